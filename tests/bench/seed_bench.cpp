// tarn_seed_bench — Table 1 of Baboud & Decoret, "Realistic Water Volumes in Real-Time" (2006),
// with tarn: frames a second at 800 x 600 by how much of the picture is water, and by what is drawn
// of it. Made of what draws alone.
//
//   tarn_seed_bench [--wind M/S] [--side N] [--frames N]
#include "bench/seed_table.hpp"
#include "core/error.hpp"
#include "gpu/context.hpp"
#include "scene/samples.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>

namespace {

using namespace tarn;

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
    std::printf(
        "%s, %d^2, 800 x 600, wind %.0f m/s; frames a second (ms)\n| water in the picture |",
        context.renderer().c_str(), side, wind);
    for (const std::string& mode : bench::seed_table_modes)
        std::printf(" %s |", mode.c_str());
    std::printf("\n| --- | --- | --- | --- | --- | --- |\n");
    for (const bench::SeedRow& row : bench::measure_seed_table(scene, wind, frames, {})) {
        std::printf("| %.0f %% |", 100.0 * row.water_share);
        for (const bench::Times& t : row.times)
            std::printf(" %.0f (%.3f) |", 1000.0 / t.median_ms, t.median_ms);
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
