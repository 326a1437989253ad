#pragma once
/// @file scene_json.hpp  scene.json <-> Scene, without the rasters. Schema: docs/scene-folder.md.
#include "scene/scene.hpp"

#include <string>

namespace tarn::scene_files {

/// The version that this program writes, and the only one that it reads.
inline constexpr int schema_version = 1;

/// Names of the rasters inside the folder.
struct FileNames {
    std::string ground = "ground.tif", water = "water.tif", ortho;
};

/// @return the text of scene.json, two-space indented, ending with a newline
std::string to_json(const scene::Scene& scene, const FileNames& files);

/// Fills everything but the codes of `ground`, `water` and `ortho` (whose sizes are set).
/// @throws tarn::Error  naming the field: missing, of the wrong type, out of range, unknown
/// version,
///                      or a file name that leaves the folder
scene::Scene from_json(const std::string& text, FileNames& files);

} // namespace tarn::scene_files
