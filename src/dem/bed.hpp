#pragma once
/// @file bed.hpp  What lies under the water: a bathymetry raster, or room for water of unknown
/// depth.
#include "core/grid.hpp"

#include <string>
#include <vector>

namespace tarn::dem {

/// What the values of a bathymetry raster mean.
enum class BathymetryKind { automatic, elevation, depth };

/// Merges a bathymetry into the ground inside the lake.
///
/// Nodes of the lake's surface that the raster does not cover (the rim between survey and shore,
/// mostly) are interpolated between the survey and the shoreline, where the depth is 0: no cliff.
/// @param wet         the lake at its level
/// @param surface     the part of it whose ground the DEM does not know: where it is flat, or all
/// of it
/// @param surface_m   height of that surface, from which depths count
/// @param bathymetry  on the same grid, NaN where not surveyed; depths of either sign
/// @return  sentences for the report: how the values were read, how many nodes they changed
/// @throws tarn::Error  if no value lies inside the lake
std::vector<std::string> merge_bathymetry(Grid<float>& elevation_m, const Grid<unsigned char>& wet,
                                          const Grid<unsigned char>& surface, double surface_m,
                                          Grid<float> bathymetry, BathymetryKind kind);

/// Where the DEM holds the water's surface itself, lowers the lake's nodes so that water has
/// room. At the rim by as much as the dry neighbours stand above the level, so that the drawn
/// shore runs midway between the last wet and the first dry node, as cell sums assume; inside by
/// a nominal 5 m. NOT a depth: the lake's bed is reported as unknown and drawn as unseen.
/// @return the number of nodes lowered
std::size_t make_room(Grid<float>& elevation_m, const Grid<unsigned char>& wet,
                      const Grid<unsigned char>& flat, double level_m);

} // namespace tarn::dem
