// Far land by blocks: exact where cells are wider than a pixel, and beyond that off by less than a
// pixel.
#include "image/compare.hpp"
#include "render/renderer.hpp"
#include "scene/samples.hpp"
#include "support/gpu_function.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

using namespace tarn;

TEST(FarLand, IsExactNearAndAPixelOffFarAway) {
    test_support::context();
    const scene::Scene scene = scene::mountain_lake(1025); // cells of 15.6 m
    render::Renderer renderer(scene);
    scene::View view;
    view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(0.5, -0.4, 0.75)));
    view.settings = {.width_px = 240, .height_px = 160, .samples = 1};
    view.camera = scene::look({-7000, -7000, 2400}, 45, -8, 50); // two cells are a pixel at 5.4 km
    const double pixel_rad = 2.0 * std::tan(25.0 * M_PI / 180.0) / 160.0;
    const Image exact = renderer.draw(view);
    view.settings.coarse_far_land = true;
    const Image coarse = renderer.draw(view);
    std::size_t far = 0, far_off = 0, other = 0, near_off = 0;
    for (std::size_t i = 0; i < exact.distance_m.size(); ++i) {
        const double d = exact.distance_m[i], c = coarse.distance_m[i];
        const double pixel_m = pixel_rad * std::min(d, c);
        if (!(d < 1e8) && !(c < 1e8))
            continue;
        if (std::min(d, c) * pixel_rad < 2.0 * scene.ground.spacing_m) {
            near_off += d != c;
            continue;
        }
        ++far;
        // On slopes of up to 45 degrees seen at 8, a block of two cells is met within some cells'
        // length.
        other += d != c;
        far_off += std::abs(d - c) > 12.0 * pixel_m;
    }
    EXPECT_EQ(near_off, 0u);
    EXPECT_GT(far, 3000u);
    EXPECT_GT(other, far / 2);                      // or nothing is coarse
    EXPECT_LT(double(far_off), 0.05 * double(far)); // outlines
    const double error = image::compare(coarse, exact).mean_relative;
    std::printf("%zu far pixels, %.2f %% of them far off, mean error %.3f %%\n", far,
                100.0 * double(far_off) / double(far), 100.0 * error);
    EXPECT_LT(error, 0.03);
    EXPECT_GT(error, 1e-5);
}
