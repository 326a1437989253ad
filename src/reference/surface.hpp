#pragma once
/// @file surface.hpp  Double-precision twin of shaders/lib/surface.glsl.
#include "core/heightfield.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace tarn::reference {

/// Same contract as the GLSL function of the same name, from the other end: the gradient is the
/// difference of two bilinear surfaces two nodes apart, which is what interpolated central
/// differences amount to.
inline glm::dvec2 ground_gradient(const Heightfield& ground, double col, double row) {
    const GridSize size = ground.size();
    const int c0 = std::clamp(int(col), 0, size.cols - 2),
              r0 = std::clamp(int(row), 0, size.rows - 2);
    const double u = col - c0, v = row - r0;
    const auto shifted = [&](int dc, int dr) {
        const auto node = [&](int c, int r) {
            return ground.elevation_m(
                Node{std::clamp(c + dc, 0, size.cols - 1), std::clamp(r + dr, 0, size.rows - 1)});
        };
        return (1 - u) * (1 - v) * node(c0, r0) + u * (1 - v) * node(c0 + 1, r0) +
               (1 - u) * v * node(c0, r0 + 1) + u * v * node(c0 + 1, r0 + 1);
    };
    return {0.5 * (shifted(1, 0) - shifted(-1, 0)), 0.5 * (shifted(0, 1) - shifted(0, -1))};
}

/// Same contract as the GLSL function of the same name: the cross product of two tangents.
inline glm::dvec3 normal_of(glm::dvec2 gradient_m_per_node, double spacing_m) {
    const glm::dvec3 east(spacing_m, 0.0, gradient_m_per_node.x);
    const glm::dvec3 north(0.0, spacing_m, -gradient_m_per_node.y);
    return glm::normalize(glm::cross(east, north));
}

} // namespace tarn::reference
