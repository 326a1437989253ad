#version 450 core
// passes/first_hit.comp — distance to what each pixel's ray meets first, and nothing else: what the
// comparison of methods times and judges.
// Reads heights, bounds and beams; writes distances: > 0 ground, < 0 water, 0 nothing. One invocation a
// pixel. Rays that go on after their first look into a cell are regrouped: lib/regroup.glsl.
#include "lib/camera.glsl"
#include "lib/walk.glsl"
#include "lib/regroup.glsl"

layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_TEXTURE_BOUNDS) uniform sampler2D bounds;
layout(binding = TARN_TEXTURE_BEAMS) uniform sampler2D beams;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_IMAGE_DISTANCE, r32f) uniform writeonly image2D distance_image;

Ray ray_through(ivec2 pixel) {
    vec2 place = (vec2(pixel) + view.offset.xy) * view.inverse_size.zw;
    vec3 direction =
        pixel_direction(view.forward.xyz, view.right.xyz, view.up.xyz, vec2(view.right.w, view.up.w), place);
    return ray_from(field_of(view), view.base.xy, view.camera.xyz, direction);
}

void store(ivec2 pixel, bool found, Hit hit) {
    imageStore(distance_image, pixel, vec4(!found ? 0.0 : hit.water ? -hit.t : hit.t));
}

void main() {
    ivec2 pixel = regroup_pixel();
    bool from_above = (view.counts.z & TARN_FLAG_UNDER_WATER) == 0u;
    bool inside = all(lessThan(pixel, ivec2(view.counts.xy)));
    Hit hit;
#ifdef TARN_REGROUP
    regroup_begin();
    if (inside) {
        Ray ray = ray_through(pixel);
        ray.begin = texelFetch(beams, pixel >> 3, 0).r;
        float t;
        int state = walk_on(heights, bounds, field_of(view), ray, 1e9, from_above, 1, hit, t);
        if (state == walk_unfinished)
            regroup_wait(t);
        else
            store(pixel, state == walk_hit, hit);
    }
    float begin;
    if (!regroup_next(pixel, begin))
        return;
    Ray ray = ray_through(pixel);
    ray.begin = begin;
    store(pixel, trace_field(heights, bounds, field_of(view), ray, 1e9, from_above, hit), hit);
#else
    if (!inside)
        return;
    Ray ray = ray_through(pixel);
    ray.begin = texelFetch(beams, pixel >> 3, 0).r;
    store(pixel, trace_field(heights, bounds, field_of(view), ray, 1e9, from_above, hit), hit);
#endif
}
