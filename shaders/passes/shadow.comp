#version 450 core
// passes/shadow.comp — does the sun reach the ground that a part ended at?
// Reads heights, bounds and hits; sets end_lit in hits. One invocation a pixel of the tile and part (z).
// Only walks: see lib/parts.glsl. Under water the sun's ray is followed to the surface, then on through
// the air.
#include "lib/parts.glsl"
#include "lib/sunlight.glsl"
#include "lib/surface.glsl"
#include "lib/walks/chosen.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_TEXTURE_BOUNDS) uniform sampler2D bounds;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_IMAGE_HITS, rgba32ui) uniform uimage2D hits[3];
#ifdef TARN_WAVES
#include "lib/waves.glsl"
layout(binding = TARN_IMAGE_SURFACE, rgba32ui) uniform readonly uimage2D surfaces;
#endif

void main() {
    ivec2 local = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(local, view.tile.zw)))
        return;
    int number = int(gl_GlobalInvocationID.z);
    Part part = camera_part(view, pixel_of(view, local));
    if (left_out(view, part))
        return;
    uvec4 stored = imageLoad(hits[0], local);
    if (number > 0) {
        End first_end = unpack_end(stored);
        if ((first_end.flags & end_surface) == 0u)
            return;
#ifdef TARN_WAVES
        WaveSurface met = unpack_surface(imageLoad(surfaces, local));
        Surface surface = Surface(slope_of_part(met, number, part.in_water, lot_of(view, pixel_of(view, local)), view.offset.z,
                                            direction_after(view, part, first_end.t), view.optics.x),
                              surface_level(heights, view, part, first_end));
#else
        Surface surface = calm_surface(heights, view, part, first_end);
#endif
        part = split_part(view, part, first_end, surface, number);
        if (!wanted(view, part, number))
            return;
        stored = number == 1 ? imageLoad(hits[1], local) : imageLoad(hits[2], local);
    }
    End end = unpack_end(stored);
    uint shaded = end_ground;
#ifdef TARN_WAVES
    if (!part.in_water && number == 0)
        shaded |= end_surface; // glitters where the sun reaches it
#endif
    if ((end.flags & shaded) == 0u)
        return;
    Field field = field_of(view);
    vec3 sun = view.sun.xyz;
    vec3 towards = part.in_water ? sun_below(sun, view.optics.x) : sun;
    vec3 normal = normal_of(ground_gradient(heights, view.grid.xy, end.cell, end.inside, view.heights.y), view.grid.z);
    if ((end.flags & end_surface) != 0u)
        normal = vec3(0.0, 0.0, 1.0);
    if (sun.z <= 0.0 || dot(normal, towards) <= 0.0)
        return;
    float height = height_after(view, part, end.t) + view.options.x;
    vec3 from = vec3(end.inside, height);
    bool lit = true;
    for (int leg = part.in_water ? 0 : 1; leg < 2 && lit; ++leg) {
        float t_leg = leg == 0 ? max(part.level - from.z, 0.0) / towards.z : far_m;
        Hit ignored;
        Ray ray = leg == 0 ? ray_from(field, vec2(end.cell), from, towards) : air_ray(field, vec2(end.cell), from, sun);
        lit = !trace_field(heights, bounds, field, ray, t_leg, false, ignored);
        from = vec3(from.xy + vec2(towards.x, -towards.y) / view.grid.z * t_leg, max(part.level, from.z));
    }
    if (!lit)
        return;
    stored.w |= end_lit;
    if (number == 0)
        imageStore(hits[0], local, stored);
    else if (number == 1)
        imageStore(hits[1], local, stored);
    else
        imageStore(hits[2], local, stored);
}
