#pragma once
/// @file cone_map.hpp
/// For each block of cells the cone of air above it: how far a ray may go before the surface could
/// be met. Conservative for the BILINEAR surface, not only at its nodes.
///
/// Bound   for every place q of the surface and every block C of 2^shift x 2^shift cells
///             height(q) <= top(C) + slope(C) * d(q, C),    d = |columns| + |rows| to the block.
///         and
///             height(q) <= top(C)    wherever d(q, C) <= free(C):
///         over a lake a ray may come down to the water's level at once, however steep the shores.
///         So a ray at height z somewhere above C that moves `l` columns plus rows and sinks `s`
///         per metre of path meets nothing before (z - top) / (slope * l + s) metres, nor before
///         the lesser of (z - top) / s and free / l.
/// Proof   In each cell d is linear in the column and linear in the row, for the block's border
///         runs along grid lines; so is, along each grid line, the bilinear surface. Where a bound
///         holds at the four nodes it therefore holds in the whole cell. With the Euclidean
///         distance of published cone maps it does not: that distance is convex, lies BELOW its
///         interpolation between nodes, and the surface may stick out of a cone that all nodes
///         keep.
/// Source  cone step mapping: Dummer 2006; the bound and its computation are our own. A slope s is
///         good for C if the L1 dilation max_q(height(q) - s d(p, q)) does not rise above top(C) on
///         any node p of C; a dilation is two sweeps along rows and columns, so a ladder of slopes
///         costs time linear in the nodes. The least good step of the ladder is kept.
#include "core/heightfield.hpp"

#include <cstdint>
#include <vector>

namespace tarn {

struct ConeMap {
    int shift = 0;       ///< blocks are 2^shift cells a side
    GridSize blocks;     ///< the last ones may reach beyond the field
    double offset_m = 0; ///< elevation of code 0
    double scale_m = 1;  ///< metres per code, of tops
    double slope_m = 0;  ///< steepest slope [m per cell]; others are (code / 65535)^2 of it
    /// Two codes a block, row by row: its top, and its slope with more in the lower eight bits,
    /// which only make it steeper: bit 0: there is water in the block or within three cells of it;
    /// bits 1 to 7: a quarter of the free distance in cells.
    std::vector<std::uint16_t> texels;

    double top_m(std::size_t block) const { return offset_m + scale_m * texels[2 * block]; }
    double slope_m_per_cell(std::size_t block) const {
        const double share = texels[2 * block + 1] / 65535.0;
        return slope_m * share * share;
    }
    int free_cells(std::size_t block) const { return 4 * (texels[2 * block + 1] % 256 / 2); }
    bool water_near(std::size_t block) const { return texels[2 * block + 1] % 2 != 0; }
};

/// @param ground   at least 2 x 2 nodes
/// @param water    null, or a field of the same size: the surface is then the higher of the two
///                 wherever there is water (a node without it counts as ground)
/// @param shift    [0, 4]
/// @param threads  0: all cores
ConeMap cone_map(const Heightfield& ground, const Heightfield* water, int shift, int threads = 0);

} // namespace tarn
