#include "scene/exposure.hpp"

#include <algorithm>

namespace tarn::scene {

ExposureRange exposure_range(const Scene& scene, const View& view) {
    const Lighting& light = view.lighting;
    const double incident =
        (light.sun_irradiance.y * std::max(light.sun_direction.z, 0.0) + light.sky_irradiance.y) /
        3.14159265;
    const bool dive = scene.under_water(view.camera.position);
    constexpr double lamp_reach_m = 3.0;
    const double lamp = dive ? view.settings.dive_light_cd * irradiance_per_lux /
                                   (3.14159265 * lamp_reach_m * lamp_reach_m)
                             : 0.0;
    const double usual = 1.25 / std::max(incident + lamp, 1e-4);
    return {.key = 0.25,
            .least = dive ? usual * (lamp > 0.0 ? 0.02 : 0.2) : usual * 0.5,
            .greatest = usual * (dive ? 400.0 : 2.0),
            .dark_share = lamp > 0.0 ? 0.02 : 0.0};
}

} // namespace tarn::scene
