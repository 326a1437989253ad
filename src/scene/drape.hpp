#pragma once
/// @file drape.hpp  Lines and points over ground and bed, ready to be looked up by shaders.
#include "scene/scene.hpp"

#include <glm/vec2.hpp>
#include <vector>

namespace tarn::scene {

/// Nearness to lines and points over the scene's ground, a texel a quarter of its spacing wide or
/// as wide as `most` texels a side demand.
///
/// @param lines   places in scene metres, each with the next; parts outside the ground are left out
/// @param points  drawn as small rings
/// @param most    texels on the longer side, [16, 16384]
/// @return        nothing where none of them lies on the ground
std::optional<Drape> make_drape(const Heightfield& ground,
                                const std::vector<std::vector<glm::dvec2>>& lines,
                                const std::vector<glm::dvec2>& points, int most = 8192);

} // namespace tarn::scene
