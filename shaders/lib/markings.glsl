// lib/markings.glsl — what maps draw on the ground: contour lines, colours of depth.
// Pure functions. C++ twin: src/reference/markings.hpp.

// Share of a pixel that a contour line covers, [0, 1]. Every fifth line is broader.
//
//   height_m     of the ground, above where contours count from
//   interval_m   between lines, > 0
//   slope        tangent of the ground's steepness, >= 0
//   footprint_m  size of the pixel on the ground
float contour_cover(float height_m, float interval_m, float slope, float footprint_m) {
    float number = round(height_m / interval_m);
    bool broad = abs(number - 5.0 * round(number / 5.0)) < 0.5;
    float away_px = abs(height_m - number * interval_m) / (max(slope, 1e-5) * footprint_m);
    float width_px = broad ? 2.2 : 1.2;
    // Lines that crowd would only darken the ground.
    float spacing_px = (broad ? 5.0 : 1.0) * interval_m / (max(slope, 1e-5) * footprint_m);
    return clamp(0.5 * width_px - away_px + 0.5, 0.0, 1.0) * smoothstep(3.0, 8.0, spacing_px) *
           smoothstep(0.0, 0.002, slope); // a plateau is no line
}

// Colour of a depth, linear albedo: light where it is shallow, dark blue where deep; even in lightness.
//
//   share  of the scale's greatest depth, [0, 1]
vec3 depth_colour(float share) {
    const vec3 stops[5] = vec3[5](vec3(0.75, 0.80, 0.52), vec3(0.32, 0.62, 0.50), vec3(0.09, 0.38, 0.50),
                                  vec3(0.04, 0.17, 0.40), vec3(0.03, 0.04, 0.18));
    float place = clamp(share, 0.0, 1.0) * 4.0;
    int first = min(int(place), 3);
    return mix(stops[first], stops[first + 1], place - float(first));
}

// Share of a pixel that a draped line covers, [0, 1].
//
//   near         of the drape's texture: 1 on the line, 0 `reach_m` away from it, linear between
//   width_px     of the line, >= 1
float drape_cover(float near, float reach_m, float width_px, float footprint_m) {
    float away_px = (1.0 - near) * reach_m / footprint_m;
    return near <= 0.0 ? 0.0 : clamp(0.5 * width_px - away_px + 0.5, 0.0, 1.0);
}
