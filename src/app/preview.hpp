#pragma once
/// @file preview.hpp  A shaded map of a scene with its lakes, level and a scale bar.
#include "core/image.hpp"
#include "scene/scene.hpp"

namespace tarn::app {

/// Relief, water and a scale bar; north up, at most `side_px` on the longer side.
Picture draw_map(const scene::Scene& scene, int side_px);

/// The same with the lake's name and figures.
Picture draw_preview(const scene::Scene& scene, int side_px = 900);

} // namespace tarn::app
