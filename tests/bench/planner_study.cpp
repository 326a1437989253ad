// tarn_planner_study - does the planner keep its budgets, and is it as quick as the best fixed
// setting? Random views of five lakes made of formulas, budgets in turn; each plan is held against
// everything at its best, pixel by pixel, and its time against every fixed setting of a grid that
// keeps the budget there. Made of what draws alone. Results: docs/planner.md.
//
//   tarn_planner_study [--views N] [--size WxH] [--seed N] [--json FILE]
#include "bench/program.hpp"
#include "bench/random_views.hpp"
#include "bench/timing.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "image/compare.hpp"
#include "render/planner.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>

namespace {

using namespace tarn;

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

int run(const bench::Words& words) {
    const int views = words.count("--views", 10), seed = words.count("--seed", 8);
    const auto [width, height] = bench::parse_size(words.text("--size", "960x540"));
    const std::string json = words.text("--json");
    const gpu::Context context;
    std::cout << "device: " << context.renderer() << ", " << width << "x" << height << "\n"
              << "| scene | views | within budget | worst, of the budget | mean used | speed-up | "
                 "time of the best fixed setting in that view | of the best one for all |\n"
              << "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
    const std::vector<bench::Lake> lakes = bench::five_lakes();
    std::string rows;
    int all = 0, all_within = 0, all_quick = 0;
    double all_worst = 0.0, log_speed = 0.0;
    std::mt19937 random{unsigned(seed)};
    for (const bench::Lake& lake : lakes) {
        render::Renderer renderer(lake.scene);
        const std::vector<Fixed> grid = grid_of(lake.wind_m_per_s > 0.0);
        struct View {
            double budget, error, ms, best_ms, fixed_ms;
            std::vector<double> grid_ms, grid_error;
        };
        std::vector<View> found;
        double used = 0.0, worst = 0.0, log_sum = 0.0;
        int within = 0;
        for (int k = 0; k < views; ++k) {
            scene::View view = bench::random_view(lake, random);
            view.settings = {.width_px = width, .height_px = height, .samples = 1};
            View v{.budget = bench::budgets_in_turn[k % 4],
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
    return tarn::bench::program(argc, argv, {"--views", "--size", "--seed", "--json"}, run);
}
