// lib/camera.glsl — rays through pixels. Pure functions. C++ twin: src/reference/camera.hpp

// pixel_direction — unit direction through a point of the picture plane.
//
//   forward, right, up  unit and perpendicular, scene axes
//   half_tangent        tangents of half the horizontal and half the vertical field of view
//   place               position in the picture, (0, 0) top left to (1, 1) bottom right
vec3 pixel_direction(vec3 forward, vec3 right, vec3 up, vec2 half_tangent, vec2 place) {
    vec2 plane = vec2(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y) * half_tangent;
    return normalize(forward + plane.x * right + plane.y * up);
}
