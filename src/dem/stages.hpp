#pragma once
/// @file stages.hpp  Area, volume, depths and shore of one lake at many levels.
///
/// Below its own level a lake shrinks within its bed: every node of its bed that lies below the
/// level counts, whether or not a sill parts it from the deepest pool, as storage tables count.
/// Above, it spreads over what rising water reaches from it, always by the lowest way.
#include "core/heightfield.hpp"
#include "core/lake_record.hpp"
#include "core/progress.hpp"
#include "dem/marks.hpp"
#include "geo/frame_data.hpp"

#include <optional>
#include <span>
#include <vector>

namespace tarn::dem {

struct Stage {
    double level_m = 0.0;
    double area_m2 = 0.0, true_area_m2 = 0.0; ///< in the projection; on the ellipsoid
    std::optional<double> volume_m3, true_volume_m3, max_depth_m, mean_depth_m; ///< bed known
    double shoreline_m = 0.0;
    int islands = 0;
    int pools = 0;             ///< parts (8-connected) that the water has
    bool open_at_edge = false; ///< water leaves the data: area and volume are of what is inside
};

struct StageTable {
    std::vector<Stage> stages;      ///< in the order of the levels asked for
    std::optional<LakeSpill> spill; ///< how far the lake may rise, and where it leaves then
};

/// @param heights_m  exact heights, NaN outside the data; same grid as ground and water
/// @param lake       one of the scene's
/// @param neighbours over which rising water spreads: 8 as everywhere in tarn, or 4
/// @param levels_m   1 to 10000 of them, in any order
/// @throws tarn::Error      if the bed is unknown and a level lies below the lake's
/// @throws tarn::Cancelled
StageTable stage_table(const Grid<float>& heights_m, const Heightfield& ground,
                       const Heightfield& water, const geo::Frame& frame, const LakeRecord& lake,
                       std::span<const double> levels_m, int neighbours, const Progress& progress);

} // namespace tarn::dem
