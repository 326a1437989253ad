#pragma once
/// @file fill.hpp  Where the water stands: connection from a seed, as water would fill; and how far
///                 it may rise.
///
/// A node is wet when it lies below the level and is reached from the seed over such nodes by
/// 8-neighbour steps: GRASS r.lake's rule, compared in float32 as r.lake does and as files hold
/// heights. A basin that is lower but not reached stays dry. Where the DEM holds a flat water
/// surface at exactly the level, that surface is wet too: it IS the lake.
#include "core/grid.hpp"
#include "dem/marks.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace tarn::dem {

/// The greatest height that a level wets.
/// @param surface_at_level  the DEM holds a flat water surface at just this level
inline float highest_wet(double level_m, bool surface_at_level) {
    const auto level = static_cast<float>(level_m); // 1882.01 is the 1882.0100098 of a raster
    return surface_at_level ? level
                            : std::nextafter(level, -std::numeric_limits<float>::infinity());
}

struct Basin {
    std::size_t nodes = 0;
    std::size_t at_level = 0;  ///< nodes within half a metre of the level: a water surface
    Node seed;                 ///< its lowest node
    bool open_at_edge = false; ///< touches the grid's edge or a node without data outside
};

struct Filled {
    std::size_t nodes = 0;
    std::size_t at_level = 0;      ///< of these, at the very height of `highest_wet_m`
    std::size_t flat_at_level = 0; ///< of those, in a flat surface
    bool open_at_edge = false;
};

/// Sets lake_of to `id` on every dry node reached from the seeds.
/// @param floor_m  nodes below it stay dry: a lake found as a flat surface does not run out over a
///                 dam that the grid is too coarse to show
/// @throws tarn::Error  if a seed lies above the level or outside the data
Filled fill_from(const Grid<float>& elevation_m, const Marks& marks, float highest_wet_m,
                 std::span<const Node> seeds, int id, LakeOf& lake_of,
                 double floor_m = -std::numeric_limits<double>::infinity());

/// As fill_from() without a floor, but gives up as soon as the water leaves the data or runs into
/// another lake: then nothing is filled. It looks downhill first, so that it soon finds a way out
/// if there is one.
std::optional<Filled> fill_closed(const Grid<float>& elevation_m, const Marks& marks,
                                  float highest_wet_m, Node seed, int id, LakeOf& lake_of);

/// Takes the water away again that fill_from() gave.
void drain(LakeOf& lake_of, std::span<const Node> seeds);

/// Every 8-connected region that a level wets, largest first. Uses mark::seen.
std::vector<Basin> find_basins(const Grid<float>& elevation_m, Marks& marks, float highest_wet_m);

/// The basin that people would call the lake: the largest that is closed, or that is open at the
/// data's edge but for the greater part a water surface at this very level.
std::optional<Basin> largest_lake(const std::vector<Basin>& basins);

/// Nearest node that the level wets within `reach` nodes of `from`.
std::optional<Node> nearest_wet(const Grid<float>& elevation_m, const Marks& marks,
                                float highest_wet_m, Node from, int reach);

/// How water that rises from a lake leaves the data.
struct Spill {
    double level_m = 0.0;    ///< the highest ground on its way: the lake may rise to this
    Node pass;               ///< where that is
    Node exit;               ///< the node at the edge of the data where it leaves
    bool at_surface = false; ///< it need not rise: the edge of the data cuts the lake
};

/// Follows rising water, always over the lowest ground next to it, until it leaves the data; that
/// is the lowest pass (priority flood: Barnes, Lehman & Mulla 2014, Computers & Geosciences 62).
/// Uses mark::seen.
/// @param lake  its nodes; the water starts at `level_m`
/// @return nothing if no edge is reached below `up_to_m`
std::optional<Spill> find_spill(const Grid<float>& elevation_m, Marks& marks, const LakeOf& lake_of,
                                int id, double level_m);

/// As above, from a point: water that collects at `seed` and rises, at most to `up_to_m`.
std::optional<Spill> find_spill(const Grid<float>& elevation_m, Marks& marks, Node seed,
                                double up_to_m = std::numeric_limits<double>::infinity());

} // namespace tarn::dem
