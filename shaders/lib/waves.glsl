// lib/waves.glsl — how high and how steep the water is at a place. Pure functions; samplers are parameters.
// C++ twin: src/reference/waves.hpp
//
// A program that draws waves defines TARN_WAVES 1 and TARN_CASCADES 0 to 4; others include nothing of it.
// Positions are metres east and north of the node `base` (shared/wave_block.h). What is narrower than
// `footprint_m` is not drawn but counted: slopes come with the covariance of what was taken away, so that
// glitter and mirrored sky keep their mean at every distance.
#include "shared/wave_block.h"
#ifndef TARN_CASCADES
#define TARN_CASCADES 4
#endif

// Heights of the cascades' waves relative to the roughest place.
vec4 wave_amplitude(sampler2D map, WaveBlock waves, vec2 at_m) {
    return textureLod(map, waves.map.xy + at_m * waves.map.zw, 0.0);
}

// wave_fade — 1 in deep water, linearly to 0 at the shore.
float wave_fade(WaveBlock waves, float depth_m) { return clamp(depth_m / waves.shore.x, 0.0, 1.0); }

float wave_level(WaveBlock waves, int cascade, float footprint_m) {
    return max(log2(max(footprint_m, 1e-6) / waves.patches[cascade].w), 0.0);
}

// What is left of a sine after a square filter: a Gaussian one of the same variance.
float sine_share(vec2 k, float footprint_m) { return exp(-dot(k, k) * footprint_m * footprint_m / 24.0); }

// cascade_height — of one cascade at full amplitude [m], at a mip level.
float cascade_height(sampler2DArray heights, WaveBlock waves, int cascade, vec2 at_m, float level) {
    vec2 place = waves.patches[cascade].xy + at_m / waves.patches[cascade].z;
    return textureLod(heights, vec3(place, float(cascade)), level).x;
}

// sine_height — of the sines together [m].
float sine_height(sampler2D table, WaveBlock waves, vec2 at_m, float footprint_m, float amplitude) {
    float sum = 0.0;
    for (int i = 0; i < int(waves.counts.x); ++i) {
        vec4 sine = texelFetch(table, ivec2(i, 4), 0);
        sum += amplitude * sine.z * sine_share(sine.xy, footprint_m) * cos(dot(sine.xy, at_m) + sine.w);
    }
    return sum;
}

// wave_height — metres above the level.
float wave_height(sampler2DArray heights, sampler2D table, WaveBlock waves, vec2 at_m, float footprint_m, vec4 amplitude) {
    float sum = sine_height(table, waves, at_m, footprint_m, amplitude.x);
    for (int j = 0; j < TARN_CASCADES; ++j)
        sum += amplitude[j] * cascade_height(heights, waves, j, at_m, wave_level(waves, j, footprint_m));
    return sum;
}

// wave_slopes — of the filtered surface: rise per metre east (x) and north (y). The fade's own slope, which is
//               that of the bed times the height over the depth, is left out.
//
//   taken  covariance xx, xy, yy of the slopes that the filter took away
vec2 wave_slopes(sampler2DArray slopes, sampler2D table, WaveBlock waves, vec2 at_m, float footprint_m, vec4 amplitude,
                 out vec3 taken) {
    vec2 sum = vec2(0.0);
    taken = waves.rough.xyz * amplitude[max(TARN_CASCADES - 1, 0)] * amplitude[max(TARN_CASCADES - 1, 0)];
    for (int j = 0; j < TARN_CASCADES; ++j) {
        vec2 place = waves.patches[j].xy + at_m / waves.patches[j].z;
        float level = wave_level(waves, j, footprint_m), column = min(level, float(TARN_WAVE_LEVELS - 1));
        sum += amplitude[j] * textureLod(slopes, vec3(place, float(j)), level).xy;
        ivec2 low = ivec2(int(column), j);
        vec3 lost = mix(texelFetch(table, low, 0).xyz,
                        texelFetch(table, ivec2(min(low.x + 1, TARN_WAVE_LEVELS - 1), j), 0).xyz, fract(column));
        taken += amplitude[j] * amplitude[j] * lost;
    }
    for (int i = 0; i < int(waves.counts.x); ++i) {
        vec4 sine = texelFetch(table, ivec2(i, 4), 0);
        float a = amplitude.x * sine.z, share = sine_share(sine.xy, footprint_m);
        sum -= a * share * sine.xy * sin(dot(sine.xy, at_m) + sine.w);
        taken += 0.5 * a * a * (1.0 - share * share) * vec3(sine.x * sine.x, sine.x * sine.y, sine.y * sine.y);
    }
    return sum;
}

// The water's surface where a ray met it.
struct WaveSurface {
    vec2 mean, lot;   // slopes: filtered, and one drawn from those inside the pixel
    float level;      // of the lake [m]
    vec3 taken;       // covariance of the slopes inside the pixel
};

// pack_surface — slopes to a two-thousandth of theirs, standard deviations to a thousandth, up to 1.
uvec4 pack_surface(WaveSurface s) {
    vec2 deviation = sqrt(max(s.taken.xz, vec2(1e-12)));
    float correlation = clamp(s.taken.y / (deviation.x * deviation.y), -1.0, 1.0);
    uvec3 parts = uvec3(round(vec3(min(deviation, 1.0) * 2047.0, (0.5 + 0.5 * correlation) * 1023.0)));
    return uvec4(packHalf2x16(s.mean), packHalf2x16(s.lot), floatBitsToUint(s.level), parts.x | parts.y << 11 | parts.z << 22);
}

WaveSurface unpack_surface(uvec4 p) {
    vec2 deviation = vec2(p.w & 2047u, p.w >> 11 & 2047u) / 2047.0;
    float correlation = float(p.w >> 22) * (2.0 / 1023.0) - 1.0;
    return WaveSurface(unpackHalf2x16(p.x), unpackHalf2x16(p.y), uintBitsToFloat(p.z),
                       vec3(deviation.x * deviation.x, correlation * deviation.x * deviation.y, deviation.y * deviation.y));
}

// normal_of_slope — unit, scene axes.
vec3 normal_of_slope(vec2 slope) { return normalize(vec3(-slope, 1.0)); }

// A slope with the chance of the point that stands for its part of a normal distribution: Gauss and Hermite's
// three points an axis, exact for polynomials of degree five.
const float hermite_step = 1.73205080757;
struct SlopePoint {
    vec2 slope;
    float chance;
};

// slope_point — number 0 to 8 of the points for slopes spread around a mean.
SlopePoint slope_point(vec2 mean, vec3 covariance, int number) {
    float a = sqrt(max(covariance.x, 1e-12)), b = covariance.y / a;
    float c = sqrt(max(covariance.z - b * b, 0.0));
    vec2 step = vec2(float(number % 3 - 1), float(number / 3 - 1)) * hermite_step;
    vec2 chance = mix(vec2(2.0 / 3.0), vec2(1.0 / 6.0), abs(vec2(float(number % 3 - 1), float(number / 3 - 1))));
    return SlopePoint(mean + vec2(a * step.x, b * step.x + c * step.y), chance.x * chance.y);
}

// slope_lot — one slope drawn from the distribution, by two even numbers in [0, 1) (Box & Muller 1958).
vec2 slope_lot(vec2 mean, vec3 covariance, vec2 even) {
    float a = sqrt(max(covariance.x, 1e-12)), b = covariance.y / a;
    float c = sqrt(max(covariance.z - b * b, 0.0)), turn = 6.28318530718 * even.y;
    vec2 lot = sqrt(-2.0 * log(max(1.0 - even.x, 1e-7))) * vec2(cos(turn), sin(turn));
    return mean + vec2(a * lot.x, b * lot.x + c * lot.y);
}

// facing — projected size of a facet with that slope, towards a viewer: what weights it in the mean.
float facing(vec3 to_viewer, vec2 slope) { return max(dot(to_viewer, vec3(-slope, 1.0)), 0.0); }

// slope_density — of a normal distribution, per unit of both slopes.
float slope_density(vec2 off, vec3 covariance) {
    float determinant = max(covariance.x * covariance.z - covariance.y * covariance.y, 1e-16);
    float exponent = (covariance.z * off.x * off.x - 2.0 * covariance.y * off.x * off.y + covariance.x * off.y * off.y) / determinant;
    return exp(-0.5 * exponent) / (6.28318530718 * sqrt(determinant));
}
