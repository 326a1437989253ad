#pragma once
/// @file statistics.hpp  Area, volume, depths, shoreline and islands, from the nodes that are
/// drawn.
#include "core/heightfield.hpp"
#include "core/lake_record.hpp"
#include "geo/frame_data.hpp"

namespace tarn::dem {

/// Fills area_m2, true_area_m2, shoreline_m, islands, position, seed, the box and, unless
/// record.bed is unknown, the depth figures of `record` (whose level_m and bed are given).
///
/// @param wet  1 for the lake's nodes; at least one
/// Source  area and volume are cell sums, as GIS storage tools give them: n * s^2 and
///         sum(level - ground) * s^2. true_area_m2 divides each node's share by the square of the
///         projection's scale factor. The shoreline is the zero curve of ground minus level, one
///         straight piece a cell edge pair (marching squares).
void measure(LakeRecord& record, const Heightfield& ground, const Grid<unsigned char>& wet,
             const geo::Frame& frame);

} // namespace tarn::dem
