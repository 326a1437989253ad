#pragma once
/// @file scene_json.hpp  scene.json <-> Scene, without the rasters. Schema: docs/scene-folder.md.
#include "scene/scene.hpp"
#include "waves/sea.hpp"

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

struct FetchRow {
    double from_deg = 0.0, fetch_m = 0.0;
};

struct LakeWaves {
    int id = 0;
    std::string name;
    waves::SeaReport report;
};

/// What `tarn waves` finds.
struct WavesReport {
    struct CascadeRow {
        double patch_m, shortest_m, longest_m, significant_height_m, mean_square_slope, choppiness;
    };
    struct RoseRow {
        double from_deg, speed_m_per_s, share, significant_height_m, peak_period_s;
    };
    waves::SeaReport sea; ///< what is drawn
    int texels = 0;       ///< a side of each patch
    std::vector<CascadeRow> cascades;
    std::vector<LakeWaves> lakes;
    std::vector<FetchRow> fetches; ///< of the first lake
    std::vector<RoseRow> rose;     ///< of the first lake, where a wind rose was given
};
std::string waves_json(const WavesReport& report);

/// The text of a scene.json with other cameras; the rest stays as it is.
/// @throws tarn::Error  if it is no JSON object
std::string with_cameras(const std::string& text, const std::vector<scene::NamedCamera>& cameras);

/// Fills everything but the codes of `ground`, `water` and `ortho` (whose sizes are set).
/// @throws tarn::Error  naming the field: missing, of the wrong type, out of range, unknown
/// version,
///                      or a file name that leaves the folder
scene::Scene from_json(const std::string& text, FileNames& files);

} // namespace tarn::scene_files
