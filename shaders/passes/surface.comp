#version 450 core
// passes/surface.comp — where the moving water, or the ground beside it, is met by rays that have come to its slab,
// and how the surface stands there. Run after passes/primary.comp, with waves only.
// Reads hits 0, heights and the waves; writes hits 0, distances and surfaces. One invocation a pixel of the tile.
//
// A camera above or below the slab sees rays enter it and never leave it: they end inside. One within it
// (TARN_IN_SLAB) sends rays out of it, too; those go on by the walk, until they come to a slab again.
#include "lib/parts.glsl"
#include "lib/walks/meet_waves.glsl"
#ifdef TARN_IN_SLAB
#include "lib/walks/chosen.glsl"
#endif

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_TEXTURE_BOUNDS) uniform sampler2D bounds;
layout(binding = TARN_TEXTURE_OVERLAY) uniform sampler2D overlay;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_BLOCK_WAVES, std140) uniform Waves { WaveBlock waves; };
layout(binding = TARN_TEXTURE_WAVES) uniform sampler2DArray wave_heights;
layout(binding = TARN_TEXTURE_SLOPES) uniform sampler2DArray wave_slope_layers;
layout(binding = TARN_TEXTURE_AMPLITUDE) uniform sampler2D amplitudes;
layout(binding = TARN_TEXTURE_WAVE_TABLE) uniform sampler2D wave_table;
layout(binding = TARN_TEXTURE_WAVE_LIMITS) uniform usamplerBuffer wave_limits;
layout(binding = TARN_IMAGE_HITS, rgba32ui) uniform uimage2D hits;
layout(binding = TARN_IMAGE_SURFACE, rgba32ui) uniform writeonly uimage2D surfaces;
layout(binding = TARN_IMAGE_DISTANCE, r32f) uniform writeonly image2D distance_image;

// The surface where the waves were met, for the passes that follow.
void store_surface(ivec2 local, ivec2 pixel, Part part, End end) {
    vec4 ground = textureGather(heights, (vec2(end.cell) + 1.0) * view.inverse_size.xy, 0) * view.heights.y;
    float level = surface_level(heights, view, part, end);
    vec2 at = (vec2(end.cell) + end.inside - view.base.xy) * view.grid.z;
    at.y = -at.y;
    vec4 amplitude = wave_fade(waves, level - bilinear(ground, end.inside)) * wave_amplitude(amplitudes, waves, at);
    vec3 direction = direction_after(view, part, end.t);
    float footprint = wave_footprint(view.camera.w, end.t, direction.z), bright;
    vec3 taken;
    vec2 mean = wave_slopes(wave_slope_layers, wave_table, waves, at, footprint, amplitude, taken);
    vec3 to_viewer = (part.in_water ? 1.0 : -1.0) * direction;
    vec2 lot = draw_slope(lot_of(view, pixel), view.offset.z, to_viewer, mean, taken, part.in_water ? 0.0 : 1.0 / view.optics.x, bright);
    imageStore(surfaces, local, pack_surface(WaveSurface(mean, lot, bright, taken)));
}

void main() {
    ivec2 local = ivec2(gl_GlobalInvocationID.xy), pixel = pixel_of(view, local);
    if (any(greaterThanEqual(local, view.tile.zw)))
        return;
    End end = unpack_end(imageLoad(hits, local));
    Part part = camera_part(view, pixel);
    bool at_slab = (end.flags & end_surface) != 0u;
#ifdef TARN_IN_SLAB
    at_slab = at_slab || (part.in_water && part.bed_known);
#endif
    if (!at_slab || left_out(view, part))
        return;
    float overlay_t = far_m;
    if ((view.counts.z & TARN_FLAG_OVERLAY) != 0u) {
        float t = texelFetch(overlay, pixel, 0).a;
        overlay_t = t > 0.0 ? t : far_m;
    }
    float reach_m = part.in_water ? view.optics.y : far_m, limit = min(reach_m, overlay_t);
    Ray ray = ray_of(view, part);
    ray.begin = end.t;
    Hit hit;
    float t_left;
#ifdef TARN_IN_SLAB
    if (part.in_water)
        ray.begin = 0.0;
    int met = met_nothing;
    for (int stay = 0; stay < 16; ++stay) {
        met = meet_waves(heights, wave_heights, amplitudes, wave_table, wave_limits, field_of(view), waves, view.base.xy,
                         view.camera.w, ray, part.in_water ? -1.0 : 1.0, limit, hit, t_left);
        if (met != met_nothing || t_left >= limit)
            break;
        if (part.in_water)
            return; // below the slab the first pass was right
        ray.begin = t_left;
        if (!trace_field(heights, bounds, field_of(view), ray, limit, true, hit))
            break;
        met = hit.water ? met_nothing : met_ground;
        if (met == met_ground)
            break;
        ray.begin = hit.t;
    }
#else
    int met = meet_waves(heights, wave_heights, amplitudes, wave_table, wave_limits, field_of(view), waves, view.base.xy,
                         view.camera.w, ray, part.in_water ? -1.0 : 1.0, limit, hit, t_left);
#endif
    uint known = end.flags & end_bed_known;
    if (met != met_nothing)
        end = End(hit.t, hit.cell, hit.inside, met == met_water ? end_surface | known : end_ground);
    else if (overlay_t <= reach_m && overlay_t < far_m)
        end = End(overlay_t, ivec2(0), vec2(0.0), end_overlay);
    else
        end = End(reach_m, ivec2(0), vec2(0.0), 0u);
    imageStore(hits, local, pack_end(end));
    if (met == met_water)
        store_surface(local, pixel, part, end);
    if (view.offset.z < 0.5)
        imageStore(distance_image, pixel, vec4(end.flags != 0u ? end.t : far_m));
}
