#include "view/session.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace tarn::view {

Session::Session(scene::Scene& s, const Services& v, Options options)
    : scene(s), services(v), usual_optics_(s.optics), view(v.make_view(options, s)),
      flight(s, pose_of(view.camera)), options_(std::move(options)) {
    options_.erase("camera"); // from here on it is flight's
    level_m_ = scene.lakes.front().level_m;
    for (const LakeRecord& lake : scene.lakes) // the one that moves
        if (lake.id == int(number("lake", 1)))
            level_m_ = lake.level_m;
    picture_samples = int(number("samples", picture_samples));
    const std::string draped = option("layers"), in_space = option("layers-3d");
    for (const std::string& path : split(draped, ':'))
        add_layer(path);
    for (const std::string& path : split(in_space, ':'))
        add_layer(path, true);
}

void Session::open_levels() {
    if (!opening_.valid() && !levels_)
        opening_ = std::async(std::launch::async, services.open_levels);
}

Session::~Session() {
    if (opening_.valid())
        opening_.wait();
}

std::string Session::option(const std::string& name, const std::string& otherwise) const {
    const auto found = options_.find(name);
    return found == options_.end() ? otherwise : found->second;
}

double Session::number(const std::string& name, double otherwise) const {
    const std::string word = option(name);
    if (word.empty())
        return otherwise;
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    return end && *end == '\0' ? value : otherwise;
}

bool Session::set(const Options& changes) {
    Options wanted = options_;
    for (const auto& [name, value] : changes)
        if (value.empty())
            wanted.erase(name);
        else
            wanted[name] = value;
    const scene::WaterOptics before = scene.optics;
    try {
        scene.optics = usual_optics_;
        Options with_camera = wanted;
        with_camera["camera"] = all_options().at("camera");
        scene::View made = services.make_view(with_camera, scene);
        view = std::move(made);
        options_ = std::move(wanted);
        for (const auto& [name, value] : changes) // somebody's own from here, not the plan's
            before_plan_.erase(name);
        return true;
    } catch (const Error& error) {
        scene.optics = before;
        complain(error.what());
        return false;
    }
}

scene::View Session::unplanned_view() {
    Options options = all_options();
    for (const auto& [name, value] : before_plan_)
        if (value.empty())
            options.erase(name);
        else
            options[name] = value;
    scene.optics = usual_optics_;
    return services.make_view(options, scene);
}

void Session::take_plan(const Planned& plan) {
    std::map<std::string, std::string> before;
    Options changes(before_plan_.begin(),
                    before_plan_.end()); // what it says nothing of is as it was
    for (const auto& [name, value] : plan.options) {
        const auto known = before_plan_.find(name);
        before[name] = known != before_plan_.end() ? known->second : option(name);
        changes[name] = value;
    }
    planned_for = flight.pose(); // whatever comes of it: not again from here
    if (!set(changes))
        return;
    before_plan_ = std::move(before);
    reasons = plan.reasons;
    if (!plan.kept)
        say("nothing keeps that budget; this comes nearest");
}

void Session::drop_plan() {
    set(Options(before_plan_.begin(), before_plan_.end()));
    before_plan_.clear();
    reasons.clear();
    planned_for.reset();
    plan_at_rest = false;
}

Options Session::all_options() const {
    Options out = options_;
    const Pose& p = flight.pose();
    const scene::Camera c = camera_of(p);
    out["camera"] =
        text("x=", p.position.x, ",y=", p.position.y, ",z=", p.position.z, ",dx=", c.forward.x,
             ",dy=", c.forward.y, ",dz=", c.forward.z, ",fov=", p.fov_deg);
    return out;
}

Options Session::picture_options() const {
    Options out = all_options();
    out["size"] = text(picture_width_px, "x", picture_height_px);
    out["samples"] = text(picture_samples);
    return out;
}

SolarTime Session::usual_time() const { // geo::default_time(), at the sun's place
    const std::string place = option("sun-place");
    const double lat_deg =
        place.empty() ? scene.lakes.front().position.lat_deg : std::atof(place.c_str());
    return {2026, lat_deg >= 0.0 ? 172 : 355, 9.5};
}

bool Session::advance(double seconds) {
    bool changed = false;
    if (opening_.valid() &&
        opening_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
        try {
            levels_ = opening_.get();
            figures_ = levels_->figures(level_m_);
            const double top = std::min(
                levels_->highest_m(),
                std::max(levels_->spill_m().value_or(levels_->highest_m()), levels_->usual_m()) +
                    0.25 * (levels_->usual_m() - levels_->lowest_m()) + 1.0);
            curve_ = levels_->curve(160, top);
        } catch (const std::exception& error) {
            complain(std::string("the level cannot be moved: ") + error.what());
        }
    }
    if (play_sun) {
        // Whole minutes are all that the option can say; at many frames a second less goes by.
        if (!playing_ || format_solar(*playing_) != option("time"))
            playing_ = parse_solar(option("time")).value_or(usual_time());
        playing_->hour += sun_hours_per_s * seconds;
        if (playing_->hour >= 24.0)
            playing_->hour -= 24.0;
        if (const std::string time = format_solar(*playing_); time != option("time"))
            changed |= set("time", time);
    }
    if (play_waves && !view.waves.calm()) {
        const double loop = view.waves.loop_s > 0.0 ? view.waves.loop_s : 1e9;
        view.waves.time_s = std::fmod(view.waves.time_s + seconds, loop);
        options_["wave-time"] = fixed(view.waves.time_s, 3);
        changed = true;
    }
    for (Message& m : messages)
        m.left_s -= seconds;
    std::erase_if(messages, [](const Message& m) { return m.left_s <= 0.0; });
    return changed;
}

void Session::set_level(double level_m, bool done) {
    if (!levels_)
        return;
    level_m = std::clamp(level_m, levels_->lowest_m(), levels_->highest_m());
    try {
        const auto start = std::chrono::steady_clock::now();
        levels_->fill(level_m, scene, done);
        last_fill_ms_ =
            1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        level_m_ = level_m;
        if (!layers.empty())
            scene::hang_layers(scene, layers); // labels lie on the water, lines may hang from it
        figures_ = levels_->figures(level_m);
        scene_changed_ = true;
        options_["level"] = fixed(level_m, 3);
        if (std::abs(level_m - levels_->usual_m()) < 0.0005)
            options_.erase("level");
    } catch (const Error& error) {
        complain(error.what());
    }
}

bool Session::take_scene_changed() { return std::exchange(scene_changed_, false); }

void Session::keep_bookmarks() {
    try {
        services.save_cameras(scene.cameras);
    } catch (const std::exception& error) {
        complain(std::string("bookmarks are not kept: ") + error.what());
    }
}

void Session::add_bookmark(const std::string& name) {
    if (name.empty() || name.find_first_of("=,/") != std::string::npos) {
        complain("a bookmark needs a name without = , and /");
        return;
    }
    std::erase_if(scene.cameras, [&](const scene::NamedCamera& c) { return c.name == name; });
    scene.cameras.push_back({name, camera_of(flight.pose())});
    keep_bookmarks();
}

void Session::remove_bookmark(const std::string& name) {
    std::erase_if(scene.cameras, [&](const scene::NamedCamera& c) { return c.name == name; });
    keep_bookmarks();
}

void Session::go_to(const std::string& name) {
    for (const scene::NamedCamera& c : scene.cameras)
        if (c.name == name)
            flight.fly_to(pose_of(c.camera));
}

void Session::add_layer(const std::string& path, bool in_space) {
    try {
        layers.push_back(services.read_layer(path));
        layer_paths_.push_back(path);
        if (in_space)
            layers.back().heights = scene::heights_from(option("layers-3d-heights"));
        try {
            lay_layers();
        } catch (const std::exception&) {
            remove_layer(layers.size() - 1);
            throw;
        }
        say(text("layer ", layers.back().name, ": ", layers.back().shapes.lines.size(), " lines, ",
                 layers.back().shapes.points.size(), " points"));
    } catch (const std::exception& error) {
        complain(error.what());
    }
}

void Session::remove_layer(std::size_t index) {
    layers.erase(layers.begin() + std::ptrdiff_t(index));
    layer_paths_.erase(layer_paths_.begin() + std::ptrdiff_t(index));
    lay_layers();
}

void Session::count_heights_from(const std::string& words) {
    const std::vector<scene::MapLayer> before = layers;
    for (scene::MapLayer& layer : layers)
        if (layer.heights)
            layer.heights = scene::heights_from(words);
    try {
        hang_layers();
        options_["layers-3d-heights"] = words;
    } catch (const Error& error) {
        layers = before;
        complain(error.what());
    }
}

void Session::lay_layers() {
    const bool draped = scene::drape_layers(scene, layers);
    hang_layers();
    if (!draped)
        complain("nothing of the layers lies on the scene");
    for (const bool in_space : {false, true}) {
        std::string paths;
        for (std::size_t i = 0; i < layers.size(); ++i)
            if (layers[i].heights.has_value() == in_space)
                paths += (paths.empty() ? "" : ":") + layer_paths_[i];
        const char* name = in_space ? "layers-3d" : "layers";
        if (paths.empty())
            options_.erase(name);
        else
            options_[name] = paths;
    }
}

void Session::hang_layers() {
    scene::hang_layers(scene, layers);
    map_changed_ = true;
}

std::optional<SolarTime> parse_solar(const std::string& time) {
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, used = 0;
    if (std::sscanf(time.c_str(), "%d-%d-%dT%d:%d%n", &year, &month, &day, &hour, &minute, &used) <
            5 ||
        std::size_t(used) != time.size())
        return std::nullopt; // with seconds or a zone
    const std::chrono::year_month_day date{std::chrono::year(year),
                                           std::chrono::month(unsigned(month)),
                                           std::chrono::day(unsigned(day))};
    if (!date.ok() || hour > 23 || minute > 59)
        return std::nullopt;
    const auto first = std::chrono::sys_days{std::chrono::year(year) / 1 / 1};
    return SolarTime{year, int((std::chrono::sys_days{date} - first).count()) + 1,
                     hour + minute / 60.0};
}

std::string format_solar(const SolarTime& time) {
    const int minutes = std::clamp(int(std::lround(time.hour * 60.0)), 0, 24 * 60 - 1);
    const std::chrono::year_month_day date{
        std::chrono::sys_days{std::chrono::year(time.year) / 1 / 1} +
        std::chrono::days(std::clamp(time.day, 1, 366) - 1)};
    char out[64];
    std::snprintf(out, sizeof out, "%04d-%02u-%02uT%02d:%02d", int(date.year()),
                  unsigned(date.month()), unsigned(date.day()), minutes / 60, minutes % 60);
    return out;
}

} // namespace tarn::view
