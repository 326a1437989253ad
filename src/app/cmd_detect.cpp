// `tarn detect` — the lakes in elevation tiles: position, level, area.
#include "app/command.hpp"
#include "app/console.hpp"
#include "app/dem_options.hpp"
#include "core/text.hpp"
#include "scene_files/scene_json.hpp"

#include <iomanip>
#include <iostream>
#include <memory>

namespace tarn::app {

namespace {

void print_table(const dem::Detection& found) {
    std::cout << "  id       level m     area km2   true km2  shore km  isl.  position\n";
    for (const LakeRecord& lake : found.lakes)
        std::cout << std::setw(4) << lake.id << std::setw(14) << fixed(lake.level_m, 3)
                  << std::setw(13) << fixed(lake.area_m2 / 1e6, 4) << std::setw(11)
                  << fixed(lake.true_area_m2 / 1e6, 4) << std::setw(10)
                  << fixed(lake.shoreline_m / 1e3, 2) << std::setw(6) << lake.islands << "  "
                  << fixed(lake.position.lat_deg, 5) << "," << fixed(lake.position.lon_deg, 5)
                  << (lake.sea ? "  sea" : "") << (lake.open_at_edge ? "  cut by the edge" : "")
                  << (lake.bed == Bed::measured ? "  with its bed" : "") << "\n";
    for (const std::string& note : found.report.notes)
        std::cout << "  note: " << note << "\n";
}

} // namespace

void add_detect(CLI::App& app, Run& run) {
    struct Words {
        DemWords dem;
        bool json = false;
    };
    auto words = std::make_shared<Words>();
    CLI::App* c = app.add_subcommand("detect", "lakes found in elevation tiles");
    add_dem_options(*c, words->dem);
    c->add_flag("--json", words->json, "the same for programs");
    c->footer("Examples:\n  tarn detect N43E006.hgt N43E007.hgt.zip\n"
              "  tarn detect dem.tif --min-area 0.5 --json | jq .lakes[].level_m");
    c->callback([words, &run] {
        run = [words] {
            read_dem_words(words->dem);
            const dem::Detection found = dem::detect_lakes(words->dem.options, console_progress());
            end_progress();
            if (words->json)
                std::cout << scene_files::detection_json(found.lakes, found.report);
            else if (found.lakes.empty())
                std::cout << "no water surface of at least "
                          << fixed(words->dem.options.min_area_km2, 2) << " km2 found\n";
            else
                print_table(found);
            return 0;
        };
    });
}

} // namespace tarn::app
