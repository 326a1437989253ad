#pragma once
/// @file plot.hpp  Plots by gnuplot.
#include <filesystem>
#include <string>
#include <vector>

namespace tarn::app {

/// A level against the area and volume below it.
struct StagePlot {
    std::string title;
    struct Point {
        double level_m, area_km2, volume_million_m3;
    };
    std::vector<Point> points;  ///< volume NaN where the bed is unknown
    double lake_level_m = 0.0;  ///< drawn as a line
    double spill_level_m = 0.0; ///< drawn as a line if it lies within the plot
};

/// @param path  .png, .svg or .pdf
/// @throws tarn::Error  if gnuplot is not there or fails, or the file cannot be written
void draw_stages(const StagePlot& plot, const std::filesystem::path& path);

} // namespace tarn::app
