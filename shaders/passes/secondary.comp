#version 450 core
// passes/secondary.comp — parts 1 and 2: mirrored and refracted at the water.
// Reads heights, bounds and hits 0; writes hits 1 and 2. One invocation a pixel of the tile and part
// (z). Only walks: see lib/parts.glsl.
#include "lib/parts.glsl"
#include "lib/walks/chosen.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_TEXTURE_BOUNDS) uniform sampler2D bounds;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
#ifdef TARN_WAVES
#include "lib/waves.glsl"
layout(binding = TARN_IMAGE_SURFACE, rgba32ui) uniform readonly uimage2D surfaces;
#endif
layout(binding = TARN_IMAGE_HITS, rgba32ui) uniform readonly uimage2D first_hits;
layout(binding = TARN_IMAGE_HITS + 1, rgba32ui) uniform writeonly uimage2D mirrored_hits;
layout(binding = TARN_IMAGE_HITS + 2, rgba32ui) uniform writeonly uimage2D refracted_hits;

void main() {
    ivec2 local = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(local, view.tile.zw)))
        return;
    End first_end = unpack_end(imageLoad(first_hits, local));
    if ((first_end.flags & end_surface) == 0u)
        return;
    int number = 1 + int(gl_GlobalInvocationID.z);
    Part first = camera_part(view, pixel_of(view, local));
    if (left_out(view, first))
        return;
#ifdef TARN_WAVES
    WaveSurface met = unpack_surface(imageLoad(surfaces, local));
    Surface surface = Surface(slope_of_part(met, number, first.in_water, lot_of(view, pixel_of(view, local)), view.offset.z,
                                            direction_after(view, first, first_end.t), view.optics.x),
                              surface_level(heights, view, first, first_end));
#else
    Surface surface = calm_surface(heights, view, first, first_end);
#endif
    Part part = split_part(view, first, first_end, surface, number);
    if (!wanted(view, part, number))
        return;
    float limit = reach(view, part);
    End end = End(limit, ivec2(0), vec2(0.0), 0u);
    bool walks = number != 1 || first.in_water || (view.counts.z & TARN_FLAG_MIRRORED_LAND) != 0u;
    if (walks && (!part.in_water || part.bed_known)) {
        Hit hit;
        if (trace_field(heights, bounds, field_of(view), ray_of(view, part), limit, false, hit))
            end = End(hit.t, hit.cell, hit.inside, end_ground);
    }
    if (number == 1)
        imageStore(mirrored_hits, local, pack_end(end));
    else
        imageStore(refracted_hits, local, pack_end(end));
}
