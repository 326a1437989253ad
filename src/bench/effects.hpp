#pragma once
/// @file effects.hpp  What a picture can be made of more cheaply, one part at a time: the rows of
/// `tarn bench`, and the views that they are measured in.
#include "scene/scene.hpp"
#include "scene/settings.hpp"

#include <functional>
#include <string>
#include <vector>

namespace tarn::bench {

/// A way of drawing one part of the picture; everything else stays at its best.
struct Variant {
    std::string effect;                      ///< the part: "caustics"
    std::string name;                        ///< the way: "splat 128"
    bool needs_waves = false;                ///< says nothing about calm water
    std::function<void(scene::View&)> apply; ///< changes a view at its best
};

/// Rows of the matrix: first the best, then `default`, what a person gets who says nothing, then
/// the ways of each part.
std::vector<Variant> variants();

/// Cameras that show where ways of drawing differ, of any scene: high, grazing, shore, top,
/// dive-down, dive-up, half-submerged; those in the water only where a lake is a metre deep.
std::vector<scene::NamedCamera> standard_views(const scene::Scene& scene, glm::dvec3 sun,
                                               double aspect);

} // namespace tarn::bench
