#include "waves/fetch.hpp"

#include "core/angles.hpp"
#include "core/parallel.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::waves {

WaterMask water_mask(const Heightfield& ground, const Heightfield& water, int most) {
    const GridSize nodes = ground.size();
    const int cells = std::max(nodes.cols, nodes.rows) - 1;
    const int stride = (cells + most - 1) / most; // nodes a square
    WaterMask mask;
    mask.side_m = stride * ground.spacing_m;
    mask.west_m = ground.west_m;
    mask.north_m = ground.north_m;
    const GridSize size{std::max(1, (nodes.cols - 1 + stride - 1) / stride),
                        std::max(1, (nodes.rows - 1 + stride - 1) / stride)};
    mask.open = Grid<std::uint8_t>(size);
    mask.wet_share = Grid<float>(size);
    mask.depth_m = Grid<float>(size);
    share_out(size.rows, 0, [&](int first, int last) {
        for (int row = first; row < last; ++row)
            for (int col = 0; col < size.cols; ++col) {
                int seen = 0, wet = 0;
                double depth_sum = 0.0;
                for (int r = row * stride; r < std::min((row + 1) * stride, nodes.rows); ++r)
                    for (int c = col * stride; c < std::min((col + 1) * stride, nodes.cols); ++c) {
                        ++seen;
                        if (water.codes[{c, r}] == no_water_code)
                            continue;
                        const double depth = water.elevation_m({c, r}) - ground.elevation_m({c, r});
                        if (depth > 0.0) {
                            ++wet;
                            depth_sum += depth;
                        }
                    }
                mask.open[{col, row}] = 2 * wet >= seen && wet > 0;
                mask.wet_share[{col, row}] = float(wet) / float(std::max(seen, 1));
                mask.depth_m[{col, row}] = wet > 0 ? float(depth_sum / wet) : 0.0f;
            }
    });
    return mask;
}

double straight_fetch_m(const WaterMask& mask, Node square, double from_deg) {
    if (!mask.open[square])
        return 0.0;
    // From square to square along the ray against the wind (Amanatides & Woo 1987).
    const double dx = std::sin(from_deg * degree), dy = -std::cos(from_deg * degree); // cols, rows
    const int step_x = dx > 0 ? 1 : -1, step_y = dy > 0 ? 1 : -1;
    const double gap_x = std::abs(dx) > 1e-12 ? 1.0 / std::abs(dx) : 1e30;
    const double gap_y = std::abs(dy) > 1e-12 ? 1.0 / std::abs(dy) : 1e30;
    double next_x = 0.5 * gap_x, next_y = 0.5 * gap_y, gone = 0.0;
    Node at = square;
    while (true) {
        if (next_x < next_y) {
            gone = next_x;
            next_x += gap_x;
            at.col += step_x;
        } else {
            gone = next_y;
            next_y += gap_y;
            at.row += step_y;
        }
        if (!mask.open.contains(at) || !mask.open[at])
            return gone * mask.side_m;
    }
}

Grid<float> effective_fetch_m(const WaterMask& mask, double from_deg) {
    Grid<float> out(mask.open.size);
    share_out(mask.open.size.rows, 0, [&](int first, int last) {
        for (int row = first; row < last; ++row)
            for (int col = 0; col < mask.open.size.cols; ++col) {
                if (!mask.open[{col, row}])
                    continue;
                double sum = 0.0, weights = 0.0;
                for (int k = -7; k <= 7; ++k) { // every 6 degrees to 42
                    const double c = std::cos(6.0 * k * degree);
                    sum += straight_fetch_m(mask, {col, row}, from_deg + 6.0 * k) * c * c;
                    weights += c;
                }
                out[{col, row}] = float(std::max(sum / weights, 0.5 * mask.side_m));
            }
    });
    // Shores and ponds that fill no half square.
    const Grid<float> open = out;
    for (int row = 0; row < out.size.rows; ++row)
        for (int col = 0; col < out.size.cols; ++col) {
            const float share = mask.wet_share[{col, row}];
            if (mask.open[{col, row}] || !(share > 0.0f))
                continue;
            float beside = 0.0f;
            for (int k = 0; k < 9; ++k) {
                const Node n{col + k % 3 - 1, row + k / 3 - 1};
                if (open.contains(n))
                    beside = std::max(beside, open[n]);
            }
            out[{col, row}] = beside > 0.0f ? beside : float(mask.side_m) * std::sqrt(share);
        }
    return out;
}

} // namespace tarn::waves
