#pragma once
/// @file desktop.hpp  A window with OpenGL 4.5 in it, and Dear ImGui's hold on it.
#include "view/window.hpp"

struct GLFWwindow;

namespace tarn::view {

/// GLFW's library and one window with a current context, both gone at the end.
class GlfwWindow {
public:
    /// @throws tarn::Error  if there is no display, or no OpenGL 4.5 core
    explicit GlfwWindow(const WindowSettings& settings);
    ~GlfwWindow();
    GlfwWindow(const GlfwWindow&) = delete;
    GlfwWindow& operator=(const GlfwWindow&) = delete;
    GLFWwindow* get() const { return window_; }

private:
    void open(const WindowSettings& settings);
    GLFWwindow* window_ = nullptr;
};

/// Dear ImGui's context and its two back ends.
class Gui {
public:
    /// @param scale  of the monitor: 1 for the usual one
    Gui(GLFWwindow* window, float scale);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;
};

} // namespace tarn::view
