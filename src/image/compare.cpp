#include "image/compare.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tarn::image {

namespace {

void require_same_size(const Image& a, const Image& b) {
    if (a.width_px != b.width_px || a.height_px != b.height_px)
        throw Error(text("pictures are ", a.width_px, " x ", a.height_px, " and ", b.width_px,
                         " x ", b.height_px));
}

double percentile(std::vector<double> values, double share) {
    const auto at =
        values.begin() +
        std::ptrdiff_t(std::min(values.size() - 1, std::size_t(share * double(values.size()))));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

} // namespace

Difference compare(const Image& got, const Image& expected) {
    require_same_size(got, expected);
    Difference out;
    if (got.radiance.empty())
        return out;
    std::vector<double> brightness;
    for (const glm::vec3& c : expected.radiance)
        brightness.push_back((double(c.r) + c.g + c.b) / 3.0);
    const double floor = relative_floor(expected);
    double squared = 0.0;
    std::vector<double> relative(got.radiance.size());
    for (std::size_t i = 0; i < got.radiance.size(); ++i) {
        relative[i] = relative_error(got.radiance[i], expected.radiance[i], floor);
        out.finite = out.finite && std::isfinite(relative[i]);
        const glm::dvec3 by = glm::dvec3(got.radiance[i]) - glm::dvec3(expected.radiance[i]);
        if (std::isfinite(relative[i]))
            squared +=
                (by.x * by.x + by.y * by.y + by.z * by.z) / (3.0 * double(got.radiance.size()));
        if (relative[i] > out.max_relative) {
            out.max_relative = relative[i];
            out.worst_pixel = i;
        }
        out.mean_relative += relative[i] / double(got.radiance.size());
    }
    out.p95_relative = percentile(relative, 0.95);
    out.p99_relative = percentile(relative, 0.99);
    const double peak = percentile(brightness, 0.99);
    out.psnr_db = squared > 0.0 ? 10.0 * std::log10(peak * peak / squared)
                                : std::numeric_limits<double>::infinity();
    return out;
}

DistanceDifference compare_distances(const Image& got, const Image& expected, double quantum_m,
                                     double share) {
    require_same_size(got, expected);
    DistanceDifference out;
    const int w = expected.width_px, h = expected.height_px;
    const auto at = [w](const Image& image, int x, int y) {
        return double(image.distance_m[std::size_t(y) * std::size_t(w) + std::size_t(x)]);
    };
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            ++out.pixels;
            const double a = at(got, x, y), b = at(expected, x, y);
            bool edge = false;
            const auto near = [&](int dx, int dy) {
                return 1.0 / at(expected, std::clamp(x + dx, 0, w - 1),
                                std::clamp(y + dy, 0, h - 1)); // sky: 0
            };
            for (const auto& [dx, dy] :
                 {std::pair{1, 0}, std::pair{0, 1}, std::pair{1, 1}, std::pair{1, -1}}) {
                if (x + dx >= w || x - dx < 0 || y + dy >= h || y + dy < 0 || y - dy < 0 ||
                    y - dy >= h)
                    continue;
                const double a1 = near(dx, dy), b1 = near(-dx, -dy), c1 = near(0, 0);
                edge |= std::abs(a1 + b1 - 2.0 * c1) > 0.02 * std::max({a1, b1, c1});
            }
            if (edge) {
                ++out.edges;
                continue;
            }
            if (!std::isfinite(a) && !std::isfinite(b))
                continue;
            const double off = std::abs(a - b);
            out.worst_m = std::max(out.worst_m, off);
            out.different += !(off <= std::max(quantum_m, share * b));
        }
    return out;
}

} // namespace tarn::image
