#pragma once
/// @file tracer.hpp  The oracle: the same picture as render/, in double precision on the CPU.
///
/// Reads the same Scene and View as the renderer and shares no code with it or with the shaders.
/// Multi-threaded (oneTBB). The physics is written down in docs/physics/water.md.
#include "core/image.hpp"
#include "core/progress.hpp"
#include "scene/settings.hpp"

namespace tarn::reference {

/// @throws tarn::Error      if a setting is out of range
/// @throws tarn::Cancelled
Image trace(const scene::Scene& scene, const scene::View& view, const Progress& progress);

} // namespace tarn::reference
