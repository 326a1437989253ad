#pragma once
/// @file water_optics.hpp  What the water does to light, per colour channel.
///
/// With `bands`, colour is integrated over wavelengths (scene/water_colour.hpp). Without, or where
/// a picture asks for it, channels are narrow bands at 620, 545 and 450 nm. Forward scattering, 97
/// % and more of all scattering in natural water, is counted as not scattered at all
/// (quasi-single-scattering approximation, Gordon 1973): what weakens a ray is a + b_b.
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace tarn::scene {

/// Share of what water scatters forwards that goes off by more than some 2.5 degrees; the rest
/// still lands where caustics and patterns of the bed are. Petzold's mean phase function (Mobley
/// 1994, table 3.10), rounded.
inline constexpr double scattered_wide = 0.6;

/// What the water does at one wavelength.
struct WaterBand {
    double wavelength_nm = 0.0;
    double absorption_per_m = 0.0;     ///< a, [0, 100]
    double scattering_per_m = 0.0;     ///< b, [0, 1000]
    double backscattering_per_m = 0.0; ///< b_b, part of b, [0, b]
    double attenuation_per_m() const { return absorption_per_m + backscattering_per_m; }
    /// Of light that still draws patterns a few degrees wide: what is scattered narrowly counts as
    /// not scattered.
    double pattern_per_m() const {
        return attenuation_per_m() + scattered_wide * (scattering_per_m - backscattering_per_m);
    }
    /// Of light that goes on in about its direction: what is not scattered evenly to all sides.
    double forward_per_m() const {
        return scattering_per_m > 2.0 * backscattering_per_m
                   ? scattering_per_m - 2.0 * backscattering_per_m
                   : 0.0;
    }
    friend bool operator==(const WaterBand&, const WaterBand&) = default;
};

struct WaterOptics {
    std::string name = "clear lake, three channels";
    /// Absorption a [1/m], [0, 100]. Pure water (Pope & Fry 1997: .2755, .052, .0092) plus
    /// dissolved organic matter of a clear lake, .03 exp(-.015 (wavelength - 440)) /m.
    glm::dvec3 absorption_per_m{0.2775, 0.058, 0.035};
    /// Backscattering b_b [1/m], [0, 100]: fine mineral particles, almost white.
    glm::dvec3 backscattering_per_m{0.0060, 0.0065, 0.0070};
    double index = 1.333; ///< of refraction, [1, 3]
    /// Ascending wavelengths in [350, 800] nm, 2 to 1000; empty: only the three channels above are
    /// known. Between bands linear, beyond them as the last.
    std::vector<WaterBand> bands;

    glm::dvec3 attenuation_per_m() const { return absorption_per_m + backscattering_per_m; }

    /// @throws tarn::Error  naming the field, its value and the legal range
    void validate() const;
    friend bool operator==(const WaterOptics&, const WaterOptics&) = default;
};

} // namespace tarn::scene
