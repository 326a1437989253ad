#pragma once
/// @file air.hpp  Double-precision twin of shaders/lib/air.glsl; densities are summed by Simpson's
/// rule.
#include <algorithm>
#include <cmath>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace tarn::reference {

/// Same contract as the GLSL function of the same name.
inline glm::dvec3 air_transmittance(glm::dvec3 extinction_per_m, double per_height, double height_m,
                                    double rise, double distance_m) {
    const int steps = 2 * std::clamp(int(std::abs(rise * distance_m * per_height) * 10.0), 8, 5000);
    const double lowest = std::min(height_m, height_m + rise * distance_m);
    // The haze is no thicker than e^2 times that of height 0, however deep the valley.
    const double cap = std::min(1.0, std::exp(2.0 + lowest * per_height));
    double sum = 0.0;
    for (int i = 0; i <= steps; ++i) {
        const double weight = i == 0 || i == steps ? 1.0 : i % 2 ? 4.0 : 2.0;
        sum += weight / (3.0 * steps) *
               std::exp(-(height_m + rise * distance_m * i / steps) * per_height);
    }
    return glm::exp(-extinction_per_m * (cap * sum * distance_m));
}

/// Same contract as the GLSL function of the same name.
inline glm::dvec3 horizon_of(glm::dvec3 direction) {
    const double flat = std::max(std::hypot(direction.x, direction.y), 1e-4);
    return glm::normalize(glm::dvec3(direction.x, direction.y, 0.02 * flat));
}

} // namespace tarn::reference
