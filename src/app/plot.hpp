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

/// Can a plot be drawn to that name? For asking before long work.
/// @throws tarn::Error  if the ending is none of .png, .svg and .pdf, or gnuplot is not there
void check_plot(const std::filesystem::path& path);

/// @param path  .png, .svg or .pdf
/// @throws tarn::Error  if gnuplot is not there or fails, or the file cannot be written
void draw_stages(const StagePlot& plot, const std::filesystem::path& path);

/// Time against error of some ways of doing one thing, a panel for each view.
struct TradePlot {
    std::string title, device;
    struct Point {
        double time_ms, failures; ///< share of rays; 0: none was found among `judged`
        std::string setting;      ///< label; empty: none
    };
    struct Method {
        std::string name;
        std::vector<Point> points; ///< by setting
    };
    struct Panel {
        std::string title;
        std::vector<Method> methods;
        double judged; ///< rays behind each point
    };
    std::vector<Panel> panels; ///< one to six
};

/// @throws as draw_stages()
void draw_trades(const TradePlot& plot, const std::filesystem::path& path);

/// Ways of drawing, one point each: time and error against a picture at its best.
struct WayPlot {
    std::string title, device;
    struct Point {
        std::string effect, name;
        double time_share, error; ///< error 0 is drawn on the floor
        bool on_front;
    };
    std::vector<Point> points;
};

/// @throws as draw_stages()
void draw_ways(const WayPlot& plot, const std::filesystem::path& path);

/// Time of a picture against the size of something, a curve each.
struct CostPlot {
    std::string title, device, x_label;
    struct Point {
        double x, ms, low_ms, high_ms; ///< low and high: the least and the greatest of the views
    };
    struct Curve {
        std::string name;
        std::vector<Point> points; ///< by x
    };
    std::vector<Curve> curves;
};

/// @throws as draw_stages()
void draw_costs(const CostPlot& plot, const std::filesystem::path& path);

} // namespace tarn::app
