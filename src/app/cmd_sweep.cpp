// `tarn sweep` — pictures of water-level scenarios: levels x cameras x times, and their figures.
#include "app/command.hpp"
#include "app/console.hpp"
#include "app/layers.hpp"
#include "app/picture.hpp"
#include "app/plan_options.hpp"
#include "app/scenario_map.hpp"
#include "app/view_options.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/refill.hpp"
#include "dem/stages.hpp"
#include "gpu/context.hpp"
#include "image/annotate.hpp"
#include "image/files.hpp"
#include "render/renderer.hpp"
#include "scene/exposure.hpp"
#include "scene_files/scenarios.hpp"
#include "scene_files/scene_folder.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tarn::app {

namespace {

namespace fs = std::filesystem;

struct SweepWords {
    ViewWords view;
    PictureWords picture;
    PlanWords plan;
    std::string scene, output, levels, cameras = "overview", times, extension = "png";
    std::vector<std::string> differences;
    int processes = 1, thumbnail_px = 480;
    std::optional<int> job;
    bool list = false;
};

/// One picture to be made.
struct Job {
    std::size_t level = 0, camera = 0, time = 0; ///< places in the lists
    std::string name;                            ///< of the file, without its ending
};

struct Camera {
    std::string name, words;
};

struct Plan {
    std::vector<double> levels_m;
    std::vector<Camera> cameras;
    std::vector<std::string> times; ///< one empty word: the default
    std::vector<Job> jobs;          ///< level by level
};

/// For names of files: letters, digits, point, dash and underscore.
std::string file_word(const std::string& word) {
    std::string out;
    for (const char c : word)
        if (std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '_')
            out += c;
    return out;
}

Plan make_plan(const SweepWords& words) {
    Plan plan;
    plan.levels_m = parse_levels(words.levels);
    for (const std::string& one : split(words.cameras, '/')) {
        // NAME, NAME:key=value,... or key=value,...
        const std::size_t colon = one.find(':'), equals = one.find('=');
        Camera camera;
        if (equals == std::string::npos)
            for (const std::string& name : split(one, ','))
                plan.cameras.push_back({file_word(name), name});
        else if (colon < equals)
            plan.cameras.push_back({file_word(one.substr(0, colon)), one.substr(colon + 1)});
        else
            plan.cameras.push_back({text("camera", plan.cameras.size() + 1), one});
    }
    if (plan.cameras.empty())
        throw Error("--cameras: none given", "write overview/shore or NAME:key=value,...");
    plan.times = split(words.times, '/');
    if (plan.times.empty())
        plan.times.push_back(words.view.time);
    for (std::size_t l = 0; l < plan.levels_m.size(); ++l)
        for (std::size_t c = 0; c < plan.cameras.size(); ++c)
            for (std::size_t t = 0; t < plan.times.size(); ++t) {
                std::string name =
                    "level_" + fixed(plan.levels_m[l], 2) + "_" + plan.cameras[c].name;
                if (!words.times.empty())
                    name += "_" + file_word(plan.times[t]);
                plan.jobs.push_back({l, c, t, name});
            }
    std::vector<std::string> names;
    for (const Job& job : plan.jobs)
        names.push_back(job.name);
    std::sort(names.begin(), names.end());
    const auto twice = std::adjacent_find(names.begin(), names.end());
    if (twice != names.end())
        throw Error("two pictures would be called " + *twice,
                    "levels count to the centimetre; give cameras different names");
    return plan;
}

/// The words of one picture.
ViewWords words_of(const SweepWords& words, const Plan& plan, const Job& job) {
    ViewWords out = words.view;
    out.level_m = plan.levels_m[job.level];
    out.camera = plan.cameras[job.camera].words;
    out.time = plan.times[job.time];
    return out;
}

scene_files::OptionList options_for(const scene_files::OptionList& common, const Plan& plan,
                                    const Job& job) {
    scene_files::OptionList out = common;
    out.emplace_back("level", text(plan.levels_m[job.level]));
    out.emplace_back("camera", plan.cameras[job.camera].words);
    if (!plan.times[job.time].empty())
        out.emplace_back("time", plan.times[job.time]);
    return out;
}

class Sweep {
public:
    Sweep(const SweepWords& words, const scene_files::OptionList& common)
        : words_(words), common_(common), plan_(make_plan(words)),
          scene_(scene_files::load(words.scene)), identity_(scene_files::identity(words.scene)) {
        layers_ = read_layers(words.view, scene_.frame);
        lay_layers(layers_, scene_);
    }

    const Plan& plan() const { return plan_; }
    const scene::Scene& scene() const { return scene_; }
    fs::path file(const Job& job) const {
        return fs::path(words_.output) / (job.name + "." + words_.extension);
    }
    std::string command(const Job& job) const {
        return command_of("render", words_.scene, options_for(common_, plan_, job)) + " -o " +
               file(job).string();
    }

    /// Changes with anything that changes the picture: options, scene, camera, program.
    std::string mark(const Job& job) const {
        const scene::Camera* named = nullptr;
        for (const scene::NamedCamera& c : scene_.cameras)
            if (c.name == plan_.cameras[job.camera].words)
                named = &c.camera;
        return short_sum(identity_ + command(job) + files_mark(common_) +
                         (named ? camera_words(*named) : std::string()));
    }

    /// Is the picture there, made from this scene with these options?
    bool done(const Job& job) const {
        if (!fs::exists(file(job)))
            return false;
        const fs::path sidecar = fs::path(file(job)).replace_extension(".json");
        try {
            return scene_files::sidecar_says(sidecar, "tarn:job", mark(job));
        } catch (const Error&) {
            return false;
        }
    }

    dem::Refill& refill() {
        if (!refill_) {
            refill_.emplace(
                make_refill(words_.scene, scene_, words_.view.lake, console_progress()));
            end_progress();
        }
        return *refill_;
    }

    /// Draws those of `jobs` that are missing. @return how many failed
    int draw(const std::vector<Job>& jobs);

private:
    double exposure_for(const Job& job, const scene::Scene& scene, const scene::View& view,
                        const Image& picture);

    const SweepWords& words_;
    const scene_files::OptionList& common_;
    Plan plan_;
    scene::Scene scene_; ///< as imported
    std::vector<scene::MapLayer> layers_;
    std::string identity_;
    std::optional<dem::Refill> refill_;
    struct Usual { ///< of the lake as imported
        bool known = false, under_water = false;
        double exposure = 1.0;
    };
    std::map<std::pair<std::size_t, std::size_t>, Usual> usual_; ///< by camera and time
};

// Pictures of one camera and time are to be compared: they share the exposure that suits the lake
// as imported, unless the water has come over the camera, or gone from it.
double Sweep::exposure_for(const Job& job, const scene::Scene& scene, const scene::View& view,
                           const Image& picture) {
    if (words_.picture.exposure != "auto" || words_.picture.tone == "none")
        return words_.picture.tone == "none"
                   ? 1.0
                   : choose_exposure(words_.picture.exposure, picture, scene, view);
    Usual& usual = usual_[{job.camera, job.time}];
    if (!usual.known) {
        ViewWords words = words_of(words_, plan_, job);
        words.level_m.reset();
        scene::Scene before = scene_;
        scene::View as_imported = make_view(words, before);
        as_imported.settings.width_px = std::max(16, view.settings.width_px / 8);
        as_imported.settings.height_px = std::max(9, view.settings.height_px / 8);
        as_imported.settings.samples = 1;
        render::Renderer renderer(before);
        const Image small = renderer.draw(as_imported);
        usual = {true, before.under_water(as_imported.camera.position),
                 choose_exposure("auto", small, before, as_imported)};
    }
    return usual.under_water == scene.under_water(view.camera.position)
               ? usual.exposure
               : choose_exposure("auto", picture, scene, view);
}

int Sweep::draw(const std::vector<Job>& jobs) {
    int failed = 0;
    std::vector<Job> missing;
    for (const Job& job : jobs)
        if (done(job))
            spdlog::info("{} is there", file(job).string());
        else
            missing.push_back(job);
    if (missing.empty())
        return 0;
    const gpu::Context context;
    const Progress progress = console_progress();
    scene::Scene scene = scene_;
    std::unique_ptr<render::Renderer> renderer;
    std::optional<std::size_t> level;
    std::size_t count = 0;
    for (const Job& job : missing) {
        try {
            const auto start = std::chrono::steady_clock::now();
            const ViewWords words = words_of(words_, plan_, job);
            if (level != job.level) {
                renderer.reset();
                move_level(refill(), plan_.levels_m[job.level], scene, true);
                scene::hang_layers(scene, layers_);
                level = job.level;
            }
            scene::View view = make_view(words, scene);
            if (!renderer)
                renderer = std::make_unique<render::Renderer>(scene);
            scene_files::OptionList options = options_for(common_, plan_, job);
            if (words_.plan.budget.asked()) { // each picture shows something else
                const render::Plan plan =
                    render::make_plan(*renderer, scene, view, words_.plan.budget, {});
                view = plan.view;
                options = planned_options(options, plan);
                end_progress();
                if (words_.plan.explain)
                    std::cout << job.name << "\n" << explained(plan);
                else if (!plan.kept)
                    spdlog::warn("{}: the budget cannot be kept; --explain says why", job.name);
            }
            const Image picture = renderer->draw(view, [&](double share) {
                progress.report((double(count) + share) / double(missing.size()), job.name);
            });
            PictureWords how = words_.picture;
            how.sidecar = true;
            write_picture(file(job).string(), how, picture, scene, view,
                          {.scene = words_.scene,
                           .options = options,
                           .command = {},
                           .device = context.renderer(),
                           .time = describe_time(words, scene),
                           .exposure = exposure_for(job, scene, view, picture),
                           .more = {{"tarn:job", mark(job)}}});
            ++count;
            end_progress();
            spdlog::info(
                "{} of {}: {} ({} s)", count, missing.size(), file(job).string(),
                fixed(
                    std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                    1));
        } catch (const Cancelled&) {
            throw;
        } catch (const Error& error) {
            end_progress();
            spdlog::error("{}: {}", job.name, error.what());
            level.reset();
            ++failed;
        }
    }
    return failed;
}

/// Contact sheet: a row a level, highest first, a column a camera and time.
void write_sheet(const Sweep& sweep, const SweepWords& words, const fs::path& path) {
    const Plan& plan = sweep.plan();
    const std::size_t columns = plan.cameras.size() * plan.times.size();
    std::vector<std::size_t> order(plan.levels_m.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return plan.levels_m[a] > plan.levels_m[b]; });
    const int size = std::max(12, words.thumbnail_px / 28), gap = size / 2, head = 2 * size,
              left = size * 8;
    Picture sheet;
    int high = 0;
    for (const Job& job : plan.jobs) {
        if (!fs::exists(sweep.file(job)))
            continue;
        const Picture picture = image::read_rgba(sweep.file(job));
        const int wide = words.thumbnail_px;
        const int tall =
            std::max(1, int(std::lround(double(wide) * picture.height_px / picture.width_px)));
        if (sheet.bytes.empty()) {
            high = tall;
            sheet.width_px = left + int(columns) * (wide + gap);
            sheet.height_px = 2 * head + int(plan.levels_m.size()) * (high + gap);
            sheet.bytes.assign(std::size_t(sheet.width_px) * std::size_t(sheet.height_px) * 3, 32);
        }
        const auto row =
            std::size_t(std::find(order.begin(), order.end(), job.level) - order.begin());
        const std::size_t column = job.camera * plan.times.size() + job.time;
        image::paste(sheet, image::resized(picture, wide, std::min(tall, high)),
                     left + int(column) * (wide + gap), 2 * head + int(row) * (high + gap));
    }
    if (sheet.bytes.empty())
        throw Error("no picture is there yet to make a contact sheet from");
    const LakeRecord& lake = sweep.scene().lakes.front();
    image::draw_text(sheet, gap, head - size / 2, size,
                     (lake.name.empty() ? std::string("Lake") : lake.name) +
                         ": levels [m] by cameras" + (plan.times.size() > 1 ? " and times" : ""));
    for (std::size_t c = 0; c < columns; ++c) {
        const std::string& time = plan.times[c % plan.times.size()];
        image::draw_text(
            sheet, left + int(c) * (words.thumbnail_px + gap), 2 * head - size / 2, size,
            plan.cameras[c / plan.times.size()].name + (words.times.empty() ? "" : "  " + time));
    }
    for (std::size_t r = 0; r < order.size(); ++r)
        image::draw_text(sheet, gap, 2 * head + int(r) * (high + gap) + high / 2, size,
                         fixed(plan.levels_m[order[r]], 2) + " m");
    image::write_png(path, sheet, {{"Software", text("tarn ", TARN_VERSION)}});
}

scene_files::Scenarios tabulate(Sweep& sweep, const SweepWords& words) {
    const Plan& plan = sweep.plan();
    const dem::Refill& refill = sweep.refill();
    const scene::Scene& scene = sweep.scene();
    const dem::StageTable table =
        dem::stage_table(refill.heights_m(), scene.ground, scene.water, scene.frame, refill.lake(),
                         plan.levels_m, 8, console_progress());
    end_progress();
    const double usual_m2 = refill.figures(refill.lake().level_m).area_m2;
    scene_files::Scenarios out;
    out.scene = words.scene;
    out.lake = refill.lake();
    for (const Job& job : plan.jobs) {
        const dem::Stage& s = table.stages[job.level];
        scene_files::Scenario row;
        row.level_m = s.level_m;
        row.camera = plan.cameras[job.camera].name;
        row.time = plan.times[job.time];
        row.picture = sweep.file(job).filename().string();
        row.done = sweep.done(job);
        const fs::path sidecar = fs::path(sweep.file(job)).replace_extension(".json");
        row.command = scene_files::sidecar_value(sidecar, "tarn:command")
                          .value_or(sweep.command(job)); // with the exposure that it has
        row.area_m2 = s.area_m2;
        row.true_area_m2 = s.true_area_m2;
        row.volume_m3 = s.volume_m3;
        row.true_volume_m3 = s.true_volume_m3;
        row.max_depth_m = s.max_depth_m;
        row.mean_depth_m = s.mean_depth_m;
        row.shoreline_m = s.shoreline_m;
        row.islands = s.islands;
        row.exposed_bed_m2 = std::max(0.0, usual_m2 - s.area_m2);
        row.flooded_m2 = std::max(0.0, s.area_m2 - usual_m2);
        row.open_at_edge = s.open_at_edge;
        out.rows.push_back(row);
    }
    return out;
}

void write_differences(Sweep& sweep, const SweepWords& words) {
    for (const std::string& difference : words.differences) {
        std::string commas = difference;
        std::replace(commas.begin(), commas.end(), ':', ',');
        const auto levels = parse_numbers("--difference", commas, 2);
        const fs::path base =
            fs::path(words.output) / ("from_" + fixed(levels[0], 2) + "_to_" + fixed(levels[1], 2));
        const auto area =
            write_difference(sweep.scene(), sweep.refill(), levels[0], levels[1], base);
        std::cout << "wrote " << base.string() << ".tif and .png: newly flooded "
                  << format_area(area.flooded_m2) << ", newly exposed "
                  << format_area(area.exposed_m2) << "\n";
    }
}

/// Shares the jobs out between processes, each with a context of its own.
int draw_in_processes(Sweep& sweep, const SweepWords& words) {
    const std::vector<Job>& jobs = sweep.plan().jobs;
    const int processes = std::clamp(words.processes, 1, int(jobs.size()));
    if (processes == 1)
        return sweep.draw(jobs);
    sweep.refill(); // once for all: memory is shared until it is written to
    std::vector<pid_t> children;
    for (int k = 0; k < processes; ++k) {
        const pid_t child = ::fork();
        if (child < 0) {
            spdlog::error("no further process can be started; ask for fewer --processes");
            break; // those that run go on; what is missing is said at the end
        }
        if (child == 0) {
            const std::size_t first = jobs.size() * std::size_t(k) / std::size_t(processes);
            const std::size_t last = jobs.size() * std::size_t(k + 1) / std::size_t(processes);
            int code = 1;
            try {
                code = sweep.draw({jobs.begin() + std::ptrdiff_t(first),
                                   jobs.begin() + std::ptrdiff_t(last)}) == 0
                           ? 0
                           : 1;
            } catch (const std::exception& error) {
                spdlog::error(error.what());
            }
            ::_exit(code); // the parent's files and threads are not ours to close
        }
        children.push_back(child);
    }
    for (const pid_t child : children) {
        int status = 0;
        while (::waitpid(child, &status, 0) < 0 && errno == EINTR)
            ;
        if (WIFSIGNALED(status))
            spdlog::error("a process was ended by signal {}; its pictures are missing",
                          WTERMSIG(status));
    }
    int missing = 0;
    for (const Job& job : jobs)
        missing += !sweep.done(job);
    return missing;
}

int run_sweep(SweepWords& words, const scene_files::OptionList& common) {
    if (words.view.level_m || words.view.camera != "overview")
        throw Error("tarn sweep takes --levels and --cameras, not --level and --camera");
    if (!words.times.empty() && !words.view.time.empty())
        throw Error("--times and --time exclude each other");
    if (words.processes < 1 || words.processes > 256)
        throw Error(text("--processes is ", words.processes, ", must be in [1, 256]"));
    if (words.thumbnail_px < 64 || words.thumbnail_px > 4096)
        throw Error(text("--thumbnail is ", words.thumbnail_px, ", must be in [64, 4096] pixels"));
    if (words.processes > 1)
        image::read_without_threads(); // they do not come along into other processes
    Sweep sweep(words, common);
    const std::vector<Job>& jobs = sweep.plan().jobs;
    if (words.list) {
        for (std::size_t i = 0; i < jobs.size(); ++i)
            std::cout << i + 1 << "\t" << (sweep.done(jobs[i]) ? "done" : "missing") << "\t"
                      << sweep.file(jobs[i]).string() << "\n";
        return 0;
    }
    // What cannot be shown is said before hours of work.
    for (const double level : sweep.plan().levels_m)
        sweep.refill().figures(level);
    for (std::size_t c = 0; c < sweep.plan().cameras.size(); ++c) {
        scene::Scene scratch = sweep.scene();
        for (const Job& job : jobs)
            if (job.camera == c && job.level == 0) {
                ViewWords one = words_of(words, sweep.plan(), job);
                one.level_m.reset();
                make_view(one, scratch);
            }
    }
    fs::create_directories(words.output);
    if (words.job) {
        if (*words.job < 1 || std::size_t(*words.job) > jobs.size())
            throw Error(text("--job ", *words.job, ": there are jobs 1 to ", jobs.size()),
                        "tarn sweep --list shows them");
        return sweep.draw({jobs[std::size_t(*words.job - 1)]}) == 0 ? 0 : 1;
    }
    const int failed = draw_in_processes(sweep, words);
    const scene_files::Scenarios scenarios = tabulate(sweep, words);
    write_beside((fs::path(words.output) / "scenarios.csv").string(),
                 scene_files::scenarios_csv(scenarios));
    write_beside((fs::path(words.output) / "scenarios.json").string(),
                 scene_files::scenarios_json(scenarios));
    if (words.extension == "png")
        write_sheet(sweep, words, fs::path(words.output) / "contact_sheet.png");
    write_differences(sweep, words);
    std::cout << "wrote " << jobs.size() - std::size_t(failed) << " of " << jobs.size()
              << " pictures, scenarios.csv, scenarios.json"
              << (words.extension == "png" ? " and contact_sheet.png" : "") << " in "
              << words.output << "\n";
    return failed == 0 ? 0 : 1;
}

} // namespace

void add_sweep(CLI::App& app, Run& run) {
    auto words = std::make_shared<SweepWords>();
    CLI::App* c = app.add_subcommand(
        "sweep", "pictures of water-level scenarios with their figures and a contact sheet");
    c->add_option("SCENE", words->scene, "scene folder")->required();
    c->add_option("-o,--output", words->output, "folder for pictures and tables")->required();
    c->add_option("--levels", words->levels, "FROM:TO:STEP, or a list with commas [m]")->required();
    c->add_option("--cameras", words->cameras,
                  "cameras of the scene with / between them; NAME:key=value,... makes one (see "
                  "--camera of tarn render)")
        ->capture_default_str();
    c->add_option("--times", words->times, "dates and times for the sun with / between them");
    c->add_option("--format", words->extension, "of the pictures")
        ->check(CLI::IsMember({"png", "exr"}))
        ->capture_default_str();
    c->add_option("--difference", words->differences,
                  "FROM:TO: map of what is newly flooded and newly exposed between two levels, as "
                  "GeoTIFF and picture; may be repeated");
    c->add_option("--thumbnail", words->thumbnail_px,
                  "width of a picture on the contact sheet [px]")
        ->capture_default_str();
    c->add_option("--processes", words->processes, "that draw side by side")->capture_default_str();
    c->add_flag("--list", words->list, "print the jobs, one a line, and whether they are done");
    c->add_option("--job", words->job,
                  "draw only this one of the list: for a batch system's array; a last run without "
                  "it collects them");
    add_view_options(*c, words->view);
    add_picture_options(*c, words->picture);
    add_plan_options(*c, words->plan);
    c->footer(
        "Pictures that are there, from the same scene and options, are not drawn again.\n"
        "Examples:\n"
        "  tarn sweep rotoma --levels 290:320:5 --cameras overview/shore -o scenarios\n"
        "  tarn sweep rotoma --levels 300,313.31 --times 2026-06-21T09:00/2026-12-21T09:00 \\\n"
        "      --cameras dam:lat=-38.05,lon=176.58,above_ground=30,heading=40 "
        "--difference 313.31:300 -o s\n"
        "  tarn sweep rotoma --levels 290:320:5 -o s --job $SLURM_ARRAY_TASK_ID");
    c->callback([words, c, &run] {
        run = [words, c] {
            apply_settings_file(*c, words->view);
            // Of the options of a picture those that all share.
            static const std::vector<std::string> own = {
                "levels",     "time",      "cameras", "times",     "format",
                "difference", "thumbnail", "job",     "processes", "list"};
            scene_files::OptionList common;
            for (const auto& option : given_options(*c))
                if (std::find(own.begin(), own.end(), option.first) == own.end())
                    common.push_back(option);
            return run_sweep(*words, common);
        };
    });
}

} // namespace tarn::app
