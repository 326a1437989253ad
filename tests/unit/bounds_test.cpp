// What walks skip by, against brute force: cones and safety radii that hold for the bilinear
// surface everywhere, not only at its nodes.
#include "core/cone_map.hpp"
#include "core/safety_radius.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;

namespace {

/// Small fields of every kind that has broken such bounds: random, smooth, saddles, spikes, steps,
/// planes.
Heightfield small_field(std::mt19937& random, int kind) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::uniform_int_distribution<int> side(2, 12);
    Heightfield field;
    field.codes = Grid<std::uint16_t>({side(random), side(random)});
    field.spacing_m = 1.0;
    field.scale_m = 1.0;
    const double a = 40 * (unit(random) - 0.5), b = 40 * (unit(random) - 0.5),
                 c = 8 * (unit(random) - 0.5), d = 8 * (unit(random) - 0.5),
                 e = 12 * (unit(random) - 0.5);
    for (int r = 0; r < field.size().rows; ++r)
        for (int q = 0; q < field.size().cols; ++q) {
            double z = 0;
            switch (kind % 6) {
            case 0:
                z = 1000 * unit(random);
                break;
            case 1:
                z = 500 + a * q + b * r + c * q * q + d * r * r + e * q * r;
                break;
            case 2:
                z = unit(random) < 0.1 ? 5000 * unit(random) : 10;
                break;
            case 3:
                z = (q / 3 + r / 2) % 2 * 300;
                break;
            case 4:
                z = 500 + a * q + b * r;
                break;
            default:
                z = 300 + 200 * std::sin(0.7 * q + a) * std::cos(0.5 * r + b);
                break;
            }
            field.codes[{q, r}] = static_cast<std::uint16_t>(std::clamp(z, 0.0, 65535.0) + 0.5);
        }
    return field;
}

double height(const Heightfield& f, double col, double row) {
    return f.elevation_m(f.x_m(col), f.y_m(row));
}

/// Times that the ray crosses the surface from one side to the other within the square of
/// (2n - 1)^2 cells around a cell: both of the bilinear patches' own roots, in each cell, by a fine
/// march.
int crossings(const Heightfield& f, Node cell, int n, double col, double row, double z, double dc,
              double dr, double dz) {
    const double low_c = std::max(0, cell.col - n + 1),
                 high_c = std::min(f.size().cols - 1, cell.col + n);
    const double low_r = std::max(0, cell.row - n + 1),
                 high_r = std::min(f.size().rows - 1, cell.row + n);
    int count = 0;
    bool above = true;
    const double step = 0.004;
    for (double t = 0;; t += step) {
        const double c = col + t * dc, r = row + t * dr;
        if (c < low_c || c > high_c || r < low_r || r > high_r)
            return count;
        const double gap = z + t * dz - height(f, c, r);
        if (above ? gap < -1e-6 : gap > 1e-6) { // a touch is no crossing
            above = !above;
            ++count;
        }
    }
}

} // namespace

TEST(ConeMap, HoldsForEveryPlaceOfTheSurfaceNotOnlyForNodes) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    long checked = 0;
    double tightest = 1e9;
    long with_free = 0;
    for (int i = 0; i < 3000; ++i) {
        const Heightfield ground = small_field(random, i);
        Heightfield water = ground;
        for (auto& code : water.codes.values)
            code = unit(random) < 0.4 ? no_water_code
                                      : static_cast<std::uint16_t>(900 * unit(random) + 1);
        const bool with_water = i % 2 == 1;
        const int shift = i % 3;
        const ConeMap map = cone_map(ground, with_water ? &water : nullptr, shift, 1 + i % 2);
        const auto surface = [&](double c, double r) {
            double z = height(ground, c, r);
            const Node n{std::min(int(c), ground.size().cols - 2),
                         std::min(int(r), ground.size().rows - 2)};
            bool wet = with_water;
            for (int k = 0; k < 4 && wet; ++k)
                wet = water.codes[{n.col + k % 2, n.row + k / 2}] != no_water_code;
            return wet ? std::max(z, height(water, c, r)) : z;
        };
        const int side = 1 << shift, last_c = ground.size().cols - 1,
                  last_r = ground.size().rows - 1;
        for (int br = 0; br < map.blocks.rows; ++br)
            for (int bc = 0; bc < map.blocks.cols; ++bc) {
                const std::size_t block =
                    std::size_t(br) * std::size_t(map.blocks.cols) + std::size_t(bc);
                const double top = map.top_m(block), slope = map.slope_m_per_cell(block);
                const int free = map.free_cells(block);
                if (free > 0)
                    ++with_free;
                const double x0 = bc * side, y0 = br * side,
                             x1 = std::min(last_c, bc * side + side),
                             y1 = std::min(last_r, br * side + side);
                for (int k = 0; k < 60; ++k) {
                    // Anywhere in the field, often close to the block and on grid lines.
                    double c = last_c * unit(random), r = last_r * unit(random);
                    if (k % 3 == 0) {
                        c = std::clamp(x0 + (x1 - x0) * unit(random) + 2 * unit(random) - 1, 0.0,
                                       double(last_c));
                        r = std::clamp(y0 + (y1 - y0) * unit(random) + 2 * unit(random) - 1, 0.0,
                                       double(last_r));
                    }
                    if (k % 4 == 0)
                        c = std::round(c);
                    const double d =
                        std::max({0.0, x0 - c, c - x1}) + std::max({0.0, y0 - r, r - y1});
                    const double room = top + slope * d - surface(c, r);
                    ASSERT_GE(room, -1e-9) << "field " << i << ", block " << bc << "," << br
                                           << " at " << c << "," << r;
                    tightest = std::min(tightest, room);
                    if (d <= free)
                        ASSERT_GE(top - surface(c, r), -1e-9) << "field " << i << ", free " << free;
                    ++checked;
                }
            }
    }
    EXPECT_GT(with_free, 1000);
    EXPECT_LT(tightest, 1e-6); // somewhere the bound is reached: it is not merely huge
    std::printf("%ld places\n", checked);
}

TEST(ConeMap, MarksWaterOnlyWhereThereIsSomeNearby) {
    std::mt19937 random(2);
    const Heightfield ground = small_field(random, 0);
    Heightfield wide = ground;
    wide.codes = Grid<std::uint16_t>({40, 30}, 100);
    Heightfield water = wide;
    std::fill(water.codes.values.begin(), water.codes.values.end(), no_water_code);
    water.codes[{20, 15}] = 120;
    const ConeMap map = cone_map(wide, &water, 1);
    for (int r = 0; r < map.blocks.rows; ++r)
        for (int c = 0; c < map.blocks.cols; ++c) {
            const bool odd =
                map.water_near(std::size_t(r) * std::size_t(map.blocks.cols) + std::size_t(c));
            const int dc = std::max({0, 2 * c - 20, 20 - 2 * c - 2}),
                      dr = std::max({0, 2 * r - 15, 15 - 2 * r - 2});
            EXPECT_EQ(odd, dc <= 3 && dr <= 3) << c << "," << r;
        }
}

TEST(SafetyRadius, NoRayThatStartsAboveACellMeetsTheSurfaceTwiceWithinIt) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    long rays = 0, met = 0;
    for (int i = 0; i < 4000; ++i) {
        const Heightfield f = small_field(random, i);
        const Grid<std::uint8_t> radii = safety_radii(f, 1 + i % 2);
        for (int k = 0; k < 12; ++k) {
            const Node cell{int(radii.size.cols * unit(random)),
                            int(radii.size.rows * unit(random))};
            const int n = radii[cell];
            if (n == 0)
                continue;
            double top = 0;
            for (int q = 0; q < 4; ++q)
                top = std::max(top, f.elevation_m(Node{cell.col + q % 2, cell.row + q / 2}));
            // Started low and aimed along the ground, where double hits happen; at corners often.
            const double col = cell.col + (k % 3 ? unit(random) : std::round(unit(random)));
            const double row = cell.row + (k % 3 ? unit(random) : std::round(unit(random)));
            const double z = top + (k % 2 ? 1e-3 : 20 * unit(random));
            const double angle = 6.2831853 * unit(random);
            const double dc = std::cos(angle), dr = std::sin(angle);
            const double ahead_c = col + 3 * dc, ahead_r = row + 3 * dr;
            const double dz =
                k % 4 == 0 ? -300 * unit(random)
                           : (height(f, ahead_c, ahead_r) - z) / 3.0 + 4 * (unit(random) - 0.5);
            const int count = crossings(f, cell, n, col, row, z, dc, dr, dz);
            ASSERT_LE(count, 1) << "field " << i << " cell " << cell.col << "," << cell.row
                                << " radius " << n;
            met += count;
            ++rays;
        }
    }
    EXPECT_GT(rays, 5'000);
    EXPECT_GT(met, rays / 10);
    std::printf("%ld rays, %ld met the surface once\n", rays, met);
}

// The radius is the greatest one, up to 4: one more ring and a tangent rises above the cell's top.
TEST(SafetyRadius, IsTheGreatestOneByBruteForce) {
    std::mt19937 random(4);
    std::array<int, 6> seen{};
    long beyond = 0, equal_beyond = 0;
    for (int i = 0; i < 2000; ++i) {
        const Heightfield f = small_field(random, i);
        const Grid<std::uint8_t> radii = safety_radii(f);
        const auto corner = [&](int c, int r) { return double(f.codes[{c, r}]); };
        for (int r = 0; r < radii.size.rows; ++r)
            for (int c = 0; c < radii.size.cols; ++c) {
                const double top = std::max(
                    {corner(c, r), corner(c + 1, r), corner(c, r + 1), corner(c + 1, r + 1)});
                // First ring with a tangent plane above the top over some corner of the cell; the
                // derivative taken at points of each cell, not from the formula under test.
                int bad = 1000;
                for (int rr = 0; rr < radii.size.rows; ++rr)
                    for (int cc = 0; cc < radii.size.cols; ++cc)
                        for (const double u : {0.0, 1.0})
                            for (const double v : {0.0, 1.0}) {
                                const double nw = corner(cc, rr), ne = corner(cc + 1, rr),
                                             sw = corner(cc, rr + 1), se = corner(cc + 1, rr + 1);
                                const double z = (1 - u) * (1 - v) * nw + u * (1 - v) * ne +
                                                 (1 - u) * v * sw + u * v * se;
                                const double gx = (1 - v) * (ne - nw) + v * (se - sw);
                                const double gy = (1 - u) * (sw - nw) + u * (se - ne);
                                for (int k = 0; k < 4; ++k) {
                                    const double plane = z + gx * (c + k % 2 - (cc + u)) +
                                                         gy * (r + k / 2 - (rr + v));
                                    if (plane > top + 1e-9)
                                        bad = std::min(
                                            bad, std::max(std::abs(cc - c), std::abs(rr - r)));
                                }
                            }
                const int got = radii[{c, r}];
                if (bad <= 3) {
                    ASSERT_EQ(got, bad) << "field " << i;
                } else {
                    ASSERT_LE(got, bad == 1000 ? 255 : bad) << "field " << i;
                    ASSERT_GE(got, 4);
                    ++beyond;
                    equal_beyond += got >= std::min(bad, 8);
                }
                ++seen[std::size_t(std::min(got, 5))];
            }
    }
    for (const int n : seen)
        EXPECT_GT(n, 50); // every value up to 5 and more was tried
    std::printf("beyond 4: %ld cells, %ld of them certified as far as 8 or the truth\n", beyond,
                equal_beyond);
}

TEST(SafetyRadius, WaterThatMovesGetsOneCalmWaterEverything) {
    EXPECT_EQ(water_safety_radius(0.0, 1.0, 1.0, 0.01), 255);
    EXPECT_EQ(water_safety_radius(0.3, 5.0, 1.0, 0.001), 1);
    EXPECT_EQ(water_safety_radius(10.0, 2.0, 30.0, 0.05), 1);
    // Ripples below the quantum do not show: the constant grows.
    EXPECT_GT(water_safety_radius(0.001, 500.0, 1.0, 0.05), 10);
}
