#include "core/safety_radius.hpp"

#include "core/parallel.hpp"
#include "core/wide.hpp"

#include <algorithm>
#include <cmath>

namespace tarn {

namespace {

using Code = std::uint16_t;

/// Four corner heights of a cell.
struct Corners {
    int nw, ne, sw, se;
    int highest() const { return std::max(std::max(nw, ne), std::max(sw, se)); }
};

struct Codes {
    const Code* values;
    int cols;
    Corners cell(int c, int r) const {
        const Code* p = values + std::size_t(r) * std::size_t(cols) + std::size_t(c);
        return {p[0], p[1], p[cols], p[cols + 1]};
    }
};

/// The highest that any tangent plane of cell D comes over any place of a cell `across` columns and
/// `down` rows from it.
int greatest_tangent(const Corners& d, int across, int down) {
    const int east_n = d.ne - d.nw, east_s = d.se - d.sw, south_w = d.sw - d.nw,
              south_e = d.se - d.ne;
    const auto plane = [&](int z, int east, int south, int u, int v) {
        return z + east * ((east > 0 ? across + 1 : across) - u) +
               south * ((south > 0 ? down + 1 : down) - v);
    };
    return std::max(
        std::max(plane(d.nw, east_n, south_w, 0, 0), plane(d.ne, east_n, south_e, 1, 0)),
        std::max(plane(d.sw, east_s, south_w, 0, 1), plane(d.se, east_s, south_e, 1, 1)));
}

/// greatest_tangent() of a whole row of cells D, `across` columns and `down` rows from the cells
/// asked for: clears safe[i] where it rises above highest[i]. No branches, so that it runs some
/// cells at once.
TARN_WIDE void test_row(const Code* north, const Code* south_row, int across, int down,
                        const int* highest, unsigned char* safe, int count) {
    for (int i = 0; i < count; ++i) {
        const int nw = north[i], ne = north[i + 1], sw = south_row[i], se = south_row[i + 1];
        const int east_n = ne - nw, east_s = se - sw, south_w = sw - nw, south_e = se - ne;
        const int up_n = east_n > 0 ? east_n : 0, up_s = east_s > 0 ? east_s : 0;
        const int up_w = south_w > 0 ? south_w : 0, up_e = south_e > 0 ? south_e : 0;
        const int a = nw + east_n * across + up_n + south_w * down + up_w;
        const int b = ne + east_n * (across - 1) + up_n + south_e * down + up_e;
        const int c = sw + east_s * across + up_s + south_w * (down - 1) + up_w;
        const int d = se + east_s * (across - 1) + up_s + south_e * (down - 1) + up_e;
        const int ab = a > b ? a : b, cd = c > d ? c : d, most = ab > cd ? ab : cd;
        safe[i] = static_cast<unsigned char>(safe[i] & (most <= highest[i]));
    }
}

/// Bounds over a block of cells: nothing in it is higher or steeper.
struct Block {
    int highest = 0;
    int east_low = 0, east_high = 0, south_low = 0, south_high = 0; ///< slopes along grid lines
};

struct Level {
    int cols = 0, rows = 0;
    std::vector<Block> blocks;
};

Block joined(const Block& a, const Block& b) {
    return {std::max(a.highest, b.highest), std::min(a.east_low, b.east_low),
            std::max(a.east_high, b.east_high), std::min(a.south_low, b.south_low),
            std::max(a.south_high, b.south_high)};
}

/// Level k: blocks of block_side(k) cells a side.
constexpr int level_count = 5;
constexpr int block_side(int k) { return 4 << k; }

/// Bounds over a block of the finest level, straight from its nodes.
Block finest_block(const Codes& codes, int c0, int r0, int cells_across, int cells_down) {
    const int c1 = std::min(c0 + block_side(0), cells_across),
              r1 = std::min(r0 + block_side(0), cells_down);
    Block block{0, 65535, -65535, 65535, -65535};
    for (int r = r0; r <= r1; ++r) {
        const Code* row = codes.values + std::size_t(r) * std::size_t(codes.cols);
        for (int c = c0; c <= c1; ++c) {
            block.highest = std::max(block.highest, int(row[c]));
            if (c < c1) {
                const int east = int(row[c + 1]) - int(row[c]);
                block.east_low = std::min(block.east_low, east);
                block.east_high = std::max(block.east_high, east);
            }
            if (r < r1) {
                const int south = int(row[c + codes.cols]) - int(row[c]);
                block.south_low = std::min(block.south_low, south);
                block.south_high = std::max(block.south_high, south);
            }
        }
    }
    return block;
}

std::vector<Level> pyramid(const Codes& codes, int cells_across, int cells_down, int threads) {
    std::vector<Level> levels;
    for (int k = 0; k < level_count; ++k) {
        Level level;
        const int side = block_side(k);
        level.cols = (cells_across + side - 1) / side;
        level.rows = (cells_down + side - 1) / side;
        level.blocks.resize(std::size_t(level.cols) * std::size_t(level.rows));
        const Level* finer = levels.empty() ? nullptr : &levels.back();
        share_out(level.rows, threads, [&](int first, int last) {
            for (int r = first; r < last; ++r)
                for (int c = 0; c < level.cols; ++c) {
                    Block& block =
                        level.blocks[std::size_t(r) * std::size_t(level.cols) + std::size_t(c)];
                    if (!finer) {
                        block = finest_block(codes, c * side, r * side, cells_across, cells_down);
                        continue;
                    }
                    const auto part = [&](int cc, int rr) {
                        return finer
                            ->blocks[std::size_t(rr) * std::size_t(finer->cols) + std::size_t(cc)];
                    };
                    block = part(2 * c, 2 * r);
                    for (int q = 1; q < 4; ++q)
                        if (2 * c + q % 2 < finer->cols && 2 * r + q / 2 < finer->rows)
                            block = joined(block, part(2 * c + q % 2, 2 * r + q / 2));
                }
        });
        levels.push_back(std::move(level));
    }
    return levels;
}

} // namespace

Grid<std::uint8_t> safety_radii(const Heightfield& heights, int threads) {
    const int across = heights.size().cols - 1, down = heights.size().rows - 1;
    const Codes codes{heights.codes.values.data(), heights.size().cols};
    const std::vector<Level> levels = pyramid(codes, across, down, threads);

    // Is the whole ring of cells `n` away harmless to a ray that starts over cell (c, r)?
    const auto ring_is_safe = [&](int c, int r, int highest, int n) {
        const int c0 = std::max(c - n, 0), c1 = std::min(c + n, across - 1);
        const auto safe = [&](int cc, int rr) {
            return greatest_tangent(codes.cell(cc, rr), c - cc, r - rr) <= highest;
        };
        for (int rr = std::max(r - n, 0); rr <= std::min(r + n, down - 1); ++rr)
            if (rr == r - n || rr == r + n) {
                for (int cc = c0; cc <= c1; ++cc)
                    if (!safe(cc, rr))
                        return false;
            } else {
                if (c - n >= 0 && !safe(c - n, rr))
                    return false;
                if (c + n < across && !safe(c + n, rr))
                    return false;
            }
        return true;
    };
    // The same for the whole square of `n` cells around a tile of 2^shift cells a side, by bounds
    // over blocks of 2^(k+1) cells. The tile itself and what is near lie in these blocks, too:
    // bounds only get larger by that.
    const auto square_is_safe = [&](int c, int r, int tile, int highest, int n, int k) {
        const Level& level = levels[std::size_t(k)];
        const int side = block_side(k);
        const int c1 = std::min(c + tile, across), r1 = std::min(r + tile, down); // nodes
        for (int br = std::max(r - n, 0) / side; br <= std::min(r1 - 1 + n, down - 1) / side; ++br)
            for (int bc = std::max(c - n, 0) / side; bc <= std::min(c1 - 1 + n, across - 1) / side;
                 ++bc) {
                const Block& b =
                    level.blocks[std::size_t(br) * std::size_t(level.cols) + std::size_t(bc)];
                // From a node of the block to a node of the tile: columns and rows, least and most.
                const int x0 = c - std::min(bc * side + side, across), x1 = c1 - bc * side;
                const int y0 = r - std::min(br * side + side, down), y1 = r1 - br * side;
                const int east = std::max(std::max(b.east_high * x1, b.east_low * x0),
                                          std::max(b.east_high * x0, b.east_low * x1));
                const int south = std::max(std::max(b.south_high * y1, b.south_low * y0),
                                           std::max(b.south_high * y0, b.south_low * y1));
                if (b.highest + east + south > highest)
                    return false;
            }
        return true;
    };
    // Greatest certified value of a tile, 0 or one of 8, 16, ... 128, 255.
    const auto certified = [&](int c, int r, int tile, int highest) {
        int n = 0;
        for (int k = 0; k < 6; ++k) {
            const int wanted = std::min(8 << k, 255);
            if (!square_is_safe(c, r, tile, highest, wanted - 1, std::max(0, k - 1)))
                break;
            n = wanted;
        }
        return n;
    };

    Grid<std::uint8_t> out({across, down});
    constexpr int tile = 8;
    share_out((down + tile - 1) / tile, threads, [&](int first, int last) {
        const std::size_t n_across = std::size_t(across);
        std::vector<int> highest(n_across);
        std::vector<unsigned char> itself(n_across), around(n_across);
        std::vector<int> together((n_across + tile - 1) / tile);
        for (int r = first * tile; r < std::min(last * tile, down); ++r) {
            if (r % tile == 0) { // wide plains (lakes) at once
                const int r1 = std::min(r + tile, down);
                for (int c = 0; c < across; c += tile) {
                    const int c1 = std::min(c + tile, across);
                    int lowest = 65535; // of the cells' highest nodes
                    for (int rr = r; rr < r1; ++rr)
                        for (int cc = c; cc < c1; ++cc)
                            lowest = std::min(lowest, codes.cell(cc, rr).highest());
                    together[std::size_t(c / tile)] = certified(c, r, tile, lowest);
                }
            }
            // Most cells of rough ground end at themselves or at the ring around: those, a row at a
            // time.
            for (int c = 0; c < across; ++c)
                highest[std::size_t(c)] = codes.cell(c, r).highest();
            const auto test = [&](int dc, int dr, std::vector<unsigned char>& safe) {
                const int rr = r + dr, c0 = std::max(0, -dc), c1 = std::min(across, across - dc);
                if (rr < 0 || rr >= down || c0 >= c1)
                    return;
                const Code* north =
                    codes.values + std::size_t(rr) * std::size_t(codes.cols) + std::size_t(c0 + dc);
                test_row(north, north + codes.cols, -dc, -dr, &highest[std::size_t(c0)],
                         &safe[std::size_t(c0)], c1 - c0);
            };
            std::fill(itself.begin(), itself.end(), static_cast<unsigned char>(1));
            test(0, 0, itself);
            around = itself;
            for (int k = 0; k < 9; ++k)
                if (k != 4)
                    test(k % 3 - 1, k / 3 - 1, around);
            for (int c = 0; c < across; ++c) {
                const std::size_t i = std::size_t(c);
                int n = itself[i] + around[i];
                if (const int plain = together[i / tile]; plain >= 16) {
                    n = plain;
                } else if (n == 2) {
                    while (n < 4 && ring_is_safe(c, r, highest[i], n))
                        ++n;
                    if (n == 4)
                        n = std::max(n, certified(c, r, 1, highest[i]));
                }
                out.values[std::size_t(r) * n_across + i] = static_cast<std::uint8_t>(n);
            }
        }
    });
    return out;
}

std::string ground_sum(const Heightfield& heights) {
    std::uint64_t sum = 14695981039346656037ull;
    const auto add = [&sum](std::uint64_t value) { sum = (sum ^ value) * 1099511628211ull; };
    add(static_cast<std::uint64_t>(heights.size().cols));
    add(static_cast<std::uint64_t>(heights.size().rows));
    for (const Code code : heights.codes.values)
        add(code);
    std::string out(16, '0');
    for (int k = 0; k < 16; ++k)
        out[std::size_t(k)] = "0123456789abcdef"[(sum >> (60 - 4 * k)) & 15];
    return out;
}

int water_safety_radius(double amplitude_m, double shortest_wave_m, double spacing_m,
                        double quantum_m) {
    if (amplitude_m <= 0.0)
        return 255;
    // A chord of length l cuts a crest of curvature a k^2 to a depth of a k^2 l^2 / 8.
    const double k = 2.0 * 3.14159265358979323846 / shortest_wave_m;
    const double chord_m = std::sqrt(8.0 * quantum_m / (amplitude_m * k * k));
    return static_cast<int>(std::clamp(std::floor(chord_m / (2.0 * spacing_m)), 1.0, 255.0));
}

} // namespace tarn
