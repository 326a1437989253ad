#pragma once
/// @file flat.hpp  Water surfaces in an elevation model: connected nodes of one and the same
/// height.
///
/// Most DEMs hold a lake as a flat surface. A run of equal nodes is taken for water when it is
/// large (64 nodes or more) and has an interior (9 nodes whose eight neighbours are equal too):
/// whole-metre models have long thin runs of equal height along every gentle slope.
#include "core/grid.hpp"

#include <vector>

namespace tarn::dem {

struct FlatSurface {
    float level_m = 0.0f;
    std::size_t nodes = 0;
    Node deepest;              ///< the node farthest (in steps) from the surface's edge
    bool touches_edge = false; ///< of the grid, or of the data
};

/// All flat surfaces, largest first. NaN nodes belong to none.
std::vector<FlatSurface> find_flats(const Grid<float>& elevation_m);

/// Sets every node outside flat surfaces to NaN.
void keep_only_flats(Grid<float>& elevation_m);

/// One byte a node: 1 inside a flat surface.
Grid<unsigned char> flat_mask(const Grid<float>& elevation_m);

} // namespace tarn::dem
