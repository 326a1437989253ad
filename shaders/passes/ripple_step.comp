#version 450 core
// passes/ripple_step.comp — one step of the wave equation for ripples.
// Reads heights now and before, and the mask; writes heights next. One invocation a texel.
//
// Source  leapfrog with linear damping; at an absorbing edge the one-way wave equation (Engquist & Majda 1977),
//         at a reflecting one no slope across it.
layout(local_size_x = 16, local_size_y = 8) in;
layout(binding = 0, r32f) uniform readonly image2D now;
layout(binding = 1, r32f) uniform readonly image2D before;
layout(binding = 2, r32f) uniform writeonly image2D next;
layout(binding = 3, r8ui) uniform readonly uimage2D mask; // 0 water, 1 land that reflects, 2 land that absorbs
layout(location = 0) uniform int edge;       // 0 wraps around, 1 reflects, 2 absorbs
layout(location = 1) uniform float courant;  // travel in a step [texels]
layout(location = 2) uniform float damping;  // times the step
layout(location = 3) uniform uint number;    // of the step
layout(location = 4) uniform uint seed;
layout(location = 5) uniform vec3 rain;      // x: chance of a drop in a cell, y: its height [m], z: radius [texels]
layout(location = 6) uniform vec4 poke;      // xy: place [texels], z: height [m], w: radius [texels], 0 = none
layout(location = 7) uniform vec4 last_poke; // of the step before
layout(location = 8) uniform bool rained_before; // in the step before
#include "lib/noise.glsl"

const int cell = 16; // texels a side, at most one drop in each

// Height that a drop leaves: it moves water outwards, and adds none.
float drop(vec2 off, float radius) {
    float u = dot(off, off) / (radius * radius);
    return u < 12.0 ? (1.0 - u) * exp(-u) : 0.0;
}

float rained(ivec2 texel, int side, uint number) {
    float sum = 0.0;
    int cells = side / cell;
    for (int k = 0; k < 9; ++k) {
        ivec2 at = texel / cell + ivec2(k % 3 - 1, k / 3 - 1), wrapped = (at + cells) % cells;
        uint lot = lattice_hash(wrapped, seed ^ number * 0x9e3779b9u);
        if (float(lot >> 8) >= rain.x * 16777216.0)
            continue;
        uint where = lattice_hash(wrapped, seed + 77u ^ number * 0x85ebca6bu);
        vec2 place = vec2(at * cell) + vec2(where & 0xffffu, where >> 16) * (float(cell) / 65536.0);
        sum += rain.y * drop(vec2(texel) - place, rain.z);
    }
    return sum;
}

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(now);
    if (any(greaterThanEqual(texel, size)) || imageLoad(mask, texel).r != 0u)
        return;
    float here = imageLoad(now, texel).r, sum = 0.0, inward = 0.0;
    int open = 0; // sides where waves run out
    for (int k = 0; k < 4; ++k) {
        ivec2 step = k < 2 ? ivec2(2 * k - 1, 0) : ivec2(0, 2 * k - 5);
        ivec2 other = texel + step;
        uint kind = 0u;
        if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, size))) {
            kind = uint(edge);
            other = (other + size) % size;
        }
        if (kind == 0u)
            kind = imageLoad(mask, other).r;
        if (kind == 2u) {
            ++open;
            ivec2 back = clamp(texel - step, ivec2(0), size - 1);
            inward += imageLoad(now, back).r - here;
        } else {
            sum += kind == 1u ? 0.0 : imageLoad(now, other).r - here;
        }
    }
    // What falls displaces the water without a push: the state before it is displaced alike.
    float past = imageLoad(before, texel).r;
    if (rained_before)
        past += rained(texel, size.x, number - 1u);
    if (last_poke.w > 0.0)
        past += last_poke.z * drop(vec2(texel) - last_poke.xy, last_poke.w);
    float result;
    if (open > 0)
        result = here + courant * inward / float(open);
    else
        result = (2.0 * here - (1.0 - damping) * past + courant * courant * sum) / (1.0 + damping);
    if (rain.x > 0.0)
        result += rained(texel, size.x, number);
    if (poke.w > 0.0)
        result += poke.z * drop(vec2(texel) - poke.xy, poke.w);
    imageStore(next, texel, vec4(result));
}
