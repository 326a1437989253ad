#include "reference/markings.hpp"
#include "support/gpu_function.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace tarn;

TEST(MarkingsGpu, AreTheReferences) {
    const test_support::GpuFunction contour("lib/markings.glsl",
                                            "result.x = contour_cover(x.x, x.y, x.z, x.w);");
    const test_support::GpuFunction colour("lib/markings.glsl", "result.xyz = depth_colour(x.x);");
    const test_support::GpuFunction drape("lib/markings.glsl",
                                          "result.x = drape_cover(x.x, x.y, x.z, x.w);");
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::vector<glm::vec4> in, ramp, lines;
    for (int i = 0; i < 5000; ++i) {
        const float interval = 0.5f + 20.0f * unit(random);
        // Half of them near a line, where it counts.
        const float height = i % 2 ? 300.0f * (unit(random) - 0.5f)
                                   : interval * std::round(20.0f * unit(random)) +
                                         0.2f * interval * (unit(random) - 0.5f);
        in.emplace_back(height, interval, 0.5f * unit(random), 0.2f + 5.0f * unit(random));
        ramp.emplace_back(1.4f * unit(random) - 0.2f, 0, 0, 0);
        lines.emplace_back(unit(random), 30.0f * unit(random) + 1.0f, 1.0f + 2.0f * unit(random),
                           0.2f + 5.0f * unit(random));
    }
    const auto contours = contour(in), colours = colour(ramp), drapes = drape(lines);
    int covered = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
        const double expected = reference::contour_cover(in[i].x, in[i].y, in[i].z, in[i].w);
        // Heights of 300 m leave float32 some 2e-5 m, which is that over slope and pixel.
        EXPECT_NEAR(contours[i].x, expected, 2e-3 + 5e-5 / (std::max(in[i].z, 1e-5f) * in[i].w));
        covered += expected > 0.0;
        const glm::dvec3 c = reference::depth_colour(ramp[i].x);
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(colours[i][k], c[k], 1e-5);
        EXPECT_NEAR(drapes[i].x,
                    reference::drape_cover(lines[i].x, lines[i].y, lines[i].z, lines[i].w), 1e-3);
    }
    EXPECT_GT(covered, 500);
}

TEST(MarkingsGpu, ALineIsAsWideAsItSays) {
    // Over even ground the cover of all pixels across a line sums to its width.
    const test_support::GpuFunction contour("lib/markings.glsl",
                                            "result.x = contour_cover(x.x, x.y, x.z, x.w);");
    for (const double number : {1.0, 5.0}) {
        std::vector<glm::vec4> pixels;
        for (int i = -20; i <= 20; ++i) // 1 m a pixel, slope .1: .1 m of height a pixel
            pixels.emplace_back(float(number * 10.0 + 0.1 * (i + 0.3)), 10.0f, 0.1f, 1.0f);
        double sum = 0.0;
        for (const glm::vec4& p : contour(pixels))
            sum += p.x;
        EXPECT_NEAR(sum, number == 5.0 ? 2.2 : 1.2, 0.01);
    }
}
