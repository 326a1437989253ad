#pragma once
/// @file ground_colour.hpp  Double-precision twin of shaders/lib/ground_colour.glsl.
///
/// A palette has no second derivation: its numbers are those of the shader. What this twin guards
/// is the arithmetic around them (order of the layers, units, precision of the noise).
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace tarn::reference {

/// Same contract as the GLSL function of the same name.
glm::dvec3 ground_albedo(glm::dvec2 place_m, double height_m, bool bed, double near_water,
                         double tree_m, double snow_m, double slope, double footprint_m);

} // namespace tarn::reference
