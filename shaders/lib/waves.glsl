// lib/waves.glsl — how high and how steep the water is at a place. Pure functions; samplers are parameters.
// C++ twin: src/reference/waves.hpp
//
// A program that draws waves defines TARN_WAVES 1 and TARN_CASCADES 0 to 4; others include nothing of it.
// Positions are metres east and north of the node `base` (shared/wave_block.h). What is narrower than
// `footprint_m` is not drawn but counted: slopes come with the covariance of what was taken away, so that
// glitter and mirrored sky keep their mean at every distance.
#include "shared/wave_block.h"
#include "lib/fresnel.glsl"
#include "lib/noise.glsl"
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

// 1, but 0 beside the one patch that is not repeated.
float inside_patch(WaveBlock waves, int cascade, vec2 place) {
    return cascade == int(waves.shore.y) && any(notEqual(floor(place), vec2(0.0))) ? 0.0 : 1.0;
}

// cascade_height — of one cascade at full amplitude [m], at a mip level.
float cascade_height(sampler2DArray heights, WaveBlock waves, int cascade, vec2 at_m, float level) {
    vec2 place = waves.patches[cascade].xy + at_m / waves.patches[cascade].z;
    return inside_patch(waves, cascade, place) * textureLod(heights, vec3(place, float(cascade)), level).x;
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
    float finest = amplitude[int(waves.rough.w)]; // of the wind's
    taken = waves.rough.xyz * finest * finest;
    for (int j = 0; j < TARN_CASCADES; ++j) {
        vec2 place = waves.patches[j].xy + at_m / waves.patches[j].z;
        float level = wave_level(waves, j, footprint_m), column = min(level, float(TARN_WAVE_LEVELS - 1));
        sum += inside_patch(waves, j, place) * amplitude[j] * textureLod(slopes, vec3(place, float(j)), level).xy;
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
    float bright;     // from above: mean reflectance times projected size of the facets that `lot` was drawn from
    vec3 taken;       // covariance of the slopes inside the pixel
};

// pack_surface — slopes to a two-thousandth of theirs, standard deviations to a two-thousandth, up to 1.
uvec4 pack_surface(WaveSurface s) {
    vec2 deviation = sqrt(max(s.taken.xz, vec2(1e-12)));
    float correlation = clamp(s.taken.y / (deviation.x * deviation.y), -1.0, 1.0);
    uvec3 parts = uvec3(round(vec3(min(deviation, 1.0) * 2047.0, (0.5 + 0.5 * correlation) * 1023.0)));
    return uvec4(packHalf2x16(s.mean), packHalf2x16(s.lot), floatBitsToUint(s.bright), parts.x | parts.y << 11 | parts.z << 22);
}

WaveSurface unpack_surface(uvec4 p) {
    vec2 deviation = vec2(p.w & 2047u, p.w >> 11 & 2047u) / 2047.0;
    float correlation = float(p.w >> 22) * (2.0 / 1023.0) - 1.0;
    return WaveSurface(unpackHalf2x16(p.x), unpackHalf2x16(p.y), uintBitsToFloat(p.z),
                       vec3(deviation.x * deviation.x, correlation * deviation.x * deviation.y, deviation.y * deviation.y));
}

// normal_of_slope — unit, scene axes.
vec3 normal_of_slope(vec2 slope) { return normalize(vec3(-slope, 1.0)); }

// facing — projected size of a facet with that slope, towards a viewer: what weights it in the mean.
float facing(vec3 to_viewer, vec2 slope) { return max(dot(to_viewer, vec3(-slope, 1.0)), 0.0); }

// Slopes inside a pixel as seen by one viewer, for sums over those that face him.
struct VisibleSlopes {
    vec2 towards, across; // unit, horizontal: to the viewer, and to the left of that
    float middle, reach;  // slopes towards the viewer that the sum takes: middle +- reach
    float mean, deviation;
    float mean_across, lean, deviation_across; // across: mean, its shift with the slope along, what is left
};

const int slopes_along = 7, slopes_across = 2;

// visible_slopes — along the view, where Fresnel's factor and the facets' projected size bend, the middles of seven
//                  equal parts between where facets turn away, or three deviations, and three on the other side;
//                  across it Gauss and Hermite's two points. (Gauss and Legendre's points along the view were no
//                  better: the integrand has a kink where mirrored rays graze the water.)
VisibleSlopes visible_slopes(vec3 to_viewer, vec2 mean, vec3 covariance) {
    VisibleSlopes v;
    float flat_part = max(length(to_viewer.xy), 1e-5);
    v.towards = to_viewer.xy / flat_part;
    if (flat_part <= 1e-5)
        v.towards = vec2(1.0, 0.0);
    v.across = vec2(-v.towards.y, v.towards.x);
    vec2 c_towards = vec2(dot(covariance.xy, v.towards), dot(covariance.yz, v.towards));
    float variance = max(dot(c_towards, v.towards), 1e-12), together = dot(c_towards, v.across);
    float variance_across = dot(vec2(dot(covariance.xy, v.across), dot(covariance.yz, v.across)), v.across);
    v.mean = -dot(mean, v.towards); // rises away from the viewer: faces him
    v.deviation = sqrt(variance);
    v.mean_across = dot(mean, v.across);
    v.lean = -together / variance;
    v.deviation_across = sqrt(max(variance_across - together * together / variance, 0.0));
    float last = v.mean + 3.2 * v.deviation;
    float first = min(max(v.mean - 3.2 * v.deviation, -to_viewer.z / flat_part), last - 1e-3 * v.deviation);
    v.middle = 0.5 * (first + last);
    v.reach = 0.5 * (last - first);
    return v;
}

// visible_slope — one of the slopes_along x slopes_across, and its share, facing included: the shares add up to
//                 the mean projected size of all facets that face the viewer.
vec2 visible_slope(VisibleSlopes v, vec3 to_viewer, int i, int j, out float share) {
    float along = v.middle + (float(2 * i + 1) / float(slopes_along) - 1.0) * v.reach, x = (along - v.mean) / v.deviation;
    float across = v.mean_across + v.lean * (along - v.mean) + (2.0 * float(j) - 1.0) * v.deviation_across;
    vec2 slope = across * v.across - along * v.towards;
    share = exp(-0.5 * x * x) * v.reach / v.deviation * (0.797884561 / float(slopes_along * slopes_across)) *
            facing(to_viewer, slope);
    return slope;
}

// slope_of_lot — one slope of the distribution, by two even numbers in [0, 1) (Box & Muller 1958).
vec2 slope_of_lot(vec2 mean, vec3 covariance, vec2 even) {
    float a = sqrt(max(covariance.x, 1e-12)), b = covariance.y / a;
    float c = sqrt(max(covariance.z - b * b, 0.0)), turn = 6.28318530718 * even.y;
    vec2 lot = sqrt(-2.0 * log(max(1.0 - even.x, 1e-7))) * vec2(cos(turn), sin(turn));
    return mean + vec2(a * lot.x, b * lot.x + c * lot.y);
}

const int slope_candidates = 8;

// draw_slope — one slope for a ray that goes on, of some drawn from those inside the pixel: facets count by the size
//              that they turn to the viewer, and by the share that they mirror or let through (resampling, Talbot,
//              Cline & Egbert 2005). The even numbers fill the square evenly from candidate to candidate and sample
//              to sample (Roberts' R2 sequence).
//
//   eta      as in fresnel_dielectric: counts facets by what they mirror, < 0: by what they let through, 0: alike
//   weight   mean of what the facets counted by
vec2 draw_slope(ivec2 pixel, float sample_number, vec3 to_viewer, vec2 mean, vec3 taken, float eta, out float weight) {
    uint h = lattice_hash(pixel, 91u), choice = lattice_hash(pixel, 17u + uint(sample_number));
    vec2 start = vec2(h & 0xffffu, h >> 16) / 65536.0, chosen = mean;
    float sum = 0.0;
    for (int i = 0; i < slope_candidates; ++i) {
        vec2 even = fract(start + (sample_number * float(slope_candidates) + float(i)) * vec2(0.7548776662, 0.5698402910));
        vec2 slope = slope_of_lot(mean, taken, even);
        float counts = facing(to_viewer, slope);
        if (eta != 0.0) {
            float mirror = fresnel_dielectric(clamp(dot(to_viewer, normal_of_slope(slope)), 0.0, 1.0), abs(eta));
            counts *= eta > 0.0 ? mirror : 1.0 - mirror;
        }
        sum += counts;
        choice = (choice ^ choice >> 15) * 0x2c1b3c6du;
        choice ^= choice >> 12;
        if (float(choice >> 8) * sum < counts * 16777216.0)
            chosen = slope;
    }
    weight = sum / float(slope_candidates);
    return chosen;
}

// slope_of_part — by which part 1 (mirrored) or 2 (refracted) of a path went on.
vec2 slope_of_part(WaveSurface surface, int number, bool from_water, ivec2 pixel, float sample_number, vec3 direction, float index) {
    if (number == 1 || from_water)
        return surface.lot;
    float ignored;
    return draw_slope(pixel, sample_number + 0.5, -direction, surface.mean, surface.taken, -1.0 / index, ignored);
}

// slope_density — of a normal distribution, per unit of both slopes.
float slope_density(vec2 off, vec3 covariance) {
    float determinant = max(covariance.x * covariance.z - covariance.y * covariance.y, 1e-16);
    float exponent = (covariance.z * off.x * off.x - 2.0 * covariance.y * off.x * off.y + covariance.x * off.y * off.y) / determinant;
    return exp(-0.5 * exponent) / (6.28318530718 * sqrt(determinant));
}
