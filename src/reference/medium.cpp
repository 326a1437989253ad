#include "reference/medium.hpp"

#include "core/angles.hpp"
#include "reference/fresnel.hpp"
#include "scene/forward_glow.hpp"
#include "scene/water_colour.hpp"
#include "scene/water_types.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tarn::reference {

double sky_glow_slant(double angle_rad) { return 1.1 + 0.16 * std::min(angle_rad / 0.85, 1.0); }

Medium::Medium(const scene::WaterOptics& optics, bool spectral) : index_(optics.index) {
    const auto sum_over = [&](double step_nm) {
        std::vector<Wave> waves;
        glm::dvec3 sum(0.0);
        for (double nm = 400.0 + 0.5 * step_nm; nm < 700.0; nm += step_nm) { // midpoints
            const scene::WaterBand band = scene::band_at(optics.bands, nm);
            const glm::dvec3 weight = scene::sunlight_colour(nm);
            waves.push_back({weight, band.attenuation_per_m(), band.backscattering_per_m,
                             band.absorption_per_m + band.scattering_per_m, band.pattern_per_m(),
                             band.forward_per_m()});
            sum += weight;
        }
        for (Wave& wave : waves)
            wave.weight /= sum;
        return waves;
    };
    if (spectral && !optics.bands.empty()) {
        waves_ = sum_over(2.5);
        glow_waves_ = sum_over(5.0);
        sky_glow_ = &scene::sky_glow_table(index_);
    } else {
        for (int c = 0; c < 3; ++c) {
            glm::dvec3 weight(0.0);
            weight[c] = 1.0;
            waves_.push_back({weight, optics.attenuation_per_m()[c], optics.backscattering_per_m[c],
                              optics.attenuation_per_m()[c], optics.attenuation_per_m()[c], 0.0});
        }
    }
    double mirrored = 0.0;
    constexpr int steps = 4000;
    for (int i = 0; i < steps; ++i) {
        const double cosine = (i + 0.5) / steps;
        mirrored += 2.0 * cosine * fresnel_dielectric(cosine, 1.0 / index_) / steps;
    }
    sky_entering_ = 1.0 - mirrored;
}

glm::dvec3 Medium::transmittance(double path_m) const {
    glm::dvec3 sum(0.0);
    for (const Wave& wave : waves_)
        sum += wave.weight * std::exp(-wave.attenuation_per_m * path_m);
    return sum;
}

glm::dvec3 Medium::pattern_transmittance(double path_m) const {
    glm::dvec3 sum(0.0);
    for (const Wave& wave : waves_)
        sum += wave.weight * std::exp(-wave.pattern_per_m * path_m);
    return sum;
}

double Medium::pattern_share(double path_m) const {
    const glm::dvec3 luminance(0.2126, 0.7152, 0.0722);
    return std::clamp(glm::dot(luminance, pattern_transmittance(path_m)) /
                          std::max(glm::dot(luminance, transmittance(path_m)), 1e-12),
                      0.0, 1.0);
}

glm::dvec3 Medium::image_transmittance(double path_m) const {
    glm::dvec3 sum(0.0);
    for (const Wave& wave : waves_)
        sum += wave.weight * std::exp(-wave.beam_per_m * path_m);
    return sum;
}

glm::dvec3 Medium::path_radiance(double slant, double depth_m, double sink, double before_m,
                                 double distance_m) const {
    glm::dvec3 sum(0.0);
    // From the end where the light has come the shorter way, so that nothing overflows.
    const double gain = (1.0 + slant * sink) * distance_m;
    const double shortest = slant * depth_m + before_m + std::min(gain, 0.0);
    for (const Wave& wave : waves_) {
        const double x = wave.attenuation_per_m * std::abs(gain);
        const double mean = std::abs(x) < 1e-9 ? 1.0 : -std::expm1(-x) / x;
        sum += wave.weight * (wave.backscattering_per_m / (2.0 * pi) * distance_m * mean *
                              std::exp(-wave.attenuation_per_m * shortest));
    }
    return sum;
}

glm::dvec3 Medium::scattered_beyond(double path_m) const {
    glm::dvec3 sum(0.0);
    for (const Wave& wave : waves_)
        if (wave.attenuation_per_m > 0.0) // else nothing is scattered either
            sum += wave.weight * (wave.backscattering_per_m / (2.0 * pi * wave.attenuation_per_m) *
                                  std::exp(-wave.attenuation_per_m * path_m));
    return sum;
}

glm::dvec3 Medium::glow_radiance(double slant, double depth_m, double sink, double before_m,
                                 double distance_m, double angle_rad) const {
    return glow_by(scene::glow_table(), slant, depth_m, sink, before_m, distance_m, angle_rad);
}

glm::dvec3 Medium::sky_glow_radiance(double depth_m, double sink, double before_m,
                                     double distance_m, double angle_rad) const {
    return sky_glow_ ? glow_by(*sky_glow_, sky_glow_slant(angle_rad), depth_m, sink, before_m,
                               distance_m, angle_rad)
                     : glm::dvec3(0.0);
}

glm::dvec3 Medium::glow_by(const scene::GlowTable& glow, double slant, double depth_m, double sink,
                           double before_m, double distance_m, double angle_rad) const {
    const double rate = 1.0 + slant * sink, start = slant * depth_m + before_m;
    glm::dvec3 sum(0.0);
    if (angle_rad >= 0.5 * pi)
        return sum;
    const double column = glow.column_of(angle_rad);
    double greatest = 0.0;
    for (const Wave& wave : glow_waves_)
        greatest = std::max(greatest, wave.attenuation_per_m + wave.forward_per_m);
    // Pieces, each longer than the one before it, that the path grows little along.
    const int pieces =
        std::clamp(int(std::ceil(2.0 * greatest * std::abs(rate) * distance_m)), 1, 6);
    for (int i = 0; i < pieces; ++i) {
        const double from = distance_m * std::pow(double(i) / pieces, 2.0),
                     to = distance_m * std::pow((i + 1.0) / pieces, 2.0);
        for (const Wave& wave : glow_waves_) {
            if (!(wave.forward_per_m > 0.0))
                continue;
            // What a piece brings, and the mean of its paths, by the exponential's moments; counted
            // from the end where the light has come the shorter way, so that nothing overflows.
            const double c = wave.attenuation_per_m, gain = rate * (to - from),
                         x = c * std::abs(gain);
            const double shortest = std::max(start + rate * from + std::min(gain, 0.0), 0.0);
            const bool short_one = x < 0.02; // to 1e-5
            const double lost = short_one ? x : -std::expm1(-x);
            const double mean = short_one ? 1.0 - 0.5 * x : lost / x;
            const double place = short_one ? 0.5 - x / 12.0 : 1.0 / x - (1.0 - lost) / lost;
            const double tau = wave.forward_per_m * (shortest + place * std::abs(gain));
            sum +=
                wave.weight * (wave.forward_per_m * (to - from) * mean * std::exp(-c * shortest) *
                               glow.at_place(column, glow.row_of(tau)));
        }
    }
    return sum;
}

// By angles, with the substitution that crowds the points where the critical angle's kink is.
glm::dvec3 Medium::thrown_back(double depth_m) const {
    glm::dvec3 sum(0.0);
    const double critical = std::asin(std::min(1.0, 1.0 / index_));
    constexpr int steps = 24;
    for (int part = 0; part < 2; ++part)
        for (int i = 0; i < steps; ++i) {
            const double t = (i + 0.5) / steps;
            const double angle =
                part == 0 ? critical * (1.0 - t * t) : critical + (0.5 * pi - critical) * t;
            const double width = (part == 0 ? 2.0 * t * critical : 0.5 * pi - critical) / steps;
            const double cosine = std::cos(angle);
            const double share = 2.0 * cosine * std::sin(angle) * width *
                                 (part == 0 ? fresnel_dielectric(cosine, index_) : 1.0);
            for (const Wave& wave : waves_) {
                const double tau = wave.attenuation_per_m * depth_m;
                if (tau < 20.0)
                    sum += wave.weight * (share * std::exp(-2.0 * tau / cosine));
            }
        }
    return sum;
}

} // namespace tarn::reference
