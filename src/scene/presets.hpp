#pragma once
/// @file presets.hpp  Cameras that give a good picture of any lake without further options.
#include "scene/camera.hpp"
#include "scene/scene.hpp"

#include <string>
#include <vector>

namespace tarn::scene {

/// "overview" from above one end, "shore" over the water from a bank, "top" straight down with
/// north up, "dive" below the surface towards the shallows.
const std::vector<std::string>& preset_names();

/// @param sun_direction  unit, towards the sun: views with the sun behind the camera are preferred
/// @param aspect         picture width over height
/// @throws tarn::Error  if the name is none of preset_names()
Camera preset_camera(const Scene& scene, const LakeRecord& lake, const std::string& name,
                     glm::dvec3 sun_direction, double aspect);

} // namespace tarn::scene
