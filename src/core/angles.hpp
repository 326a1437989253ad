#pragma once
/// @file angles.hpp  Constants of the circle.
#include <numbers>

namespace tarn {

inline constexpr double pi = std::numbers::pi;
inline constexpr double degree = pi / 180.0; ///< [rad]

} // namespace tarn
