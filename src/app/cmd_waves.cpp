// `tarn waves` — what waves a wind raises on the lakes of a scene, in numbers that can be checked.
#include "app/command.hpp"
#include "app/console.hpp"
#include "app/view_options.hpp"
#include "core/text.hpp"
#include "geo/frame.hpp"
#include "scene_files/scene_folder.hpp"
#include "scene_files/scene_json.hpp"
#include "waves/sea.hpp"
#include "waves/wind_rose.hpp"

#include <cmath>
#include <iostream>
#include <memory>
#include <spdlog/spdlog.h>

namespace tarn::app {

namespace {

struct WavesWords {
    ViewWords view;
    std::string scene;
    bool json = false;
};

std::string metres(double m) {
    return m >= 1000.0 ? fixed(m / 1000.0, 2) + " km" : fixed(m, m < 10 ? 2 : 0) + " m";
}

/// Fetch of a lake's windiest shore for the sixteen directions of a compass.
std::vector<scene_files::FetchRow> fetches(const waves::WaterMask& mask, const scene::Scene& scene,
                                           const LakeRecord& lake, double convergence_deg) {
    std::vector<scene_files::FetchRow> out;
    waves::Settings s = scene.waves;
    for (int k = 0; k < 16; ++k) {
        const double from = 22.5 * k;
        const Grid<float> fetch = waves::effective_fetch_m(mask, from - convergence_deg);
        out.push_back(
            {from, waves::report_for(mask, fetch, scene.ground, scene.water, lake, s).fetch_m});
    }
    return out;
}

void print_lake(const scene_files::LakeWaves& lake) {
    const waves::SeaReport& r = lake.report;
    std::cout << "lake " << lake.id << (lake.name.empty() ? "" : ", " + lake.name) << ": ";
    if (!(r.significant_height_m > 0.0)) {
        std::cout << "calm (fetch " << metres(r.fetch_m) << ")\n";
        return;
    }
    std::cout << "Hs " << fixed(r.significant_height_m, 3) << " m, Tp " << fixed(r.peak_period_s, 2)
              << " s, length at the peak " << metres(r.peak_length_m) << ", mean square slope "
              << fixed(r.mean_square_slope, 4) << "\n  fetch " << metres(r.fetch_m) << ", "
              << (r.depth_m < 9999.0 ? "depth " + metres(r.depth_m)
                                     : std::string("depth unknown, taken as deep"))
              << "\n";
}

int run_waves(WavesWords& words) {
    const scene::Scene scene = scene_files::load(words.scene);
    waves::Settings settings = make_waves(words.view, scene);
    if (settings.model == waves::Model::calm && !words.view.waves)
        settings.model = waves::Model::jonswap; // what a wind would raise
    const waves::Sea sea = waves::make_sea(scene.ground, scene.water, scene.lakes, settings);
    const double turned = convergence_deg(scene);
    const waves::WaterMask mask = waves::water_mask(scene.ground, scene.water);
    const Grid<float> fetch = waves::effective_fetch_m(mask, settings.wind_from_deg);
    scene_files::WavesReport report;
    report.sea = sea.report;
    report.sea.wind_from_deg = settings.wind_from_deg + turned;
    report.texels = settings.texels;
    for (const waves::Cascade& c : sea.cascades)
        report.cascades.push_back({c.patch_m, 2 * M_PI / c.high_k, 2 * M_PI / c.low_k,
                                   4 * std::sqrt(c.moments.height), c.moments.slope(),
                                   c.choppiness});
    for (const LakeRecord& lake : scene.lakes)
        report.lakes.push_back(
            {lake.id, lake.name,
             waves::report_for(mask, fetch, scene.ground, scene.water, lake, settings)});
    report.fetches = fetches(mask, scene, scene.lakes.front(), turned);
    if (words.view.wind_rose)
        for (const waves::WindSector& sector : waves::read_wind_rose(*words.view.wind_rose)) {
            waves::Settings then = settings;
            then.wind_m_per_s = sector.speed_m_per_s;
            then.wind_from_deg = sector.from_deg - turned;
            const Grid<float> there = waves::effective_fetch_m(mask, then.wind_from_deg);
            const waves::SeaReport r = waves::report_for(mask, there, scene.ground, scene.water,
                                                         scene.lakes.front(), then);
            report.rose.push_back({sector.from_deg, sector.speed_m_per_s, sector.share,
                                   r.significant_height_m, r.peak_period_s});
        }
    if (words.json) {
        std::cout << scene_files::waves_json(report);
        return 0;
    }
    const waves::SeaReport& r = sea.report;
    std::cout << "model " << r.model;
    if (settings.model != waves::Model::sines && settings.model != waves::Model::calm)
        std::cout << ", wind " << fixed(settings.wind_m_per_s, 1) << " m/s from "
                  << fixed(std::fmod(report.sea.wind_from_deg + 720.0, 360.0), 0) << " deg";
    std::cout << "\n";
    for (const auto& lake : report.lakes)
        print_lake(lake);
    if (r.drawn_height_m > 0.0) {
        std::cout << "drawn: Hs " << fixed(r.drawn_height_m, 3)
                  << " m at the roughest place, waves of " << metres(r.longest_m) << " down to "
                  << metres(r.shortest_m) << ", mean square slope " << fixed(r.drawn_slope, 4)
                  << " of " << fixed(r.mean_square_slope, 4) << ", the rest counts as roughness\n";
        for (const auto& c : report.cascades)
            std::cout << "  patch of " << metres(c.patch_m) << ", " << settings.texels
                      << "^2: waves of " << metres(c.longest_m) << " to " << metres(c.shortest_m)
                      << ", Hs " << fixed(c.significant_height_m, 3) << " m, mean square slope "
                      << fixed(c.mean_square_slope, 4) << ", choppiness " << fixed(c.choppiness, 2)
                      << "\n";
    }
    std::cout << "effective fetch of lake " << scene.lakes.front().id
              << " by the wind's direction:\n";
    for (const auto& row : report.fetches)
        std::cout << "  " << fixed(row.from_deg, 1) << " deg  " << metres(row.fetch_m) << "\n";
    if (!report.rose.empty()) {
        std::cout << "wind rose, lake " << scene.lakes.front().id << ":\n";
        double mean = 0.0, most = 0.0;
        for (const auto& row : report.rose) {
            std::cout << "  " << fixed(row.from_deg, 0) << " deg  " << fixed(row.speed_m_per_s, 1)
                      << " m/s  " << fixed(100 * row.share, 1) << " %  Hs "
                      << fixed(row.significant_height_m, 3) << " m  Tp "
                      << fixed(row.peak_period_s, 2) << " s\n";
            mean += row.share * row.significant_height_m;
            most = std::max(most, row.significant_height_m);
        }
        std::cout << "  mean Hs " << fixed(mean, 3) << " m, greatest " << fixed(most, 3) << " m\n";
    }
    for (const std::string& note : r.notes)
        spdlog::info("waves: {}", note);
    return 0;
}

} // namespace

void add_waves(CLI::App& app, Run& run) {
    auto words = std::make_shared<WavesWords>();
    CLI::App* c =
        app.add_subcommand("waves", "heights, periods and slopes of the waves that a wind raises");
    c->add_option("SCENE", words->scene, "scene folder")->required();
    add_wave_options(*c, words->view);
    c->add_flag("--json", words->json, "JSON instead of text");
    c->footer("Examples:\n  tarn waves rotoma --wind 8 --wind-from 240\n"
              "  tarn waves rotoma --wind-rose rose.csv --json | jq .wind_rose");
    c->callback([words, &run] { run = [words] { return run_waves(*words); }; });
}

} // namespace tarn::app
