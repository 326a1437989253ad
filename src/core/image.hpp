#pragma once
/// @file image.hpp  A picture of linear radiance with its distances, and an 8-bit one to look at.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

namespace tarn {

/// Linear scene-referred picture; row 0 is the top.
struct Image {
    int width_px = 0, height_px = 0;
    std::vector<glm::vec3> radiance; ///< linear sRGB primaries, relative W/(m2 sr)
    std::vector<float> distance_m;   ///< along the ray to the first surface; infinity = sky
};

/// The yardstick of pictures: a thousandth of the reference's mean radiance, which errors are held
/// against where it is darker, so that black pixels do not rule.
inline double relative_floor(const Image& expected) {
    double mean = 0.0;
    for (const glm::vec3& c : expected.radiance)
        mean += (double(c.r) + c.g + c.b) / 3.0 / double(expected.radiance.size());
    return std::max(1e-3 * mean, 1e-12);
}

/// |got - expected| / max(|expected|, floor), the mean over channels; infinite if a value is no
/// number.
inline double relative_error(const glm::vec3& got, const glm::vec3& expected, double floor) {
    double error = 0.0;
    for (int k = 0; k < 3; ++k) {
        const double a = got[k], b = expected[k];
        if (!std::isfinite(a) || !std::isfinite(b))
            return std::numeric_limits<double>::infinity();
        error += std::abs(a - b) / std::max(std::abs(b), floor) / 3.0;
    }
    return error;
}

/// 8-bit picture, sRGB encoded, `channels` of 1, 3 or 4; row 0 is the top.
struct Picture {
    int width_px = 0, height_px = 0, channels = 3;
    std::vector<std::uint8_t> bytes;
};

/// A georeferenced photograph over the scene: RGBA, pixel (0, 0) covers the square whose
/// north-west corner is (west_m, north_m).
struct Ortho {
    Picture picture; ///< 4 channels; alpha 0 = no picture there
    double west_m = 0.0, north_m = 0.0, spacing_m = 1.0;
};

} // namespace tarn
