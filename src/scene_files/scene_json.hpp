#pragma once
/// @file scene_json.hpp  scene.json <-> Scene, without the rasters. Schema: docs/scene-folder.md.
#include "scene/scene.hpp"

#include <string>

namespace tarn::scene_files {

/// The version that this program writes, and the only one that it reads.
inline constexpr int schema_version = 2;

/// Names of the rasters inside the folder.
struct FileNames {
    std::string ground = "ground.tif", water = "water.tif", heights = "heights.tif", ortho,
                safety_ground;
    std::string safety_sum; ///< core/safety_radius.hpp: of the ground that it was made for
};

/// @return the text of scene.json, two-space indented, ending with a newline
std::string to_json(const scene::Scene& scene, const FileNames& files);

/// What `tarn detect --json` prints: "lakes" as in scene.json, and "import", the report.
std::string detection_json(const std::vector<LakeRecord>& lakes, const ImportReport& report);

/// One row of `tarn stats`.
struct StageRow {
    double level_m = 0.0, area_m2 = 0.0, true_area_m2 = 0.0;
    std::optional<double> volume_m3, true_volume_m3, max_depth_m, mean_depth_m;
    double shoreline_m = 0.0;
    int islands = 0, pools = 0;
    bool open_at_edge = false;
};

/// What `tarn stats --json` prints: "lake", "spill", "stages".
std::string stages_json(const LakeRecord& lake, const std::optional<LakeSpill>& spill,
                        const std::vector<StageRow>& rows);

/// Fills everything but the codes of `ground`, `water` and `ortho` (whose sizes are set).
/// @throws tarn::Error  naming the field: missing, of the wrong type, out of range, unknown
/// version,
///                      or a file name that leaves the folder
scene::Scene from_json(const std::string& text, FileNames& files);

} // namespace tarn::scene_files
