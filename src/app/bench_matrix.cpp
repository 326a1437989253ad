#include "app/bench_matrix.hpp"
#include "app/commit.hpp"

#include "app/console.hpp"
#include "app/dem_options.hpp"
#include "app/picture.hpp"
#include "app/plot.hpp"
#include "bench/matrix.hpp"
#include "bench/seed_table.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "gpu/objects.hpp"
#include "image/compare.hpp"
#include "image/files.hpp"
#include "reference/tracer.hpp"
#include "scene/curvature.hpp"
#include "scene/samples.hpp"
#include "scene_files/scene_folder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <glm/geometric.hpp>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

namespace tarn::app {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Size {
    int width_px, height_px;
};

std::vector<Size> parse_sizes(const std::string& words) {
    std::vector<Size> out;
    for (const std::string& one : split(words, ',')) {
        Size size{};
        char extra = 0;
        if (std::sscanf(one.c_str(), "%dx%d%c", &size.width_px, &size.height_px, &extra) != 2)
            throw Error("--size '" + one + "' is not understood",
                        "write WIDTHxHEIGHT, like 800x600, commas between several");
        scene::RenderSettings range;
        range.width_px = size.width_px;
        range.height_px = size.height_px;
        range.validate();
        out.push_back(size);
    }
    if (out.empty())
        throw Error("--size is empty", "write WIDTHxHEIGHT, like 800x600");
    return out;
}

/// A scene that is named on the command line, made of formulas or read from its folder.
std::pair<std::string, scene::Scene> named_scene(const std::string& word) {
    if (fs::exists(word)) {
        scene::Scene scene = scene_files::load(word);
        scene.safety_radii = scene_files::load_safety_radii(word, scene);
        const fs::path folder = fs::path(word).lexically_normal();
        return {(folder.has_filename() ? folder : folder.parent_path()).filename().string(),
                std::move(scene)};
    }
    if (word == "bowl")
        return {word, scene::bowl(513)};
    int side = 0;
    char extra = 0;
    if (std::sscanf(word.c_str(), "mountain:%d%c", &side, &extra) == 1) {
        if (side < 17 || side > 16384)
            throw Error("'" + word + "': nodes a side must be in [17, 16384]");
        return {word, scene::mountain_lake(side)};
    }
    throw Error(word + ": is no scene", "name a scene folder, bowl, or mountain:NODES");
}

/// Changes with every build: a reference picture of another tracer is none.
std::string program_mark() {
    std::error_code failed;
    const fs::path self = fs::read_symlink("/proc/self/exe", failed);
    return text(built_commit(), " ", fs::file_size(self, failed), " ",
                fs::last_write_time(self, failed).time_since_epoch().count());
}

/// Changes with everything that a reference picture depends on.
std::string mark_of(const scene::Scene& scene, const scene::View& view) {
    const auto& c = view.camera;
    const auto& s = view.settings;
    std::ostringstream all;
    all.precision(17);
    all << program_mark() << ' ' << scene.ground.spacing_m << ' ' << scene.ground.offset_m << ' '
        << scene.ground.scale_m << ' ' << scene.water.offset_m << ' ' << scene.water.scale_m << ' '
        << scene.ground.west_m << ' ' << scene.ground.north_m;
    for (const glm::dvec3& v : {c.position, c.forward, c.right, c.up, view.lighting.sun_direction,
                                view.lighting.sun_irradiance, view.lighting.sky_irradiance,
                                scene.optics.absorption_per_m, scene.optics.backscattering_per_m})
        all << ' ' << v.x << ' ' << v.y << ' ' << v.z;
    for (const scene::WaterBand& b : scene.optics.bands)
        all << ' ' << b.wavelength_nm << ' ' << b.absorption_per_m << ' ' << b.scattering_per_m
            << ' ' << b.backscattering_per_m;
    for (const LakeRecord& lake : scene.lakes)
        all << ' ' << lake.level_m << ' ' << int(lake.bed);
    all << ' ' << c.fov_deg << ' ' << s.width_px << ' ' << s.height_px << ' ' << s.samples << ' '
        << scene.optics.index << ' ' << scene.look.tree_line_m << ' ' << scene.look.snow_line_m
        << ' ' << int(view.waves.model) << ' ' << view.waves.wind_m_per_s << ' '
        << view.waves.wind_from_deg << ' ' << view.waves.texels << ' ' << view.waves.cascades << ' '
        << view.waves.seed << ' ' << scene::is_curved(scene, view);
    std::string words = all.str();
    for (const Heightfield* field : {&scene.ground, &scene.water})
        words.append(reinterpret_cast<const char*>(field->codes.values.data()),
                     field->codes.values.size() * sizeof field->codes.values[0]);
    if (scene.ortho)
        words.append(reinterpret_cast<const char*>(scene.ortho->picture.bytes.data()),
                     scene.ortho->picture.bytes.size());
    return short_sum(words);
}

/// The reference's picture, traced or as it was kept.
Image reference_picture(const scene::Scene& scene, const scene::View& view, const fs::path& cache) {
    const fs::path kept = cache / ("reference-" + mark_of(scene, view) + ".exr");
    if (fs::exists(kept))
        return image::read_exr(kept);
    const Image picture = reference::trace(scene, view, console_progress());
    std::error_code failed;
    fs::create_directories(cache, failed);
    image::write_exr(kept, picture, {});
    return picture;
}

double number(const json& value, const char* key) { return value.at(key).get<double>(); }
std::string word(const json& value, const char* key) { return value.at(key).get<std::string>(); }
std::string variant_of(const json& r) { return word(r.at("settings"), "variant"); }

/// "Rotoma, wind 6 m/s": what a table or a panel is about.
std::string subject_of(const json& r) { return text(word(r, "scene"), ", ", word(r, "state")); }

std::string size_of(const json& r) { return text(r.at("width"), "x", r.at("height")); }

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0.0 : values[values.size() / 2];
}

/// One way of drawing one scene, over its views.
struct Row {
    std::string effect, variant;
    double time_share = 0.0; ///< of the best's time: the median over views
    double mean = 0.0, worst = 0.0, p99 = 0.0, perceptual = -1.0, reference = -1.0, flux = -1.0;
    bool on_front = false; ///< nothing is both quicker and nearer to the best
};

/// Rows of one subject at its first size, in the order that they were measured in.
std::vector<Row> rows_of(const json& all, const std::string& subject) {
    std::string size;
    std::map<std::string, double> best_ms; // by view
    std::vector<std::pair<std::string, std::string>> order;
    std::map<std::pair<std::string, std::string>, std::vector<const json*>> found;
    for (const json& r : all.at("results")) {
        if (subject_of(r) != subject)
            continue;
        if (size.empty())
            size = size_of(r);
        if (size_of(r) != size)
            continue;
        const auto key = std::pair(word(r, "method"), variant_of(r));
        if (found[key].empty())
            order.push_back(key);
        found[key].push_back(&r);
        if (key.second == "best")
            best_ms[word(r, "view")] = number(r, "time_ms");
    }
    std::vector<Row> rows;
    for (const auto& key : order) {
        Row row{.effect = key.first, .variant = key.second};
        std::vector<double> shares;
        const auto& views = found[key];
        for (const json* r : views) {
            shares.push_back(number(*r, "time_ms") / best_ms[word(*r, "view")]);
            const double mean = number(r->at("error"), "mean");
            row.mean += mean / double(views.size());
            row.worst = std::max(row.worst, mean);
            row.p99 = std::max(row.p99, number(r->at("error"), "p99"));
            if (r->contains("perceptual_share"))
                row.perceptual = std::max(row.perceptual, number(*r, "perceptual_share"));
            if (r->contains("error_from_reference"))
                row.reference =
                    std::max(row.reference, 0.0) +
                    number(r->at("error_from_reference"), "mean") / double(views.size());
            if (r->contains("flux_error"))
                row.flux = std::max(row.flux, number(*r, "flux_error"));
        }
        row.time_share = median(shares);
        rows.push_back(row);
    }
    for (Row& row : rows)
        row.on_front = std::none_of(rows.begin(), rows.end(), [&](const Row& other) {
            return other.time_share <= row.time_share && other.mean <= row.mean &&
                   (other.time_share < row.time_share || other.mean < row.mean);
        });
    return rows;
}

std::vector<std::string> subjects_of(const json& all) {
    std::vector<std::string> out;
    for (const json& r : all.at("results"))
        if (std::find(out.begin(), out.end(), subject_of(r)) == out.end())
            out.push_back(subject_of(r));
    return out;
}

/// "-" for what was not measured.
std::string figure(double share) { return share < 0.0 ? "-" : percent(share, 3); }

std::string file_word(std::string words) {
    for (char& c : words)
        if (!std::isalnum(static_cast<unsigned char>(c)))
            c = '_';
    return words;
}

/// Curves of the time of best and default pictures, median over views, against what `x_of` says of
/// a result; those with one point alone are left out.
/// @param curve_of  what a curve holds besides
CostPlot costs_of(const json& all, const std::function<double(const json&)>& x_of,
                  const std::function<std::string(const json&)>& curve_of) {
    std::map<std::string, std::map<double, std::vector<double>>> found;
    std::vector<std::string> order;
    for (const json& r : all.at("results")) {
        const std::string variant = variant_of(r);
        if (word(r, "method") != "all" || (variant != "best" && variant != "default"))
            continue;
        const std::string name = curve_of(r) + ", " + variant;
        if (!found.count(name))
            order.push_back(name);
        found[name][x_of(r)].push_back(number(r, "time_ms"));
    }
    CostPlot plot;
    plot.device = word(all, "device");
    for (const std::string& name : order) {
        if (found[name].size() < 2)
            continue;
        CostPlot::Curve curve{name, {}};
        for (const auto& [x, ms] : found[name])
            curve.points.push_back({x, median(ms), *std::min_element(ms.begin(), ms.end()),
                                    *std::max_element(ms.begin(), ms.end())});
        plot.curves.push_back(std::move(curve));
    }
    return plot;
}

/// Cost against field size and resolution: charts, and what the report says of them.
std::string cost_charts(const json& all, const fs::path& folder) {
    std::string out;
    const auto section = [&](const CostPlot& plot, const std::string& chart, const std::string& x) {
        if (plot.curves.empty())
            return;
        draw_costs(plot, folder / chart);
        out += text(out.empty() ? "\n## Cost against size\n" : "", "\n![", plot.title, "](", chart,
                    ")\n\n| ", x, " |");
        std::string line = "\n| --- |";
        std::set<double> places;
        for (const auto& curve : plot.curves)
            for (const auto& p : curve.points)
                places.insert(p.x);
        for (const double p : places) {
            out += text(" ", p, " |");
            line += " --- |";
        }
        out += line + "\n";
        for (const auto& curve : plot.curves) {
            out += "| " + curve.name + " |";
            for (const double place : places) {
                const auto at = std::find_if(curve.points.begin(), curve.points.end(),
                                             [&](const auto& p) { return p.x == place; });
                out += at == curve.points.end() ? " - |" : " " + fixed(at->ms, 3) + " |";
            }
            out += "\n";
        }
        out += "\nMedian over views [ms]; bars: the quickest and the slowest view.\n";
    };
    const auto family = [](const json& r) { return split(word(r, "scene"), ':').front(); };
    CostPlot nodes = costs_of(
        all, [](const json& r) { return number(r, "nodes"); },
        [&](const json& r) { return text(family(r), ", ", word(r, "state"), ", ", size_of(r)); });
    nodes.title = "Cost against the field's size";
    nodes.x_label = "nodes a side";
    section(nodes, "cost_nodes.png", "nodes a side");
    CostPlot pixels = costs_of(
        all, [](const json& r) { return 1e-6 * number(r, "width") * number(r, "height"); },
        [](const json& r) { return subject_of(r); });
    pixels.title = "Cost against resolution";
    pixels.x_label = "million pixels";
    section(pixels, "cost_pixels.png", "million pixels");
    return out;
}

/// Baboud & Decoret's Table 1, if it was measured.
std::string seed_table_of(const json& all) {
    if (!all.contains("seed_table"))
        return {};
    const json& table = all.at("seed_table");
    std::string out = text("\n## The seed's Table 1\n\nBaboud & Decoret 2006, Table 1, with tarn: "
                           "pictures a second (ms) "
                           "at 800x600 by how much of the picture is water;\nmountain lake of ",
                           table.at("nodes"), " nodes a side, wind ", table.at("wind_m_per_s"),
                           " m/s, one sample a pixel. Theirs, on a GeForce 7800 FX with 128 nodes "
                           "a side: docs/performance.md.\n\n"
                           "| water |");
    std::string line = "\n| --- |";
    for (const json& mode : table.at("modes")) {
        out += " " + mode.get<std::string>() + " |";
        line += " --- |";
    }
    out += line + "\n";
    for (const json& row : table.at("rows")) {
        out += "| " + fixed(100.0 * number(row, "water_share"), 0) + " % |";
        for (const json& ms : row.at("time_ms"))
            out += text(" ", fixed(1000.0 / ms.get<double>(), 1), " (", fixed(ms.get<double>(), 3),
                        ") |");
        out += "\n";
    }
    return out;
}

} // namespace

std::vector<std::string> effect_names() {
    std::vector<std::string> names;
    for (const bench::Variant& v : bench::variants())
        if (std::find(names.begin(), names.end(), v.effect) == names.end())
            names.push_back(v.effect);
    return names;
}

json measure_matrix(const MatrixWords& words) {
    const std::vector<Size> sizes = parse_sizes(words.sizes);
    const fs::path cache = words.cache.empty() ? user_folder("XDG_CACHE_HOME", ".cache") / "tarn"
                                               : fs::path(words.cache);
    const std::vector<std::string> scenes =
        words.scenes.empty() ? std::vector<std::string>{"bowl", "mountain:1024"} : words.scenes;
    std::vector<std::pair<std::string, scene::Scene>> loaded; // all errors before any work
    for (const std::string& word : scenes)
        loaded.push_back(named_scene(word));
    for (const std::string& word : words.scaling)
        loaded.push_back(named_scene(word));
    const gpu::Context context;
    std::vector<bench::MatrixResult> results;
    for (std::size_t n = 0; n < loaded.size(); ++n) {
        auto& [name, scene] = loaded[n];
        const bool as_a_whole = n >= scenes.size();
        const glm::dvec3 sun = glm::normalize(glm::dvec3(0.5, -0.4, 0.75));
        std::vector<double> winds{0.0};
        if (words.wind_m_per_s > 0.0)
            winds.push_back(words.wind_m_per_s);
        for (std::size_t k = 0; k < sizes.size(); ++k) {
            const double aspect = double(sizes[k].width_px) / sizes[k].height_px;
            std::vector<scene::NamedCamera> views = bench::standard_views(scene, sun, aspect);
            const std::vector<std::string> wanted_views =
                !words.views.empty() ? words.views
                : gpu::is_software() ? std::vector<std::string>{"shore", "dive-up"} // or hours
                                     : std::vector<std::string>{};
            if (!wanted_views.empty()) {
                std::vector<scene::NamedCamera> all = views, chosen;
                for (const scene::NamedCamera& camera : scene.cameras)
                    all.push_back(camera);
                std::string names;
                for (const auto& v : all)
                    names += (names.empty() ? "" : ", ") + v.name;
                for (const std::string& wanted : wanted_views) {
                    const auto at = std::find_if(all.begin(), all.end(),
                                                 [&](const auto& v) { return v.name == wanted; });
                    if (at == all.end() && words.views.empty())
                        continue; // too shallow to dive in
                    if (at == all.end())
                        throw Error("--views: " + name + " has none called '" + wanted + "'",
                                    "use " + names);
                    chosen.push_back(*at);
                }
                views = chosen;
            }
            for (const double wind : winds) {
                bench::MatrixScene what;
                what.name = name;
                what.state = wind > 0.0 ? text("wind ", wind, " m/s") : "calm";
                what.views = views;
                what.view.lighting = scene::clear_sky(sun);
                if (wind > 0.0) {
                    what.view.waves.model = waves::Model::jonswap;
                    what.view.waves.wind_m_per_s = wind;
                    if (gpu::is_software()) // or the water is all that takes time
                        what.view.waves.texels = 256;
                }
                bench::MatrixOptions options;
                options.width_px = sizes[k].width_px;
                options.height_px = sizes[k].height_px;
                options.samples = words.samples;
                options.runs = words.runs;
                options.budget = words.budget;
                options.effects =
                    k == 0 && !as_a_whole ? words.effects : std::vector<std::string>{"all"};
                if (k == 0 && !as_a_whole)
                    options.perceptual = image::visible_share;
                if (k == 0 && !as_a_whole &&
                    (words.reference == "all" || (words.reference == "calm" && !(wind > 0.0))))
                    options.reference = [&](const scene::Scene& s, const scene::View& v) {
                        return std::optional(reference_picture(s, v, cache));
                    };
                for (bench::MatrixResult& r :
                     bench::run_matrix(scene, what, options, console_progress()))
                    results.push_back(std::move(r));
            }
        }
        scene = {};
    }
    std::ostringstream out, table;
    if (words.seed_table) {
        constexpr int nodes = 1024;
        bench::write_seed_table(table, nodes, words.wind_m_per_s,
                                bench::measure_seed_table(scene::mountain_lake(nodes),
                                                          words.wind_m_per_s, words.runs,
                                                          console_progress()));
    }
    end_progress();
    bench::write_json(out, context.renderer(), built_commit(), results, table.str());
    return json::parse(out.str());
}

void print_matrix(const json& all) {
    std::cout << "device " << word(all, "device") << ", commit " << word(all, "commit") << "\n";
    for (const std::string& subject : subjects_of(all)) {
        std::cout << subject
                  << "\n  part            way                 time  mean error  worst view"
                     "   99th pct.   visible  from the reference\n";
        for (const Row& r : rows_of(all, subject)) {
            char line[240];
            std::snprintf(line, sizeof line, "  %-14s %-18s %6.3f %11s %11s %11s %9s %11s%s\n",
                          r.effect.c_str(), r.variant.c_str(), r.time_share, figure(r.mean).c_str(),
                          figure(r.worst).c_str(), figure(r.p99).c_str(),
                          figure(r.perceptual).c_str(), figure(r.reference).c_str(),
                          r.on_front ? "  *" : "");
            std::cout << line;
        }
    }
    std::cout << "time: of the best's, median over views; errors against the best, mean over views "
                 "unless said;\n* nothing measured is both quicker and nearer\n";
}

int print_changes(const json& now, const json& then) {
    const auto key = [](const json& r) {
        return text(subject_of(r), ", ", word(r, "view"), ", ", size_of(r), ", ", word(r, "method"),
                    " ", variant_of(r));
    };
    std::map<std::string, const json*> old;
    for (const json& r : then.at("results"))
        old[key(r)] = &r;
    int compared = 0, changed = 0;
    const bool same_device = word(now, "device") == word(then, "device");
    std::cout << "against commit " << word(then, "commit") << " on " << word(then, "device")
              << (same_device ? "" : ": another device, times are as they are") << "\n";
    for (const json& r : now.at("results")) {
        const auto at = old.find(key(r));
        if (at == old.end())
            continue;
        ++compared;
        const json& o = *at->second;
        // Noise: quartiles of both runs, three times their distance, and a tenth at least.
        const double spread = (number(r, "time_q3_ms") - number(r, "time_q1_ms")) +
                              (number(o, "time_q3_ms") - number(o, "time_q1_ms"));
        const double by = number(r, "time_ms") - number(o, "time_ms");
        if (std::abs(by) > std::max(1.5 * spread, 0.1 * number(o, "time_ms"))) {
            ++changed;
            std::cout << "  " << key(r) << ": " << fixed(number(o, "time_ms"), 3) << " -> "
                      << fixed(number(r, "time_ms"), 3) << " ms ("
                      << (by > 0 ? "slower" : "quicker") << ")\n";
        }
        const double e = number(r.at("error"), "mean"), f = number(o.at("error"), "mean");
        if (std::abs(e - f) > std::max(0.05 * f, 1e-5)) {
            ++changed;
            std::cout << "  " << key(r) << ": error " << figure(f) << " -> " << figure(e)
                      << (e > f ? " (worse)" : " (better)") << "\n";
        }
    }
    std::cout << compared << " rows compared, " << changed << " differences beyond noise\n";
    return compared;
}

void write_report(const json& all, const std::string& folder, const std::string& command) {
    std::error_code failed;
    fs::create_directories(folder, failed);
    if (!fs::is_directory(folder))
        throw Error(folder + ": cannot be made", "check the path given with --report");
    std::ostringstream md;
    md << "# Speed against accuracy\n\nDevice: " << word(all, "device") << "; commit "
       << word(all, "commit") << ". Made by `" << command << "`.\n\n"
       << "Each row changes one part of the picture at its best. Time: of one picture, as a share "
          "of the best's,\nmedian over views. Error: relative radiance against the best at the "
          "same "
          "sample positions, mean over\npixels and views; the worst view; the worst view's 99th "
          "percentile. Visible: pixels where a person would\nsee it (Yee's measure), worst view. "
          "From the reference: against the double-precision tracer, in moving water in\nthe mean "
          "over blocks of 8 x 8 pixels. **Bold**: on the Pareto front, nothing measured is both "
          "quicker and nearer.\n";
    for (const std::string& subject : subjects_of(all)) {
        const std::vector<Row> rows = rows_of(all, subject);
        if (std::all_of(rows.begin(), rows.end(), [](const Row& r) { return r.effect == "all"; }))
            continue; // its cost alone was asked for
        const std::string chart = "trade_" + file_word(subject) + ".png";
        md << "\n## " << subject << "\n\n![Time against error, " << subject << "](" << chart
           << ")\n\n| part | way | time | mean error | worst view | 99th percentile | visible | "
              "from "
              "the reference | caustic flux off by |\n| --- | --- | --- | --- | --- | --- | --- | "
              "--- | --- |\n";
        WayPlot plot;
        plot.title = subject;
        plot.device = word(all, "device");
        for (const Row& r : rows) {
            const char* bold = r.on_front ? "**" : "";
            md << "| " << r.effect << " | " << bold << r.variant << bold << " | "
               << fixed(r.time_share, 3) << " | " << figure(r.mean) << " | " << figure(r.worst)
               << " | " << figure(r.p99) << " | " << figure(r.perceptual) << " | "
               << figure(r.reference) << " | " << figure(r.flux) << " |\n";
            plot.points.push_back({r.effect, r.variant, r.time_share, r.mean, r.on_front});
        }
        draw_ways(plot, fs::path(folder) / chart);
        // Share of each pass, best and default.
        std::vector<std::string> passes;
        std::map<std::string, std::map<std::string, double>> shares; // by variant
        for (const char* variant : {"best", "default"}) {
            double total = 0.0;
            for (const json& r : all.at("results"))
                if (subject_of(r) == subject && variant_of(r) == variant)
                    for (const auto& [pass, ms] : r.at("passes_ms").items()) {
                        if (std::find(passes.begin(), passes.end(), pass) == passes.end())
                            passes.push_back(pass);
                        shares[variant][pass] += ms.get<double>();
                        total += ms.get<double>();
                    }
            for (auto& [pass, share] : shares[variant])
                share /= std::max(total, 1e-12);
        }
        md << "\nShare of the picture's time by pass: ";
        for (const char* variant : {"best", "default"}) {
            md << (variant == std::string("best") ? "" : "; ") << variant;
            for (const std::string& pass : passes)
                if (shares[variant][pass] > 0.005)
                    md << " " << pass << " " << fixed(100.0 * shares[variant][pass], 0) << " %";
        }
        md << ".\n";
    }
    md << "\n## Times\n\nOne picture with one sample, at its best and by default [ms, median; "
          "quartiles]; memory of heights and bounds.\n\n"
          "| scene | nodes | view | picture | best | default | field [MB] |\n| --- | --- | --- | "
          "--- "
          "| --- | --- | --- |\n";
    std::map<std::string, const json*> best;
    const auto place = [](const json& r) {
        return text(subject_of(r), word(r, "view"), size_of(r));
    };
    for (const json& r : all.at("results"))
        if (variant_of(r) == "best")
            best[place(r)] = &r;
    const auto ms = [](const json& r) {
        return text(fixed(number(r, "time_ms"), 3), " (", fixed(number(r, "time_q1_ms"), 3), " to ",
                    fixed(number(r, "time_q3_ms"), 3), ")");
    };
    for (const json& r : all.at("results"))
        if (variant_of(r) == "default" && best.count(place(r)))
            md << "| " << subject_of(r) << " | " << r.at("nodes") << " | " << word(r, "view")
               << " | " << size_of(r) << " | " << ms(*best[place(r)]) << " | " << ms(r) << " | "
               << fixed(number(r, "field_mb"), 1) << " |\n";
    md << cost_charts(all, folder) << seed_table_of(all);
    write_beside((fs::path(folder) / "report.md").string(), md.str());
}

} // namespace tarn::app
