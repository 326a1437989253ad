#pragma once
/// @file sunlight.hpp  Double-precision twin of shaders/lib/sunlight.glsl.
#include "reference/fresnel.hpp"

namespace tarn::reference {

/// Same contract as the GLSL function of the same name.
inline glm::dvec3 sun_below(glm::dvec3 sun, double index) {
    if (!(sun.z > 0.0))
        return {0.0, 0.0, 1.0};
    const double along = std::hypot(sun.x, sun.y), zenith_angle = std::asin(along / index);
    if (along == 0.0)
        return sun;
    return {sun.x / along * std::sin(zenith_angle), sun.y / along * std::sin(zenith_angle),
            std::cos(zenith_angle)};
}

/// Same contract as the GLSL function of the same name.
inline double sun_share_below(glm::dvec3 sun, glm::dvec3 below, double index, bool schlick) {
    if (!(sun.z > 0.0))
        return 0.0;
    const double mirror =
        schlick ? fresnel_schlick(sun.z, 1.0 / index) : fresnel_dielectric(sun.z, 1.0 / index);
    const double horizontal = (1.0 - mirror) * sun.z; // flux through a horizontal metre
    return horizontal / below.z;
}

} // namespace tarn::reference
