#pragma once
/// @file settings.hpp  How a picture is computed; every default gives a good picture of any lake.
#include "scene/camera.hpp"
#include "scene/lighting.hpp"
#include "scene/scene.hpp"

#include <glm/vec2.hpp>
#include <optional>

namespace tarn::scene {

enum class Fresnel { exact, schlick };

struct RenderSettings {
    int width_px = 1280; ///< [1, 16384]
    int height_px = 720; ///< [1, 16384]
    int samples = 4;     ///< per pixel, [1, 1024]; sub-pixel positions by sample_offset()
    Fresnel fresnel = Fresnel::exact;
    bool shadows = true;
    bool reflection = true;
    bool refraction = true;
    double least_transmittance = 0.002;  ///< underwater paths end where less is left, [1e-6, .5]
    std::optional<double> ground_albedo; ///< lab: one grey for all ground, [0, 1]

    /// @throws tarn::Error  naming the field, its value and the legal range
    void validate() const;
};

/// Everything a tracer needs to know, besides the scene.
struct View {
    Camera camera;
    Lighting lighting;
    RenderSettings settings;
};

/// Position of sample `index` of `count` inside the pixel, in [0, 1)^2: the centre for one sample,
/// else Roberts' R2 low-discrepancy sequence (plastic number), the same on every device.
glm::dvec2 sample_offset(int index, int count);

/// Rays for shadows start this much above the surface they come from [m]: a hundredth of the
/// spacing and two height quanta, or the surface would shade itself by rounding.
double shadow_lift_m(const Heightfield& ground);

/// Bottom of the block of earth that a scene is cut out of [m]: a thirtieth of its longer side
/// below its lowest node. Rays that come in from the side meet the cut; below it there is sky.
double block_bottom_m(const Heightfield& ground);

/// Length of an underwater path after which less than settings.least_transmittance is left in
/// every channel [m]; 1e9 in water that does not attenuate.
double greatest_path_m(const WaterOptics& optics, const RenderSettings& settings);

} // namespace tarn::scene
