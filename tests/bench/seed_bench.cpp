// tarn_seed_bench — Table 1 of Baboud & Decoret, "Realistic Water Volumes in Real-Time" (2006),
// with tarn: frames a second at 800 x 600 by how much of the picture is water, and by what is drawn
// of it. Made of what draws alone.
//
//   tarn_seed_bench [--wind M/S] [--side N] [--frames N]
#include "bench/timing.hpp"
#include "core/error.hpp"
#include "gpu/context.hpp"
#include "render/renderer.hpp"
#include "scene/samples.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <glm/geometric.hpp>
#include <iostream>
#include <string>

namespace {

using namespace tarn;

/// Share of the picture whose first hit is water.
double coverage(render::Renderer& renderer, const scene::View& view) {
    renderer.prepare(view);
    renderer.find_first_hits();
    double wet = 0.0;
    const std::vector<float> hits = renderer.read_first_hits();
    for (const float d : hits)
        wet += d < 0.0f;
    return wet / double(hits.size());
}

int run(int argc, char** argv) {
    double wind = 6.0;
    int side = 1024, frames = 31;
    for (int i = 1; i + 1 < argc; i += 2) {
        if (!std::strcmp(argv[i], "--wind"))
            wind = std::atof(argv[i + 1]);
        else if (!std::strcmp(argv[i], "--side"))
            side = std::atoi(argv[i + 1]);
        else if (!std::strcmp(argv[i], "--frames"))
            frames = std::atoi(argv[i + 1]);
        else
            throw Error(std::string("unknown option ") + argv[i]);
    }
    const gpu::Context context;
    const scene::Scene scene = scene::mountain_lake(side);
    render::Renderer renderer(scene);
    const double level = scene.lakes.front().level_m;
    scene::View view;
    view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(0.5, -0.4, 0.75)));
    view.settings = {.width_px = 800, .height_px = 600, .samples = 1};
    if (wind > 0.0) {
        view.waves.model = waves::Model::jonswap;
        view.waves.wind_m_per_s = wind;
    }
    struct Mode {
        const char* name;
        bool reflection, caustics;
        int shafts;
        bool shadows;
    };
    const Mode modes[] = {{"refraction", false, false, 0, false},
                          {"+ reflection of land and sky", true, false, 0, false},
                          {"+ caustics", true, true, 0, false},
                          {"+ shafts of light", true, true, 2, false},
                          {"+ shadows", true, true, 2, true}};
    std::printf("%s, %d^2, 800 x 600, wind %.0f m/s; frames a second (ms)\n",
                context.renderer().c_str(), side, wind);
    std::printf("| water in the picture |");
    for (const Mode& mode : modes)
        std::printf(" %s |", mode.name);
    std::printf("\n| --- | --- | --- | --- | --- | --- |\n");
    for (const double wanted : {1.0, 0.5, 0.25}) {
        // From over the middle of the lake the view is lifted from straight down to the sky.
        double low = -89.0, high = 40.0;
        double share = 1.0;
        for (int i = 0; i < 24; ++i) {
            const double pitch = wanted == 1.0 ? -60.0 : 0.5 * (low + high);
            view.camera = scene::look({-400, -1500, level + 60.0}, 5.0, pitch, 45.0);
            share = coverage(renderer, view);
            (share > wanted ? low : high) = pitch;
        }
        std::printf("| %.0f %% |", 100.0 * share);
        for (const Mode& mode : modes) {
            scene::View drawn = view;
            drawn.settings.reflection = mode.reflection;
            drawn.settings.caustics = mode.caustics ? scene::Caustics::splat : scene::Caustics::off;
            drawn.settings.shaft_steps = mode.shafts;
            drawn.settings.shadows = mode.shadows;
            renderer.prepare(drawn);
            double time_s = 0.0;
            const bench::Times t = bench::time_on_gpu(
                [&] {
                    renderer.move_waves(time_s += 1.0 / 60.0);
                    renderer.draw_once();
                },
                frames);
            std::printf(" %.0f (%.3f) |", 1000.0 / t.median_ms, t.median_ms);
            std::fflush(stdout);
        }
        std::printf("\n");
    }
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
