#include "app/bench_matrix.hpp"
#include "app/command.hpp"
#include "app/commit.hpp"
#include "app/console.hpp"
#include "app/plot.hpp"
#include "bench/adversary.hpp"
#include "bench/intersection.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "image/files.hpp"
#include "scene/samples.hpp"
#include "scene_files/scene_folder.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace tarn::app {

namespace {

using nlohmann::json;

struct BenchWords {
    MatrixWords matrix;
    std::string scene, size = "800x600", json_file, chart, pictures, report, against;
    std::vector<std::string> from;
    std::vector<std::string> scenes, methods, views;
    int synthetic = 1024, runs = 7, rays = 20'000;
    bool intersection = false, failures = false, size_given = false;
};

json measure(const BenchWords& words) {
    bench::IntersectionOptions options;
    options.methods = words.methods;
    bench::PictureSize size;
    char extra = 0;
    if (std::sscanf(words.size.c_str(), "%dx%d%c", &size.width_px, &size.height_px, &extra) != 2)
        throw Error("--size '" + words.size + "' is not understood",
                    "write WIDTHxHEIGHT, like 800x600");
    scene::RenderSettings range;
    range.width_px = size.width_px;
    range.height_px = size.height_px;
    range.validate(); // before a scene is made
    options.sizes = {size};
    options.runs = words.runs;
    options.judged_rays = words.rays;
    scene::Scene scene;
    std::string name;
    std::vector<bench::NamedView> views;
    if (words.scene.empty()) {
        scene = scene::mountain_lake(words.synthetic);
        name = text("synthetic ", words.synthetic);
        views = bench::mountain_views();
    } else {
        scene = scene_files::load(words.scene);
        scene.safety_radii = scene_files::load_safety_radii(words.scene, scene);
        std::filesystem::path folder = std::filesystem::path(words.scene).lexically_normal();
        name = (folder.has_filename() ? folder : folder.parent_path()).filename().string();
        for (const scene::NamedCamera& camera : scene.cameras)
            views.push_back({camera.name, camera.camera});
    }
    if (!words.views.empty()) {
        std::vector<bench::NamedView> chosen;
        for (const std::string& wanted : words.views) {
            const auto at = std::find_if(views.begin(), views.end(),
                                         [&](const auto& v) { return v.name == wanted; });
            if (at == views.end()) {
                std::string names;
                for (const auto& v : views)
                    names += (names.empty() ? "" : ", ") + v.name;
                throw Error("--views: no view is called '" + wanted + "'", "use " + names);
            }
            chosen.push_back(*at);
        }
        views = chosen;
    }
    const gpu::Context context;
    const auto results = bench::compare_methods(scene, name, views, options, console_progress());
    end_progress();
    std::ostringstream out;
    bench::write_json(out, context.renderer(), built_commit(), results);
    return json::parse(out.str());
}

json read_results(const std::string& option, const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in)
        throw Error(option + " " + path + ": no such file", "name a file that --json wrote");
    try {
        json stored = json::parse(in);
        for (const char* key : {"device", "commit", "results"})
            if (!stored.contains(key))
                throw Error(option + " " + path + ": has no '" + key + "'",
                            "name a file that --json wrote");
        if (!stored.at("results").is_array() ||
            (stored.at("results").empty() && !stored.contains("seed_table")))
            throw Error(option + " " + path + ": holds no results",
                        "name a file that --json wrote");
        return stored;
    } catch (const json::exception& error) {
        throw Error(option + " " + path + ": is not understood (" + error.what() + ")",
                    "name a file that --json wrote");
    }
}

/// Runs done in parts are one; what is there once, a device or the seed's table, is the last one's.
json read_parts(const std::vector<std::string>& paths) {
    json all;
    for (const std::string& path : paths) {
        json part = read_results("--from", path);
        if (all.is_null()) {
            all = std::move(part);
            continue;
        }
        if (part.at("device") != all.at("device"))
            throw Error("--from " + path + ": was measured on another device than " + paths.front(),
                        "name the parts of one run");
        for (const json& r : part.at("results"))
            all.at("results").push_back(r);
        if (part.contains("seed_table"))
            all["seed_table"] = part.at("seed_table");
    }
    return all;
}

void print_table(const json& all) {
    std::cout << "device " << all.at("device").get<std::string>() << ", commit "
              << all.at("commit").get<std::string>() << "\n";
    std::string last;
    for (const json& r : all.at("results")) {
        const std::string head =
            text(r.at("scene").get<std::string>(), ", ", r.at("view").get<std::string>(), ", ",
                 r.at("width"), "x", r.at("height"));
        if (head != last)
            std::cout << head
                      << "\n  method            setting    time [ms]   M rays/s     missed      "
                         "wrong   mean error\n";
        last = head;
        char line[200];
        std::snprintf(line, sizeof line, "  %-16s %8g  %11.3f  %9.2f  %9.2e  %9.2e  %11.2e\n",
                      r.at("method").get<std::string>().c_str(),
                      r.at("settings").at("steps").get<double>(), r.at("time_ms").get<double>(),
                      1e-6 * r.at("rays_per_s").get<double>(), r.at("missed_rate").get<double>(),
                      r.at("wrong_rate").get<double>(), r.at("mean_error").get<double>());
        std::cout << line;
    }
}

/// One panel for each field, view and size: the first six.
TradePlot trades_of(const json& all) {
    TradePlot plot;
    plot.title = "First hits: time against error";
    plot.device = all.at("device").get<std::string>();
    for (const json& r : all.at("results")) {
        const std::string title =
            text(r.at("scene").get<std::string>(), ", ", r.at("view").get<std::string>(), ", ",
                 r.at("width"), "×", r.at("height"));
        auto panel = std::find_if(plot.panels.begin(), plot.panels.end(),
                                  [&](const auto& p) { return p.title == title; });
        if (panel == plot.panels.end()) {
            if (plot.panels.size() == 6)
                continue;
            plot.panels.push_back({title, {}, r.at("hits").get<double>()});
            panel = plot.panels.end() - 1;
        }
        const std::string name = r.at("method").get<std::string>();
        auto method = std::find_if(panel->methods.begin(), panel->methods.end(),
                                   [&](const auto& m) { return m.name == name; });
        if (method == panel->methods.end()) {
            panel->methods.push_back({name, {}});
            method = panel->methods.end() - 1;
        }
        const double steps = r.at("settings").at("steps").get<double>();
        method->points.push_back(
            {r.at("time_ms").get<double>(),
             r.at("missed_rate").get<double>() + r.at("wrong_rate").get<double>(),
             steps > 0 ? text(steps) : std::string()});
    }
    return plot;
}

/// One field as an exact method and as another one shows it, side by side.
void draw_failure(const scene::Scene& field, const scene::WalkMethod& method,
                  const std::string& path) {
    const Heightfield& g = field.ground;
    const double w = g.east_m() - g.west_m, h = g.north_m - g.south_m();
    const double low = g.min_elevation_m(), relief = g.max_elevation_m() - low;
    const double rise = std::min(0.6 * relief, 0.35 * w) + 0.05 * w;
    const glm::dvec3 from(g.west_m + 0.62 * w, g.south_m() - 0.25 * h, low + rise);
    scene::View view;
    view.camera =
        scene::look_along(from, glm::dvec3(-0.1 * w, 0.75 * h, -0.8 * rise), {0, 0, 1}, 50.0);
    view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(0.8, -0.2, 0.5)));
    view.settings = {};
    view.settings.width_px = 400;
    view.settings.height_px = 300;
    view.settings.samples = 1;
    view.settings.ground_albedo = 0.4;
    render::Renderer renderer(field);
    const Image right = renderer.draw(view);
    view.settings.walk = method.walk;
    const Image wrong = renderer.draw(view);
    Picture picture{.width_px = 808, .height_px = 300, .channels = 3, .bytes = {}};
    for (int y = 0; y < 300; ++y)
        for (int x = 0; x < 808; ++x)
            for (int k = 0; k < 3; ++k) {
                const Image& image = x < 400 ? right : wrong;
                const int column = x < 400 ? x : x - 408;
                const double value =
                    column < 0 ? 1.0 : double(image.radiance[std::size_t(y * 400 + column)][k]);
                picture.bytes.push_back(std::uint8_t(
                    std::clamp(255.0 * std::pow(std::max(0.0, value), 1 / 2.2), 0.0, 255.0)));
            }
    image::write_png(path, picture, {});
}

/// Share of failures of each method for each class of ray, over fields made to break it.
void print_failures(const BenchWords& words) {
    const gpu::Context context;
    const auto fields = bench::adversarial_fields();
    const Progress progress = console_progress();
    std::cout << "| method | field |";
    for (const char* name : bench::ray_class_names)
        std::cout << " " << name << " |";
    std::cout << "\n| --- | --- |" << [] {
        std::string out;
        for (std::size_t k = 0; k < bench::ray_class_names.size(); ++k)
            out += " --- |";
        return out;
    }() << "\n";
    std::size_t done = 0;
    for (const scene::WalkMethod& method : scene::walk_methods()) {
        if (!words.methods.empty() && std::find(words.methods.begin(), words.methods.end(),
                                                method.name) == words.methods.end())
            continue;
        double worst_share = 0.0;
        const scene::Scene* worst = nullptr;
        for (const auto& field : fields) {
            progress.report(double(done++) / double(fields.size() * scene::walk_methods().size()),
                            method.name);
            render::Renderer renderer(field.scene);
            std::string row = text("| ", method.name, " | ", field.name, " |");
            for (std::size_t k = 0; k < bench::ray_class_names.size(); ++k) {
                auto rays = bench::make_rays(field.scene, static_cast<bench::RayClass>(k),
                                             words.rays, unsigned(k + 1));
                const auto rounded = bench::round_rays(field.scene, rays);
                const auto got = renderer.trace_rays(rounded, method.walk, 0.0, false);
                const bench::Verdict v = bench::judge_hits(field.scene, rays, got, false);
                const double hits = std::max(1, v.hits);
                // Off by less than half a cell is a matter of settings; this is one of method.
                const int bad = v.missed + v.far_off + v.invented;
                if (bad / hits > worst_share) {
                    worst_share = bad / hits;
                    worst = &field.scene;
                }
                if (v.failures() == 0) // nothing at all, not even by a quantum
                    row += " 0 |";
                else
                    row += text(" ", fixed(100.0 * v.missed / hits, 2), " + ",
                                fixed(100.0 * (v.far_off + v.invented) / hits, 2), " |");
            }
            std::cout << row << "\n" << std::flush;
        }
        if (worst && !words.pictures.empty())
            draw_failure(*worst, method, words.pictures + "/failure_" + method.name + ".png");
    }
    end_progress();
}

int run_matrix(const BenchWords& words) {
    if (!words.report.empty())
        check_plot("chart.png");
    json against;
    if (!words.against.empty())
        against = read_results("--against", words.against);
    const json all = words.from.empty() ? measure_matrix(words.matrix) : read_parts(words.from);
    try {
        print_matrix(all);
        if (!words.json_file.empty())
            write_beside(words.json_file, all.dump(1) + "\n");
        if (!words.report.empty())
            write_report(all, words.report, command_line());
        if (!words.against.empty() && print_changes(all, against) == 0)
            throw Error("--against " + words.against + ": has no row of what was measured",
                        "measure the same scenes, views, sizes and effects");
    } catch (const json::exception& error) {
        throw Error(text("the results are not understood (", error.what(), ")"),
                    "name files that --json wrote without --intersection");
    }
    return 0;
}

int run_bench(BenchWords words) {
    // Whatever cannot be written is told before minutes of work.
    for (const std::string& output :
         {words.json_file, words.chart, words.pictures.empty() ? "" : words.pictures + "/x"}) {
        const auto folder = std::filesystem::path(output).parent_path();
        if (!folder.empty() && !std::filesystem::is_directory(folder))
            throw Error(folder.string() + ": no such folder", "create it first");
    }
    if (!words.chart.empty())
        check_plot(words.chart);
    if (!words.intersection) {
        if (words.failures || !words.methods.empty() || !words.chart.empty())
            throw Error("--failures, --methods and --chart belong to --intersection",
                        "add --intersection, or leave them out");
        words.matrix.scenes = words.scenes;
        words.matrix.views = words.views;
        return run_matrix(words);
    }
    if (words.scenes.size() > 1)
        throw Error("--intersection takes one scene");
    if (!words.report.empty() || !words.against.empty() || !words.matrix.effects.empty())
        throw Error("--report, --against and --effects do not go with --intersection",
                    "leave them out; --chart draws");
    words.scene = words.scenes.empty() ? "" : words.scenes.front();
    words.size = words.size_given ? words.matrix.sizes : words.size;
    if (words.failures) {
        print_failures(words);
        return 0;
    }
    const json all = words.from.empty() ? measure(words) : read_parts(words.from);
    try {
        print_table(all);
        if (!words.json_file.empty())
            write_beside(words.json_file, all.dump(1) + "\n");
        if (!words.chart.empty())
            draw_trades(trades_of(all), words.chart);
    } catch (const json::exception& error) {
        throw Error((words.from.empty() ? "the results" : "--from " + words.from.front()) +
                        ": are not understood (" + error.what() + ")",
                    "name a file that --json wrote");
    }
    return 0;
}

} // namespace

void add_bench(CLI::App& app, Run& run) {
    auto words = std::make_shared<BenchWords>();
    CLI::App* c = app.add_subcommand("bench", "speed against accuracy: table, JSON, chart");
    MatrixWords& m = words->matrix;
    CLI::Option* scene =
        c->add_option("SCENE", words->scenes,
                      "scene folders, bowl, mountain:NODES; without any a bowl and "
                      "a mountain lake, both made of formulas");
    c->add_option("--effects", m.effects, "only these parts of the picture, comma between")
        ->delimiter(',')
        ->check(CLI::IsMember(effect_names()));
    c->add_option("--wind", m.wind_m_per_s, "besides calm water; 0: calm alone [m/s]")
        ->check(CLI::Range(0.0, 30.0))
        ->capture_default_str();
    c->add_option("--samples", m.samples, "a pixel, of the pictures that are judged")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    c->add_option("--max-error", m.budget.max_error,
                  "a row for what the planner makes of this mean relative error");
    c->add_option("--frame-time", m.budget.frame_time_ms,
                  "a row for what the planner makes of this time [ms]");
    c->add_option("--scaling", m.scaling,
                  "scenes that are drawn as a whole only, for cost against size, comma between")
        ->delimiter(',');
    c->add_flag("--seed-table", m.seed_table,
                "besides: Table 1 of Baboud & Decoret 2006, pictures a second by share of water");
    c->add_option("--reference", m.reference,
                  "hold pictures of calm water, all or none against the double-precision tracer, "
                  "which takes its time and is kept")
        ->check(CLI::IsMember({"calm", "all", "none"}))
        ->capture_default_str();
    c->add_option("--cache", m.cache, "where its pictures are kept; default: the user's cache");
    c->add_option("--report", words->report,
                  "a folder for report.md with its charts; needs gnuplot");
    c->add_option("--against", words->against,
                  "mark what differs from the results of an earlier --json");
    c->add_flag("--intersection", words->intersection,
                "instead: ways of finding a ray's first hit");
    c->add_option("--synthetic", words->synthetic,
                  "with --intersection: nodes a side of the synthetic lake")
        ->check(CLI::Range(17, 16384))
        ->capture_default_str();
    std::vector<std::string> names;
    for (const scene::WalkMethod& method : scene::walk_methods())
        names.emplace_back(method.name);
    c->add_option("--methods", words->methods, "only these, comma between")
        ->delimiter(',')
        ->check(CLI::IsMember(names));
    c->add_option(
         "--views", words->views,
         "only these: high, grazing, shore, top, dive-down, dive-up, half-submerged, the scene's "
         "cameras; with --intersection its cameras, or high, grazing, shore, below")
        ->delimiter(',');
    CLI::Option* size = c->add_option(
        "--size", m.sizes,
        "of the pictures [px], commas between: the first for everything, others for the picture as "
        "a whole; default 320x240, with --intersection 800x600");
    c->add_option("--runs", words->runs, "timed pictures; the median counts")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    c->add_option("--rays", words->rays,
                  "judged against the double-precision walk, a picture or class")
        ->check(CLI::Range(100, 10'000'000))
        ->capture_default_str();
    CLI::Option* failures =
        c->add_flag("--failures", words->failures,
                    "instead: a table of failures over fields and rays made to break methods");
    c->add_option("--pictures", words->pictures,
                  "with --failures: a folder for a picture of each method's worst field")
        ->needs(failures);
    CLI::Option* json_file = c->add_option("--json", words->json_file, "write the results");
    CLI::Option* chart =
        c->add_option("--chart", words->chart, "draw time against error (.svg, .png, .pdf)");
    CLI::Option* from =
        c->add_option(
             "--from", words->from,
             "results of an earlier --json instead of measuring; parts of a run, comma between")
            ->delimiter(',');
    failures->excludes(json_file)->excludes(chart)->excludes(from)->excludes(scene);
    from->excludes(scene);
    c->footer(
        "Examples:\n"
        "  tarn bench --report out --json out/bench.json\n"
        "  tarn bench bowl --effects all --scaling mountain:1024,mountain:4096 --report sizes\n"
        "  tarn bench rotoma bowl --effects caustics,shafts --reference all\n"
        "  tarn bench --against yesterday.json\n"
        "  tarn bench --intersection --chart walks.svg --json walks.json\n"
        "  tarn bench rotoma --intersection --methods cone-map,uniform-steps --views shore\n"
        "  tarn bench --intersection --failures --rays 5000\n"
        "  tarn bench --intersection --from gpu.json --chart gpu.svg");
    c->callback([words, size, &run] {
        words->size_given = size->count() > 0;
        words->matrix.runs = words->runs;
        run = [words] { return run_bench(*words); };
    });
}

} // namespace tarn::app
