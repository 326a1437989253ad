#pragma once
/// @file camera.hpp  Where the picture is taken from.
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

namespace tarn::scene {

/// A pinhole camera in scene metres (x east, y north, z up).
struct Camera {
    glm::dvec3 position{0};
    glm::dvec3 forward{0, 1, 0}; ///< unit
    glm::dvec3 right{1, 0, 0};   ///< unit, to the picture's right
    glm::dvec3 up{0, 0, 1};      ///< unit, to the picture's top
    double fov_deg = 50.0;       ///< VERTICAL field of view, (0, 170]
};

/// From grid heading (clockwise from scene north) and pitch (up positive), both in degrees.
Camera look(glm::dvec3 position, double heading_deg, double pitch_deg, double fov_deg);

/// From a viewing direction and an up vector of any length.
/// @throws tarn::Error  if they are zero, parallel or not finite, or fov_deg is outside (0, 170]
Camera look_along(glm::dvec3 position, glm::dvec3 direction, glm::dvec3 up, double fov_deg);

/// Angle of a pixel in the middle of a picture so many rows high [rad].
double pixel_rad(const Camera& camera, int height_px);

/// Place in a picture, (0, 0) top left to (1, 1), of what lies in a direction of any length;
/// nothing behind the camera. May lie outside.
/// @param aspect  width over height
std::optional<glm::dvec2> picture_place(const Camera& camera, const glm::dvec3& direction,
                                        double aspect);

/// Direction, not normalised, through picture position (px, py) in pixels from the top left.
glm::dvec3 pixel_direction(const Camera& camera, double px, double py, int width_px, int height_px);

} // namespace tarn::scene
