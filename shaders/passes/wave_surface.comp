#version 450 core
// passes/wave_surface.comp — one height and one slope over each place, from the transformed fields, and the first
// three mip levels of both, since they are at hand.
// Reads fields; writes levels 0 to 3 of the waves' textures, and their limits. One invocation a texel and cascade (z).
//
// Choppy water (Tessendorf 2001, sec. 3.5): the point over x came from x' with x' + choppiness D(x') = x, found
// by repeated substitution and Newton's method. There is one such point while nothing folds; `choppiness` is
// bounded to keep it so (src/waves/sea.hpp). Whatever happens, there is one height over each place. Slopes are those of the
// displaced surface: the transposed inverse of the Jacobian times the spectral derivative.
#include "shared/wave_block.h"
#ifndef TARN_FFT_N
#define TARN_FFT_N 512
#endif
#ifndef TARN_WAVE_FIELDS
#define TARN_WAVE_FIELDS 2 // pairs of pairs: 1 without displacement
#endif
layout(local_size_x = 16, local_size_y = 16) in;
layout(binding = TARN_BUFFER_WAVE_FIELDS, std430) readonly buffer Fields { vec4 fields[]; };
layout(binding = TARN_IMAGE_WAVE_HEIGHTS, r32f) uniform writeonly image2DArray heights[4];
layout(binding = TARN_IMAGE_WAVE_SLOPES, rg16f) uniform writeonly image2DArray slopes[4];
layout(binding = TARN_BUFFER_WAVE_LIMITS, std430) buffer Limits { uint limits[]; };
layout(location = 0) uniform vec4 choppiness;
layout(location = 1) uniform vec4 bound;  // on |height| [m]
layout(location = 2) uniform vec4 per_m;  // texels a metre

shared vec3 tile[256];
shared uint highest[4]; // of each level
shared uint steepest;
#ifdef TARN_MEASURE_FOLDS
shared uint folded;
#endif

uint place(uint cascade, uint field, ivec2 at) {
    const int n = TARN_FFT_N;
    at &= n - 1;
    return ((cascade * uint(TARN_WAVE_FIELDS) + field) * uint(n) + uint(at.y)) * uint(n) + uint(at.x);
}

// Bilinear, in texels.
vec4 sampled(uint cascade, uint field, vec2 at) {
    vec2 whole = floor(at), part = at - whole;
    ivec2 i = ivec2(whole);
    return mix(mix(fields[place(cascade, field, i)], fields[place(cascade, field, i + ivec2(1, 0))], part.x),
               mix(fields[place(cascade, field, i + ivec2(0, 1))], fields[place(cascade, field, i + ivec2(1, 1))], part.x),
               part.y);
}

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    uint cascade = gl_GlobalInvocationID.z;
    float height;
    vec2 slope;
    float least = 1.0;
#if TARN_WAVE_FIELDS == 2
    float chop = choppiness[cascade], scale = chop * per_m[cascade];
    vec2 from = vec2(texel);
    vec4 shift;  // Dx, Dy, d Dx / dx, d Dy / dy
    for (int i = 0; i < 10; ++i) {
        shift = sampled(cascade, 1u, from);
        vec2 off = vec2(texel) - from - scale * shift.xy;
        if (dot(off, off) < 1e-4) // a hundredth of a texel
            break;
        if (i >= 2) { // where substitution is slow, the displacement's own slope helps (Newton)
            float xy = chop * sampled(cascade, 0u, from).y;
            vec2 diagonal = 1.0 + chop * shift.zw;
            off = vec2(diagonal.y * off.x - xy * off.y, diagonal.x * off.y - xy * off.x) /
                  max(diagonal.x * diagonal.y - xy * xy, 0.05);
        }
        from += off;
    }
    vec4 rise = sampled(cascade, 0u, from); // height, d Dx / dy, slopes
    slope = rise.zw;
    float xx = 1.0 + chop * shift.z, yy = 1.0 + chop * shift.w, xy = chop * rise.y;
    float middle = 0.5 * (xx + yy), reach = length(vec2(0.5 * (xx - yy), xy));
    least = middle - reach;
    // A fold would turn slopes over; held where the surface is steep but still a height field.
    float determinant = max(least, 0.05) * max(middle + reach, 0.05);
    slope = vec2(yy * slope.x - xy * slope.y, xx * slope.y - xy * slope.x) / determinant;
    height = rise.x;
#else
    vec4 rise = fields[place(cascade, 0u, texel)];
    height = rise.x;
    slope = rise.zw;
#endif
    height = clamp(height, -bound[cascade], bound[cascade]);
    // Limits that the walk trusts, and mip levels by halving the tile.
    ivec2 local = ivec2(gl_LocalInvocationID.xy);
    uint index = gl_LocalInvocationIndex;
    vec3 sum = vec3(height, slope);
    tile[index] = sum;
    if (index < 4u)
        highest[index] = 0u;
    if (index == 4u)
        steepest = 0u;
    barrier();
    // Between texels the surface rises as its neighbours differ; at the tile's rim its own slope has to tell.
    float east = local.x < 15 ? abs(tile[index + 1u].x - height) * per_m[cascade] : abs(slope.x);
    float north = local.y < 15 ? abs(tile[index + 16u].x - height) * per_m[cascade] : abs(slope.y);
    atomicMax(steepest, floatBitsToUint(length(vec2(max(east, abs(slope.x)), max(north, abs(slope.y))))));
    for (int level = 0; level < 4; ++level) {
        int wide = 16 >> level;
        bool at_work = all(lessThan(local, ivec2(wide)));
        if (at_work) {
            ivec3 at = ivec3(ivec2(gl_WorkGroupID.xy) * wide + local, int(cascade));
            imageStore(heights[level], at, vec4(sum.x));
            imageStore(slopes[level], at, vec4(sum.yz, 0.0, 0.0));
            atomicMax(highest[level], floatBitsToUint(abs(sum.x)));
        }
        if (level == 3)
            break;
        barrier();
        if (level > 0 && at_work)
            tile[16 * local.y + local.x] = sum;
        barrier();
        if (all(lessThan(local, ivec2(wide / 2)))) {
            int first = 32 * local.y + 2 * local.x;
            sum = 0.25 * (tile[first] + tile[first + 1] + tile[first + 16] + tile[first + 17]);
        }
    }
    barrier();
    uint limit = cascade * uint(TARN_WAVE_LIMITS);
    if (index < 4u)
        atomicMax(limits[limit + index], highest[index]);
    if (index == 4u) // no texel's patch is steeper than the steepest edges on both axes together
        atomicMax(limits[limit + uint(TARN_WAVE_LEVELS)], floatBitsToUint(1.4143 * uintBitsToFloat(steepest)));
#ifdef TARN_MEASURE_FOLDS // when asked: a picture needs no such number
    if (gl_LocalInvocationIndex == 0u)
        folded = 0u;
    barrier();
    atomicMax(folded, floatBitsToUint(max(1.0 - least, 0.0)));
    barrier();
    if (gl_LocalInvocationIndex == 0u)
        atomicMax(limits[cascade * uint(TARN_WAVE_LIMITS) + uint(TARN_WAVE_LEVELS + 1)], folded);
#endif
}
