#pragma once
/// @file image.hpp  A picture of linear radiance with its distances, and an 8-bit one to look at.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace tarn {

/// Linear scene-referred picture; row 0 is the top.
struct Image {
    int width_px = 0, height_px = 0;
    std::vector<glm::vec3> radiance; ///< linear sRGB primaries, relative W/(m2 sr)
    std::vector<float> distance_m;   ///< along the ray to the first surface; infinity = sky
};

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
