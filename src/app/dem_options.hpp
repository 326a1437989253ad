#pragma once
/// @file dem_options.hpp  The options about elevation data that import and detect share.
#include "dem/import.hpp"

#include <CLI/App.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace tarn::app {

struct DemWords {
    dem::ImportOptions options;
    std::vector<std::string> dems;
    std::string at, bounds, nodata;
    std::string source, sources, cache; ///< of tiles on the network
};

void add_dem_options(CLI::App& command, DemWords& words);

/// Turns the words into options, after parsing.
/// @throws tarn::Error  naming the option
void read_dem_words(DemWords& words);

/// Where this user's programs keep files of some kind: $VARIABLE, else a folder of the home.
std::filesystem::path user_folder(const char* variable, const char* fallback);

} // namespace tarn::app
