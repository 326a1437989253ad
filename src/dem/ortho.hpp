#pragma once
/// @file ortho.hpp  An aerial picture in any CRS -> RGBA in the scene's frame.
#include "core/heightfield.hpp"
#include "core/image.hpp"
#include "dem/source.hpp"
#include "geo/frame_data.hpp"

namespace tarn::dem {

/// Warps the part of the picture that lies over the scene, at its own resolution or as fine as
/// 8192 pixels a side allow. One or two bands are taken as grey (and alpha).
/// @throws tarn::Error  if the picture lies elsewhere
Ortho warp_ortho(Source& source, const geo::Frame& frame, const Heightfield& ground,
                 const Progress& progress);

} // namespace tarn::dem
