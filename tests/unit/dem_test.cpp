// Filling, flats, voids, the shoreline rule and statistics, on grids with known answers.
#include "core/error.hpp"
#include "dem/bed.hpp"
#include "dem/fill.hpp"
#include "dem/flat.hpp"
#include "dem/statistics.hpp"
#include "dem/voids.hpp"
#include "dem/water.hpp"
#include "geo/frame.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <rapidcheck.h>

using namespace tarn;
using namespace tarn::dem;

namespace {

/// A grid from rows of characters: digits are heights, '?' is a void.
Grid<float> picture(const std::vector<std::string>& rows) {
    Grid<float> z({int(rows[0].size()), int(rows.size())});
    for (int r = 0; r < z.size.rows; ++r)
        for (int c = 0; c < z.size.cols; ++c) {
            const char ch = rows[std::size_t(r)][std::size_t(c)];
            z[{c, r}] = ch == '?' ? std::numeric_limits<float>::quiet_NaN() : float(ch - '0');
        }
    return z;
}

std::string show(const Grid<unsigned char>& mask) {
    std::string out;
    for (int r = 0; r < mask.size.rows; ++r) {
        for (int c = 0; c < mask.size.cols; ++c)
            out += mask[{c, r}] ? '#' : '.';
        out += '\n';
    }
    return out;
}

} // namespace

TEST(Fill, FollowsConnectionOverEightNeighboursAndLeavesOtherBasinsDry) {
    const Grid<float> z = picture({"9999999999",
                                   "9139999119", // the pond on the right is lower than the level,
                                   "9929999119", // but nothing joins it to the seed
                                   "9991999999", // joined by its corner only
                                   "9999999999"});
    bool open = true;
    const auto wet = fill_from(z, Grid<unsigned char>(z.size), 3.0, {1, 1}, &open);
    EXPECT_EQ(show(wet), "..........\n.##.......\n..#.......\n...#......\n..........\n");
    EXPECT_FALSE(open);
    EXPECT_THROW(fill_from(z, Grid<unsigned char>(z.size), 3.0, {4, 1}), Error);
}

TEST(Fill, TheLevelItselfIsWetInSpiteOfFloat32) {
    Grid<float> z({5, 5}, 1882.01f); // 1882.0100098 in float32
    EXPECT_EQ(show(fill_from(z, Grid<unsigned char>(z.size), 1882.01, {2, 2})),
              "#####\n#####\n#####\n#####\n#####\n");
}

TEST(Fill, AFloorKeepsALakeFromRunningOutOverAnUnseenDam) {
    const Grid<float> z = picture({"99999999", "95555311", "95555311", "99999999"});
    const auto wet = fill_from(z, Grid<unsigned char>(z.size), 5.0, {1, 1}, nullptr, 4.0);
    EXPECT_EQ(show(wet), "........\n.####...\n.####...\n........\n");
}

TEST(Fill, TheLargestClosedBasinIsTheLakeNotTheOpenLowland) {
    const Grid<float> z = picture({"1111111111", "1111111111", "9999999999", "9922299999",
                                   "9922299119", "9999999119", "9999999999"});
    const auto basins = find_basins(z, Grid<unsigned char>(z.size), 3.0);
    ASSERT_EQ(basins.size(), 3u);
    EXPECT_EQ(basins[0].nodes, 20u);
    EXPECT_TRUE(basins[0].open_at_edge);
    const auto lake = largest_lake(basins);
    ASSERT_TRUE(lake.has_value());
    EXPECT_EQ(lake->nodes, 6u);
    EXPECT_FALSE(largest_lake({}).has_value());
}

TEST(Flat, FindsLakesAndNotTheLongRunsOfWholeMetreSlopes) {
    Grid<float> z({60, 40});
    for (int r = 0; r < 40; ++r)
        for (int c = 0; c < 60; ++c)
            z[{c, r}] = float(c / 2); // steps two nodes wide: long, thin, equal
    for (int r = 10; r < 22; ++r)
        for (int c = 20; c < 34; ++c)
            z[{c, r}] = 7.0f;
    const auto flats = find_flats(z);
    ASSERT_EQ(flats.size(), 1u);
    EXPECT_EQ(flats[0].level_m, 7.0f);
    EXPECT_EQ(flats[0].nodes, 12u * 14u);
    EXPECT_FALSE(flats[0].touches_edge);
    EXPECT_NEAR(flats[0].deepest.col, 26.5, 2.0);
    EXPECT_NEAR(flats[0].deepest.row, 15.5, 2.0);
    keep_only_flats(z);
    EXPECT_TRUE(std::isnan(z[Node(0, 0)]));
    EXPECT_EQ(z[Node(25, 15)], 7.0f);
}

TEST(Voids, InsideIsInterpolatedAndOutsideIsNeverFlooded) {
    Grid<float> z = picture({"??555555", "?5555555", "555?5555", "55555555", "55555555"});
    const Voids voids = fill_voids(z);
    EXPECT_EQ(voids.count, 4u);
    EXPECT_EQ(voids.inside, 1u);
    EXPECT_EQ(show(voids.outside), "##......\n#.......\n........\n........\n........\n");
    EXPECT_FLOAT_EQ(z[Node(3, 2)], 5.0f);
    for (const float value : z.values)
        EXPECT_TRUE(std::isfinite(value));
    bool open = false;
    const auto wet = fill_from(z, voids.outside, 6.0, {4, 3}, &open);
    EXPECT_FALSE(wet[Node(0, 0)]);
    EXPECT_TRUE(open);
    Grid<float> empty({3, 3}, std::numeric_limits<float>::quiet_NaN());
    EXPECT_THROW(fill_voids(empty), Error);
}

TEST(Voids, InterpolationIsTheMeanInTheMiddleOfASlope) {
    Grid<float> z({41, 41});
    for (int r = 0; r < 41; ++r)
        for (int c = 0; c < 41; ++c)
            z[{c, r}] = std::abs(c - 20) <= 3 && std::abs(r - 20) <= 3 ? NAN : float(100 + c);
    interpolate_voids(z, 100);
    // Inverse distances over a hole of 7 nodes: within the hole's own half range of the plane.
    EXPECT_NEAR(z[Node(20, 20)], 120.0, 3.5);
    for (int c = 17; c <= 23; ++c) // and never beyond its rim
        EXPECT_NEAR(z[Node(c, 20)], 120.0, 4.0);
}

// The shoreline rule, on random grounds and levels: no water outside the lake anywhere in any cell,
// wet nodes at the level, and the drawn shore is where the ground crosses it.
TEST(Water, ShowsInTheLakeAndNowhereElse) {
    const bool held = rc::check("no leak", [] {
        const int cols = *rc::gen::inRange(6, 24), rows = *rc::gen::inRange(6, 24);
        const auto seed = *rc::gen::arbitrary<std::uint32_t>();
        std::mt19937 random(seed);
        std::uniform_int_distribution<int> step(0, 12);
        Grid<float> z({cols, rows});
        for (float& v : z.values)
            v = float(step(random)); // few values, so that nodes AT the level are common
        const double level =
            double(*rc::gen::inRange(1, 12)) + (*rc::gen::inRange(0, 2) ? 0.0 : 0.37);
        const auto basins = find_basins(z, Grid<unsigned char>(z.size), level);
        RC_PRE(!basins.empty());
        WetLake lake{level, fill_from(z, Grid<unsigned char>(z.size), level, basins[0].seed)};
        Heightfield ground = quantise(z.values, z.size, 10.0, 4);
        RC_ASSERT(separate(ground, lake) == 0u); // a filled lake needs no dams
        const Heightfield water = water_surface(ground, std::span(&lake, 1));
        for (int r = 0; r + 1 < rows; ++r)
            for (int c = 0; c + 1 < cols; ++c) {
                const Node corner[4] = {{c, r}, {c + 1, r}, {c, r + 1}, {c + 1, r + 1}};
                int wet = 0, carry = 0;
                for (const Node n : corner) {
                    wet += lake.wet[n];
                    carry += water.codes[n] != no_water_code;
                    if (lake.wet[n]) {
                        RC_ASSERT(std::abs(water.elevation_m(n) - level) <= 1e-3);
                        RC_ASSERT(ground.elevation_m(n) < level);
                    } else if (water.codes[n] != no_water_code) {
                        RC_ASSERT(ground.elevation_m(n) > level);
                    }
                }
                if (wet > 0)
                    RC_ASSERT(carry == 4); // flat at the level over the whole cell
                else if (carry == 4) // drawn as water patch: must lie below the ground everywhere
                    for (const Node n : corner)
                        RC_ASSERT(ground.elevation_m(n) > water.elevation_m(n));
            }
    });
    EXPECT_TRUE(held);
}

TEST(Water, SeveralLakesKeepTheirLevelsToAMillimetre) {
    // 280 m apart: 16 bits alone would give steps of 4 mm.
    const double levels[] = {720.12, 829.0, 896.37, 899.81, 984.05};
    Grid<float> z({60, 12}, 2000.0f);
    std::vector<WetLake> lakes;
    for (int i = 0; i < 5; ++i) {
        WetLake lake{levels[i], Grid<unsigned char>(z.size)};
        for (int r = 3; r < 9; ++r)
            for (int c = 12 * i + 3; c < 12 * i + 9; ++c) {
                z[{c, r}] = float(levels[i] - 5.0);
                lake.wet[{c, r}] = 1;
            }
        lakes.push_back(lake);
    }
    Heightfield ground = quantise(z.values, z.size, 30.0, 4);
    const Heightfield water = water_surface(ground, lakes);
    for (int i = 0; i < 5; ++i) {
        EXPECT_NEAR(water.elevation_m(Node{12 * i + 5, 5}), levels[i], 1e-3);
        EXPECT_NEAR(water.elevation_m(Node{12 * i + 2, 5}), levels[i], 1e-3); // the dry margin
    }
    EXPECT_EQ(water.codes[Node(0, 0)], no_water_code);
}

TEST(Statistics, OfTheBowlAreThoseOfItsFormula) {
    const double s = 4.0;
    const int side = 301;
    Grid<float> z({side, side});
    for (int r = 0; r < side; ++r)
        for (int c = 0; c < side; ++c)
            z[{c, r}] =
                float(40.0 * (std::pow((c - 150) * s, 2) + std::pow((r - 150) * s, 2)) / 250'000.0);
    for (int r = 148; r <= 152; ++r) // an island of 5 x 5 nodes off the middle
        for (int c = 118; c <= 122; ++c)
            z[{c, r}] = 15.0f;
    WetLake lake{10.0, fill_from(z, Grid<unsigned char>(z.size), 10.0, {150, 150})};
    Heightfield ground = quantise(z.values, z.size, s, 4);
    separate(ground, lake);
    LakeRecord record;
    record.level_m = 10.0;
    measure(record, ground, lake.wet, geo::local_frame({45, 8}));
    const double r = 250.0, island = 25 * s * s;
    EXPECT_NEAR(record.area_m2, M_PI * r * r - island, 2e-3 * M_PI * r * r);
    EXPECT_NEAR(record.true_area_m2, record.area_m2, 1e-5 * record.area_m2); // near the origin
    EXPECT_NEAR(*record.max_depth_m, 10.0, 2 * ground.scale_m);
    // Island nodes stood in about 10 - 40 (120/500)^2 = 7.7 m of water.
    EXPECT_NEAR(*record.volume_m3, M_PI * r * r * 5.0 - island * 7.7, 3e-3 * M_PI * r * r * 5.0);
    EXPECT_EQ(record.islands, 1);
    // The island's shore: a square whose sides are crossed at 7.7 / (7.7 + 5) of a cell outside it.
    const double wide = 4 * s + 2 * s * 5.0 / 12.7;
    EXPECT_NEAR(record.shoreline_m, 2 * M_PI * r + 4 * wide, 0.02 * 2 * M_PI * r);
    EXPECT_NEAR(record.position.lat_deg, 45.0, 0.01);
    record.bed = Bed::unknown;
    measure(record, ground, lake.wet, geo::local_frame({45, 8}));
    EXPECT_FALSE(record.volume_m3.has_value());
}

TEST(Statistics, TrueAreaIsTheGeodesicOne) {
    // A rectangle of nodes far from the central meridian of a UTM zone: scale factor 1.0011.
    geo::Frame frame = geo::local_frame({45, 0});
    frame.scale0 = 0.9996;
    frame.origin_easting_m = 350'000; // from the meridian: false easting is 0 here
    frame.origin_northing_m = 0;
    Grid<float> z({202, 152}, 50.0f);
    WetLake lake{10.0, Grid<unsigned char>(z.size)};
    for (int r = 1; r < 151; ++r)
        for (int c = 1; c < 201; ++c) {
            z[{c, r}] = 5.0f;
            lake.wet[{c, r}] = 1;
        }
    Heightfield ground = quantise(z.values, z.size, 100.0, 4);
    LakeRecord record;
    record.level_m = 10.0;
    measure(record, ground, lake.wet, frame);
    std::vector<GeoPoint> outline; // the outer edges of the wet nodes' squares, densely
    const auto add = [&](double c, double r) {
        outline.push_back(geo::to_geo(frame, {c * 100, -r * 100}));
    };
    for (int i = 0; i < 200; ++i)
        add(0.5 + i, 0.5);
    for (int i = 0; i < 150; ++i)
        add(200.5, 0.5 + i);
    for (int i = 0; i < 200; ++i)
        add(200.5 - i, 150.5);
    for (int i = 0; i < 150; ++i)
        add(0.5, 150.5 - i);
    EXPECT_NEAR(record.true_area_m2 / geo::geodesic_area_m2(outline), 1.0, 1e-5);
    EXPECT_GT(record.area_m2 / record.true_area_m2, 1.001);
}

TEST(Bed, BathymetryIsReadAsDepthsOfEitherSignOrAsElevations) {
    Grid<float> z({40, 40}, 110.0f);
    Grid<unsigned char> wet(z.size);
    Grid<float> depth(z.size, NAN);
    for (int r = 5; r < 35; ++r)
        for (int c = 5; c < 35; ++c) {
            z[{c, r}] = 100.0f;
            wet[{c, r}] = 1;
            const int in = std::min({c - 5, r - 5, 34 - c, 34 - r});
            if (in >= 3) // the survey stops three nodes from the shore
                depth[{c, r}] = 0.5f * float(in);
        }
    const auto apply = [&](float sign, float datum, BathymetryKind kind) {
        Grid<float> ground = z, survey = depth;
        for (float& v : survey.values)
            v = datum + sign * v;
        merge_bathymetry(ground, wet, wet, 100.0, survey, kind);
        return ground;
    };
    const auto a = apply(1, 0, BathymetryKind::automatic),
               b = apply(-1, 0, BathymetryKind::automatic);
    const auto c = apply(-1, 100, BathymetryKind::automatic);
    for (std::size_t i = 0; i < z.values.size(); ++i) {
        EXPECT_FLOAT_EQ(a.values[i], b.values[i]);
        EXPECT_NEAR(a.values[i], c.values[i], 1e-4);
    }
    EXPECT_NEAR(a[Node(20, 20)], 100.0 - 0.5 * 14, 1e-4);
    // Between survey and shore the bed rises steadily: no cliff at either end.
    double previous = a[Node(4, 20)] - 10.0; // the shore node's level, 100
    for (int k = 5; k <= 8; ++k) {
        EXPECT_LT(a[Node(k, 20)], previous + 1e-4);
        EXPECT_GT(a[Node(k, 20)], 100.0 - 1.6);
        previous = a[Node(k, 20)];
    }
    Grid<float> ground = z;
    EXPECT_THROW(
        merge_bathymetry(ground, wet, wet, 100.0, Grid<float>(z.size, NAN), BathymetryKind::depth),
        Error);
}

TEST(Bed, RoomForUnknownDepthPutsTheShoreMidwayBetweenNodes) {
    Grid<float> z({30, 30}, 104.0f);
    Grid<unsigned char> wet(z.size);
    for (int r = 8; r < 22; ++r)
        for (int c = 8; c < 22; ++c) {
            z[{c, r}] = 100.0f;
            wet[{c, r}] = 1;
        }
    EXPECT_EQ(make_room(z, wet, wet, 100.0), 14u * 14u);
    // Linear between the last wet and the first dry node: crosses the level halfway.
    EXPECT_NEAR((100.0 - z[Node(8, 15)]) / (z[Node(7, 15)] - z[Node(8, 15)]), 0.5, 1e-6);
}
