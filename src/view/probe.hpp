#pragma once
/// @file probe.hpp  What lies under the pointer, in numbers. No window and no GL.
#include "core/geo.hpp"
#include "scene/scene.hpp"

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

namespace tarn::view {

struct Reading {
    GeoPoint place;
    glm::dvec3 point{0};           ///< scene metres
    double distance_m = 0.0;       ///< from the camera
    double ground_m = 0.0;         ///< elevation of the ground there
    double slope_deg = 0.0;        ///< of the ground
    std::optional<double> level_m; ///< of water over it
    /// Water depth straight below the point; nothing where it is dry or the bed unknown.
    std::optional<double> depth_m;
    /// Where a line of sight from above the water ends on the bed: how deep that is, and how deep
    /// it looks. Flat water; to the eye a thing lies where the unbent line of sight passes straight
    /// above it (tan of the angle in water over tan of that in air times its depth).
    std::optional<double> seen_depth_m, apparent_depth_m;
};

/// @param eye        the camera's place
/// @param direction  of the line of sight, any length
/// @param distance   to what it meets first, surface or ground, as pictures give it; 1e9: nothing
/// @param bend_per_m  of lines of sight, as the picture has it (scene/curvature.hpp)
/// @return           nothing if it meets neither
std::optional<Reading> read_place(const scene::Scene& scene, const glm::dvec3& eye,
                                  const glm::dvec3& direction, double distance,
                                  double bend_per_m = 0.0);

/// Where a ray from within the field meets the ground, if it does before `most_m`: steps of half a
/// node, then halving. For readings, not for pictures.
/// @param bend_per_m  as above
std::optional<glm::dvec3> first_ground(const scene::Scene& scene, const glm::dvec3& origin,
                                       const glm::dvec3& direction, double most_m,
                                       double bend_per_m = 0.0);

/// The same from anywhere, water stopping it, too.
std::optional<glm::dvec3> first_met(const scene::Scene& scene, const glm::dvec3& eye,
                                    const glm::dvec3& direction, double bend_per_m = 0.0);

/// In one line: "-38.05123, 176.58231   ground 271.32 m   depth 41.99 m   slope 3.2 deg ...".
std::string describe(const Reading& reading);

/// Of a line through places of the scene, on the ellipsoid [m].
double length_m(const scene::Scene& scene, const std::vector<glm::dvec3>& places);
/// Inside of it when closed [m2].
double area_m2(const scene::Scene& scene, const std::vector<glm::dvec3>& places);

} // namespace tarn::view
