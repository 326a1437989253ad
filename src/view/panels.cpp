#include "view/panels.hpp"

#include "core/text.hpp"
#include "geo/frame.hpp"
#include "scene/water_types.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <imgui.h>

namespace tarn::view {

namespace {

std::string area_words(double m2) {
    return m2 >= 1e5 ? fixed(m2 / 1e6, 3) + " km2" : fixed(m2, 0) + " m2";
}

std::string volume_words(double m3) {
    return m3 >= 1e9 ? fixed(m3 / 1e9, 4) + " km3" : fixed(m3 / 1e6, 3) + " million m3";
}

/// A slider of an option that has a number. @return whether it was moved
bool number_slider(Session& session, const char* label, const char* option, double usual,
                   float least, float most, const char* format, bool logarithmic = false) {
    auto value = static_cast<float>(session.number(option, usual));
    if (!ImGui::SliderFloat(label, &value, least, most, format,
                            logarithmic ? ImGuiSliderFlags_Logarithmic : 0))
        return false;
    return session.set(option, text(value));
}

/// A box that is ticked unless the option --no-... is given.
bool effect_box(Session& session, const char* label, const char* option) {
    bool on = !session.flag(option);
    if (!ImGui::Checkbox(label, &on))
        return false;
    return session.set(option, on ? "" : "true");
}

bool choice(Session& session, const char* label, const char* option,
            const std::vector<std::string>& names, const std::string& usual) {
    const std::string now = session.option(option, usual);
    bool changed = false;
    if (ImGui::BeginCombo(label, now.c_str())) {
        for (const std::string& name : names)
            if (ImGui::Selectable(name.c_str(), name == now))
                changed |= session.set(option, name == usual ? "" : name);
        ImGui::EndCombo();
    }
    return changed;
}

/// Area or volume over the level.
void plot_curve(const Session& session, bool volume) {
    const auto& curve = session.curve();
    if (curve.empty() || (volume && !curve.front().volume_m3))
        return;
    std::vector<float> values;
    for (const Figures& f : curve)
        values.push_back(float(volume ? *f.volume_m3 / 1e6 : f.area_m2 / 1e6));
    const auto& now = *session.figures();
    const float most = *std::max_element(values.begin(), values.end());
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const ImVec2 size(ImGui::GetContentRegionAvail().x, 64.0f * ImGui::GetFontSize() / 15.0f);
    const std::string over =
        volume ? "volume " + volume_words(*now.volume_m3) : "area " + area_words(now.area_m2);
    ImGui::PlotLines(volume ? "##volume" : "##area", values.data(), int(values.size()), 0,
                     over.c_str(), 0.0f, most, size);
    // Where the level is now, and where it spills.
    const double low = curve.front().level_m, high = curve.back().level_m;
    const auto line = [&](double level, ImU32 colour) {
        if (level < low || level > high)
            return;
        const float x = at.x + size.x * float((level - low) / std::max(high - low, 1e-9));
        ImGui::GetWindowDrawList()->AddLine({x, at.y}, {x, at.y + size.y}, colour, 1.5f);
    };
    if (session.levels() && session.levels()->spill_m())
        line(*session.levels()->spill_m(), IM_COL32(230, 90, 70, 220));
    line(session.level_m(), IM_COL32(255, 220, 120, 255));
}

void water_panel(Session& session, PanelState& state) {
    if (!session.levels()) {
        ImGui::TextDisabled("following the water, a moment ...");
        ImGui::Text("level %.2f m", session.level_m());
        return;
    }
    LevelControl& levels = *session.levels();
    const double top =
        session.curve().empty() ? levels.highest_m() : session.curve().back().level_m;
    auto level = static_cast<float>(session.level_m());
    ImGui::SetNextItemWidth(-1.0f);
    const bool moved = ImGui::SliderFloat("##level", &level, float(levels.lowest_m()), float(top),
                                          "level %.2f m", ImGuiSliderFlags_NoRoundToFormat);
    const bool done = ImGui::IsItemDeactivatedAfterEdit();
    if (moved || done)
        session.set_level(std::round(double(level) * 100.0) / 100.0, done);
    state.level_dragged = moved && !done;
    const auto step = [&](const char* label, double by) {
        if (ImGui::Button(label))
            session.set_level(std::round((session.level_m() + by) * 100.0) / 100.0, true);
        ImGui::SameLine();
    };
    step("-1 m", -1.0);
    step("-.1", -0.1);
    step("+.1", 0.1);
    step("+1 m", 1.0);
    if (ImGui::Button("as imported"))
        session.set_level(levels.usual_m(), true);
    if (session.figures()) {
        const Figures& f = *session.figures();
        ImGui::Text("area %s", area_words(f.area_m2).c_str());
        if (f.volume_m3)
            ImGui::Text("volume %s, depth %.2f m", volume_words(*f.volume_m3).c_str(),
                        f.max_depth_m.value_or(0.0));
        else
            ImGui::TextDisabled("bed unknown: no volume, no depth");
        if (levels.spill_m() && f.open_at_edge)
            ImGui::TextColored({1.0f, 0.5f, 0.4f, 1.0f},
                               "spills: above %.2f m water leaves the data", *levels.spill_m());
        else if (levels.spill_m())
            ImGui::TextDisabled("may rise to %.2f m", *levels.spill_m());
        plot_curve(session, false);
        plot_curve(session, true);
        if (!session.curve().empty())
            ImGui::TextDisabled("over %.0f to %.0f m; yellow: now, red: spills",
                                session.curve().front().level_m, session.curve().back().level_m);
    }
    if (session.last_fill_ms() > 0.0)
        ImGui::TextDisabled("refilled in %.0f ms", session.last_fill_ms());
}

bool sun_panel(Session& session, PanelState& state) {
    bool changed = false;
    const bool by_hand = !session.option("sun").empty() || !session.option("environment").empty();
    if (by_hand) {
        ImGui::TextWrapped("The sun is given by --sun or --environment.");
        if (ImGui::Button("by date and time instead"))
            changed |=
                session.set(Options{{"sun", ""}, {"environment", ""}, {"environment-turn", ""}});
    } else if (const auto time = parse_solar(session.option("time"));
               time || session.option("time").empty()) {
        SolarTime now = time.value_or(session.usual_time());
        auto hour = static_cast<float>(now.hour);
        const std::string words = format_solar(now);
        if (ImGui::SliderFloat("time", &hour, 0.0f, 23.98f, words.substr(11).c_str())) {
            now.hour = hour;
            changed |= session.set("time", format_solar(now));
        }
        if (ImGui::SliderInt("date", &now.day, 1, 365, words.substr(0, 10).c_str()))
            changed |= session.set("time", format_solar(now));
        ImGui::TextDisabled("mean solar time %s",
                            session.option("sun-place").empty() ? "at the lake" : "at that place");
        ImGui::Checkbox("play", &session.play_sun);
        if (!ImGui::IsAnyItemActive())
            std::snprintf(state.sun_place, sizeof state.sun_place, "%s",
                          session.option("sun-place").c_str());
        if (ImGui::InputTextWithHint("place", "LAT,LON; empty: the lake", state.sun_place,
                                     sizeof state.sun_place, ImGuiInputTextFlags_EnterReturnsTrue))
            changed |= session.set("sun-place", state.sun_place);
    } else {
        ImGui::Text("%s", session.option("time").c_str());
        if (ImGui::Button("in solar time instead"))
            changed |= session.set("time", format_solar(session.usual_time()));
    }
    const glm::dvec3& s = session.view.lighting.sun_direction;
    ImGui::Text("sun %.1f deg high", std::asin(std::clamp(s.z, -1.0, 1.0)) * 57.29578);
    bool haze = !session.option("visibility").empty();
    if (ImGui::Checkbox("haze", &haze))
        changed |= session.set("visibility", haze ? "30" : "");
    if (haze)
        changed |=
            number_slider(session, "visibility", "visibility", 30.0, 0.5f, 200.0f, "%.1f km", true);
    return changed;
}

bool wind_panel(Session& session) {
    bool changed = false;
    auto wind =
        static_cast<float>(session.view.waves.calm() ? 0.0 : session.view.waves.wind_m_per_s);
    ImGui::SliderFloat("wind", &wind, 0.0f, 20.0f, "%.1f m/s");
    if (ImGui::IsItemDeactivatedAfterEdit()) // a new sea takes a moment
        changed |=
            wind < 0.3f
                ? session.set(Options{{"wind", ""}, {"waves", "calm"}})
                : session.set(Options{{"wind", text(std::round(wind * 10) / 10)}, {"waves", ""}});
    auto from = static_cast<float>(session.number("wind-from", 270.0));
    ImGui::SliderFloat("from", &from, 0.0f, 360.0f, "%.0f deg");
    if (ImGui::IsItemDeactivatedAfterEdit())
        changed |= session.set("wind-from", fixed(from, 0));
    ImGui::Checkbox("moving water", &session.play_waves);
    if (!session.view.waves.calm() && !session.play_waves)
        changed |= number_slider(session, "moment", "wave-time", 0.0, 0.0f, 60.0f, "%.1f s");
    return changed;
}

bool clarity_panel(Session& session) {
    // One way of describing the water takes the place of all others.
    const auto only = [](const std::string& option, const std::string& value) {
        Options out = {{"secchi", ""},
                       {"water", ""},
                       {"water-table", ""},
                       {"chlorophyll", ""},
                       {"cdom", ""},
                       {"turbidity", ""},
                       {"absorption-per-m", ""},
                       {"backscattering-per-m", ""}};
        if (!option.empty())
            out[option] = value;
        return out;
    };
    bool changed = false;
    const bool by_type = !session.option("water").empty();
    auto secchi = static_cast<float>(session.number("secchi", 14.0));
    if (ImGui::SliderFloat("Secchi depth", &secchi, 0.3f, 45.0f, by_type ? "-" : "%.1f m",
                           ImGuiSliderFlags_Logarithmic))
        changed |= session.set(only("secchi", fixed(secchi, 2)));
    const std::string now = session.option(
        "water", session.option("secchi").empty() ? "as the scene says" : "by Secchi depth");
    if (ImGui::BeginCombo("type", now.c_str())) {
        if (ImGui::Selectable("as the scene says"))
            changed |= session.set(only("", ""));
        for (const std::string& name : scene::water_type_names())
            if (ImGui::Selectable(name.c_str(), name == now))
                changed |= session.set(only("water", name));
        ImGui::EndCombo();
    }
    ImGui::TextDisabled("%s", session.scene.optics.name.c_str());
    changed |= number_slider(session, "dive light", "dive-light", 0.0, 0.0f, 50000.0f, "%.0f cd");
    return changed;
}

bool effects_panel(Session& session, PanelState& state, Requests& asked) {
    bool changed = false;
    changed |= effect_box(session, "reflection", "no-reflection");
    ImGui::SameLine();
    changed |= effect_box(session, "refraction", "no-refraction");
    ImGui::SameLine();
    changed |= effect_box(session, "shadows", "no-shadows");
    std::vector<std::string> names;
    for (const scene::CausticsMethod& m : scene::caustics_methods())
        names.emplace_back(m.name);
    changed |= choice(session, "caustics", "caustics", names, "splat");
    auto steps = int(session.number("shaft-steps", 2));
    if (ImGui::SliderInt("shafts of light", &steps, 0, 16, steps == 0 ? "off" : "%d"))
        changed |= session.set("shaft-steps", steps == 2 ? "" : text(steps));
    names.clear();
    for (const scene::WalkMethod& m : scene::walk_methods())
        names.emplace_back(m.name);
    changed |= choice(session, "intersection", "intersection", names, "cone-map");
    changed |= choice(session, "colour", "colour", {"spectral", "rgb"}, "spectral");
    auto samples = int(session.number("samples", 4));
    if (ImGui::SliderInt("samples", &samples, 1, 64))
        changed |= session.set("samples", text(samples));
    if (ImGui::Button("time each pass"))
        asked.time_passes = true;
    if (!state.pass_ms.empty()) {
        double sum = 0.0;
        for (const auto& [name, ms] : state.pass_ms) {
            ImGui::Text("%8.2f ms  %s", ms, name.c_str());
            sum += ms;
        }
        ImGui::Text("%8.2f ms  one sample", sum);
    }
    return changed;
}

bool planner_panel(Session& session, Requests& asked) {
    auto percent = float(100.0 * session.max_error);
    if (const auto ms = session.services.frame_time_ms)
        ImGui::Text("as true as %.3g ms a picture allow", *ms);
    else if (ImGui::SliderFloat("error", &percent, 0.1f, 10.0f, "at most %.1f %%",
                                ImGuiSliderFlags_Logarithmic))
        session.max_error = 0.01 * double(percent);
    asked.plan = ImGui::Button("plan this view");
    ImGui::SameLine();
    const bool dropped = ImGui::Button("draw everything");
    if (dropped)
        session.drop_plan();
    ImGui::Checkbox("again where the camera rests", &session.plan_at_rest);
    if (session.reasons.empty())
        ImGui::TextWrapped("Leaves out what this view does not show, by trials on a sample of it.");
    for (const std::string& reason : session.reasons)
        ImGui::TextWrapped("%s", reason.c_str());
    return dropped;
}

bool exposure_panel(Session& session, const Screen& screen) {
    bool changed = false;
    bool automatic = session.option("exposure").empty();
    if (ImGui::Checkbox("automatic", &automatic))
        changed |= session.set("exposure", automatic ? "" : text(float(screen.exposure())));
    if (!automatic)
        changed |= number_slider(session, "exposure", "exposure", screen.exposure(), 0.05f, 500.0f,
                                 "%.2f", true);
    else
        ImGui::Text("factor %.2f", screen.exposure());
    return changed;
}

/// @return whether the camera is another one now
bool camera_panel(Session& session, PanelState& state) {
    bool changed = false;
    for (const scene::NamedCamera& c : session.scene.cameras) {
        if (ImGui::Button(c.name.c_str()))
            session.go_to(c.name);
        if (ImGui::BeginPopupContextItem()) {
            if (ImGui::MenuItem("remove")) {
                session.remove_bookmark(c.name);
                ImGui::EndPopup();
                break; // the list is another one now
            }
            ImGui::EndPopup();
        }
        const float next = ImGui::GetItemRectMax().x + 90.0f;
        if (next < ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x)
            ImGui::SameLine();
    }
    ImGui::NewLine();
    ImGui::SetNextItemWidth(-70.0f * ImGui::GetFontSize() / 15.0f);
    ImGui::InputTextWithHint("##name", "name", state.bookmark, sizeof state.bookmark);
    ImGui::SameLine();
    if (ImGui::Button("keep")) {
        session.add_bookmark(state.bookmark);
        state.bookmark[0] = '\0';
    }
    Pose pose = session.flight.pose();
    auto fov = static_cast<float>(pose.fov_deg);
    if (ImGui::SliderFloat("field of view", &fov, 10.0f, 100.0f, "%.0f deg")) {
        pose.fov_deg = fov;
        session.flight.jump(pose);
        changed = true;
    }
    if (ImGui::Button("copy as recording")) {
        try {
            ImGui::SetClipboardText(session.services.record_command(session.all_options()).c_str());
            session.say("a command that records a way through all cameras is on the clipboard");
        } catch (const std::exception& error) {
            session.complain(error.what());
        }
    }
    ImGui::SameLine();
    if (ImGui::Button("undo"))
        changed |= session.flight.undo();
    ImGui::SameLine();
    if (ImGui::Button("redo"))
        changed |= session.flight.redo();
    return changed;
}

/// A length that may be left out: a box and a field.
bool optional_length(Session& session, const char* label, const char* option, float usual) {
    bool on = !session.option(option).empty();
    bool changed = false;
    if (ImGui::Checkbox(label, &on))
        changed |= session.set(option, on ? text(usual) : "");
    if (on) {
        ImGui::SameLine(0.45f * ImGui::GetWindowWidth());
        ImGui::SetNextItemWidth(-1.0f);
        auto value = static_cast<float>(session.number(option, usual));
        if (ImGui::DragFloat((std::string("##") + option).c_str(), &value, 0.02f * value, 0.05f,
                             5000.0f, "%.4g m") &&
            value > 0.01f)
            changed |= session.set(option, text(value));
    }
    return changed;
}

bool map_panel(Session& session) {
    const LakeRecord& lake = session.scene.lakes.front();
    const auto depth = static_cast<float>(lake.max_depth_m.value_or(50.0));
    bool changed = optional_length(
        session, "contours", "contours",
        float(round_length(std::max(session.scene.ground.upper_bound_m() - lake.level_m, 2.0) /
                           20.0)));
    changed |= optional_length(session, "depth contours", "depth-contours",
                               float(round_length(std::max(double(depth), 0.5) / 10.0)));
    changed |= optional_length(session, "depth colours", "depth-colours", std::ceil(depth));
    return changed;
}

void measure_panel(Session& session, PanelState& state, Requests& asked) {
    int kind = int(session.measuring);
    ImGui::RadioButton("off", &kind, 0);
    ImGui::SameLine();
    ImGui::RadioButton("line", &kind, 1);
    ImGui::SameLine();
    ImGui::RadioButton("polygon", &kind, 2);
    if (kind != int(session.measuring)) {
        session.measuring = Session::Measuring(kind);
        session.measured.clear();
    }
    if (session.measuring != Session::Measuring::off) {
        ImGui::TextDisabled("click to set points, Backspace takes one back");
        const double length = length_m(session.scene, session.measured);
        ImGui::Text("length %s", length >= 1000 ? (fixed(length / 1000, 3) + " km").c_str()
                                                : (fixed(length, 2) + " m").c_str());
        if (session.measuring == Session::Measuring::polygon)
            ImGui::Text("area %s", area_words(area_m2(session.scene, session.measured)).c_str());
    }
    ImGui::SetNextItemWidth(-70.0f * ImGui::GetFontSize() / 15.0f);
    ImGui::InputTextWithHint("##layer", "GeoJSON, GeoPackage, GPX, ...", state.layer,
                             sizeof state.layer);
    ImGui::SameLine();
    if (ImGui::Button("add") && state.layer[0] != '\0')
        session.add_layer(state.layer, state.layer_in_space);
    ImGui::Checkbox("in space, at its own heights", &state.layer_in_space);
    const bool in_space = std::any_of(session.layers.begin(), session.layers.end(),
                                      [](const auto& layer) { return layer.heights.has_value(); });
    if (in_space || state.layer_in_space) {
        static const char* from[] = {"datum", "level", "ground"};
        const std::string now = session.option("layers-3d-heights", "datum");
        if (ImGui::BeginCombo("heights from", now.c_str())) {
            for (const char* words : from)
                if (ImGui::Selectable(words, now == words))
                    session.count_heights_from(words);
            ImGui::EndCombo();
        }
    }
    if (!session.layers.empty() &&
        choice(session, "show", "layers-on", {"all", "dry", "flooded"}, "all"))
        asked.view_changed = true;
    for (std::size_t i = 0; i < session.layers.size(); ++i) {
        ImGui::BulletText("%s%s", session.layers[i].name.c_str(),
                          session.layers[i].heights ? " (in space)" : "");
        ImGui::SameLine();
        if (ImGui::SmallButton(text("remove##", i).c_str())) {
            session.remove_layer(i);
            break;
        }
    }
}

void picture_panel(Session& session, Requests& asked) {
    int size[2] = {session.picture_width_px, session.picture_height_px};
    if (ImGui::InputInt2("size", size)) {
        session.picture_width_px = std::clamp(size[0], 1, 16384);
        session.picture_height_px = std::clamp(size[1], 1, 16384);
    }
    ImGui::SliderInt("rays a pixel", &session.picture_samples, 1, 256);
    bool caption = session.flag("caption");
    if (ImGui::Checkbox("caption", &caption))
        session.set("caption", caption ? "true" : "");
    ImGui::SameLine();
    bool labels = session.flag("labels");
    if (ImGui::Checkbox("names", &labels))
        session.set("labels", labels ? "true" : "");
    for (const char* format : {"png", "exr"}) {
        if (ImGui::RadioButton(format, session.picture_format == format))
            session.picture_format = format;
        ImGui::SameLine();
    }
    if (ImGui::Button("save (F12)"))
        asked.save_picture = true;
    if (ImGui::Button("copy as command")) {
        ImGui::SetClipboardText(session.picture_command().c_str());
        session.say("the command that makes this picture is on the clipboard");
    }
}

} // namespace

Requests draw_panels(Session& session, const Screen& screen, PanelState& state, float scale) {
    Requests asked;
    state.level_dragged = false;
    if (!state.shown)
        return asked;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({8 * scale, 8 * scale}, ImGuiCond_Once);
    ImGui::SetNextWindowSize({330 * scale, size.y - 50 * scale}, ImGuiCond_Once);
    ImGui::SetNextWindowSizeConstraints({200 * scale, 100 * scale},
                                        {size.x, std::max(110 * scale, size.y - 50 * scale)});
    const LakeRecord& lake = session.scene.lakes.front();
    const std::string title = (lake.name.empty() ? std::string("tarn") : lake.name) + "###panel";
    if (ImGui::Begin(title.c_str(), &state.shown, ImGuiWindowFlags_NoSavedSettings)) {
        ImGui::PushItemWidth(-110 * scale);
        const auto section = [](const char* name, bool open) {
            return ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
        };
        if (section("Water level", true))
            water_panel(session, state);
        if (section("Sun and air", true))
            asked.view_changed |= sun_panel(session, state);
        if (section("Wind and waves", false))
            asked.view_changed |= wind_panel(session);
        if (section("Clarity", false))
            asked.view_changed |= clarity_panel(session);
        if (section("Cameras", false))
            asked.view_changed |= camera_panel(session, state);
        if (section("Measure, layers", false))
            measure_panel(session, state, asked);
        if (section("Map", false))
            asked.view_changed |= map_panel(session);
        if (section("Effects and methods", false))
            asked.view_changed |= effects_panel(session, state, asked);
        if (section("No more than it needs", false))
            asked.view_changed |= planner_panel(session, asked);
        if (section("Exposure", false))
            asked.view_changed |= exposure_panel(session, screen);
        if (section("Picture", false))
            picture_panel(session, asked);
        if (section("Another scene", false)) {
            ImGui::SetNextItemWidth(-70 * scale);
            ImGui::InputTextWithHint("##open", "scene folder or DEM", state.open,
                                     sizeof state.open);
            ImGui::SameLine();
            if (ImGui::Button("open"))
                asked.open = state.open;
        }
        ImGui::Separator();
        ImGui::TextDisabled("%s", state.device.c_str());
        ImGui::TextDisabled("%.0f/s, %.0f %% of the pixels, %d samples", state.frames_per_s,
                            100.0 * screen.scale() * screen.scale(), screen.samples_done());
        ImGui::TextDisabled("F1: keys");
        ImGui::PopItemWidth();
    }
    ImGui::End();
    return asked;
}

void set_style(float scale) {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 5.0f;
    style.FrameRounding = 3.0f;
    style.GrabRounding = 3.0f;
    style.Colors[ImGuiCol_WindowBg] = {0.06f, 0.08f, 0.10f, 0.88f};
    style.Colors[ImGuiCol_TitleBgActive] = {0.10f, 0.24f, 0.32f, 1.0f};
    style.Colors[ImGuiCol_Header] = {0.14f, 0.30f, 0.38f, 0.80f};
    style.Colors[ImGuiCol_SliderGrab] = {0.40f, 0.70f, 0.80f, 1.0f};
    style.Colors[ImGuiCol_PlotLines] = {0.55f, 0.80f, 0.90f, 1.0f};
    style.ScaleAllSizes(scale);
}

} // namespace tarn::view
