#pragma once
/// @file noise.hpp  Double-precision twin of shaders/lib/noise.glsl; the hash is equal bit for bit.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>

namespace tarn::reference {

/// Same contract as the GLSL function of the same name.
inline std::uint32_t lattice_hash(std::int32_t x, std::int32_t y, std::uint32_t seed) {
    std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8da6b343u ^
                      static_cast<std::uint32_t>(y) * 0xd8163841u ^ seed * 0xcb1ab31fu;
    h = (h ^ (h >> 16)) * 0x7feb352du;
    h = (h ^ (h >> 15)) * 0x846ca68bu;
    return h ^ (h >> 16);
}

/// Same contract as the GLSL function of the same name: a weighted sum over the four corners.
inline double value_noise(glm::dvec2 p, std::uint32_t seed) {
    const auto x0 = static_cast<std::int32_t>(std::floor(p.x)),
               y0 = static_cast<std::int32_t>(std::floor(p.y));
    double sum = 0.0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const auto ramp = [](double away) {
                return (1.0 - away) * (1.0 - away) * (1.0 + 2.0 * away);
            };
            const double w = ramp(std::abs(p.x - (x0 + i))) * ramp(std::abs(p.y - (y0 + j)));
            sum += w * double(lattice_hash(x0 + i, y0 + j, seed) >> 8) / 16777216.0;
        }
    return sum;
}

/// Same contract as the GLSL function of the same name.
inline double faded_noise(glm::dvec2 p_m, double wavelength_m, double footprint_m,
                          std::uint32_t seed) {
    double out = 0.5;
    for (std::uint32_t octave = 0; octave < 3; ++octave) {
        const double length = wavelength_m * std::pow(0.4, octave);
        const double turn = (octave + 1) * std::atan2(0.6, 0.8), c = std::cos(turn),
                     sn = std::sin(turn);
        const glm::dvec2 turned(c * p_m.x - sn * p_m.y, sn * p_m.x + c * p_m.y);
        const double share = std::clamp(2.0 - 4.0 * footprint_m / length, 0.0, 1.0);
        out +=
            std::pow(0.5, octave + 1) * share * (value_noise(turned / length, seed + octave) - 0.5);
    }
    return out;
}

} // namespace tarn::reference
