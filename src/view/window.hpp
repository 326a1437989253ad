#pragma once
/// @file window.hpp  The window: GLFW, Dear ImGui, and the loop that holds all together.
#include "scene/scene.hpp"
#include "view/services.hpp"

#include <chrono>
#include <functional>
#include <optional>
#include <string>

namespace tarn::view {

struct WindowSettings {
    int width_px = 1280, height_px = 720; ///< at first
    std::string title = "tarn";
    std::string message;        ///< shown at first
    std::function<bool()> stop; ///< asked each frame: is the window to close?
    std::string log;            ///< file for what goes on (session_log.hpp); empty: none
    std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
    std::optional<Planned> plan; ///< made before the window opened
    double max_error = 0.01;     ///< of that, and of others to come
    bool egl = false;            ///< ask GLFW for an EGL context instead of the platform's own
    std::string picture_format = "png"; ///< or "exr": what F12 writes
};

/// Shows the scene until somebody closes the window.
/// @return  a scene folder or DEM that was dropped on the window, to be shown next
/// @throws tarn::Error  if no window or no OpenGL 4.5 can be had, saying why and what to do
std::optional<std::string> run_window(scene::Scene& scene, const Services& services,
                                      const Options& options, const WindowSettings& settings);

} // namespace tarn::view
