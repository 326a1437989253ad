// lib/medium.glsl — light inside the water body. Pure functions; the table is a parameter.
// C++ twin: src/reference/medium.hpp, which sums over wavelengths instead of looking the sum up
// Model and sources: docs/physics/water.md (quasi-single scattering, Gordon 1973); the table: src/scene/water_colour.hpp

// water_row — a row of the water's table.
//
//   table    RGBA32F, six rows over the length of a path
//   scale    x: 1 / shortest path [1/m], y: texels per logarithm of path, z: greatest attenuation of any wavelength
//            [1/m], w: last texel
//   row      0 transmitted, 1 integral of what is scattered back, 2 what a metre scatters back, 3 thrown back,
//            4 not scattered at all, 5 not scattered wide
//   path_m   >= 0
vec3 water_row(sampler2D table, vec4 scale, int row, float path_m) {
    float place = clamp(log(1.0 + path_m * scale.x) * scale.y, 0.0, scale.w - 0.01), low = floor(place);
    return mix(texelFetch(table, ivec2(int(low), row), 0).rgb, texelFetch(table, ivec2(int(low) + 1, row), 0).rgb,
               place - low);
}

// transmittance — what is left of white light after a path in the water.
vec3 transmittance(sampler2D table, vec4 scale, float path_m) { return water_row(table, scale, 0, path_m); }

// thrown_back — share of what a flat bed sends up diffusely that the surface sends back to it.
vec3 thrown_back(sampler2D table, vec4 scale, float depth_m) { return water_row(table, scale, 3, depth_m); }

// image_transmittance — of that, what has not been scattered at all, and still draws the edges of things.
vec3 image_transmittance(sampler2D table, vec4 scale, float path_m) { return water_row(table, scale, 4, path_m); }

// pattern_transmittance — what has not been scattered wide, and still draws caustics and patterns of the bed.
vec3 pattern_transmittance(sampler2D table, vec4 scale, float path_m) { return water_row(table, scale, 5, path_m); }

// drawn_place — a place along a way by its share, in [0, 1), of all that light falling off brings from it.
//
//   fall      of the light [1/m], < 0 where it grows along the way
//   length_m  > 0
//   returns   metres
float drawn_place(float fall, float length_m, float share) {
    float steep = max(fall * length_m, -60.0); // what exp() can hold
    return abs(steep) < 1e-3 ? share * length_m : -log(1.0 - share * (1.0 - exp(-steep))) / steep * length_m;
}

// WayLight — how the sun's light that a straight path scatters to the eye falls along it, by luminance.
struct WayLight {
    float start; // path of the light that comes from its beginning, eye's way included [m]
    float rate;  // metres that the light's path grows by, a metre of the way
    float fall;  // of what comes from farther on [1/m of the way]; < 0 for a steep view upwards
    float blur;  // of patterns in it, beside the light itself [1/m of the light's path]
};

// way_light — by its fall to about a third.
//
//   scale, slant, depth_m, sink, before_m   as in path_radiance()
//   length_m  > 0
WayLight way_light(sampler2D table, vec4 scale, float slant, float depth_m, float sink, float before_m, float length_m) {
    const vec3 luminance = vec3(0.2126, 0.7152, 0.0722);
    WayLight way;
    way.rate = 1.0 + slant * sink;
    way.start = slant * depth_m + before_m;
    float here = log(max(dot(luminance, water_row(table, scale, 2, way.start)), 1e-12));
    float typical = min(length_m, 1.0 / max(scale.z, 1e-3));
    for (int i = 0; i < 3; ++i) {
        float there = max(way.start + way.rate * typical, 0.0);
        way.fall = (here - log(max(dot(luminance, water_row(table, scale, 2, there)), 1e-12))) / typical;
        typical = min(length_m, 1.0 / max(abs(way.fall), 1e-3));
    }
    float whole = max(way.start + 0.5 * way.rate * typical, 1e-3);
    way.blur = log(max(dot(luminance, transmittance(table, scale, whole)), 1e-12) /
                   max(dot(luminance, pattern_transmittance(table, scale, whole)), 1e-12)) / whole;
    return way;
}

// path_radiance — light scattered into a straight path by the water itself, per unit of the light's irradiance just
//                 below the surface on a plane facing it.
//
//   slant       path of that light per metre of depth: 1 / cosine, >= 1
//   depth_m     depth where the path begins [m], >= 0
//   sink        metres of depth gained per metre of path, in [-1, 1]
//   before_m    path in the water from there to the eye [m]
//   distance_m  length of the path [m], not beyond the surface
// Accuracy 1e-3 of the exact value (tests/gpu/medium_gpu_test.cpp)
vec3 path_radiance(sampler2D table, vec4 scale, float slant, float depth_m, float sink, float before_m, float distance_m) {
    // All light that arrives has come a path that grows evenly along the ray: the integral is a difference.
    float rate = 1.0 + slant * sink, start = slant * depth_m + before_m, gain = rate * distance_m;
    if (abs(gain) * scale.z < 0.5) // Simpson's rule, where the difference would lose digits
        return distance_m / 6.0 * (water_row(table, scale, 2, start) + 4.0 * water_row(table, scale, 2, start + 0.5 * gain) +
                                   water_row(table, scale, 2, start + gain));
    return (water_row(table, scale, 1, start + gain) - water_row(table, scale, 1, start)) / rate;
}

// glow_radiance — light of the sun or the sky that the water scatters forwards into a straight path: what glows around
//                 the sun, and softens the rim of Snell's window, seen from below.
//
//   glow       RGBA32F, what a metre scatters forwards over the angle off the beam and the light's path, both spaced by
//              logarithm: scene/water_colour.hpp, make_glow_colours()
//   fall       of light in the water, about [1/m], > 0
//   angle_rad  between path and the sun's beam, or the vertical for the sky's, both towards where the light comes
//              from, [0, pi]
//   the others and what it is a share of: as in path_radiance()
// Accuracy 1.5 % of the sum over wavelengths near the sun, beside it 1.5 % of all scattered light
// (tests/gpu/medium_gpu_test.cpp).
vec3 glow_radiance(sampler2D glow, vec4 scale, float fall, float slant, float depth_m, float sink, float before_m,
                   float distance_m, float angle_rad) {
    // As scene::GlowTable spaces its angles.
    const float least_rad = 0.004, angles = 1.0 / log(1.0 + 3.14159265359 / least_rad);
    if (angle_rad >= 1.57079632679)
        return vec3(0.0);
    float rate = 1.0 + slant * sink, start = slant * depth_m + before_m;
    vec2 size = vec2(textureSize(glow, 0));
    // Over equal shares of the light, by Gauss and Legendre's four points of them.
    const vec4 place = vec4(0.0694318, 0.3300095, 0.6699905, 0.9305682);
    // Colours that last see farther than the mean of all: by its shares alone they would be looked up too near.
    fall *= 0.6;
    float gain = clamp(fall * rate * distance_m, -60.0, 60.0);
    float lost = abs(gain) < 1e-3 ? gain : 1.0 - exp(-gain); // on the way, of light at the path's beginning
    float all_m = abs(gain) < 1e-3 ? distance_m : distance_m * lost / gain; // as much of it as all that arrives
    vec4 left = 1.0 - place * lost, path = max(start - log(left) / fall, 0.0);
    float x = (min(log(1.0 + angle_rad / least_rad) * angles, 1.0) * (size.x - 1.0) + 0.5) / size.x;
    vec4 y = (min(log(1.0 + path * scale.x) * (scale.y / scale.w), 1.0) * (size.y - 1.0) + 0.5) / size.y;
    vec4 part = all_m * vec4(0.1739274, 0.3260726, 0.3260726, 0.1739274) / left;
    return part.x * textureLod(glow, vec2(x, y.x), 0.0).rgb + part.y * textureLod(glow, vec2(x, y.y), 0.0).rgb +
           part.z * textureLod(glow, vec2(x, y.z), 0.0).rgb + part.w * textureLod(glow, vec2(x, y.w), 0.0).rgb;
}

// sky_glow_slant — path, per metre of depth, of the skylight that is scattered forwards into views at an angle off the
//                  vertical: what comes from straight above has come a shorter way than what comes over the rim of
//                  Snell's window. Fitted to photons (tests/unit/glow_test.cpp).
float sky_glow_slant(float angle_rad) { return 1.1 + 0.16 * min(angle_rad / 0.85, 1.0); }
