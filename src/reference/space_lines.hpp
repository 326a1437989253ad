#pragma once
/// @file space_lines.hpp  Twin of shaders/lib/space_lines.glsl in double precision: the nearest of
/// a stroke is searched along it.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace tarn::reference {

struct StrokeSeen {
    double apart_rad, t;
};

/// @param direction  unit, of a ray from the eye
/// @param from, to   ends of the stroke, from the eye [m]
inline StrokeSeen near_stroke(glm::dvec3 direction, glm::dvec3 from, glm::dvec3 to) {
    // Angles along a straight line have one least value before the eye: by golden section.
    const auto angle = [&](double s) {
        const glm::dvec3 p = from + s * (to - from);
        return std::atan2(glm::length(glm::cross(p, direction)), glm::dot(p, direction));
    };
    double low = 0.0, high = 1.0;
    const double ratio = 0.6180339887498949;
    double a = high - ratio * (high - low), b = low + ratio * (high - low);
    double at_a = angle(a), at_b = angle(b);
    for (int i = 0; i < 80; ++i)
        if (at_a < at_b) {
            high = b;
            b = a;
            at_b = at_a;
            a = high - ratio * (high - low);
            at_a = angle(a);
        } else {
            low = a;
            a = b;
            at_a = at_b;
            b = low + ratio * (high - low);
            at_b = angle(b);
        }
    double best = 0.5 * (low + high);
    for (const double end : {0.0, 1.0})
        if (angle(end) <= angle(best))
            best = end;
    const glm::dvec3 p = from + best * (to - from);
    return {std::sin(std::min(angle(best), 1.5707963267948966)), glm::dot(p, direction)};
}

inline double stroke_cover(double apart_px, double width_px) {
    const double inside_px = 0.5 * (width_px + 1.0) - apart_px;
    return std::min(std::max(inside_px, 0.0), 1.0);
}

} // namespace tarn::reference
