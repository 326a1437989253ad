// lib/caustics.glsl — sunlight that waves focus on its way down. Pure functions; samplers are parameters.
// C++ twin: src/reference/caustics.hpp. Model and figures: docs/physics/caustics.md
//
// With one direction of the sun the pattern that a periodic surface casts is periodic at every depth, in
// coordinates sheared along the beam: a tile for each of some depths serves a lake of any size, and all the water
// between. Each cascade has tiles of its own; the waves of finer ones blur what it draws, and their pattern
// multiplies it. A weaker sea draws at a depth what the full one draws higher up: displacements grow with slope
// times depth.
#include "shared/sunlight_block.h"
#include "lib/fresnel.glsl"

// What comes through one facet of the surface.
struct Photon {
    vec2 lean;   // metres east and north for each metre of depth
    float share; // flux through a horizontal metre, against that of flat water; 0 where it faces away
};

// photon_below — the sun's light behind a facet.
//
//   sun      unit, towards it, sun.z > 0
//   slope    rise of the facet per metre east and north
//   index    of refraction of the water
Photon photon_below(vec3 sun, vec2 slope, float index, bool schlick) {
    vec3 normal = normalize(vec3(-slope, 1.0));
    float cosine = dot(sun, normal);
    if (cosine <= 0.0)
        return Photon(vec2(0.0), 0.0);
    float eta = 1.0 / index;
    vec3 down = refracted(-sun, normal, eta);
    float mirror = schlick ? fresnel_schlick(cosine, eta) : fresnel_dielectric(cosine, eta);
    float mirror_flat = schlick ? fresnel_schlick(sun.z, eta) : fresnel_dielectric(sun.z, eta);
    if (down.z >= -0.05) // along the surface of a steep wave: it comes to nothing that is drawn
        return Photon(vec2(0.0), 0.0);
    return Photon(down.xy / -down.z, (1.0 - mirror) * (sun.z - dot(sun.xy, slope)) / ((1.0 - mirror_flat) * sun.z));
}

// slice_of_depth — where among the slices of a cascade a depth lies, and how much of their contrast is there:
//                  above the first it grows with depth.
vec2 slice_of_depth(SunlightBlock light, int cascade, float depth_m) {
    float ratio = depth_m / light.cascades[cascade].x;
    return vec2(clamp(log2(max(ratio, 1e-9)) * light.cascades[cascade].y, 0.0, light.last[cascade] - 0.001), min(ratio, 1.0));
}

#ifdef TARN_WAVES
// sun_focus — sunlight on a horizontal plane against that below flat water; 1 in the mean.
//
//   tiles       TARN_TEXTURE_SUNLIGHT
//   at_m        east and north of the base of the waves
//   depth_m     below the level, >= 0
//   amplitude   of the cascades, where the light comes in
//   footprint_m what is narrower is not drawn
float sun_focus(sampler2DArray tiles, SunlightBlock light, WaveBlock waves, vec2 at_m, float depth_m, vec4 amplitude,
                float footprint_m) {
    vec2 straight = at_m - depth_m * light.beam.xy;
    float variance = light.beam.w, finest = amplitude[int(waves.rough.w)], focus = 1.0;
    variance += light.rough.x * finest * finest;
    for (int j = TARN_CASCADES - 1; j >= 0; --j) {
        vec4 own = light.cascades[j];
        vec2 place = waves.patches[j].xy + straight / waves.patches[j].z;
        // Looked up bilinearly, a level whose texels are w wide blurs with a variance of w^2 / 4; a pixel with a twelfth.
        float level = 0.5 * log2(max((4.0 * depth_m * depth_m * variance + footprint_m * footprint_m / 3.0) / (own.w * own.w), 1.0));
        vec2 slice = slice_of_depth(light, j, amplitude[j] * depth_m);
        float first = floor(slice.x);
        vec2 two = textureLod(tiles, vec3(place, float(j) * light.beam.z + first), level).xy;
        // Wider than the coarsest level, a pixel sees ever more of the same.
        float seen = slice.y * min(1.0, 0.25 * waves.patches[j].z / own.w * exp2(-level));
        focus *= 1.0 + inside_patch(waves, j, place) * seen * (mix(two.x, two.y, slice.x - first) - 1.0);
        variance += own.z * amplitude[j] * amplitude[j];
    }
    return focus;
}
#endif
