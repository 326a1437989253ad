#pragma once
/// @file sky.hpp  Double-precision twin of shaders/lib/sky.glsl, with azimuths by atan2.
#include "core/angles.hpp"
#include "scene/lighting.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace tarn::reference {

/// Same contract as the GLSL function of the same name.
inline glm::dvec2 sky_place(glm::dvec3 direction, glm::dvec3 sun, bool whole_turn = false) {
    const double flat = std::hypot(direction.x, direction.y);
    const double elevation = std::max(0.0, std::atan2(direction.z, flat));
    if (whole_turn) {
        const double azimuth = std::atan2(direction.x, direction.y);
        return {(azimuth < 0.0 ? azimuth + 2.0 * pi : azimuth) / (2.0 * pi),
                std::sqrt(elevation / (pi / 2))};
    }
    double apart = pi / 2; // overhead no azimuth is defined; the table is even there
    if (flat > 1e-12 && std::hypot(sun.x, sun.y) > 1e-12) {
        apart = std::abs(std::atan2(direction.x, direction.y) - std::atan2(sun.x, sun.y));
        apart = apart > pi ? 2 * pi - apart : apart;
    }
    return {apart / pi, std::sqrt(elevation / (pi / 2))};
}

/// Same contract as the GLSL function of the same name.
inline glm::dvec3 sky_radiance(const scene::SkyTable& table, glm::dvec3 direction, glm::dvec3 sun) {
    const glm::dvec2 place = sky_place(direction, sun, table.whole_turn);
    const double x = place.x * (table.azimuths - 1), y = place.y * (table.elevations - 1);
    const int i = std::clamp(int(x), 0, table.azimuths - 2),
              j = std::clamp(int(y), 0, table.elevations - 2);
    const double u = x - i, v = y - j;
    return (1 - v) * ((1 - u) * glm::dvec3(table.at(i, j)) + u * glm::dvec3(table.at(i + 1, j))) +
           v * ((1 - u) * glm::dvec3(table.at(i, j + 1)) + u * glm::dvec3(table.at(i + 1, j + 1)));
}

/// Same contract as the GLSL function of the same name, by the angle itself.
inline double disc_share(glm::dvec3 direction, glm::dvec3 sun, double radius, double pixel) {
    const double cosine = glm::dot(direction, sun);
    if (cosine <= 0.0)
        return 0.0;
    const double angle = std::atan2(glm::length(glm::cross(direction, sun)), cosine);
    return std::clamp((radius + 0.5 * pixel - angle) / pixel, 0.0, 1.0);
}

} // namespace tarn::reference
