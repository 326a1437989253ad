#include "bench/effects.hpp"

#include "core/text.hpp"
#include "scene/presets.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tarn::bench {

namespace {

using scene::Caustics;
using scene::View;

const char* name_of(Caustics method) {
    for (const scene::CausticsMethod& m : scene::caustics_methods())
        if (m.caustics == method)
            return m.name;
    return "";
}

} // namespace

std::vector<Variant> variants() {
    std::vector<Variant> out;
    const auto add = [&](const char* effect, const std::string& name, bool needs_waves,
                         std::function<void(View&)> apply) {
        out.push_back({effect, name, needs_waves, std::move(apply)});
    };
    add("all", "best", false, [](View&) {});
    add("all", "default", false, [](View& v) {
        const scene::RenderSettings best = v.settings;
        v.settings = {};
        v.settings.width_px = best.width_px;
        v.settings.height_px = best.height_px;
        v.settings.samples = best.samples;
    });
    for (const scene::WalkMethod& method : scene::walk_methods())
        if (method.walk != scene::Walk::cone_map)
            add("first hits", method.name, false,
                [walk = method.walk](View& v) { v.settings.walk = walk; });
    for (const bool on : {false, true})
        add("curvature", on ? "on" : "off", false,
            [on](View& v) { v.settings.earth_curvature = on; });
    add("far land", "coarse", false, [](View& v) { v.settings.coarse_far_land = true; });
    add("shadows", "off", false, [](View& v) { v.settings.shadows = false; });
    add("reflection", "of the sky", false, [](View& v) { v.settings.mirrored_land = false; });
    add("reflection", "off", false, [](View& v) { v.settings.reflection = false; });
    add("refraction", "off", false, [](View& v) { v.settings.refraction = false; });
    add("Fresnel", "Schlick", false, [](View& v) { v.settings.fresnel = scene::Fresnel::schlick; });
    add("colour", "rgb", false, [](View& v) { v.settings.spectral = false; });
    add("thrown back", "off", false, [](View& v) { v.settings.thrown_back = false; });
    for (const double left : {0.002, 0.01, 0.05, 0.2})
        add("end of paths", text(left, " left"), false,
            [left](View& v) { v.settings.least_transmittance = left; });
    add("waves", "calm", true, [](View& v) { v.waves = {}; });
    for (const int cascades : {1, 2})
        add("waves", text(cascades, cascades > 1 ? " cascades" : " cascade"), true,
            [cascades](View& v) { v.waves.cascades = std::min(v.waves.cascades, cascades); });
    for (const int texels : {128, 256})
        add("waves", text(texels, " texels"), true, [texels](View& v) {
            v.waves.texels = std::min(v.waves.texels, texels);
            v.settings.caustic_texels = std::min(v.settings.caustic_texels, texels);
        });
    add("caustics", "off", true, [](View& v) { v.settings.caustics = Caustics::off; });
    for (const int texels : {64, 128, 256, 512})
        add("caustics", text("splat ", texels), true, [texels](View& v) {
            v.settings.caustic_texels = std::min(texels, v.waves.texels);
            v.settings.caustic_photons = 1;
        });
    for (const Caustics method : {Caustics::photon_map, Caustics::mesh, Caustics::back})
        add("caustics", name_of(method), true, [method](View& v) {
            v.settings.caustics = method;
            v.settings.caustic_texels = 0;
            v.settings.caustic_photons = 1;
        });
    for (const int steps : {0, 1, 2, 4, 8})
        add("shafts", text(steps, steps == 1 ? " step" : " steps"), true,
            [steps](View& v) { v.settings.shaft_steps = steps; });
    for (const int prisms : {32, 64, 128, 256})
        add("shafts", text("prisms ", prisms), true, [prisms](View& v) {
            v.settings.shafts = scene::Shafts::prisms;
            v.settings.shaft_prisms = prisms;
        });
    return out;
}

std::vector<scene::NamedCamera> standard_views(const scene::Scene& scene, glm::dvec3 sun,
                                               double aspect) {
    const LakeRecord& lake = scene.lakes.front();
    const auto preset = [&](const char* name) {
        return scene::preset_camera(scene, lake, name, sun, aspect);
    };
    const double pi = 3.14159265358979323846;
    const auto heading_of = [&](const scene::Camera& c) {
        return std::atan2(c.forward.x, c.forward.y) * 180.0 / pi;
    };
    std::vector<scene::NamedCamera> views;
    const scene::Camera high = preset("overview"), shore = preset("shore");
    views.push_back({"high", high});
    // From as far as the high view, low enough to graze land and water.
    const glm::dvec3 low(high.position.x, high.position.y,
                         lake.level_m + 0.25 * (high.position.z - lake.level_m));
    const double ground = scene.ground.elevation_m(low.x, low.y);
    views.push_back({"grazing", scene::look({low.x, low.y, std::max(low.z, ground + 20.0)},
                                            heading_of(high), -4.0, 45.0)});
    views.push_back({"shore", shore});
    views.push_back({"top", preset("top")});
    const scene::Camera dive = preset("dive");
    const auto level = scene.water_level_m(dive.position.x, dive.position.y);
    if (!level || dive.position.z >= *level)
        return views;
    const double heading = heading_of(dive);
    views.push_back({"dive-down", scene::look(dive.position, heading, -35.0, 65.0)});
    views.push_back({"dive-up", scene::look(dive.position, heading, 50.0, 75.0)});
    views.push_back(
        {"half-submerged",
         scene::look({dive.position.x, dive.position.y, *level + 0.02}, heading, 0.0, 60.0)});
    return views;
}

} // namespace tarn::bench
