// lib/medium.glsl — light inside the water body. Pure functions. C++ twin: src/reference/medium.hpp
// Model and sources: docs/physics/water.md (quasi-single scattering, Gordon 1973).

// transmittance — fraction of radiance that survives a straight path (Beer-Lambert law).
//
//   attenuation_per_m  a + b_b per channel [1/m], >= 0
//   distance_m         path length [m], >= 0
vec3 transmittance(vec3 attenuation_per_m, float distance_m) {
    return exp(-attenuation_per_m * distance_m);
}

// faded_length — integral over s from 0 to d of exp(-start - k s), for any sign of k.
//
//   Written so that neither k d -> 0 loses digits nor a growing exponential overflows: with k < 0
//   the integral is taken from the far end.
float faded_length(float start, float k_per_m, float d_m) {
    float x = abs(k_per_m) * d_m;
    float ratio = x < 1e-2 ? 1.0 - x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0)))
                           : (1.0 - exp(-x)) / x;
    return d_m * ratio * exp(k_per_m < 0.0 ? x - start : -start);
}

// path_radiance — light scattered into a straight path by the water itself.
//
//   backscattering_per_m  b_b, spread evenly over directions: b_b / 2 pi per steradian [1/m]
//   attenuation_per_m     a + b_b [1/m]
//   irradiance            of the downward light just below the surface, on a plane facing it
//   slant                 path of that light per metre of depth: 1 / cosine, >= 1
//   depth_m               depth where the path begins, at the eye [m], >= 0
//   sink                  metres of depth gained per metre of path, in [-1, 1]
//   distance_m            length of the path [m], not beyond the surface
//   returns               radiance at the beginning of the path
vec3 path_radiance(vec3 backscattering_per_m, vec3 attenuation_per_m, vec3 irradiance, float slant,
                   float depth_m, float sink, float distance_m) {
    vec3 start = attenuation_per_m * (slant * depth_m);
    vec3 k = attenuation_per_m * (1.0 + slant * sink);
    return backscattering_per_m * (1.0 / 6.28318530718) * irradiance *
           vec3(faded_length(start.r, k.r, distance_m), faded_length(start.g, k.g, distance_m),
                faded_length(start.b, k.b, distance_m));
}
