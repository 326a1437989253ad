// lib/sunlight.glsl — the sun's beam below a flat surface. Pure functions.
// C++ twin: src/reference/sunlight.hpp
#include "lib/fresnel.glsl"

// sun_below — direction towards the sun as seen from under water, unit; straight up for a sun that is
//             below the horizon.
vec3 sun_below(vec3 sun, float index) {
    return sun.z > 0.0 ? -refracted(-sun, vec3(0.0, 0.0, 1.0), 1.0 / index) : vec3(0.0, 0.0, 1.0);
}

// sun_share_below — irradiance just below the surface on a plane facing the refracted beam, as a share
//                   of the irradiance above it on a plane facing the sun.
//
//   Flux through a horizontal metre is the same on both sides, but for what is mirrored:
//   (1 - F) cos / cos_w.  Source  docs/physics/water.md, rule 2.
float sun_share_below(vec3 sun, vec3 below, float index, bool schlick) {
    if (sun.z <= 0.0)
        return 0.0;
    float mirror = schlick ? fresnel_schlick(sun.z, 1.0 / index) : fresnel_dielectric(sun.z, 1.0 / index);
    return (1.0 - mirror) * sun.z / below.z;
}
