#pragma once
/// @file land_shadow.hpp  How high the shadow of land and bed reaches over every place: which water
/// the sun's light comes into, and how deep.
#include "scene/scene.hpp"

#include <optional>
#include <vector>

namespace tarn::scene {

/// Square-ish cells over the whole ground, row 0 north; values belong to the cells' middles.
struct LandShadow {
    int cols = 0, rows = 0;
    double softness_m = 1.0;     ///< height over which the shadow's edge is spread: half a cell's
    std::vector<float> height_m; ///< below this the sun is hidden
};

/// @param sun   unit, towards it
/// @param most  cells on the longer side
/// @return      nothing where no water of the scene lies in shadow, or the sun does not shine
///
/// Greatest of h(p + t s) - t tan(elevation) over the way t towards the sun, in steps of a cell, by
/// doubling: what two steps of 2^k see is what one of 2^(k+1) sees.
std::optional<LandShadow> land_shadow(const Scene& scene, glm::dvec3 sun, int most = 1024);

/// The same of the bed, in the water alone.
/// @param below  unit, towards the sun as it is refracted
/// @return       nothing where the bed shades no water above it: no slope is steeper than the beam
std::optional<LandShadow> bed_shadow(const Scene& scene, glm::dvec3 below, int most = 1024);

} // namespace tarn::scene
