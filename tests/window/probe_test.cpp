#include "geo/frame.hpp"
#include "scene/curvature.hpp"
#include "scene/samples.hpp"
#include "view/probe.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

using namespace tarn;
using view::read_place;

namespace {

scene::Scene placed_tank() {
    scene::Scene tank = scene::tank();
    tank.frame = geo::local_frame({46.0, 8.0});
    return tank;
}

/// Distance to a height along a direction.
double to_height(const glm::dvec3& eye, const glm::dvec3& direction, double z) {
    return (eye.z - z) / -glm::normalize(direction).z;
}

} // namespace

TEST(Probe, StraightDownWaterLooksThreeQuartersAsDeep) {
    const scene::Scene tank = placed_tank(); // 8 m deep
    const glm::dvec3 eye(3, 4, 10);
    const auto r = read_place(tank, eye, {0, 0, -1}, 10.0);
    ASSERT_TRUE(r && r->seen_depth_m);
    EXPECT_NEAR(*r->depth_m, 8.0, 0.01);
    EXPECT_NEAR(*r->seen_depth_m, 8.0, 0.01);
    EXPECT_NEAR(*r->apparent_depth_m, 8.0 / 1.333, 0.01);
    EXPECT_NEAR(r->place.lat_deg, 46.0 + 4.0 / 111'144.0, 1e-6);
}

TEST(Probe, ObliquelyItLooksShallowerStill) {
    const scene::Scene tank = placed_tank();
    const glm::dvec3 eye(-20, 0, 10);
    double last = 1e9;
    for (const double degrees : {80.0, 60.0, 40.0, 25.0}) { // below the horizon
        const double a = degrees * M_PI / 180.0;
        const glm::dvec3 d(std::cos(a), 0, -std::sin(a));
        const auto r = read_place(tank, eye, d, to_height(eye, d, 0.0));
        ASSERT_TRUE(r && r->apparent_depth_m) << degrees;
        // Snell by hand.
        const double in_water = std::asin(std::cos(a) / 1.333);
        EXPECT_NEAR(*r->apparent_depth_m, 8.0 * std::tan(in_water) * std::tan(a), 0.01);
        EXPECT_LT(*r->apparent_depth_m, last);
        last = *r->apparent_depth_m;
    }
}

TEST(Probe, ReadsSlopeAndElevation) {
    scene::Scene bowl = scene::bowl(513);
    bowl.frame = geo::local_frame({46.0, 8.0});
    // z = 40 (r / 500)^2: at r = 400 the slope is 80 r / 250000.
    const glm::dvec3 eye(400, 0, 100);
    const double z = bowl.ground.elevation_m(400.0, 0.0);
    const auto r = read_place(bowl, eye, {0, 0, -1}, 100.0 - z);
    ASSERT_TRUE(r);
    EXPECT_NEAR(r->ground_m, 40.0 * 0.64, 0.01);
    EXPECT_NEAR(r->slope_deg, std::atan(80.0 * 400.0 / 250'000.0) * 180.0 / M_PI, 0.05);
    EXPECT_FALSE(r->level_m);
    EXPECT_FALSE(r->depth_m);
}

TEST(Probe, SkyIsNothingAndUnknownBedsHaveNoDepth) {
    scene::Scene tank = placed_tank();
    EXPECT_FALSE(read_place(tank, {0, 0, 10}, {0, 0, 1}, 1e9));
    EXPECT_FALSE(read_place(tank, {0, 0, 10}, {0, 0, 1}, INFINITY));
    EXPECT_FALSE(read_place(tank, {0, 0, 10}, {0, 0, 1}, NAN));
    tank.lakes[0].bed = Bed::unknown;
    const auto r = read_place(tank, {0, 0, 10}, {0, 0, -1}, 10.0);
    ASSERT_TRUE(r && r->level_m);
    EXPECT_FALSE(r->depth_m);
    EXPECT_NE(describe(*r).find("bed unknown"), std::string::npos);
}

TEST(Probe, MeasuresOnTheEllipsoid) {
    const scene::Scene tank = placed_tank();
    // A square of 100 m at true scale: the frame's scale factor is 1 at its centre.
    const std::vector<glm::dvec3> square = {{0, 0, 0}, {100, 0, 0}, {100, 100, 0}, {0, 100, 0}};
    EXPECT_NEAR(view::length_m(tank, square), 300.0, 1e-4);
    EXPECT_NEAR(view::area_m2(tank, square), 10'000.0, 0.1);
    EXPECT_EQ(view::area_m2(tank, {{0, 0, 0}, {1, 0, 0}}), 0.0);
}

// Two metres over a lake 60 km wide the horizon lies 2.5 arc minutes down: a line of sight one
// minute down meets water on a flat map only.
TEST(Probe, FarWaterIsBehindTheHorizon) {
    scene::Scene lake = scene::tank();
    for (Heightfield* h : {&lake.ground, &lake.water}) {
        h->spacing_m = 300.0;
        h->west_m = -30000.0;
        h->north_m = 30000.0;
    }
    const double minute = M_PI / 180.0 / 60.0;
    EXPECT_FALSE(view::first_met(lake, {-28000, 40, 2}, {1, 0, -minute}, scene::bend_per_m));
    const auto near =
        view::first_met(lake, {-28000, 40, 2}, {1, 0, -4 * minute}, scene::bend_per_m);
    ASSERT_TRUE(near);
    EXPECT_NEAR(near->z, 0.0, 1e-6);
    // (s - sqrt(s^2 - 4 b h)) / 2 b
    EXPECT_NEAR(near->x,
                -28000 + (4 * minute - std::sqrt(16 * minute * minute - 8 * 6.8277e-8)) /
                             (2 * 6.8277e-8),
                2.0);
}

TEST(Probe, FirstGroundIsTheBilinearOne) {
    const scene::Scene bowl = scene::bowl(257);
    const glm::dvec3 eye(0, 0, 9.0);
    for (int k = 0; k < 32; ++k) {
        const double a = k * M_PI / 16.0;
        const glm::dvec3 d = glm::normalize(glm::dvec3(std::cos(a), std::sin(a), -0.05 * k));
        const auto hit = view::first_ground(bowl, eye, d, 1000.0);
        ASSERT_TRUE(hit) << k;
        EXPECT_NEAR(hit->z, bowl.ground.elevation_m(hit->x, hit->y), 1e-6);
        // z = 40 r^2 / 250000 meets 9 + t dz at the root of a quadratic.
        const double flat = std::hypot(d.x, d.y), A = 40.0 * flat * flat / 250'000.0;
        const double t = (d.z + std::sqrt(d.z * d.z + 36.0 * A)) / (2.0 * A);
        EXPECT_NEAR(glm::length(*hit - eye), t, 0.01 * t);
    }
    EXPECT_FALSE(view::first_ground(bowl, eye, {0, 0, 1}, 1000.0));
    // From outside and above, water stops it.
    const glm::dvec3 outside(-900, 0, 410);
    const auto water = view::first_met(bowl, outside, glm::dvec3(0, 0, 10) - outside);
    ASSERT_TRUE(water);
    EXPECT_NEAR(glm::length(*water - glm::dvec3(0, 0, 10)), 0.0, 1e-6);
    EXPECT_FALSE(view::first_met(bowl, outside, {-1, 0, -0.1}));
    const auto land = view::first_met(bowl, outside, glm::dvec3(-400, 0, 25.6) - outside);
    ASSERT_TRUE(land);
    EXPECT_NEAR(land->x, -400.0, 1.0);
}
