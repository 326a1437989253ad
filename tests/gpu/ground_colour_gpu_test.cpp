#include "reference/ground_colour.hpp"
#include "support/gpu_function.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace tarn;

TEST(GroundColourGpu, AgreesWithTheReferenceAndIsAnAlbedo) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::vector<glm::vec4> x, y;
    for (int i = 0; i < 20'000; ++i) {
        x.emplace_back(2000 * unit(random), 2000 * unit(random),
                       i % 2 ? 1800 * unit(random) : 6 * unit(random) - 1, 1.6f * unit(random));
        y.emplace_back(i % 4 == 0 ? 1.0f : 0.0f, unit(random), 8 * unit(random), 0);
        if (i % 4 == 0)
            x.back().z = -30 * unit(random);
    }
    const auto got = test_support::GpuFunction(
        "lib/ground_colour.glsl",
        "result.rgb = ground_albedo(x.xy, x.z, y.x > 0.5, y.y, 700.0, 1200.0, x.w, y.z);")(x, y);
    double sum = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const glm::dvec3 expected = reference::ground_albedo(glm::dvec2(x[i]), x[i].z, y[i].x > 0.5,
                                                             y[i].y, 700, 1200, x[i].w, y[i].z);
        for (int k = 0; k < 3; ++k) {
            ASSERT_NEAR(got[i][k], expected[k], 2e-3);
            ASSERT_GE(got[i][k], 0.0f);
            ASSERT_LE(got[i][k], 1.0f);
            sum += std::abs(got[i][k] - expected[k]);
        }
    }
    EXPECT_LT(sum / double(3 * x.size()), 2e-5);
}
