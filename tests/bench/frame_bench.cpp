// tarn_frame_bench — GPU time of whole calm frames of synthetic lakes. Made of what draws alone:
// needs OpenGL 4.5 and EGL, no GDAL and no OpenImageIO, so it runs on a bare GPU machine.
//
//   tarn_frame_bench [--side N,N,...] [--size WxH,WxH,...] [--view high,shore,dive]
//                    [--intersection METHOD] [--wind M/S] [--caustics METHOD] [--caustic-texels N]
//                    [--caustic-photons N]
//                    [--shaft-steps N] [--map 1] [--drag N] [--frames N] [--json FILE] [--ppm
//                    PREFIX] [--lines N] [--port M] [--dive-light CD] [--prisms N] [--glow 0|1]
//                    [--water TYPE]
// --view split: at the water's surface. --lines: random ones in space, some pixels wide.
#include "bench/timing.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "render/renderer.hpp"
#include "scene/presets.hpp"
#include "scene/samples.hpp"
#include "scene/water_types.hpp"
#include "support/words.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <glm/geometric.hpp>
#include <iostream>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace tarn;

using test_support::split;

scene::Camera camera_for(const std::string& view, double level_m) {
    if (view == "split")
        return scene::look({600, -1500, level_m + 0.01}, 200.0, -4.0, 75.0);
    if (view == "high")
        return scene::look({-900, -6500, 3300}, 8.0, -22.0, 45.0);
    if (view == "shore")
        return scene::look({-400, -2300, 952}, 5.0, -4.0, 55.0);
    return scene::look({600, -1500, 918}, 200.0, 6.0, 75.0); // dive
}

/// Lines of ten metres to a kilometre, anywhere over and in the lake.
std::vector<scene::SpaceStroke> random_strokes(const scene::Scene& scene, int count) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> even(-1.0, 1.0);
    std::vector<scene::SpaceStroke> out;
    const double level = scene.lakes.front().level_m;
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 from(4000.0 * even(random), 4000.0 * even(random),
                              level + 60.0 * even(random));
        const double size = std::pow(10.0, 2.0 + even(random));
        out.push_back(
            {from, from + size * glm::dvec3(even(random), even(random), 0.2 * even(random))});
    }
    return out;
}

void write_ppm(const std::string& path, const Image& image) {
    std::ofstream out(path, std::ios::binary);
    out << "P6\n" << image.width_px << " " << image.height_px << "\n255\n";
    for (const glm::vec3& c : image.radiance)
        for (int k = 0; k < 3; ++k) {
            const double p = std::pow(std::max(0.0, 1.6 * double(c[k])), 1.3);
            out.put(char(std::lround(255.0 * std::pow(p / (p + 0.49), 1.0 / 2.2))));
        }
}

int run(int argc, char** argv) {
    bool map = false;
    int drag = 0;
    std::string sides = "1024,4096", sizes = "800x600,1920x1080,3840x2160",
                views = "high,shore,dive";
    std::string json_path, ppm, method = scene::walk_methods().front().name;
    int frames = 41;
    double wind = 0.0; // m/s; 0: calm
    std::string caustics = "splat";
    int lines = 0;
    double port_m = 0.0, dive_light_cd = 0.0;
    int caustic_texels = 0, caustic_photons = 1, shaft_steps = 2, prisms = 0;
    bool glow = true;
    std::string water;
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
        else if (word == "--intersection")
            method = value;
        else if (word == "--caustics")
            caustics = value;
        else if (word == "--caustic-texels")
            caustic_texels = std::atoi(value.c_str());
        else if (word == "--caustic-photons")
            caustic_photons = std::atoi(value.c_str());
        else if (word == "--water")
            water = value;
        else if (word == "--prisms")
            prisms = std::atoi(value.c_str());
        else if (word == "--glow")
            glow = std::atoi(value.c_str()) != 0;
        else if (word == "--shaft-steps")
            shaft_steps = std::atoi(value.c_str());
        else if (word == "--wind")
            wind = std::atof(value.c_str());
        else if (word == "--frames")
            frames = std::max(1, std::atoi(value.c_str()));
        else if (word == "--lines")
            lines = std::max(0, std::atoi(value.c_str()));
        else if (word == "--port")
            port_m = std::atof(value.c_str());
        else if (word == "--dive-light")
            dive_light_cd = std::atof(value.c_str());
        else if (word == "--map")
            map = std::atoi(value.c_str()) != 0;
        else if (word == "--drag")
            drag = std::max(0, std::atoi(value.c_str()));
        else if (word == "--json")
            json_path = value;
        else if (word == "--ppm")
            ppm = value;
        else
            throw Error("unknown option " + word);
    }
    const gpu::Context context;
    std::cout << "device: " << context.renderer() << ", OpenGL " << context.version() << "\n";
    std::string json = "{\"device\": \"" + context.renderer() + "\", \"results\": [";
    bool first = true;
    for (const std::string& side : split(sides)) {
        scene::Scene scene = scene::mountain_lake(std::atoi(side.c_str()));
        if (!water.empty())
            scene.optics = scene::water_type(water);
        scene.space_strokes = random_strokes(scene, lines);
        const double level_m = scene.lakes.front().level_m;
        const auto load = std::chrono::steady_clock::now();
        render::Renderer renderer(scene);
        glFinish();
        const double load_ms =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - load)
                .count();
        std::printf("field %s^2: upload, maxima and shaders %.0f ms\n", side.c_str(), load_ms);
        for (const std::string& name : split(views))
            for (const std::string& size : split(sizes)) {
                int w = 0, h = 0;
                if (std::sscanf(size.c_str(), "%dx%d", &w, &h) != 2)
                    throw Error("--size '" + size + "' is not understood");
                struct Mode {
                    const char* name;
                    bool shadows, split;
                };
                for (const Mode mode : {Mode{"all", true, true}, Mode{"no shadows", false, true},
                                        Mode{"primary rays", false, false}}) {
                    scene::View view;
                    view.camera = camera_for(name, level_m);
                    view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(0.5, -0.4, 0.75)));
                    view.settings = {.width_px = w,
                                     .height_px = h,
                                     .samples = 1,
                                     .shadows = mode.shadows,
                                     .reflection = mode.split,
                                     .refraction = mode.split};
                    if (!mode.split)
                        view.settings.ground_albedo = 0.2; // the walk alone, without colours
                    for (const scene::WalkMethod& m : scene::walk_methods())
                        if (method == m.name)
                            view.settings.walk = m.walk;
                    view.settings.port_m = port_m;
                    view.settings.dive_light_cd = dive_light_cd;
                    view.settings.caustic_texels = caustic_texels;
                    view.settings.caustic_photons = caustic_photons;
                    view.settings.shaft_steps = shaft_steps;
                    view.settings.forward_glow = glow;
                    if (prisms > 0) {
                        view.settings.shafts = scene::Shafts::prisms;
                        view.settings.shaft_prisms = prisms;
                    }
                    for (const scene::CausticsMethod& m : scene::caustics_methods())
                        if (caustics == m.name)
                            view.settings.caustics = m.caustics;
                    if (wind > 0.0) {
                        view.waves.model = waves::Model::jonswap;
                        view.waves.wind_m_per_s = wind;
                    }
                    if (map) {
                        view.settings.contours_m = 20.0;
                        view.settings.depth_contours_m = 5.0;
                    }
                    renderer.prepare(view);
                    double time_s = 0.0;
                    const bench::Times t = bench::time_on_gpu(
                        [&] {
                            renderer.move_waves(time_s += 1.0 / 60.0); // nothing where it is calm
                            renderer.draw_once();
                        },
                        frames);
                    std::printf(
                        "%6s^2  %-5s  %-9s  %-12s  %9.3f ms  (quartiles %.3f to %.3f, %s)\n",
                        side.c_str(), name.c_str(), size.c_str(), mode.name, t.median_ms, t.low_ms,
                        t.high_ms, t.clock);
                    json += text(
                        first ? "\n" : ",\n", "{\"wind_m_per_s\": ", wind, ", \"caustics\": \"",
                        wind > 0.0 ? caustics : "off", "\", \"caustic_texels\": ", caustic_texels,
                        ", \"caustic_photons\": ", caustic_photons,
                        ", \"shaft_steps\": ", wind > 0.0 ? shaft_steps : 0, ", \"field\": ", side,
                        ", \"intersection\": \"", method, "\", \"view\": \"", name,
                        "\", \"width\": ", w, ", \"height\": ", h, ", \"mode\": \"", mode.name,
                        "\", \"median_ms\": ", t.median_ms, ", \"q1_ms\": ", t.low_ms,
                        ", \"q3_ms\": ", t.high_ms, ", \"clock\": \"", t.clock, "\"}");
                    first = false;
                    if (mode.split && mode.shadows) {
                        const auto parts = bench::time_parts(
                            [&](const std::function<void(const char*)>& begins) {
                                renderer.on_pass = begins;
                                renderer.move_waves(time_s += 1.0 / 60.0);
                                renderer.draw_once();
                                renderer.on_pass = {};
                            },
                            frames);
                        std::printf("              ");
                        for (const bench::PartTime& part : parts)
                            std::printf(" %s %.3f", part.name.c_str(), part.median_ms);
                        std::printf("\n");
                    }
                    if (mode.split && mode.shadows && size == split(sizes).front()) {
                        const Image image = renderer.draw(view);
                        glm::dvec3 sum(0.0);
                        for (const glm::vec3& c : image.radiance)
                            sum += glm::dvec3(c) / double(image.radiance.size());
                        std::printf("               mean radiance %.6f %.6f %.6f\n", sum.r, sum.g,
                                    sum.b);
                        if (!ppm.empty())
                            write_ppm(ppm + "_" + side + "_" + name + ".ppm", image);
                    }
                }
            }
        // A level that somebody drags: heights go up again, maxima are made anew, a picture is
        // drawn.
        if (drag > 0) {
            scene::View view;
            view.camera = camera_for("high", level_m);
            view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(0.5, -0.4, 0.75)));
            view.settings = {.width_px = 1920, .height_px = 1080, .samples = 1};
            view.settings.walk = scene::Walk::maximum_mipmap;
            std::vector<double> upload_ms, picture_ms;
            for (int i = 0; i < drag; ++i) {
                const auto start = std::chrono::steady_clock::now();
                renderer.scene_changed(false);
                glFinish();
                const auto uploaded = std::chrono::steady_clock::now();
                renderer.prepare(view);
                renderer.draw_once();
                glFinish();
                const auto drawn = std::chrono::steady_clock::now();
                upload_ms.push_back(
                    std::chrono::duration<double, std::milli>(uploaded - start).count());
                picture_ms.push_back(
                    std::chrono::duration<double, std::milli>(drawn - uploaded).count());
            }
            std::sort(upload_ms.begin(), upload_ms.end());
            std::sort(picture_ms.begin(), picture_ms.end());
            std::printf(
                "%6s^2  level dragged: %.1f ms to the GPU, %.1f ms for maxima and picture\n",
                side.c_str(), upload_ms[upload_ms.size() / 2], picture_ms[picture_ms.size() / 2]);
        }
    }
    json += "\n]}\n";
    if (!json_path.empty())
        std::ofstream(json_path) << json;
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::cerr << "tarn_frame_bench: " << error.what() << "\n";
        return 1;
    }
}
