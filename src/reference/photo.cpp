#include "reference/photo.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::reference {

namespace {
double linear(double encoded) { // inverse of the sRGB transfer function
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}
} // namespace

Photo::Photo(const Ortho& ortho)
    : west_m_(ortho.west_m), north_m_(ortho.north_m), spacing_m_(ortho.spacing_m),
      width_m_(ortho.picture.width_px * ortho.spacing_m),
      height_m_(ortho.picture.height_px * ortho.spacing_m) {
    Level base{ortho.picture.width_px, ortho.picture.height_px, {}};
    base.texels.reserve(ortho.picture.bytes.size() / 4);
    for (std::size_t i = 0; i + 3 < ortho.picture.bytes.size(); i += 4)
        base.texels.emplace_back(
            linear(ortho.picture.bytes[i] / 255.0), linear(ortho.picture.bytes[i + 1] / 255.0),
            linear(ortho.picture.bytes[i + 2] / 255.0), ortho.picture.bytes[i + 3] / 255.0);
    levels_.push_back(std::move(base));
    while (levels_.back().width > 1 || levels_.back().height > 1) {
        const Level& fine = levels_.back();
        Level next{std::max(1, fine.width / 2), std::max(1, fine.height / 2), {}};
        next.texels.resize(std::size_t(next.width) * std::size_t(next.height));
        for (int y = 0; y < next.height; ++y)
            for (int x = 0; x < next.width; ++x) {
                glm::dvec4 sum(0.0);
                for (int k = 0; k < 4; ++k)
                    sum += fine.texels[std::size_t(std::min(2 * y + k / 2, fine.height - 1)) *
                                           std::size_t(fine.width) +
                                       std::size_t(std::min(2 * x + k % 2, fine.width - 1))];
                next.texels[std::size_t(y) * std::size_t(next.width) + std::size_t(x)] = 0.25 * sum;
            }
        levels_.push_back(std::move(next));
    }
}

glm::dvec4 Photo::Level::bilinear(double u, double v) const {
    const double x = u * width - 0.5, y = v * height - 0.5;
    const double fx = std::floor(x), fy = std::floor(y);
    const auto texel = [&](double i, double j) {
        return texels[std::size_t(std::clamp(int(j), 0, height - 1)) * std::size_t(width) +
                      std::size_t(std::clamp(int(i), 0, width - 1))];
    };
    const double a = x - fx, b = y - fy;
    return (1 - b) * ((1 - a) * texel(fx, fy) + a * texel(fx + 1, fy)) +
           b * ((1 - a) * texel(fx, fy + 1) + a * texel(fx + 1, fy + 1));
}

glm::dvec4 Photo::at(double x, double y, double footprint_m) const {
    const double u = (x - west_m_) / width_m_, v = (north_m_ - y) / height_m_;
    if (levels_.empty() || !(u > 0.0 && v > 0.0 && u < 1.0 && v < 1.0))
        return glm::dvec4(0.0);
    const double last = double(levels_.size() - 1);
    const double lod = std::clamp(std::log2(std::max(footprint_m, 1e-6) / spacing_m_), 0.0, last);
    const auto below = std::size_t(lod);
    const auto above = std::min(below + 1, levels_.size() - 1);
    const double f = lod - double(below);
    return (1 - f) * levels_[below].bilinear(u, v) + f * levels_[above].bilinear(u, v);
}

} // namespace tarn::reference
