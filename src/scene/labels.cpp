#include "scene/labels.hpp"

#include "scene/space_lines.hpp"

namespace tarn::scene {

std::vector<ShownLabel> shown_labels(const Scene& scene, const Camera& camera, double aspect,
                                     DrapeOn on,
                                     const std::function<double(double x, double y)>& distance_at,
                                     int most) {
    std::vector<ShownLabel> out;
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
        const auto at = picture_place(camera, seen->towards, aspect);
        if (!at || !(at->x >= 0.0 && at->x < 1.0 && at->y >= 0.0 && at->y < 1.0))
            continue;
        if (!(distance_at(at->x, at->y) < 0.97 * seen->distance_m) &&
            sighting_of(scene, camera.position, label.place))
            out.push_back({at->x, at->y, label.text});
    }
    return out;
}

} // namespace tarn::scene
