#pragma once
/// @file camera_path.hpp  A camera's way through some places, picture by picture.
#include "core/heightfield.hpp"
#include "scene/camera.hpp"

#include <glm/vec2.hpp>
#include <vector>

namespace tarn::scene {

/// Smoothly through all of `keys`, begun and ended gently, in between at an even pace (of metres
/// and of turning); never below the ground.
///
/// @param keys    at least one
/// @param frames  >= 1; the first is the first key, the last the last one
/// Source  centripetal Catmull-Rom spline (Yuksel, Schaefer & Keyser 2011, Computer-Aided Design
///         43): no loops between places that lie close together.
std::vector<Camera> path_through(const std::vector<Camera>& keys, int frames,
                                 const Heightfield& ground);

/// Along a track at a height above ground or water, looking ahead and a little down.
///
/// @param track    at least two places [scene metres]
/// @param above_m  > 0
/// @param level_m  water counts as ground below this; -1e9 for none
std::vector<Camera> path_along(const std::vector<glm::dvec2>& track, double above_m, double level_m,
                               double fov_deg, int frames, const Heightfield& ground);

} // namespace tarn::scene
