#include "image/tone.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace tarn::image {

namespace {
double luminance(const glm::vec3& c) {
    return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
} // BT.709
} // namespace

glm::vec3 into_gamut(glm::vec3 c) {
    if (!std::isfinite(c.r + c.g +
                       c.b)) // a fault of its maker, or another program's: black, no more
        return glm::vec3(0.0f);
    const float least = std::min({c.r, c.g, c.b});
    if (least >= 0.0f)
        return c;
    const auto grey = static_cast<float>(luminance(c));
    if (grey <= 0.0f)
        return glm::vec3(0.0f);
    return glm::max(glm::vec3(grey) + (c - grey) * (grey / (grey - least)), glm::vec3(0.0f));
}

double srgb_encode(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

double auto_exposure(const Image& image, double key, double least, double greatest,
                     double dark_share) {
    std::vector<float> values;
    values.reserve(image.radiance.size());
    for (const glm::vec3& c : image.radiance)
        if (const double value = luminance(c); std::isfinite(value))
            values.push_back(static_cast<float>(value));
    if (values.empty())
        return 1.0;
    std::sort(values.begin(), values.end());
    std::size_t from = values.size() * 2 / 100;
    const std::size_t to = std::max(from + 1, values.size() * 98 / 100);
    while (from + 1 < to && double(values[from]) < dark_share * double(values[to - 1]))
        ++from;
    double sum = 0.0;
    for (std::size_t i = from; i < to; ++i)
        sum += std::log(std::max(double(values[i]), 1e-6));
    return std::clamp(key / std::exp(sum / double(to - from)), least, greatest);
}

Picture encode_linear(const Image& image) {
    Picture out{
        .width_px = image.width_px, .height_px = image.height_px, .channels = 3, .bytes = {}};
    for (const glm::vec3& radiance : image.radiance) {
        const glm::vec3 c = into_gamut(radiance);
        for (int k = 0; k < 3; ++k)
            out.bytes.push_back(static_cast<std::uint8_t>(
                std::lround(255.0 * srgb_encode(std::clamp(double(c[k]), 0.0, 1.0)))));
    }
    return out;
}

Picture tone_map(const Image& image, double exposure) {
    constexpr double contrast = 1.3;
    // Semi-saturation such that mid grey, .18, stays .18.
    const double half = std::pow(0.18, contrast) * (1.0 - 0.18) / 0.18;
    // 4 x 4 Bayer thresholds, mean zero, within half an 8-bit step.
    static constexpr int bayer[16] = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
    Picture out{
        .width_px = image.width_px, .height_px = image.height_px, .channels = 3, .bytes = {}};
    out.bytes.resize(image.radiance.size() * 3);
    // A table replaces three million powers; its steps are a sixteenth of an 8-bit step.
    static const auto table = [] {
        std::vector<float> t(4097);
        for (std::size_t i = 0; i < t.size(); ++i)
            t[i] = static_cast<float>(255.0 * srgb_encode(std::pow(double(i) / 4096.0, 2.0)));
        return t;
    }();
    for (std::size_t i = 0; i < image.radiance.size(); ++i) {
        const std::size_t x = i % std::size_t(image.width_px), y = i / std::size_t(image.width_px);
        const double dither = (bayer[(y % 4) * 4 + x % 4] + 0.5) / 16.0 - 0.5;
        const glm::vec3 colour = into_gamut(image.radiance[i]);
        for (int k = 0; k < 3; ++k) {
            const double v = std::max(0.0, double(colour[k]) * exposure);
            const double powered = std::pow(v, contrast);
            const double curved = powered / (powered + half);
            const double place = std::sqrt(curved) * 4096.0; // the table is even in the square root
            const auto low = std::min<std::size_t>(4095, std::size_t(place));
            const double f = place - double(low);
            const double code = table[low] * (1.0 - f) + table[low + 1] * f;
            out.bytes[3 * i + std::size_t(k)] =
                static_cast<std::uint8_t>(std::clamp(std::lround(code + dither), 0l, 255l));
        }
    }
    return out;
}

} // namespace tarn::image
