#include "scene/land_shadow.hpp"

#include "core/parallel.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::scene {

std::optional<LandShadow> land_shadow(const Scene& scene, glm::dvec3 sun, int most) {
    const double flat = std::hypot(sun.x, sun.y);
    if (!(sun.z > 0.0) || !(flat > 1e-6))
        return {};
    const Heightfield& ground = scene.ground;
    const double east_m = (ground.size().cols - 1) * ground.spacing_m,
                 south_m = (ground.size().rows - 1) * ground.spacing_m;
    const double cell_m = std::max(std::max(east_m, south_m) / most, ground.spacing_m);
    LandShadow out;
    out.cols = std::max(2, int(std::ceil(east_m / cell_m)));
    out.rows = std::max(2, int(std::ceil(south_m / cell_m)));
    const double wide = east_m / out.cols, high = south_m / out.rows;
    const double fall = cell_m * sun.z / flat; // of the beam over a step
    out.softness_m = std::max(0.5 * fall, 0.01);
    const auto x_of = [&](int col) { return ground.west_m + (col + 0.5) * wide; };
    const auto y_of = [&](int row) { return ground.north_m - (row + 0.5) * high; };
    out.height_m.resize(std::size_t(out.cols) * std::size_t(out.rows));
    std::vector<float> next(out.height_m.size());
    share_out(out.rows, 0, [&](int first, int last) {
        for (int r = first; r < last; ++r)
            for (int c = 0; c < out.cols; ++c)
                out.height_m[std::size_t(r) * std::size_t(out.cols) + std::size_t(c)] =
                    float(ground.elevation_m(x_of(c), y_of(r)));
    });
    // The place itself is not in its own way: the first look is a step ahead.
    const auto look = [&](const std::vector<float>& values, double col, double row) {
        if (col < 0.0 || row < 0.0 || col > out.cols - 1.0 || row > out.rows - 1.0)
            return -1e9;
        const int c = std::min(int(col), out.cols - 2), r = std::min(int(row), out.rows - 2);
        const double u = col - c, v = row - r;
        const auto at = [&](int x, int y) {
            return double(values[std::size_t(y) * std::size_t(out.cols) + std::size_t(x)]);
        };
        const double a = at(c, r), b = at(c + 1, r), d = at(c, r + 1), e = at(c + 1, r + 1);
        if (std::min({a, b, d, e}) < -1e8)
            return std::max({a, b, d, e});
        return (a * (1 - u) + b * u) * (1 - v) + (d * (1 - u) + e * u) * v;
    };
    const double across = cell_m * sun.x / flat / wide, down = -cell_m * sun.y / flat / high;
    double step = 1.0;
    bool shift = true; // first: from heights to what one step sees
    while (step < 2.0 * std::max(out.cols, out.rows)) {
        share_out(out.rows, 0, [&](int first, int last) {
            for (int r = first; r < last; ++r)
                for (int c = 0; c < out.cols; ++c) {
                    const std::size_t i = std::size_t(r) * std::size_t(out.cols) + std::size_t(c);
                    const double ahead =
                        look(out.height_m, c + step * across, r + step * down) - step * fall;
                    next[i] = float(shift ? ahead : std::max(double(out.height_m[i]), ahead));
                }
        });
        std::swap(next, out.height_m);
        if (!shift)
            step *= 2.0;
        shift = false;
    }
    bool dark = false;
    for (int r = 0; r < out.rows && !dark; ++r)
        for (int c = 0; c < out.cols && !dark; ++c) {
            const auto level = scene.water_level_m(x_of(c), y_of(r));
            dark = level && out.height_m[std::size_t(r) * std::size_t(out.cols) + std::size_t(c)] >
                                *level - out.softness_m;
        }
    return dark ? std::optional(std::move(out)) : std::nullopt;
}

} // namespace tarn::scene
