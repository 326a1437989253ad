// lib/air.glsl — haze between the eye and what it looks at. Pure functions. C++ twin: src/reference/air.hpp
// Model: docs/physics/air.md

// air_transmittance — share of light that a straight path through the air leaves.
//
//   extinction_per_m  of the three channels at height 0 [1/m], >= 0
//   per_height        1 / scale height [1/m]: the haze thins out by e over that height
//   height_m          of the path's beginning
//   rise              metres of height gained per metre of path, in [-1, 1]
//   distance_m        >= 0
vec3 air_transmittance(vec3 extinction_per_m, float per_height, float height_m, float rise, float distance_m) {
    float x = rise * distance_m * per_height;
    // The mean density along the path, from its lower end so that nothing overflows.
    float size = abs(x), low = min(height_m, height_m + rise * distance_m);
    float mean = size < 1e-2 ? 1.0 - size * (0.5 - size / 6.0) : (1.0 - exp(-size)) / size;
    return exp(-extinction_per_m * (distance_m * mean * exp(min(-low * per_height, 2.0))));
}

// horizon_of — the direction whose sky the haze along a ray takes its colour from: just above the horizon.
vec3 horizon_of(vec3 direction) {
    return normalize(vec3(direction.xy, 0.02 * max(length(direction.xy), 1e-4)));
}
