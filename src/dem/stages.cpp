#include "dem/stages.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/fill.hpp"
#include "dem/flat.hpp"
#include "dem/statistics.hpp"
#include "dem/wetting.hpp"
#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tarn::dem {

namespace {

constexpr float never = never_wet;

int count_pools(LakeOf& lake, const Box& box) {
    int pools = 0;
    for (int row = box.first.row; row <= box.second.row; ++row)
        for (int col = box.first.col; col <= box.second.col; ++col) {
            if (lake[{col, row}] != 1)
                continue;
            ++pools;
            lake[{col, row}] = 2;
            search<8>(
                lake.size, {Node{col, row}},
                [&](Node n) {
                    if (lake[n] != 1)
                        return false;
                    lake[n] = 2;
                    return true;
                },
                [](Node) {});
        }
    return pools;
}

} // namespace

StageTable stage_table(const Grid<float>& z, const Heightfield& ground, const Heightfield& water,
                       const geo::Frame& frame, const LakeRecord& lake,
                       std::span<const double> levels_m, int neighbours, const Progress& progress) {
    if (levels_m.empty() || levels_m.size() > 10'000)
        throw Error(text("got ", levels_m.size(), " levels, must be 1 to 10000"),
                    "choose a larger step");
    if (neighbours != 4 && neighbours != 8)
        throw Error(text("neighbours is ", neighbours, ", must be 4 or 8"));
    if (lake.bed == Bed::unknown)
        for (const double level : levels_m)
            if (level < lake.level_m - 0.0005)
                throw Error(text("the bed of lake ", lake.id, " is unknown: nothing can be told ",
                                 "about a level of ", level, " m, below its surface at ",
                                 fixed(lake.level_m, 2), " m"),
                            "start at its surface, or import with --bathymetry or --soundings");
    StageTable out;
    progress.report(0.0, "following the water");
    LakeOf mask(ground.size());
    add_footprint(ground, water, lake, 1, mask);
    const double highest = *std::max_element(levels_m.begin(), levels_m.end());
    const Grid<float> wets = wetting_heights(z, mask, 1, lake.level_m, highest, neighbours);

    progress.report(0.3, "looking for the pass");
    const Surface surface{z, ground.spacing_m, ground.west_m, ground.north_m};
    {
        Marks marks(z.size);
        Grid<float> solid = z; // the edge of the data is where heights end
        for (std::size_t i = 0; i < solid.values.size(); ++i)
            if (std::isnan(solid.values[i])) {
                marks.values[i] = mark::outside;
                solid.values[i] = never;
            }
        if (const auto spill = find_spill(solid, marks, mask, 1, lake.level_m))
            out.spill = LakeSpill{.level_m = spill->level_m,
                                  .pass = geo::to_geo(frame, {ground.x_m(spill->pass.col),
                                                              ground.y_m(spill->pass.row)}),
                                  .at_surface = spill->at_surface};
    }

    // Each node belongs to the first level that wets it; sums over levels follow from these.
    struct Class {
        std::size_t nodes = 0;
        double below = 0.0, true_nodes = 0.0, true_below = 0.0; ///< below: reference minus height
        float lowest = never;
        bool edge = false;
        Node low{std::numeric_limits<int>::max(), std::numeric_limits<int>::max()}, high{-1, -1};
    };
    std::vector<std::size_t> order(levels_m.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return levels_m[a] < levels_m[b]; });
    const auto flats = find_flats(z);
    std::vector<float> wet_to;
    for (const std::size_t i : order)
        wet_to.push_back(highest_wet(
            levels_m[i], std::any_of(flats.begin(), flats.end(), [&](const FlatSurface& flat) {
                const auto level = static_cast<float>(levels_m[i]); // a surface that it reaches
                return flat.level_m == level && wets[flat.middle] <= level;
            })));
    std::vector<Class> classes(order.size());
    const double reference = lake.level_m;
    constexpr int block = 32; // the scale factor varies over kilometres
    for (int r0 = 0; r0 < z.size.rows; r0 += block)
        for (int c0 = 0; c0 < z.size.cols; c0 += block) {
            double area_scale = 0.0;
            for (int row = r0; row < std::min(r0 + block, z.size.rows); ++row)
                for (int col = c0; col < std::min(c0 + block, z.size.cols); ++col) {
                    const Node n{col, row};
                    const auto first = std::lower_bound(wet_to.begin(), wet_to.end(), wets[n]);
                    if (wets[n] == never || first == wet_to.end())
                        continue;
                    if (area_scale == 0.0) {
                        const double k =
                            geo::scale_factor(frame, {ground.x_m(c0 + 0.5 * (block - 1)),
                                                      ground.y_m(r0 + 0.5 * (block - 1))});
                        area_scale = 1.0 / (k * k);
                    }
                    Class& c = classes[std::size_t(first - wet_to.begin())];
                    ++c.nodes;
                    c.below += reference - double(z[n]);
                    c.true_nodes += area_scale;
                    c.true_below += area_scale * (reference - double(z[n]));
                    c.lowest = std::min(c.lowest, z[n]);
                    c.low = {std::min(c.low.col, col), std::min(c.low.row, row)};
                    c.high = {std::max(c.high.col, col), std::max(c.high.row, row)};
                    bool edge =
                        col == 0 || row == 0 || col + 1 == z.size.cols || row + 1 == z.size.rows;
                    each_neighbour(z.size, n, [&](Node m) { edge |= std::isnan(z[m]); });
                    c.edge |= edge;
                }
        }

    out.stages.resize(order.size());
    const double cell = ground.spacing_m * ground.spacing_m;
    Class sum;
    for (std::size_t k = 0; k < order.size(); ++k) {
        progress.report(0.4 + 0.6 * double(k) / double(order.size()), "measuring levels");
        const Class& c = classes[k];
        sum.nodes += c.nodes;
        sum.below += c.below;
        sum.true_nodes += c.true_nodes;
        sum.true_below += c.true_below;
        sum.lowest = std::min(sum.lowest, c.lowest);
        sum.edge |= c.edge;
        sum.low = {std::min(sum.low.col, c.low.col), std::min(sum.low.row, c.low.row)};
        sum.high = {std::max(sum.high.col, c.high.col), std::max(sum.high.row, c.high.row)};
        Stage& s = out.stages[order[k]];
        s.level_m = levels_m[order[k]];
        const double rise = double(static_cast<float>(s.level_m)) - reference;
        s.area_m2 = double(sum.nodes) * cell;
        s.true_area_m2 = sum.true_nodes * cell;
        s.open_at_edge = sum.edge;
        if (lake.bed != Bed::unknown) {
            s.volume_m3 = std::max(0.0, (sum.below + rise * double(sum.nodes)) * cell);
            s.true_volume_m3 = std::max(0.0, (sum.true_below + rise * sum.true_nodes) * cell);
            s.max_depth_m = sum.nodes ? reference + rise - double(sum.lowest) : 0.0;
            s.mean_depth_m = sum.nodes ? *s.volume_m3 / s.area_m2 : 0.0;
        }
        if (sum.nodes == 0)
            continue;
        const Box box{sum.low, sum.high};
        for (int row = box.first.row; row <= box.second.row; ++row)
            for (int col = box.first.col; col <= box.second.col; ++col)
                mask[{col, row}] = wets[{col, row}] <= wet_to[k];
        s.shoreline_m =
            shoreline_length_m(s.level_m, surface, mask, 1, box, lake.bed == Bed::unknown);
        s.islands = count_islands(mask, 1, box);
        s.pools = count_pools(mask, box);
    }
    return out;
}

} // namespace tarn::dem
