#version 450 core
// passes/primary.comp — part 0 of every path: from the camera to the first surface.
// Reads heights, bounds, beams and overlay; writes hits 0 and, for the first sample, distances. One invocation a pixel
// of the tile. Only walks: see lib/parts.glsl. With waves (TARN_WAVES) it goes as far as the slab that holds the
// moving water; passes/surface.comp goes on from there.
#include "lib/parts.glsl"
#include "lib/walks/chosen.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_TEXTURE_BOUNDS) uniform sampler2D bounds;
layout(binding = TARN_TEXTURE_OVERLAY) uniform sampler2D overlay;
layout(binding = TARN_TEXTURE_BEAMS) uniform sampler2D beams;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_BUFFER_LAKES, std430) readonly buffer Lakes { vec4 lakes[]; };
layout(binding = TARN_IMAGE_HITS, rgba32ui) uniform writeonly uimage2D hits;
layout(binding = TARN_IMAGE_DISTANCE, r32f) uniform writeonly image2D distance_image;

// Whether the bed of the lake with that level is known. The lakes come sorted by level.
bool bed_is_known(float level) {
    uint low = 0u, high = view.counts.w; // the first lake above the level lies in [low, high]
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (lakes[middle].x < level)
            low = middle + 1u;
        else
            high = middle;
    }
    if (low == view.counts.w || (low > 0u && level - lakes[low - 1u].x < lakes[low].x - level))
        --low; // the one below is nearer
    return lakes[low].y > 0.5;
}

// How far away something rasterised is in this pixel; far_m if there is nothing.
float overlay_distance(ivec2 pixel) {
    if ((view.counts.z & TARN_FLAG_OVERLAY) == 0u)
        return far_m;
    float t = texelFetch(overlay, pixel, 0).a;
    return t > 0.0 ? t : far_m;
}

void store(ivec2 local, ivec2 pixel, Part part, float limit, float overlay_t, bool found, Hit hit) {
    End end = End(limit, ivec2(0), vec2(0.0), 0u);
    if (found) {
        end = End(hit.t, hit.cell, hit.inside, hit.water ? end_surface : end_ground);
#if defined(TARN_WAVES) || defined(TARN_CUT_WATER)
        float level = texelFetch(heights, hit.cell, 0).g * view.heights.w + view.heights.z - view.offset.w;
#else
        float level = height_after(view, part, hit.t);
#endif
        if (hit.water && bed_is_known(level))
            end.flags |= end_bed_known;
    } else if (overlay_t <= limit && overlay_t < far_m) {
        end.t = overlay_t;
        end.flags = end_overlay;
    } else if (part.in_water && to_surface(part) <= view.optics.y) {
        end.flags = end_surface | (part.bed_known ? end_bed_known : 0u);
        place_at(view, part, limit, end.cell, end.inside);
    }
    imageStore(hits, local, pack_end(end));
    if (view.offset.z < 0.5)
        imageStore(distance_image, pixel, vec4(end.flags != 0u ? end.t : far_m));
}

void main() {
    ivec2 local = ivec2(gl_GlobalInvocationID.xy), pixel = pixel_of(view, local);
    if (any(greaterThanEqual(local, view.tile.zw)))
        return;
    Part part = camera_part(view, pixel);
    if (left_out(view, part))
        return;
#ifdef TARN_WAVES
    part.level -= view.offset.w; // as low as a trough may be
#endif
    float limit = reach(view, part), overlay_t = overlay_distance(pixel);
    Ray ray = ray_of(view, part);
    ray.begin = texelFetch(beams, pixel >> 3, 0).r;
    Hit hit;
    bool found = false;
    if (!part.in_water || part.bed_known)
        found = trace_field(heights, bounds, field_of(view), ray, min(limit, overlay_t), !part.in_water, hit);
    store(local, pixel, part, limit, overlay_t, found, hit);
}
