#pragma once
/// @file fresnel.hpp  Double-precision twin of shaders/lib/fresnel.glsl.
///
/// Written from the ANGLE form of the equations on purpose. The shader uses the cosine form, so a
/// slip copied into one of them cannot hide in the other.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace tarn::reference {

/// Same contract as the GLSL function of the same name.
inline double fresnel_dielectric(double cos_i, double eta) {
    const double angle_i = std::acos(std::clamp(cos_i, 0.0, 1.0));
    const double sin_t = eta * std::sin(angle_i);
    if (sin_t >= 1.0)
        return 1.0;
    if (angle_i < 1e-7) // sin(0)/sin(0): the limit
        return std::pow((1.0 - eta) / (1.0 + eta), 2.0);
    const double angle_t = std::asin(sin_t);
    const double r_s = std::sin(angle_i - angle_t) / std::sin(angle_i + angle_t);
    const double r_p = std::tan(angle_i - angle_t) / std::tan(angle_i + angle_t);
    return 0.5 * (r_s * r_s + r_p * r_p);
}

/// Same contract as the GLSL function of the same name.
inline double fresnel_schlick(double cos_i, double eta) {
    const double straight = std::pow((1.0 - eta) / (1.0 + eta), 2.0);
    const double angle_i = std::acos(std::clamp(cos_i, 0.0, 1.0));
    double thin_side = angle_i; // the angle in the thinner medium
    if (eta > 1.0) {
        const double sine = eta * std::sin(angle_i);
        if (sine >= 1.0)
            return 1.0;
        thin_side = std::asin(sine);
    }
    return straight + (1.0 - straight) * std::pow(1.0 - std::cos(thin_side), 5.0);
}

/// Same contract as the GLSL function of the same name; by angles.
inline glm::dvec3 refracted(glm::dvec3 direction, glm::dvec3 normal, double eta) {
    const glm::dvec3 tangent = direction - glm::dot(direction, normal) * normal;
    const double along = glm::length(tangent);
    if (along == 0.0)
        return direction;
    const double angle_t = std::asin(std::min(1.0, eta * along));
    return tangent / along * std::sin(angle_t) - std::cos(angle_t) * normal;
}

} // namespace tarn::reference
