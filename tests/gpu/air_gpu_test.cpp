#include "reference/air.hpp"
#include "support/gpu_function.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace tarn;

// Up, level and down, from beside the water to above all haze, metres to a hundred kilometres.
TEST(AirGpu, TransmittanceAgreesWithTheSumOfDensities) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::vector<glm::vec4> x, y;
    for (int i = 0; i < 4000; ++i) {
        x.emplace_back(
            std::pow(10.0f, -5.5f + 2.5f * unit(random)), -4000.0f + 9000.0f * unit(random),
            i % 7 == 0 ? 0.0f : 2.0f * unit(random) - 1.0f, std::pow(10.0f, 5.0f * unit(random)));
        y.emplace_back(1.0f / (500.0f + 3000.0f * unit(random)), 0, 0, 0);
    }
    const auto got = test_support::GpuFunction(
        "lib/air.glsl",
        "result.rgb = air_transmittance(vec3(x.x, 2.0 * x.x, 0.0), y.x, x.y, x.z, x.w);")(x, y);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const glm::dvec3 expected = reference::air_transmittance({x[i].x, 2.0 * x[i].x, 0.0},
                                                                 y[i].x, x[i].y, x[i].z, x[i].w);
        for (int k = 0; k < 3; ++k)
            ASSERT_NEAR(got[i][k], expected[k], 2e-4)
                << "sigma " << x[i].x << " z " << x[i].y << " rise " << x[i].z << " d " << x[i].w;
    }
    EXPECT_EQ(got[0].z, 1.0f); // no haze, no loss
}

TEST(AirGpu, TheHorizonIsJustAboveAndInTheSameDirection) {
    const std::vector<glm::vec4> x = {{1, 0, 0, 0}, {0.3f, -0.4f, -0.8f, 0}, {0, 0, -1, 0}};
    const auto got =
        test_support::GpuFunction("lib/air.glsl", "result.rgb = horizon_of(x.xyz);")(x);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const glm::dvec3 expected = reference::horizon_of(glm::dvec3(x[i]));
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(got[i][k], expected[k], 1e-6);
    }
}
