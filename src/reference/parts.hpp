#pragma once
/// @file parts.hpp  Double-precision twin of the split in shaders/lib/parts.glsl.
#include "reference/fresnel.hpp"

namespace tarn::reference {

struct Split {
    glm::dvec3 reflected, refracted;
    double mirror = 0.0, through = 0.0;
};

/// Same contract as the GLSL function of the same name. Radiance over index squared is conserved:
/// the branch through the surface counts the square of the ratio of the indices.
inline Split split_at_surface(glm::dvec3 direction, glm::dvec3 normal, double index,
                              bool from_water, bool schlick) {
    const double here = from_water ? index : 1.0, there = from_water ? 1.0 : index;
    const glm::dvec3 facing = from_water ? -normal : normal;
    const double cosine = std::clamp(-glm::dot(direction, facing), 0.0, 1.0);
    Split out;
    out.mirror =
        schlick ? fresnel_schlick(cosine, here / there) : fresnel_dielectric(cosine, here / there);
    out.reflected = glm::reflect(direction, facing);
    if (glm::dot(direction, facing) > 0.0) // seen from behind: as if edge on
        out.reflected = direction;
    out.reflected.z = std::copysign(out.reflected.z, facing.z);
    out.refracted = out.mirror < 1.0 ? refracted(direction, facing, here / there) : out.reflected;
    if (out.mirror < 1.0)
        out.refracted.z = std::copysign(out.refracted.z, -facing.z);
    out.through = (1.0 - out.mirror) * (here * here) / (there * there);
    return out;
}

} // namespace tarn::reference
