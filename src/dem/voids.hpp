#pragma once
/// @file voids.hpp  Nodes without data: told apart, filled for the eye, never flooded from outside.
#include "core/grid.hpp"

#include <cstdint>

namespace tarn::dem {

struct Voids {
    Grid<unsigned char> outside; ///< 1 where a void is open to the grid's edge
    Grid<unsigned char> filled;  ///< 1 where an enclosed void was interpolated
    std::uint64_t count = 0;     ///< all void nodes
    std::uint64_t inside = 0;    ///< of these, enclosed by data: interpolated
};

/// Replaces every NaN: enclosed voids by inverse-distance interpolation from their rim
/// (GDALFillNodata, up to 100 nodes; the middle of wider ones gets the lowest height around it),
/// open ones likewise and beyond that by the lowest height there is.
/// @throws tarn::Error  if there is no data at all
Voids fill_voids(Grid<float>& elevation_m);

/// The interpolation alone: fills NaN nodes where data lie within `reach` nodes.
void interpolate_voids(Grid<float>& values, int reach);

} // namespace tarn::dem
