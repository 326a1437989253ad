#pragma once
/// @file water_colour.hpp  What water does to light by colour, integrated over wavelengths once.
///
/// Light in the scene has three channels of linear sRGB, white being the sun's own colour. A
/// channel's share of the light at a wavelength is w(lambda), the product of the sun's spectrum and
/// the CIE observer in sRGB, normalised to sum 1. After x metres of water, whether down from the
/// surface, along the view ray or both, white has become
///   T(x) = sum of w exp(-(a + b_b) x),
/// which no exponential of three channels gives (Akkaynak & Treibitz 2018). Weights have negative
/// lobes where a colour lies outside sRGB, and so may T. Rows of the table, over the path x:
///   0  T, transmitted
///   1  I, the integral of row 2 from 0 to x
///   2  Q = sum of w b_b / 2 pi exp(-(a + b_b) x), what a metre scatters back [1/(m sr)]
///   3  B, diffuse reflectance of the surface seen from a bed at depth x, water included
///   4  sum of w exp(-(a + b) x), of light that has not been scattered at all: what still draws a
///      thing's edges. Where only channels are known, row 0.
///   5  the same of light that has not been scattered wide (WaterBand::pattern_per_m): what still
///      draws patterns a few degrees wide
/// Sources  observer: Wyman, Sloan & Shirley (2013), a fit to CIE 1931; sun: Planck at 5772 K (IAU
///          2015); sRGB: IEC 61966-2-1. The physics: docs/physics/water.md.
#include "scene/water_optics.hpp"

#include <array>
#include <glm/vec4.hpp>

namespace tarn::scene {

struct GlowTable;

/// Shares of red, green and blue in sunlight of that wavelength, per nm, not normalised.
glm::dvec3 sunlight_colour(double wavelength_nm);

struct WaterTable {
    static constexpr int texels = 4096;
    static constexpr double shortest_m = 0.02; ///< below this, texels lie evenly
    double longest_m = 1.0;                    ///< the last texel's path
    double greatest_attenuation_per_m = 0.0;   ///< of any wavelength
    double sky_entering = 1.0;                 ///< share of an even sky that a flat surface lets in
    std::array<std::vector<glm::vec3>, 6> rows;

    /// The path at a share of the way from the first texel to the last [m].
    static double path_m(double share, double longest_m);
    /// The path at a texel [m]: shortest_m (exp(i s) - 1).
    double path_m(int texel) const { return path_m(double(texel) / (texels - 1), longest_m); }
    /// As shaders/lib/medium.glsl takes it: the rows one after another, and what turns a path into
    /// a place in them.
    std::vector<glm::vec4> packed() const;
    glm::vec4 scale() const;
};

/// @param spectral  false: three narrow bands, an exponential each
WaterTable make_water_table(const WaterOptics& optics, bool spectral);

/// Share of unpolarised light that a flat surface of water throws back at what comes from below.
/// @param cosine  of the angle in the water, [0, 1]   @param index  of the water, >= 1
double reflectance_from_below(double cosine, double index);

/// The glow that water makes of the sun's or the sky's light, by colour: what a metre scatters
/// forwards,
///   sum of w b_f exp(-(a + b_b) x) H(angle, b_f x)  [1/(m sr)]   (scene/forward_glow.hpp),
/// over the table's angle and the path x, b_f being WaterBand::forward_per_m().
struct GlowColours {
    static constexpr int paths = 256;
    int angles = 0;
    std::vector<glm::vec4> rgb; ///< [path][angle], alpha 0; paths spaced as a WaterTable's are
};

/// @param glow       the sun's or the sky's
/// @param longest_m  the last path: WaterTable::longest_m
/// @pre   optics have bands
GlowColours make_glow_colours(const WaterOptics& optics, const GlowTable& glow, double longest_m);

} // namespace tarn::scene
