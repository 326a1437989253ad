#pragma once
/// @file spectrum.hpp  How the variance of the water's height is shared out over wave vectors.
///
/// Symbols  k wavenumber [rad/m], theta direction of travel from the wind's [rad], omega [rad/s],
///          S(k) [m^3] with integral over k = variance m0 [m^2], D(theta) with integral 1.
/// Sources  dispersion: Tessendorf 2001, eqs. 14-18; Phillips: eqs. 23-24, with Phillips' constant
///          .0081 in front; JONSWAP and its growth with fetch: Hasselmann et al. 1973; fully grown
///          sea: Pierson & Moskowitz 1964; TMA: Bouws et al. 1985 with Kitaigorodskii's factor;
///          spreading: Donelan, Hamilton & Hui 1985, tail by Banner 1990; mean square slope: Cox &
///          Munk 1954.
#include "waves/settings.hpp"

#include <glm/vec2.hpp>

namespace tarn::waves {

inline constexpr double gravity_m_per_s2 = 9.81;
/// Square of the length at which gravity and surface tension pull alike: sigma / (rho g) with
/// .0728 N/m (water at 20 C).
inline constexpr double capillary_length2_m2 = 0.0728 / (998.2 * gravity_m_per_s2);
/// Where waves are slowest, 1.7 cm: shorter ones are not modelled.
inline constexpr double greatest_k_per_m = 370.0;

/// omega^2 = (g k + sigma k^3 / rho) tanh(k depth).
/// @param depth_m  >= 0; 0: nothing moves
double omega_per_s(double k_per_m, double depth_m);
/// d omega / d k [m/s].
double group_speed_m_per_s(double k_per_m, double depth_m);

/// Cox & Munk's mean square slope of a clean surface: upwind plus crosswind.
double cox_munk_slope(double wind_m_per_s);

struct Moments {
    double height = 0.0;      ///< m0 [m^2]
    double slope_along = 0.0; ///< mean square slope in the wind's direction
    double slope_across = 0.0;
    double slope() const { return slope_along + slope_across; }
};

class Spectrum {
public:
    /// Of one of the spectral models, at a place with that fetch and depth.
    /// @param fetch_m  > 0
    /// @param depth_m  >= 0
    Spectrum(const Settings& settings, double fetch_m, double depth_m);

    /// S(k), cut-off included; 0 for k <= 0.
    double density(double k_per_m) const;
    /// D(theta) at k.
    double spread(double k_per_m, double theta_rad) const;
    /// Density over the plane of wave vectors [m^4]: S D / k.
    double at(glm::dvec2 k_per_m) const;

    /// Of the waves with k in [low, high), by quadrature.
    Moments moments(double low_k, double high_k) const;
    /// Of all modelled waves.
    Moments moments() const { return moments(lowest_k(), highest_k()); }

    double peak_k() const { return peak_k_; }
    double peak_period_s() const;
    /// 4 sqrt(m0) [m].
    double significant_height_m() const;
    /// Nothing worth modelling is outside [lowest_k, highest_k].
    double lowest_k() const;
    double highest_k() const;
    double cutoff_m() const { return cutoff_m_; }
    double depth_m() const { return depth_m_; }
    /// Unit vector that the waves travel along, scene axes.
    glm::dvec2 towards() const { return towards_; }
    /// No wind, or too little for any wave that is modelled.
    bool still() const { return still_; }

private:
    double uncut(double k_per_m) const;
    double total_slope() const; ///< moments().slope() without its directions
    Model model_;
    glm::dvec2 towards_;
    double depth_m_, exponent_, exponent_norm_ = 1.0;
    double peak_k_ = 1.0, peak_omega_ = 1.0, alpha_ = 0.0081, gamma_ = 3.3;
    double cutoff_m_ = 0.0;
    bool still_ = false;
};

} // namespace tarn::waves
