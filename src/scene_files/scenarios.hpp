#pragma once
/// @file scenarios.hpp  The table of `tarn sweep`.
#include "core/lake_record.hpp"

#include <optional>
#include <string>
#include <vector>

namespace tarn::scene_files {

/// One picture and what the lake holds in it.
struct Scenario {
    double level_m = 0.0;
    std::string camera, time, picture, command;
    bool done = false;
    double area_m2 = 0.0, true_area_m2 = 0.0;
    std::optional<double> volume_m3, true_volume_m3, max_depth_m, mean_depth_m;
    double shoreline_m = 0.0;
    int islands = 0;
    double exposed_bed_m2 = 0.0; ///< wet at the level of the scene, dry at this one
    double flooded_m2 = 0.0;     ///< the other way round
    bool open_at_edge = false;
};

struct Scenarios {
    std::string scene;
    LakeRecord lake; ///< as imported
    std::vector<Scenario> rows;
};

std::string scenarios_csv(const Scenarios& scenarios);
std::string scenarios_json(const Scenarios& scenarios);

} // namespace tarn::scene_files
