#pragma once
/// @file markings.hpp  Twin of shaders/lib/markings.glsl in double precision.
#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>

namespace tarn::reference {

/// The line as a strip of ground: its share of the pixel's width, as far as lines keep apart.
inline double contour_cover(double height_m, double interval_m, double slope, double footprint_m) {
    const double below = std::floor(height_m / interval_m + 0.5);
    const bool broad =
        std::fmod(std::abs(below), 5.0) < 0.5 || std::fmod(std::abs(below), 5.0) > 4.5;
    const double steep = std::max(slope, 1e-5);
    const double rise_a_px = steep * footprint_m;
    const double half_strip_m = 0.5 * (broad ? 2.2 : 1.2) * rise_a_px;
    const double into_m = half_strip_m + 0.5 * rise_a_px - std::abs(height_m - below * interval_m);
    const auto smooth = [](double a, double b, double x) {
        const double t = std::clamp((x - a) / (b - a), 0.0, 1.0);
        return t * t * (3.0 - 2.0 * t);
    };
    return std::clamp(into_m / rise_a_px, 0.0, 1.0) *
           smooth(3.0, 8.0, (broad ? 5.0 : 1.0) * interval_m / rise_a_px) *
           smooth(0.0, 0.002, slope);
}

inline glm::dvec3 depth_colour(double share) {
    static const glm::dvec3 stops[] = {{0.75, 0.80, 0.52},
                                       {0.32, 0.62, 0.50},
                                       {0.09, 0.38, 0.50},
                                       {0.04, 0.17, 0.40},
                                       {0.03, 0.04, 0.18}};
    glm::dvec3 out(0.0); // tents around the stops
    for (int i = 0; i < 5; ++i)
        out +=
            stops[i] * std::max(0.0, 1.0 - std::abs(4.0 * std::clamp(share, 0.0, 1.0) - double(i)));
    return out;
}

inline double drape_cover(double near, double reach_m, double width_px, double footprint_m) {
    if (near <= 0.0)
        return 0.0;
    const double away_m = reach_m - near * reach_m;
    return std::clamp((0.5 * (width_px + 1.0) * footprint_m - away_m) / footprint_m, 0.0, 1.0);
}

} // namespace tarn::reference
