#include "dem/statistics.hpp"

#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::dem {

namespace {

double shoreline_length_m(double level_m, const Heightfield& ground, const Grid<unsigned char>& wet,
                          Node low, Node high) {
    double length = 0.0;
    const double s = ground.spacing_m;
    for (int row = std::max(low.row - 1, 0); row < std::min(high.row + 1, ground.size().rows - 1);
         ++row)
        for (int col = std::max(low.col - 1, 0);
             col < std::min(high.col + 1, ground.size().cols - 1); ++col) {
            // Corners clockwise from the north-west.
            const Node corner[4] = {{col, row}, {col + 1, row}, {col + 1, row + 1}, {col, row + 1}};
            bool is_wet[4];
            double above[4];
            int count = 0;
            for (int k = 0; k < 4; ++k) {
                is_wet[k] = wet[corner[k]] != 0;
                above[k] = ground.elevation_m(corner[k]) - level_m;
                count += is_wet[k];
            }
            if (count == 0 || count == 4)
                continue;
            static constexpr double corner_x[4] = {0, 1, 1, 0}, corner_y[4] = {0, 0, 1, 1};
            double x[4], y[4];
            int crossings = 0;
            for (int k = 0; k < 4; ++k) {
                const int m = (k + 1) % 4;
                if (is_wet[k] == is_wet[m])
                    continue;
                const double a = std::abs(above[k]), b = std::abs(above[m]);
                const double f = a + b > 0.0 ? a / (a + b) : 0.5;
                x[crossings] = corner_x[k] + f * (corner_x[m] - corner_x[k]);
                y[crossings] = corner_y[k] + f * (corner_y[m] - corner_y[k]);
                ++crossings;
            }
            for (int k = 0; k + 1 < crossings; k += 2)
                length += s * std::hypot(x[k + 1] - x[k], y[k + 1] - y[k]);
        }
    return length;
}

/// Dry parts inside the box (widened by one) that its rim cannot reach by 4-neighbour steps.
int count_islands(const Grid<unsigned char>& wet, Node low, Node high) {
    const GridSize size{high.col - low.col + 3, high.row - low.row + 3};
    Grid<unsigned char> seen(size);
    const auto is_wet = [&](Node n) {
        const Node at{n.col + low.col - 1, n.row + low.row - 1};
        return wet.contains(at) && wet[at];
    };
    std::vector<Node> queue;
    const auto sweep = [&](Node from) {
        queue.assign(1, from);
        seen[from] = 1;
        for (std::size_t i = 0; i < queue.size(); ++i) {
            const Node at = queue[i];
            const Node next[4] = {{at.col - 1, at.row},
                                  {at.col + 1, at.row},
                                  {at.col, at.row - 1},
                                  {at.col, at.row + 1}};
            for (const Node n : next)
                if (seen.contains(n) && !seen[n] && !is_wet(n)) {
                    seen[n] = 1;
                    queue.push_back(n);
                }
        }
    };
    // The rim of the widened box holds no wet node and is one connected ring.
    sweep({0, 0});
    int islands = 0;
    for (int row = 0; row < size.rows; ++row)
        for (int col = 0; col < size.cols; ++col)
            if (!seen[{col, row}] && !is_wet({col, row})) {
                ++islands;
                sweep({col, row});
            }
    return islands;
}

/// The wet node with the greatest chessboard distance to dry land: "in the middle of the lake".
Node innermost(const Grid<unsigned char>& wet, Node low, Node high) {
    Grid<int> distance(wet.size, 0);
    Node best = low;
    const auto at = [&](int col, int row) {
        return distance.contains({col, row}) ? distance[{col, row}] : 0;
    };
    for (int row = low.row; row <= high.row; ++row)
        for (int col = low.col; col <= high.col; ++col)
            if (wet[{col, row}])
                distance[{col, row}] = 1 + std::min({at(col - 1, row - 1), at(col, row - 1),
                                                     at(col + 1, row - 1), at(col - 1, row)});
    int greatest = 0;
    for (int row = high.row; row >= low.row; --row)
        for (int col = high.col; col >= low.col; --col)
            if (wet[{col, row}]) {
                const int d = std::min(distance[{col, row}],
                                       1 + std::min({at(col + 1, row + 1), at(col, row + 1),
                                                     at(col - 1, row + 1), at(col + 1, row)}));
                distance[{col, row}] = d;
                if (d > greatest) {
                    greatest = d;
                    best = {col, row};
                }
            }
    return best;
}

} // namespace

void measure(LakeRecord& record, const Heightfield& ground, const Grid<unsigned char>& wet,
             const geo::Frame& frame) {
    Node low{wet.size.cols, wet.size.rows}, high{-1, -1};
    std::size_t nodes = 0;
    double depth_sum = 0.0, deepest = 0.0;
    const double cell = ground.spacing_m * ground.spacing_m;
    for (int row = 0; row < wet.size.rows; ++row)
        for (int col = 0; col < wet.size.cols; ++col) {
            if (!wet[{col, row}])
                continue;
            ++nodes;
            low = {std::min(low.col, col), std::min(low.row, row)};
            high = {std::max(high.col, col), std::max(high.row, row)};
            const double depth = record.level_m - ground.elevation_m(Node{col, row});
            depth_sum += depth;
            deepest = std::max(deepest, depth);
        }
    record.west_north = low;
    record.east_south = high;
    record.area_m2 = double(nodes) * cell;

    // The scale factor varies over kilometres: one value per block of 32 x 32 nodes is plenty.
    record.true_area_m2 = 0.0;
    constexpr int block = 32;
    for (int r0 = low.row; r0 <= high.row; r0 += block)
        for (int c0 = low.col; c0 <= high.col; c0 += block) {
            std::size_t here = 0;
            for (int row = r0; row <= std::min(r0 + block - 1, high.row); ++row)
                for (int col = c0; col <= std::min(c0 + block - 1, high.col); ++col)
                    here += wet[{col, row}] != 0;
            if (here == 0)
                continue;
            const double k = geo::scale_factor(
                frame, {ground.x_m(c0 + 0.5 * (block - 1)), ground.y_m(r0 + 0.5 * (block - 1))});
            record.true_area_m2 += double(here) * cell / (k * k);
        }

    record.volume_m3.reset();
    record.max_depth_m.reset();
    record.mean_depth_m.reset();
    if (record.bed != Bed::unknown) {
        record.volume_m3 = depth_sum * cell;
        record.max_depth_m = deepest;
        record.mean_depth_m = depth_sum / double(nodes);
    }
    record.shoreline_m = shoreline_length_m(record.level_m, ground, wet, low, high);
    record.islands = count_islands(wet, low, high);
    record.seed = innermost(wet, low, high);
    record.position =
        geo::to_geo(frame, {ground.x_m(record.seed.col), ground.y_m(record.seed.row)});
}

} // namespace tarn::dem
