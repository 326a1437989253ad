#pragma once
/// @file wetting.hpp  How high a lake must rise to wet each node: what stage tables and moved
///                    levels are made from.
#include "core/heightfield.hpp"
#include "core/lake_record.hpp"
#include "dem/marks.hpp"

#include <limits>

namespace tarn::dem {

/// Of a node that no rising water reaches.
inline constexpr float never_wet = std::numeric_limits<float>::infinity();

/// The nodes that a scene shows as this lake: `id`, on top of what `out` holds.
/// @param out  of the ground's size
void add_footprint(const Heightfield& ground, const Heightfield& water, const LakeRecord& lake,
                   int id, LakeOf& out);

/// For every node the height that water from the lake must reach to wet it: the least, over all
/// ways, of the highest ground on the way; never_wet beyond `up_to_m` and outside the data. Within
/// the lake that is the ground itself.
///
/// @param z          exact heights, NaN outside the data
/// @param lake       its nodes: those of `id`; others do not count
/// @param level_m    its level
/// @param neighbours over which water spreads: 8, or 4
/// Source  priority flood (Barnes, Lehman & Mulla 2014, Computers & Geosciences 62) with buckets by
///         height, each put in order when its turn comes: time linear in the nodes.
Grid<float> wetting_heights(const Grid<float>& z, const LakeOf& lake, int id, double level_m,
                            double up_to_m, int neighbours);

} // namespace tarn::dem
