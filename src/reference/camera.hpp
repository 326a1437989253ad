#pragma once
/// @file camera.hpp  Double-precision twin of shaders/lib/camera.glsl.
///
/// Written by rotating a ray of angles instead of scaling plane coordinates: the shader normalises
/// forward + u right + v up, here the direction is put together from its sines and cosines.
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace tarn::reference {

/// Same contract as the GLSL function of the same name.
inline glm::dvec3 pixel_direction(glm::dvec3 forward, glm::dvec3 right, glm::dvec3 up,
                                  glm::dvec2 half_tangent, glm::dvec2 place) {
    const double across = std::atan((2.0 * place.x - 1.0) * half_tangent.x);
    const double rise = std::atan((1.0 - 2.0 * place.y) * half_tangent.y * std::cos(across));
    return std::cos(rise) * (std::cos(across) * forward + std::sin(across) * right) +
           std::sin(rise) * up;
}

} // namespace tarn::reference
