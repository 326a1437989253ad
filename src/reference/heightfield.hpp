#pragma once
/// @file heightfield.hpp  Double-precision twin of shaders/lib/heightfield.glsl: exact grid walk.
///
/// Visits every cell under the ray, one by one, and finds the crossing by bisection where the ray's
/// height above the patch changes sign or dips below zero between two positive ends. No mipmap, no
/// closed form: nothing in common with the shader but the surface itself.
#include "core/heightfield.hpp"

#include <glm/vec3.hpp>
#include <optional>

namespace tarn::reference {

struct Hit {
    double t = 0.0;     ///< metres along the ray
    bool water = false; ///< of the water's surface, else of the ground
    double col = 0.0, row = 0.0;
    glm::dvec3 point{0}; ///< scene metres
};

/// First hit of a ray with the bilinear ground, and with the water where all four nodes of a cell
/// hold some.
/// @param direction  unit, scene axes
/// @param water      null to look at the ground only
/// @param bottom_m   of the block of earth below the ground: there is nothing under it
/// @param bend       rise of a curved ray over its direction by the square of path length [1/m]
std::optional<Hit> trace_field(const Heightfield& ground, const Heightfield* water,
                               glm::dvec3 origin, glm::dvec3 direction, double t_max,
                               double bottom_m = -1e9, double bend = 0.0);

} // namespace tarn::reference
