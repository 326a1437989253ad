#pragma once
/// @file panels.hpp  What stands at the side of the picture.
#include "view/screen.hpp"
#include "view/session.hpp"

#include <optional>
#include <string>

namespace tarn::view {

/// What panels ask the window to do.
struct Requests {
    bool view_changed = false; ///< options, hence the picture
    bool save_picture = false;
    bool plan = false;
    bool time_passes = false;
    std::string open; ///< a scene folder or DEM to show next
};

/// Of a point of a layer, where it is in the window.
struct Label {
    float x = 0, y = 0;
    std::string text;
};

/// What the panels keep between frames.
struct PanelState {
    bool shown = true, help = false;
    double frames_per_s = 0.0;
    std::string device;
    char sun_place[64] = "", bookmark[64] = "", layer[512] = "", open[512] = "";
    bool layer_in_space = false;
    std::vector<std::pair<std::string, double>> pass_ms;
    std::optional<Reading> pointer;
    bool pointer_known = false; ///< else nothing has been drawn there yet
    bool level_dragged = false;
    std::vector<Label> labels;
};

/// The side panel.
Requests draw_panels(Session& session, const Screen& screen, PanelState& state, float scale);

/// One colour scheme and sizes for all.
void set_style(float scale);

} // namespace tarn::view
