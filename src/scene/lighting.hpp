#pragma once
/// @file lighting.hpp  Sun and sky above the scene.
///
/// Units  relative: the sun outside the atmosphere has perpendicular irradiance pi in each
///        channel, so a white matte surface facing it would have radiance 1.
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

namespace tarn::scene {

/// Sky radiance over direction, symmetric about the sun's vertical plane, or of a whole turn.
/// Shape  `elevations` rows of `azimuths` values. Row j is elevation 90 deg * (j/(rows-1))^2, so
///        that rows crowd towards the horizon; column i is the angle i/(cols-1) * 180 deg between
///        the direction's azimuth and the sun's; of a whole turn it is azimuth i/(cols-1) * 360
///        deg, clockwise from grid north, the first column once more as the last. Below the horizon
///        the lowest row counts.
struct SkyTable {
    int azimuths = 0, elevations = 0;
    bool whole_turn = false;
    std::vector<glm::vec3> radiance;
    const glm::vec3& at(int azimuth, int elevation) const {
        return radiance[std::size_t(elevation) * std::size_t(azimuths) + std::size_t(azimuth)];
    }
};

struct Lighting {
    glm::dvec3 sun_direction{0, 0, 1}; ///< unit, TOWARDS the sun, scene axes
    glm::dvec3 sun_irradiance{0};      ///< on a plane facing the sun, at the ground
    bool sun_disc = true;              ///< is the sun itself to be seen
    SkyTable sky;
    /// Distance at which a black thing's contrast with the horizon falls to .02 [m], at the height
    /// of the lake, [100, 1e6]; none: clear air, costs nothing.
    std::optional<double> visibility_m;
    glm::dvec3 sky_irradiance{0}; ///< of the sky alone on a horizontal plane
};

/// The haze thins out by e over this height above the lake [m]: the boundary layer's usual depth.
inline constexpr double haze_scale_height_m = 1500.0;

/// Extinction of the air at the lake's height in the three channels [1/m]: 3.912 / visibility at
/// 550 nm (Koschmieder 1924), by wavelength as the sky's aerosol (Angstrom exponent 1.3); 0 in
/// clear air.
glm::dvec3 air_extinction_per_m(const Lighting& lighting);

/// Angular radius of the sun [rad]: 16 arc minutes.
inline constexpr double sun_radius_rad = 0.004654;

/// A clear sky: single Rayleigh and aerosol scattering in closed form, plus an isotropic part that
/// lifts its irradiance to that of the two-stream solution (multiple scattering).
///
/// @param sun_direction  unit; a sun below the horizon gives a faint twilight sky
/// Source  Rayleigh optical depth .008569 w^-4 (1 + .0113 w^-2), w in um (Hansen & Travis 1974);
///         aerosol optical depth .05 at 550 nm, Angstrom exponent 1.3, asymmetry .76; ozone
///         300 DU (Chappuis band); air mass by Kasten & Young (1989); two-stream transmittance of
///         a scattering layer by the Eddington approximation (Shettle & Weinman 1970).
Lighting clear_sky(glm::dvec3 sun_direction);

/// A sky of one radiance in every direction, and a sun given by hand: for comparison with other
/// renderers and with closed forms.
Lighting uniform_sky(glm::dvec3 sun_direction, glm::dvec3 sun_irradiance, glm::dvec3 sky_radiance);

/// Irradiance on a horizontal plane, integrated over the table.
glm::dvec3 horizontal_irradiance(const SkyTable& sky);

} // namespace tarn::scene
