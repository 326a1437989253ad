#include "view/overlay.hpp"

#include "core/text.hpp"
#include "geo/frame.hpp"
#include "scene/curvature.hpp"
#include "scene/labels.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <imgui.h>
#include <optional>

namespace tarn::view {

namespace {

/// Where a place of the scene is on the screen, if it is before the camera.
std::optional<ImVec2> on_screen(const scene::Camera& c, const glm::dvec3& place, ImVec2 size) {
    glm::dvec3 to = place - c.position;
    to.z -= scene::bend_per_m * (to.x * to.x + to.y * to.y); // nothing, but far away
    const auto at = scene::picture_place(c, to, double(size.x) / double(size.y));
    if (!at)
        return std::nullopt;
    return ImVec2(size.x * float(at->x), size.y * float(at->y));
}

void draw_north(const Session& session, ImVec2 middle, float radius) {
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    const Pose& pose = session.flight.pose();
    const double convergence_deg =
        geo::convergence_deg(session.scene.frame, {pose.position.x, pose.position.y});
    const double a = -(pose.heading_deg + convergence_deg) * 0.017453292519943295;
    const ImVec2 tip(middle.x + radius * float(std::sin(a)),
                     middle.y - radius * float(std::cos(a)));
    const ImVec2 left(middle.x - 0.35f * radius * float(std::cos(a)),
                      middle.y - 0.35f * radius * float(std::sin(a)));
    const ImVec2 right(2 * middle.x - left.x, 2 * middle.y - left.y);
    const ImVec2 tail(2 * middle.x - tip.x, 2 * middle.y - tip.y);
    list.AddCircleFilled(middle, radius * 1.15f, IM_COL32(0, 0, 0, 90), 32);
    list.AddTriangleFilled(tip, left, right, IM_COL32(225, 80, 70, 255));
    list.AddTriangleFilled(tail, left, right, IM_COL32(235, 235, 235, 255));
    list.AddText({middle.x - 4, middle.y - radius * 1.15f - ImGui::GetFontSize()},
                 IM_COL32(255, 255, 255, 255), "N");
}

void draw_scale(const PanelState& state, const Session& session, ImVec2 size, float scale) {
    // At what the pointer is on, else there is none.
    if (!state.pointer)
        return;
    const double metre_px = 1.0 / (scene::pixel_rad(camera_of(session.flight.pose()), int(size.y)) *
                                   state.pointer->distance_m);
    const double length = round_length(160.0 * double(scale) / metre_px);
    const auto px = float(length * metre_px);
    const ImVec2 end(size.x - 20 * scale, size.y - 44 * scale);
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    list.AddRectFilled({end.x - px - 1, end.y - 5}, {end.x + 1, end.y + 1}, IM_COL32(0, 0, 0, 160));
    list.AddRectFilled({end.x - px, end.y - 4}, end, IM_COL32(255, 255, 255, 255));
    const std::string words = length_words(length) + " at the pointer";
    list.AddText({end.x - ImGui::CalcTextSize(words.c_str()).x, end.y - 8 - ImGui::GetFontSize()},
                 IM_COL32(255, 255, 255, 255), words.c_str());
}

void draw_gauge(const Session& session, ImVec2 size, float scale) {
    const glm::dvec3& p = session.flight.pose().position;
    const auto level = session.scene.water_level_m(p.x, p.y);
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    std::string words;
    if (level && p.z < *level)
        words = fixed(*level - p.z, 2) + " m deep, bed " +
                fixed(p.z - session.scene.ground.elevation_m(p.x, p.y), 1) + " m below";
    else
        words = fixed(p.z, 1) + " m, " +
                fixed(p.z - level.value_or(session.scene.ground.elevation_m(p.x, p.y)), 1) +
                (level ? " m above the water" : " m above the ground");
    const ImVec2 extent = ImGui::CalcTextSize(words.c_str());
    const ImVec2 at(size.x - extent.x - 20 * scale, 14 * scale);
    list.AddRectFilled({at.x - 6, at.y - 3}, {at.x + extent.x + 6, at.y + extent.y + 3},
                       IM_COL32(0, 0, 0, 110), 4.0f);
    list.AddText(at, IM_COL32(255, 255, 255, 255), words.c_str());
    if (level && p.z < *level) { // a bar from the surface down to the bed, with where one is
        const double bed = session.scene.ground.elevation_m(p.x, p.y);
        const double share = (*level - p.z) / std::max(*level - bed, 0.01);
        const float x = size.x - 28 * scale, top = 120 * scale, bottom = size.y - 120 * scale;
        list.AddRectFilled({x - 3, top}, {x + 3, bottom}, IM_COL32(20, 60, 90, 160));
        const float y = top + (bottom - top) * float(std::clamp(share, 0.0, 1.0));
        list.AddTriangleFilled({x - 12, y - 6}, {x - 12, y + 6}, {x - 2, y},
                               IM_COL32(255, 230, 140, 255));
        list.AddText({x - 24, top - ImGui::GetFontSize() - 2}, IM_COL32(255, 255, 255, 255), "0 m");
        const std::string deepest = fixed(*level - bed, 1) + " m";
        list.AddText({x - 24, bottom + 2}, IM_COL32(255, 255, 255, 255), deepest.c_str());
    }
}

void draw_measured(Session& session, ImVec2 size) {
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    const scene::Camera camera = camera_of(session.flight.pose());
    std::vector<glm::dvec3> places = session.measured;
    if (session.measuring == Session::Measuring::polygon && places.size() > 2)
        places.push_back(places.front());
    std::optional<ImVec2> last;
    for (const glm::dvec3& place : places) {
        const auto here = on_screen(camera, place, size);
        if (here) {
            list.AddCircleFilled(*here, 4.0f, IM_COL32(255, 210, 90, 255));
            if (last)
                list.AddLine(*last, *here, IM_COL32(255, 210, 90, 230), 2.0f);
        }
        last = here;
    }
}

void draw_labels(const PanelState& state) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (const Label& label : state.labels) {
        const ImVec2 at(label.x + 5, label.y - ImGui::GetFontSize() - 1);
        list.AddText({at.x + 1, at.y + 1}, IM_COL32(0, 0, 0, 200), label.text.c_str());
        list.AddText(at, IM_COL32(255, 255, 255, 255), label.text.c_str());
    }
}

void draw_messages(Session& session, ImVec2 size, float scale) {
    float y = size.y - 70 * scale;
    for (auto m = session.messages.rbegin(); m != session.messages.rend(); ++m) {
        const float wrap = std::min(size.x * 0.6f, 700 * scale);
        const ImVec2 extent = ImGui::CalcTextSize(m->text.c_str(), nullptr, false, wrap);
        y -= extent.y + 14;
        const ImVec2 at((size.x - extent.x) / 2, y);
        ImDrawList& list = *ImGui::GetForegroundDrawList();
        list.AddRectFilled({at.x - 10, at.y - 5}, {at.x + extent.x + 10, at.y + extent.y + 5},
                           m->error ? IM_COL32(120, 30, 25, 225) : IM_COL32(20, 30, 40, 200), 6.0f);
        list.AddText(ImGui::GetFont(), ImGui::GetFontSize(), at, IM_COL32(255, 255, 255, 255),
                     m->text.c_str(), nullptr, wrap);
    }
}

void draw_help(bool& open) {
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing,
                            {0.5f, 0.5f});
    if (ImGui::Begin("Keys and mouse", &open,
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse |
                         ImGuiWindowFlags_NoSavedSettings)) {
        static const char* keys[][2] = {{"W A S D", "fly forward, left, back, right"},
                                        {"E / Q, Page up / down", "up, down"},
                                        {"Shift / Ctrl", "four times as fast / a quarter"},
                                        {"left button", "go round the point under the pointer"},
                                        {"right button", "look around"},
                                        {"wheel", "nearer, farther"},
                                        {"double click", "fly to a point"},
                                        {"1 ... 9", "cameras of the scene"},
                                        {"Ctrl Z / Ctrl Y", "take back a movement / do it again"},
                                        {"[ / ]", "water down, up by .1 m (Shift: 1 m)"},
                                        {"Space", "water moves or stands still"},
                                        {"Tab", "panel on, off"},
                                        {"F1", "these keys"},
                                        {"F12", "save a picture"},
                                        {"Ctrl C", "copy as command"},
                                        {"Ctrl Q", "close"},
                                        {"Esc", "leave off measuring"}};
        if (ImGui::BeginTable("keys", 2)) {
            for (const auto& row : keys) {
                ImGui::TableNextRow();
                ImGui::TableNextColumn();
                ImGui::TextUnformatted(row[0]);
                ImGui::TableNextColumn();
                ImGui::TextUnformatted(row[1]);
            }
            ImGui::EndTable();
        }
    }
    ImGui::End();
}

} // namespace

void draw_overlay(Session& session, PanelState& state, float scale) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    draw_labels(state);
    draw_north(session, {size.x - 44 * scale, 70 * scale}, 18 * scale);
    draw_scale(state, session, size, scale);
    draw_gauge(session, size, scale);
    draw_measured(session, size);
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    list.AddRectFilled({0, size.y - 26 * scale}, size, IM_COL32(0, 0, 0, 150));
    const std::string words = state.pointer         ? describe(*state.pointer)
                              : state.pointer_known ? std::string("sky")
                                                    : std::string("...");
    list.AddText({10 * scale, size.y - 22 * scale}, IM_COL32(255, 255, 255, 255), words.c_str());
    draw_messages(session, size, scale);
    if (state.help)
        draw_help(state.help);
}

std::vector<Label> find_labels(const Session& session, const Screen& screen) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    std::vector<Label> out;
    for (const scene::ShownLabel& label :
         scene::shown_labels(session.scene, camera_of(session.flight.pose()),
                             double(size.x) / double(size.y), session.view.settings.drape_on,
                             [&](double x, double y) { return double(screen.distance_at(x, y)); }))
        out.push_back({size.x * float(label.x), size.y * float(label.y), label.text});
    return out;
}

} // namespace tarn::view
