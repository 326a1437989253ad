#include "scene/samples.hpp"

#include "core/parallel.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace tarn::scene {

namespace {

/// Fills everything at or below the level that is connected to the middle (8 neighbours).
Scene fill(const std::function<double(double, double)>& height, int side, double half_m,
           double level_m) {
    Scene scene;
    std::vector<float> z(std::size_t(side) * std::size_t(side));
    const double s = 2.0 * half_m / (side - 1);
    share_out(side, 0, [&](int first, int last) {
        for (int row = first; row < last; ++row)
            for (int col = 0; col < side; ++col)
                z[std::size_t(row) * std::size_t(side) + std::size_t(col)] =
                    static_cast<float>(height(-half_m + col * s, half_m - row * s));
    });
    scene.ground = quantise(z, {side, side}, s, 4);
    scene.ground.west_m = -half_m;
    scene.ground.north_m = half_m;
    scene.water = scene.ground;
    std::fill(scene.water.codes.values.begin(), scene.water.codes.values.end(), no_water_code);
    scene.water.scale_m = 0.001;
    scene.water.offset_m = level_m - 0.001;

    LakeRecord lake;
    lake.id = 1;
    lake.name = "sample";
    lake.level_m = level_m;
    Grid<unsigned char> wet({side, side});
    std::vector<Node> queue = {{side / 2, side / 2}};
    wet[queue[0]] = 1;
    lake.seed = lake.west_north = lake.east_south = queue[0];
    double depth_sum = 0.0, deepest = 0.0;
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const Node at = queue[i];
        const double depth = level_m - scene.ground.elevation_m(at);
        depth_sum += depth;
        if (depth > deepest) {
            deepest = depth;
            lake.seed = at;
        }
        lake.west_north = {std::min(lake.west_north.col, at.col),
                           std::min(lake.west_north.row, at.row)};
        lake.east_south = {std::max(lake.east_south.col, at.col),
                           std::max(lake.east_south.row, at.row)};
        for (int dr = -1; dr <= 1; ++dr)
            for (int dc = -1; dc <= 1; ++dc) {
                const Node n{at.col + dc, at.row + dr};
                if (!wet.contains(n))
                    continue;
                scene.water.codes[n] = 1;
                if (!wet[n] && scene.ground.elevation_m(n) < level_m) {
                    wet[n] = 1;
                    queue.push_back(n);
                }
            }
    }
    lake.area_m2 = lake.true_area_m2 = double(queue.size()) * s * s;
    lake.volume_m3 = depth_sum * s * s;
    lake.max_depth_m = deepest;
    lake.mean_depth_m = depth_sum / double(queue.size());
    scene.lakes = {lake};
    scene.frame.proj = "+proj=tmerc +lat_0=0 +lon_0=0 +k=1 +datum=WGS84 +units=m +no_defs";
    return scene;
}

/// Integer-lattice value noise with a quintic ramp; any hash would do, this one is fixed.
double noise(double x, double y) {
    const auto value = [](long i, long j) {
        auto h = static_cast<std::uint32_t>(i) * 0x8da6b343u ^
                 static_cast<std::uint32_t>(j) * 0xd8163841u;
        h = (h ^ (h >> 15)) * 0x2c1b3c6du;
        h = (h ^ (h >> 12)) * 0x297a2d39u;
        return double((h ^ (h >> 15)) >> 8) / double(1u << 24);
    };
    const double fx = std::floor(x), fy = std::floor(y);
    const long i = long(fx), j = long(fy);
    const auto ramp = [](double t) { return t * t * t * (t * (t * 6 - 15) + 10); };
    const double u = ramp(x - fx), v = ramp(y - fy);
    return (value(i, j) * (1 - u) + value(i + 1, j) * u) * (1 - v) +
           (value(i, j + 1) * (1 - u) + value(i + 1, j + 1) * u) * v;
}

double mountains(double x, double y) {
    const double r = std::hypot(x * 0.85, y);
    double relief = 0.0, ridge = 0.0, amplitude = 1.0, wavelength = 5200.0;
    for (int octave = 0; octave < 10; ++octave) {
        const double n = noise(x / wavelength + 17.3 * octave, y / wavelength - 9.1 * octave);
        relief += amplitude * (n - 0.5);
        ridge += amplitude * (1.0 - std::abs(2.0 * n - 1.0));
        amplitude *= 0.48;
        wavelength *= 0.5;
    }
    const double basin = 1.0 - std::exp(-std::pow(r / 3400.0, 3.0));
    const double land = 900.0 + 700.0 * basin + basin * (620.0 * relief + 420.0 * (ridge - 1.2));
    const double bed = 790.0 + 90.0 * relief;
    const double blend = std::clamp((r - 1700.0) / 1900.0, 0.0, 1.0);
    const double smooth = blend * blend * (3.0 - 2.0 * blend);
    const double island =
        210.0 * std::exp(-(std::pow(x - 700.0, 2) + std::pow(y + 500.0, 2)) / 9.0e4);
    return bed * (1.0 - smooth) + land * smooth + island;
}

} // namespace

Scene bowl(int side) {
    Scene scene = fill([](double x, double y) { return 40.0 * (x * x + y * y) / (500.0 * 500.0); },
                       side, 500.0, 10.0);
    scene.look = {.tree_line_m = 1900.0, .snow_line_m = 2700.0};
    return scene;
}

Scene mountain_lake(int side) {
    Scene scene = fill(mountains, side, 8000.0, 930.0);
    scene.look = {.tree_line_m = 1500.0, .snow_line_m = 1850.0};
    return scene;
}

Scene tank() {
    return fill(
        [](double x, double y) { return std::max(std::abs(x), std::abs(y)) > 99.5 ? 1.0 : -8.0; },
        201, 100.0, 0.0);
}

} // namespace tarn::scene
