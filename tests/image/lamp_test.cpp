// A diver's lamp: by hand, against the reference, and nothing where it is off.
#include "image/compare.hpp"
#include "reference/tracer.hpp"
#include "render/renderer.hpp"
#include "scene/samples.hpp"
#include "scene/water_types.hpp"
#include "support/gpu_function.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

using namespace tarn;

namespace {

/// Night over the tank: bed at -8 m, water at 0.
scene::View night(double z, double pitch_deg) {
    scene::View view;
    view.lighting = scene::uniform_sky({0, 0, -1}, glm::dvec3(0.0), glm::dvec3(0.0));
    view.camera = scene::look({0, 0, z}, 30, pitch_deg, 70);
    view.settings = {.width_px = 48, .height_px = 32, .samples = 1};
    view.settings.dive_light_cd = 10000.0;
    return view;
}

} // namespace

// Straight down from 3 m over a bed of albedo .5 through water that only absorbs: E = I / (t^2 +
// a^2), there and back.
TEST(Lamp, LightsTheBedByTheSquareOfTheDistance) {
    test_support::context();
    scene::Scene scene = scene::tank();
    scene.optics.absorption_per_m = {0.3, 0.1, 0.2};
    scene.optics.backscattering_per_m = glm::dvec3(0.0);
    scene.optics.bands.clear();
    render::Renderer renderer(scene);
    scene::View view = night(-5.0, -90.0);
    view.settings.ground_albedo = 0.5;
    view.settings.thrown_back = false;
    view.settings.width_px = view.settings.height_px = 9;
    view.camera.fov_deg = 1.0;
    const glm::vec3 got = renderer.draw(view).radiance[40];
    const double e = 10000.0 * M_PI / 133300.0 / (9.0 + 0.0625);
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(got[k], 0.5 / M_PI * e * std::exp(-6.0 * scene.optics.absorption_per_m[k]),
                    1e-3 * got[k]);
    view.settings.dive_light_cd = 0.0;
    EXPECT_EQ(renderer.draw(view).radiance[40], glm::vec3(0.0f));
}

TEST(Lamp, IsTheReferencesInItsConeAndBesideIt) {
    test_support::context();
    scene::Scene scene = scene::tank();
    for (const char* water : {"pure", "clear lake", "glacial lake"}) {
        scene.optics = scene::water_type(water);
        render::Renderer renderer(scene);
        for (const double pitch : {-30.0, 10.0}) {
            const scene::View view = night(-5.0, pitch);
            const Image got = renderer.draw(view), expected = reference::trace(scene, view, {});
            const image::Difference d = image::compare(got, expected);
            std::printf("%s, pitch %.0f: mean %.3f %%, 99th %.3f %%\n", water, pitch,
                        100 * d.mean_relative, 100 * d.p99_relative);
            EXPECT_LT(d.mean_relative, 0.005) << water << pitch;
            EXPECT_LT(d.p99_relative, 0.03) << water << pitch;
            EXPECT_GT(got.radiance[16 * 48 + 24].g, 0.0f); // along the view
            EXPECT_EQ(got.radiance[0], glm::vec3(0.0f));   // beside the cone it is night
        }
    }
}
