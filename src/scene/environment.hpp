#pragma once
/// @file environment.hpp  A picture of the whole sky in place of the clear one.
#include "core/image.hpp"
#include "scene/lighting.hpp"

namespace tarn::scene {

/// Sun and sky from an environment map.
///
/// What is at least thirty times as bright as the sky's mean, within 3 degrees of the brightest
/// place, is the sun: its light becomes the sun's irradiance, its middle the sun's direction, and
/// the sky goes on behind it as it is around. A map without such a place, or with it below the
/// horizon, is an overcast sky.
///
/// @param map       latitude and longitude: twice as wide as high, at least 16 rows; the top row is
///                  the zenith, the middle column looks to grid north, columns go on to the east.
///                  Radiance in any unit: pictures find their exposure. What is below the horizon
///                  is not used.
/// @param turn_deg  the map is turned so far clockwise, seen from above
/// @throws tarn::Error  if the shape is another, or a value is negative or not finite
Lighting environment(const Image& map, double turn_deg = 0.0);

} // namespace tarn::scene
