#pragma once
/// @file fetch.hpp  Over how much open water the wind has blown before it reaches a place.
///
/// Shape   a grid of squares, row 0 north; a square is open water where at least half of it is wet.
/// Source  effective fetch of narrow water: mean over directions up to 42 degrees from the wind's,
///         projected on it, weighted by the cosine (Saville 1954; Shore Protection Manual 1984).
#include "core/heightfield.hpp"

#include <vector>

namespace tarn::waves {

/// Open water of a scene, coarser than its grid.
struct WaterMask {
    Grid<std::uint8_t> open;            ///< 1 = at least half of the square is water
    Grid<float> wet_share;              ///< of the square, [0, 1]
    Grid<float> depth_m;                ///< mean of the wet part; 0 where all is dry
    double side_m = 1.0;                ///< of a square
    double west_m = 0.0, north_m = 0.0; ///< outer corner of square (0, 0)
};

/// @param most  squares a side at most, >= 2
WaterMask water_mask(const Heightfield& ground, const Heightfield& water, int most = 256);

/// Straight open water upwind of a square [m], 0 on land. The edge of the data ends it.
/// @param from_deg  where the wind comes from, clockwise from grid north
double straight_fetch_m(const WaterMask& mask, Node square, double from_deg);

/// Effective fetch of every square with any water [m], at least half a square; one with less than
/// half has what the open squares beside it have, or where there is none its own extent.
Grid<float> effective_fetch_m(const WaterMask& mask, double from_deg);

} // namespace tarn::waves
