// Filling, flats, voids, the shoreline rule and statistics, on grids with known answers.
#include "core/error.hpp"
#include "dem/bed.hpp"
#include "dem/fill.hpp"
#include "dem/flat.hpp"
#include "dem/lakes.hpp"
#include "dem/refill.hpp"
#include "dem/stages.hpp"
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

template <class T>
std::string show(const Grid<T>& mask) {
    std::string out;
    for (int r = 0; r < mask.size.rows; ++r) {
        for (int c = 0; c < mask.size.cols; ++c)
            out += mask[{c, r}] ? '#' : '.';
        out += '\n';
    }
    return out;
}

/// Fills from one seed into a fresh mask.
LakeOf filled(const Grid<float>& z, float highest_wet_m, Node seed, Filled* out = nullptr,
              double floor_m = -1e30, const Marks* marks = nullptr) {
    LakeOf lakes(z.size);
    const Marks plain(z.size);
    const Filled result =
        fill_from(z, marks ? *marks : plain, highest_wet_m, std::span(&seed, 1), 1, lakes, floor_m);
    if (out)
        *out = result;
    return lakes;
}

Surface surface_of(const Grid<float>& z, double spacing_m) {
    return {z, spacing_m, -0.5 * (z.size.cols - 1) * spacing_m,
            0.5 * (z.size.rows - 1) * spacing_m};
}

/// A scene's ground and water of one lake.
struct Poured {
    Heightfield ground, water;
};
Poured pour_lake(const Grid<float>& z, double spacing_m, const LakeOf& lakes, double level_m) {
    Poured out;
    out.ground = quantise(z.values, z.size, spacing_m, 4, std::span(&level_m, 1));
    out.ground.west_m = -0.5 * (z.size.cols - 1) * spacing_m;
    out.ground.north_m = 0.5 * (z.size.rows - 1) * spacing_m;
    out.water = empty_water(out.ground, std::span(&level_m, 1));
    pour(out.ground, lakes, std::span(&level_m, 1), out.ground, out.water);
    return out;
}

} // namespace

TEST(Fill, FollowsConnectionOverEightNeighboursAndLeavesOtherBasinsDry) {
    const Grid<float> z = picture({"9999999999",
                                   "9139999119", // the pond on the right is lower than the level,
                                   "9929999119", // but nothing joins it to the seed
                                   "9991999999", // joined by its corner only
                                   "9999999999"});
    Filled result;
    EXPECT_EQ(show(filled(z, highest_wet(3.5, false), {1, 1}, &result)),
              "..........\n.##.......\n..#.......\n...#......\n..........\n");
    EXPECT_FALSE(result.open_at_edge);
    EXPECT_EQ(result.nodes, 4u);
    EXPECT_THROW(filled(z, 3.0f, {4, 1}), Error);
}

TEST(Fill, ALevelWetsWhatLiesBelowItAndASurfaceAtJustThatHeight) {
    // r.lake's rule is "below", compared in float32; 1882.01 is stored as 1882.0100098.
    EXPECT_EQ(highest_wet(1882.01, true), 1882.01f);
    EXPECT_LT(highest_wet(1882.01, false), 1882.01f);
    const Grid<float> z({5, 5}, 1882.01f);
    EXPECT_EQ(show(filled(z, highest_wet(1882.01, true), {2, 2})),
              "#####\n#####\n#####\n#####\n#####\n");
    EXPECT_THROW(filled(z, highest_wet(1882.01, false), {2, 2}), Error);
}

TEST(Fill, AFloorKeepsALakeFromRunningOutOverAnUnseenDam) {
    const Grid<float> z = picture({"99999999", "95555311", "95555311", "99999999"});
    EXPECT_EQ(show(filled(z, 5.0f, {1, 1}, nullptr, 4.0)),
              "........\n.####...\n.####...\n........\n");
}

TEST(Fill, ClosedFillingIsTheSameOrNothing) {
    const bool held = rc::check("closed or nothing", [] {
        const int cols = *rc::gen::inRange(4, 20), rows = *rc::gen::inRange(4, 20);
        std::mt19937 random(*rc::gen::arbitrary<std::uint32_t>());
        std::uniform_int_distribution<int> step(0, 7);
        Grid<float> z({cols, rows});
        for (float& v : z.values)
            v = float(step(random));
        const Node seed{*rc::gen::inRange(0, cols), *rc::gen::inRange(0, rows)};
        const float level = z[seed] + float(*rc::gen::inRange(0, 3));
        Filled result;
        const LakeOf plain = filled(z, level, seed, &result);
        LakeOf lakes(z.size);
        const auto closed = fill_closed(z, Marks(z.size), level, seed, 1, lakes);
        RC_ASSERT(closed.has_value() != result.open_at_edge);
        if (closed) {
            RC_ASSERT(lakes.values == plain.values);
            RC_ASSERT(closed->nodes == result.nodes);
            RC_ASSERT(closed->at_level == result.at_level);
        } else {
            RC_ASSERT(lakes.values == LakeOf(z.size).values);
        }
    });
    EXPECT_TRUE(held);
}

TEST(Fill, WaterSpillsOverTheLowestPassAndLeavesWhereItReachesTheEdge) {
    const Grid<float> z = picture(
        {"9999999999", "9911199999", "9911169999", "9911197429", "9999999922", "9999999992"});
    Marks marks(z.size);
    const LakeOf lakes = filled(z, 3.0f, {3, 2});
    const auto spill = find_spill(z, marks, lakes, 1, 3.0);
    ASSERT_TRUE(spill.has_value());
    EXPECT_EQ(spill->level_m, 7.0); // over 6 and 7, not over any 9
    // Ties on the shore do not lead astray: the pass is on the water's own way.
    Grid<float> bowl({21, 21}, 9.0f);
    for (int r = 5; r < 16; ++r)
        for (int c = 5; c < 16; ++c)
            bowl[{c, r}] = r == 5 || c == 5 || r == 15 || c == 15 ? 6.0f : 2.0f;
    for (int c = 16; c < 21; ++c)
        bowl[{c, 10}] = c == 16 ? 6.0f : 1.0f;
    Marks fresh(bowl.size);
    const LakeOf pond = filled(bowl, 3.0f, {10, 10});
    const auto notch = find_spill(bowl, fresh, pond, 1, 3.0);
    EXPECT_EQ(notch->level_m, 6.0);
    EXPECT_GE(notch->pass.col, 15);
    EXPECT_NEAR(notch->pass.row, 10, 1);
    EXPECT_EQ(spill->pass, (Node{6, 3}));
    EXPECT_EQ(spill->exit, (Node{9, 4}));
    EXPECT_FALSE(spill->at_surface);
    const auto point = find_spill(z, marks, {3, 2});
    EXPECT_EQ(point->level_m, 7.0);
    EXPECT_FALSE(find_spill(z, marks, {3, 2}, 6.5).has_value());
    EXPECT_EQ(marks.values, Marks(z.size).values); // scratch marks are gone
}

TEST(Fill, TheLargestClosedBasinIsTheLakeNotTheOpenLowland) {
    const Grid<float> z = picture({"1111111111", "1111111111", "9999999999", "9922299999",
                                   "9922299119", "9999999119", "9999999999"});
    Marks marks(z.size);
    const auto basins = find_basins(z, marks, 3.0f);
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
    EXPECT_NEAR(flats[0].middle.col, 26.5, 2.0);
    EXPECT_NEAR(flats[0].middle.row, 15.5, 2.0);
    EXPECT_EQ(flats[0].runs.size(), 12u);
}

TEST(Flat, RowByRowFindsWhatAWholeSearchFinds) {
    const bool held = rc::check("components", [] {
        const int cols = *rc::gen::inRange(8, 40), rows = *rc::gen::inRange(8, 40);
        std::mt19937 random(*rc::gen::arbitrary<std::uint32_t>());
        // Random rectangles over ground that is nowhere equal; some end up on top of others.
        Grid<float> z({cols, rows});
        for (std::size_t i = 0; i < z.values.size(); ++i)
            z.values[i] = 100.0f + 0.01f * float(i);
        for (int k = 0; k < 6; ++k) {
            const int c0 = int(random() % unsigned(cols)), r0 = int(random() % unsigned(rows));
            const int w = 3 + int(random() % 12u), h = 3 + int(random() % 12u);
            const float level = random() % 9u == 0 ? NAN : float(10 * k);
            for (int r = r0; r < std::min(r0 + h, rows); ++r)
                for (int c = c0; c < std::min(c0 + w, cols); ++c)
                    z[{c, r}] = level;
        }
        // The independent route: flood every component, count nodes and interior ones.
        Grid<unsigned char> seen(z.size);
        std::vector<std::tuple<float, std::size_t, std::size_t>> expected, terraces;
        for (int r = 0; r < rows; ++r)
            for (int c = 0; c < cols; ++c) {
                if (seen[{c, r}] || std::isnan(z[Node(c, r)]))
                    continue;
                std::vector<Node> members{{c, r}};
                seen[{c, r}] = 1;
                std::size_t interior = 0, lower = 0, higher = 0;
                for (std::size_t i = 0; i < members.size(); ++i) {
                    const Node at = members[i];
                    int equal = 0;
                    each_neighbour(z.size, at, [&](Node n) {
                        equal += z[n] == z[at];
                        if (n.col == at.col || n.row == at.row) {
                            lower += z[n] < z[at];
                            higher += z[n] > z[at];
                        }
                        if (z[n] == z[at] && !seen[n]) {
                            seen[n] = 1;
                            members.push_back(n);
                        }
                    });
                    interior += equal == 8;
                }
                if (members.size() >= 20 && interior >= 4)
                    (20 * lower <= 7 * (lower + higher) && 10 * interior >= members.size()
                         ? expected
                         : terraces)
                        .emplace_back(z[Node(c, r)], members.size(), interior);
            }
        std::vector<std::tuple<float, std::size_t, std::size_t>> got;
        for (const FlatSurface& flat : find_flats(z)) {
            got.emplace_back(flat.level_m, flat.nodes, flat.interior);
            std::size_t in_runs = 0;
            for (const dem::Run& run : flat.runs)
                in_runs += std::size_t(run.last - run.first + 1);
            RC_ASSERT(in_runs == flat.nodes);
            RC_ASSERT(z[flat.middle] == flat.level_m);
        }
        // Terraces are kept all, where heights are finely stepped, or none.
        if (got.size() != expected.size())
            expected.insert(expected.end(), terraces.begin(), terraces.end());
        std::sort(expected.begin(), expected.end());
        std::sort(got.begin(), got.end());
        RC_ASSERT(expected == got);
    });
    EXPECT_TRUE(held);
}

TEST(Lakes, VoidsWithAnEvenRimAreWaterAndRadarShadowIsNot) {
    Grid<float> z({80, 40});
    for (int r = 0; r < 40; ++r)
        for (int c = 0; c < 80; ++c)
            z[{c, r}] = 300.0f + 7.0f * float(c) + 3.0f * float(r) + 0.123f * float((c * r) % 7);
    for (int r = 10; r < 22; ++r) // a pond: its shore all at 250.1 to 250.4 m
        for (int c = 10; c < 22; ++c) {
            const bool rim = r == 10 || r == 21 || c == 10 || c == 21;
            z[{c, r}] = rim ? 250.1f + 0.01f * float((r + c) % 30) : NAN;
        }
    for (int r = 10; r < 22; ++r) // a shadow in the slope
        for (int c = 50; c < 62; ++c)
            z[{c, r}] = NAN;
    Marks marks(z.size);
    fill_voids(z, marks);
    std::vector<std::string> notes;
    const auto surfaces = complete_surfaces(z, marks, {}, false, notes);
    ASSERT_EQ(surfaces.size(), 1u);
    EXPECT_EQ(surfaces[0].nodes, 100u);
    EXPECT_NEAR(surfaces[0].level_m, 250.1, 0.001);
    EXPECT_EQ(notes.size(), 1u);
}

TEST(Lakes, CentimetreRampsAndSeamsMakeOneLake) {
    Grid<float> z({60, 40});
    for (int r = 0; r < 40; ++r)
        for (int c = 0; c < 60; ++c)
            z[{c, r}] = 120.0f + 0.37f * float((c * 13 + r * 29) % 17) + 0.01f * float(c);
    for (int r = 8; r < 32; ++r) // west half flat at 100, east half 8 cm higher and sloping
        for (int c = 8; c < 52; ++c)
            z[{c, r}] = c < 30 ? 100.0f : 100.08f + 0.001f * float(c - 30);
    Marks marks(z.size);
    LakeOf lakes(z.size);
    std::vector<std::string> notes;
    const auto surfaces = complete_surfaces(z, marks, find_flats(z), false, notes);
    const auto found =
        find_lakes({.elevation_m = z, .marks = marks, .lake_of = lakes}, surfaces, 1);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].level_m, 100.0);
    // All of it but the seam's and the shore's own rows.
    EXPECT_GT(found[0].nodes, 24u * 44u - 2 * 24u - 2 * 22u);
    EXPECT_LE(found[0].nodes, 24u * 44u);
}

TEST(Lakes, NoisyWaterOfAnyShapeAndSeamsBetweenFlatsAreOneLake) {
    // A laser lake with millimetres of noise: a circle, so that no shore runs along the grid.
    std::mt19937 random(5);
    std::normal_distribution<float> noise(0.0f, 0.004f);
    Grid<float> z({160, 160});
    std::size_t truth = 0;
    for (int r = 0; r < 160; ++r)
        for (int c = 0; c < 160; ++c) {
            const double d = std::hypot(c - 80, r - 80);
            truth += d < 50;
            z[{c, r}] =
                d < 50 ? 100.0f + noise(random) : float(100.4 + 0.2 * (d - 50)) + noise(random);
        }
    const auto search = [&](Grid<float>& grid) {
        Marks marks(grid.size);
        LakeOf lakes(grid.size);
        std::vector<std::string> notes;
        const auto surfaces = complete_surfaces(grid, marks, find_flats(grid), false, notes);
        return find_lakes({.elevation_m = grid, .marks = marks, .lake_of = lakes}, surfaces, 1);
    };
    auto found = search(z);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(double(found[0].nodes), double(truth), 0.03 * double(truth));
    // Two flat halves that differ by .2 m, whichever is larger.
    for (const int seam : {60, 100}) {
        for (int r = 0; r < 160; ++r)
            for (int c = 0; c < 160; ++c)
                if (std::hypot(c - 80, r - 80) < 50)
                    z[{c, r}] = c < seam ? 100.0f : 100.2f;
        Grid<float> copy = z;
        found = search(copy);
        ASSERT_EQ(found.size(), 1u) << seam;
        EXPECT_EQ(found[0].nodes, truth);
        EXPECT_FLOAT_EQ(float(found[0].level_m), seam == 60 ? 100.2f : 100.0f);
    }
}

TEST(Lakes, ManyLevelsTerracesAndBaysAreTold) {
    // Whole metres: a stepped slope with two lakes, one of them with a cut-off bay.
    Grid<float> z({120, 60});
    for (int r = 0; r < 60; ++r)
        for (int c = 0; c < 120; ++c)
            z[{c, r}] = std::floor(300.0f - 0.15f * float(c) + 0.9f * float(r % 2)); // terraces
    const auto lay = [&](int c0, int r0, int c1, int r1, float level) {
        for (int r = r0 - 1; r <= r1; ++r) // a bank around it
            for (int c = c0 - 1; c <= c1; ++c)
                z[{c, r}] = std::max(z[{c, r}], level + 2.0f);
        for (int r = r0; r < r1; ++r)
            for (int c = c0; c < c1; ++c)
                z[{c, r}] = level;
    };
    lay(10, 10, 30, 30, 296.0f);
    lay(33, 12, 39, 20, 296.0f); // three nodes off: a bay behind a causeway
    lay(80, 10, 100, 40, 285.0f);
    Marks marks(z.size);
    LakeOf lakes(z.size);
    std::vector<std::string> notes;
    const auto surfaces = complete_surfaces(z, marks, find_flats(z), true, notes);
    const auto found =
        find_lakes({.elevation_m = z, .marks = marks, .lake_of = lakes}, surfaces, 1);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].level_m, 285.0);
    EXPECT_EQ(found[0].nodes, 600u);
    EXPECT_EQ(found[1].level_m, 296.0);
    EXPECT_EQ(found[1].nodes, 400u + 48u);
    EXPECT_EQ(found[1].seeds.size(), 2u);
    EXPECT_FALSE(found[0].open_at_edge);
}

TEST(Voids, InsideIsInterpolatedAndOutsideIsNeverFlooded) {
    Grid<float> z = picture({"??555555", "?5555555", "555?5555", "55555555", "55555555"});
    Marks marks(z.size);
    const VoidCount count = fill_voids(z, marks);
    EXPECT_EQ(count.all, 4u);
    EXPECT_EQ(count.inside, 1u);
    EXPECT_EQ(marks[Node(0, 0)], mark::outside);
    EXPECT_EQ(marks[Node(0, 1)], mark::outside);
    EXPECT_EQ(marks[Node(3, 2)], mark::filled);
    EXPECT_EQ(marks[Node(4, 4)], 0);
    EXPECT_FLOAT_EQ(z[Node(3, 2)], 5.0f);
    for (const float value : z.values)
        EXPECT_TRUE(std::isfinite(value));
    Filled result;
    const LakeOf lakes = filled(z, 6.0f, {4, 3}, &result, -1e30, &marks);
    EXPECT_EQ(lakes[Node(0, 0)], 0);
    EXPECT_TRUE(result.open_at_edge);
    Grid<float> empty({3, 3}, std::numeric_limits<float>::quiet_NaN());
    Marks none(empty.size);
    EXPECT_THROW(fill_voids(empty, none), Error);
}

TEST(Voids, FillingByTilesIsFillingAtOnce) {
    // Holes across the tiles' seams at node 1024.
    Grid<float> z({1100, 60});
    for (int r = 0; r < 60; ++r)
        for (int c = 0; c < 1100; ++c)
            z[{c, r}] = float(100.0 + 20.0 * std::sin(c / 9.0) * std::cos(r / 7.0));
    for (int r = 20; r < 40; ++r)
        for (int c = 1000; c < 1050; ++c)
            z[{c, r}] = NAN;
    Grid<float> whole = z;
    Marks marks(z.size);
    fill_voids(z, marks);
    interpolate_voids(whole, 100);
    EXPECT_EQ(z.values, whole.values);
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
        const float highest = highest_wet(level, *rc::gen::inRange(0, 2) == 1);
        Marks marks(z.size);
        const auto basins = find_basins(z, marks, highest);
        RC_PRE(!basins.empty());
        const LakeOf lake = filled(z, highest, basins[0].seed);
        Heightfield ground = quantise(z.values, z.size, 10.0, 4);
        const double levels[] = {level};
        Heightfield water = empty_water(ground, levels);
        // A filled lake needs no dams.
        RC_ASSERT(pour(ground, lake, levels, ground, water) == 0u);
        for (int r = 0; r + 1 < rows; ++r)
            for (int c = 0; c + 1 < cols; ++c) {
                const Node corner[4] = {{c, r}, {c + 1, r}, {c, r + 1}, {c + 1, r + 1}};
                int wet = 0, carry = 0;
                for (const Node n : corner) {
                    wet += lake[n];
                    carry += water.codes[n] != no_water_code;
                    if (lake[n]) {
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
    LakeOf lakes(z.size);
    for (int i = 0; i < 5; ++i)
        for (int r = 3; r < 9; ++r)
            for (int c = 12 * i + 3; c < 12 * i + 9; ++c) {
                z[{c, r}] = float(levels[i] - 5.0);
                lakes[{c, r}] = std::uint16_t(i + 1);
            }
    Heightfield ground = quantise(z.values, z.size, 30.0, 4);
    Heightfield water = empty_water(ground, levels);
    pour(ground, lakes, levels, ground, water);
    for (int i = 0; i < 5; ++i) {
        EXPECT_NEAR(water.elevation_m(Node{12 * i + 5, 5}), levels[i], 1e-3);
        EXPECT_NEAR(water.elevation_m(Node{12 * i + 2, 5}), levels[i], 1e-3); // the dry margin
    }
    EXPECT_EQ(water.codes[Node(0, 0)], no_water_code);
}

TEST(Water, LakesThatTouchArePartedAndNoWaterStandsAgainstTheLower) {
    Grid<float> z({12, 6}, 50.0f);
    LakeOf lakes(z.size);
    for (int r = 1; r < 5; ++r)
        for (int c = 1; c < 11; ++c) {
            z[{c, r}] = c < 6 ? 10.0f : 20.0f;
            lakes[{c, r}] = c < 6 ? 1 : 2;
        }
    const double levels[] = {15.0, 25.0};
    EXPECT_EQ(part_lakes(lakes, levels), 4u);
    EXPECT_EQ(lakes[Node(5, 2)], 1);
    EXPECT_EQ(lakes[Node(6, 2)], 0);
    EXPECT_EQ(lakes[Node(7, 2)], 2);
    Heightfield ground = quantise(z.values, z.size, 10.0, 4);
    Heightfield water = empty_water(ground, levels);
    EXPECT_EQ(pour(ground, lakes, levels, ground, water), 4u); // the wall between them
    EXPECT_GT(ground.elevation_m(Node{6, 2}), 25.0);
    EXPECT_NEAR(water.elevation_m(Node{6, 2}), 15.0, 1e-3);
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
    const LakeOf lake = filled(z, 10.0f, {150, 150});
    LakeRecord record;
    record.id = 1;
    record.level_m = 10.0;
    const Box box = boxes_of(lake, 1)[0];
    measure(record, surface_of(z, s), lake, box, geo::local_frame({45, 8}));
    const double r = 250.0, island = 25 * s * s;
    EXPECT_NEAR(record.area_m2, M_PI * r * r - island, 2e-3 * M_PI * r * r);
    EXPECT_NEAR(record.true_area_m2, record.area_m2, 1e-5 * record.area_m2); // near the origin
    EXPECT_NEAR(*record.max_depth_m, 10.0, 1e-6);
    EXPECT_NEAR(*record.true_volume_m3, *record.volume_m3, 1e-5 * *record.volume_m3);
    // Island nodes stood in about 10 - 40 (120/500)^2 = 7.7 m of water.
    EXPECT_NEAR(*record.volume_m3, M_PI * r * r * 5.0 - island * 7.7, 3e-3 * M_PI * r * r * 5.0);
    EXPECT_EQ(record.islands, 1);
    // The island's shore: a square whose sides are crossed at 7.7 / (7.7 + 5) of a cell outside it.
    const double wide = 4 * s + 2 * s * 5.0 / 12.7;
    EXPECT_NEAR(record.shoreline_m, 2 * M_PI * r + 4 * wide, 0.02 * 2 * M_PI * r);
    EXPECT_NEAR(record.position.lat_deg, 45.0, 0.01);
    record.bed = Bed::unknown;
    measure(record, surface_of(z, s), lake, box, geo::local_frame({45, 8}));
    EXPECT_FALSE(record.volume_m3.has_value());
}

TEST(Statistics, TrueAreaIsTheGeodesicOne) {
    // A rectangle of nodes far from the central meridian of a UTM zone: scale factor 1.0011.
    geo::Frame frame = geo::local_frame({45, 0});
    frame.scale0 = 0.9996;
    frame.origin_easting_m = 350'000; // from the meridian: false easting is 0 here
    frame.origin_northing_m = 0;
    Grid<float> z({202, 152}, 50.0f);
    LakeOf lake(z.size);
    for (int r = 1; r < 151; ++r)
        for (int c = 1; c < 201; ++c) {
            z[{c, r}] = 5.0f;
            lake[{c, r}] = 1;
        }
    LakeRecord record;
    record.id = 1;
    record.level_m = 10.0;
    measure(record, {z, 100.0, 0.0, 0.0}, lake, boxes_of(lake, 1)[0], frame);
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
    // Depth is 5 m everywhere: the true volume is the geodesic area times that.
    EXPECT_NEAR(*record.true_volume_m3 / (5.0 * geo::geodesic_area_m2(outline)), 1.0, 1e-5);
}

/// Two paraboloid basins with rims at 40 m, joined by a notch at 25 m; a third, shut off, whose
/// lake stands at 30 m in 22 m deep ground, and a pass at 38 m to it.
Grid<float> three_basins() {
    Grid<float> z({361, 121}, 60.0f);
    for (int r = 0; r < 121; ++r)
        for (int c = 0; c < 361; ++c) {
            const double y = (r - 60) * 5.0;
            const auto bowl = [&](int middle, double low) {
                const double x = (c - middle) * 5.0;
                return low + 40.0 * (x * x + y * y) / 90'000.0;
            };
            double h = std::min({bowl(60, 0.0), bowl(180, 10.0), bowl(300, 22.0), 60.0});
            if (std::abs(y) < 20.0 && c > 60 && c < 180)
                h = std::min(h, 25.0);
            if (std::abs(y) < 20.0 && c > 180 && c < 300)
                h = std::min(h, 38.0);
            z[{c, r}] = float(h);
        }
    for (int r = 0; r < 121; ++r) // a wall, so that nothing leaves below 60 m
        for (int c = 0; c < 361; ++c)
            if (r == 0 || c == 0 || r == 120 || c == 360)
                z[{c, r}] = 60.0f;
    return z;
}

struct Basins {
    Grid<float> z = three_basins();
    geo::Frame frame = geo::local_frame({45, 8});
    std::vector<LakeRecord> lakes;
    Heightfield ground, water;
    Basins() {
        LakeOf lake_of(z.size);
        Marks marks(z.size);
        const Node seeds[2] = {{60, 60}, {300, 60}};
        fill_from(z, marks, highest_wet(20.0, false), std::span(&seeds[0], 1), 1, lake_of);
        fill_from(z, marks, highest_wet(30.0, false), std::span(&seeds[1], 1), 2, lake_of);
        const std::vector<double> levels = {20.0, 30.0};
        for (int id = 1; id <= 2; ++id) {
            LakeRecord lake;
            lake.id = id;
            lake.level_m = levels[std::size_t(id - 1)];
            measure(lake, surface_of(z, 5.0), lake_of, boxes_of(lake_of, 2)[std::size_t(id - 1)],
                    frame);
            lakes.push_back(lake);
        }
        ground = quantise(z.values, z.size, 5.0, 4, levels);
        water = empty_water(ground, levels);
        pour(ground, lake_of, levels, ground, water);
    }
    Refill refill(int id) const { return Refill(z, ground, water, frame, lakes, id, Progress{}); }
};

TEST(Refill, CountsWhatStageTablesCount) {
    const Basins b;
    const Refill refill = b.refill(1);
    EXPECT_NEAR(refill.lowest_m(), 0.1, 1e-6);
    ASSERT_TRUE(refill.spill_m());
    EXPECT_NEAR(*refill.spill_m(), 60.0, 1e-6);
    const std::vector<double> levels = {0.5, 10.0, 20.0, 24.9, 25.1, 30.0, 37.0, 39.0, 55.0};
    const auto table =
        stage_table(b.z, b.ground, b.water, b.frame, b.lakes[0], levels, 8, Progress{});
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const WaterFigures f = refill.figures(levels[i]);
        EXPECT_EQ(f.area_m2, table.stages[i].area_m2) << levels[i];
        EXPECT_NEAR(f.true_area_m2, table.stages[i].true_area_m2, 1e-6 * f.true_area_m2);
        EXPECT_NEAR(*f.volume_m3, *table.stages[i].volume_m3, 1e-9 * *f.volume_m3) << levels[i];
        EXPECT_EQ(*f.max_depth_m, *table.stages[i].max_depth_m);
        EXPECT_EQ(f.open_at_edge, table.stages[i].open_at_edge);
    }
}

TEST(Refill, FillsAsAnImportWould) {
    const Basins b;
    Refill refill = b.refill(1);
    Heightfield ground = b.ground, water = b.water;
    std::vector<LakeRecord> lakes;
    for (const double level : {24.0, 12.0, 31.0, 20.0, 5.0}) {
        refill.fill(level, ground, water, lakes, true);
        ASSERT_EQ(lakes.size(), 2u) << level;
        LakeOf lake_of(b.z.size);
        Marks marks(b.z.size);
        const Node seeds[2] = {{60, 60}, {300, 60}};
        fill_from(b.z, marks, highest_wet(level, false), std::span(&seeds[0], 1), 1, lake_of);
        fill_from(b.z, marks, highest_wet(30.0, false), std::span(&seeds[1], 1), 2, lake_of);
        LakeRecord lake;
        lake.id = 1;
        lake.level_m = level;
        measure(lake, surface_of(b.z, 5.0), lake_of, boxes_of(lake_of, 2)[0], b.frame);
        EXPECT_EQ(lakes[0].area_m2, lake.area_m2) << level;
        EXPECT_NEAR(*lakes[0].volume_m3, *lake.volume_m3, 1e-9 * *lake.volume_m3) << level;
        EXPECT_EQ(lakes[0].shoreline_m, lake.shoreline_m) << level;
        EXPECT_EQ(lakes[0].west_north, lake.west_north);
        EXPECT_EQ(lakes[0].east_south, lake.east_south);
        // Water shows just where the lakes are, at their levels to the millimetre.
        for (int r = 0; r < b.z.size.rows; ++r)
            for (int c = 0; c < b.z.size.cols; ++c) {
                const Node n{c, r};
                const bool shows =
                    water.codes[n] != no_water_code && ground.elevation_m(n) < water.elevation_m(n);
                ASSERT_EQ(shows, lake_of[n] != 0) << level << " at " << c << ", " << r;
                if (shows) {
                    ASSERT_NEAR(water.elevation_m(n), lake_of[n] == 1 ? level : 30.0, 0.001);
                }
            }
    }
}

TEST(Refill, DrownsALakeThatStandsLower) {
    const Basins b;
    Refill refill = b.refill(1);
    Heightfield ground = b.ground, water = b.water;
    std::vector<LakeRecord> lakes;
    refill.fill(39.0, ground, water, lakes, false); // over the pass at 38 m
    ASSERT_EQ(lakes.size(), 1u);
    EXPECT_EQ(lakes[0].id, 1);
    EXPECT_NEAR(water.elevation_m({300, 60}), 39.0, 0.001);
    refill.fill(37.0, ground, water, lakes, false); // and gives it back
    ASSERT_EQ(lakes.size(), 2u);
    EXPECT_NEAR(water.elevation_m({300, 60}), 30.0, 0.001);
}

TEST(Refill, SaysWhichLevelsCanBeShown) {
    Basins b;
    const auto refused = [&](double level) {
        try {
            b.refill(1).figures(level);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_NE(refused(-3.0).find("reach from 0.10 to 60.00 m"), std::string::npos) << refused(-3);
    EXPECT_NE(refused(61.0).find("61 m"), std::string::npos);
    EXPECT_NE(refused(NAN), "");
    b.lakes[0].bed = Bed::unknown;
    EXPECT_NE(refused(19.0).find("bed of lake 1 is unknown"), std::string::npos);
    EXPECT_EQ(refused(21.0), "");
    EXPECT_THROW(b.refill(7), Error);
}

TEST(Stages, OfTwoBasinsFollowTheirFormulas) {
    // Two paraboloids, 40 and 30 m deep below the rim, side by side, joined by a notch at 25 m. The
    // first one's rim meets the grid's edge at 40 m.
    const double s = 5.0;
    Grid<float> z({241, 121});
    for (int r = 0; r < 121; ++r)
        for (int c = 0; c < 241; ++c) {
            const double x = (c - 60) * s, x2 = (c - 180) * s, y = (r - 60) * s;
            const double a = 40.0 * (x * x + y * y) / 90'000.0;
            const double b = 10.0 + 40.0 * (x2 * x2 + y * y) / 90'000.0;
            double h = std::min({a, b, 60.0});
            if (std::abs(y) < 20.0 && c > 60 && c < 180)
                h = std::min(h, 25.0);
            z[{c, r}] = float(h);
        }
    const geo::Frame frame = geo::local_frame({45, 8});
    const LakeOf lakes = filled(z, highest_wet(20.0, false), {60, 60});
    const Poured scene = pour_lake(z, s, lakes, 20.0);
    LakeRecord record;
    record.id = 1;
    record.level_m = 20.0;
    measure(record, surface_of(z, s), lakes, boxes_of(lakes, 1)[0], frame);
    const std::vector<double> levels = {10.0, 20.0, 24.0, 26.0, 55.0};
    const auto table =
        stage_table(z, scene.ground, scene.water, frame, record, levels, 8, Progress{});
    const auto volume = [](double deep) { return M_PI * 90'000.0 / 40.0 * deep * deep / 2.0; };
    const auto area = [](double deep) { return M_PI * 90'000.0 / 40.0 * deep; };
    EXPECT_NEAR(table.stages[0].area_m2, area(10), 0.01 * area(10));
    EXPECT_NEAR(*table.stages[0].volume_m3, volume(10), 0.01 * volume(10));
    // At the scene's own level the table says what info says, to the last cell.
    EXPECT_EQ(table.stages[1].area_m2, record.area_m2);
    EXPECT_NEAR(*table.stages[1].volume_m3, *record.volume_m3, 1e-6 * *record.volume_m3);
    EXPECT_NEAR(table.stages[1].shoreline_m, record.shoreline_m, 1e-6);
    EXPECT_NEAR(*table.stages[2].volume_m3, volume(24), 0.01 * volume(24)); // one basin
    EXPECT_NEAR(*table.stages[3].volume_m3, volume(26) + volume(16), 0.01 * volume(26)); // both
    EXPECT_EQ(table.stages[3].pools, 1);
    EXPECT_FALSE(table.stages[3].open_at_edge);
    EXPECT_TRUE(table.stages[4].open_at_edge); // over the rim
    ASSERT_TRUE(table.spill.has_value());
    EXPECT_NEAR(table.spill->level_m, 40.0, 1e-6);
    // Imported high and lowered below the sill, the water stands in two pools.
    const LakeOf both = filled(z, highest_wet(39.0, false), {60, 60});
    const Poured high = pour_lake(z, s, both, 39.0);
    record.level_m = 39.0;
    measure(record, surface_of(z, s), both, boxes_of(both, 1)[0], frame);
    const auto low =
        stage_table(z, high.ground, high.water, frame, record, std::vector{20.0}, 8, Progress{});
    EXPECT_EQ(low.stages[0].pools, 2);
    EXPECT_NEAR(*low.stages[0].volume_m3, volume(20) + volume(10), 0.01 * volume(20));
    // Both parts of a lake behind a causeway count, and a rim node whose bed just reaches the
    // level.
    LakeOf split = both;
    Grid<float> levelled = z;
    for (int r = 0; r < 121; ++r) {
        split[{120, r}] = 0;
        levelled[{120, r}] = 45.0f;
    }
    for (int r = 50; r < 70; ++r)
        levelled[{60, r}] = 39.0f;
    const Poured parted = pour_lake(levelled, s, split, 39.0);
    measure(record, surface_of(levelled, s), split, boxes_of(split, 1)[0], frame);
    Marks scratch(z.size);
    record.parts = parts_of(split, scratch, 1, boxes_of(split, 1)[0]);
    EXPECT_EQ(record.parts.size(), 2u);
    const auto whole = stage_table(levelled, parted.ground, parted.water, frame, record,
                                   std::vector{39.0}, 8, Progress{});
    EXPECT_EQ(whole.stages[0].area_m2, record.area_m2);
    record.bed = Bed::unknown;
    EXPECT_THROW(
        stage_table(z, high.ground, high.water, frame, record, std::vector{20.0}, 8, Progress{}),
        Error);
}

namespace {

BedPlace whole_lake(const LakeOf& lakes, const Marks& marks, double surface_m) {
    return {.lake_of = lakes,
            .marks = marks,
            .id = 1,
            .box = boxes_of(lakes, 1)[0],
            .surface_m = surface_m,
            .surface_known = false};
}

/// The part of a survey that a lake's widened box shows.
Grid<float> cut(const Grid<float>& survey, const BedPlace& place) {
    Grid<float> out(place.size());
    const Node first = place.widened().first;
    for (int r = 0; r < out.size.rows; ++r)
        for (int c = 0; c < out.size.cols; ++c)
            out[{c, r}] = survey[{first.col + c, first.row + r}];
    return out;
}

} // namespace

TEST(Bed, BathymetryIsReadAsDepthsOfEitherSignOrAsElevations) {
    Grid<float> z({40, 40}, 110.0f);
    LakeOf lakes(z.size);
    const Marks marks(z.size);
    Grid<float> depth(z.size, NAN);
    for (int r = 5; r < 35; ++r)
        for (int c = 5; c < 35; ++c) {
            z[{c, r}] = 100.0f;
            lakes[{c, r}] = 1;
            const int in = std::min({c - 5, r - 5, 34 - c, 34 - r});
            if (in >= 3) // the survey stops three nodes from the shore
                depth[{c, r}] = 0.5f * float(in);
        }
    const BedPlace place = whole_lake(lakes, marks, 100.0);
    const auto apply = [&](float sign, float datum, BathymetryKind kind) {
        Grid<float> ground = z, survey = depth;
        for (float& v : survey.values)
            v = datum + sign * v;
        merge_bathymetry(ground, place, cut(survey, place), kind);
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
        merge_bathymetry(ground, place, Grid<float>(place.size(), NAN), BathymetryKind::depth),
        Error);
}

TEST(Bed, SoundingsOfAPlaneGiveThatPlaneAndTheShoreHasNoDepth) {
    LakeOf lakes({60, 50});
    const Marks marks(lakes.size);
    for (int r = 5; r < 45; ++r)
        for (int c = 5; c < 55; ++c)
            lakes[{c, r}] = 1;
    const BedPlace place = whole_lake(lakes, marks, 100.0);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> across(8.0, 51.0), down(8.0, 41.0);
    const auto plane = [](double c, double r) { return 3.0 + 0.2 * c + 0.1 * r; };
    std::vector<Sounding> soundings;
    for (int i = 0; i < 3000; ++i) {
        const double c = across(random), r = down(random);
        soundings.push_back({c, r, plane(c, r)});
    }
    const Grid<float> depth = grid_soundings(place, soundings, 0.0);
    const Node first = place.widened().first;
    double worst = 0.0;
    for (int r = 10; r < 40; ++r)
        for (int c = 10; c < 50; ++c)
            worst = std::max(worst, std::abs(depth[{c - first.col, r - first.row}] - plane(c, r)));
    EXPECT_LT(worst, 1e-4); // linear interpolation is exact on a plane
    // The rim: between 0 half a node out and the survey three nodes in.
    for (int r = 10; r < 40; ++r) {
        EXPECT_GT(depth[Node(5 - first.col, r - first.row)], 0.0f);
        EXPECT_LT(depth[Node(5 - first.col, r - first.row)], plane(8, r) / 3.0);
    }
    EXPECT_TRUE(std::isnan(grid_soundings(place, {}, 0.0).values[0]));
}

TEST(Bed, AnEstimateReachesItsGreatestDepthAndTheMeanThatLakesHave) {
    Grid<float> z({201, 201}, 110.0f);
    LakeOf lakes(z.size);
    const Marks marks(z.size);
    double nodes = 0.0;
    for (int r = 0; r < 201; ++r)
        for (int c = 0; c < 201; ++c)
            if (std::hypot(c - 100, r - 100) < 90.0) {
                lakes[{c, r}] = 1;
                z[{c, r}] = 100.0f;
                ++nodes;
            }
    estimate_depths(z, whole_lake(lakes, marks, 100.0), 40.0);
    double sum = 0.0, deepest = 0.0;
    for (std::size_t i = 0; i < z.values.size(); ++i)
        if (lakes.values[i]) {
            sum += 100.0 - z.values[i];
            deepest = std::max(deepest, 100.0 - double(z.values[i]));
        }
    EXPECT_NEAR(deepest, 40.0, 0.1);
    EXPECT_NEAR(sum / nodes / 40.0, 1.75 / 3.75, 0.01); // 1 - 2 / (p + 2) for a circle, p = 1.75
    EXPECT_LT(100.0 - z[Node(11, 100)], 1.0);           // no cliff at the shore
}

TEST(Bed, RoomForUnknownDepthPutsTheShoreMidwayBetweenNodes) {
    Grid<float> z({30, 30}, 104.0f);
    LakeOf lakes(z.size);
    Marks marks(z.size);
    for (int r = 8; r < 22; ++r)
        for (int c = 8; c < 22; ++c) {
            z[{c, r}] = 100.0f;
            lakes[{c, r}] = 1;
            marks[{c, r}] = mark::flat;
        }
    const double levels[] = {100.0}, reach[] = {100.0 - greatest_room_m};
    Heightfield ground = quantise(z.values, z.size, 10.0, 4, reach);
    make_room(ground, lakes, marks, levels);
    // Linear between the last wet and the first dry node: crosses the level halfway.
    const double wet = ground.elevation_m(Node{8, 15}), dry = ground.elevation_m(Node{7, 15});
    EXPECT_NEAR((100.0 - wet) / (dry - wet), 0.5, 1e-3);
    EXPECT_NEAR(ground.elevation_m(Node{15, 15}), 95.0, 0.01);
    const double known[] = {std::numeric_limits<double>::quiet_NaN()};
    Heightfield untouched = quantise(z.values, z.size, 10.0, 4, reach);
    EXPECT_EQ(make_room(untouched, lakes, marks, known), 0u);
}
