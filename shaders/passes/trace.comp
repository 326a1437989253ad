#version 450 core
// passes/trace.comp — the picture: one ray a pixel, split once at the water's surface into a
// reflected and a refracted one, shaded where it ends.
// Reads heights, maxima, sky and orthophoto; adds to radiance, writes distance (first sample).
// One invocation per pixel. This file says which rays are followed; what light does is in lib/.
#include "shared/view_block.h"
#include "lib/camera.glsl"
#include "lib/fresnel.glsl"
#include "lib/ground_colour.glsl"
#include "lib/heightfield.glsl"
#include "lib/medium.glsl"
#include "lib/sky.glsl"
#include "lib/surface.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_TEXTURE_MAXIMA) uniform sampler2D maxima;
layout(binding = TARN_TEXTURE_SKY) uniform sampler2D sky_table;
layout(binding = TARN_TEXTURE_ORTHO) uniform sampler2D ortho;
layout(binding = TARN_IMAGE_RADIANCE, rgba32f) uniform image2D radiance_image;
layout(binding = TARN_IMAGE_DISTANCE, r32f) uniform writeonly image2D distance_image;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_BUFFER_LAKES, std430) readonly buffer Lakes { vec4 lakes[]; };

const float far_m = 1e9;
// White in an aerial picture is no albedo of 1: pictures are exposed for mid grey.
const float photo_albedo = 0.7;
const float inverse_pi = 0.318309886184;
// Mean slant of skylight in the water, refracted from an even sky, and what the surface lets in
// of it (1 - .066): docs/physics/water.md.
const float sky_slant = 1.19;
const float sky_entering = 0.934;

bool on(uint flag) { return (view.counts.z & flag) != 0u; }

// A ray still to be followed, and how much its radiance counts in the pixel.
struct Segment {
    ivec2 base;     // node that origin.xy counts from
    vec3 origin;    // columns, rows, height
    vec3 direction; // unit, scene axes
    vec3 weight;
    bool in_water;
};

float surface_reflectance(float cos_i, float eta) {
    return on(TARN_FLAG_SCHLICK) ? fresnel_schlick(cos_i, eta) : fresnel_dielectric(cos_i, eta);
}

vec3 sky(vec3 direction) {
    vec3 radiance = sky_radiance(sky_table, direction, view.sun.xyz);
    if (on(TARN_FLAG_SUN_DISC)) {
        float radius = view.sun.w;
        radiance += view.sun_irradiance.rgb / (3.14159265359 * radius * radius) *
                    disc_share(direction, view.sun.xyz, radius, view.camera.w);
    }
    return radiance;
}

bool lit_along(Field field, ivec2 base, vec3 from, vec3 towards, float t_max) {
    Hit ignored;
    return !trace_field(heights, maxima, field, ray_from(base, from, towards, view.grid.z), t_max, false,
                        ignored);
}

// Sunlight just below a flat surface: one value for the whole lake.
vec3 sun_below() {
    return view.sun.z > 0.0 ? -refracted(-view.sun.xyz, 1.0 / view.attenuation.w) : vec3(0.0, 0.0, 1.0);
}

vec3 sun_irradiance_below(vec3 below) {
    float sine = view.sun.z; // of the sun's elevation
    return sine > 0.0 ? view.sun_irradiance.rgb * (sine / below.z) *
                            (1.0 - surface_reflectance(sine, 1.0 / view.attenuation.w))
                      : vec3(0.0);
}

// Radiance that leaves the ground at a hit: land in the air, bed under water.
//
//   place, base  of the hit: height, and node plus position in the cell
//   level        of the water above, if in_water
//   direction    of the ray that came here
//   path_m       length of the way here, for the footprint of a pixel
vec3 shade(Field field, Hit hit, vec3 place, ivec2 base, vec3 direction, bool in_water, float level,
           float path_m) {
    vec4 corners = textureGather(heights, (vec2(hit.cell) + 1.0) * field.texel, 0) * field.ground_m.y;
    if (!in_water && place.z < bilinear(corners, hit.inside) - view.options.x) {
        // The side of the block that the scene is cut out of.
        vec3 earth = view.look.w < 0.0 ? vec3(0.19, 0.155, 0.115) : vec3(view.look.w);
        float rise = normalize(vec3(-direction.xy, 0.5)).z;
        return earth * inverse_pi * view.sky_irradiance.rgb * (0.5 + 0.5 * rise);
    }
    vec2 gradient = ground_gradient(heights, field.nodes, hit.cell, hit.inside, field.ground_m.y);
    vec3 normal = normal_of(gradient, view.grid.z);
    float footprint = view.camera.w * path_m;
    float shore = in_water ? level : view.look.z;
    vec2 nodes = vec2(base) + place.xy;
    vec3 albedo = vec3(view.look.w);
    if (view.look.w < 0.0) {
        float near_water = water_share(heights, field.nodes, hit.cell, hit.inside);
        albedo = ground_albedo(nodes * view.grid.z, place.z - shore, in_water, near_water, view.look.x - shore,
                               view.look.y - shore, length(gradient) / view.grid.z, footprint);
        if (on(TARN_FLAG_ORTHO) && !in_water) {
            vec2 at = (nodes - view.ortho.xy) / view.ortho.zw;
            if (all(greaterThan(at, vec2(0.0))) && all(lessThan(at, vec2(1.0)))) {
                float lod = max(0.0, log2(max(footprint, 1e-6) / view.ortho_lod.x));
                vec4 photo = textureLod(ortho, at, lod);
                albedo = mix(albedo, photo_albedo * photo.rgb, photo.a);
            }
        }
    }

    vec3 attenuation = view.attenuation.rgb;
    vec3 sun = view.sun.xyz;
    vec3 towards = in_water ? sun_below() : sun;
    float facing = sun.z > 0.0 ? max(dot(normal, towards), 0.0) : 0.0;
    float depth = in_water ? max(level - place.z, 0.0) : 0.0;
    vec3 sunlight = vec3(0.0);
    if (facing > 0.0) {
        bool lit = true;
        if (on(TARN_FLAG_SHADOWS)) {
            vec3 from = place + vec3(0.0, 0.0, view.options.x);
            // Under water the sun's ray is followed to the surface, then on through the air.
            for (int leg = in_water ? 0 : 1; leg < 2 && lit; ++leg) {
                float t_leg = leg == 0 ? max(level - from.z, 0.0) / towards.z : far_m;
                lit = lit_along(field, base, from, leg == 0 ? towards : sun, t_leg);
                from = vec3(from.xy + vec2(towards.x, -towards.y) / view.grid.z * t_leg, max(level, from.z));
            }
        }
        if (lit)
            sunlight = facing * (in_water ? sun_irradiance_below(towards) *
                                                transmittance(attenuation, depth / towards.z)
                                          : view.sun_irradiance.rgb);
    }
    vec3 skylight = in_water ? view.sky_irradiance.rgb * sky_entering *
                                   transmittance(attenuation, sky_slant * depth)
                             : view.sky_irradiance.rgb;
    return albedo * inverse_pi * (sunlight + skylight * (0.5 + 0.5 * normal.z));
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = ivec2(view.counts.xy);
    if (any(greaterThanEqual(pixel, size)))
        return;
    Field field = field_of(view);
    float index = view.attenuation.w, d_max = view.backscattering.w;
    vec3 attenuation = view.attenuation.rgb;

    vec3 direction = pixel_direction(view.forward.xyz, view.right.xyz, view.up.xyz,
                                     vec2(view.right.w, view.up.w),
                                     (vec2(pixel) + view.offset.xy) / vec2(size));
    // One ray is followed, at most one waits: named variables, not an array, which would live in
    // slow memory. What holds for both after the split is kept once.
    Segment now = Segment(view.walk.zw, view.camera.xyz, direction, vec3(1.0), on(TARN_FLAG_UNDER_WATER));
    Segment waiting = now;
    bool more = false;
    float level = view.options.y;             // of the water that a ray is in, or was split at
    bool bed_known = view.options.z > 0.5;    // in that lake
    float before_m = 0.0;                     // path to the split, for the footprint of a pixel
    vec3 radiance = vec3(0.0);
    float first_distance = far_m;

    for (int turn = 0; turn < 3; ++turn) {
        float start_depth = now.in_water ? max(level - now.origin.z, 0.0) : 0.0;
        float to_surface = now.in_water && now.direction.z > 1e-6 ? start_depth / now.direction.z : far_m;
        float reach = now.in_water ? min(to_surface, d_max) : far_m;
        bool water_counts = turn == 0 && !now.in_water;

        Hit hit;
        bool found = false;
        Ray ray = ray_from(now.base, now.origin, now.direction, view.grid.z);
        if (!now.in_water || bed_known)
            found = trace_field(heights, maxima, field, ray, reach, water_counts, hit);
        float travelled = found ? hit.t : reach;
        bool at_surface = found ? hit.water : now.in_water && to_surface <= d_max;
        if (turn == 0)
            first_distance = found || at_surface ? travelled : far_m;
        // Where the ray has come to: a node and what is left, like the ray itself.
        ivec2 base = found ? hit.cell : ray.base;
        vec3 place = ray.origin + travelled * ray.direction;
        if (found)
            place.xy = hit.inside;

        vec3 weight = now.weight;
        if (now.in_water) {
            float sink = -now.direction.z;
            vec3 below = sun_below();
            radiance += weight * (path_radiance(view.backscattering.rgb, attenuation,
                                                sun_irradiance_below(below), 1.0 / below.z, start_depth,
                                                sink, travelled) +
                                  path_radiance(view.backscattering.rgb, attenuation,
                                                view.sky_irradiance.rgb * (sky_entering * sky_slant),
                                                sky_slant, start_depth, sink, travelled));
            weight *= transmittance(attenuation, travelled);
        }

        bool ended = true;
        if (at_surface) { // split in two; this happens in the first turn only
            if (turn == 0) {
                if (!now.in_water) {
                    level = place.z;
                    float nearest = far_m;
                    for (uint k = 0u; k < view.counts.w; ++k)
                        if (abs(lakes[k].x - level) < nearest) {
                            nearest = abs(lakes[k].x - level);
                            bed_known = lakes[k].y > 0.5;
                        }
                }
                before_m = travelled;
                float eta = now.in_water ? index : 1.0 / index;
                float mirror = surface_reflectance(min(abs(now.direction.z), 1.0), eta);
                // What is conserved is radiance over index squared.
                float through = (1.0 - mirror) * eta * eta;
                vec3 start = vec3(place.xy, level);
                vec3 bounced = vec3(now.direction.xy, -now.direction.z);
                vec3 bent = mirror < 1.0 ? refracted(now.direction, eta) : bounced;
                Segment reflected_part = Segment(base, start, bounced, weight * mirror, now.in_water);
                Segment refracted_part = Segment(base, start, bent, weight * through, !now.in_water);
                bool reflect_it = on(TARN_FLAG_REFLECTION);
                bool refract_it = on(TARN_FLAG_REFRACTION) && mirror < 1.0;
                waiting = reflected_part;
                more = reflect_it && refract_it;
                now = refract_it ? refracted_part : reflected_part;
                ended = !reflect_it && !refract_it;
            }
        } else if (!found) {
            if (!now.in_water)
                radiance += weight * sky(now.direction);
        } else {
            radiance += weight * shade(field, hit, place, base, now.direction, now.in_water, level, before_m + travelled);
        }
        if (ended) {
            if (!more)
                break;
            now = waiting;
            more = false;
        }
    }
    radiance *= view.options.w;
    if (view.offset.z > 0.5)
        radiance += imageLoad(radiance_image, pixel).rgb;
    else
        imageStore(distance_image, pixel, vec4(first_distance));
    imageStore(radiance_image, pixel, vec4(radiance, 1.0));
}
