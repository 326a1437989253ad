// tarn_intersection_bench — first hits by every method on synthetic lakes: time, and error against
// the double-precision grid walk. As `tarn bench --intersection`, but made of what draws alone:
// needs OpenGL 4.5 and EGL, no GDAL and no OpenImageIO, so it runs on a bare GPU machine.
//
//   tarn_intersection_bench [--side N,N,...] [--size WxH,WxH,...] [--view NAME,...]
//                           [--method NAME,...] [--runs N] [--judged N] [--settings one|all]
//                           [--json FILE]
#include "bench/intersection.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "scene/samples.hpp"
#include "support/words.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>

namespace {

using namespace tarn;

using test_support::split;

int run(int argc, char** argv) {
    std::string sides = "1024,4096", sizes = "1920x1080", views = "high,grazing,shore,below", json;
    bench::IntersectionOptions options;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (i + 1 >= argc)
            throw Error(word + " needs a value");
        const std::string value = argv[++i];
        if (word == "--side")
            sides = value;
        else if (word == "--size")
            sizes = value;
        else if (word == "--view")
            views = value;
        else if (word == "--method")
            options.methods = split(value);
        else if (word == "--runs")
            options.runs = std::max(1, std::atoi(value.c_str()));
        else if (word == "--judged")
            options.judged_rays = std::max(1, std::atoi(value.c_str()));
        else if (word == "--settings")
            options.all_settings = value == "all";
        else if (word == "--cone-shift")
            options.cone_shift = std::atoi(value.c_str());
        else if (word == "--in-step")
            options.rays_in_step = value == "1";
        else if (word == "--json")
            json = value;
        else
            throw Error("unknown option " + word);
    }
    for (const std::string& size : split(sizes)) {
        bench::PictureSize s;
        if (std::sscanf(size.c_str(), "%dx%d", &s.width_px, &s.height_px) != 2)
            throw Error("--size '" + size + "' is not understood");
        options.sizes.push_back(s);
    }
    const gpu::Context context;
    std::cout << "device: " << context.renderer() << ", OpenGL " << context.version() << "\n";
    std::vector<bench::NamedView> chosen;
    for (const bench::NamedView& view : bench::mountain_views()) {
        const auto names = split(views);
        if (std::find(names.begin(), names.end(), view.name) != names.end())
            chosen.push_back(view);
    }
    std::vector<bench::IntersectionResult> results;
    for (const std::string& side : split(sides)) {
        const scene::Scene scene = scene::mountain_lake(std::atoi(side.c_str()));
        for (const auto& r :
             bench::compare_methods(scene, "mountain lake " + side, chosen, options, {})) {
            std::printf("%6d^2 %-8s %4dx%-4d %-16s %6g  %9.4f ms (%.4f to %.4f) %7.2f M rays/s  "
                        "missed %.2e wrong %.2e  set-up %.0f ms, %.0f MB\n",
                        r.nodes, r.view.c_str(), r.width_px, r.height_px, r.method.c_str(),
                        r.setting, r.time.median_ms, r.time.low_ms, r.time.high_ms,
                        double(r.width_px) * r.height_px / r.time.median_ms * 1e-3, r.missed_rate,
                        r.wrong_rate, r.set_up_ms, r.field_mb);
            std::fflush(stdout);
            results.push_back(r);
        }
    }
    if (!json.empty()) {
        std::ofstream out(json);
        bench::write_json(out, context.renderer(), TARN_COMMIT, results);
    }
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::cerr << "tarn_intersection_bench: " << error.what() << "\n";
        return 1;
    }
}
