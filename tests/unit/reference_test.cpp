// The oracle against closed forms, so that it is not taken on trust itself.
#include "reference/camera.hpp"
#include "reference/fresnel.hpp"
#include "reference/heightfield.hpp"
#include "reference/medium.hpp"
#include "reference/noise.hpp"
#include "reference/sky.hpp"
#include "reference/surface.hpp"
#include "reference/tracer.hpp"
#include "scene/land_shadow.hpp"
#include "scene/samples.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;
using namespace tarn::reference;

namespace {
constexpr double n_water = 1.333;
constexpr double into_water = 1.0 / n_water, out_of_water = n_water;
double deg(double degrees) { return degrees * M_PI / 180.0; }
} // namespace

TEST(Fresnel, NormalIncidenceIsTheSquaredIndexContrast) {
    const double expected = std::pow((n_water - 1.0) / (n_water + 1.0), 2.0); // 0.02037
    EXPECT_NEAR(fresnel_dielectric(1.0, into_water), expected, 1e-15);
    EXPECT_NEAR(fresnel_dielectric(std::cos(1e-6), into_water), expected, 1e-10);
}

TEST(Fresnel, AtBrewstersAngleOnlyHalfOfTheSPartIsReflected) {
    const double brewster = std::atan(n_water); // r_p = 0 there, r_s = -cos(2 * brewster)
    EXPECT_NEAR(fresnel_dielectric(std::cos(brewster), into_water),
                0.5 * std::pow(std::cos(2.0 * brewster), 2.0), 1e-12);
}

TEST(Fresnel, MatchesThePublishedTable) {
    // Air to water, n = 1.333, unpolarised.
    const double degrees[] = {0, 30, 45, 60, 70, 75, 80, 85, 88};
    const double table[] = {.0204, .0214, .0279, .0597, .1335, .2124, .3479, .5835, .804};
    for (int i = 0; i < 9; ++i)
        EXPECT_NEAR(fresnel_dielectric(std::cos(deg(degrees[i])), into_water), table[i], 6e-4);
    EXPECT_NEAR(fresnel_dielectric(std::cos(deg(40)), out_of_water), .056, 6e-4);
    EXPECT_NEAR(fresnel_dielectric(std::cos(deg(48)), out_of_water), .433, 6e-3);
}

TEST(Fresnel, BeyondTheCriticalAngleEverythingIsReflected) {
    const double critical = std::asin(1.0 / n_water);
    EXPECT_EQ(fresnel_dielectric(std::cos(critical + 1e-6), out_of_water), 1.0);
    EXPECT_LT(fresnel_dielectric(std::cos(critical - 1e-6), out_of_water), 1.0);
    EXPECT_EQ(fresnel_schlick(std::cos(critical + 1e-6), out_of_water), 1.0);
}

TEST(Fresnel, IsTheSameForTheReversedRay) {
    for (int degree = 1; degree < 90; ++degree) {
        const double air = deg(degree), water = std::asin(std::sin(air) / n_water);
        EXPECT_NEAR(fresnel_dielectric(std::cos(air), into_water),
                    fresnel_dielectric(std::cos(water), out_of_water), 1e-12);
        EXPECT_NEAR(fresnel_schlick(std::cos(air), into_water),
                    fresnel_schlick(std::cos(water), out_of_water), 1e-12);
    }
}

TEST(Fresnel, SchlickIsOffByUpToSixPercentNear84Degrees) {
    double worst = 0.0, at = 0.0;
    for (double d = 0.0; d < 90.0; d += 0.1) {
        const double off = fresnel_schlick(std::cos(deg(d)), into_water) -
                           fresnel_dielectric(std::cos(deg(d)), into_water);
        if (std::abs(off) > std::abs(worst))
            worst = off, at = d;
    }
    EXPECT_NEAR(worst, 0.059, 0.002);
    EXPECT_NEAR(at, 83.8, 0.5);
}

TEST(Refraction, FollowsSnellAndStaysInItsPlane) {
    const glm::dvec3 in = glm::normalize(glm::dvec3(0.6, -0.3, -0.5));
    const glm::dvec3 out = refracted(in, {0, 0, 1}, into_water);
    EXPECT_NEAR(glm::length(out), 1.0, 1e-14);
    EXPECT_NEAR(std::hypot(out.x, out.y) * n_water, std::hypot(in.x, in.y), 1e-14);
    EXPECT_NEAR(out.x * in.y, out.y * in.x, 1e-14);
    // Incidence 59.917 degrees -> 40.477 degrees; the sun at 45 degrees -> 32.037 (n = 1.333).
    EXPECT_NEAR(std::acos(-refracted({std::sin(deg(59.917)), 0, -std::cos(deg(59.917))}, {0, 0, 1},
                                     into_water)
                               .z) /
                    deg(1),
                40.477, 1e-3);
    EXPECT_NEAR(
        std::acos(-refracted({std::sin(deg(45)), 0, -std::cos(deg(45))}, {0, 0, 1}, into_water).z) /
            deg(1),
        32.037, 1e-3);
    EXPECT_NEAR(1 - fresnel_dielectric(std::cos(deg(59.917)), into_water), .94065, 1e-5);
}

TEST(Medium, PathRadianceEqualsItsQuadrature) {
    const glm::dvec3 bb(0.01, 0.02, 0.5), c(0.05, 0.3, 8.0);
    const Medium medium({.absorption_per_m = c - bb, .backscattering_per_m = bb}, false);
    for (const double sink : {-0.9, -0.2, 0.0, 0.4, 1.0})
        for (const double distance : {0.01, 1.0, 25.0}) {
            const double depth = 30.0, slant = 1.25;
            const glm::dvec3 got = medium.path_radiance(slant, depth, sink, 2.0, distance);
            for (int k = 0; k < 3; ++k) {
                // Midpoints: light comes down to the depth there and goes back along the path.
                double expected = 0.0;
                constexpr int steps = 20'000;
                for (int i = 0; i < steps; ++i) {
                    const double s = (i + 0.5) / steps * distance;
                    expected += bb[k] / (2 * M_PI) * distance / steps *
                                std::exp(-c[k] * (slant * (depth + sink * s) + s + 2.0));
                }
                EXPECT_NEAR(got[k] / expected, 1.0, 1e-4);
            }
        }
}

TEST(Medium, DeepWaterReflectsAboutAQuarterOfItsBackscatterAlbedo) {
    // Straight down into endless water under a zenith sun: pi L / E = b_b / (4 c).
    const Medium medium(
        {.absorption_per_m = glm::dvec3(0.48), .backscattering_per_m = glm::dvec3(0.02)}, false);
    const double L = medium.path_radiance(1.0, 0.0, 1.0, 0.0, 200.0).x;
    EXPECT_NEAR(M_PI * L, 0.02 / (4 * 0.5), 1e-6);
}

TEST(Surface, GradientOfAPlaneAndASaddle) {
    std::vector<float> z;
    for (int r = 0; r < 20; ++r)
        for (int c = 0; c < 30; ++c)
            z.push_back(float(2.0 * c - 3.0 * r + 0.25 * c * r));
    const Heightfield field = quantise(z, {30, 20}, 10.0);
    for (const glm::dvec2 p : {glm::dvec2(5.3, 7.9), glm::dvec2(20.0, 3.5)}) {
        const glm::dvec2 g = ground_gradient(field, p.x, p.y);
        EXPECT_NEAR(g.x, 2.0 + 0.25 * p.y, 3 * field.scale_m);
        EXPECT_NEAR(g.y, -3.0 + 0.25 * p.x, 3 * field.scale_m);
    }
    const glm::dvec3 up = normal_of({10.0, 0.0}, 10.0); // 45 degrees, rising to the east
    EXPECT_NEAR(up.x, -std::sqrt(0.5), 1e-12);
    EXPECT_NEAR(up.z, std::sqrt(0.5), 1e-12);
}

// The grid walk against marching in tiny steps over random small fields, water included.
TEST(GridWalk, FindsWhatBruteForceFinds) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    int hits = 0;
    for (int trial = 0; trial < 400; ++trial) {
        const int side = 4 + int(unit(random) * 8);
        std::vector<float> z(std::size_t(side) * std::size_t(side));
        for (float& v : z)
            v = float(10.0 * std::pow(unit(random), 3.0)); // needles
        Heightfield ground = quantise(z, {side, side}, 1.0);
        ground.north_m = side - 1;
        Heightfield water = ground;
        std::fill(water.codes.values.begin(), water.codes.values.end(), std::uint16_t(20000));
        const glm::dvec3 origin(unit(random) * side * 2 - side / 2.0,
                                unit(random) * side * 2 - side / 2.0, 12.0 * unit(random));
        double over = 0.0; // path over the field
        const glm::dvec3 aim(unit(random) * side, unit(random) * side, 8.0 * unit(random));
        const glm::dvec3 d = glm::normalize(aim - origin);
        // Brute force from where the ray enters the field, in steps of a two-thousandth of a cell.
        double first = -1.0;
        bool wet = false, entered_below = false, inside = false;
        for (double t = 0.0; t < 3.0 * side && first < 0.0; t += 5e-4) {
            const glm::dvec3 p = origin + t * d;
            if (p.x < 0 || p.y < 0 || p.x > side - 1 || p.y > side - 1)
                continue;
            const double land = ground.elevation_m(p.x, p.y), lake = water.elevation_m(p.x, p.y);
            if (p.z <= std::max(land, lake)) {
                first = t;
                wet = lake > land;
                entered_below =
                    !inside; // through the side of the field, below both: the ground's cut
            }
            inside = true;
            over += 5e-4;
        }
        const auto hit = trace_field(ground, &water, origin, d, 1e9);
        if (first < 0.0) {
            // A graze shorter than the step is all that brute force may overlook.
            if (hit && over > 0.01)
                EXPECT_NEAR(hit->point.z,
                            std::max(ground.elevation_m(hit->point.x, hit->point.y),
                                     water.elevation_m(hit->point.x, hit->point.y)),
                            1e-3);
            continue;
        }
        ++hits;
        ASSERT_TRUE(hit.has_value()) << trial;
        EXPECT_LE(hit->t, first + 1e-9) << trial;
        if (first - hit->t > 1e-3) // earlier: then the surface really is there
            EXPECT_NEAR(hit->point.z,
                        std::max(ground.elevation_m(hit->point.x, hit->point.y),
                                 water.elevation_m(hit->point.x, hit->point.y)),
                        1e-6)
                << trial;
        else if (!entered_below)
            EXPECT_EQ(hit->water, wet) << trial;
    }
    EXPECT_GT(hits, 150);
}

// Flat water, bed at 8 m, sun at 45 degrees with irradiance pi, albedo .5, nothing absorbed:
// in the water E_bed albedo / pi = cos 45 (1 - F) .5 = .3437; from above (1 - F0) / n^2 of it.
TEST(Tracer, TheTankHasItsExactRadiances) {
    scene::Scene tank = scene::tank();
    tank.optics = {.name = "lab",
                   .absorption_per_m = {0, 0, 0},
                   .backscattering_per_m = {0, 0, 0},
                   .index = 1.333};
    scene::View view;
    view.lighting = scene::uniform_sky({1, 0, 1}, glm::dvec3(M_PI), glm::dvec3(0));
    view.settings = {
        .width_px = 3, .height_px = 3, .samples = 1, .thrown_back = false, .ground_albedo = 0.5};
    view.camera = scene::look({0, 0, -4}, 0, -90, 1.0);
    const double bed = std::sqrt(0.5) * (1 - fresnel_dielectric(std::sqrt(0.5), into_water)) * 0.5;
    EXPECT_NEAR(bed, .3437, 5e-5);
    EXPECT_NEAR(trace(tank, view, {}).radiance[4].g, bed, 1e-6);
    EXPECT_NEAR(trace(tank, view, {}).distance_m[4], 4.0, 1e-3);
    view.camera = scene::look({0, 0, 20}, 0, -90, 1.0);
    const double above = bed * (1 - fresnel_dielectric(1.0, into_water)) / (n_water * n_water);
    EXPECT_NEAR(above, .1895, 5e-5);
    EXPECT_NEAR(trace(tank, view, {}).radiance[4].g, above, 1e-6);
    // Seen obliquely through the surface at 60 degrees in air, with an even sky mirrored in it.
    view.lighting = scene::uniform_sky({1, 0, 1}, glm::dvec3(M_PI), glm::dvec3(0.2));
    view.camera = scene::look({0, -10, 5}, 0, -30, 1.0);
    const double sky_bed =
        0.5 / M_PI * 0.2 * M_PI *
        Medium(tank.optics, true).sky_entering(); // even sky through the surface, no loss
    const double mirror = fresnel_dielectric(0.5, into_water);
    EXPECT_NEAR(trace(tank, view, {}).radiance[4].g,
                mirror * 0.2 + (1 - mirror) / (n_water * n_water) * (bed + sky_bed), 1e-6);
    // From below, straight up: the sky is n^2 brighter, less what is mirrored, plus the mirrored
    // bed.
    view.camera = scene::look({0, 0, -4}, 0, 90, 1.0);
    const double f0 = fresnel_dielectric(1.0, out_of_water);
    EXPECT_NEAR(trace(tank, view, {}).radiance[4].g,
                (1 - f0) * n_water * n_water * 0.2 + f0 * (bed + sky_bed), 1e-6);
    // From below at 60 degrees from the vertical: total reflection shows the bed alone.
    view.camera = scene::look({0, 0, -4}, 0, 30, 1.0);
    EXPECT_NEAR(trace(tank, view, {}).radiance[4].g, bed + sky_bed, 1e-6);
}

TEST(Tracer, AbsorptionFollowsBeerLambertOnTheWayDownAndUp) {
    scene::Scene tank = scene::tank();
    tank.optics = {.name = "lab",
                   .absorption_per_m = {0.3, 0.1, 0.02},
                   .backscattering_per_m = {0, 0, 0},
                   .index = 1.333};
    scene::View view;
    view.lighting = scene::uniform_sky({0, 0, 1}, glm::dvec3(M_PI), glm::dvec3(0));
    view.settings = {
        .width_px = 3, .height_px = 3, .samples = 1, .thrown_back = false, .ground_albedo = 0.5};
    view.camera = scene::look({0, 0, 20}, 0, -90, 1.0);
    const glm::vec3 got = trace(tank, view, {}).radiance[4];
    const double through =
        std::pow(1 - fresnel_dielectric(1.0, into_water), 2.0) / (n_water * n_water) * 0.5;
    EXPECT_NEAR(got.r / (through * std::exp(-16 * 0.3)), 1.0, 1e-3);
    EXPECT_NEAR(got.g / (through * std::exp(-16 * 0.1)), 1.0, 1e-3);
    EXPECT_NEAR(got.b / (through * std::exp(-16 * 0.02)), 1.0, 1e-3);
}

// The land's shadow by doubling against a ray from each place towards the sun.
TEST(Sun, LandsShadowIsThatOfRays) {
    const scene::Scene scene = scene::mountain_lake(257);
    for (const double rise : {0.05, 0.15, 0.4}) {
        const glm::dvec3 sun = glm::normalize(glm::dvec3(0.8, -0.5, rise));
        const auto shadow = scene::land_shadow(scene, sun);
        if (!shadow) {
            EXPECT_GT(rise, 0.2);
            continue;
        }
        int right = 0, judged = 0, dark = 0;
        const Heightfield& g = scene.ground;
        for (int r = 2; r < shadow->rows - 2; r += 3)
            for (int c = 2; c < shadow->cols - 2; c += 3) {
                const double x = g.west_m +
                                 (c + 0.5) * (g.size().cols - 1) * g.spacing_m / shadow->cols,
                             y = g.north_m -
                                 (r + 0.5) * (g.size().rows - 1) * g.spacing_m / shadow->rows;
                const auto level = scene.water_level_m(x, y);
                if (!level)
                    continue;
                const double over =
                    shadow->height_m[std::size_t(r) * std::size_t(shadow->cols) + std::size_t(c)] -
                    *level;
                if (std::abs(over) < 2.0 * shadow->softness_m)
                    continue; // the edge
                const bool hidden =
                    reference::trace_field(g, nullptr, {x, y, *level + 0.01}, sun, 1e9, -1e9)
                        .has_value();
                ++judged;
                dark += hidden;
                right += hidden == (over > 0.0);
            }
        std::printf("rise %.2f: %d of %d places right, %d in shadow\n", rise, right, judged, dark);
        EXPECT_GE(right, 0.98 * judged) << rise;
        if (rise < 0.1)
            EXPECT_GT(dark, judged / 20);
    }
}
