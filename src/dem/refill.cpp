#include "dem/refill.hpp"

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/text.hpp"
#include "dem/fill.hpp"
#include "dem/flat.hpp"
#include "dem/statistics.hpp"
#include "dem/water.hpp"
#include "dem/wetting.hpp"
#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::dem {

namespace {

constexpr int block = 32;             // nodes a side; the scale factor varies over kilometres
constexpr double least_depth_m = 0.1; // of the water that is left at the lowest level

bool at_edge(const Grid<float>& z, Node n) {
    bool edge = n.col == 0 || n.row == 0 || n.col + 1 == z.size.cols || n.row + 1 == z.size.rows;
    each_neighbour(z.size, n, [&](Node m) { edge |= std::isnan(z[m]); });
    return edge;
}

} // namespace

Refill::Refill(Grid<float> heights_m, const Heightfield& ground, const Heightfield& water,
               const geo::Frame& frame, const std::vector<LakeRecord>& lakes, int lake_id,
               const Progress& progress)
    : z_(std::move(heights_m)), ground_(ground), frame_(frame), lakes_(lakes) {
    const auto found = std::find_if(lakes.begin(), lakes.end(),
                                    [&](const LakeRecord& l) { return l.id == lake_id; });
    if (found == lakes.end())
        throw Error(text("there is no lake ", lake_id, " in the scene; it has lakes ",
                         lakes.front().id, " to ", lakes.back().id),
                    "tarn info lists them");
    lake_ = std::size_t(found - lakes.begin());
    progress.report(0.0, "following the water");
    others_ = LakeOf(z_.size);
    for (std::size_t k = 0; k < lakes_.size(); ++k)
        if (k != lake_)
            add_footprint(ground, water, lakes_[k], int(k) + 1, others_);
    lake_of_ = others_;
    add_footprint(ground, water, lakes_[lake_], mark(), lake_of_);
    wets_ = wetting_heights(z_, lake_of_, mark(), lake().level_m, never_wet, 8);

    progress.report(0.7, "summing up");
    const int across = (z_.size.cols + block - 1) / block;
    const int down = (z_.size.rows + block - 1) / block;
    blocks_ = Grid<Block>({across, down});
    std::vector<float> lowest(std::size_t(down), never_wet), highest(std::size_t(down), -never_wet),
        edge(std::size_t(down), never_wet);
    share_out(down, 0, [&](int first, int last) {
        for (int r = first; r < last; ++r)
            for (int c = 0; c < across; ++c) {
                Block& b = blocks_[{c, r}];
                b.first = b.lowest = never_wet;
                b.last = -never_wet;
                for (int row = r * block; row < std::min((r + 1) * block, z_.size.rows); ++row)
                    for (int col = c * block; col < std::min((c + 1) * block, z_.size.cols);
                         ++col) {
                        const Node n{col, row};
                        const float wets = wets_[n];
                        if (wets == never_wet) {
                            b.last = never_wet;
                            continue;
                        }
                        ++b.nodes;
                        b.below += lake().level_m - double(z_[n]);
                        b.first = std::min(b.first, wets);
                        b.last = std::max(b.last, wets);
                        b.lowest = std::min(b.lowest, z_[n]);
                        if (int(lake_of_[n]) == mark())
                            lowest[std::size_t(r)] = std::min(lowest[std::size_t(r)], z_[n]);
                        if (wets < edge[std::size_t(r)] && at_edge(z_, n))
                            edge[std::size_t(r)] = wets;
                        highest[std::size_t(r)] = std::max(highest[std::size_t(r)], wets);
                    }
                if (b.nodes == 0)
                    continue;
                const double k =
                    geo::scale_factor(frame_, {ground_.x_m(c * block + 0.5 * (block - 1)),
                                               ground_.y_m(r * block + 0.5 * (block - 1))});
                b.area_scale = 1.0 / (k * k);
            }
    });
    const float leaves = *std::min_element(edge.begin(), edge.end());
    if (leaves != never_wet)
        spill_m_ = std::max(double(leaves), lake().level_m);
    highest_m_ =
        std::max(lake().level_m, double(*std::max_element(highest.begin(), highest.end())));
    lowest_m_ =
        lake().bed == Bed::unknown
            ? lake().level_m
            : std::min(lake().level_m,
                       double(*std::min_element(lowest.begin(), lowest.end())) + least_depth_m);
    for (const FlatSurface& flat : find_flats(z_))
        if (wets_[flat.middle] <= flat.level_m)
            flats_.emplace_back(flat.level_m, wets_[flat.middle]);
}

float Refill::wet_to(double level_m) const {
    const auto level = static_cast<float>(level_m);
    return highest_wet(level_m, std::any_of(flats_.begin(), flats_.end(), [&](const auto& flat) {
                           return flat.first == level; // a surface that it reaches
                       }));
}

void Refill::check(double level_m) const {
    if (level_m >= lowest_m_ - 0.0005 && level_m <= highest_m_)
        return;
    if (lake().bed == Bed::unknown && level_m < lowest_m_)
        throw Error(text("the bed of lake ", lake().id, " is unknown: it cannot be shown at ",
                         level_m, " m, below its surface at ", fixed(lake().level_m, 2), " m"),
                    "import with --bathymetry, --soundings or --estimate-depth");
    throw Error(text("lake ", lake().id, " cannot stand at ", level_m, " m: its bed and shores ",
                     "reach from ", fixed(lowest_m_, 2), " to ", fixed(highest_m_, 2), " m"),
                "choose a level in between");
}

WaterFigures Refill::figures(double level_m) const {
    check(level_m);
    const float limit = wet_to(level_m);
    struct Sum {
        double nodes = 0.0, below = 0.0, true_nodes = 0.0, true_below = 0.0;
        float lowest = never_wet;
    };
    std::vector<Sum> rows(std::size_t(blocks_.size.rows));
    const double reference = lake().level_m;
    share_out(blocks_.size.rows, 0, [&](int first, int last) {
        for (int r = first; r < last; ++r)
            for (int c = 0; c < blocks_.size.cols; ++c) {
                const Block& b = blocks_[{c, r}];
                if (b.nodes == 0 || b.first > limit)
                    continue;
                std::size_t nodes = b.nodes;
                double below = b.below;
                float low = b.lowest;
                if (b.last > limit) {
                    nodes = 0;
                    below = 0.0;
                    low = never_wet;
                    for (int row = r * block; row < std::min((r + 1) * block, z_.size.rows); ++row)
                        for (int col = c * block; col < std::min((c + 1) * block, z_.size.cols);
                             ++col)
                            if (const Node n{col, row}; wets_[n] <= limit) {
                                ++nodes;
                                below += reference - double(z_[n]);
                                low = std::min(low, z_[n]);
                            }
                }
                Sum& s = rows[std::size_t(r)];
                s.nodes += double(nodes);
                s.below += below;
                s.true_nodes += b.area_scale * double(nodes);
                s.true_below += b.area_scale * below;
                s.lowest = std::min(s.lowest, low);
            }
    });
    Sum sum;
    for (const Sum& s : rows)
        sum = {sum.nodes + s.nodes, sum.below + s.below, sum.true_nodes + s.true_nodes,
               sum.true_below + s.true_below, std::min(sum.lowest, s.lowest)};
    const double cell = ground_.spacing_m * ground_.spacing_m;
    const double rise = double(static_cast<float>(level_m)) - reference;
    WaterFigures out;
    out.level_m = level_m;
    out.area_m2 = sum.nodes * cell;
    out.true_area_m2 = sum.true_nodes * cell;
    out.open_at_edge = spill_m_ && limit >= static_cast<float>(*spill_m_);
    if (lake().bed != Bed::unknown) {
        out.volume_m3 = std::max(0.0, (sum.below + rise * sum.nodes) * cell);
        out.true_volume_m3 = std::max(0.0, (sum.true_below + rise * sum.true_nodes) * cell);
        out.max_depth_m = sum.nodes > 0.0 ? reference + rise - double(sum.lowest) : 0.0;
        out.mean_depth_m = sum.nodes > 0.0 ? *out.volume_m3 / out.area_m2 : 0.0;
    }
    return out;
}

std::vector<WaterFigures> Refill::curve(int count, double up_to_m) const {
    std::vector<WaterFigures> out;
    const double top = std::clamp(up_to_m, lowest_m_, highest_m_);
    for (int i = 0; i < count; ++i)
        out.push_back(
            figures(std::min(top, lowest_m_ + (top - lowest_m_) * i / std::max(1, count - 1))));
    return out;
}

std::vector<std::size_t> Refill::drowned(double level_m) const {
    std::vector<std::size_t> out;
    const float limit = wet_to(level_m);
    for (std::size_t k = 0; k < lakes_.size(); ++k)
        if (k != lake_ && lakes_[k].level_m <= level_m && wets_[lakes_[k].seed] <= limit)
            out.push_back(k);
    return out;
}

std::optional<Grid<std::uint8_t>> Refill::exposed_bed() const {
    Grid<std::uint8_t> out(z_.size);
    const auto own = static_cast<std::uint16_t>(mark());
    const auto level = static_cast<float>(lake().level_m); // its own nodes get wet below it
    std::vector<char> any(std::size_t(z_.size.rows), 0);
    share_out(z_.size.rows, 0, [&](int first, int last) {
        for (int row = first; row < last; ++row) {
            const std::size_t start = out.index({0, row});
            for (std::size_t i = start; i < start + std::size_t(z_.size.cols); ++i)
                if (wets_.values[i] < level && lake_of_.values[i] != own) {
                    out.values[i] = 255;
                    any[std::size_t(row)] = 1;
                }
        }
    });
    if (std::find(any.begin(), any.end(), 1) == any.end())
        return std::nullopt;
    return out;
}

void Refill::fill(double level_m, Heightfield& ground, Heightfield& water,
                  std::vector<LakeRecord>& lakes, bool shore) {
    const WaterFigures found = figures(level_m);
    const float limit = wet_to(level_m);
    // Whose nodes the rising water may take: dry ones, and those of lakes that stand no higher.
    std::vector<unsigned char> taken(lakes_.size() + 1, 0), gone(lakes_.size() + 1, 0);
    taken[0] = 1;
    std::vector<double> levels;
    for (std::size_t k = 0; k < lakes_.size(); ++k) {
        taken[k + 1] = lakes_[k].level_m <= level_m;
        levels.push_back(k == lake_ ? level_m : lakes_[k].level_m);
    }
    for (const std::size_t k : drowned(level_m))
        gone[k + 1] = 1;
    const auto own = static_cast<std::uint16_t>(mark());
    const GridSize size = z_.size;
    const auto cols = std::size_t(size.cols);
    share_out(size.rows, 0, [&](int first, int last) {
        for (std::size_t i = std::size_t(first) * cols; i < std::size_t(last) * cols; ++i) {
            const std::uint16_t other = others_.values[i];
            if (wets_.values[i] <= limit && taken[other])
                lake_of_.values[i] = own;
            else
                lake_of_.values[i] = gone[other] ? std::uint16_t(0) : other;
        }
    });
    part_lakes(lake_of_, levels); // where there are several

    // The moved lake's level first, so that it is met whatever the step of the codes.
    std::vector<double> ordered = levels;
    std::swap(ordered[0], ordered[lake_]);
    Heightfield empty = empty_water(ground_, ordered);
    for (double& level : levels)
        level = drawn_level_m(empty, level);
    if (!(ground.codes.size == size))
        ground = ground_;
    water = std::move(empty);
    pour(ground_, lake_of_, levels, ground, water);

    lakes.clear();
    for (std::size_t k = 0; k < lakes_.size(); ++k)
        if (!gone[k + 1])
            lakes.push_back(lakes_[k]);
    LakeRecord& moved = *std::find_if(
        lakes.begin(), lakes.end(), [&](const LakeRecord& l) { return l.id == lakes_[lake_].id; });
    moved.level_m = level_m;
    moved.area_m2 = found.area_m2;
    moved.true_area_m2 = found.true_area_m2;
    moved.volume_m3 = found.volume_m3;
    moved.true_volume_m3 = found.true_volume_m3;
    moved.max_depth_m = found.max_depth_m;
    moved.mean_depth_m = found.mean_depth_m;
    moved.open_at_edge = found.open_at_edge;
    Node low{size.cols, size.rows}, high{-1, -1}, deepest = moved.seed;
    float least = never_wet;
    for (int r = 0; r < blocks_.size.rows; ++r)
        for (int c = 0; c < blocks_.size.cols; ++c) {
            const Block& b = blocks_[{c, r}];
            if (b.nodes == 0 || b.first > limit)
                continue;
            // Blocks inside the box so far can only bring a deeper place.
            const bool within = c * block >= low.col && (c + 1) * block <= high.col &&
                                r * block >= low.row && (r + 1) * block <= high.row;
            if (within && b.lowest >= least)
                continue;
            for (int row = r * block; row < std::min((r + 1) * block, size.rows); ++row)
                for (int col = c * block; col < std::min((c + 1) * block, size.cols); ++col) {
                    const Node n{col, row};
                    if (lake_of_[n] != own)
                        continue;
                    low = {std::min(low.col, col), std::min(low.row, row)};
                    high = {std::max(high.col, col), std::max(high.row, row)};
                    if (z_[n] < least) {
                        least = z_[n];
                        deepest = n;
                    }
                }
        }
    moved.west_north = low;
    moved.east_south = high;
    moved.seed = deepest;
    if (shore) {
        const Surface surface{z_, ground_.spacing_m, ground_.west_m, ground_.north_m};
        const int id = moved.id;
        moved.id = mark();
        measure(moved, surface, lake_of_, {low, high}, frame_);
        Marks marks(size);
        moved.parts = parts_of(lake_of_, marks, moved.id, {low, high});
        moved.id = id;
        // A lake stays where it was while that place is wet: so does the sun above it.
        if (const LakeRecord& was = lakes_[lake_]; lake_of_[was.seed] == own) {
            moved.seed = was.seed;
            moved.position = was.position;
        }
    } else {
        moved.parts = {deepest};
    }
}

} // namespace tarn::dem
