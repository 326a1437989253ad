// `tarn render` — one picture, no display needed.
#include "app/command.hpp"
#include "app/console.hpp"
#include "app/picture.hpp"
#include "app/plan_options.hpp"
#include "app/report.hpp"
#include "app/view_options.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "image/compare.hpp"
#include "image/error_map.hpp"
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

struct RenderWords {
    ViewWords view;
    PictureWords picture;
    PlanWords plan;
    bool measure_plan = false;
    std::string scene, against, error_map;
    std::vector<std::string> outputs;
    bool reference = false;
};

/// How far a planned picture is from everything at its best, and how long both take.
void print_measured(render::Renderer& renderer, const scene::View& everything,
                    const scene::View& planned) {
    struct Drawn {
        Image image;
        double ms;
    };
    const auto draw = [&](const scene::View& view) {
        renderer.draw(view); // programs are made when they first run
        const auto start = std::chrono::steady_clock::now();
        renderer.move_waves(view.waves.time_s);
        Drawn out{renderer.draw_again(), 0.0};
        out.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
                     .count();
        return out;
    };
    const Drawn best = draw(everything), got = draw(planned);
    const image::Difference d = image::compare(got.image, best.image);
    std::cout << "  measured: error " << fixed(100.0 * d.mean_relative, 4) << " % (95th "
              << fixed(100.0 * d.p95_relative, 3) << " %), " << fixed(got.ms, 2)
              << " ms instead of " << fixed(best.ms, 2) << " ms with reading back\n";
}

/// Draws a picture that is too large to be held whole.
void draw_strips(render::Renderer& renderer, scene::View view, int rows,
                 std::vector<PictureFile>& files, const Progress& progress) {
    const int height = view.settings.height_px;
    for (int first = 0; first < height; first += rows) {
        view.settings.strip = {first, std::min(rows, height - first)};
        const Image strip = renderer.draw(view, [&](double share) {
            progress.report((first + share * view.settings.strip->rows) / height, "rendering");
        });
        for (PictureFile& file : files)
            file.add(strip);
    }
}

int run_render(RenderWords& words, scene_files::OptionList options) {
    check_outputs(words.outputs);
    if (!words.error_map.empty()) {
        check_outputs({words.error_map});
        if (std::filesystem::path(words.error_map).extension() != ".png")
            throw Error("--error-map '" + words.error_map + "': maps are .png");
    }
    words.plan.budget.validate();
    if (!words.plan.budget.asked() && (words.plan.explain || words.measure_plan))
        throw Error("--explain and --measure need something to plan for",
                    "add --max-error or --frame-time");
    if (words.plan.budget.asked() && words.reference)
        throw Error("--reference draws everything; it cannot be planned",
                    "leave out --max-error and --frame-time");
    if (!words.error_map.empty() && words.against.empty())
        throw Error("--error-map needs something to hold the picture against",
                    "add --against REFERENCE.exr");
    if (!words.against.empty() && !std::filesystem::exists(words.against))
        throw Error("--against " + words.against + ": no such file",
                    "render it first, with --reference");
    scene::Scene scene = load_scene(words.scene, words.view);
    scene::View view = make_view(words.view, scene);
    if (view.settings.walk == scene::Walk::safety_exact ||
        view.settings.walk == scene::Walk::safety_radius)
        scene.safety_radii = scene_files::load_safety_radii(words.scene, scene);
    const Progress progress = console_progress();
    const bool needs_whole = words.reference || !words.against.empty() || words.plan.budget.asked();
    const int rows = strip_rows(words.picture, view.settings);
    const bool in_strips =
        rows < view.settings.height_px && (words.picture.strip_rows > 0 || !needs_whole);
    if (in_strips && needs_whole)
        throw Error("--strip-rows does not go with --reference, --against, --max-error and "
                    "--frame-time: they need the picture whole",
                    "leave it out");
    Image picture;
    std::string device;
    std::vector<PictureFile> files;
    const auto record = [&] {
        return Record{.scene = words.scene,
                      .options = options,
                      .command = command_line(),
                      .device = device,
                      .time = describe_time(words.view, scene),
                      .exposure = {},
                      .more = {}};
    };
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
        if (words.plan.budget.asked()) {
            const scene::View everything = scene::at_its_best(view);
            const render::Plan plan =
                render::make_plan(renderer, scene, view, words.plan.budget, progress);
            end_progress();
            view = plan.view;
            options = planned_options(options, plan);
            if (words.plan.explain || words.measure_plan)
                std::cout << explained(plan);
            else if (!plan.kept)
                spdlog::warn("the budget cannot be kept: at most {:.2g} % of error, {:.3g} ms; "
                             "--explain says why",
                             100.0 * plan.predicted_error, plan.predicted_ms);
            if (words.measure_plan)
                print_measured(renderer, everything, view);
        }
        setup_s = seconds();
        if (in_strips) {
            const Image overview = renderer.draw(scene::overview_of(view));
            for (const std::string& output : words.outputs)
                files.emplace_back(output, words.picture, scene, view, record(), overview);
            draw_strips(renderer, view, rows, files, progress);
        } else {
            picture =
                renderer.draw(view, [&](double share) { progress.report(share, "rendering"); });
        }
        end_progress();
        for (const std::string& note : renderer.wave_notes())
            spdlog::info("waves: {}", note);
    }
    const double total_s = seconds();
    end_progress();
    for (PictureFile& file : files)
        file.finish();
    for (const std::string& output : words.outputs) {
        if (!in_strips)
            write_picture(output, words.picture, picture, scene, view, record());
        std::cout << "wrote " << output << " (" << view.settings.width_px << " x "
                  << view.settings.height_px << ", " << view.settings.samples
                  << (view.settings.samples == 1 ? " sample" : " samples") << ", "
                  << fixed(total_s - setup_s, 2) << " s after " << fixed(setup_s, 2)
                  << " s of set-up, " << device << ")\n";
    }
    if (!words.against.empty()) {
        const Image other = image::read_exr(words.against);
        const image::Difference d = image::compare(picture, other);
        if (!words.error_map.empty())
            image::write_png(
                words.error_map, image::error_map(picture, other),
                {{"Software", text("tarn ", TARN_VERSION)}, {"tarn:command", command_line()}});
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
    auto words = std::make_shared<RenderWords>();
    CLI::App* c =
        app.add_subcommand("render", "one picture of a scene (.png, .exr), no display needed");
    c->add_option("SCENE", words->scene, "scene folder")->required();
    c->add_option("-o,--output", words->outputs,
                  "picture to write; .png for the eye, .exr linear with distances [m] in channel "
                  "Z; may be repeated")
        ->required();
    add_view_options(*c, words->view);
    add_picture_options(*c, words->picture);
    add_plan_options(*c, words->plan);
    c->add_flag(
        "--measure", words->measure_plan,
        "as --explain, and draw everything at its best, too: the plan's true error and time");
    c->add_option("--strip-rows", words->picture.strip_rows,
                  "draw and write so many rows at a time, a multiple of 8: for little memory; "
                  "default: all of them up to 33 million pixels, then 16 million pixels");
    c->add_flag("--reference", words->reference,
                "by the double-precision CPU tracer: slow, needs no GPU");
    c->add_option("--against", words->against, "print how far the picture is from this .exr");
    c->add_option("--error-map", words->error_map,
                  "a .png that shows where: relative error in colours, with a legend");
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
