#pragma once
/// @file bench_matrix.hpp  `tarn bench` without --intersection: ways of drawing x views x scenes,
///                         and the report about it.
#include "render/planner.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tarn::app {

/// What was typed; empty = not given.
struct MatrixWords {
    std::vector<std::string> scenes;  ///< scene folders, `bowl`, `mountain:NODES`
    std::vector<std::string> scaling; ///< scenes drawn as a whole only, for cost against size
    std::vector<std::string> effects, views;
    std::string sizes = "320x240"; ///< the first for everything, others for `all` alone
    std::string reference = "calm";
    std::string cache;     ///< folder of reference pictures
    render::Budget budget; ///< of the planner's row
    double wind_m_per_s = 6.0;
    int samples = 4, runs = 5;
    bool seed_table = false; ///< besides (bench/seed_table.hpp)
};

/// Effects that can be named.
std::vector<std::string> effect_names();

/// Measures, as JSON.
/// @throws tarn::Error  naming the option and what is wrong
nlohmann::json measure_matrix(const MatrixWords& words);

/// Scenes and ways of drawing in a table on stdout.
void print_matrix(const nlohmann::json& all);

/// What differs from a stored run beyond the noise of both, a line each on stdout.
/// @return  how many rows of the two could be compared
int print_changes(const nlohmann::json& now, const nlohmann::json& then);

/// report.md with its charts, in a folder that is made if need be.
/// @param command  that made it
void write_report(const nlohmann::json& all, const std::string& folder, const std::string& command);

} // namespace tarn::app
