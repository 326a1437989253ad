#version 450 core
// passes/sunlight_photons.comp — sunlight through one patch of waves, gathered on tiles at some depths.
// Reads heights and slopes of the waves; adds to flux. One invocation a texel of the waves and cascade (z); with
// TARN_SUNLIGHT_BACK a texel of the tile.
//
// TARN_SUNLIGHT_METHOD, one of
//   0 splat        TARN_SUNLIGHT_PHOTONS^2 photons from each texel of the waves, shared out where they land
//   1 photon map   Baboud & Decoret 2006, sec. 4.3: a photon from a random place of each texel falls into one texel
//                  of the illumination map; passes/sunlight_tiles.comp filters it
//   2 mesh         Wallace 2016: cells of the refracted mesh carry their flux to the area that they come to; here it
//                  is shared out among the texels whose middles a triangle covers, so that none is lost at folds
//   3 back         after Guardado & Sanchez-Crespo 2004 (GPU Gems, ch. 2): straight
//                  up from the bed along the beam, and the brightness by how the surface there bends the light; flux
//                  is not kept
#include "shared/wave_block.h"
#include "lib/caustics.glsl"
#ifndef TARN_SUNLIGHT_METHOD
#define TARN_SUNLIGHT_METHOD 0
#endif
#ifndef TARN_SUNLIGHT_PHOTONS
#define TARN_SUNLIGHT_PHOTONS 1
#endif
#if TARN_SUNLIGHT_METHOD == 0
layout(local_size_x = 16, local_size_y = 16) in; // each with 2 x 2 photons
#else
layout(local_size_x = 8, local_size_y = 8) in;
#endif
layout(binding = TARN_TEXTURE_WAVES) uniform sampler2DArray heights;
layout(binding = TARN_TEXTURE_SLOPES) uniform sampler2DArray slopes;
layout(binding = TARN_BLOCK_SUNLIGHT, std140) uniform Sunlight { SunlightBlock light; };
layout(binding = TARN_BUFFER_SUNLIGHT, std430) buffer Flux { uint flux[]; };
layout(location = 0) uniform vec4 sun;     // xyz: towards it, w: index of refraction
layout(location = 1) uniform int side;     // texels of a tile
layout(location = 2) uniform bool schlick;
layout(location = 3) uniform ivec4 needed; // slices of each cascade

int cascade, texels;
vec2 straight; // lean below flat water, by the same arithmetic as any other

uint place(int slice, ivec2 at) {
    at &= side - 1;
    return uint(((cascade * int(light.beam.z) + slice) * side + at.y) * side + at.x);
}

void give(int slice, ivec2 at, float share) {
    uint amount = uint(share * TARN_SUNLIGHT_UNIT + 0.5);
    if (amount > 0u)
        atomicAdd(flux[place(slice, at)], amount);
}

#if TARN_SUNLIGHT_METHOD == 0 && !defined(TARN_SUNLIGHT_DIRECT)
// Most photons of a group land close together: they are gathered in shared memory, of which each texel is added to
// the tile once. (Software GL, which has no such memory, is quicker without: TARN_SUNLIGHT_DIRECT.)
const int window = 32;
shared uint gathered[window * window];
ivec2 window_corner;

void give_near(int slice, ivec2 at, float share) {
    ivec2 inside = at - window_corner;
    uint amount = uint(share * TARN_SUNLIGHT_UNIT + 0.5);
    if (all(greaterThanEqual(inside, ivec2(0))) && all(lessThan(inside, ivec2(window))))
        atomicAdd(gathered[inside.y * window + inside.x], amount);
    else if (amount > 0u)
        atomicAdd(flux[place(slice, at)], amount);
}
#define GIVE give_near
#else
#define GIVE give
#endif

// Shared out between the texels that a square around `at` covers; `at` in texels of the tile, middles at halves. A photon
// is as wide as their distance in flat water, which so comes out even: a texel is as wide as a whole number of them.
void splat(int slice, vec2 at, float share) {
    float wide = float(side) / float(texels * TARN_SUNLIGHT_PHOTONS);
    vec2 corner = floor(at - 0.5 * wide), part = clamp((at + 0.5 * wide - corner - 1.0) / wide, 0.0, 1.0);
    ivec2 low = ivec2(corner);
    GIVE(slice, low, share * (1.0 - part.x) * (1.0 - part.y));
    if (part.x > 0.0)
        GIVE(slice, low + ivec2(1, 0), share * part.x * (1.0 - part.y));
    if (part.y > 0.0) {
        GIVE(slice, low + ivec2(0, 1), share * (1.0 - part.x) * part.y);
        if (part.x > 0.0)
            GIVE(slice, low + ivec2(1, 1), share * part.x * part.y);
    }
}

float depth_of_slice(int slice) {
    return light.cascades[cascade].x * exp2(float(slice) / light.cascades[cascade].y);
}

// Where a photon that entered at `from` [texels of the tile] arrives, beside the beam of flat water.
vec2 landing(vec2 from, float height_m, Photon photon, float depth_m) {
    return from + (max(depth_m + height_m, 0.0) * photon.lean - depth_m * straight) / light.cascades[cascade].w;
}

Photon photon_at(ivec2 texel, out float height_m) {
    ivec3 at = ivec3(texel & (texels - 1), cascade);
    height_m = texelFetch(heights, at, 0).x;
    return photon_below(sun.xyz, texelFetch(slopes, at, 0).xy, sun.w, schlick);
}

#if TARN_SUNLIGHT_METHOD == 0
// Of a lattice TARN_SUNLIGHT_PHOTONS times as fine as the waves' texels; between them by the cubic through four
// (Catmull & Rom).
Photon photon_of_lattice(ivec2 number, out float height_m) {
#if TARN_SUNLIGHT_PHOTONS == 1
    return photon_at(number, height_m);
#else
    vec2 at = (vec2(number) + 0.5) / float(TARN_SUNLIGHT_PHOTONS) - 0.5, low = floor(at), t = at - low;
    vec2 w[4] = vec2[4](0.5 * t * (-1.0 + t * (2.0 - t)), 0.5 * (2.0 + t * t * (-5.0 + 3.0 * t)),
                        0.5 * t * (1.0 + t * (4.0 - 3.0 * t)), 0.5 * t * t * (t - 1.0));
    vec3 sum = vec3(0.0);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x) {
            ivec3 texel = ivec3((ivec2(low) + ivec2(x - 1, y - 1)) & (texels - 1), cascade);
            sum += w[x].x * w[y].y * vec3(texelFetch(heights, texel, 0).x, texelFetch(slopes, texel, 0).xy);
        }
    height_m = sum.x;
    return photon_below(sun.xyz, sum.yz, sun.w, schlick);
#endif
}
#endif

#if TARN_SUNLIGHT_METHOD == 1
uint hash(uint v) { // Wellons' lowbias32
    v = (v ^ v >> 16) * 0x7feb352du;
    v = (v ^ v >> 15) * 0x846ca68bu;
    return v ^ v >> 16;
}
#endif

#if TARN_SUNLIGHT_METHOD == 2
float cross2(vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; }

// A triangle's flux, evenly to the texels whose middles it covers; where it covers none, around its own middle.
void give_triangle(int slice, vec2 a, vec2 b, vec2 c, float share) {
    vec2 low = ceil(min(a, min(b, c)) - 0.5), high = min(floor(max(a, max(b, c)) - 0.5), low + 15.0);
    float turn = cross2(b - a, c - a);
    float way = turn < 0.0 ? -1.0 : 1.0;
    int covered = 0;
    for (int pass = 0; pass < 2; ++pass) {
        if (pass == 1 && covered == 0) {
            splat(slice, (a + b + c) / 3.0, share);
            return;
        }
        for (float y = low.y; y <= high.y; y += 1.0)
            for (float x = low.x; x <= high.x; x += 1.0) {
                vec2 p = vec2(x, y) + 0.5;
                vec3 inside = way * vec3(cross2(b - a, p - a), cross2(c - b, p - b), cross2(a - c, p - c));
                if (all(greaterThanEqual(inside, vec3(0.0)))) {
                    if (pass == 0)
                        ++covered;
                    else
                        give(slice, ivec2(int(x), int(y)), share / float(covered));
                }
            }
    }
}
#endif

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    cascade = int(gl_GlobalInvocationID.z);
    texels = textureSize(slopes, 0).x;
    int slices = needed[cascade];
    straight = photon_below(sun.xyz, vec2(0.0), sun.w, schlick).lean;
    float a_tile = float(side) / float(texels); // texels of the tile per texel of the waves
    float worth = a_tile * a_tile;              // of one photon: flat water fills each texel to 1
#if TARN_SUNLIGHT_METHOD == 0
    const int dense = TARN_SUNLIGHT_PHOTONS;
    a_tile /= float(dense);
    worth /= float(dense * dense);
    float heights_m[4];
    Photon photons[4];
    for (int c = 0; c < 4; ++c)
        photons[c] = photon_of_lattice(2 * texel + ivec2(c & 1, c >> 1), heights_m[c]);
#ifdef TARN_SUNLIGHT_DIRECT
    for (int c = 0; c < 4; ++c) {
        vec2 from = (vec2(2 * texel + ivec2(c & 1, c >> 1)) + 0.5) * a_tile;
        for (int k = 0; k < slices; ++k)
            splat(k, landing(from, heights_m[c], photons[c], depth_of_slice(k)), worth * photons[c].share);
    }
#else
    int index = int(gl_LocalInvocationIndex);
    for (int i = index; i < window * window; i += 256)
        gathered[i] = 0u;
    window_corner = ivec2((vec2(32 * gl_WorkGroupID.xy) + 16.0) * a_tile) - window / 2;
    for (int k = 0; k < slices; ++k) {
        barrier();
        for (int c = 0; c < 4; ++c) {
            vec2 from = (vec2(2 * texel + ivec2(c & 1, c >> 1)) + 0.5) * a_tile;
            splat(k, landing(from, heights_m[c], photons[c], depth_of_slice(k)), worth * photons[c].share);
        }
        barrier();
        for (int i = index; i < window * window; i += 256) {
            if (gathered[i] > 0u)
                atomicAdd(flux[place(k, window_corner + ivec2(i % window, i / window))], gathered[i]);
            gathered[i] = 0u;
        }
    }
#endif
#elif TARN_SUNLIGHT_METHOD == 1
    uint lot = hash(uint(texel.x + texels * texel.y) ^ uint(cascade) << 28);
    vec2 from = (vec2(texel) + vec2(lot & 0xffffu, lot >> 16) / 65536.0) * a_tile;
    vec3 there = vec3(from / float(side), float(cascade));
    float height = textureLod(heights, there, 0.0).x;
    Photon photon = photon_below(sun.xyz, textureLod(slopes, there, 0.0).xy, sun.w, schlick);
    for (int k = 0; k < slices; ++k)
        give(k, ivec2(floor(landing(from, height, photon, depth_of_slice(k)))), worth * photon.share);
#elif TARN_SUNLIGHT_METHOD == 2
    Photon corners[4];
    float high[4];
    for (int c = 0; c < 4; ++c)
        corners[c] = photon_at(texel + ivec2(c & 1, c >> 1), high[c]);
    for (int k = 0; k < slices; ++k) {
        float depth = depth_of_slice(k);
        vec2 at[4];
        for (int c = 0; c < 4; ++c)
            at[c] = landing((vec2(texel + ivec2(c & 1, c >> 1)) + 0.5) * a_tile, high[c], corners[c], depth);
        float third = worth / 6.0;
        give_triangle(k, at[0], at[1], at[2], third * (corners[0].share + corners[1].share + corners[2].share));
        give_triangle(k, at[1], at[3], at[2], third * (corners[1].share + corners[3].share + corners[2].share));
    }
#else
    if (any(greaterThanEqual(texel, ivec2(side))))
        return;
    // The lean's own slope, by differences over a texel of the tile.
    float texel_m = light.cascades[cascade].w, height;
    Photon by[5];
    for (int c = 0; c < 5; ++c) {
        vec2 off = c == 0 ? vec2(0.0) : c == 1 ? vec2(0.5, 0.0) : c == 2 ? vec2(-0.5, 0.0) : c == 3 ? vec2(0.0, 0.5) : vec2(0.0, -0.5);
        vec3 there = vec3((vec2(texel) + 0.5 + off) / float(side), float(cascade));
        by[c] = photon_below(sun.xyz, textureLod(slopes, there, 0.0).xy, sun.w, schlick);
    }
    vec2 east = (by[1].lean - by[2].lean) / texel_m, north = (by[3].lean - by[4].lean) / texel_m;
    for (int k = 0; k < slices; ++k) {
        float depth = depth_of_slice(k);
        float area = abs((1.0 + depth * east.x) * (1.0 + depth * north.y) - depth * depth * east.y * north.x);
        give(k, texel, by[0].share / max(area, 0.05));
    }
#endif
}
