#pragma once
/// @file medium.hpp  Double-precision twin of shaders/lib/medium.glsl.
///
/// The path radiance is integrated NUMERICALLY (Gauss-Legendre, five points a panel) instead of by
/// the shader's closed form.
#include <algorithm>
#include <cmath>
#include <glm/exponential.hpp>
#include <glm/vec3.hpp>

namespace tarn::reference {

/// Same contract as the GLSL function of the same name.
inline glm::dvec3 transmittance(glm::dvec3 attenuation_per_m, double distance_m) {
    return glm::exp(-attenuation_per_m * distance_m);
}

/// Same contract as the GLSL function of the same name: what the water scatters at path length s
/// comes from light weakened over the slant depth there, and is weakened on its way back.
inline glm::dvec3 path_radiance(glm::dvec3 backscattering_per_m, glm::dvec3 attenuation_per_m,
                                glm::dvec3 irradiance, double slant, double depth_m, double sink,
                                double distance_m) {
    static constexpr double place[5] = {-0.9061798459386640, -0.5384693101056831, 0.0,
                                        0.5384693101056831, 0.9061798459386640};
    static constexpr double weight[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                         0.4786286704993665, 0.2369268850561891};
    // Panels short against the steepest change.
    const double steepest =
        std::max({attenuation_per_m.x, attenuation_per_m.y, attenuation_per_m.z}) * (1.0 + slant);
    const int panels = std::clamp(int(std::ceil(steepest * distance_m / 1.5)), 1, 20'000);
    const double half = 0.5 * distance_m / panels;
    glm::dvec3 sum(0.0);
    for (int i = 0; i < panels; ++i)
        for (int k = 0; k < 5; ++k) {
            const double s = half * (2 * i + 1 + place[k]);
            const double depth = depth_m + sink * s;
            const glm::dvec3 there = irradiance * transmittance(attenuation_per_m, slant * depth);
            sum += weight[k] * half * there * transmittance(attenuation_per_m, s);
        }
    return backscattering_per_m * sum / (2.0 * 3.14159265358979323846);
}

} // namespace tarn::reference
