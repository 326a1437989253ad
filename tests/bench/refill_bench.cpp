// How long it takes to move a lake's level: tarn_refill_bench [SIDE]
#include "core/text.hpp"
#include "dem/refill.hpp"
#include "scene/samples.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <thread>

namespace {

double ms(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
}

} // namespace

int main(int argc, char** argv) {
    using namespace tarn;
    const int side = argc > 1 ? std::atoi(argv[1]) : 4096;
    scene::Scene scene = scene::mountain_lake(side);
    Grid<float> heights(scene.ground.size());
    for (std::size_t i = 0; i < heights.values.size(); ++i)
        heights.values[i] =
            float(scene.ground.offset_m + scene.ground.scale_m * scene.ground.codes.values[i]);
    std::unique_ptr<dem::Refill> refill;
    const double start_ms = ms([&] {
        refill =
            std::make_unique<dem::Refill>(std::move(heights), scene.ground, scene.water,
                                          scene.frame, scene.lakes, scene.lakes[0].id, Progress{});
    });
    std::vector<double> figures, fills, shores;
    const double base = refill->lake().level_m;
    std::cout << "field " << side << " x " << side << ", " << std::thread::hardware_concurrency()
              << " threads; lake " << fixed(scene.lakes[0].area_m2 / 1e6, 2) << " km2, level "
              << base << " m, may move from " << fixed(refill->lowest_m(), 2) << " to "
              << fixed(refill->highest_m(), 2) << " m\n";
    for (int i = 0; i < 21; ++i) {
        const double level = base - 20.0 + 2.0 * i;
        figures.push_back(ms([&] { refill->figures(level); }));
        fills.push_back(
            ms([&] { refill->fill(level, scene.ground, scene.water, scene.lakes, false); }));
        if (i % 5 == 0)
            shores.push_back(
                ms([&] { refill->fill(level, scene.ground, scene.water, scene.lakes, true); }));
    }
    const double curve_ms = ms([&] { refill->curve(200, base + 100.0); });
    std::cout << "| step | median [ms] |\n| --- | --- |\n"
              << "| getting ready (once a scene, in the background) | " << fixed(start_ms, 0)
              << " |\n| area and volume at a level | " << fixed(median(figures), 2)
              << " |\n| refill | " << fixed(median(fills), 1)
              << " |\n| refill with shoreline and islands | " << fixed(median(shores), 0)
              << " |\n| plot of 200 levels | " << fixed(curve_ms, 1) << " |\n";
}
