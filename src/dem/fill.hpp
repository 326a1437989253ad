#pragma once
/// @file fill.hpp  Where the water stands: connection from a seed, as water would fill.
///
/// A node is wet when it lies at or below the level and is reached from the seed over such nodes
/// by 8-neighbour steps (GRASS r.lake's rule). A basin that is lower but not reached stays dry.
#include "core/grid.hpp"

#include <optional>
#include <vector>

namespace tarn::dem {

/// Heights within this of the level count as at the level: float32 files hold 1882.01 as
/// 1882.0100098, and no survey knows half a millimetre.
inline constexpr double level_tolerance_m = 0.0005;

inline bool at_or_below(float elevation_m, double level_m) {
    return double(elevation_m) <= level_m + level_tolerance_m; // false for NaN
}

struct Basin {
    std::size_t nodes = 0;
    std::size_t at_level = 0;  ///< nodes within half a metre of the level: a water surface
    Node seed;                 ///< its lowest node
    bool open_at_edge = false; ///< touches the grid's edge or a node in `outside`
};

/// Wet mask (1 = wet) reached from `seed`.
/// @param outside  1 where there is no data: never wet; reaching it makes the lake open
/// @param floor_m  nodes below it stay dry: a lake found as a flat surface does not run out over a
///                 dam that the grid is too coarse to show
/// @throws tarn::Error  if the seed lies above the level
Grid<unsigned char> fill_from(const Grid<float>& elevation_m, const Grid<unsigned char>& outside,
                              double level_m, Node seed, bool* open_at_edge = nullptr,
                              double floor_m = -1e30);

/// Every 8-connected region at or below the level, largest first.
std::vector<Basin> find_basins(const Grid<float>& elevation_m, const Grid<unsigned char>& outside,
                               double level_m);

/// The basin that people would call the lake: the largest that is closed, or that is open at the
/// data's edge but for the greater part a water surface at this very level.
std::optional<Basin> largest_lake(const std::vector<Basin>& basins);

/// Nearest node at or below the level within `reach` nodes of `from`.
std::optional<Node> nearest_wet(const Grid<float>& elevation_m, const Grid<unsigned char>& outside,
                                double level_m, Node from, int reach);

} // namespace tarn::dem
