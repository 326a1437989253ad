// `tarn view` — the window.
#include "app/command.hpp"
#include "app/console.hpp"
#include "app/layers.hpp"
#include "app/picture.hpp"
#include "app/plan_options.hpp"
#include "app/view_options.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/import.hpp"
#include "dem/refill.hpp"
#include "geo/frame.hpp"
#include "gpu/context.hpp"
#include "render/planner.hpp"
#include "scene_files/scene_folder.hpp"
#include "view/window.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <spdlog/spdlog.h>

namespace tarn::app {

namespace {

namespace fs = std::filesystem;

struct WindowWords {
    ViewWords view;
    PictureWords picture;
    PlanWords plan;
    std::string scene, pictures = ".", picture_format = "png", log;
    std::vector<std::string> layers;
    bool egl = false;
};

/// dem::Refill as the window knows it.
class RefilledLevels : public view::LevelControl {
public:
    explicit RefilledLevels(dem::Refill refill) : refill_(std::move(refill)) {}
    double lowest_m() const override { return refill_.lowest_m(); }
    double highest_m() const override { return refill_.highest_m(); }
    double usual_m() const override { return refill_.lake().level_m; }
    std::optional<double> spill_m() const override { return refill_.spill_m(); }
    view::Figures figures(double level_m) const override { return of(refill_.figures(level_m)); }
    std::vector<view::Figures> curve(int count, double up_to_m) const override {
        std::vector<view::Figures> out;
        for (const dem::WaterFigures& f : refill_.curve(count, up_to_m))
            out.push_back(of(f));
        return out;
    }
    void fill(double level_m, scene::Scene& scene, bool shore) override {
        move_level(refill_, level_m, scene, shore);
    }

private:
    static view::Figures of(const dem::WaterFigures& f) {
        return {f.level_m, f.area_m2, f.volume_m3, f.max_depth_m, f.open_at_edge};
    }
    dem::Refill refill_;
};

/// A command line of options, read as `tarn render` reads it.
struct Parsed {
    ViewWords view;
    PictureWords picture;
    CLI::App app;
    explicit Parsed(const view::Options& options) {
        add_view_options(app, view);
        add_picture_options(app, picture);
        try {
            for (const auto& [name, value] : options) {
                CLI::Option* option = app.get_option_no_throw("--" + name);
                if (!option)
                    throw Error("no option is called '" + name + "'");
                option->add_result(value);
                option->run_callback();
            }
        } catch (const CLI::Error& error) {
            throw Error(error.what());
        }
    }
};

scene_files::OptionList list_of(const view::Options& options) {
    return {options.begin(), options.end()};
}

/// A name that is not taken, with either ending: tarn_001.png, tarn_002.exr, ...
std::string next_picture(const fs::path& folder, const std::string& format) {
    for (int i = 1; i < 100'000; ++i) {
        const std::string name = "tarn_" + numbered(i, 3);
        if (!fs::exists(folder / (name + ".png")) && !fs::exists(folder / (name + ".exr")))
            return (folder / (name + "." + format)).string();
    }
    throw Error(folder.string() + " is full of pictures", "choose another folder with --pictures");
}

class PictureOnDisk : public view::SavedPicture {
public:
    PictureOnDisk(std::string path, PictureFile file)
        : path_(std::move(path)), file_(std::move(file)) {}
    void add(const Image& rows) override { file_.add(rows); }
    std::string finish() override {
        file_.finish();
        return path_;
    }

private:
    std::string path_;
    PictureFile file_;
};

view::Planned planned_of(const render::Plan& plan) {
    view::Planned out;
    for (const auto& [name, value] : options_of(plan))
        out.options[name] = value;
    for (const render::Decision& d : plan.decisions)
        if (d.taken)
            out.reasons.push_back(text(d.part, ": ", d.choice, ", ", d.why,
                                       d.error > 0.0 ? ": " + percent(d.error, 2) : std::string()));
    out.speed_up = plan.everything_ms / std::max(plan.predicted_ms, 1e-6);
    out.reasons.push_back(text("At most ", percent(plan.predicted_error, 2), " of error, ",
                               fixed(out.speed_up, 1), " times as quick as everything on."));
    out.kept = plan.kept;
    return out;
}

/// @param import  command that makes the scene, where it is a temporary one
view::Services services_for(const std::string& folder, const scene::Scene& as_imported,
                            const WindowWords& words, const std::string& import) {
    // In commands and sidecars a temporary scene has the name that `import` gives it.
    const std::string named = import.empty() ? folder : "scene";
    const std::string first = import.empty() ? "" : import + " && ";
    view::Services out;
    out.make_view = [](const view::Options& options, scene::Scene& scene) {
        Parsed parsed(options);
        return make_view(parsed.view, scene);
    };
    out.command = [named, first](const view::Options& options, const std::string& format) {
        return first + command_of("render", named, list_of(options)) + " -o picture." + format;
    };
    out.record_command = [folder, named, first](const view::Options& options) {
        view::Options own = options;
        own.erase("camera");
        std::string path;
        for (const scene::NamedCamera& c : scene_files::load_cameras(folder))
            path += (path.empty() ? "" : "/") + c.name;
        own["path"] = path;
        return first + command_of("record", named, list_of(own)) + " -o frames";
    };
    out.open_levels = [folder, lake = words.view.lake,
                       scene = std::make_shared<const scene::Scene>(as_imported)] {
        return std::unique_ptr<view::LevelControl>(
            std::make_unique<RefilledLevels>(make_refill(folder, *scene, lake, Progress{})));
    };
    out.save_cameras = [folder](const std::vector<scene::NamedCamera>& cameras) {
        scene_files::replace_cameras(folder, cameras);
    };
    out.begin_picture = [named, first, pictures = words.pictures](
                            const Image& overview, const scene::Scene& scene,
                            const scene::View& view, const view::Options& options,
                            const std::string& format) {
        Parsed parsed(options);
        parsed.picture.sidecar = true;
        const std::string path = next_picture(pictures, format);
        return std::make_unique<PictureOnDisk>(
            path, PictureFile(path, parsed.picture, scene, view,
                              {.scene = named,
                               .options = list_of(options),
                               .command = first + command_of("render", named, list_of(options)) +
                                          " -o " + path,
                               .device = "tarn view",
                               .time = describe_time(parsed.view, scene),
                               .exposure = {},
                               .more = {}},
                              overview));
    };
    if (!words.plan.budget.max_error)
        out.frame_time_ms = words.plan.budget.frame_time_ms;
    out.plan = [time_ms = out.frame_time_ms](render::Renderer& renderer, const scene::Scene& scene,
                                             const scene::View& view, double max_error,
                                             const Progress& progress) {
        render::Budget budget;
        if (time_ms)
            budget.frame_time_ms = time_ms;
        else
            budget.max_error = max_error;
        return planned_of(render::make_plan(renderer, scene, view, budget, progress));
    };
    out.read_layer = [frame = as_imported.frame](const std::string& path) {
        return read_layer(path, frame);
    };
    return out;
}

/// A DEM is imported beside, to a folder that goes with the program.
class TemporaryScene {
public:
    TemporaryScene(const std::string& dem, std::optional<double> level_m) {
        std::string name = (fs::temp_directory_path() / "tarn-view-XXXXXX").string();
        if (!::mkdtemp(name.data()))
            throw Error(fs::temp_directory_path().string() + ": no folder can be made there",
                        "set TMPDIR to a place with some space");
        folder_ = name;
        try {
            import_for_viewing(dem, (folder_ / "scene").string(), level_m);
        } catch (...) {
            std::error_code ignored;
            fs::remove_all(folder_, ignored);
            throw;
        }
    }
    ~TemporaryScene() {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    TemporaryScene(const TemporaryScene&) = delete;
    TemporaryScene& operator=(const TemporaryScene&) = delete;
    std::string path() const { return (folder_ / "scene").string(); }

private:
    fs::path folder_;
};

/// Chooses what the window begins with, for its first view; panels and options change it from
/// there.
view::Planned plan_start(const WindowWords& words, const scene::Scene& scene, int width_px,
                         int height_px) {
    const gpu::Context context;
    scene::Scene shown = scene;
    ViewWords start = words.view;
    start.size = text(width_px, "x", height_px);
    scene::View view = make_view(start, shown);
    view.settings.samples = 1; // as one flies
    render::Renderer renderer(shown);
    const render::Plan plan =
        render::make_plan(renderer, shown, view, words.plan.budget, console_progress());
    end_progress();
    if (words.plan.explain)
        std::cout << explained(plan) << std::flush;
    else if (!plan.kept)
        spdlog::warn("the budget cannot be kept; --explain says why");
    return planned_of(plan);
}

int run_view(const WindowWords& words, view::Options options) {
    const auto started = std::chrono::steady_clock::now();
    std::optional<std::string> next = words.scene;
    std::string shown, message;
    bool first = true;
    while (next) {
        std::optional<TemporaryScene> temporary;
        std::string folder = *next;
        scene::Scene scene;
        try {
            if (!fs::is_directory(folder)) {
                temporary.emplace(folder, first ? words.view.level_m : std::nullopt);
                folder = temporary->path();
            }
            scene = scene_files::load(folder);
            if (first)
                // Refuses what cannot be read before a window opens.
                lay_layers(read_layers(words.view, scene.frame), scene);
        } catch (const Error& error) {
            if (first)
                throw;
            message = error.what(); // back to what was shown before
            temporary.reset();
            next = folder = shown;
            if (!fs::is_directory(folder)) {
                temporary.emplace(folder, std::nullopt);
                folder = temporary->path();
            }
            scene = scene_files::load(folder);
        }
        const scene::Scene as_imported = scene;
        if (const auto level = words.view.level_m; level && first && !temporary) {
            dem::Refill refill = make_refill(folder, scene, words.view.lake, console_progress());
            move_level(refill, *level, scene, true);
            end_progress();
        }
        int width = 1280, height = 800;
        if (const auto size = options.find("size"); size != options.end())
            std::sscanf(size->second.c_str(), "%dx%d", &width, &height);
        std::optional<view::Planned> plan;
        if (first && words.plan.budget.asked())
            plan = plan_start(words, scene, width, height);
        const std::string import =
            temporary ? "tarn import " + *next +
                            (words.view.level_m && first ? text(" --level ", *words.view.level_m)
                                                         : std::string()) +
                            " -o scene"
                      : std::string();
        shown = *next;
        const std::string name = scene.lakes.front().name;
        next = view::run_window(
            scene, services_for(folder, as_imported, words, import), options,
            {.width_px = width,
             .height_px = height,
             .title = (name.empty() ? fs::path(*next).filename().string() : name) + " - tarn",
             .message = std::exchange(message, {}),
             .stop = interrupted,
             .log = first ? words.log : "",
             .started = started,
             .plan = std::move(plan),
             .max_error = words.plan.budget.max_error.value_or(0.01),
             .egl = words.egl,
             .picture_format = words.picture_format});
        options.clear();
        first = false;
    }
    return 0;
}

} // namespace

void add_view(CLI::App& app, Run& run) {
    auto words = std::make_shared<WindowWords>();
    CLI::App* c = app.add_subcommand("view", "the window: fly, dive, move the level, measure");
    c->add_option("SCENE", words->scene,
                  "scene folder; a DEM file is imported for the time being, with its level found")
        ->required();
    c->add_option("--pictures", words->pictures, "folder that F12 writes to")
        ->capture_default_str();
    c->add_option("--picture-format", words->picture_format,
                  "what F12 writes: png, or exr, linear with distances")
        ->check(CLI::IsMember({"png", "exr"}))
        ->capture_default_str();
    c->add_option("--session-log", words->log,
                  "file for what goes on, a JSON object a line: start, frames, levels, poses");
    c->add_flag("--egl", words->egl, "an EGL context instead of the platform's own");
    add_view_options(*c, words->view);
    add_picture_options(*c, words->picture);
    add_plan_options(*c, words->plan);
    c->footer("F1 in the window shows keys and mouse.\n"
              "Examples:\n  tarn view rotoma\n  tarn view rotoma --wind 5 --camera dive\n"
              "  tarn view dem.tif");
    c->callback([words, c, &run] {
        run = [words, c] {
            apply_settings_file(*c, words->view);
            view::Options options;
            for (const auto& [name, value] : given_options(*c))
                if (name != "pictures" && name != "picture-format" && name != "egl" &&
                    name != "session-log" && name != "max-error" && name != "frame-time")
                    options[name] = value;
            return run_view(*words, options);
        };
    });
}

} // namespace tarn::app
