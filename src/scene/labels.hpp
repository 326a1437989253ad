#pragma once
/// @file labels.hpp  Where a picture shows the names of places.
#include "scene/settings.hpp"

#include <functional>
#include <string>
#include <vector>

namespace tarn::scene {

struct ShownLabel {
    double x = 0.0, y = 0.0; ///< of its place in the picture, (0, 0) top left to (1, 1)
    std::string text;
};

/// Labels of the scene that a view shows: before the camera, refracted by calm water, neither
/// behind ground nor behind what the picture has there, cut by the water's level as the layers are.
/// @param distance_at  that the picture has met at a place of it [m]
/// @param most         further ones are left out
std::vector<ShownLabel> shown_labels(const Scene& scene, const Camera& camera, double aspect,
                                     DrapeOn on,
                                     const std::function<double(double x, double y)>& distance_at,
                                     int most = 200);

} // namespace tarn::scene
