#include "scene/samples.hpp"
#include "view/flight.hpp"
#include "view/pacing.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;
using view::Flight;
using view::Pose;
using view::Push;

namespace {

/// The bowl: 500 m radius, 40 m deep, water at 10 m.
struct Bowl {
    scene::Scene scene = scene::bowl(257);
    Flight at(glm::dvec3 place, double heading = 0.0, double pitch = 0.0) {
        return {scene, {place, heading, pitch, 50.0}};
    }
};

/// Where a point is in the picture: right and up of the middle, in units of the distance ahead.
glm::dvec2 seen(const Flight& flight, const glm::dvec3& point) {
    const scene::Camera c = camera_of(flight.pose());
    const glm::dvec3 d = point - c.position;
    return {glm::dot(d, c.right) / glm::dot(d, c.forward),
            glm::dot(d, c.up) / glm::dot(d, c.forward)};
}

} // namespace

TEST(Flight, PoseAndCameraAreTheSame) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int i = 0; i < 500; ++i) {
        const Pose pose{{100 * unit(random), 100 * unit(random), 100 * unit(random)},
                        179.0 * unit(random),
                        89.0 * unit(random),
                        60.0};
        const Pose back = view::pose_of(view::camera_of(pose));
        EXPECT_NEAR(back.heading_deg, pose.heading_deg, 1e-6);
        EXPECT_NEAR(back.pitch_deg, pose.pitch_deg, 1e-6);
    }
    // Straight down the picture's top is where one looks to.
    const Pose down = view::pose_of(scene::look({0, 0, 100}, 40.0, -90.0, 50.0));
    EXPECT_NEAR(down.heading_deg, 40.0, 1e-6);
}

TEST(Flight, GoesWhereItIsPushed) {
    Bowl b;
    Flight flight = b.at({0, 0, 100}, 90.0);
    EXPECT_FALSE(flight.advance({}, 0.1));
    EXPECT_TRUE(flight.advance({.forward = 1.0}, 0.5));
    EXPECT_GT(flight.pose().position.x, 5.0);
    EXPECT_NEAR(flight.pose().position.y, 0.0, 1e-6);
    const double x = flight.pose().position.x;
    flight.advance({.right = 1.0}, 0.5); // east is ahead, so south is to the right
    EXPECT_LT(flight.pose().position.y, -5.0);
    EXPECT_NEAR(flight.pose().position.x, x, 1e-6);
    flight.advance({.up = 1.0}, 0.5);
    EXPECT_GT(flight.pose().position.z, 105.0);
}

TEST(Flight, IsFastHighUpAndSlowNearTheWater) {
    Bowl b;
    EXPECT_GT(b.at({0, 0, 300}).speed_m_per_s(), 10.0 * b.at({0, 0, 12}).speed_m_per_s());
    EXPECT_GE(b.at({0, 0, 10.01}).speed_m_per_s(), 1.0); // never stuck
}

TEST(Flight, StopsAtTheGroundAndNeverGoesThrough) {
    Bowl b;
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    Flight flight = b.at({100, 50, 60});
    for (int i = 0; i < 3000; ++i) {
        flight.turn(40.0 * unit(random), 30.0 * unit(random));
        flight.advance({.forward = unit(random),
                        .right = unit(random),
                        .up = unit(random) - 0.5,
                        .boost = 4.0},
                       0.1);
        const glm::dvec3& p = flight.pose().position;
        ASSERT_GE(p.z, flight.lowest_m(p.x, p.y) - 1e-9);
        ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
    }
}

TEST(Flight, DivesThroughTheSurfaceWithoutAJump) {
    Bowl b;
    Flight flight = b.at({0, 0, 14}, 0.0, -60.0);
    double last = flight.pose().position.z, greatest = 0.0;
    bool under = false;
    for (int i = 0; i < 400 && flight.pose().position.z > 2.0; ++i) {
        flight.advance({.forward = 1.0}, 1.0 / 60.0);
        greatest = std::max(greatest, last - flight.pose().position.z);
        last = flight.pose().position.z;
        under |= last < 10.0;
    }
    EXPECT_TRUE(under);
    EXPECT_LT(greatest, 0.1); // six metres a second at most
}

TEST(Flight, OrbitKeepsThePointWhereItIs) {
    Bowl b;
    const glm::dvec3 pivot(120, -40, 12);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    Flight flight = b.at({-200, 100, 220}, 120.0, -25.0);
    const glm::dvec2 before = seen(flight, pivot);
    const double distance = glm::length(flight.pose().position - pivot);
    for (int i = 0; i < 200; ++i) {
        flight.orbit(pivot, 20.0 * unit(random), 0.0);
        EXPECT_NEAR(glm::length(flight.pose().position - pivot), distance, 1e-6);
        EXPECT_NEAR(seen(flight, pivot).x, before.x, 1e-6);
        EXPECT_NEAR(seen(flight, pivot).y, before.y, 1e-6);
    }
    flight.orbit(pivot, 0.0, 15.0); // higher, and still as far to the side
    EXPECT_GT(flight.pose().position.z, 220.0);
    EXPECT_NEAR(glm::length(flight.pose().position - pivot), distance, 1e-6);
}

TEST(Flight, ZoomNeverPassesThePoint) {
    Bowl b;
    const glm::dvec3 point(0, 0, 10);
    Flight flight = b.at({0, -300, 200});
    double last = 1e9;
    for (int i = 0; i < 60; ++i) {
        flight.zoom(point, 1.0);
        const double now = glm::length(flight.pose().position - point);
        EXPECT_LT(now, last);
        last = now;
    }
    EXPECT_LT(last, 1.0);
    flight.zoom(point, -5.0);
    EXPECT_GT(glm::length(flight.pose().position - point), last);
}

TEST(Flight, FliesToAPointAndBack) {
    Bowl b;
    const Pose start{{-300, -200, 150}, 45.0, -15.0, 50.0};
    Flight flight(b.scene, start);
    const glm::dvec3 point(50, 60, b.scene.ground.elevation_m(50, 60));
    flight.fly_to_point(point);
    EXPECT_TRUE(flight.under_way());
    double furthest_step = 0.0;
    for (int i = 0; i < 120; ++i) {
        const glm::dvec3 before = flight.pose().position;
        flight.advance({}, 1.0 / 60.0);
        furthest_step = std::max(furthest_step, glm::length(flight.pose().position - before));
    }
    EXPECT_FALSE(flight.under_way());
    EXPECT_LT(furthest_step, 12.0);                           // smooth: some 400 m in 72 pictures
    EXPECT_NEAR(glm::length(seen(flight, point)), 0.0, 0.05); // in the middle
    EXPECT_TRUE(flight.undo());
    EXPECT_NEAR(glm::length(flight.pose().position - start.position), 0.0, 1e-9);
    EXPECT_TRUE(flight.redo());
    EXPECT_NEAR(glm::length(seen(flight, point)), 0.0, 0.05);
    EXPECT_FALSE(flight.redo());
}

TEST(Flight, AnyPushTakesOver) {
    Bowl b;
    Flight flight = b.at({0, 0, 100});
    flight.fly_to({{300, 0, 100}, 0.0, 0.0, 50.0});
    flight.advance({}, 0.3);
    flight.advance({.forward = 1.0}, 0.05);
    EXPECT_FALSE(flight.under_way());
}

TEST(Flight, AGamepadAtRestDoesNothing) {
    const float rest[6] = {0.05f, -0.1f, 0.0f, 0.14f, -1.0f, -1.0f};
    const view::PadInput none = view::read_pad(rest);
    EXPECT_FALSE(none.push.any());
    EXPECT_EQ(none.turn_right, 0.0);
    EXPECT_EQ(none.turn_up, 0.0);
    const float all[6] = {1.0f, -1.0f, 0.5f, -0.5f, -1.0f, 1.0f};
    const view::PadInput input = view::read_pad(all);
    EXPECT_EQ(input.push.right, 1.0);
    EXPECT_EQ(input.push.forward, 1.0); // sticks count downwards
    EXPECT_EQ(input.push.up, 1.0);
    EXPECT_EQ(input.turn_right, 0.5);
    EXPECT_EQ(input.turn_up, 0.5);
    const float sink[6] = {0, 0, 0, 0, 1.0f, -1.0f};
    EXPECT_EQ(view::read_pad(sink).push.up, -1.0);
}

TEST(Pacing, FindsTheFinestThatIsQuickEnough) {
    for (const double cost_ms : {20.0, 150.0, 700.0, 3000.0}) { // of a whole picture
        const double fixed_ms = 8.0;
        view::Pacing pacing(100.0, 0.375);
        for (int i = 0; i < 200; ++i)
            pacing.took(fixed_ms + cost_ms * pacing.scale() * pacing.scale());
        const double ms = fixed_ms + cost_ms * pacing.scale() * pacing.scale();
        if (fixed_ms + cost_ms * 0.125 * 0.125 < 100.0) {
            EXPECT_LT(ms, 115.0) << cost_ms;
        }
        double finer = 1.0; // the next step up would not do
        for (const double step : {0.75, 0.5, 0.375, 0.25, 0.1875, 0.125})
            if (step > pacing.scale())
                finer = step;
        if (pacing.scale() < 1.0) {
            EXPECT_GT(fixed_ms + cost_ms * finer * finer, 80.0) << cost_ms;
        }
        const double settled = pacing.scale();
        int changes = 0;
        for (int i = 0; i < 100; ++i) {
            const double before = pacing.scale();
            pacing.took(fixed_ms + cost_ms * before * before);
            changes += pacing.scale() != before;
        }
        EXPECT_LE(changes, 2) << "restless at " << settled;
    }
}

TEST(Pacing, OneSlowPictureDoesNotSpoilTheRest) {
    view::Pacing pacing(100.0, 1.0);
    pacing.took(2000.0); // a hitch
    EXPECT_LT(pacing.scale(), 1.0);
    for (int i = 0; i < 60; ++i)
        pacing.took(5.0);
    EXPECT_EQ(pacing.scale(), 1.0);
}
