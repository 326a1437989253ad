#include "core/cone_map.hpp"

#include "core/parallel.hpp"
#include "core/wide.hpp"

#include <cassert>
#include <cmath>

namespace tarn {

namespace {

using Code = std::uint16_t;

/// to[i] = max(to[i], from[i] - drop)
TARN_WIDE void raise(Code* __restrict to, const Code* __restrict from, Code drop, int count) {
    for (int i = 0; i < count; ++i) {
        const Code m = from[i] > drop ? from[i] : drop;
        const Code lowered = static_cast<Code>(m - drop);
        to[i] = to[i] > lowered ? to[i] : lowered;
    }
}

/// to[i] = max(now[i], before[i] - drop, behind[i] - drop)
TARN_WIDE void spread(Code* __restrict to, const Code* now, const Code* before, const Code* behind,
                      Code drop, int count) {
    for (int i = 0; i < count; ++i) {
        const Code side = before[i] > behind[i] ? before[i] : behind[i];
        const Code m = side > drop ? side : drop;
        const Code lowered = static_cast<Code>(m - drop);
        to[i] = now[i] > lowered ? now[i] : lowered;
    }
}

/// max over neighbours i, i + 1
TARN_WIDE Code greatest_step(const Code* a, const Code* b, int count) {
    Code greatest = 0;
    for (int i = 0; i < count; ++i) {
        const Code high = a[i] > b[i] ? a[i] : b[i], low = a[i] > b[i] ? b[i] : a[i];
        const Code step = static_cast<Code>(high - low);
        greatest = greatest > step ? greatest : step;
    }
    return greatest;
}

/// One row against copies of itself shifted by 1, 2, 4, ... nodes: every shift is a sum of those.
void dilate_row(Code* row, int cols, Code slope, std::vector<Code>& buffers) {
    const std::size_t n = std::size_t(cols);
    buffers.assign(6 * n, 0); // two rows, each between two stretches of zeros
    Code* now = buffers.data() + n;
    Code* next = buffers.data() + 4 * n;
    std::copy(row, row + n, now);
    for (long d = 1; d < cols && d * slope < 65536; d *= 2) {
        spread(next, now, now - d, now + d, static_cast<Code>(d * slope), cols);
        std::swap(now, next);
    }
    std::copy(now, now + n, row);
}

/// Heights of the surface in codes of the map.
Grid<Code> surface_codes(const Heightfield& ground, const Heightfield* water, ConeMap& map,
                         int threads) {
    const GridSize size = ground.size();
    map.offset_m = ground.offset_m;
    map.scale_m = ground.scale_m;
    if (!water)
        return ground.codes;
    Code wettest = no_water_code;
    for (const Code code : water->codes.values)
        wettest = std::max(wettest, code);
    if (wettest == no_water_code)
        return ground.codes;
    const double highest_m =
        std::max(ground.max_elevation_m(), water->offset_m + water->scale_m * wettest);
    // Coarser codes only if water stands higher than the ground's can say.
    map.scale_m = std::max(map.scale_m, (highest_m - map.offset_m) / 65534.0);
    const bool same = map.scale_m == ground.scale_m;
    Grid<Code> out(size);
    share_out(size.rows, threads, [&](int first, int last) {
        const std::size_t cols = std::size_t(size.cols);
        for (std::size_t i = std::size_t(first) * cols; i < std::size_t(last) * cols; ++i) {
            const auto up = [&](double elevation_m) {
                return static_cast<Code>(std::clamp(
                    std::ceil((elevation_m - map.offset_m) / map.scale_m), 0.0, 65535.0));
            };
            Code code = ground.codes.values[i];
            if (!same)
                code = up(ground.offset_m + ground.scale_m * code);
            if (water->codes.values[i] != no_water_code)
                code =
                    std::max(code, up(water->offset_m + water->scale_m * water->codes.values[i]));
            out.values[i] = code;
        }
    });
    return out;
}

/// Slopes to try, steepest first. The steepest is good for every block: no two neighbouring nodes
/// differ by more. Finely spaced where most blocks are, coarsely above.
std::vector<Code> ladder(const Grid<Code>& codes, int threads) {
    const int cols = codes.size.cols, rows = codes.size.rows;
    std::vector<Code> greatest(std::size_t(rows), Code{0});
    share_out(rows, threads, [&](int first, int last) {
        for (int r = first; r < last; ++r) {
            const Code* row = &codes.values[std::size_t(r) * std::size_t(cols)];
            Code most = greatest_step(row, row + 1, cols - 1);
            if (r + 1 < rows)
                most = std::max(most, greatest_step(row, row + cols, cols));
            greatest[std::size_t(r)] = most;
        }
    });
    std::vector<Code> sorted = greatest;
    std::sort(sorted.begin(), sorted.end());
    const double steepest = sorted.back(), usual = sorted[sorted.size() / 2];
    const auto [low, high] = std::minmax_element(codes.values.begin(), codes.values.end());
    // Less than this never serves: the whole relief is spread over the whole field.
    const double least = std::max(1.0, double(*high - *low) / (cols + rows));
    std::vector<Code> out;
    for (double s = steepest;;) {
        const Code code = static_cast<Code>(std::ceil(std::max(s, 0.0)));
        if (out.empty() || code < out.back())
            out.push_back(code);
        if (s <= least)
            break;
        s *= s > usual ? 0.5 : std::pow(2.0, -0.25);
    }
    return out;
}

/// Which blocks of a row have water in them or near.
std::vector<unsigned char> wet_blocks(const Heightfield* water, const ConeMap& map, int block_row) {
    constexpr int near_cells = 3; // a walk looks so many cells on before it asks for the next cone
    std::vector<unsigned char> wet(std::size_t(map.blocks.cols), static_cast<unsigned char>(0));
    if (!water)
        return wet;
    const int cols = water->size().cols, rows = water->size().rows, side = 1 << map.shift;
    const int r0 = std::max(0, block_row * side - near_cells),
              r1 = std::min(rows - 1, (block_row + 1) * side + near_cells);
    for (int r = r0; r <= r1; ++r)
        for (int c = 0; c < cols; ++c)
            if (water->codes.values[std::size_t(r) * std::size_t(cols) + std::size_t(c)] !=
                no_water_code)
                for (int b = std::max(0, (c - near_cells - 1) / side);
                     b <= std::min(map.blocks.cols - 1, (c + near_cells) / side); ++b)
                    wet[std::size_t(b)] = 1;
    return wet;
}

/// Greatest codes of ever larger blocks of blocks: level k joins 2^k x 2^k of them.
std::vector<Grid<Code>> top_pyramid(const ConeMap& map, int threads) {
    std::vector<Grid<Code>> levels(1, Grid<Code>(map.blocks));
    for (std::size_t i = 0; i < map.blocks.count(); ++i)
        levels[0].values[i] = map.texels[2 * i];
    for (int k = 1; k < 8; ++k) {
        const Grid<Code>& finer = levels.back();
        Grid<Code> level({(finer.size.cols + 1) / 2, (finer.size.rows + 1) / 2});
        share_out(level.size.rows, threads, [&](int first, int last) {
            for (int r = first; r < last; ++r)
                for (int c = 0; c < level.size.cols; ++c) {
                    Code most = 0;
                    for (int q = 0; q < 4; ++q) {
                        const Node n{2 * c + q % 2, 2 * r + q / 2};
                        if (finer.contains(n))
                            most = std::max(most, finer[n]);
                    }
                    level[{c, r}] = most;
                }
        });
        levels.push_back(std::move(level));
    }
    return levels;
}

/// Cells around a block within which nothing is higher than its top, at most 508: the greatest of
/// 4, 8, 16, ... that squares of blocks certify.
int free_cells(const std::vector<Grid<Code>>& tops, int shift, int col, int row) {
    const Code top = tops[0][{col, row}];
    int free = 0;
    for (int wanted = 4; wanted <= 512; wanted *= 2) {
        const int blocks = std::max(1, wanted >> shift);
        // Blocks of a quarter of the distance: some ten by ten of them.
        std::size_t k = 0;
        while (k + 1 < tops.size() && (4 << k) < blocks)
            ++k;
        const Grid<Code>& level = tops[k];
        const int c0 = std::max(0, col - blocks) >> k, r0 = std::max(0, row - blocks) >> k;
        const int c1 = std::min((col + blocks) >> k, level.size.cols - 1),
                  r1 = std::min((row + blocks) >> k, level.size.rows - 1);
        for (int r = r0; r <= r1; ++r)
            for (int c = c0; c <= c1; ++c)
                if (level[{c, r}] > top)
                    return free;
        free = std::min(wanted, 508);
    }
    return free;
}

/// Puts slope, free distance and the mark of water into one code.
void pack(const Heightfield* water, Code steepest, ConeMap& map, int threads) {
    // So that the upper eight bits alone reach the steepest slope: 65280 = 255 * 256.
    map.slope_m =
        map.scale_m * std::max<Code>(steepest, 1) * (65535.0 / 65280.0) * (65535.0 / 65280.0);
    const std::vector<Grid<Code>> tops = top_pyramid(map, threads);
    share_out(map.blocks.rows, threads, [&](int first, int last) {
        for (int r = first; r < last; ++r) {
            const std::vector<unsigned char> wet = wet_blocks(water, map, r);
            Code* texels = &map.texels[2 * std::size_t(r) * std::size_t(map.blocks.cols)];
            for (int c = 0; c < map.blocks.cols; ++c) {
                const double share =
                    std::sqrt(double(texels[2 * c + 1]) / std::max<Code>(steepest, 1));
                // Rounded up; the lower bits add to it.
                const int high = std::min(255, int(std::ceil(share * 255.0)));
                const int low = free_cells(tops, map.shift, c, r) / 4 * 2 + wet[std::size_t(c)];
                texels[2 * c + 1] = static_cast<Code>(256 * high + low);
            }
        }
    });
}

} // namespace

ConeMap cone_map(const Heightfield& ground, const Heightfield* water, int shift, int threads) {
    assert(shift >= 0 && shift <= 4);
    ConeMap map;
    map.shift = shift;
    const Grid<Code> codes = surface_codes(ground, water, map, threads);
    const int cols = codes.size.cols, rows = codes.size.rows, side = 1 << shift;
    map.blocks = {(cols - 1 + side - 1) / side, (rows - 1 + side - 1) / side};
    map.texels.resize(2 * map.blocks.count());

    // Greatest code on the nodes of a block; its border nodes belong to it.
    const auto top = [&](const Grid<Code>& field, int block_col, int block_row) {
        const int c0 = block_col << shift, r0 = block_row << shift;
        const int c1 = std::min(c0 + side, cols - 1), r1 = std::min(r0 + side, rows - 1);
        Code most = 0;
        for (int r = r0; r <= r1; ++r)
            for (int c = c0; c <= c1; ++c)
                most = std::max(most,
                                field.values[std::size_t(r) * std::size_t(cols) + std::size_t(c)]);
        return most;
    };
    const std::vector<Code> slopes = ladder(codes, threads);
    share_out(map.blocks.rows, threads, [&](int first, int last) {
        for (int r = first; r < last; ++r)
            for (int c = 0; c < map.blocks.cols; ++c) {
                Code* texel = &map.texels[2 * (std::size_t(r) * std::size_t(map.blocks.cols) +
                                               std::size_t(c))];
                texel[0] = top(codes, c, r);
                texel[1] = slopes.front();
            }
    });
    Grid<Code> dilated(codes.size);
    for (std::size_t k = 1; k < slopes.size(); ++k) {
        const Code slope = slopes[k];
        share_out(rows, threads, [&](int first, int last) {
            std::vector<Code> buffers;
            for (int r = first; r < last; ++r) {
                Code* row = &dilated.values[std::size_t(r) * std::size_t(cols)];
                std::copy_n(&codes.values[std::size_t(r) * std::size_t(cols)], cols, row);
                dilate_row(row, cols, slope, buffers);
            }
        });
        // Columns in strips that stay in the cache on the way down and back up.
        constexpr int strip = 128;
        share_out((cols + strip - 1) / strip, threads, [&](int first, int last) {
            for (int s = first; s < last; ++s) {
                const int from = s * strip, count = std::min(strip, cols - from);
                const auto at = [&](int r) {
                    return &dilated.values[std::size_t(r) * std::size_t(cols) + std::size_t(from)];
                };
                for (int r = 1; r < rows; ++r)
                    raise(at(r), at(r - 1), slope, count);
                for (int r = rows - 2; r >= 0; --r)
                    raise(at(r), at(r + 1), slope, count);
            }
        });
        share_out(map.blocks.rows, threads, [&](int first, int last) {
            for (int r = first; r < last; ++r)
                for (int c = 0; c < map.blocks.cols; ++c) {
                    Code* texel = &map.texels[2 * (std::size_t(r) * std::size_t(map.blocks.cols) +
                                                   std::size_t(c))];
                    if (texel[1] == slopes[k - 1] && top(dilated, c, r) <= texel[0])
                        texel[1] = slope;
                }
        });
    }
    pack(water, slopes.front(), map, threads);
    return map;
}

} // namespace tarn
