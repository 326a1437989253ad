#include "core/error.hpp"
#include "scene/camera_path.hpp"
#include "scene/curvature.hpp"
#include "scene/drape.hpp"
#include "scene/environment.hpp"
#include "scene/lighting.hpp"
#include "scene/presets.hpp"
#include "scene/samples.hpp"
#include "scene/settings.hpp"
#include "scene/space_lines.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;
using namespace tarn::scene;

TEST(Camera, LookAgreesWithCompassAndPlumbLine) {
    const Camera east = look({0, 0, 0}, 90.0, 0.0, 60.0);
    EXPECT_NEAR(east.forward.x, 1.0, 1e-12);
    EXPECT_NEAR(east.right.y, -1.0, 1e-12); // south is on the right when looking east
    EXPECT_NEAR(east.up.z, 1.0, 1e-12);
    const Camera down = look({0, 0, 0}, 0.0, -90.0, 60.0);
    EXPECT_NEAR(down.forward.z, -1.0, 1e-12);
    EXPECT_NEAR(down.up.y, 1.0, 1e-12); // north at the top
    // The corners of a 60 degree picture: half the height at tan 30.
    const glm::dvec3 top = pixel_direction(east, 50, 0, 100, 100);
    EXPECT_NEAR(top.z / top.x, std::tan(M_PI / 6), 1e-12);
    EXPECT_THROW(look_along({0, 0, 0}, {0, 0, 1}, {0, 0, 1}, 50), Error);
    EXPECT_THROW(look_along({0, 0, 0}, {0, 0, 0}, {0, 0, 1}, 50), Error);
    EXPECT_THROW(look_along({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 180), Error);
}

TEST(SpaceLines, HeightsCountFromDatumLevelOrGround) {
    const Scene s = bowl(129);
    const double ground = s.ground.elevation_m(100.0, 0.0);
    EXPECT_EQ(place_in_space(s, {100, 0, 7}, HeightsFrom::datum).z, 7.0);
    EXPECT_NEAR(place_in_space(s, {100, 0, -2}, HeightsFrom::level).z, 8.0, 1e-3);
    EXPECT_NEAR(place_in_space(s, {450, 0, -2}, HeightsFrom::level).z, 8.0, 1e-3); // on dry land
    EXPECT_NEAR(place_in_space(s, {100, 0, 2}, HeightsFrom::ground).z, ground + 2.0, 1e-9);
    EXPECT_NEAR(place_in_space(s, {100, 0, std::nan("")}, HeightsFrom::ground).z, ground, 1e-9);
    EXPECT_THROW(place_in_space(s, {100, 0, std::nan("")}, HeightsFrom::datum), Error);
    // Far outside the ground's border counts.
    EXPECT_TRUE(std::isfinite(place_in_space(s, {1e6, 0, 2}, HeightsFrom::ground).z));
}

TEST(SpaceLines, ASightingObeysSnell) {
    const Scene s = bowl(257);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> even(0.0, 1.0);
    const auto lean = [](const glm::dvec3& v) { return std::hypot(v.x, v.y) / glm::length(v); };
    int seen_ones = 0;
    for (int i = 0; i < 400; ++i) {
        const double r = 150.0 * std::sqrt(even(random)), a = 6.283 * even(random);
        const glm::dvec3 in_water(r * std::cos(a), r * std::sin(a), 6.5 + 3.0 * even(random)),
            in_air(80.0 * even(random), 80.0 * even(random), 10.5 + 20.0 * even(random));
        for (const bool dives : {false, true}) {
            const auto seen = sighting_of(s, dives ? in_water : in_air, dives ? in_air : in_water);
            if (!seen) // behind the bed
                continue;
            ++seen_ones;
            EXPECT_TRUE(seen->through_water);
            const glm::dvec3 eye = dives ? in_water : in_air, other = dives ? in_air : in_water;
            glm::dvec3 crossing = eye + seen->distance_m * seen->towards;
            // What the Earth's curvature takes off at its distance is put back.
            const double away = std::hypot(crossing.x - eye.x, crossing.y - eye.y);
            if (!dives)
                crossing.z += bend_per_m * away * away;
            EXPECT_NEAR(crossing.z, 10.0, 1e-5);
            const double here = lean(crossing - eye), there = lean(other - crossing);
            EXPECT_NEAR(here * (dives ? 1.333 : 1.0), there * (dives ? 1.0 : 1.333), 1e-6);
            const glm::dvec3 upright = glm::cross(crossing - eye, other - crossing);
            EXPECT_NEAR(upright.z, 0.0, 1e-3 * glm::length(other - eye)); // in one plane
        }
    }
    EXPECT_GT(seen_ones, 300);
    // Straight down water looks three quarters as deep; here it is the direction alone that counts.
    const auto down = sighting_of(s, {0, 0, 20}, {0, 0, 5});
    ASSERT_TRUE(down);
    EXPECT_NEAR(down->towards.z, -1.0, 1e-9);
    EXPECT_NEAR(down->distance_m, 10.0, 1e-3);
    EXPECT_FALSE(sighting_of(s, {0, 0, 20}, {0, 0, -1}));   // in the bed
    EXPECT_FALSE(sighting_of(s, {600, 0, 20}, {0, 0, 12})); // beyond the rim
    EXPECT_TRUE(sighting_of(s, {450, 0, 40}, {-450, 0, 40}));
}

TEST(Sky, UniformSkyHasIrradiancePiTimesItsRadiance) {
    const Lighting sky = uniform_sky({0, 0, 1}, glm::dvec3(0), {1, 2, 3});
    EXPECT_NEAR(sky.sky_irradiance.y, 2 * M_PI, 1e-12);
    // The quadrature itself, on a table fine enough for it.
    SkyTable table{.azimuths = 64,
                   .elevations = 256,
                   .radiance = std::vector<glm::vec3>(64 * 256, glm::vec3(1))};
    EXPECT_NEAR(horizontal_irradiance(table).x, M_PI, 1e-3);
}

TEST(Sky, ClearSkyConservesEnergyAndIsBlue) {
    for (const double degrees : {5.0, 20.0, 45.0, 80.0}) {
        const double e = degrees * M_PI / 180;
        const Lighting light = clear_sky({std::cos(e), 0, std::sin(e)});
        for (int k = 0; k < 3; ++k) {
            const double direct = light.sun_irradiance[k] * std::sin(e), above = M_PI * std::sin(e);
            EXPECT_LT(direct + light.sky_irradiance[k], above) << degrees; // no more than comes in
            EXPECT_GT(direct + light.sky_irradiance[k], 0.35 * above) << degrees;
            EXPECT_GT(light.sky_irradiance[k], 0.01 * above);
        }
        EXPECT_GT(light.sky_irradiance.b, 1.5 * light.sky_irradiance.r); // blue sky
        EXPECT_LT(light.sun_irradiance.b, light.sun_irradiance.r);       // yellow sun
    }
    // Diffuse share at 45 degrees in clear air: 8 to 20 % in broad measurements.
    const Lighting noon = clear_sky(glm::normalize(glm::dvec3(1, 0, 1)));
    const double share =
        noon.sky_irradiance.g / (noon.sky_irradiance.g + noon.sun_irradiance.g * std::sqrt(0.5));
    EXPECT_GT(share, 0.06);
    EXPECT_LT(share, 0.20);
    EXPECT_EQ(clear_sky({1, 0, -0.2}).sun_irradiance.g, 0.0);
}

// A map with a sun of known size, brightness and place in an even sky: its light is the sun's, the
// sky stays even, and together they are the map's own light. Turned, the sun turns.
TEST(Sky, AnEnvironmentMapHasItsSunTakenOut) {
    const int w = 720, h = 360;
    const glm::dvec3 sky(0.2, 0.3, 0.5);
    const double azimuth = 0.7, elevation = 0.6;
    const auto direction = [](double a, double e) {
        return glm::dvec3(std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e));
    };
    const glm::dvec3 sun = direction(azimuth, elevation);
    Image map{.width_px = w, .height_px = h, .radiance = {}, .distance_m = {}};
    glm::dvec3 put_in(0.0), on_level(0.0);
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            const double a = ((x + 0.5) / w - 0.5) * 2 * M_PI, e = (0.5 - (y + 0.5) / h) * M_PI;
            const double angle = 2 * M_PI / w * (M_PI / h) * std::cos(e);
            glm::dvec3 c = sky;
            if (glm::dot(direction(a, e), sun) > std::cos(0.02)) {
                c += glm::dvec3(900, 800, 700);
                put_in += angle * glm::dvec3(900, 800, 700);
            }
            on_level += angle * std::max(std::sin(e), 0.0) * c;
            map.radiance.emplace_back(c);
        }
    const Lighting light = environment(map);
    EXPECT_GT(glm::dot(light.sun_direction, sun), std::cos(0.003));
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(light.sun_irradiance[k] / put_in[k], 1.0, 0.002);
        EXPECT_NEAR(light.sky_irradiance[k] / (M_PI * sky[k]), 1.0, 0.002);
        EXPECT_NEAR((light.sky_irradiance[k] + light.sun_irradiance[k] * light.sun_direction.z) /
                        on_level[k],
                    1.0, 0.003);
    }
    EXPECT_GT(
        glm::dot(environment(map, 90.0).sun_direction, direction(azimuth + M_PI / 2, elevation)),
        std::cos(0.003));
    // Without a bright place there is no sun; wrong shapes and values are refused.
    Image even = map;
    std::fill(even.radiance.begin(), even.radiance.end(), glm::vec3(1.0f));
    EXPECT_EQ(environment(even).sun_irradiance.g, 0.0);
    even.radiance[5].g = -1.0f;
    EXPECT_THROW(environment(even), Error);
    even.radiance[5].g = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(environment(even), Error);
    even.width_px = 719;
    EXPECT_THROW(environment(even), Error);
}

TEST(Settings, OutOfRangeNamesTheField) {
    RenderSettings{}.validate();
    for (const RenderSettings& wrong :
         {RenderSettings{.width_px = 0}, RenderSettings{.height_px = 16385},
          RenderSettings{.samples = 0}, RenderSettings{.caustic_texels = 8},
          RenderSettings{.caustic_photons = 3}, RenderSettings{.shaft_steps = -1},
          RenderSettings{.least_transmittance = 0.9}, RenderSettings{.ground_albedo = 1.5}})
        EXPECT_THROW(wrong.validate(), Error);
    EXPECT_DOUBLE_EQ(
        greatest_path_m({.absorption_per_m = {1, 2, 3}, .backscattering_per_m = {0, 0, 0}},
                        {.least_transmittance = std::exp(-3.0)}),
        3.0);
    EXPECT_EQ(
        greatest_path_m({.absorption_per_m = {0, 0, 0}, .backscattering_per_m = {0, 0, 0}}, {}),
        1e9);
}

TEST(Settings, SamplesFillThePixelEvenly) {
    EXPECT_EQ(sample_offset(0, 1), glm::dvec2(0.5));
    int quadrant[4] = {};
    for (int i = 0; i < 64; ++i) {
        const glm::dvec2 p = sample_offset(i, 64);
        ++quadrant[(p.x < 0.5) + 2 * (p.y < 0.5)];
    }
    for (const int count : quadrant)
        EXPECT_NEAR(count, 16, 2);
}

TEST(Presets, StandWhereTheirNamesSay) {
    for (const Scene& scene : {mountain_lake(257), bowl(129)}) {
        const LakeRecord& lake = scene.lakes.front();
        const glm::dvec3 sun = glm::normalize(glm::dvec3(1, -1, 1));
        for (const std::string& name : preset_names()) {
            const Camera c = preset_camera(scene, lake, name, sun, 16.0 / 9.0);
            const glm::dvec3 p = c.position;
            const bool wet = scene.water_level_m(p.x, p.y).has_value();
            const double ground = scene.ground.elevation_m(p.x, p.y);
            EXPECT_NEAR(glm::length(c.forward), 1.0, 1e-9);
            EXPECT_GT(p.z, ground) << name;
            if (name == "dive") {
                EXPECT_TRUE(wet);
                EXPECT_LT(p.z, lake.level_m);
            } else {
                EXPECT_GT(p.z, lake.level_m) << name;
            }
            if (name == "shore")
                EXPECT_FALSE(wet);
        }
        EXPECT_THROW(preset_camera(scene, lake, "moon", sun, 1.0), Error);
    }
}

TEST(Samples, TheBowlHasItsExactFigures) {
    const Scene scene = bowl(401);
    EXPECT_NEAR(scene.lakes[0].area_m2, M_PI * 250 * 250, 0.005 * M_PI * 250 * 250);
    EXPECT_NEAR(*scene.lakes[0].volume_m3, M_PI * 250 * 250 * 5, 0.005 * M_PI * 250 * 250 * 5);
    scene.validate();
    mountain_lake(129).validate();
    tank().validate();
}

namespace {
glm::dvec3 at(const scene::Camera& c) { return c.position; }
} // namespace

TEST(CameraPath, GoesThroughItsKeysAtAnEvenPace) {
    const scene::Scene bowl = scene::bowl(129);
    const std::vector<scene::Camera> keys = {
        scene::look({-300, -300, 120}, 45, -20, 50), scene::look({0, -200, 60}, 10, -10, 60),
        scene::look({10, -190, 58}, 0, -10, 60), scene::look({200, 100, 90}, -60, -30, 40)};
    const auto way = scene::path_through(keys, 500, bowl.ground);
    ASSERT_EQ(way.size(), 500u);
    EXPECT_NEAR(glm::length(at(way.front()) - at(keys.front())), 0.0, 1e-9);
    EXPECT_NEAR(glm::length(at(way.back()) - at(keys.back())), 0.0, 1e-9);
    double length = 0.0, longest = 0.0;
    for (std::size_t i = 1; i < way.size(); ++i) {
        const double step = glm::length(at(way[i]) - at(way[i - 1]));
        length += step;
        longest = std::max(longest, step);
        EXPECT_NEAR(glm::length(way[i].forward), 1.0, 1e-9);
        EXPECT_GT(glm::dot(way[i].forward, way[i - 1].forward), 0.99) << "a jerk at " << i;
    }
    EXPECT_LT(longest, 2.0 * length / 499.0) << "no leaps";
    for (const scene::Camera& key : keys) { // through all of them
        double nearest = 1e9;
        for (const scene::Camera& c : way)
            nearest = std::min(nearest, glm::length(at(c) - at(key)));
        EXPECT_LT(nearest, longest);
    }
    EXPECT_EQ(scene::path_through({keys[0]}, 7, bowl.ground).size(), 7u);
    EXPECT_EQ(scene::path_through(keys, 1, bowl.ground).size(), 1u);
}

TEST(CameraPath, StaysAboveTheGround) {
    const scene::Scene lake = scene::mountain_lake(257);
    const Heightfield& g = lake.ground;
    const double z = g.min_elevation_m() + 10.0;
    const auto way = scene::path_through({scene::look({g.west_m + 100, 0, z}, 90, 0, 50),
                                          scene::look({g.east_m() - 100, 0, z}, 90, 0, 50)},
                                         300, g);
    for (const scene::Camera& c : way)
        EXPECT_GE(c.position.z, g.elevation_m(c.position.x, c.position.y) + 0.49);
    const auto track = scene::path_along({{g.west_m + 100, -500}, {0, 700}, {g.east_m() - 100, 0}},
                                         20.0, lake.lakes[0].level_m, 60.0, 300, g);
    ASSERT_EQ(track.size(), 300u);
    for (const scene::Camera& c : track) {
        EXPECT_GE(c.position.z, g.elevation_m(c.position.x, c.position.y) + 0.49);
        EXPECT_LT(c.forward.z, 0.0);
    }
    EXPECT_GT(track.front().forward.x, 0.0); // looks ahead
}

TEST(Drape, IsNearOnTheLineAndNowhereElse) {
    const scene::Scene bowl = scene::bowl(129);
    EXPECT_FALSE(scene::make_drape(bowl.ground, {{{9000, 0}, {9000, 100}}}, {}));
    EXPECT_FALSE(scene::make_drape(bowl.ground, {}, {}));
    const glm::dvec2 a(-400, -100), b(300, 200);
    const auto drape = scene::make_drape(bowl.ground, {{a, b, {5000, 200}}}, {{0, 300}});
    ASSERT_TRUE(drape);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> place(-490.0, 490.0);
    for (int i = 0; i < 20'000; ++i) {
        const int c = int((place(random) - drape->west_m) / drape->texel_m),
                  r = int((drape->north_m - place(random)) / drape->texel_m);
        if (c < 0 || r < 0 || c >= drape->cols || r >= drape->rows)
            continue;
        const glm::dvec2 p(drape->west_m + (c + 0.5) * drape->texel_m,
                           drape->north_m - (r + 0.5) * drape->texel_m);
        const auto away = [&](glm::dvec2 s, glm::dvec2 e) {
            const double f = std::clamp(glm::dot(p - s, e - s) / glm::dot(e - s, e - s), 0.0, 1.0);
            return glm::length(p - s - (e - s) * f);
        };
        const double ring = std::abs(glm::length(p - glm::dvec2(0, 300)) - 3.0 * drape->texel_m);
        const double nearest = std::min(away(a, b), away(b, {5000, 200}));
        const double expected = std::max(0.0, 1.0 - nearest / drape->reach_m);
        const double found =
            drape->nearness[std::size_t(r) * std::size_t(drape->cols) + std::size_t(c)] / 255.0;
        if (ring > drape->reach_m) {
            EXPECT_NEAR(found, expected, 0.003) << p.x << ", " << p.y;
        } else {
            EXPECT_GE(found, expected - 0.003);
        }
    }
}
