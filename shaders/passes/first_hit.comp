#version 450 core
// passes/first_hit.comp — distance to what each pixel's ray meets first, and nothing else: what the
// comparison of methods times and judges.
// Reads heights, bounds and beams; writes distances: > 0 ground, < 0 water, 0 nothing. One invocation a
// pixel.
#include "lib/camera.glsl"
#include "lib/walks/chosen.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_TEXTURE_BOUNDS) uniform sampler2D bounds;
layout(binding = TARN_TEXTURE_BEAMS) uniform sampler2D beams;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_IMAGE_DISTANCE, r32f) uniform writeonly image2D distance_image;

Ray ray_through(ivec2 pixel) {
    vec2 place = (vec2(pixel) + view.offset.xy) * view.inverse_size.zw;
    vec3 direction =
        pixel_direction(view.forward.xyz, view.right.xyz, view.up.xyz, vec2(view.right.w, view.up.w), place);
    bool from_above = (view.counts.z & TARN_FLAG_UNDER_WATER) == 0u;
    return from_above ? air_ray(field_of(view), view.base.xy, view.camera.xyz, direction)
                      : ray_from(field_of(view), view.base.xy, view.camera.xyz, direction);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, ivec2(view.counts.xy))))
        return;
    bool from_above = (view.counts.z & TARN_FLAG_UNDER_WATER) == 0u;
    Ray ray = ray_through(pixel);
    ray.begin = texelFetch(beams, pixel >> 3, 0).r;
    Hit hit;
    float t = 0.0;
    if (trace_field(heights, bounds, field_of(view), ray, 1e9, from_above, hit))
        t = max(hit.t, 1e-6) * (hit.water ? -1.0 : 1.0);
    imageStore(distance_image, pixel, vec4(t));
}
