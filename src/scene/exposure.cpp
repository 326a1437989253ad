#include "scene/exposure.hpp"

#include <algorithm>

namespace tarn::scene {

ExposureRange exposure_range(const Scene& scene, const View& view) {
    const Lighting& light = view.lighting;
    const double incident =
        (light.sun_irradiance.y * std::max(light.sun_direction.z, 0.0) + light.sky_irradiance.y) /
        3.14159265;
    const double usual = 1.25 / std::max(incident, 1e-4);
    const bool dive = scene.under_water(view.camera.position);
    return {.key = 0.25,
            .least = dive ? usual * 0.2 : usual * 0.5,
            .greatest = usual * (dive ? 400.0 : 2.0)};
}

} // namespace tarn::scene
