// lib/ground_colour.glsl — colours of land and lake bed where no photograph says better.
// Pure functions. C++ twin: src/reference/ground_colour.hpp. For the look: meadow, forest, rock, snow,
// shore and bed told apart by height above the lake, slope and a little noise. Linear sRGB albedo.
#include "lib/noise.glsl"

// ground_albedo
//
//   place_m      metres east and south of the scene's north-west node, for the noise
//   height_m     above the level of the lake, negative on the bed
//   tree_m, snow_m  heights of tree and snow line above the same level
//   slope        tangent of the steepness, >= 0
//   footprint_m  size of the pixel on the ground
vec3 ground_albedo(vec2 place_m, float height_m, float tree_m, float snow_m, float slope,
                   float footprint_m) {
    float broad = faded_noise(place_m, 900.0, footprint_m, 1u);
    float fine = faded_noise(place_m, 60.0, footprint_m, 11u);
    if (height_m < 0.0) { // bed: sand in the shallows, silt below, rock where it is steep
        float depth = -height_m;
        vec3 sand = vec3(0.34, 0.30, 0.21) * (0.85 + 0.3 * fine);
        vec3 silt = vec3(0.125, 0.115, 0.085) * (0.8 + 0.4 * fine);
        vec3 stone = vec3(0.17, 0.165, 0.145) * (0.7 + 0.6 * fine);
        vec3 colour = mix(sand, silt, smoothstep(1.5, 16.0, depth + 8.0 * (broad - 0.5)));
        return mix(colour, stone, smoothstep(0.45, 0.8, slope + 0.4 * (fine - 0.5)));
    }
    vec3 meadow = vec3(0.115, 0.145, 0.045) * (0.8 + 0.4 * fine);
    vec3 forest = vec3(0.030, 0.052, 0.020) * (0.65 + 0.7 * fine);
    vec3 alpine = vec3(0.170, 0.155, 0.085) * (0.8 + 0.4 * fine);
    vec3 rock = vec3(0.215, 0.205, 0.190) * (0.7 + 0.6 * fine);
    vec3 scree = vec3(0.30, 0.285, 0.26) * (0.8 + 0.4 * fine);
    vec3 shore = vec3(0.36, 0.315, 0.225) * (0.85 + 0.3 * fine);
    vec3 snow = vec3(0.82, 0.84, 0.87);

    float jitter = broad - 0.5;
    float woods = smoothstep(0.42, 0.58, 0.5 * broad + 0.5 * fine + 0.12 * clamp(slope, 0.0, 1.0));
    vec3 colour = mix(meadow, forest, woods);
    float above_trees = smoothstep(tree_m - 120.0, tree_m + 120.0, height_m + 300.0 * jitter);
    colour = mix(colour, mix(alpine, scree, smoothstep(0.4, 0.6, fine)), above_trees);
    colour = mix(colour, rock, smoothstep(0.62, 0.95, slope + 0.35 * (fine - 0.5) + 0.1 * above_trees));
    float white = smoothstep(snow_m - 90.0, snow_m + 90.0, height_m + 260.0 * jitter) *
                  (1.0 - smoothstep(0.9, 1.35, slope + 0.3 * (fine - 0.5)));
    colour = mix(colour, snow, white);
    float beach = (1.0 - smoothstep(0.5, 2.2, height_m + 1.2 * (fine - 0.5))) *
                  (1.0 - smoothstep(0.5, 0.9, slope));
    return mix(colour, shore, beach);
}
