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

#include <span>

namespace tarn::dem {

struct WetLake {
    double level_m = 0.0;
    Grid<unsigned char> wet; ///< 1 = wet
};

/// Rounds ground codes beside the shore to the side that the fill decided.
/// @return the number of dry nodes that had to be raised by more than one code (no-data margins)
std::size_t separate(Heightfield& ground, const WetLake& lake);

/// The water heightfield of some lakes; levels are met within 1 mm or the closest 16 bits can do.
/// @param ground  gives size, spacing and place
Heightfield water_surface(const Heightfield& ground, std::span<const WetLake> lakes);

} // namespace tarn::dem
