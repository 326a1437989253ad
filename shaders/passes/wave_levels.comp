#version 450 core
// passes/wave_levels.comp — up to four mip levels of the waves' textures from the one below them, and how high
// and steep the water is at each: the walk's bounds follow the waves that are there.
// Reads level `source`; writes the next `levels`, and limits. A workgroup 16 x 16 texels and a cascade (z).
#include "shared/wave_block.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_WAVES) uniform sampler2DArray waves;
layout(binding = TARN_TEXTURE_SLOPES) uniform sampler2DArray slopes;
layout(binding = TARN_IMAGE_WAVE_HEIGHTS, r32f) uniform writeonly image2DArray coarser[4];
layout(binding = TARN_IMAGE_WAVE_SLOPES, rg16f) uniform writeonly image2DArray coarser_slopes[4];
layout(binding = TARN_BUFFER_WAVE_LIMITS, std430) buffer Limits { uint limits[]; };
layout(location = 0) uniform int source;
layout(location = 1) uniform int levels;
layout(location = 2) uniform vec4 per_m; // texels of level 0 a metre
// Height and slopes; greatest |height| of the source and of the levels made so far, and the steepest slope.
shared vec3 tile[64];
shared vec4 tops[64];
shared vec2 rest[64];

// Maxima go up with the means: no invocation waits for another's atomic.
void main() {
    int cascade = int(gl_GlobalInvocationID.z), side = textureSize(waves, source).x;
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    uint index = gl_LocalInvocationIndex;
    vec3 sum = vec3(0.0);
    vec4 top = vec4(0.0);  // of the source, and of the first three levels
    vec2 more = vec2(0.0); // of the fourth; steepest difference between neighbours of the source
    if (2 * at.x < side && 2 * at.y < side) {
        vec2 rise = vec2(0.0);
        for (int k = 0; k < 4; ++k) {
            ivec2 here = 2 * at + ivec2(k & 1, k >> 1);
            float height = texelFetch(waves, ivec3(here, cascade), source).x;
            sum += 0.25 * vec3(height, texelFetch(slopes, ivec3(here, cascade), source).xy);
            top.x = max(top.x, abs(height));
            if (source == 0) {
                float east = texelFetch(waves, ivec3((here.x + 1) & (side - 1), here.y, cascade), 0).x;
                float north = texelFetch(waves, ivec3(here.x, (here.y + 1) & (side - 1), cascade), 0).x;
                rise = max(rise, abs(vec2(east, north) - height));
            }
        }
        more.y = length(rise);
    }
    ivec2 local = ivec2(gl_LocalInvocationID.xy);
    for (int level = 0; level < levels; ++level) {
        int wide = 8 >> level; // invocations at work
        if (all(lessThan(local, ivec2(wide))) && all(lessThan(at, ivec2(side >> (level + 1))))) {
            imageStore(coarser[level], ivec3(at, cascade), vec4(sum.x));
            imageStore(coarser_slopes[level], ivec3(at, cascade), vec4(sum.yz, 0.0, 0.0));
            if (level < 3)
                top[level + 1] = abs(sum.x);
            else
                more.x = abs(sum.x);
        }
        if (level + 1 == levels && wide == 1)
            break;
        tile[index] = sum;
        tops[index] = top;
        rest[index] = more;
        barrier();
        at = ivec2(gl_WorkGroupID.xy) * (wide / 2) + local;
        if (all(lessThan(local, ivec2(wide / 2)))) {
            int first = 16 * local.y + 2 * local.x;
            sum = 0.25 * (tile[first] + tile[first + 1] + tile[first + 8] + tile[first + 9]);
            top = max(max(tops[first], tops[first + 1]), max(tops[first + 8], tops[first + 9]));
            more = max(max(rest[first], rest[first + 1]), max(rest[first + 8], rest[first + 9]));
        }
        barrier();
    }
    // Fewer levels than four leave several invocations with maxima of their own.
    if (any(greaterThanEqual(local, ivec2(max(8 >> levels, 1)))))
        return;
    uint limit = uint(cascade * TARN_WAVE_LIMITS + source);
    if (source == 0) {
        atomicMax(limits[limit], floatBitsToUint(top.x));
        // No texel's patch is steeper than the steepest edges on both axes together.
        atomicMax(limits[limit + uint(TARN_WAVE_LEVELS)], floatBitsToUint(1.4143 * more.y * per_m[cascade]));
    }
    for (int level = 1; level <= levels; ++level)
        atomicMax(limits[limit + uint(level)], floatBitsToUint(level < 4 ? top[level] : more.x));
}
