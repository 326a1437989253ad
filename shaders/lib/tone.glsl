// lib/tone.glsl — from linear radiance to what a screen takes: the curve of src/image/tone.hpp.
// Pure functions. C++ twin: src/reference/tone.hpp.

// A colour outside sRGB moved towards the grey of its luminance until no channel is negative.
vec3 into_gamut(vec3 c) {
    if (any(isnan(c)) || any(isinf(c)))
        return vec3(0.0);
    float least = min(c.r, min(c.g, c.b));
    if (least >= 0.0)
        return c;
    float grey = dot(c, vec3(0.2126, 0.7152, 0.0722));
    return grey <= 0.0 ? vec3(0.0) : max(vec3(grey) + (c - grey) * (grey / (grey - least)), vec3(0.0));
}

// The eye's response x^n / (x^n + s^n) (Naka & Rushton 1966), n = 1.3, that leaves mid grey where it is; then the
// sRGB transfer function (IEC 61966-2-1).
//
//   radiance  linear, >= 0
//   exposure  factor on it
vec3 tone_curve(vec3 radiance, float exposure) {
    const float n = 1.3;
    const float half_way = 0.4902252; // .18^1.3 (1 - .18) / .18
    vec3 powered = pow(max(radiance * exposure, vec3(0.0)), vec3(n));
    vec3 linear = powered / (powered + half_way);
    vec3 low = 12.92 * linear, high = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, lessThanEqual(linear, vec3(0.0031308)));
}
