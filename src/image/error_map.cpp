#include "image/error_map.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "image/annotate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tarn::image {

namespace {

constexpr double decades = 4.0; // from 1e-4 to 1

/// @param place  on the scale, [0, 1]; lightness grows with it
std::array<std::uint8_t, 3> colour(double place) {
    static constexpr double stops[5][3] = {
        {0, 0, 0}, {35, 45, 130}, {30, 135, 105}, {245, 190, 60}, {255, 255, 255}};
    const double at = std::clamp(place, 0.0, 1.0) * 4.0;
    const int first = std::min(int(at), 3);
    std::array<std::uint8_t, 3> out{};
    for (std::size_t k = 0; k < 3; ++k)
        out[k] = static_cast<std::uint8_t>(
            std::lround(stops[first][k] + (at - first) * (stops[first + 1][k] - stops[first][k])));
    return out;
}

} // namespace

Picture error_map(const Image& got, const Image& expected) {
    if (got.width_px != expected.width_px || got.height_px != expected.height_px)
        throw Error(text("pictures are ", got.width_px, " x ", got.height_px, " and ",
                         expected.width_px, " x ", expected.height_px));
    const int size = std::max(11, got.height_px / 24), bar = 2 * size;
    Picture out{
        .width_px = got.width_px, .height_px = got.height_px + bar, .channels = 3, .bytes = {}};
    out.bytes.assign(std::size_t(out.width_px) * std::size_t(out.height_px) * 3, 24);
    const double floor = relative_floor(expected);
    for (std::size_t i = 0; i < got.radiance.size(); ++i) {
        const double error = relative_error(got.radiance[i], expected.radiance[i], floor);
        const auto c = colour(error > 0.0 ? 1.0 + std::log10(error) / decades : 0.0);
        std::copy(c.begin(), c.end(), out.bytes.begin() + std::ptrdiff_t(3 * i));
    }
    const int left = size, right = std::max(left + 5, out.width_px - 4 * size);
    for (int x = left; x < right; ++x)
        fill_box(out, x, got.height_px + bar / 8, x + 1, got.height_px + bar / 2,
                 colour(double(x - left) / (right - left)));
    for (const auto& [place, words] :
         {std::pair(0.0, ".01 %"), std::pair(0.25, ".1 %"), std::pair(0.5, "1 %"),
          std::pair(0.75, "10 %"), std::pair(1.0, "100 %")})
        draw_text(out, left + int(place * (right - left)), got.height_px + bar - bar / 8,
                  size * 3 / 4, words);
    return out;
}

} // namespace tarn::image
