#pragma once
/// @file space_lines.hpp  Lines and points that hang in air and water, from the shapes of a map.
#include "scene/settings.hpp"

#include <string_view>
#include <vector>

namespace tarn::scene {

/// Pieces that all lines together may have: 96 MiB on the GPU, of the 128 that OpenGL promises.
constexpr std::size_t most_strokes = std::size_t(1) << 21;

/// What heights of shapes count from.
enum class HeightsFrom {
    datum, ///< the scene's vertical datum
    level, ///< the water over or under a vertex; away from all water, the first lake
    ground ///< ground and bed
};

/// "datum", "level" or "ground", as --layers-3d-heights has it; anything else counts as the first.
HeightsFrom heights_from(std::string_view words);

/// A shape's vertices, z as the file says, NaN where it says none.
struct SpaceShapes {
    std::vector<std::vector<glm::dvec3>> lines;
    std::vector<glm::dvec3> points;
};

/// Where a vertex hangs.
/// @throws tarn::Error  if it has no height and they count from the datum; from elsewhere it is 0
glm::dvec3 place_in_space(const Scene& scene, const glm::dvec3& vertex, HeightsFrom from);

/// Lines are straight between their vertices; those that count from the ground follow it, in pieces
/// as long as its spacing. Nothing is cut at the scene's border.
/// @throws tarn::Error  as place_in_space(), and where there are more than most_strokes pieces
std::vector<SpaceStroke> make_strokes(const Scene& scene, const SpaceShapes& shapes,
                                      HeightsFrom from);

/// How brightly lines in space show that are signs, not things: irradiance on them as at the
/// camera, of green light for all colours.
double sign_irradiance(const Scene& scene, const View& view);

/// How a place is seen from a camera: in which direction, refracted where calm water lies between.
struct Sighting {
    glm::dvec3 towards{0.0};    ///< unit, from the camera
    double distance_m = 0.0;    ///< along it, to the place or to where the water's surface is met
    bool through_water = false; ///< seen through the surface
};
/// Nothing where land or bed hides the place, or all light is reflected on the way. Waves are left
/// out.
/// @param look_for_ground  false: only what bends and mirrors light counts, which is quick
std::optional<Sighting> sighting_of(const Scene& scene, const glm::dvec3& camera,
                                    const glm::dvec3& place, bool look_for_ground = true);

} // namespace tarn::scene
