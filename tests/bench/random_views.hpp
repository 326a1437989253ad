#pragma once
/// @file random_views.hpp  Five lakes made of formulas and random views of them: what the planner's
/// studies look at.
#include "gpu/context.hpp"
#include "scene/samples.hpp"
#include "scene/settings.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

namespace tarn::bench {

struct Lake {
    const char* name;
    scene::Scene scene;
    double wind_m_per_s;
};

/// Somewhere over or in the lake, looking anywhere that is not all sky.
inline scene::Camera random_camera(const scene::Scene& scene, std::mt19937& random) {
    std::uniform_real_distribution<double> even(0.0, 1.0);

    const Heightfield& g = scene.ground;
    for (;;) {
        const double x = std::lerp(g.west_m, g.east_m(), 0.15 + 0.7 * even(random)),
                     y = std::lerp(g.south_m(), g.north_m, 0.15 + 0.7 * even(random));
        const auto water = scene.water_level_m(x, y);
        const double ground = g.elevation_m(x, y), heading = 360.0 * even(random);
        const double lot = even(random), size = g.east_m() - g.west_m;
        if (lot < 0.35 && water && *water - ground > 2.0)
            return scene::look({x, y, std::lerp(ground + 0.5, *water - 0.5, even(random))}, heading,
                               -50.0 + 100.0 * even(random), 65.0);
        if (lot >= 0.35)
            return scene::look({x, y,
                                std::max(water.value_or(ground), ground) + 2.0 +
                                    0.15 * size * std::pow(even(random), 3.0)},
                               lot < 0.7 ? std::atan2(-x, -y) * 180.0 / 3.14159265 : heading,
                               -45.0 * even(random), 50.0);
    }
}

/// Small and large, calm and moving, clear and turbid.
inline std::vector<Lake> five_lakes() {
    std::vector<Lake> lakes;
    lakes.push_back({"bowl, calm", scene::bowl(513), 0.0});
    lakes.push_back({"mountain 1024, calm", scene::mountain_lake(1024), 0.0});
    lakes.push_back({"bowl, wind 3 m/s", scene::bowl(513), 3.0});
    lakes.push_back({"mountain 1024, wind 6 m/s", scene::mountain_lake(1024), 6.0});
    lakes.push_back({"mountain 4096, wind 10 m/s", scene::mountain_lake(4096), 10.0});
    // Green and turbid, as lowland lakes are.
    lakes[3].scene.optics.absorption_per_m = {0.45, 0.25, 0.6};
    lakes[3].scene.optics.backscattering_per_m = {0.03, 0.032, 0.034};
    lakes[3].scene.optics.bands.clear();
    return lakes;
}

/// The next random view of a lake, without a size.
inline scene::View random_view(const Lake& lake, std::mt19937& random) {
    scene::View view;
    view.camera = random_camera(lake.scene, random);
    view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(0.5, -0.4, 0.75)));
    if (lake.wind_m_per_s > 0.0) {
        view.waves.model = waves::Model::jonswap;
        view.waves.wind_m_per_s = lake.wind_m_per_s;
        if (gpu::is_software())
            view.waves.texels = 128;
    }
    return view;
}

/// Budgets that views are planned to, in turn.
constexpr double budgets_in_turn[] = {0.005, 0.01, 0.02, 0.05};

} // namespace tarn::bench
