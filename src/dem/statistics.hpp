#pragma once
/// @file statistics.hpp  Area, volume, depths, shoreline and islands, from the nodes that are
///                       drawn; and how they change with the level.
#include "core/grid.hpp"
#include "core/lake_record.hpp"
#include "dem/marks.hpp"
#include "geo/frame_data.hpp"

#include <utility>
#include <vector>

namespace tarn::dem {

/// Heights and where their nodes lie in the scene.
struct Surface {
    const Grid<float>& elevation_m;
    double spacing_m = 0.0;
    double west_m = 0.0, north_m = 0.0; ///< scene position of node (0, 0)
};

using Box = std::pair<Node, Node>; ///< north-west and south-east node, inclusive
using Boxes = std::vector<Box>;

/// The boxes around lakes 1 ... count.
Boxes boxes_of(const LakeOf& lakes, int count);

/// Fills areas, shoreline_m, islands, position, seed, the box and, unless record.bed is unknown,
/// volumes and depths of `record` (whose id, level_m and bed are given).
///
/// Source  area and volume are cell sums, as GIS storage tools give them: n * s^2 and
///         sum(level - ground) * s^2, in the grid's projection. The true ones divide each node's
///         share by the square of the projection's scale factor there. The shoreline is the zero
///         curve of ground minus level, one straight piece a cell edge pair (marching squares).
void measure(LakeRecord& record, const Surface& ground, const LakeOf& lakes, const Box& box,
             const geo::Frame& frame);

/// A node of each connected part of lake `id` (8 neighbours). Leaves mark::seen on its nodes.
std::vector<Node> parts_of(const LakeOf& lakes, Marks& marks, int id, const Box& box);

/// Length of the curve between lake `id` and the land around and in it.
/// @param midway  between a wet and a dry node it runs half way, whatever the heights: of water
///                whose surface is all that the data hold
double shoreline_length_m(double level_m, const Surface& ground, const LakeOf& lakes, int id,
                          const Box& box, bool midway);

/// Dry parts inside the box (widened by one) that its rim cannot reach by 4-neighbour steps.
int count_islands(const LakeOf& lakes, int id, const Box& box);

} // namespace tarn::dem
