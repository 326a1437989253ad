#pragma once
/// @file overlay.hpp  What stands over the picture.
#include "view/panels.hpp"

namespace tarn::view {

/// North arrow, scale bar, depth gauge, measured lines, layers, pointer, messages, keys.
void draw_overlay(Session& session, PanelState& state, float scale);

/// Labels of points that nothing hides; asks the GPU for each.
std::vector<Label> find_labels(const Session& session, const Screen& screen);

} // namespace tarn::view
