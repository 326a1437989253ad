#pragma once
/// @file voids.hpp  Nodes without data: told apart, filled for the eye, never flooded from outside.
#include "core/grid.hpp"
#include "dem/marks.hpp"

#include <cstdint>

namespace tarn::dem {

struct VoidCount {
    std::uint64_t all = 0;    ///< nodes without data
    std::uint64_t inside = 0; ///< of these, enclosed by data: interpolated
};

/// Replaces every NaN and marks where it was: enclosed voids (mark::filled) by inverse-distance
/// interpolation from their rim (GDALFillNodata, up to 100 nodes; the middle of wider ones gets the
/// lowest height around it), voids open to the edge (mark::outside) likewise and beyond that by the
/// lowest height there is.
/// @param marks  same size as the grid
/// @throws tarn::Error  if there is no data at all
VoidCount fill_voids(Grid<float>& elevation_m, Marks& marks);

/// The interpolation alone: fills NaN nodes where data lie within `reach` nodes.
void interpolate_voids(Grid<float>& values, int reach);

} // namespace tarn::dem
