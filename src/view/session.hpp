#pragma once
/// @file session.hpp  What the window is about: scene, options, camera, level, measured lines.
/// Knows neither the window nor GL.
#include "core/cone_map.hpp"
#include "scene/scene.hpp"
#include "view/flight.hpp"
#include "view/probe.hpp"
#include "view/services.hpp"

#include <deque>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace tarn::view {

struct Message {
    std::string text;
    bool error = false;
    double left_s = 6.0;
};

/// "2026-06-21T09:30" to day of the year [1, 366] and hour, and back; for sliders in solar time.
struct SolarTime {
    int year = 2026, day = 172;
    double hour = 9.5;
};
std::optional<SolarTime> parse_solar(const std::string& time);
std::string format_solar(const SolarTime& time);

class Session {
public:
    /// @throws tarn::Error  if the options make no view
    Session(scene::Scene& scene, const Services& services, Options options);
    ~Session();

    scene::Scene& scene;
    const Services& services;

private:
    const scene::WaterOptics usual_optics_; ///< before any option had its say

public:
    scene::View view; ///< that the options make; its camera is flight's
    Flight flight;

    const Options& options() const { return options_; }
    std::string option(const std::string& name, const std::string& otherwise = {}) const;
    double number(const std::string& name, double otherwise) const;
    bool flag(const std::string& name) const { return option(name) == "true"; }
    /// Changes options and makes the view anew; an empty value takes an option away. What cannot be
    /// is said in a message, and nothing changes.
    bool set(const Options& changes);
    bool set(const std::string& name, const std::string& value) {
        return set(Options{{name, value}});
    }

    /// The options with the camera as it is.
    Options all_options() const;
    /// The same for the picture that would be saved: its size and rays a pixel.
    Options picture_options() const;
    int picture_width_px = 1920, picture_height_px = 1080, picture_samples = 16;
    std::string picture_format = "png"; ///< or "exr"
    /// The command that makes that picture.
    std::string picture_command() const {
        return services.command(picture_options(), picture_format);
    }

    /// When the sun stands where it does without an option.
    SolarTime usual_time() const;

    /// Once a frame: takes over what other threads have finished.
    /// @return whether the picture has changed
    bool advance(double seconds);

    // --- the level -------------------------------------------------------------------------------
    bool opening_levels() const { return opening_.valid(); }
    /// Begins to follow the water, on a thread of its own.
    void open_levels();
    LevelControl* levels() const { return levels_.get(); } ///< nothing until it is ready
    double level_m() const { return level_m_; }
    const std::optional<Figures>& figures() const { return figures_; }
    const std::vector<Figures>& curve() const { return curve_; }
    /// @param done  the slider was let go: count shore and islands, too
    void set_level(double level_m, bool done);
    double last_fill_ms() const { return last_fill_ms_; }
    /// The scene's heights are not those that the renderer has. Ask once.
    bool take_scene_changed();

    // --- messages --------------------------------------------------------------------------------
    void say(const std::string& text) {
        messages.push_back({text, false, 6.0});
        said_.push_back(messages.back());
    }
    void complain(const std::string& text) {
        messages.push_back({text, true, 12.0});
        said_.push_back(messages.back());
    }
    /// Those that nobody has taken yet, for the log.
    std::vector<Message> take_said() { return std::exchange(said_, {}); }
    std::deque<Message> messages;

    // --- the planner -----------------------------------------------------------------------------
    double max_error = 0.01;          ///< to plan with
    bool plan_at_rest = false;        ///< again, whenever the camera has come to rest elsewhere
    std::vector<std::string> reasons; ///< of the last plan; empty: there is none
    std::optional<Pose> planned_for;
    /// The view without what the last plan chose: what the next one begins with.
    scene::View unplanned_view();
    void take_plan(const Planned& plan);
    /// Draws everything again.
    void drop_plan();

    // --- bookmarks -------------------------------------------------------------------------------
    void add_bookmark(const std::string& name);
    void remove_bookmark(const std::string& name);
    void go_to(const std::string& name);

    // --- measuring -------------------------------------------------------------------------------
    enum class Measuring { off, line, polygon } measuring = Measuring::off;
    std::vector<glm::dvec3> measured;

    std::vector<scene::MapLayer> layers;
    /// @param in_space  at heights of its own, counted as the option layers-3d-heights says
    void add_layer(const std::string& path, bool in_space = false);
    void remove_layer(std::size_t index);
    /// @param words  of layers-3d-heights
    void count_heights_from(const std::string& words);
    /// What is draped is not what the renderer has. Ask once.
    bool take_map_changed() { return std::exchange(map_changed_, false); }

    /// Sun and waves that go on by themselves.
    bool play_sun = false, play_waves = false;
    double sun_hours_per_s = 0.5;

private:
    void keep_bookmarks();
    void lay_layers();
    void hang_layers();

    Options options_;
    std::optional<SolarTime> playing_; ///< finer than the option can say
    std::future<std::unique_ptr<LevelControl>> opening_;
    std::unique_ptr<LevelControl> levels_;
    double level_m_ = 0.0, last_fill_ms_ = 0.0;
    std::optional<Figures> figures_;
    std::vector<Figures> curve_;
    bool scene_changed_ = false, map_changed_ = false;
    std::vector<Message> said_;
    std::vector<std::string> layer_paths_;
    std::map<std::string, std::string> before_plan_; ///< of the options that it set
};

} // namespace tarn::view
