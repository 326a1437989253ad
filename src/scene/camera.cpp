#include "scene/camera.hpp"

#include "core/angles.hpp"
#include "core/error.hpp"
#include "core/text.hpp"

#include <cmath>
#include <glm/geometric.hpp>

namespace tarn::scene {

Camera look_along(glm::dvec3 position, glm::dvec3 direction, glm::dvec3 up, double fov_deg) {
    if (!(fov_deg > 0.0 && fov_deg <= 170.0))
        throw Error(text("field of view is ", fov_deg, " degrees, must be in (0, 170]"));
    const double length = glm::length(direction);
    const glm::dvec3 side = glm::cross(direction, up);
    if (!(length > 0.0) || !(glm::length(side) > 1e-9 * length * glm::length(up)) ||
        !std::isfinite(glm::length(side)) || !std::isfinite(glm::length(position)))
        throw Error("the camera's direction and up vector do not span a view",
                    "give a finite position and two vectors that are not parallel");
    Camera camera;
    camera.position = position;
    camera.forward = direction / length;
    camera.right = glm::normalize(side);
    camera.up = glm::cross(camera.right, camera.forward);
    camera.fov_deg = fov_deg;
    return camera;
}

Camera look(glm::dvec3 position, double heading_deg, double pitch_deg, double fov_deg) {
    const double h = heading_deg * degree, p = pitch_deg * degree;
    const glm::dvec3 direction(std::sin(h) * std::cos(p), std::cos(h) * std::cos(p), std::sin(p));
    // Tilted with the pitch, so that looking straight down leaves the heading at the top.
    const glm::dvec3 up(-std::sin(h) * std::sin(p), -std::cos(h) * std::sin(p), std::cos(p));
    return look_along(position, direction, up, fov_deg);
}

double pixel_rad(const Camera& camera, int height_px) {
    return 2.0 * std::tan(0.5 * camera.fov_deg * degree) / height_px;
}

std::optional<glm::dvec2> picture_place(const Camera& camera, const glm::dvec3& direction,
                                        double aspect) {
    const double depth = glm::dot(direction, camera.forward);
    if (!(depth > 1e-6 * glm::length(direction)))
        return {};
    const double half = depth * std::tan(0.5 * camera.fov_deg * degree);
    return glm::dvec2(0.5 + 0.5 * glm::dot(direction, camera.right) / (half * aspect),
                      0.5 - 0.5 * glm::dot(direction, camera.up) / half);
}

glm::dvec3 pixel_direction(const Camera& camera, double px, double py, int width_px,
                           int height_px) {
    const double half = std::tan(0.5 * camera.fov_deg * degree);
    const double u = (2.0 * px / width_px - 1.0) * half * width_px / height_px;
    const double v = (1.0 - 2.0 * py / height_px) * half;
    return camera.forward + u * camera.right + v * camera.up;
}

} // namespace tarn::scene
