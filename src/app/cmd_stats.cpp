// `tarn stats` — level, area, volume, shoreline of a lake: a table and a plot.
#include "app/command.hpp"
#include "app/console.hpp"
#include "app/plot.hpp"
#include "app/view_options.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/stages.hpp"
#include "scene_files/scene_folder.hpp"
#include "scene_files/scene_json.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <spdlog/spdlog.h>
#include <unistd.h>

namespace tarn::app {

namespace {

struct StatsWords {
    std::string scene, levels, output, plot;
    int lake = 1, neighbours = 8;
    bool json = false;
};

std::string csv(const dem::StageTable& table) {
    std::string out = "level_m,area_m2,true_area_m2,volume_m3,true_volume_m3,max_depth_m,"
                      "mean_depth_m,shoreline_m,islands,pools,open_at_edge\n";
    const auto number = [](const std::optional<double>& v, int digits) {
        return v ? fixed(*v, digits) : std::string();
    };
    for (const dem::Stage& s : table.stages)
        out += text(text(s.level_m), ",", fixed(s.area_m2, 4), ",", fixed(s.true_area_m2, 4), ",",
                    number(s.volume_m3, 4), ",", number(s.true_volume_m3, 4), ",",
                    number(s.max_depth_m, 4), ",", number(s.mean_depth_m, 4), ",",
                    fixed(s.shoreline_m, 2), ",", s.islands, ",", s.pools, ",",
                    s.open_at_edge ? "true" : "false", "\n");
    return out;
}

int run_stats(const StatsWords& words) {
    const std::vector<double> levels = parse_levels(words.levels);
    const scene::Scene scene = scene_files::load(words.scene);
    const auto lake = std::find_if(scene.lakes.begin(), scene.lakes.end(),
                                   [&](const LakeRecord& l) { return l.id == words.lake; });
    if (lake == scene.lakes.end())
        throw Error(text("--lake ", words.lake, ": the scene has lakes ", scene.lakes.front().id,
                         " to ", scene.lakes.back().id),
                    "tarn info lists them");
    const Progress progress = console_progress();
    const Grid<float> heights = scene_files::load_heights(words.scene, scene);
    const dem::StageTable table = dem::stage_table(heights, scene.ground, scene.water, scene.frame,
                                                   *lake, levels, words.neighbours, progress);
    end_progress();
    const bool json = words.json || words.output.ends_with(".json");
    const std::string content =
        json ? scene_files::stages_json(
                   *lake, table.spill,
                   [&] {
                       std::vector<scene_files::StageRow> rows;
                       for (const dem::Stage& s : table.stages)
                           rows.push_back({s.level_m, s.area_m2, s.true_area_m2, s.volume_m3,
                                           s.true_volume_m3, s.max_depth_m, s.mean_depth_m,
                                           s.shoreline_m, s.islands, s.pools, s.open_at_edge});
                       return rows;
                   }())
             : csv(table);
    if (words.output.empty())
        std::cout << content;
    else
        write_beside(words.output, content);
    if (!words.plot.empty()) {
        StagePlot plot{.title = (lake->name.empty() ? text("Lake ", lake->id) : lake->name) +
                                ": level, area and volume" +
                                (lake->bed == Bed::estimated      ? " (bed estimated)"
                                 : lake->bed == Bed::interpolated ? " (bed interpolated)"
                                                                  : ""),
                       .points = {},
                       .lake_level_m = lake->level_m,
                       .spill_level_m = table.spill ? table.spill->level_m
                                                    : std::numeric_limits<double>::quiet_NaN()};
        // Beyond the pass the figures are of what the data happen to hold: not drawn.
        const bool cut = table.spill && table.spill->at_surface;
        if (table.spill &&
            (cut || table.spill->level_m > *std::max_element(levels.begin(), levels.end())))
            plot.spill_level_m = std::numeric_limits<double>::quiet_NaN(); // not within the plot
        for (const dem::Stage& s : table.stages)
            if (!s.open_at_edge || cut)
                plot.points.push_back(
                    {s.level_m, s.area_m2 / 1e6,
                     s.volume_m3 ? *s.volume_m3 / 1e6 : std::numeric_limits<double>::quiet_NaN()});
        std::sort(plot.points.begin(), plot.points.end(),
                  [](const auto& a, const auto& b) { return a.level_m < b.level_m; });
        if (plot.points.empty())
            throw Error("--plot: at every level asked for the water runs out of the data",
                        "ask for lower levels");
        draw_stages(plot, words.plot);
    }
    if (lake->bed == Bed::estimated)
        spdlog::warn("the bed is estimated, not surveyed: so are volumes and depths");
    const bool open = std::any_of(table.stages.begin(), table.stages.end(),
                                  [](const dem::Stage& s) { return s.open_at_edge; });
    if (open && table.spill)
        spdlog::warn(table.spill->at_surface
                         ? "the edge of the data cuts the lake: figures count what is inside"
                         : text("above ", fixed(table.spill->level_m, 2),
                                " m the water spills over the pass at ",
                                fixed(table.spill->pass.lat_deg, 5), ",",
                                fixed(table.spill->pass.lon_deg, 5),
                                " and leaves the data: those rows count only what is inside"));
    return 0;
}

} // namespace

void add_stats(CLI::App& app, Run& run) {
    auto words = std::make_shared<StatsWords>();
    CLI::App* c = app.add_subcommand("stats", "level, area and volume of a lake: table and plot");
    c->add_option("SCENE", words->scene, "scene folder")->required();
    c->add_option("--levels", words->levels, "FROM:TO:STEP, or a list with commas [m]")->required();
    c->add_option("--lake", words->lake, "id of the lake (tarn info)")->capture_default_str();
    c->add_option("--neighbours", words->neighbours,
                  "over which rising water spreads: 8, as tarn and r.lake do; some tools take 4")
        ->check(CLI::IsMember({4, 8}))
        ->capture_default_str();
    c->add_option("-o,--output", words->output, "file to write, .csv or .json; default: stdout");
    c->add_flag("--json", words->json, "JSON instead of CSV");
    c->add_option("--plot", words->plot, "plot of level against area and volume: .png, .svg, .pdf");
    c->footer("Examples:\n  tarn stats rotoma --levels 235:320:1 --plot rotoma.png\n"
              "  tarn stats rotoma --levels 300,310,313.31 --json | jq .stages[].volume_m3");
    c->callback([words, &run] { run = [words] { return run_stats(*words); }; });
}

} // namespace tarn::app
