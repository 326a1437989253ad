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
layout(location = 3) uniform int first_layer;
shared vec3 tile[64];
shared uint highest[5];  // of the source and of the levels made here
shared uint steepest;

void main() {
    int cascade = first_layer + int(gl_GlobalInvocationID.z), side = textureSize(waves, source).x;
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    uint index = gl_LocalInvocationIndex;
    if (index < 5u)
        highest[index] = 0u;
    if (index == 5u)
        steepest = 0u;
    barrier();
    vec3 sum = vec3(0.0);
    float high = 0.0;
    vec2 rise = vec2(0.0);
    if (2 * at.x < side && 2 * at.y < side) {
        for (int k = 0; k < 4; ++k) {
            ivec2 here = 2 * at + ivec2(k & 1, k >> 1);
            float height = texelFetch(waves, ivec3(here, cascade), source).x;
            sum += 0.25 * vec3(height, texelFetch(slopes, ivec3(here, cascade), source).xy);
            high = max(high, abs(height));
            if (source == 0) {
                float east = texelFetch(waves, ivec3((here.x + 1) & (side - 1), here.y, cascade), 0).x;
                float north = texelFetch(waves, ivec3(here.x, (here.y + 1) & (side - 1), cascade), 0).x;
                rise = max(rise, abs(vec2(east, north) - height));
            }
        }
        if (source == 0) {
            atomicMax(highest[0], floatBitsToUint(high));
            atomicMax(steepest, floatBitsToUint(length(rise)));
        }
    }
    ivec2 local = ivec2(gl_LocalInvocationID.xy);
    for (int level = 0; level < levels; ++level) {
        int wide = 8 >> level; // invocations at work
        if (all(lessThan(local, ivec2(wide))) && all(lessThan(at, ivec2(side >> (level + 1))))) {
            imageStore(coarser[level], ivec3(at, cascade), vec4(sum.x));
            imageStore(coarser_slopes[level], ivec3(at, cascade), vec4(sum.yz, 0.0, 0.0));
            atomicMax(highest[level + 1], floatBitsToUint(abs(sum.x)));
        }
        tile[index] = sum;
        barrier();
        at = ivec2(gl_WorkGroupID.xy) * (wide / 2) + local;
        if (all(lessThan(local, ivec2(wide / 2))))
            sum = 0.25 * (tile[16 * local.y + 2 * local.x] + tile[16 * local.y + 2 * local.x + 1] +
                          tile[16 * local.y + 8 + 2 * local.x] + tile[16 * local.y + 9 + 2 * local.x]);
        barrier();
    }
    uint first = uint(cascade * TARN_WAVE_LIMITS);
    if (index <= uint(levels) && (index > 0u || source == 0))
        atomicMax(limits[first + uint(source) + index], highest[index]);
    if (index == 0u && source == 0) // no texel's patch is steeper than the steepest edges on both axes together
        atomicMax(limits[first + uint(TARN_WAVE_LEVELS)],
                  floatBitsToUint(1.4143 * uintBitsToFloat(steepest) * per_m[cascade]));
}
