#pragma once
/// @file strips.hpp  Pictures too large to be held whole are drawn and written in strips.
#include "scene/settings.hpp"

namespace tarn::scene {

/// Rows of a strip: all of the picture up to 33 million pixels, beyond that a multiple of 8 that
/// makes 16 million at most.
int strip_rows(const RenderSettings& settings);

/// A smaller picture of a view, for what concerns all of a large one: exposure, scale.
View overview_of(View view);

} // namespace tarn::scene
