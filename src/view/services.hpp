#pragma once
/// @file services.hpp  What the window asks of the rest of the program: who gives it knows GDAL,
/// files and the command line, the window does not.
#include "core/image.hpp"
#include "core/progress.hpp"
#include "scene/map_layers.hpp"
#include "scene/settings.hpp"
#include "view/options.hpp"

#include <functional>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tarn::render {
class Renderer;
}

namespace tarn::view {

/// What the water holds at a level.
struct Figures {
    double level_m = 0.0, area_m2 = 0.0;
    std::optional<double> volume_m3, max_depth_m; ///< bed known
    bool open_at_edge = false;
};

/// Moves a lake's level. Made on a thread of its own; used by one thread at a time.
class LevelControl {
public:
    virtual ~LevelControl() = default;
    virtual double lowest_m() const = 0;
    virtual double highest_m() const = 0;
    virtual double usual_m() const = 0; ///< as the scene was made
    virtual std::optional<double> spill_m() const = 0;
    virtual Figures figures(double level_m) const = 0;
    virtual std::vector<Figures> curve(int count, double up_to_m) const = 0;
    /// Changes ground, water and lakes of the scene.
    /// @param shore  shoreline, islands and the lake's middle, too: slower
    virtual void fill(double level_m, scene::Scene& scene, bool shore) = 0;
};

/// A picture being written, from its first row down. Without finish() nothing is left of it.
class SavedPicture {
public:
    virtual ~SavedPicture() = default;
    virtual void add(const Image& rows) = 0; ///< @throws tarn::Error
    virtual std::string finish() = 0;        ///< its path. @throws tarn::Error
};

/// How a view is drawn within a budget of error, and why.
struct Planned {
    Options options;                  ///< that draw so
    std::vector<std::string> reasons; ///< a line each
    double speed_up = 1.0;            ///< over everything at its best, predicted
    bool kept = true;                 ///< false: nothing keeps the budget, this comes nearest
};

struct Services {
    /// The view that the options ask for; puts the water's optics into the scene.
    /// @throws tarn::Error  saying which option is wrong
    std::function<scene::View(const Options&, scene::Scene&)> make_view;
    /// The command that makes the same picture.
    /// @param format  "png" or "exr"
    std::function<std::string(const Options&, const std::string& format)> command;
    /// The command that records a way through all cameras of the scene.
    std::function<std::string(const Options&)> record_command;
    /// Slow: call it on a thread of its own. May throw.
    std::function<std::unique_ptr<LevelControl>()> open_levels;
    /// Keeps cameras in the scene folder. @throws tarn::Error
    std::function<void(const std::vector<scene::NamedCamera>&)> save_cameras;
    /// Begins to write a picture and what belongs beside it.
    /// @param overview  the picture itself, or a smaller one (scene/strips.hpp)
    /// @param format    "png" or "exr"
    /// @throws tarn::Error
    std::function<std::unique_ptr<SavedPicture>(const Image& overview, const scene::Scene&,
                                                const scene::View&, const Options&,
                                                const std::string& format)>
        begin_picture;
    /// @throws tarn::Error
    std::function<scene::MapLayer(const std::string& path)> read_layer;
    /// What plans keep to instead of an error, where the window was opened with that.
    std::optional<double> frame_time_ms;
    /// Chooses what a view needs for a mean relative radiance error, or for that time; takes as
    /// long as some fifteen pictures. @throws tarn::Error, tarn::Cancelled
    std::function<Planned(render::Renderer&, const scene::Scene&, const scene::View&,
                          double max_error, const Progress&)>
        plan;
};

} // namespace tarn::view
