// `tarn record` — a camera's way as numbered pictures, and as a video where ffmpeg is there.
#include "app/command.hpp"
#include "app/console.hpp"
#include "app/picture.hpp"
#include "app/view_options.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/vectors.hpp"
#include "gpu/context.hpp"
#include "image/files.hpp"
#include "render/renderer.hpp"
#include "scene/camera_path.hpp"
#include "scene_files/scene_folder.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <spdlog/spdlog.h>

namespace tarn::app {

namespace {

namespace fs = std::filesystem;

struct RecordWords {
    ViewWords view;
    PictureWords picture;
    std::string scene, output, path, track, video;
    double seconds = 20.0, frames_per_s = 25.0, above_m = 30.0;
};

std::vector<scene::Camera> plan(const RecordWords& words, scene::Scene& scene, int frames) {
    if (words.track.empty() == words.path.empty())
        throw Error("give a way with --path or --track, one of them",
                    "--path overview/shore/dive, say");
    if (!words.path.empty()) {
        std::vector<scene::Camera> keys;
        for (const std::string& camera : split(words.path, '/')) {
            ViewWords one = words.view;
            one.camera = camera;
            keys.push_back(make_view(one, scene).camera);
        }
        if (keys.empty())
            throw Error("--path names no camera", "--path overview/shore/dive, say");
        return scene::path_through(keys, frames, scene.ground);
    }
    for (const dem::VectorFeature& f : dem::read_vectors(words.track, scene.frame))
        for (const auto& line : f.lines) {
            std::vector<glm::dvec2> track;
            for (const ScenePoint& p : line)
                track.push_back({p.x_m, p.y_m});
            return scene::path_along(track, words.above_m, scene.lakes.front().level_m, 60.0,
                                     frames, scene.ground);
        }
    throw Error(words.track + ": holds no line to follow", "give a track, not waypoints");
}

std::string frame_name(int index) { return "frame_" + numbered(index + 1, 5) + ".png"; }

/// Each picture's exposure, found in small ones and smoothed over half a second: no flicker.
std::vector<double> exposures(const RecordWords& words, const std::vector<scene::Camera>& way,
                              const scene::Scene& scene, scene::View view,
                              render::Renderer& renderer, const Progress& progress) {
    std::vector<double> raw;
    std::vector<bool> under;
    view.settings.width_px = std::max(16, view.settings.width_px / 8);
    view.settings.height_px = std::max(9, view.settings.height_px / 8);
    view.settings.samples = 1;
    for (std::size_t i = 0; i < way.size(); ++i) {
        progress.report(0.1 * double(i) / double(way.size()), "finding exposures");
        view.camera = way[i];
        under.push_back(scene.under_water(way[i].position));
        raw.push_back(
            std::log(choose_exposure(words.picture.exposure, renderer.draw(view), scene, view)));
    }
    const int reach = std::max(1, int(0.5 * words.frames_per_s));
    std::vector<double> out;
    for (int i = 0; i < int(raw.size()); ++i) {
        double sum = 0.0, weights = 0.0;
        // Not across the surface: there the light changes a hundredfold at once.
        for (const int step : {-1, 1})
            for (int k = step > 0 ? 1 : 0; k <= reach; ++k) {
                const int j = i + step * k;
                if (j < 0 || j >= int(raw.size()) || under[std::size_t(j)] != under[std::size_t(i)])
                    break;
                const double weight = 1.0 + std::cos(3.14159265 * k / (reach + 1));
                sum += weight * raw[std::size_t(j)];
                weights += weight;
            }
        out.push_back(std::exp(sum / weights));
    }
    return out;
}

/// Draws those pictures of the way that are missing.
void draw(const RecordWords& words, const scene_files::OptionList& options,
          const std::vector<scene::Camera>& way, const std::vector<int>& missing,
          const scene::Scene& scene, scene::View view) {
    const gpu::Context context;
    render::Renderer renderer(scene);
    const Progress progress = console_progress();
    const std::vector<double> exposure =
        words.picture.tone == "none" ? std::vector<double>(way.size(), 1.0)
                                     : exposures(words, way, scene, view, renderer, progress);
    const double begin_s = view.waves.time_s;
    for (const int i : missing) {
        const fs::path path = fs::path(words.output) / frame_name(i);
        view.camera = way[std::size_t(i)];
        if (!view.waves.calm())
            view.waves.time_s = begin_s + i / words.frames_per_s;
        const Image picture = renderer.draw(view, [&](double share) {
            progress.report(0.1 + 0.9 * (i + share) / double(way.size()), frame_name(i));
        });
        scene_files::OptionList own; // of this picture alone
        for (const auto& option : options)
            if (option.first != "path" && option.first != "track" && option.first != "above" &&
                option.first != "seconds" && option.first != "fps")
                own.push_back(option);
        own = with_option(own, "camera", camera_words(view.camera));
        if (!view.waves.calm())
            own = with_option(own, "wave-time", text(view.waves.time_s));
        write_picture(path.string(), words.picture, picture, scene, view,
                      {.scene = words.scene,
                       .options = own,
                       .command = {},
                       .device = context.renderer(),
                       .time = describe_time(words.view, scene),
                       .exposure = exposure[std::size_t(i)],
                       .more = {}});
    }
    end_progress();
}

int run_record(const RecordWords& words, const scene_files::OptionList& options) {
    if (!(words.seconds > 0.0 && words.seconds <= 36'000.0))
        throw Error(text("--seconds is ", words.seconds, ", must be in (0, 36000]"));
    if (!(words.frames_per_s >= 0.1 && words.frames_per_s <= 240.0))
        throw Error(text("--fps is ", words.frames_per_s, ", must be in [0.1, 240]"));
    if (!(words.above_m > 0.0 && words.above_m <= 1e5))
        throw Error(text("--above is ", words.above_m, " m, must be in (0, 100000]"));
    if (!words.video.empty() && std::system("command -v ffmpeg >/dev/null 2>&1") != 0)
        throw Error("--video needs ffmpeg, which is not here",
                    "install it (Debian: ffmpeg), or leave --video out and keep the pictures");
    const double wanted = std::round(words.seconds * words.frames_per_s);
    if (!(wanted <= 100'000.0))
        throw Error(text("that is ", wanted, " pictures"), "ask for fewer than 100000");
    const int frames = std::max(1, int(wanted));
    scene::Scene scene = load_scene(words.scene, words.view);
    const scene::View view = make_view(words.view, scene);
    const std::vector<scene::Camera> way = plan(words, scene, frames);
    fs::create_directories(words.output);
    // Pictures of the same recording are kept, those of another are in the way.
    const fs::path record = fs::path(words.output) / "record.json";
    const std::string command = command_of("record", words.scene, options);
    std::string all; // every camera counts: bookmarks and tracks may have changed
    for (const scene::Camera& c : way)
        all += camera_words(c);
    const std::string about = scene_files::sidecar_json(
        "frame_*.png", words.scene, options,
        {{"tarn:command", command},
         {"tarn:job", short_sum(scene_files::identity(words.scene) + all + files_mark(options))}});
    if (fs::exists(record) && !scene_files::same_text(record, about))
        throw Error(words.output + ": holds another recording", "choose another folder with -o");
    if (!fs::exists(record) && fs::exists(fs::path(words.output) / frame_name(0)))
        throw Error(words.output + ": holds pictures of another recording",
                    "choose another folder with -o");
    write_beside(record.string(), about);

    std::vector<int> missing;
    for (int i = 0; i < frames; ++i)
        if (!fs::exists(fs::path(words.output) / frame_name(i)))
            missing.push_back(i);
    if (!missing.empty())
        draw(words, options, way, missing, scene, view);
    std::cout << "wrote " << missing.size() << " of " << frames << " pictures to " << words.output
              << "\n";
    if (!words.video.empty()) {
        const fs::path part =
            fs::path(words.video)
                .replace_extension(".part" + fs::path(words.video).extension().string());
        const std::string shell =
            text("ffmpeg -v error -y -framerate ", words.frames_per_s, " -i ",
                 shell_word((fs::path(words.output) / "frame_%05d.png").string()),
                 " -vf 'crop=trunc(iw/2)*2:trunc(ih/2)*2' -pix_fmt yuv420p ",
                 shell_word(part.string()), " </dev/null");
        if (std::system(shell.c_str()) != 0) {
            std::error_code ignored;
            fs::remove(part, ignored);
            throw Error("ffmpeg could not write " + words.video, "the pictures are there");
        }
        fs::rename(part, words.video);
        std::cout << "wrote " << words.video << "\n";
    }
    return 0;
}

} // namespace

void add_record(CLI::App& app, Run& run) {
    auto words = std::make_shared<RecordWords>();
    CLI::App* c =
        app.add_subcommand("record", "a camera's way as numbered pictures, and as a video");
    c->add_option("SCENE", words->scene, "scene folder")->required();
    c->add_option("-o,--output", words->output, "folder for frame_00001.png, ...")->required();
    c->add_option("--path", words->path,
                  "cameras to go through, with / between them: names, or pairs as --camera takes");
    c->add_option("--track", words->track, "follow the first line of a GPX or other vector file");
    c->add_option("--above", words->above_m, "height over ground and water along --track [m]")
        ->capture_default_str();
    c->add_option("--seconds", words->seconds, "it lasts so long")->capture_default_str();
    c->add_option("--fps", words->frames_per_s, "pictures a second")->capture_default_str();
    c->add_option("--video", words->video, "write this video, too (by ffmpeg): .mp4, .webm, ...");
    add_view_options(*c, words->view);
    add_picture_options(*c, words->picture);
    c->footer("Waves go on with the time of the pictures. What is there of the same recording is "
              "kept.\n"
              "Examples:\n"
              "  tarn record rotoma --path overview/shore/dive --seconds 12 --wind 4 -o frames\n"
              "  tarn record rotoma --track boat.gpx --above 3 --video boat.mp4 -o frames");
    c->callback([words, c, &run] {
        run = [words, c] {
            apply_settings_file(*c, words->view);
            scene_files::OptionList options;
            for (const auto& option : given_options(*c))
                if (option.first != "video")
                    options.push_back(option);
            return run_record(*words, options);
        };
    });
}

} // namespace tarn::app
