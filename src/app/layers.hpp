#pragma once
/// @file layers.hpp  Vector files -> layers of a scene.
#include "app/view_options.hpp"
#include "scene/map_layers.hpp"

#include <string>
#include <vector>

namespace tarn::app {

/// A vector file as a layer that is draped.
/// @throws tarn::Error  naming the file
scene::MapLayer read_layer(const std::string& path, const geo::Frame& frame);

/// The layers that the words name, draped and in space.
/// @throws tarn::Error  naming the file
std::vector<scene::MapLayer> read_layers(const ViewWords& words, const geo::Frame& frame);

/// Drapes layers, and hangs those in space.
/// @throws tarn::Error  also where nothing that is to be draped lies on the scene
void lay_layers(const std::vector<scene::MapLayer>& layers, scene::Scene& scene);

} // namespace tarn::app
