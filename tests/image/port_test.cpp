// A camera half in, half out of the water.
#include "image/compare.hpp"
#include "reference/tracer.hpp"
#include "render/renderer.hpp"
#include "scene/samples.hpp"
#include "support/gpu_function.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

using namespace tarn;

namespace {

scene::View at_the_surface(double above_m, double pitch_deg) {
    scene::View view;
    view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(0.5, -0.4, 0.6)));
    view.lighting.sun_disc = false;
    view.camera = scene::look({20, -150, 10.0 + above_m}, 15, pitch_deg, 60);
    view.settings = {.width_px = 120, .height_px = 90, .samples = 1};
    view.settings.port_m = 0.1;
    return view;
}

} // namespace

TEST(Port, CalmWaterIsTheReferencesAboveAndBelowTheLine) {
    test_support::context();
    const scene::Scene scene = scene::bowl(257);
    render::Renderer renderer(scene);
    for (const double above : {0.0, 0.03, -0.05})
        for (const double pitch : {0.0, -20.0, 15.0}) {
            const scene::View view = at_the_surface(above, pitch);
            const Image got = renderer.draw(view), expected = reference::trace(scene, view, {});
            const image::Difference d = image::compare(got, expected);
            EXPECT_LT(d.mean_relative, 0.002) << above << " " << pitch;
            EXPECT_LT(d.p99_relative, 0.02) << above << " " << pitch;
        }
}

// The line is where the dome meets the level, to a pixel: in ink, what is in the water is black.
TEST(Port, TheLineIsWhereTheDomeMeetsTheLevel) {
    test_support::context();
    scene::Scene scene = scene::bowl(257);
    scene.optics.absorption_per_m = glm::dvec3(1e4);
    scene.optics.backscattering_per_m = glm::dvec3(0.0);
    scene.optics.bands.clear();
    render::Renderer renderer(scene);
    for (const double above : {0.0, 0.03, -0.02}) {
        scene::View view = at_the_surface(above, 0.0);
        view.settings.height_px = 400;
        view.settings.width_px = 9;
        const Image got = renderer.draw(view);
        const double sine = -above / view.settings.port_m; // of the ray through level and dome
        const double row = 200.0 - std::tan(std::asin(sine)) / std::tan(M_PI / 6.0) * 200.0;
        int first = 0;
        while (first < 400 && got.radiance[std::size_t(first) * 9 + 4].g > 1e-3f)
            ++first;
        EXPECT_NEAR(first, row, 1.0) << above;
        for (int y = first; y < 400; ++y)
            EXPECT_LE(got.radiance[std::size_t(y) * 9 + 4].g, 1e-3f) << above << " " << y;
    }
}

TEST(Port, WavesBeforeItAreTheReferences) {
    test_support::context();
    const scene::Scene scene = scene::bowl(129);
    render::Renderer renderer(scene);
    scene::View view = at_the_surface(0.0, 0.0);
    view.settings.width_px = 48;
    view.settings.height_px = 48;
    view.settings.samples = 4;
    view.settings.caustics = scene::Caustics::off;
    view.waves.model = waves::Model::jonswap;
    view.waves.wind_m_per_s = 5.0;
    view.waves.texels = 256;
    for (const double time : {3.0, 4.0}) { // the lens below a crest, and above a trough
        view.waves.time_s = time;
        const Image got = renderer.draw(view), expected = reference::trace(scene, view, {});
        double sum = 0.0;
        int blocks = 0;
        for (int y = 0; y < 48; y += 8)
            for (int x = 0; x < 48; x += 8) {
                double a = 0.0, b = 0.0;
                for (int k = 0; k < 64; ++k) {
                    const std::size_t i = std::size_t((y + k / 8) * 48 + x + k % 8);
                    a += got.radiance[i].g;
                    b += expected.radiance[i].g;
                }
                sum += std::abs(a - b) / b;
                if (std::abs(a - b) / b > 0.1)
                    std::printf("block %d %d: %.3f for %.3f\n", x, y, a / 64, b / 64);
                ++blocks;
            }
        std::printf("blocks differ by %.2f %%\n", 100.0 * sum / blocks);
        EXPECT_LT(sum / blocks, 0.02);
    }
}

// Farther from the surface than the dome is wide, it is not there: the very picture without.
TEST(Port, AwayFromTheSurfaceItIsNothing) {
    test_support::context();
    const scene::Scene scene = scene::bowl(129);
    render::Renderer renderer(scene);
    for (const double above : {0.5, -0.5}) {
        scene::View view = at_the_surface(above, -5.0);
        const Image with = renderer.draw(view);
        view.settings.port_m = 0.0;
        EXPECT_EQ(renderer.draw(view).radiance, with.radiance);
    }
}
