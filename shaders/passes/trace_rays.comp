#version 450 core
// passes/trace_rays.comp — first hits of rays from a list: what tests and the failure table ask.
// Reads heights, bounds and rays; writes answers: path length [m], 0 nothing / 1 ground / 2 water, column and row
// of the hit. One invocation a ray.
#include "lib/walks/chosen.glsl"

layout(local_size_x = 64) in;
layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_TEXTURE_BOUNDS) uniform sampler2D bounds;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_BUFFER_RAYS, std430) readonly buffer Rays { vec4 rays[]; }; // origin and direction by turns, base in w
layout(binding = TARN_BUFFER_ANSWERS, std430) writeonly buffer Answers { vec4 answers[]; };
layout(location = 0) uniform bool with_water;
layout(location = 1) uniform float t_max;

void main() {
    uint i = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * 65536u;
    if (i >= uint(answers.length()))
        return;
    vec4 origin = rays[2u * i], direction = rays[2u * i + 1u];
    Field field = field_of(view);
    Ray ray = air_ray(field, vec2(origin.w, direction.w), origin.xyz, direction.xyz);
    Hit hit;
    vec4 answer = vec4(0.0);
    if (trace_field(heights, bounds, field, ray, t_max, with_water, hit))
        answer = vec4(hit.t, hit.water ? 2.0 : 1.0, vec2(hit.cell) + hit.inside);
    answers[i] = answer;
}
