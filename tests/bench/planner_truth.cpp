// tarn_planner_truth - planned pictures against the double-precision tracer: random views of five
// lakes, budgets in turn. In calm water pixel by pixel at the same sample positions; in moving
// water, where both draw at random what a pixel cannot resolve, in means over blocks of 8 x 8
// pixels, without the sun's disc (whose mirror images the tracer finds by chance alone). Results:
// docs/planner.md.
//
//   tarn_planner_truth [--views N] [--size WxH] [--samples N] [--seed N] [--wind 0|1]
#include "bench/matrix.hpp"
#include "bench/program.hpp"
#include "bench/random_views.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "image/compare.hpp"
#include "reference/tracer.hpp"
#include "render/planner.hpp"

#include <algorithm>
#include <cstdio>
#include <iostream>

namespace {

using namespace tarn;

int run(const bench::Words& words) {
    const int views = words.count("--views", 10), samples = words.count("--samples", 16),
              seed = words.count("--seed", 8);
    const auto [width, height] = bench::parse_size(words.text("--size", "320x180"));
    const bool wind = words.text("--wind") != "0";
    const gpu::Context context;
    std::cout
        << "device: " << context.renderer() << ", " << width << "x" << height << ", " << samples
        << " samples in moving water, 1 in calm\n"
        << "| scene | view | budget | best from the reference | planned from the best | planned "
           "from the reference | of the budget |\n| --- | --- | --- | --- | --- | --- | --- |\n";
    std::mt19937 random{unsigned(seed)};
    int all = 0, within = 0, within_twice = 0, within_beside = 0;
    double worst = 0.0;
    for (const bench::Lake& lake : bench::five_lakes()) {
        const bool wavy = lake.wind_m_per_s > 0.0;
        render::Renderer renderer(lake.scene);
        for (int k = 0; k < views; ++k) {
            scene::View view = bench::random_view(lake, random);
            if (wavy && !wind)
                continue;
            view.settings.width_px = width;
            view.settings.height_px = height;
            view.settings.samples = wavy ? samples : 1;
            if (wavy)
                view.lighting.sun_disc = false;
            const double budget = bench::budgets_in_turn[k % 4];
            const scene::View everything = scene::at_its_best(view);
            const render::Plan plan =
                render::make_plan(renderer, lake.scene, view, {.max_error = budget}, {});
            const Image truth = reference::trace(lake.scene, everything, {}),
                        best = renderer.draw(everything), planned = renderer.draw(plan.view);
            const auto error = [&](const Image& a, const Image& b) {
                return wavy ? image::compare(bench::in_blocks(a, 8), bench::in_blocks(b, 8))
                                  .mean_relative
                            : image::compare(a, b).mean_relative;
            };
            const double e = error(planned, truth), at_best = error(best, truth);
            std::printf("| %s | %d | %.1f %% | %.3f %% | %.3f %% | %.3f %% | %.2f |\n", lake.name,
                        k + 1, 100 * budget, 100 * at_best, 100 * error(planned, best), 100 * e,
                        e / budget);
            std::fflush(stdout);
            ++all;
            within += e <= budget;
            within_twice += e <= 2.0 * budget;
            within_beside += e - at_best <= budget;
            worst = std::max(worst, e / budget);
        }
    }
    std::printf(
        "all: %d of %d within the budget of the reference, %d within twice, worst %.2f of it; "
        "%d within it beside what the best is off\n",
        within, all, within_twice, worst, within_beside);
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    return tarn::bench::program(argc, argv, {"--views", "--size", "--samples", "--seed", "--wind"},
                                run);
}
