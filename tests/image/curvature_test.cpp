// The Earth's curvature: where the horizon is, what it hides, the reference, and that small scenes
// know nothing of it.
#include "image/compare.hpp"
#include "reference/heightfield.hpp"
#include "reference/tracer.hpp"
#include "render/renderer.hpp"
#include "scene/curvature.hpp"
#include "scene/samples.hpp"
#include "support/gpu_function.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;

namespace {

constexpr double ridge_x_m = 20000.0, ridge_top_m = 200.0, eye_m = 2.0;

/// A lake 60 km wide, 20 m deep, its level 0, with a ridge across it.
scene::Scene great_lake() {
    scene::Scene scene = scene::tank(); // 201 x 201
    for (Heightfield* h : {&scene.ground, &scene.water}) {
        h->spacing_m = 300.0;
        h->west_m = -30000.0;
        h->north_m = 30000.0;
    }
    scene.ground.offset_m = -20.0;
    scene.ground.scale_m = 0.01;
    scene.water.offset_m = -1.0;
    scene.water.scale_m = 1.0;
    const GridSize size = scene.ground.size();
    for (int row = 0; row < size.rows; ++row)
        for (int col = 0; col < size.cols; ++col) {
            const double x = scene.ground.x_m(col);
            const double z =
                std::max(-20.0, ridge_top_m - 0.1 * std::abs(x - ridge_x_m)); // slopes of 10 %
            scene.ground.codes[{col, row}] = std::uint16_t(std::lround((z + 20.0) / 0.01));
            scene.water.codes[{col, row}] = 1;
        }
    scene.lakes.front().level_m = 0.0;
    return scene;
}

scene::View to_the_east(double fov_deg, int height_px) {
    scene::View view;
    view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(-0.5, 0.4, 0.6)));
    view.camera = scene::look({-28000.0, 40.0, eye_m}, 90.0, 0.0, fov_deg);
    view.settings = {.width_px = 8, .height_px = height_px, .samples = 1};
    return view;
}

} // namespace

// Snellius' rule: from a height h the horizon is sqrt(2 R h / (1 - k)) away.
TEST(Curvature, TheHorizonIsWhereItIs) {
    test_support::context();
    const scene::Scene scene = great_lake();
    render::Renderer renderer(scene);
    const scene::View view = to_the_east(0.5, 2000); // 4.4e-6 rad a pixel
    const Image image = renderer.draw(view);
    double farthest = 0.0;
    for (std::size_t i = 0; i < image.distance_m.size(); ++i)
        if (image.distance_m[i] < 20000.0) // water this side of the horizon; beyond it, the ridge
            farthest = std::max(farthest, double(image.distance_m[i]));
    const double horizon = std::sqrt(eye_m / scene::bend_per_m);
    EXPECT_NEAR(horizon, 5411.0, 2.0);
    // A ray a pixel below the horizon meets the water sqrt(d / bend) before it.
    EXPECT_NEAR(farthest, horizon, std::sqrt(eye_m / scene::bend_per_m * 0.03) + 100.0);
    EXPECT_GT(farthest, 0.85 * horizon);
}

// Of the ridge 48 km away the lowest 124 m are hidden, a flat map would show all of it.
TEST(Curvature, HidesTheFootOfAFarRidge) {
    test_support::context();
    const scene::Scene scene = great_lake();
    render::Renderer renderer(scene);
    scene::View view = to_the_east(0.5, 2000);
    const auto lowest_seen = [&](std::optional<bool> curved) {
        view.settings.earth_curvature = curved;
        const Image image = renderer.draw(view);
        double lowest = 1e9;
        for (const float d : image.distance_m)
            if (d > 40000.0f && d < 60000.0f)
                lowest = std::min(lowest, ridge_top_m - 0.1 * std::abs(double(d) - 48000.0));
        return lowest;
    };
    // The slope itself is met where it stands above the line that touches the water.
    double hidden = 0.0;
    for (double x = 45000.0; x < 48000.0; x += 1.0) {
        const double horizon = std::sqrt(eye_m / scene::bend_per_m);
        const double line = scene::bend_per_m * (x - horizon) * (x - horizon);
        if (ridge_top_m - 0.1 * (48000.0 - x) >= line) {
            hidden = line;
            break;
        }
    }
    EXPECT_NEAR(hidden, 121.0, 3.0);
    EXPECT_NEAR(lowest_seen(std::nullopt), hidden, 1.0); // a pixel is 21 cm there
    EXPECT_LT(lowest_seen(false), 1.0);
}

TEST(Curvature, IsLeftOutWhereItIsLessThanAPixel) {
    const scene::Scene bowl = scene::bowl(65), great = great_lake();
    scene::View view = to_the_east(45.0, 1080);
    EXPECT_TRUE(scene::is_curved(great, view)); // 58 km: 8.6e-3 rad
    const scene::CurvatureDrop drop = scene::curvature_drop(great, view.camera, 1080);
    EXPECT_NEAR(drop.drop_m, drop.distance_m * drop.distance_m * 0.87 / (2 * 6371008.8), 1e-9);
    EXPECT_NEAR(drop.pixels, drop.drop_m / drop.distance_m / (2 * std::tan(M_PI / 8) / 1080), 1e-9);
    view.camera = scene::look({0, 0, 50}, 90.0, 0.0, 45.0);
    EXPECT_FALSE(scene::is_curved(bowl, view));
    view.settings.earth_curvature = true;
    EXPECT_TRUE(scene::is_curved(bowl, view));
    // What is left out, is no more than that: pictures of the bowl are the same to a thousandth.
    test_support::context();
    render::Renderer renderer(bowl);
    view.settings.width_px = 160;
    view.settings.height_px = 120;
    const Image with = renderer.draw(view);
    view.settings.earth_curvature = false;
    const Image without = renderer.draw(view);
    EXPECT_LT(image::compare(without, with).mean_relative, 1e-3);
}

// Every exact walk, from above, from the shore and from below, against double precision.
TEST(Curvature, PicturesAreThoseOfTheReference) {
    test_support::context();
    scene::Scene mountains = scene::mountain_lake(257);
    for (Heightfield* h : {&mountains.ground, &mountains.water}) { // 80 km wide
        h->spacing_m *= 5.0;
        h->west_m *= 5.0;
        h->north_m *= 5.0;
    }
    const scene::Scene lakes[] = {mountains, great_lake()};
    for (const scene::Scene& scene : lakes) {
        render::Renderer renderer(scene);
        const Heightfield& g = scene.ground;
        const double level = scene.lakes.front().level_m;
        const scene::Camera cameras[] = {
            scene::look({0.9 * g.west_m, 0, level + 1500.0}, 90, -2.0, 12.0),
            scene::look({0, 0, level + 3.0}, 60, 0.3, 6.0),
            scene::look({0, 0, level - 2.0}, 60, 35.0, 70.0)};
        for (const scene::Camera& camera : cameras) {
            scene::View view;
            view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(-0.5, 0.4, 0.3)));
            view.camera = camera;
            view.settings = {.width_px = 160, .height_px = 120, .samples = 1};
            view.settings.earth_curvature = true;
            const Image expected = reference::trace(scene, view, {});
            for (const scene::WalkMethod& method : scene::walk_methods()) {
                if (!method.exact || method.walk == scene::Walk::safety_exact)
                    continue; // radii are of straight rays
                view.settings.walk = method.walk;
                const Image got = renderer.draw(view);
                const image::Difference d = image::compare(got, expected);
                const auto z = image::compare_distances(got, expected, g.scale_m, 1e-5);
                EXPECT_LE(d.mean_relative, 0.005) << method.name;
                EXPECT_EQ(z.different, 0u) << method.name << ", worst " << z.worst_m << " m";
                EXPECT_LT(z.edges, z.pixels / 3);
                std::printf("%-15s mean %.4f %%, 99th %.3f %%, %zu of %zu edge pixels\n",
                            method.name, 100 * d.mean_relative, 100 * d.p99_relative, z.edges,
                            z.pixels);
            }
            view.settings.walk = scene::Walk::cone_map;
            view.settings.earth_curvature = false; // and that is another picture
            const double flat = image::compare(renderer.draw(view), expected).mean_relative;
            if (camera.position.z > level)
                EXPECT_GT(flat, 0.01);
        }
    }
}

// Waves far out: the slab is met, and left again, by curved rays.
TEST(Curvature, WavesAtTheHorizonAreThoseOfTheReference) {
    test_support::context();
    const scene::Scene scene = great_lake();
    render::Renderer renderer(scene);
    scene::View view = to_the_east(2.0, 96);
    view.settings.width_px = 24;
    view.settings.samples = 2;
    view.lighting.sun_disc = false; // the reference finds its mirror images by chance alone
    view.settings.caustics = scene::Caustics::off;
    view.waves.model = waves::Model::jonswap;
    view.waves.wind_m_per_s = 6.0;
    view.waves.fetch_m = 5000.0;
    view.waves.texels = 128;
    const Image expected = reference::trace(scene, view, {});
    const Image got = renderer.draw(view);
    // The ridge rises out of the water at the same row; sky, ridge and water are as bright.
    int different = 0;
    for (int top = 0; top < 96; top += 8) {
        glm::dvec3 a(0.0), b(0.0);
        for (int y = top; y < top + 8; ++y) {
            int ridge_a = 0, ridge_b = 0;
            for (int x = 0; x < 24; ++x) {
                const std::size_t i = std::size_t(y) * 24 + std::size_t(x);
                a += glm::dvec3(got.radiance[i]);
                b += glm::dvec3(expected.radiance[i]);
                const auto far = [](float d) { return d > 40000.0f && d < 60000.0f; };
                ridge_a += far(got.distance_m[i]);
                ridge_b += far(expected.distance_m[i]);
            }
            different += std::abs(ridge_a - ridge_b) > 2;
        }
        std::printf("rows %d to %d: %.3f of the reference\n", top, top + 7, a.g / b.g);
        // Water this side of the horizon lies at half a degree, where wavy water is up to 16 % too
        // bright on a flat Earth, too (docs/waves.md); beyond it all is as exact as in calm water.
        EXPECT_NEAR(a.g / b.g, 1.0, top < 48 ? 0.005 : 0.15) << "from row " << top;
    }
    EXPECT_LE(different, 1);
}
