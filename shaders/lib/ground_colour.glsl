// lib/ground_colour.glsl — colours of land and lake bed where no photograph says better.
// Pure functions. C++ twin: src/reference/ground_colour.hpp. For the look: meadow, forest, rock, snow,
// shore and bed told apart by height above the lake, slope and a little noise. Linear sRGB albedo.
#include "lib/noise.glsl"

// ground_albedo
//
//   place_m      metres east and south of the scene's north-west node, for the noise
//   height_m     above the level of the lake
//   bed          is this under water
//   near_water   0 away from the lake, 1 at its shore: beaches lie only there
//   tree_m, snow_m  heights of tree and snow line above the same level
//   slope        tangent of the steepness, >= 0
//   footprint_m  size of the pixel on the ground
vec3 ground_albedo(vec2 place_m, float height_m, bool bed, float near_water, float tree_m, float snow_m,
                   float slope, float footprint_m) {
    float broad = faded_noise(place_m, 1100.0, footprint_m, 1u);
    float fine = faded_noise(place_m, 90.0, footprint_m, 11u);
    float grain = faded_noise(place_m, 5.0, footprint_m, 21u);
    float tone = 1.0 + 0.5 * (grain - 0.5);
    if (bed) { // sand in the shallows, silt below, rock where it is steep
        float depth = max(-height_m, 0.0);
        vec3 sand = vec3(0.34, 0.30, 0.21) * (0.85 + 0.3 * fine);
        vec3 silt = vec3(0.125, 0.115, 0.085) * (0.8 + 0.4 * fine);
        vec3 stone = vec3(0.17, 0.165, 0.145) * (0.7 + 0.6 * fine);
        vec3 colour = mix(sand, silt, smoothstep(1.5, 18.0, depth + 10.0 * (broad - 0.5)));
        colour = mix(colour, stone, smoothstep(0.40, 0.75, slope + 0.5 * (fine - 0.5) + 0.3 * (grain - 0.5)));
        // Stones and weed: patches of some metres, grain of some decimetres.
        float pebbles = faded_noise(place_m, 1.3, footprint_m, 31u);
        return colour * (0.3 + 0.7 * smoothstep(0.30, 0.60, grain)) * (0.6 + 0.8 * pebbles);
    }
    vec3 meadow = vec3(0.082, 0.104, 0.036) * (0.75 + 0.5 * fine);
    vec3 forest = vec3(0.026, 0.043, 0.018) * (0.65 + 0.7 * fine);
    vec3 alpine = vec3(0.125, 0.115, 0.062) * (0.8 + 0.4 * fine);
    vec3 rock = vec3(0.185, 0.175, 0.160) * (0.7 + 0.6 * fine);
    vec3 scree = vec3(0.19, 0.178, 0.155) * (0.8 + 0.4 * fine);
    vec3 shore = vec3(0.31, 0.27, 0.19) * (0.85 + 0.3 * fine);
    vec3 snow = vec3(0.82, 0.84, 0.87);

    float jitter = broad - 0.5;
    float woods = smoothstep(0.30, 0.62, 0.6 * broad + 0.4 * fine + 0.15 * clamp(slope, 0.0, 1.0));
    vec3 colour = mix(meadow, forest, woods);
    float above_trees = smoothstep(tree_m - 160.0, tree_m + 160.0, height_m + 500.0 * jitter);
    float bare = smoothstep(0.25, 0.75, 0.5 * broad + 0.5 * fine + 0.5 * (clamp(slope, 0.0, 1.0) - 0.35));
    colour = mix(colour, mix(alpine, scree, bare), above_trees);
    colour = mix(colour, rock, smoothstep(0.60, 0.95, slope + 0.35 * (fine - 0.5) + 0.1 * above_trees));
    float white = smoothstep(snow_m - 110.0, snow_m + 110.0, height_m + 400.0 * jitter) *
                  (1.0 - smoothstep(0.9, 1.35, slope + 0.3 * (fine - 0.5)));
    colour = mix(colour * tone, snow, white);
    float beach = near_water * (1.0 - smoothstep(0.5, 2.2, height_m + 1.2 * (fine - 0.5))) *
                  (1.0 - smoothstep(0.4, 0.8, slope));
    return mix(colour, shore * tone, beach);
}
