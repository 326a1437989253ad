#include "dem/statistics.hpp"

#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::dem {

namespace {

/// The wet node with the greatest chessboard distance to dry land: "in the middle of the lake".
Node innermost(const LakeOf& lakes, int id, Node low, Node high) {
    const GridSize size{high.col - low.col + 1, high.row - low.row + 1};
    Grid<std::uint16_t> distance(size);
    const auto at = [&](int col, int row) {
        return distance.contains({col, row}) ? int(distance[{col, row}]) : 0;
    };
    const auto wet = [&](int col, int row) { return lakes[{low.col + col, low.row + row}] == id; };
    const auto store = [&](int col, int row, int d) {
        distance[{col, row}] = static_cast<std::uint16_t>(std::min(d, 65535));
    };
    for (int row = 0; row < size.rows; ++row)
        for (int col = 0; col < size.cols; ++col)
            if (wet(col, row))
                store(col, row,
                      1 + std::min({at(col - 1, row - 1), at(col, row - 1), at(col + 1, row - 1),
                                    at(col - 1, row)}));
    Node best = low;
    int greatest = 0;
    for (int row = size.rows - 1; row >= 0; --row)
        for (int col = size.cols - 1; col >= 0; --col)
            if (wet(col, row)) {
                const int d =
                    std::min(at(col, row), 1 + std::min({at(col + 1, row + 1), at(col, row + 1),
                                                         at(col - 1, row + 1), at(col + 1, row)}));
                store(col, row, d);
                if (d > greatest) {
                    greatest = d;
                    best = {low.col + col, low.row + row};
                }
            }
    return best;
}

} // namespace

Boxes boxes_of(const LakeOf& lakes, int count) {
    Boxes out(std::size_t(count), {Node{lakes.size.cols, lakes.size.rows}, Node{-1, -1}});
    for (int row = 0; row < lakes.size.rows; ++row)
        for (int col = 0; col < lakes.size.cols; ++col)
            if (const int id = lakes[{col, row}]; id > 0 && id <= count) {
                auto& [low, high] = out[std::size_t(id - 1)];
                low = {std::min(low.col, col), std::min(low.row, row)};
                high = {std::max(high.col, col), std::max(high.row, row)};
            }
    return out;
}

double shoreline_length_m(double level_m, const Surface& ground, const LakeOf& lakes, int id,
                          const Box& box, bool midway) {
    const auto [low, high] = box;
    double length = 0.0;
    const double s = ground.spacing_m;
    for (int row = std::max(low.row - 1, 0);
         row < std::min(high.row + 1, ground.elevation_m.size.rows - 1); ++row)
        for (int col = std::max(low.col - 1, 0);
             col < std::min(high.col + 1, ground.elevation_m.size.cols - 1); ++col) {
            // Corners clockwise from the north-west.
            const Node corner[4] = {{col, row}, {col + 1, row}, {col + 1, row + 1}, {col, row + 1}};
            bool is_wet[4];
            double above[4];
            int count = 0;
            for (int k = 0; k < 4; ++k) {
                is_wet[k] = lakes[corner[k]] == id;
                above[k] = double(ground.elevation_m[corner[k]]) - level_m;
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
                // Half way, too, to where there is no data.
                const double f = midway || !(a + b > 0.0) ? 0.5 : a / (a + b);
                x[crossings] = corner_x[k] + f * (corner_x[m] - corner_x[k]);
                y[crossings] = corner_y[k] + f * (corner_y[m] - corner_y[k]);
                ++crossings;
            }
            for (int k = 0; k + 1 < crossings; k += 2)
                length += s * std::hypot(x[k + 1] - x[k], y[k + 1] - y[k]);
        }
    return length;
}

std::vector<Node> parts_of(const LakeOf& lakes, Marks& marks, int id, const Box& box) {
    std::vector<Node> out;
    for (int row = box.first.row; row <= box.second.row; ++row)
        for (int col = box.first.col; col <= box.second.col; ++col) {
            const Node start{col, row};
            if (lakes[start] != id || (marks[start] & mark::seen))
                continue;
            out.push_back(start);
            marks[start] |= mark::seen;
            search<8>(
                lakes.size, {start},
                [&](Node n) {
                    if (lakes[n] != id || (marks[n] & mark::seen))
                        return false;
                    marks[n] |= mark::seen;
                    return true;
                },
                [](Node) {});
        }
    return out;
}

int count_islands(const LakeOf& lakes, int id, const Box& box) {
    const auto [low, high] = box;
    const GridSize size{high.col - low.col + 3, high.row - low.row + 3};
    Grid<unsigned char> seen(size);
    const Node corner{low.col - 1, low.row - 1};
    const auto is_wet = [&](Node n) {
        const Node at{n.col + corner.col, n.row + corner.row};
        return lakes.contains(at) && lakes[at] == id;
    };
    const auto sweep = [&](Node from) {
        seen[from] = 1;
        search<4>(
            size, {from},
            [&](Node n) {
                if (seen[n] || is_wet(n))
                    return false;
                seen[n] = 1;
                return true;
            },
            [](Node) {});
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

void measure(LakeRecord& record, const Surface& ground, const LakeOf& lakes, const Box& box,
             const geo::Frame& frame) {
    const auto [low, high] = box;
    const int id = record.id;
    const double cell = ground.spacing_m * ground.spacing_m;
    // Depths count from the level as files would hold it (float32), as GIS tools do.
    const auto level_m = double(static_cast<float>(record.level_m));
    record.west_north = low;
    record.east_south = high;
    std::size_t nodes = 0;
    double depth_sum = 0.0, deepest = 0.0, true_area = 0.0, true_volume = 0.0;
    // The scale factor varies over kilometres: one value per block of 32 x 32 nodes is plenty.
    constexpr int block = 32;
    for (int r0 = low.row; r0 <= high.row; r0 += block)
        for (int c0 = low.col; c0 <= high.col; c0 += block) {
            std::size_t here = 0;
            double depths = 0.0;
            for (int row = r0; row <= std::min(r0 + block - 1, high.row); ++row)
                for (int col = c0; col <= std::min(c0 + block - 1, high.col); ++col) {
                    if (lakes[{col, row}] != id)
                        continue;
                    const double depth =
                        std::max(level_m - double(ground.elevation_m[{col, row}]), 0.0);
                    ++here;
                    depths += depth;
                    deepest = std::max(deepest, depth);
                }
            if (here == 0)
                continue;
            const double k = geo::scale_factor(
                frame, {ground.west_m + (c0 + 0.5 * (block - 1)) * ground.spacing_m,
                        ground.north_m - (r0 + 0.5 * (block - 1)) * ground.spacing_m});
            nodes += here;
            depth_sum += depths;
            true_area += double(here) * cell / (k * k);
            true_volume += depths * cell / (k * k);
        }
    record.area_m2 = double(nodes) * cell;
    record.true_area_m2 = true_area;
    record.volume_m3.reset();
    record.true_volume_m3.reset();
    record.max_depth_m.reset();
    record.mean_depth_m.reset();
    if (record.bed != Bed::unknown && nodes > 0) {
        record.volume_m3 = depth_sum * cell;
        record.true_volume_m3 = true_volume;
        record.max_depth_m = deepest;
        record.mean_depth_m = depth_sum / double(nodes);
    }
    record.shoreline_m =
        shoreline_length_m(level_m, ground, lakes, id, box, record.bed == Bed::unknown);
    record.islands = count_islands(lakes, id, box);
    record.seed = innermost(lakes, id, low, high);
    record.position = geo::to_geo(frame, {ground.west_m + record.seed.col * ground.spacing_m,
                                          ground.north_m - record.seed.row * ground.spacing_m});
}

} // namespace tarn::dem
