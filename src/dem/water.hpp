#pragma once
/// @file water.hpp  Ground and water heightfields whose crossing is the shoreline.
///
/// Rule    every wet node carries its lake's level, and so does every dry node next to one (8
///         neighbours); all other nodes carry "no water". In a cell that touches water the water
///         is therefore flat at the level, and the shoreline is exactly the curve where the
///         bilinear ground crosses it. In every other cell the water lies below the ground at all
///         four nodes, and bilinear interpolation is a convex combination: no water can show.
///         For this to hold in 16 bits, ground codes of wet nodes are rounded to BELOW the level
///         and those of dry nodes beside them to ABOVE it.
#include "core/heightfield.hpp"
#include "dem/marks.hpp"

#include <span>

namespace tarn::dem {

/// An empty water heightfield on the ground's grid whose codes meet the levels best: the first
/// (the main lake's) within half a millimetre, the others as well as 16 bits over their range can.
Heightfield empty_water(const Heightfield& ground, std::span<const double> levels_m);

/// The level that `water` holds for `level_m`.
double drawn_level_m(const Heightfield& water, double level_m);

/// Dries nodes of a lake that touch a lake of another level: between two surfaces stands land,
/// even where the grid is too coarse to show it. Of the two, the higher lake loses its node.
/// @return how many nodes were dried
std::size_t part_lakes(LakeOf& lake_of, std::span<const double> levels_m);

/// Writes the lakes into `water` and rounds ground codes beside the shore to the side that the fill
/// decided; by all cores. A dry node between two lakes carries the lower level, so that nothing can
/// show above the land, and is raised above the higher one.
/// @param original  the ground as it was; `ground` becomes it, separated. The two may be one
/// @param levels_m  of lakes 1, 2, ... as drawn
/// @param water     of empty_water()
/// @return the number of dry nodes that had to be raised by more than one code (no-data margins,
///         dams that the grid does not show)
std::size_t pour(const Heightfield& original, const LakeOf& lake_of,
                 std::span<const double> levels_m, Heightfield& ground, Heightfield& water);

} // namespace tarn::dem
