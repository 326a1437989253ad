#include "scene/lighting.hpp"

#include "core/angles.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

namespace tarn::scene {

namespace {

constexpr double wavelength_um[3] = {0.620, 0.545, 0.450};

/// Relative optical air mass (Kasten & Young 1989); 1 at the zenith, 38 at the horizon.
double air_mass(double elevation_rad) {
    const double deg = std::max(elevation_rad, 0.0) * 180.0 / pi;
    return 1.0 / (std::sin(deg * pi / 180.0) + 0.50572 * std::pow(deg + 6.07995, -1.6364));
}

struct Air {
    double rayleigh, aerosol, ozone;
    double scattering() const { return rayleigh + 0.95 * aerosol; } // aerosol albedo .95
    double total() const { return rayleigh + aerosol + ozone; }
};

Air air(int channel) {
    const double w = wavelength_um[channel];
    constexpr double ozone[3] = {0.033, 0.025, 0.002}; // 300 DU times the Chappuis cross-section
    return {0.008569 * std::pow(w, -4.0) * (1.0 + 0.0113 / (w * w)),
            0.05 * std::pow(w / 0.55, -1.3), ozone[channel]};
}

/// Phase functions with mean 1 over the sphere.
double rayleigh_phase(double cosine) { return 0.75 * (1.0 + cosine * cosine); }
double henyey_greenstein(double cosine, double g) {
    return (1.0 - g * g) / std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5);
}

/// Diffuse plus direct transmittance of a layer that only scatters (Eddington).
double two_stream(double depth, double g, double cos_sun) {
    return ((2.0 + 3.0 * cos_sun) + (2.0 - 3.0 * cos_sun) * std::exp(-depth / cos_sun)) /
           (4.0 + 3.0 * (1.0 - g) * depth);
}

} // namespace

glm::dvec3 horizontal_irradiance(const SkyTable& sky) {
    // Trapezoid rule over azimuth and over the squared-elevation parameter v.
    glm::dvec3 sum(0.0);
    for (int j = 0; j < sky.elevations; ++j) {
        const double v = double(j) / (sky.elevations - 1);
        const double elevation = 0.5 * pi * v * v;
        const double weight_v = (j == 0 || j == sky.elevations - 1 ? 0.5 : 1.0) /
                                (sky.elevations - 1) * pi * v; // d elevation / d v
        for (int i = 0; i < sky.azimuths; ++i) {
            const double weight_a =
                (i == 0 || i == sky.azimuths - 1 ? 0.5 : 1.0) / (sky.azimuths - 1) * 2.0 * pi;
            sum += glm::dvec3(sky.at(i, j)) *
                   (weight_a * weight_v * std::sin(elevation) * std::cos(elevation));
        }
    }
    return sum;
}

Lighting clear_sky(glm::dvec3 sun_direction) {
    Lighting out;
    out.sun_direction = glm::normalize(sun_direction);
    const double elevation = std::asin(std::clamp(out.sun_direction.z, -1.0, 1.0));
    // Below the horizon the sun lights the upper air only; a smooth fade stands for twilight.
    const double twilight = std::exp(std::min(elevation, 0.0) * 180.0 / pi * 0.8);
    const double sun_elevation = std::max(elevation, 0.2 * pi / 180.0);
    const double m_sun = air_mass(sun_elevation), cos_sun = 1.0 / m_sun;
    out.sky.azimuths = 96;
    out.sky.elevations = 64;
    out.sky.radiance.resize(std::size_t(out.sky.azimuths) * std::size_t(out.sky.elevations));

    for (int channel = 0; channel < 3; ++channel) {
        const Air a = air(channel);
        const double direct = std::exp(-a.total() * m_sun);
        out.sun_irradiance[channel] = elevation > 0.0 ? pi * direct : 0.0;
        for (int j = 0; j < out.sky.elevations; ++j) {
            const double v = double(j) / (out.sky.elevations - 1);
            const double view = 0.5 * pi * v * v, m_view = air_mass(view);
            for (int i = 0; i < out.sky.azimuths; ++i) {
                const double azimuth = pi * i / (out.sky.azimuths - 1);
                const double cosine = std::sin(view) * std::sin(sun_elevation) +
                                      std::cos(view) * std::cos(sun_elevation) * std::cos(azimuth);
                const double phase = (a.rayleigh * rayleigh_phase(cosine) +
                                      0.95 * a.aerosol * henyey_greenstein(cosine, 0.76)) /
                                     a.total();
                // Integral of the source along the slant path through a homogeneous layer.
                const double x = a.total() * (m_view - m_sun);
                const double slab = std::abs(x) < 1e-6 ? 1.0 : -std::expm1(-x) / x;
                const double radiance =
                    twilight * 0.25 * phase * a.total() * m_view * direct * slab; // E0 / 4 pi
                out.sky.radiance[std::size_t(j) * std::size_t(out.sky.azimuths) + std::size_t(i)]
                                [channel] = static_cast<float>(radiance);
            }
        }
        const double once = horizontal_irradiance(out.sky)[channel];
        const double absorbed = std::exp(-(a.total() - a.scattering()) * m_sun);
        const double g = 0.95 * a.aerosol * 0.76 / a.scattering();
        const double diffuse =
            pi * cos_sun * absorbed * twilight *
            (two_stream(a.scattering(), g, cos_sun) - std::exp(-a.scattering() / cos_sun));
        const auto lift = static_cast<float>(std::max(0.0, diffuse - once) / pi);
        for (glm::vec3& radiance : out.sky.radiance)
            radiance[channel] += lift;
    }
    out.sky_irradiance = horizontal_irradiance(out.sky);
    return out;
}

glm::dvec3 air_extinction_per_m(const Lighting& lighting) {
    if (!lighting.visibility_m)
        return glm::dvec3(0.0);
    const double green = 3.912 / *lighting.visibility_m;
    return {green * std::pow(550.0 / 620.0, 1.3), green * std::pow(550.0 / 545.0, 1.3),
            green * std::pow(550.0 / 450.0, 1.3)};
}

Lighting uniform_sky(glm::dvec3 sun_direction, glm::dvec3 sun_irradiance, glm::dvec3 sky_radiance) {
    Lighting out;
    out.sun_direction = glm::normalize(sun_direction);
    out.sun_irradiance = sun_irradiance;
    out.sun_disc = false;
    out.sky.azimuths = out.sky.elevations = 2;
    out.sky.radiance.assign(4, glm::vec3(sky_radiance));
    out.sky_irradiance = sky_radiance * pi; // the closed form; two rows would integrate it badly
    return out;
}

} // namespace tarn::scene
