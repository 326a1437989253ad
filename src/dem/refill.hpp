#pragma once
/// @file refill.hpp  A scene's lake at another level, as often as somebody moves it.
///
/// The rule is that of stages.hpp: below its own level the lake shrinks within its bed, above it
/// spreads by the lowest way. Figures are sums over exact heights, as `tarn stats` counts them.
#include "core/heightfield.hpp"
#include "core/lake_record.hpp"
#include "core/progress.hpp"
#include "dem/marks.hpp"
#include "geo/frame_data.hpp"

#include <optional>
#include <vector>

namespace tarn::dem {

/// What the water holds at a level.
struct WaterFigures {
    double level_m = 0.0;
    double area_m2 = 0.0, true_area_m2 = 0.0; ///< in the projection; on the ellipsoid
    std::optional<double> volume_m3, true_volume_m3, max_depth_m, mean_depth_m; ///< bed known
    bool open_at_edge = false; ///< water leaves the data: figures are of what is inside
};

class Refill {
public:
    /// @param heights_m  exact heights, NaN outside the data; same grid as ground and water
    /// @param ground, water, lakes  as the scene holds them
    /// @param lake_id    the lake that moves
    /// @throws tarn::Error      if there is no such lake
    /// @throws tarn::Cancelled
    Refill(Grid<float> heights_m, const Heightfield& ground, const Heightfield& water,
           const geo::Frame& frame, const std::vector<LakeRecord>& lakes, int lake_id,
           const Progress& progress);

    /// Levels that can be asked for: from a hand's breadth of water (or its surface, where the bed
    /// is unknown) to the highest ground that its water reaches.
    double lowest_m() const { return lowest_m_; }
    double highest_m() const { return highest_m_; }
    /// The lake as the scene was made.
    const LakeRecord& lake() const { return lakes_[lake_]; }
    /// Level at which water begins to leave the data; nothing if no edge is reached.
    std::optional<double> spill_m() const { return spill_m_; }
    const Grid<float>& heights_m() const { return z_; }

    /// @throws tarn::Error  unless level_m lies within [lowest_m(), highest_m()]
    WaterFigures figures(double level_m) const;
    /// At `count` levels, evenly from lowest_m() to `up_to_m`.
    std::vector<WaterFigures> curve(int count, double up_to_m) const;

    /// Moves the water. Ground beside the shore is rounded to the side that the fill decided
    /// (water.hpp).
    /// @param ground, water  written: as an import at this level would give them
    /// @param lakes          the moved lake with new figures, box and seed; lakes that it drowned
    ///                       are gone
    /// @param shore          count shoreline and islands, too, and find the middle of the lake: the
    ///                       slower half, not for every step of a slider
    /// @throws as figures()
    void fill(double level_m, Heightfield& ground, Heightfield& water,
              std::vector<LakeRecord>& lakes, bool shore);

    /// Where the lake stood as the scene was made and does not after the last fill(): 255, else 0.
    /// Nothing if there is no such node.
    std::optional<Grid<std::uint8_t>> exposed_bed() const;

    /// Nodes of the moved lake as the last fill() left them are those with this mark.
    const LakeOf& lake_of() const { return lake_of_; }
    int mark() const { return int(lake_) + 1; }

private:
    /// Sums over blocks of nodes, so that only blocks on the shore are looked into.
    struct Block {
        float first = 0, last = 0, lowest = 0; ///< wetting heights; the lowest ground
        std::size_t nodes = 0;                 ///< that water reaches at all
        double below = 0.0;                    ///< sum of the lake's level minus ground
        double area_scale = 1.0;
    };
    float wet_to(double level_m) const;
    void check(double level_m) const;
    std::vector<std::size_t> drowned(double level_m) const;

    Grid<float> z_, wets_;
    Heightfield ground_;
    geo::Frame frame_;
    std::vector<LakeRecord> lakes_;
    std::size_t lake_ = 0;
    LakeOf others_;  ///< of all lakes but the moved one: index in lakes_ plus one
    LakeOf lake_of_; ///< the same with it, as filled last
    Grid<Block> blocks_;
    std::vector<std::pair<float, float>> flats_; ///< levels of flat surfaces, when they get wet
    double lowest_m_ = 0.0, highest_m_ = 0.0;
    std::optional<double> spill_m_;
};

} // namespace tarn::dem
