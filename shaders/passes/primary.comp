#version 450 core
// passes/primary.comp — part 0 of every path: from the camera to the first surface.
// Reads heights, bounds, beams and overlay; writes hits 0 and, for the first sample, distances. One invocation a pixel
// of the tile. Only walks: see lib/parts.glsl. A program with waves (TARN_WAVES) follows rays through the slab of
// moving water and writes the surface that they meet, too.
#include "lib/parts.glsl"
#include "lib/walks/chosen.glsl"
#ifdef TARN_WAVES
#include "lib/walks/meet_waves.glsl"
#include "lib/noise.glsl"
#endif

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_TEXTURE_BOUNDS) uniform sampler2D bounds;
layout(binding = TARN_TEXTURE_OVERLAY) uniform sampler2D overlay;
layout(binding = TARN_TEXTURE_BEAMS) uniform sampler2D beams;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_BUFFER_LAKES, std430) readonly buffer Lakes { vec4 lakes[]; };
layout(binding = TARN_IMAGE_HITS, rgba32ui) uniform writeonly uimage2D hits;
#ifdef TARN_WAVES
layout(binding = TARN_BLOCK_WAVES, std140) uniform Waves { WaveBlock waves; };
layout(binding = TARN_TEXTURE_WAVES) uniform sampler2DArray wave_heights;
layout(binding = TARN_TEXTURE_AMPLITUDE) uniform sampler2D amplitudes;
layout(binding = TARN_TEXTURE_WAVE_TABLE) uniform sampler2D wave_table;
layout(binding = TARN_TEXTURE_WAVE_LIMITS) uniform usampler2D wave_limits;
layout(binding = TARN_TEXTURE_SLOPES) uniform sampler2DArray wave_slope_layers;
layout(binding = TARN_IMAGE_SURFACE, rgba32ui) uniform writeonly uimage2D surfaces;
#endif
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

void store(ivec2 pixel, Part part, float limit, float overlay_t, bool found, Hit hit, float level) {
    End end = End(limit, ivec2(0), vec2(0.0), 0u);
    if (found) {
        end = End(hit.t, hit.cell, hit.inside, hit.water ? end_surface : end_ground);
        if (hit.water && bed_is_known(level))
            end.flags |= end_bed_known;
    } else if (overlay_t <= limit && overlay_t < far_m) {
        end.t = overlay_t;
        end.flags = end_overlay;
#ifndef TARN_WAVES
    } else if (part.in_water && to_surface(part) <= view.backscattering.w) {
        end.flags = end_surface | (part.bed_known ? end_bed_known : 0u);
        place_at(view, part, limit, end.cell, end.inside);
#endif
    }
    imageStore(hits, pixel - view.tile.xy, pack_end(end));
    if (view.offset.z < 0.5)
        imageStore(distance_image, pixel, vec4(end.flags != 0u ? end.t : far_m));
}

#ifdef TARN_WAVES
// Two even numbers for a pixel: from sample to sample they fill the square evenly (Roberts' R2 sequence).
vec2 even_numbers(ivec2 pixel) {
    uint h = lattice_hash(pixel, 91u);
    vec2 start = vec2(h & 0xffffu, h >> 16) / 65536.0;
    return fract(start + view.offset.z * vec2(0.7548776662, 0.5698402910));
}

// The surface where the waves were met, for the passes that follow; returns its level. Its slope is one of
// those inside the pixel: mirrored and refracted rays go where facets send them, not where their mean would.
float store_surface(ivec2 pixel, Part part, Hit hit) {
    vec4 ground = textureGather(heights, (vec2(hit.cell) + 1.0) * view.inverse_size.xy, 0) * view.heights.y;
    float coded = texelFetch(heights, hit.cell, 0).g * view.heights.w + view.heights.z;
    float level = part.in_water ? part.level : coded - waves.counts.w;
    vec2 at = (vec2(hit.cell) + hit.inside - view.base.xy) * view.grid.z;
    at.y = -at.y;
    vec4 amplitude = wave_fade(waves, level - bilinear(ground, hit.inside)) * wave_amplitude(amplitudes, waves, at);
    float footprint = wave_footprint(view.camera.w, hit.t, part.direction.z);
    vec3 taken;
    vec2 slope = wave_slopes(wave_slope_layers, wave_table, waves, at, footprint, amplitude, taken);
    vec2 lot = slope_lot(slope, taken, even_numbers(pixel));
    imageStore(surfaces, pixel - view.tile.xy, pack_surface(WaveSurface(slope, lot, level, taken)));
    return level;
}

// What the ray meets: ground, or the waves after as many stays in their slab as it takes.
bool find(Part part, Ray ray, float limit, out Hit hit) {
    float lift = waves.counts.w, sink = part.direction.z;
    bool from_above = !part.in_water;
    // Under water the slab begins at the level less the waves' bound.
    float below = part.level - lift - part.origin.z;
    float t_slab = from_above || sink <= 1e-6 ? far_m : max(below, 0.0) / sink;
    bool in_slab = part.in_water && below <= 0.0;
    for (int stay = 0; stay < 16; ++stay) {
        if (!in_slab) {
            bool found = trace_field(heights, bounds, field_of(view), ray, min(limit, t_slab), from_above, hit);
            if (found && !hit.water)
                return true;
            if (!found && (from_above || t_slab >= limit))
                return false;
            ray.begin = found ? hit.t : t_slab;
        }
        float t_left;
        int met = meet_waves(heights, wave_heights, amplitudes, wave_table, wave_limits, field_of(view), waves, view.base.xy,
                             view.camera.w, ray, from_above ? 1.0 : -1.0, limit, hit, t_left);
        if (met != met_nothing)
            return true;
        if (t_left >= limit)
            return false;
        ray.begin = t_left;
        in_slab = false;
        t_slab = far_m;
    }
    return false;
}
#endif

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + view.tile.xy;
    if (any(greaterThanEqual(pixel - view.tile.xy, view.tile.zw)))
        return;
    Part part = camera_part(view, pixel);
    float limit = reach(view, part), overlay_t = overlay_distance(pixel);
    Ray ray = ray_of(view, part);
    ray.begin = texelFetch(beams, pixel >> 3, 0).r;
    Hit hit;
    bool found = false;
    float level = 0.0;
#ifdef TARN_WAVES
    if (part.in_water)
        limit = view.backscattering.w; // the surface is where the waves are
    if (!part.in_water || part.bed_known)
        found = find(part, ray, min(limit, overlay_t), hit);
    if (found && hit.water)
        level = store_surface(pixel, part, hit);
#else
    if (!part.in_water || part.bed_known)
        found = trace_field(heights, bounds, field_of(view), ray, min(limit, overlay_t), !part.in_water, hit);
    level = part.origin.z + hit.t * part.direction.z;
#endif
    store(pixel, part, limit, overlay_t, found, hit, level);
}
