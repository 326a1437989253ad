#pragma once
/// @file ripples.hpp  What the wave equation of small ripples is solved with: numbers shared by the
///                    GPU's solver and by what is known of it beforehand.
///
/// h_tt + 2 damping h_t = speed^2 (h_xx + h_yy) on a square of texels, by the leapfrog scheme, in
/// steps of .6 texels' travel (stable up to .71; Courant, Friedrichs & Lewy 1928).
#include "waves/settings.hpp"

#include <algorithm>

namespace tarn::waves {

inline constexpr double ripple_texel_m = 1.0 / 64.0; ///< rings of a hand's width have six texels
inline constexpr double ripple_speed_m_per_s = 0.3;  ///< of waves of 2 to 8 cm (.23 to .36)
inline constexpr double ripple_damping_per_s = 1.5;  ///< rings are gone in a few seconds
inline constexpr double ripple_courant = 0.6;
/// A drop leaves height (1 - r^2 / s^2) exp(-r^2 / s^2), which adds no water, with this s.
inline constexpr double drop_radius_m = 2.5 * ripple_texel_m;
/// Drops fall on squares of so many texels a side, at most one a step.
inline constexpr int drop_cell_texels = 16;

inline constexpr double ripple_step_s() {
    return ripple_courant * ripple_texel_m / ripple_speed_m_per_s;
}

/// Rain is no denser than a drop a step in each such square [1/(m^2 s)].
inline constexpr double most_drops_per_m2_s() {
    const double cell_m = drop_cell_texels * ripple_texel_m;
    return 1.0 / (cell_m * cell_m * ripple_step_s());
}
/// Root mean square wavenumber of a drop's slopes [rad/m], and of its rings'.
inline constexpr double drop_k_per_m = 2.449489742783178 / drop_radius_m;

/// Mean square slope that rain keeps up: by Campbell's theorem the rate times the integral over a
/// drop's life of its squared slopes, which are 3/2 pi height^2 at first, half that once the rings
/// run, and fade with twice the damping.
inline double rain_slope(const RippleSettings& s) {
    return std::min(s.rain_drops_per_m2_s, most_drops_per_m2_s()) * 1.5 * 3.14159265358979 *
           s.drop_height_m * s.drop_height_m / 2.0 / (2.0 * ripple_damping_per_s);
}

} // namespace tarn::waves
