// tarn_planner_study - does the planner keep its budgets, and is it as quick as the best fixed
// setting? Random views of five lakes made of formulas, budgets in turn; each plan is held against
// everything at its best, pixel by pixel, and its time against every fixed setting of a grid that
// keeps the budget there. Made of what draws alone. Results: docs/planner.md.
//
//   tarn_planner_study [--views N] [--size WxH] [--seed N] [--json FILE]
#include "bench/timing.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "image/compare.hpp"
#include "render/planner.hpp"
#include "scene/samples.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <glm/geometric.hpp>
#include <iostream>
#include <random>

namespace {

using namespace tarn;

struct Lake {
    const char* name;
    scene::Scene scene;
    double wind_m_per_s;
};

/// Somewhere over or in the lake, looking anywhere that is not all sky.
scene::Camera random_camera(const scene::Scene& scene, std::mt19937& random) {
    std::uniform_real_distribution<double> even(0.0, 1.0);

    const Heightfield& g = scene.ground;
    for (;;) {
        const double x = std::lerp(g.west_m, g.east_m(), 0.15 + 0.7 * even(random)),
                     y = std::lerp(g.south_m(), g.north_m, 0.15 + 0.7 * even(random));
        const auto water = scene.water_level_m(x, y);
        const double ground = g.elevation_m(x, y), heading = 360.0 * even(random);
        const double lot = even(random), size = g.east_m() - g.west_m;
        if (lot < 0.35 && water && *water - ground > 2.0)
            return scene::look({x, y, std::lerp(ground + 0.5, *water - 0.5, even(random))}, heading,
                               -50.0 + 100.0 * even(random), 65.0);
        if (lot >= 0.35)
            return scene::look({x, y,
                                std::max(water.value_or(ground), ground) + 2.0 +
                                    0.15 * size * std::pow(even(random), 3.0)},
                               lot < 0.7 ? std::atan2(-x, -y) * 180.0 / 3.14159265 : heading,
                               -45.0 * even(random), 50.0);
    }
}

/// A fixed setting of the grid.
struct Fixed {
    bool shadows, mirrored_land;
    double left;
    int texels, photons, shafts; ///< texels 0: no caustics
    bool plane;
    scene::View applied(scene::View view) const {
        scene::RenderSettings& s = view.settings;
        s.shadows = shadows;
        s.mirrored_land = mirrored_land;
        s.least_transmittance = left;
        if (plane)
            view.waves = {};
        if (texels == 0)
            s.caustics = scene::Caustics::off;
        else {
            s.caustic_texels = texels;
            s.caustic_photons = photons;
        }
        s.shaft_steps = shafts;
        return view;
    }
};

std::vector<Fixed> grid_of(bool wavy) {
    std::vector<Fixed> out;
    for (const bool shadows : {true, false})
        for (const bool mirrored : {true, false})
            for (const double left : {1e-4, 0.01, 0.05, 0.2}) {
                out.push_back({shadows, mirrored, left, 0, 1, 0, true});
                if (!wavy)
                    continue;
                out.push_back({shadows, mirrored, left, 0, 1, 0, false});
                for (const auto& [texels, photons] :
                     {std::pair{512, 2}, {512, 1}, {256, 1}, {128, 1}, {64, 1}})
                    for (const int shafts : {16, 4, 0})
                        out.push_back({shadows, mirrored, left, texels, photons, shafts, false});
            }
    return out;
}

int run(int argc, char** argv) {
    int views = 10, width = 960, height = 540, seed = 8;
    std::string json;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (i + 1 >= argc)
            throw Error(word + " needs a value");
        const std::string value = argv[++i];
        if (word == "--views")
            views = std::max(1, std::atoi(value.c_str()));
        else if (word == "--size") {
            if (std::sscanf(value.c_str(), "%dx%d", &width, &height) != 2)
                throw Error("--size '" + value + "' is not understood");
        } else if (word == "--seed")
            seed = std::atoi(value.c_str());
        else if (word == "--json")
            json = value;
        else
            throw Error("unknown option " + word);
    }
    const gpu::Context context;
    std::cout << "device: " << context.renderer() << ", " << width << "x" << height << "\n"
              << "| scene | views | within budget | worst, of the budget | mean used | speed-up | "
                 "time of the best fixed setting in that view | of the best one for all |\n"
              << "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
    std::vector<Lake> lakes;
    lakes.push_back({"bowl, calm", scene::bowl(513), 0.0});
    lakes.push_back({"mountain 1024, calm", scene::mountain_lake(1024), 0.0});
    lakes.push_back({"bowl, wind 3 m/s", scene::bowl(513), 3.0});
    lakes.push_back({"mountain 1024, wind 6 m/s", scene::mountain_lake(1024), 6.0});
    lakes.push_back({"mountain 4096, wind 10 m/s", scene::mountain_lake(4096), 10.0});
    // Green and turbid, as lowland lakes are.
    lakes[3].scene.optics.absorption_per_m = {0.45, 0.25, 0.6};
    lakes[3].scene.optics.backscattering_per_m = {0.03, 0.032, 0.034};
    lakes[3].scene.optics.bands.clear();
    std::string rows;
    int all = 0, all_within = 0, all_quick = 0;
    double all_worst = 0.0, log_speed = 0.0;
    std::mt19937 random{unsigned(seed)};
    for (const Lake& lake : lakes) {
        render::Renderer renderer(lake.scene);
        const std::vector<Fixed> grid = grid_of(lake.wind_m_per_s > 0.0);
        const double budgets[] = {0.005, 0.01, 0.02, 0.05};
        struct View {
            double budget, error, ms, best_ms, fixed_ms;
            std::vector<double> grid_ms, grid_error;
        };
        std::vector<View> found;
        double used = 0.0, worst = 0.0, log_sum = 0.0;
        int within = 0;
        for (int k = 0; k < views; ++k) {
            scene::View view;
            view.camera = random_camera(lake.scene, random);
            view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(0.5, -0.4, 0.75)));
            view.settings = {.width_px = width, .height_px = height, .samples = 1};
            if (lake.wind_m_per_s > 0.0) {
                view.waves.model = waves::Model::jonswap;
                view.waves.wind_m_per_s = lake.wind_m_per_s;
                if (gpu::is_software())
                    view.waves.texels = 128;
            }
            View v{.budget = budgets[k % 4],
                   .error = 0,
                   .ms = 0,
                   .best_ms = 0,
                   .fixed_ms = 1e300,
                   .grid_ms = {},
                   .grid_error = {}};
            const scene::View everything = scene::at_its_best(view);
            const render::Plan plan =
                render::make_plan(renderer, lake.scene, view, {.max_error = v.budget}, {});
            const auto time = [&](const scene::View& drawn, Image& image) {
                image = renderer.draw(drawn);
                double ms = 1e300;
                for (int i = 0; i < 3; ++i) {
                    const auto start = std::chrono::steady_clock::now();
                    renderer.move_waves(drawn.waves.time_s);
                    renderer.draw_once();
                    glFinish();
                    ms = std::min(ms, std::chrono::duration<double, std::milli>(
                                          std::chrono::steady_clock::now() - start)
                                          .count());
                }
                return ms;
            };
            Image best, got;
            v.best_ms = time(everything, best);
            v.ms = time(plan.view, got);
            v.error = image::compare(got, best).mean_relative;
            for (const Fixed& fixed : grid) {
                const double ms = time(fixed.applied(everything), got);
                const double error = image::compare(got, best).mean_relative;
                v.grid_ms.push_back(ms);
                v.grid_error.push_back(error);
                if (error <= v.budget)
                    v.fixed_ms = std::min(v.fixed_ms, ms);
            }
            v.fixed_ms = std::min(v.fixed_ms, v.best_ms);
            within += v.error <= v.budget;
            worst = std::max(worst, v.error / v.budget);
            used += v.error / v.budget / views;
            log_sum += std::log(v.best_ms / v.ms) / views;
            all_quick += v.ms <= 1.25 * v.fixed_ms;
            if (v.ms > 1.25 * v.fixed_ms)
                for (const render::Decision& d : plan.decisions)
                    std::printf("    slow: %s %s %s error %.4f of %.4f saves %.3f of %.3f ms\n",
                                d.taken ? "takes" : "not", d.part.c_str(), d.choice.c_str(),
                                d.error, v.budget, d.saved_ms, plan.everything_ms);
            rows += text(rows.empty() ? "" : ",\n", "{\"scene\": \"", lake.name,
                         "\", \"budget\": ", v.budget, ", \"predicted\": ", plan.predicted_error,
                         ", \"error\": ", v.error, ", \"ms\": ", v.ms,
                         ", \"everything_ms\": ", v.best_ms, ", \"best_fixed_ms\": ", v.fixed_ms,
                         ", \"trials\": ", plan.trials, ", \"planning_s\": ", plan.planning_s, "}");
            found.push_back(std::move(v));
        }
        // The one fixed setting that keeps the budget in all views at the least time.
        double planned = 0.0, one = 0.0, in_view = 0.0;
        for (const View& v : found) {
            planned += v.ms;
            in_view += v.fixed_ms;
            one += v.best_ms;
        }
        for (std::size_t g = 0; g < grid.size(); ++g) {
            double sum = 0.0;
            bool keeps = true;
            for (const View& v : found) {
                sum += v.grid_ms[g];
                keeps = keeps && v.grid_error[g] <= v.budget;
            }
            if (keeps)
                one = std::min(one, sum);
        }
        std::printf("| %s | %d | %d | %.2f | %.2f | %.2f | %.2f | %.2f |\n", lake.name, views,
                    within, worst, used, std::exp(log_sum), planned / in_view, planned / one);
        std::fflush(stdout);
        all += views;
        all_within += within;
        all_worst = std::max(all_worst, worst);
        log_speed += log_sum * views;
    }
    std::printf(
        "all: %d of %d within the budget (%.1f %%), worst %.2f of it; %.2f times as quick as "
        "everything on; %d of %d at most 1.25 times the best fixed setting of their view\n",
        all_within, all, 100.0 * all_within / all, all_worst, std::exp(log_speed / all), all_quick,
        all);
    if (!json.empty())
        std::ofstream(json) << "{\"device\": \"" << context.renderer() << "\", \"results\": [\n"
                            << rows << "\n]}\n";
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& e) {
        std::cerr << e.what() << "\n";
        return 1;
    }
}
