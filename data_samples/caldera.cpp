#include "caldera.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tarn::samples {

namespace {

constexpr double pi = 3.14159265358979323846;

/// Value noise with slope-continuous ramps: the roughness that no published figure gives.
double noise(double x, double y, std::uint32_t seed) {
    const auto value = [seed](long i, long j) {
        std::uint32_t h =
            std::uint32_t(i) * 0x9e3779b1u ^ std::uint32_t(j) * 0x85ebca77u ^ seed * 0xc2b2ae3du;
        h = (h ^ (h >> 15)) * 0x2c1b3c6du;
        h = (h ^ (h >> 12)) * 0x297a2d39u;
        return double((h ^ (h >> 15)) >> 8) / 16777216.0;
    };
    const double fx = std::floor(x), fy = std::floor(y);
    const auto ramp = [](double t) { return t * t * (3.0 - 2.0 * t); };
    const double u = ramp(x - fx), v = ramp(y - fy);
    const long i = long(fx), j = long(fy);
    return (value(i, j) * (1 - u) + value(i + 1, j) * u) * (1 - v) +
           (value(i, j + 1) * (1 - u) + value(i + 1, j + 1) * u) * v - 0.5;
}

double rough(double x, double y, double wavelength, int octaves, std::uint32_t seed) {
    double sum = 0.0, amplitude = 1.0;
    for (int k = 0; k < octaves; ++k) {
        const double c = std::cos(0.7 * (k + 1)), s = std::sin(0.7 * (k + 1));
        sum += amplitude * noise((c * x - s * y) / wavelength, (s * x + c * y) / wavelength,
                                 seed + std::uint32_t(k));
        amplitude *= 0.5;
        wavelength *= 0.5;
    }
    return sum;
}

/// Shape of the shore: 1 on average, wider east-west, with the bays of the real outline's order.
double outline(double angle) {
    return 1.0 + 0.095 * std::cos(2 * angle) + 0.022 * std::cos(3 * angle + 0.8) +
           0.018 * std::cos(5 * angle + 2.1) + 0.010 * std::cos(9 * angle + 0.3) +
           0.006 * std::cos(14 * angle + 1.7);
}

/// Rim height above the sea by direction (degrees counter-clockwise from east).
double rim_m(double angle) {
    struct Peak {
        double at_deg, height_m, width_deg;
    };
    static constexpr Peak peaks[] = {
        {165, 2484, 9},  // Hillman Peak
        {182, 2442, 8},  // The Watchman
        {128, 2453, 10}, // Llao Rock
        {18, 2458, 12},  // Cloudcap
        {262, 2455, 9},  // Garfield Peak
        {285, 2420, 10}, // Applegate Peak, Dutton Cliff side
        {340, 2330, 14}, // above Kerr Notch's northern side
    };
    // Joined by a fourth-power mean: the greater one rules, without a crease where two are equal.
    double sum = 0.0;
    for (const Peak& peak : peaks) {
        const double off = std::remainder(angle * 180.0 / pi - peak.at_deg, 360.0) / peak.width_deg;
        sum += std::pow((peak.height_m - 2135.0) * std::exp(-0.5 * off * off), 4.0);
    }
    return 2135.0 + std::pow(sum, 0.25);
}

struct Shape {
    double radius_m, profile;
};

double elevation(double x, double y, const Shape& shape) {
    const double angle = std::atan2(y, x), r = std::hypot(x, y);
    const double shore = shape.radius_m * outline(angle);
    const double share = r / shore;
    double z = 0.0;
    if (share < 1.0) {
        // Steep walls, flat floor; the greatest depth lies in the north-east.
        const double lean =
            1.0 - 0.10 * (1.0 - std::clamp(std::hypot(x - 1500.0, y - 1300.0) / 4500.0, 0.0, 1.0));
        z = caldera_level_m -
            caldera_depth_m * (1.0 - std::pow(share, shape.profile)) / lean * 0.93;
        z += 22.0 * rough(x, y, 1800.0, 5, 3u) * std::clamp((1.0 - share) * 6.0, 0.0, 1.0);
    } else {
        const double up = r - shore;
        const double rim = rim_m(angle) + 60.0 * rough(x, y, 1500.0, 4, 40u);
        const double wall = 0.70 + 0.25 * rough(x, y, 700.0, 3, 90u);
        const double reach = (rim - caldera_level_m) / wall;
        if (up < reach) {
            const double f = up / reach;
            const double gullies =
                26.0 * rough(x, y, 420.0, 5, 60u) * std::sin(pi * std::min(1.0, f));
            z = caldera_level_m + 1.0 + (rim - caldera_level_m - 1.0) * std::pow(f, 0.9) +
                gullies * std::min(1.0, up / 150.0);
            z = std::max(z, caldera_level_m + 0.02 * up + 0.2);
        } else {
            const double out = up - reach;
            const double fall = 560.0 * (1.0 - std::exp(-out / 4200.0)) * (rim - 1560.0) / 600.0;
            z = rim - fall + 120.0 * rough(x, y, 2600.0, 8, 7u) * std::min(1.0, out / 600.0);
        }
    }
    // Mount Scott, a cone east of the rim.
    const double scott = std::hypot(x - 7700.0, y + 1600.0);
    z = std::max(z, 2721.0 - 0.42 * scott +
                        30.0 * rough(x, y, 600.0, 4, 21u) * std::min(1.0, scott / 300.0));
    // Wizard Island: a cinder cone on an apron of lava.
    const double wizard = std::hypot(x + 3050.0, y + 650.0);
    const double coast =
        638.0 * (1.0 + 0.12 * std::cos(3.0 * std::atan2(y + 650.0, x + 3050.0) + 1.0));
    const double off_coast = std::max(0.0, wizard - coast);
    const double apron =
        caldera_level_m + 16.0 * (1.0 - std::pow(std::min(wizard / coast, 1.0), 2.0)) -
        0.05 * off_coast - 0.45 * off_coast * off_coast / (off_coast + 150.0) +
        5.0 * rough(x, y, 260.0, 4, 33u) * std::clamp(1.0 - wizard / coast, 0.0, 1.0);
    const double crater = 27.0 * std::exp(-std::pow(wizard / 60.0, 2.0));
    const double cone = 2113.0 - 0.60 * std::max(0.0, wizard - 95.0) - crater;
    return std::max({z, apron, cone});
}

Grid<float> build(const Shape& shape, double spacing, int side) {
    Grid<float> z({side, side});
    const double half = 0.5 * (side - 1) * spacing;
    for (int row = 0; row < side; ++row)
        for (int col = 0; col < side; ++col)
            z[{col, row}] =
                static_cast<float>(elevation(col * spacing - half, half - row * spacing, shape));
    return z;
}

void measure(Caldera& c) {
    // Flooded from the middle over nodes at or below the level, 8 neighbours.
    Grid<unsigned char> wet(c.elevation_m.size);
    std::vector<Node> queue = {{wet.size.cols / 2, wet.size.rows / 2}};
    wet[queue[0]] = 1;
    c.area_m2 = c.volume_m3 = c.max_depth_m = 0.0;
    const double cell = c.spacing_m * c.spacing_m;
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const Node at = queue[i];
        const double depth = caldera_level_m - c.elevation_m[at];
        c.area_m2 += cell;
        c.volume_m3 += depth * cell;
        c.max_depth_m = std::max(c.max_depth_m, depth);
        for (int k = 0; k < 9; ++k) {
            const Node n{at.col + k % 3 - 1, at.row + k / 3 - 1};
            if (wet.contains(n) && !wet[n] && c.elevation_m[n] <= caldera_level_m) {
                wet[n] = 1;
                queue.push_back(n);
            }
        }
    }
}

} // namespace

Caldera make_caldera(double spacing_m) {
    Caldera out;
    out.spacing_m = spacing_m;
    const int side = int(std::lround(21'000.0 / spacing_m));
    Shape shape{.radius_m = 4100.0, .profile = 4.0};
    for (int turn = 0; turn < 14; ++turn) {
        out.elevation_m = build(shape, spacing_m, side);
        // The floor is pressed or lifted to the published depth; the shore stays where it is.
        measure(out);
        const double press = caldera_depth_m / out.max_depth_m;
        for (float& z : out.elevation_m.values)
            if (z < caldera_level_m)
                z = static_cast<float>(caldera_level_m - (caldera_level_m - z) * press);
        measure(out);
        const double area = out.area_m2 / caldera_area_m2,
                     volume = out.volume_m3 / caldera_volume_m3;
        if (std::abs(area - 1.0) < 1e-3 && std::abs(volume - 1.0) < 1e-3)
            break;
        shape.radius_m /= std::sqrt(area);
        // Mean over greatest depth of 1 - s^p over a disc is p / (p + 2).
        shape.profile = std::clamp(shape.profile / std::pow(volume / area, 2.2), 0.5, 40.0);
    }
    // The lake's middle: 42.9446 N, 122.1090 W, in UTM zone 10N (WGS 84).
    const double east = 572'700.0, north = 4'755'200.0;
    out.west_m = std::round((east - 0.5 * side * spacing_m) / spacing_m) * spacing_m;
    out.north_m = std::round((north + 0.5 * side * spacing_m) / spacing_m) * spacing_m;
    return out;
}

} // namespace tarn::samples
