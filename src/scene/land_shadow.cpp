#include "scene/land_shadow.hpp"

#include "core/parallel.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::scene {

namespace {

constexpr double nothing_m = -1e9;

/// Cells and the heights that cast shadows, then how high those reach.
struct Cells {
    const Heightfield& ground;
    LandShadow out;
    double wide_m = 1.0, high_m = 1.0; ///< of a cell

    Cells(const Heightfield& g, int most) : ground(g) {
        const double east_m = (ground.size().cols - 1) * ground.spacing_m,
                     south_m = (ground.size().rows - 1) * ground.spacing_m;
        const double cell_m = std::max(std::max(east_m, south_m) / most, ground.spacing_m);
        out.cols = std::max(2, int(std::ceil(east_m / cell_m)));
        out.rows = std::max(2, int(std::ceil(south_m / cell_m)));
        wide_m = east_m / out.cols;
        high_m = south_m / out.rows;
        out.height_m.resize(std::size_t(out.cols) * std::size_t(out.rows));
    }
    double x_of(int col) const { return ground.west_m + (col + 0.5) * wide_m; }
    double y_of(int row) const { return ground.north_m - (row + 0.5) * high_m; }
    std::size_t index(int col, int row) const {
        return std::size_t(row) * std::size_t(out.cols) + std::size_t(col);
    }

    template <class Height>
    void fill(Height height_m) {
        share_out(out.rows, 0, [&](int first, int last) {
            for (int r = first; r < last; ++r)
                for (int c = 0; c < out.cols; ++c)
                    out.height_m[index(c, r)] = float(height_m(x_of(c), y_of(r)));
        });
    }

    void cast(glm::dvec3 sun);
};

void Cells::cast(glm::dvec3 sun) {
    const double flat = std::hypot(sun.x, sun.y), cell_m = std::max(wide_m, high_m);
    const double fall = cell_m * sun.z / flat; // of the beam over a step
    out.softness_m = std::max(0.5 * fall, 0.01);
    std::vector<float> next(out.height_m.size());
    // The place itself is not in its own way: the first look is a step ahead.
    const auto look = [&](const std::vector<float>& values, double col, double row) {
        if (col < 0.0 || row < 0.0 || col > out.cols - 1.0 || row > out.rows - 1.0)
            return nothing_m;
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
    const double across = cell_m * sun.x / flat / wide_m, down = -cell_m * sun.y / flat / high_m;
    double step = 1.0;
    bool shift = true; // first: from heights to what one step sees
    while (step < 2.0 * std::max(out.cols, out.rows)) {
        share_out(out.rows, 0, [&](int first, int last) {
            for (int r = first; r < last; ++r)
                for (int c = 0; c < out.cols; ++c) {
                    const std::size_t i = index(c, r);
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
}

/// Is there sun, and does it stand beside the zenith?
bool casts_shadows(glm::dvec3 sun) { return sun.z > 0.0 && std::hypot(sun.x, sun.y) > 1e-6; }

} // namespace

std::optional<LandShadow> land_shadow(const Scene& scene, glm::dvec3 sun, int most) {
    if (!casts_shadows(sun))
        return {};
    Cells cells(scene.ground, most);
    cells.fill([&](double x, double y) { return scene.ground.elevation_m(x, y); });
    cells.cast(sun);
    bool dark = false;
    for (int r = 0; r < cells.out.rows && !dark; ++r)
        for (int c = 0; c < cells.out.cols && !dark; ++c) {
            const auto level = scene.water_level_m(cells.x_of(c), cells.y_of(r));
            dark = level &&
                   double(cells.out.height_m[cells.index(c, r)]) > *level - cells.out.softness_m;
        }
    return dark ? std::optional(std::move(cells.out)) : std::nullopt;
}

std::optional<LandShadow> bed_shadow(const Scene& scene, glm::dvec3 below, int most) {
    if (!casts_shadows(below))
        return {};
    Cells cells(scene.ground, most);
    // What stands above the level is in nobody's way: there the light is in the air. Beyond the
    // shore no light of the water comes by.
    const Heightfield& water = scene.water;
    cells.fill([&](double x, double y) {
        const Node node{std::clamp(int(std::lround(water.col(x))), 0, water.size().cols - 1),
                        std::clamp(int(std::lround(water.row(y))), 0, water.size().rows - 1)};
        return water.codes[node] == no_water_code
                   ? nothing_m
                   : std::min(scene.ground.elevation_m(x, y), water.elevation_m(node));
    });
    cells.cast(below);
    bool dark = false;
    for (int r = 0; r < cells.out.rows && !dark; ++r)
        for (int c = 0; c < cells.out.cols && !dark; ++c) {
            const double x = cells.x_of(c), y = cells.y_of(r);
            dark = scene.water_level_m(x, y) &&
                   double(cells.out.height_m[cells.index(c, r)]) >
                       scene.ground.elevation_m(x, y) + cells.out.softness_m;
        }
    return dark ? std::optional(std::move(cells.out)) : std::nullopt;
}

} // namespace tarn::scene
