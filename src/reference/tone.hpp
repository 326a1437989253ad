#pragma once
/// @file tone.hpp  Twin of shaders/lib/tone.glsl in double precision.
#include <cmath>
#include <glm/vec3.hpp>

namespace tarn::reference {

/// Moves along the line from the colour to its grey, as far as the most negative channel needs.
inline glm::dvec3 into_gamut(const glm::dvec3& c) {
    const double grey = 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
    double keep = 1.0; // share of the colour; the rest is grey
    for (int k = 0; k < 3; ++k)
        if (c[k] < 0.0)
            keep = std::min(keep, grey / (grey - c[k]));
    if (grey <= 0.0 && keep < 1.0)
        return glm::dvec3(0.0);
    return glm::dvec3(grey) * (1.0 - keep) + c * keep;
}

/// 1 / (1 + (s / x)^n), then sRGB.
inline double tone_curve(double radiance, double exposure) {
    const double x = radiance * exposure;
    if (!(x > 0.0))
        return 0.0;
    const double n = 1.3, s = 0.18 * std::pow((1.0 - 0.18) / 0.18, 1.0 / n);
    const double linear = 1.0 / (1.0 + std::pow(s / x, n));
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

} // namespace tarn::reference
