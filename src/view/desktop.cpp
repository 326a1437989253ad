#include "view/desktop.hpp"

#include "core/error.hpp"
#include "view/panels.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <cmath>
#include <filesystem>
#include <imgui.h>

namespace tarn::view {

namespace {
std::string glfw_error() {
    const char* words = nullptr;
    glfwGetError(&words);
    return words ? words : "no reason given";
}
} // namespace

GlfwWindow::GlfwWindow(const WindowSettings& settings) {
    if (!glfwInit())
        throw Error("no window can be opened (" + glfw_error() + ")",
                    "without a display use tarn render and tarn sweep");
    try {
        open(settings);
    } catch (...) {
        glfwTerminate();
        throw;
    }
}

GlfwWindow::~GlfwWindow() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

void GlfwWindow::open(const WindowSettings& settings) {
    std::string tried;
    // The platform's own context, or EGL's if there is no other.
    for (const int api : {GLFW_NATIVE_CONTEXT_API, GLFW_EGL_CONTEXT_API}) {
        if (settings.egl && api != GLFW_EGL_CONTEXT_API)
            continue;
        glfwWindowHint(GLFW_CONTEXT_CREATION_API, api);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
        glfwWindowHintString(GLFW_X11_CLASS_NAME, "tarn");
        glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "tarn");
        window_ = glfwCreateWindow(settings.width_px, settings.height_px, settings.title.c_str(),
                                   nullptr, nullptr);
        if (window_)
            break;
        tried += (tried.empty() ? "" : "; ") +
                 std::string(api == GLFW_EGL_CONTEXT_API ? "EGL: " : "native: ") + glfw_error();
    }
    if (!window_)
        throw Error("no window with OpenGL 4.5 can be opened (" + tried + ")",
                    "run tarn doctor; without a display use tarn render and tarn sweep");
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
}

Gui::Gui(GLFWwindow* window, float scale) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.ConfigFlags |= ImGuiConfigFlags_NavEnableGamepad;
    static const ImWchar letters[] = {0x20, 0x17F, 0x2010, 0x2030, 0};
    const char* font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
    if (!std::filesystem::exists(font) ||
        !io.Fonts->AddFontFromFileTTF(font, std::round(14.0f * scale), nullptr, letters))
        io.Fonts->AddFontDefault();
    set_style(scale);
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 450");
}

Gui::~Gui() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

} // namespace tarn::view
