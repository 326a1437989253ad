#include "scene/labels.hpp"

#include "scene/space_lines.hpp"

#include <cmath>
#include <glm/geometric.hpp>

namespace tarn::scene {

std::vector<ShownLabel> shown_labels(const Scene& scene, const Camera& camera, double aspect,
                                     DrapeOn on,
                                     const std::function<double(double x, double y)>& distance_at,
                                     int most) {
    std::vector<ShownLabel> out;
    const double half = std::tan(0.5 * camera.fov_deg * 0.017453292519943295);
    for (const PlaceLabel& label : scene.labels) {
        if (int(out.size()) >= most)
            break;
        const auto level = scene.water_level_m(label.place.x, label.place.y);
        const bool flooded = level && label.place.z <= *level + 1e-3; // also on the water itself
        if (on == (flooded ? DrapeOn::dry : DrapeOn::flooded))
            continue;
        // One that lies on ground or water is met there, not behind.
        const auto seen = sighting_of(scene, camera.position, label.place, false);
        if (!seen)
            continue;
        const double depth = glm::dot(seen->towards, camera.forward);
        if (depth <= 1e-6)
            continue;
        const double x = 0.5 +
                         0.5 * glm::dot(seen->towards, camera.right) / (depth * half * aspect),
                     y = 0.5 - 0.5 * glm::dot(seen->towards, camera.up) / (depth * half);
        if (!(x >= 0.0 && x < 1.0 && y >= 0.0 && y < 1.0))
            continue;
        if (!(distance_at(x, y) < 0.97 * seen->distance_m) &&
            sighting_of(scene, camera.position, label.place))
            out.push_back({x, y, label.text});
    }
    return out;
}

} // namespace tarn::scene
