#include "view/window.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "gpu/gl.hpp"
#include "render/renderer.hpp"
#include "scene/curvature.hpp"
#include "scene/strips.hpp"
#include "view/cone_maker.hpp"
#include "view/desktop.hpp"
#include "view/overlay.hpp"
#include "view/panels.hpp"
#include "view/screen.hpp"
#include "view/session.hpp"
#include "view/session_log.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <algorithm>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <future>
#include <glm/geometric.hpp>
#include <imgui.h>

namespace tarn::view {

namespace {

double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

class App {
public:
    App(scene::Scene& scene, const Services& services, const Options& options,
        const WindowSettings& settings)
        : window_(settings), scale_(content_scale()), callbacks_(set_callbacks()),
          gui_(window_.get(), scale_), session_(scene, services, options), renderer_(scene),
          screen_(renderer_), log_(settings.log),
          started_s_(std::chrono::duration<double>(settings.started.time_since_epoch()).count()) {
        state_.device = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
        session_.play_waves = !gpu::is_software();
        stop_ = settings.stop;
        if (!settings.message.empty())
            session_.complain(settings.message);
        session_.max_error = settings.max_error;
        session_.picture_format = settings.picture_format;
        if (settings.plan) {
            session_.take_plan(*settings.plan);
            session_.plan_at_rest = !gpu::is_software(); // where it takes a second
        }
        if (gpu::is_software() && session_.option("samples").empty())
            session_.picture_samples = 4;
        last_s_ = now_s();
    }

    std::optional<std::string> run() {
        while (!glfwWindowShouldClose(window_.get())) {
            frame();
            if (stop_ && stop_())
                glfwSetWindowShouldClose(window_.get(), GLFW_TRUE);
        }
        log_.write(now_s() - started_s_, "closed", {});
        return next_;
    }

private:
    // Before Dear ImGui sets its own, which then call these. Keys that go down and up within one
    // slow frame are kept.
    bool set_callbacks() {
        glfwSetWindowUserPointer(window_.get(), this);
        glfwSetDropCallback(window_.get(), [](GLFWwindow* w, int count, const char** paths) {
            static_cast<App*>(glfwGetWindowUserPointer(w))->dropped(count, paths);
        });
        glfwSetKeyCallback(window_.get(), [](GLFWwindow* w, int key, int, int action, int mods) {
            if (action == GLFW_PRESS)
                static_cast<App*>(glfwGetWindowUserPointer(w))->pressed_.push_back({key, mods});
        });
        return true;
    }
    float content_scale() const {
        float x = 1.0f, y = 1.0f;
        glfwGetWindowContentScale(window_.get(), &x, &y);
        return std::max(1.0f, x);
    }
    void frame();
    void keys(double seconds);
    void mouse();
    void read_pointer();
    bool draw_rows_of(const scene::View& view, double from_share, double to_share);
    void save_picture();
    void plan(int width, int height);
    void log_frame(double began_s, bool first);
    void take_changes(double now);
    bool draw(bool time_passes, double now, int width, int height, double seconds);
    bool show_progress(const std::string& what, double share);
    ImTextureID screen_image() const;
    void show();
    void dropped(int count, const char** paths);
    scene::View view_now();
    std::optional<glm::dvec3> point_at(double x, double y) const;
    /// Of the picture's lines of sight (scene/curvature.hpp).
    double bend_per_m(int height_px) const;

    GlfwWindow window_;
    struct KeyPress {
        int key, mods; ///< as GLFW has them
    };
    std::vector<KeyPress> pressed_; ///< since the last frame, however short
    float scale_;
    bool callbacks_;
    Gui gui_;
    Session session_;
    render::Renderer renderer_;
    Screen screen_;
    PanelState state_;
    ConeMaker cones_;
    std::optional<std::string> next_;
    std::function<bool()> stop_;
    SessionLog log_;
    double started_s_, logged_level_m_ = NAN;
    bool shown_once_ = false;
    double last_s_ = 0.0, moved_s_ = -1e9, level_s_ = -1e9;
    std::optional<Pose> pose_; ///< of the last frame, and since when
    double pose_s_ = 0.0;
    bool save_asked_ = false;
    bool changed_ = true, moving_ = false, was_moving_ = false;
    std::optional<glm::dvec3> pivot_;
    bool turning_ = false;
    double pointer_x_ = 0.0, pointer_y_ = 0.0;
    double frames_ = 0.0, frames_since_s_ = 0.0;
    int idle_frames_ = 0;
};

scene::View App::view_now() {
    scene::View view = session_.view;
    view.camera = camera_of(session_.flight.pose());
    // Until cone maps are there, what a GPU makes at once serves: it finds the same.
    const bool cones = view.settings.walk == scene::Walk::cone_map ||
                       view.settings.walk == scene::Walk::cone_steps;
    if (cones && renderer_.needs_cone_maps())
        view.settings.walk = scene::Walk::maximum_mipmap;
    return view;
}

std::optional<glm::dvec3> App::point_at(double x, double y) const {
    int w = 1, h = 1;
    glfwGetFramebufferSize(window_.get(), &w, &h);
    const glm::dvec3 eye = session_.flight.pose().position;
    const glm::dvec3 d = glm::normalize(
        scene::pixel_direction(camera_of(session_.flight.pose()), x * w, y * h, w, h));
    const float distance = screen_.distance_at(x, y);
    if (std::isnan(distance)) // not drawn yet: without the GPU
        return first_met(session_.scene, eye, d, bend_per_m(h));
    if (!(distance > 0.0f && distance < 0.99e9f))
        return std::nullopt;
    const double bend = bend_per_m(h) * (d.x * d.x + d.y * d.y);
    return eye + d * double(distance) + glm::dvec3(0, 0, bend * distance * distance);
}

double App::bend_per_m(int height_px) const {
    scene::View view = session_.view;
    view.camera = camera_of(session_.flight.pose());
    view.settings.height_px = std::max(height_px, 1);
    const glm::dvec3& eye = view.camera.position;
    const auto over = session_.scene.water_level_m(eye.x, eye.y);
    return scene::is_curved(session_.scene, view) && !(over && eye.z < *over) ? scene::bend_per_m
                                                                              : 0.0;
}

void App::keys(double seconds) {
    const ImGuiIO& io = ImGui::GetIO();
    GLFWwindow* w = window_.get();
    const auto down = [w](int key) { return glfwGetKey(w, key) == GLFW_PRESS; };
    // Alone, or with Shift, which some keys take for more.
    const auto pressed = [this](int key, int mods = 0) {
        return std::any_of(pressed_.begin(), pressed_.end(), [&](const KeyPress& p) {
            return p.key == key && (p.mods & GLFW_MOD_CONTROL) == (mods & GLFW_MOD_CONTROL);
        });
    };
    const auto shifted = [this](int key) {
        return std::any_of(pressed_.begin(), pressed_.end(), [&](const KeyPress& p) {
            return p.key == key && (p.mods & GLFW_MOD_SHIFT) != 0;
        });
    };
    Push push;
    if (!io.WantTextInput) {
        const bool control = io.KeyCtrl;
        if (pressed(GLFW_KEY_F1))
            state_.help = !state_.help;
        if (pressed(GLFW_KEY_F12))
            save_asked_ = true;
        if (pressed(GLFW_KEY_TAB))
            state_.shown = !state_.shown;
        if (pressed(GLFW_KEY_Q, GLFW_MOD_CONTROL))
            glfwSetWindowShouldClose(window_.get(), GLFW_TRUE);
        if (pressed(GLFW_KEY_Z, GLFW_MOD_CONTROL) && session_.flight.undo())
            changed_ = true;
        if (pressed(GLFW_KEY_Y, GLFW_MOD_CONTROL) && session_.flight.redo())
            changed_ = true;
        if (pressed(GLFW_KEY_C, GLFW_MOD_CONTROL)) {
            ImGui::SetClipboardText(session_.picture_command().c_str());
            session_.say("the command that makes this picture is on the clipboard");
        }
        if (pressed(GLFW_KEY_ESCAPE)) {
            session_.measuring = Session::Measuring::off;
            session_.measured.clear();
        }
        if (pressed(GLFW_KEY_BACKSPACE) && !session_.measured.empty())
            session_.measured.pop_back();
        if (pressed(GLFW_KEY_SPACE))
            session_.play_waves = !session_.play_waves;
        for (int k = 0; k < 9; ++k)
            if (pressed(GLFW_KEY_1 + k) && std::size_t(k) < session_.scene.cameras.size())
                session_.go_to(session_.scene.cameras[std::size_t(k)].name);
        for (const auto& [key, sign] :
             {std::pair(GLFW_KEY_LEFT_BRACKET, -1.0), std::pair(GLFW_KEY_RIGHT_BRACKET, 1.0)})
            if (pressed(key))
                session_.set_level(session_.level_m() + sign * (shifted(key) ? 1.0 : 0.1), true);
        if (!control || !(down(GLFW_KEY_Z) || down(GLFW_KEY_Y) || down(GLFW_KEY_C))) {
            push.forward = double(down(GLFW_KEY_W) || down(GLFW_KEY_UP)) -
                           double(down(GLFW_KEY_S) || down(GLFW_KEY_DOWN));
            push.right = double(down(GLFW_KEY_D) || down(GLFW_KEY_RIGHT)) -
                         double(down(GLFW_KEY_A) || down(GLFW_KEY_LEFT));
            push.up = double(down(GLFW_KEY_E) || down(GLFW_KEY_PAGE_UP)) -
                      double(down(GLFW_KEY_Q) || down(GLFW_KEY_PAGE_DOWN));
        }
        push.boost = io.KeyShift ? 4.0 : io.KeyCtrl ? 0.25 : 1.0;
    }
    GLFWgamepadstate pad;
    if (glfwGetGamepadState(GLFW_JOYSTICK_1, &pad)) {
        const PadInput input = read_pad(pad.axes);
        push.right += input.push.right;
        push.forward += input.push.forward;
        push.up += input.push.up;
        if (input.turn_right != 0.0 || input.turn_up != 0.0) {
            session_.flight.turn(90.0 * input.turn_right * seconds, 60.0 * input.turn_up * seconds);
            changed_ = moving_ = true;
        }
    }
    if (push.any() && !was_moving_)
        session_.flight.remember();
    if (session_.flight.advance(push, seconds))
        changed_ = moving_ = true;
    moving_ |= push.any() || session_.flight.under_way();
}

void App::mouse() {
    const ImGuiIO& io = ImGui::GetIO();
    const bool here = !io.WantCaptureMouse && io.DisplaySize.x > 0 && io.DisplaySize.y > 0;
    const double x = io.MousePos.x / io.DisplaySize.x, y = io.MousePos.y / io.DisplaySize.y;
    if (here && ImGui::IsMouseDoubleClicked(0) && session_.measuring == Session::Measuring::off) {
        if (const auto point = point_at(x, y)) {
            session_.flight.fly_to_point(*point);
            changed_ = true;
        }
        pivot_.reset();
        return;
    }
    if (here && ImGui::IsMouseClicked(0)) {
        pivot_ = point_at(x, y);
        if (session_.measuring != Session::Measuring::off) {
            if (pivot_)
                session_.measured.push_back(*pivot_);
            pivot_.reset();
        } else {
            turning_ = !pivot_; // there is nothing to go round in the sky
            session_.flight.remember();
        }
    }
    if (here && ImGui::IsMouseClicked(1)) {
        turning_ = true;
        session_.flight.remember();
    }
    if (!ImGui::IsMouseDown(0))
        pivot_.reset();
    if (!ImGui::IsMouseDown(0) && !ImGui::IsMouseDown(1))
        turning_ = false;
    const double dx = io.MouseDelta.x, dy = io.MouseDelta.y;
    const bool dragged = dx != 0.0 || dy != 0.0;
    if (pivot_ && dragged) {
        session_.flight.orbit(*pivot_, 0.3 * dx, 0.3 * dy);
        changed_ = moving_ = true;
    } else if (turning_ && dragged) {
        const double degrees_a_px = session_.flight.pose().fov_deg / io.DisplaySize.y;
        session_.flight.turn(dx * degrees_a_px, -dy * degrees_a_px);
        changed_ = moving_ = true;
    }
    moving_ |= pivot_.has_value() || turning_;
    if (here && io.MouseWheel != 0.0f) {
        session_.flight.zoom(point_at(x, y), double(io.MouseWheel));
        changed_ = moving_ = true;
    }
    pointer_x_ = x;
    pointer_y_ = y;
}

void App::read_pointer() {
    state_.pointer.reset();
    int w = 1, h = 1;
    glfwGetFramebufferSize(window_.get(), &w, &h);
    if (!(pointer_x_ >= 0.0 && pointer_x_ < 1.0 && pointer_y_ >= 0.0 && pointer_y_ < 1.0))
        return;
    const float distance = screen_.distance_at(pointer_x_, pointer_y_);
    state_.pointer_known = !std::isnan(distance);
    state_.pointer = read_place(session_.scene, session_.flight.pose().position,
                                scene::pixel_direction(camera_of(session_.flight.pose()),
                                                       pointer_x_ * w, pointer_y_ * h, w, h),
                                double(distance), bend_per_m(h));
    if (const auto& r = state_.pointer; r && r->seen_depth_m)
        log_.write(now_s() - started_s_, "depth read",
                   {{"depth_m", *r->depth_m},
                    {"seen_depth_m", *r->seen_depth_m},
                    {"apparent_depth_m", *r->apparent_depth_m}});
}

// Only that something goes on, and how far it is; Escape stops it.
bool App::show_progress(const std::string& what, double share) {
    glfwPollEvents();
    const bool stop = std::any_of(pressed_.begin(), pressed_.end(),
                                  [](const KeyPress& p) { return p.key == GLFW_KEY_ESCAPE; }) ||
                      glfwWindowShouldClose(window_.get());
    pressed_.clear();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::GetBackgroundDrawList()->AddImage(screen_image(), {0, 0}, size);
    ImGui::SetNextWindowPos({size.x / 2, size.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::Begin("##progress", nullptr,
                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoDecoration);
    ImGui::TextUnformatted((what + " - Escape stops it").c_str());
    ImGui::ProgressBar(float(share), {320 * scale_, 0});
    ImGui::End();
    show();
    return !stop;
}

ImTextureID App::screen_image() const {
    return reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(screen_.texture()));
}

void App::show() {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_.get(), &width, &height);
    ImGui::Render();
    glViewport(0, 0, width, height);
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    glfwSwapBuffers(window_.get());
}

// All samples of a picture or of a strip of it, by pieces, with the window alive in between.
// @return whether nobody has stopped it
bool App::draw_rows_of(const scene::View& view, double from_share, double to_share) {
    renderer_.prepare(view);
    const int height = view.settings.rows_drawn(), samples = view.settings.samples;
    const int rows = std::max(16, 300'000 / view.settings.width_px / 8 * 8);
    double shown_s = 0.0;
    for (int sample = 0; sample < samples; ++sample)
        for (int row = 0; row < height; row += rows) {
            renderer_.draw_rows(sample, samples, row, std::min(rows, height - row));
            if (now_s() - shown_s < 0.1)
                continue;
            glFinish();
            shown_s = now_s();
            const double share = (sample + double(row) / height) / samples;
            if (!show_progress("drawing the picture", from_share + share * (to_share - from_share)))
                return false;
        }
    return true;
}

void App::save_picture() {
    try {
        const Options options = session_.picture_options();
        const scene::View view = session_.services.make_view(options, session_.scene);
        const int height = view.settings.height_px, rows = scene::strip_rows(view.settings);
        const auto begin = [&](const Image& overview) {
            return session_.services.begin_picture(overview, session_.scene, view, options,
                                                   session_.picture_format);
        };
        std::unique_ptr<SavedPicture> file;
        bool stopped = false;
        if (rows < height) {
            stopped = !draw_rows_of(scene::overview_of(view), 0.0, 0.02);
            if (!stopped)
                file = begin(renderer_.read_back());
        }
        for (int first = 0; first < height && !stopped; first += rows) {
            scene::View part = view;
            if (rows < height)
                part.settings.strip = {first, std::min(rows, height - first)};
            stopped = !draw_rows_of(part, double(first) / height,
                                    std::min(1.0, double(first + rows) / height));
            if (!stopped) {
                const Image drawn = renderer_.read_back();
                if (!file)
                    file = begin(drawn);
                file->add(drawn);
            }
        }
        session_.say(stopped ? "no picture was saved" : "wrote " + file->finish());
    } catch (const std::exception& error) {
        session_.complain(error.what());
    }
    changed_ = true;
    last_s_ = now_s();
}

// What the view at rest needs, for as long as it is looked at.
void App::plan(int width, int height) {
    try {
        scene::View view = session_.unplanned_view();
        view.camera = camera_of(session_.flight.pose());
        view.settings.width_px = width;
        view.settings.height_px = height;
        view.settings.samples = 1; // as one flies
        const Planned plan = session_.services.plan(
            renderer_, session_.scene, view, session_.max_error,
            Progress([this](double share, const std::string&) {
                return show_progress("finding out what this view needs", share);
            }));
        session_.take_plan(plan);
        log_.write(now_s() - started_s_, "plan",
                   {{"speed_up", plan.speed_up}, {"reasons", double(plan.reasons.size())}});
    } catch (const Cancelled&) {
        session_.say("nothing was planned");
        session_.plan_at_rest = false;
    } catch (const std::exception& error) {
        session_.complain(error.what());
        session_.plan_at_rest = false;
    }
    changed_ = true;
    last_s_ = now_s();
}

void App::dropped(int count, const char** paths) {
    for (int i = 0; i < count; ++i) {
        const std::filesystem::path path = paths[i];
        std::string ending = path.extension().string();
        if (std::filesystem::is_directory(path) || ending == ".tif" || ending == ".tiff" ||
            ending == ".hgt") {
            next_ = path.string();
            glfwSetWindowShouldClose(window_.get(), GLFW_TRUE);
        } else {
            session_.add_layer(path.string(), state_.layer_in_space);
        }
    }
}

void App::log_frame(double began_s, bool first) {
    if (!log_.on())
        return;
    const double end = now_s(), t = end - started_s_;
    if (first)
        log_.write(t, "first picture", {{"start_ms", 1e3 * t}}, state_.device);
    log_.frame(t, 1e3 * (end - began_s), moving_);
    if (session_.levels() && session_.level_m() != logged_level_m_) {
        logged_level_m_ = session_.level_m();
        log_.write(t, "level",
                   {{"level_m", logged_level_m_},
                    {"refill_ms", session_.last_fill_ms()},
                    {"area_m2", session_.figures() ? session_.figures()->area_m2 : 0.0}});
    }
    if (was_moving_ && !moving_) {
        const Pose& p = session_.flight.pose();
        log_.write(t, "pose",
                   {{"x", p.position.x},
                    {"y", p.position.y},
                    {"z", p.position.z},
                    {"heading_deg", p.heading_deg},
                    {"pitch_deg", p.pitch_deg},
                    {"ground_m", session_.scene.ground.elevation_m(p.position.x, p.position.y)},
                    {"under_water", session_.scene.under_water(p.position) ? 1.0 : 0.0}});
    }
    for (const Message& m : session_.take_said())
        log_.write(t, m.error ? "complaint" : "message", {}, m.text);
    for (GLenum error = glGetError(); error != GL_NO_ERROR; error = glGetError())
        log_.write(t, "gl error", {{"code", double(error)}});
}

/// Heights, maps and cone maps that others have made go to the GPU.
void App::take_changes(double now) {
    if (session_.take_scene_changed()) {
        const double before = now_s();
        renderer_.scene_changed(!state_.level_dragged);
        glFinish();
        log_.write(now - started_s_, "upload", {{"ms", 1e3 * (now_s() - before)}});
        changed_ = true;
        level_s_ = now;
        if (cones_.busy()) // what is being made is of the level before
            cones_.start(session_.scene, renderer_.water_lift_m());
    }
    if (session_.take_map_changed()) {
        renderer_.map_changed();
        changed_ = true;
    }
    if (state_.level_dragged)
        moving_ = true;
    // Cone maps when the water has come to rest, and the first picture stands.
    const scene::Walk walk = session_.view.settings.walk;
    const bool cones_wanted =
        shown_once_ && (walk == scene::Walk::cone_map || walk == scene::Walk::cone_steps);
    if (cones_.deliver(renderer_, session_.scene))
        ; // the picture is the same, only faster from here on
    else if (cones_wanted && renderer_.needs_cone_maps() && !cones_.busy() && now - level_s_ > 0.3)
        cones_.start(session_.scene, renderer_.water_lift_m());
}

/// @return whether the screen shows something new
bool App::draw(bool time_passes, double now, int width, int height, double seconds) {
    if (moving_)
        moved_s_ = now;
    if (time_passes) {
        scene::View view = view_now();
        view.settings.width_px = width;
        view.settings.height_px = height;
        state_.pass_ms = screen_.time_passes(view);
    }
    if (changed_)
        screen_.changed();
    std::optional<double> exposure;
    if (const double fixed_exposure = session_.number("exposure", 0.0); fixed_exposure > 0.0)
        exposure = fixed_exposure;
    return screen_.update(view_now(), session_.scene, width, height, now - moved_s_ < 0.15,
                          exposure, seconds);
}

void App::frame() {
    int width = 0, height = 0;
    // Nothing to draw and nobody there: wait for somebody.
    const bool hidden = glfwGetWindowAttrib(window_.get(), GLFW_ICONIFIED) != 0;
    if (hidden || (idle_frames_ > 3 && !session_.opening_levels() && !cones_.busy()))
        glfwWaitEventsTimeout(hidden ? 0.2 : 0.1);
    else
        glfwPollEvents();
    glfwGetFramebufferSize(window_.get(), &width, &height);
    const double now = now_s();
    const double seconds = std::clamp(now - last_s_, 0.0, 0.25);
    last_s_ = now;
    if (width < 1 || height < 1 || hidden) {
        session_.advance(seconds);
        return;
    }
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    moving_ = false;
    keys(seconds);
    pressed_.clear();
    mouse();
    changed_ |= session_.advance(seconds);
    moving_ |= session_.play_sun || (session_.play_waves && !session_.view.waves.calm());
    const Requests asked = draw_panels(session_, screen_, state_, scale_);
    changed_ |= asked.view_changed;
    save_asked_ |= asked.save_picture;
    if (!asked.open.empty()) {
        if (std::filesystem::exists(asked.open)) {
            next_ = asked.open;
            glfwSetWindowShouldClose(window_.get(), GLFW_TRUE);
        } else {
            session_.complain(asked.open + ": no such scene or file");
        }
    }
    bool drawn = false;
    try {
        take_changes(now);
        drawn = draw(asked.time_passes, now, width, height, seconds);
    } catch (const std::exception& error) {
        session_.complain(error.what());
    }
    changed_ = false;
    if (drawn || ImGui::GetIO().MouseDelta.x != 0.0f || ImGui::GetIO().MouseDelta.y != 0.0f)
        read_pointer();
    if (drawn)
        state_.labels = find_labels(session_, screen_);
    const bool settled = screen_.finished() && !moving_ && session_.messages.empty();
    idle_frames_ = settled && !ImGui::IsAnyItemActive() ? idle_frames_ + 1 : 0;

    ImGui::GetBackgroundDrawList()->AddImage(screen_image(), {0, 0}, ImGui::GetIO().DisplaySize);
    draw_overlay(session_, state_, scale_);
    show();
    const bool first = drawn && !shown_once_;
    if (first) {
        shown_once_ = true;
        session_.open_levels(); // until here the cores had enough to do
    }
    log_frame(now, first);
    was_moving_ = moving_;
    if (std::exchange(save_asked_, false)) // between two frames
        save_picture();
    if (pose_ != session_.flight.pose()) { // the camera's rest: water may go on moving
        pose_ = session_.flight.pose();
        pose_s_ = now;
    }
    const bool rests = session_.plan_at_rest && shown_once_ && now - pose_s_ > 1.0 &&
                       now - level_s_ > 1.0 && session_.planned_for != pose_;
    if (asked.plan || rests)
        plan(width, height);
    frames_ += 1.0;
    if (now - frames_since_s_ > 1.0) {
        state_.frames_per_s = frames_ / (now - frames_since_s_);
        frames_ = 0.0;
        frames_since_s_ = now;
    }
}

} // namespace

std::optional<std::string> run_window(scene::Scene& scene, const Services& services,
                                      const Options& options, const WindowSettings& settings) {
    App app(scene, services, options, settings);
    return app.run();
}

} // namespace tarn::view
