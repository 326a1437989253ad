#pragma once
/// @file map_layers.hpp  What vector files show in a scene: draped over ground and bed, or hung in
/// air and water at heights of their own.
#include "scene/space_lines.hpp"

#include <optional>
#include <string>
#include <vector>

namespace tarn::scene {

struct MapLayer {
    std::string name; ///< of its file
    SpaceShapes shapes;
    std::vector<std::string> labels;      ///< of the points; empty ones have none
    std::optional<HeightsFrom> heights{}; ///< of lines in space; nothing: it is draped
};

/// Drapes those that are draped.
/// @return whether anything of them lies on the scene, or there are none
bool drape_layers(Scene& scene, const std::vector<MapLayer>& layers);

/// Hangs those that are in space, and places all labels: anew when the water has moved.
/// @throws tarn::Error  naming the layer: it has no heights, or too many pieces
void hang_layers(Scene& scene, const std::vector<MapLayer>& layers);

} // namespace tarn::scene
