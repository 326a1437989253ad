#pragma once
/// @file sea.hpp  The waves of one lake, ready to be drawn: what both tracers read.
///
/// A cascade is a square patch that repeats itself, with a lattice of wave vectors of its own. No
/// wave is in two cascades: each has a band [low_k, high_k) of wavenumbers. Its height is
///   eta(x, t) = sum over k of h(k, t) exp(i k . x),
///   h(k, t) = h0(k) exp(-i omega t) + conj(h0(-k)) exp(i omega t)        (Tessendorf 2001, eq. 26)
/// with E|h0(k)|^2 = S(k) dk^2 / 2, so that the variance of eta is the integral of the spectrum.
/// Frequencies are whole numbers of turns a loop: any time is reached directly, backwards too,
/// and phases are counted in whole numbers, so that years of it lose nothing.
///
/// Choppy water: the surface point over x lies at x + choppiness D(x) (eq. 29). The tracer needs
/// one height over each place, so the patch is resampled: see shaders/passes/wave_surface.comp.
/// `choppiness` is bounded so that a fold would need a slope of six standard deviations.
#include "core/lake_record.hpp"
#include "waves/fetch.hpp"
#include "waves/spectrum.hpp"

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>

namespace tarn::waves {

inline constexpr int most_cascades = 4;
inline constexpr int filter_levels = 12; ///< mip levels of the largest cascade

/// Covariance of the surface's slopes, scene axes.
struct SlopeCovariance {
    double xx = 0.0, xy = 0.0, yy = 0.0;
    double trace() const { return xx + yy; }
    void add(double share, glm::dvec2 slope) {
        xx += share * slope.x * slope.x;
        xy += share * slope.x * slope.y;
        yy += share * slope.y * slope.y;
    }
};

struct Cascade {
    double patch_m = 1.0; ///< side of the square
    int texels = 512;     ///< a side
    double low_k = 0.0, high_k = 0.0;
    double choppiness = 0.0;
    bool ripples = false; ///< made by rain (waves/ripples.hpp), not by a spectrum
    /// Ripples of pokes: not repeated, its south-western corner lies here [scene m], ...
    bool window = false;
    glm::dvec2 corner_m{0.0};
    std::vector<std::uint8_t> mask;   ///< ... and where its texels are land: 1
    Moments moments;                  ///< of the band, by the spectrum
    double bound_m = 0.0;             ///< heights are held within +- this: six standard deviations
    std::vector<glm::vec4> h0;        ///< texels^2: h0(k) and conj(h0(-k)); row = y, FFT order
    std::vector<std::uint32_t> turns; ///< texels^2: omega in turns a loop
    /// Slopes that a square filter 2^level texels wide, looked up bilinearly, takes away.
    std::array<SlopeCovariance, filter_levels> unresolved{};

    double texel_m() const { return patch_m / texels; }
};

/// A plane wave ready to be summed: amplitude cos(k . x - omega t + phase).
struct SineWave {
    glm::dvec2 k_per_m{0.0};
    double amplitude_m = 0.0, omega_per_s = 0.0, phase_rad = 0.0;
};

/// What a limnologist can check.
struct SeaReport {
    std::string model;
    double wind_m_per_s = 0.0, wind_from_deg = 0.0;
    double fetch_m = 0.0, depth_m = 0.0;
    double significant_height_m = 0.0, peak_period_s = 0.0, peak_length_m = 0.0;
    double mean_square_slope = 0.0;           ///< of all waves, drawn or counted as roughness
    double drawn_slope = 0.0;                 ///< of those drawn
    double drawn_height_m = 0.0;              ///< significant height of those drawn
    double longest_m = 0.0, shortest_m = 0.0; ///< drawn
    double choppiness = 0.0;                  ///< smallest of the cascades', after the bound
    std::vector<std::string> notes;           ///< what had to be changed, and why
};

struct Sea {
    Settings settings;
    std::vector<Cascade> cascades;
    std::vector<SineWave> sines;
    SlopeCovariance roughness; ///< of waves too short for any cascade
    double bound_m = 0.0;      ///< the surface stays within +- this of the level
    double full_depth_m = 0.0; ///< waves fade linearly to nothing from this depth to the shore
    /// Height of each cascade's waves relative to the roughest place, 255 = 1: by the fetch and
    /// depth there. Squares of `mask`; a sample between their middles is bilinear.
    Grid<std::array<std::uint8_t, most_cascades>> amplitude;
    double amplitude_side_m = 1.0, amplitude_west_m = 0.0, amplitude_north_m = 0.0;
    SeaReport report;

    /// Nothing moves: drawn as a plane.
    bool still() const { return cascades.empty() && sines.empty(); }
};

/// @param lakes  at least one; the first one's mean depth serves where none is given
/// @throws tarn::Error  if the settings are out of range
Sea make_sea(const Heightfield& ground, const Heightfield& water,
             const std::vector<LakeRecord>& lakes, const Settings& settings);

/// The numbers alone, for one lake of a scene.
SeaReport report_for(const WaterMask& mask, const Grid<float>& fetch, const Heightfield& ground,
                     const Heightfield& water, const LakeRecord& lake, const Settings& settings);

/// Whole turns of the loop since time 0, as a 32-bit fraction: phase = turns * this / 2^32 turns.
std::uint32_t loop_fraction(double time_s, double loop_s);

} // namespace tarn::waves
