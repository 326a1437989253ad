// `tarn render` — one picture, no display needed.
#include "app/command.hpp"
#include "app/console.hpp"
#include "app/report.hpp"
#include "app/view_options.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "geo/frame.hpp"
#include "gpu/context.hpp"
#include "image/compare.hpp"
#include "image/files.hpp"
#include "image/tone.hpp"
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
    std::string scene, exposure = "auto", tone = "eye", against;
    std::vector<std::string> outputs;
    bool reference = false;
};

/// Bright enough for land in the given light; under water the picture itself decides.
double choose_exposure(const Words& words, const Image& picture, const scene::Scene& scene,
                       const scene::View& view) {
    if (words.exposure != "auto") {
        const double factor = parse_numbers("--exposure", words.exposure, 1)[0];
        if (!(factor > 0.0))
            throw Error("--exposure must be a positive factor, or auto");
        return factor;
    }
    const scene::Lighting& light = view.lighting;
    const double incident =
        (light.sun_irradiance.y * std::max(light.sun_direction.z, 0.0) + light.sky_irradiance.y) /
        3.14159265;
    const double usual = 1.25 / std::max(incident, 1e-4);
    const glm::dvec3& p = view.camera.position;
    const auto water = scene.water_level_m(p.x, p.y);
    const bool dive = water && p.z < *water;
    return image::auto_exposure(picture, 0.25, dive ? usual * 0.2 : usual * 0.5,
                                usual * (dive ? 400.0 : 2.0));
}

std::string describe_waves(const waves::Settings& s) {
    std::string out = waves::name_of(s.model);
    if (s.calm())
        return out;
    for (const waves::PlaneWave& w : s.list)
        out += text("; ", w.amplitude_m, ",", w.length_m, ",", w.towards_deg, ",", w.phase_rad);
    if (s.model != waves::Model::calm)
        out += text("; wind ", s.wind_m_per_s, " m/s from ", s.wind_from_deg, " (grid)");
    out += text("; time ", s.time_s, " s of ", s.loop_s, "; seed ", s.seed);
    if (s.ripples.rain_drops_per_m2_s > 0.0)
        out += text("; rain ", s.ripples.rain_drops_per_m2_s, " drops/(m^2 s)");
    for (const waves::Poke& p : s.ripples.pokes)
        out += text("; poke ", p.x_m, ",", p.y_m, ",", p.height_m, ",", p.radius_m, ",", p.time_s);
    return out;
}

image::Metadata describe(const scene::Scene& scene, const scene::View& view,
                         const std::string& device) {
    const LakeRecord& lake =
        scene.lake_at_level(scene.water_level_m(view.camera.position.x, view.camera.position.y)
                                .value_or(scene.lakes.front().level_m));
    const scene::Camera& c = view.camera;
    const GeoPoint eye = geo::to_geo(scene.frame, {c.position.x, c.position.y});
    const glm::dvec3& s = view.lighting.sun_direction;
    const auto triple = [](const glm::dvec3& v) { return text(v.x, ",", v.y, ",", v.z); };
    return {
        {"Software", text("tarn ", TARN_VERSION)},
        {"Title",
         text(lake.name.empty() ? "Lake" : lake.name, " at ", fixed(lake.level_m, 2), " m")},
        {"tarn:place", text(fixed(lake.position.lat_deg, 6), ",", fixed(lake.position.lon_deg, 6))},
        {"tarn:level_m", text(lake.level_m)},
        {"tarn:vertical_datum", scene.frame.vertical_datum},
        {"tarn:bed", to_string(lake.bed)},
        {"tarn:camera", text("x=", c.position.x, ",y=", c.position.y, ",z=", c.position.z,
                             ",dx=", c.forward.x, ",dy=", c.forward.y, ",dz=", c.forward.z,
                             ",ux=", c.up.x, ",uy=", c.up.y, ",uz=", c.up.z, ",fov=", c.fov_deg)},
        {"tarn:camera_place", text(fixed(eye.lat_deg, 6), ",", fixed(eye.lon_deg, 6), " at ",
                                   fixed(c.position.z, 2), " m")},
        {"tarn:sun_direction", triple(s)},
        {"tarn:visibility_m",
         view.lighting.visibility_m ? text(*view.lighting.visibility_m) : "clear"},
        {"tarn:water", text(scene.optics.name, "; a ", triple(scene.optics.absorption_per_m),
                            " /m; b_b ", triple(scene.optics.backscattering_per_m),
                            " /m at 620, 545, 450 nm; n ", scene.optics.index,
                            view.settings.spectral && !scene.optics.bands.empty()
                                ? text("; ", scene.optics.bands.size(), " bands")
                                : std::string("; three channels"))},
        {"tarn:waves", describe_waves(view.waves)},
        {"tarn:renderer", device},
        {"tarn:command", command_line()}};
}

Picture develop(const Words& words, const Image& picture, const scene::Scene& scene,
                const scene::View& view) {
    if (words.tone == "none") // values as they are, 1 = white
        return image::encode_linear(picture);
    return image::tone_map(picture, choose_exposure(words, picture, scene, view));
}

int run_render(Words& words) {
    for (const std::string& output : words.outputs) {
        const std::string extension = std::filesystem::path(output).extension().string();
        if (extension != ".png" && extension != ".exr")
            throw Error("-o '" + output + "': pictures are .png or .exr",
                        "choose one of these endings");
        const auto folder = std::filesystem::path(output).parent_path();
        if (!folder.empty() && !std::filesystem::is_directory(folder))
            throw Error(folder.string() + ": no such folder", "create it first");
    }
    if (!words.against.empty() && !std::filesystem::exists(words.against))
        throw Error("--against " + words.against + ": no such file",
                    "render it first, with --reference");
    scene::Scene scene = scene_files::load(words.scene);
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
        const auto metadata = describe(scene, view, device);
        if (std::filesystem::path(output).extension() == ".exr")
            image::write_exr(output, picture, metadata);
        else
            image::write_png(output, develop(words, picture, scene, view), metadata);
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
    c->add_option("--exposure", words->exposure, "factor on radiance, or auto")
        ->capture_default_str();
    c->add_option("--tone", words->tone, "tone curve of a .png; none: linear radiance, 1 = white")
        ->check(CLI::IsMember({"eye", "none"}))
        ->capture_default_str();
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
            return run_render(*words);
        };
    });
}

} // namespace tarn::app
