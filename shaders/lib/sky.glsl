// lib/sky.glsl — where in the sky table a direction lies, and the sun's disc.
// Pure functions. C++ twin: src/reference/sky.hpp; the table itself: src/scene/lighting.hpp

// sky_place — column and row (both in [0, 1]) of a direction in the sky table.
//
//   direction, sun  unit, scene axes; directions below the horizon take the lowest row
//
// A program whose table goes all around (scene/lighting.hpp) defines TARN_WHOLE_SKY.
vec2 sky_place(vec3 direction, vec3 sun) {
    float elevation = asin(clamp(direction.z, 0.0, 1.0));
    float v = sqrt(elevation * (1.0 / 1.57079632679));
#ifdef TARN_WHOLE_SKY
    float turn = dot(direction.xy, direction.xy) > 0.0 ? atan(direction.x, direction.y) * (0.5 / 3.14159265359) : 0.0;
    return vec2(turn - floor(turn), v);
#else
    vec2 a = direction.xy, b = sun.xy;
    float scale = inversesqrt(max(dot(a, a) * dot(b, b), 1e-30));
    float u = acos(clamp(dot(a, b) * scale, -1.0, 1.0)) * (1.0 / 3.14159265359);
    return vec2(u, v);
#endif
}

// sky_radiance — the table's value there, linear between its entries.
vec3 sky_radiance(sampler2D table, vec3 direction, vec3 sun) {
    vec2 size = vec2(textureSize(table, 0));
    return textureLod(table, (sky_place(direction, sun) * (size - 1.0) + 0.5) / size, 0.0).rgb;
}

// disc_share — share of a pixel that the sun's disc covers, its edge softened over one pixel.
//
//   direction, sun  unit
//   radius, pixel   angles of the disc and of the pixel [rad]
float disc_share(vec3 direction, vec3 sun, float radius, float pixel) {
    if (dot(direction, sun) <= 0.0)
        return 0.0;
    vec3 off = cross(direction, sun);
    return clamp((radius - length(off)) / pixel + 0.5, 0.0, 1.0); // sine = angle at this size
}
