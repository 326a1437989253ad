// `tarn render` — one picture, no display needed.
#include "app/command.hpp"
#include "app/console.hpp"
#include "app/picture.hpp"
#include "app/report.hpp"
#include "app/view_options.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "image/compare.hpp"
#include "image/files.hpp"
#include "reference/tracer.hpp"
#include "render/renderer.hpp"
#include "scene_files/scene_folder.hpp"

#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <spdlog/spdlog.h>

namespace tarn::app {

namespace {

struct Words {
    ViewWords view;
    PictureWords picture;
    std::string scene, against;
    std::vector<std::string> outputs;
    bool reference = false;
};

int run_render(Words& words, const scene_files::OptionList& options) {
    check_outputs(words.outputs);
    if (!words.against.empty() && !std::filesystem::exists(words.against))
        throw Error("--against " + words.against + ": no such file",
                    "render it first, with --reference");
    scene::Scene scene = load_scene(words.scene, words.view);
    const scene::View view = make_view(words.view, scene);
    if (view.settings.walk == scene::Walk::safety_exact ||
        view.settings.walk == scene::Walk::safety_radius)
        scene.safety_radii = scene_files::load_safety_radii(words.scene, scene);
    const Progress progress = console_progress();
    Image picture;
    std::string device;
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&start] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    double setup_s = 0.0;
    if (words.reference) {
        device = "reference (double precision, CPU)";
        picture = reference::trace(scene, view, progress);
    } else {
        const gpu::Context context;
        device = context.renderer();
        render::Renderer renderer(scene);
        setup_s = seconds();
        picture = renderer.draw(view, [&](double share) { progress.report(share, "rendering"); });
        end_progress();
        for (const std::string& note : renderer.wave_notes())
            spdlog::info("waves: {}", note);
    }
    const double total_s = seconds();
    end_progress();
    for (const std::string& output : words.outputs) {
        write_picture(output, words.picture, picture, scene, view,
                      {.scene = words.scene,
                       .options = options,
                       .command = command_line(),
                       .device = device,
                       .time = describe_time(words.view, scene),
                       .exposure = {},
                       .more = {}});
        std::cout << "wrote " << output << " (" << picture.width_px << " x " << picture.height_px
                  << ", " << view.settings.samples
                  << (view.settings.samples == 1 ? " sample" : " samples") << ", "
                  << fixed(total_s - setup_s, 2) << " s after " << fixed(setup_s, 2)
                  << " s of set-up, " << device << ")\n";
    }
    if (!words.against.empty()) {
        const Image other = image::read_exr(words.against);
        const image::Difference d = image::compare(picture, other);
        const image::DistanceDifference z =
            image::compare_distances(picture, other, scene.ground.scale_m, 1e-5);
        std::cout << "against " << words.against << ": relative radiance error mean "
                  << fixed(100 * d.mean_relative, 4) << " %, 95th "
                  << fixed(100 * d.p95_relative, 4) << " %, 99th percentile "
                  << fixed(100 * d.p99_relative, 4) << " %, PSNR " << fixed(d.psnr_db, 1)
                  << " dB\n  first hits: " << z.different << " of " << z.pixels - z.edges
                  << " pixels off by more than max(" << fixed(1000 * scene.ground.scale_m, 2)
                  << " mm, 1e-5 of the distance), " << z.edges << " edge pixels not judged\n";
    }
    return 0;
}

} // namespace

void add_render(CLI::App& app, Run& run) {
    auto words = std::make_shared<Words>();
    CLI::App* c =
        app.add_subcommand("render", "one picture of a scene (.png, .exr), no display needed");
    c->add_option("SCENE", words->scene, "scene folder")->required();
    c->add_option("-o,--output", words->outputs,
                  "picture to write; .png for the eye, .exr linear with distances [m] in channel "
                  "Z; may be repeated")
        ->required();
    add_view_options(*c, words->view);
    add_picture_options(*c, words->picture);
    c->add_flag("--reference", words->reference,
                "by the double-precision CPU tracer: slow, needs no GPU");
    c->add_option("--against", words->against, "print how far the picture is from this .exr");
    c->footer(
        "Examples:\n"
        "  tarn render rotoma -o rotoma.png\n"
        "  tarn render rotoma --camera dive --time 2026-01-15T12:00+13:00 -o dive.png\n"
        "  tarn render rotoma --camera lat=-38.05,lon=176.58,above_water=30,heading=40,pitch=-10 "
        "-o a.png\n"
        "  tarn render tank --ground-albedo 0.5 --sky-radiance 0 --sun-direction 1,0,1 \\\n"
        "      --sun-irradiance 3.14159 --absorption-per-m 0 --backscattering-per-m 0 -o tank.exr");
    c->callback([words, c, &run] {
        run = [words, c] {
            apply_settings_file(*c, words->view);
            return run_render(*words, given_options(*c));
        };
    });
}

} // namespace tarn::app
