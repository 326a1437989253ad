#pragma once
/// @file stroke_tree.hpp  Lines in space, packed in a tree of boxes that a shader walks without a
/// stack. Layout: shaders/lib/space_lines.glsl.
#include "scene/space_lines.hpp"

#include <glm/vec4.hpp>
#include <vector>

namespace tarn::render {

/// Box nodes, depth first, each with where to go on if it is missed; then the strokes of the
/// leaves. Ends count from whole nodes of the ground, so that float32 holds them to a fraction of a
/// cell wherever they are.
/// @param strokes  at least one, at most scene::most_strokes
std::vector<glm::uvec4> pack_strokes(const Heightfield& ground,
                                     const std::vector<scene::SpaceStroke>& strokes);

} // namespace tarn::render
