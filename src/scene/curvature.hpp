#pragma once
/// @file curvature.hpp  How far level ground falls away below a line of sight, and when that shows.
///
/// Scenes lie in a plane map whose heights count from level ground. There a line of sight is a
/// parabola: after d metres it stands d^2 (1 - k) / 2R higher over level ground than a straight
/// line would. R: mean radius of the Earth (Moritz 2000, GRS 80). k: coefficient of refraction of
/// the air, .13 as surveyors take it (Brunner 1984): light bends down by as much of the Earth's
/// curvature. In the water paths are too short for it.
#include "scene/settings.hpp"

namespace tarn::scene {

constexpr double earth_radius_m = 6371008.8;
constexpr double air_refraction = 0.13;

/// Drop of level ground is this times the squared distance [1/m]: 6.83e-8, 6.8 m in 10 km.
constexpr double bend_per_m = (1.0 - air_refraction) / (2.0 * earth_radius_m);

/// The greatest drop that a view could show, at the corner of the scene farthest from the camera.
struct CurvatureDrop {
    double distance_m = 0.0, drop_m = 0.0;
    double pixels = 0.0; ///< seen from the camera
};
CurvatureDrop curvature_drop(const Scene& scene, const Camera& camera, int height_px);

/// Whether a view's rays are bent: as asked, else where the drop could be more than a pixel.
bool is_curved(const Scene& scene, const View& view);

} // namespace tarn::scene
