#pragma once
/// @file scenario_map.hpp  What two levels of a lake differ in, as a map.
#include "dem/refill.hpp"
#include "scene/scene.hpp"

#include <filesystem>

namespace tarn::app {

struct DifferenceAreas {
    double flooded_m2 = 0.0, exposed_m2 = 0.0; ///< in the projection
};

/// Writes BASE.tif (classes: 1 newly flooded, 2 newly exposed, 3 under water at both levels; 0
/// elsewhere, nodata) and BASE.png, the same over a shaded map with a legend.
/// @throws tarn::Error  if a level cannot be shown, or a file cannot be written
DifferenceAreas write_difference(const scene::Scene& scene, dem::Refill& refill, double from_m,
                                 double to_m, const std::filesystem::path& base);

} // namespace tarn::app
