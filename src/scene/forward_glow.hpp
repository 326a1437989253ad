#pragma once
/// @file forward_glow.hpp  Where the light of sun and sky goes that water scatters forwards.
///
/// Quasi-single scattering counts it as not scattered: right for how much light arrives, and for
/// what is lit. Seen from below it is not in the sun's disc, though, but in a glow around it:
/// after an optical depth tau of forward scattering, e^-tau is left in the disc. All light in a
/// wide beam scatters alike, so what comes from an angle theta off the beam is
///   G(theta, tau) = sum over l of (2 l + 1) / 4 pi (e^(-tau (1 - p_l)) - e^-tau) P_l(cos theta),
/// p_l being the Legendre moments of the phase function (Goudsmit & Saunderson 1940), for paths of
/// one length. The table holds H = G / tau [1/sr], for tau -> 0 the phase function itself, which
/// what a metre scatters is multiplied by.
/// Phase function  Fournier & Forand (1994) in the form of Jonasz & Fournier (2007) with n = 1.10,
/// mu = 3.5835, which back-scatters Petzold's .0183 (Mobley et al. 2002), less the even part that
/// scattered_radiance() in shaders/passes/shade.comp counts apart.
/// Beyond a right angle paths differ too much for the formula: between 70 and 90 degrees the table
/// falls to nothing. Verified by photons: tests/unit/glow_test.cpp.
#include <vector>

namespace tarn::scene {

/// What the forward part of the phase function is at an angle [1/sr], 1 over the sphere.
/// @param theta_rad  [0, pi]; 0 beyond a right angle
double forward_phase(double theta_rad);

struct GlowTable {
    static constexpr int angles = 160, depths = 64;
    static constexpr double least_rad = 0.004, least_tau = 0.1, greatest_tau = 100.0;
    std::vector<float> h; ///< [depth][angle], 1/sr, >= 0

    /// Angles and depths are spaced by the logarithm of 1 + angle / least_rad, of 1 + tau /
    /// least_tau.
    static double angle_rad(int column);
    static double tau(int row);
    /// Where between columns an angle lies, in [0, angles - 1], and between rows an optical depth,
    /// in [0, depths - 1].
    static double column_of(double theta_rad);
    static double row_of(double tau);
    /// H, bilinear between entries.
    double at_place(double column, double row) const;
    /// @param theta_rad  [0, pi]   @param tau  >= 0
    double at(double theta_rad, double tau) const {
        return at_place(column_of(theta_rad), row_of(tau));
    }
};

/// Of the sun's light. Made once.
const GlowTable& glow_table();

/// Of an even sky's, seen through a flat surface: per unit of scalar irradiance, angles off the
/// vertical. Made once for each index of refraction.
/// @param index  of the water, >= 1
const GlowTable& sky_glow_table(double index);

} // namespace tarn::scene
