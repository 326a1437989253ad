#include "reference/medium.hpp"
#include "support/gpu_function.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace tarn;

TEST(MediumGpu, TransmittanceAgrees) {
    std::vector<glm::vec4> in;
    for (float d = 0; d < 60; d += 0.37f)
        in.emplace_back(0.02f, 0.3f, 1.1f, d);
    const auto got =
        test_support::GpuFunction("lib/medium.glsl", "result.rgb = transmittance(x.xyz, x.w);")(in);
    for (std::size_t i = 0; i < in.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const double expected = reference::transmittance(glm::dvec3(in[i]), in[i].w)[k];
            ASSERT_NEAR(got[i][k], expected, 1e-5 * expected + 1e-30);
        }
}

// Closed form in float32 against quadrature in double: up, level and down, thin and thick, where
// the exponent nearly cancels (sink = -1 / slant) and where it would overflow if written
// carelessly.
TEST(MediumGpu, PathRadianceAgreesWithTheQuadrature) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::vector<glm::vec4> x, y;
    for (int i = 0; i < 4000; ++i) {
        const float c = std::pow(10.0f, -3.0f + 5.0f * unit(random)); // .001 to 100 per metre
        const float slant = 1.0f + 0.5f * unit(random);
        float sink = i % 5 == 0 ? -1.0f / slant : i % 5 == 1 ? -1.0f : 2.0f * unit(random) - 1.0f;
        const float depth = 40.0f * unit(random);
        float distance = std::pow(10.0f, -2.0f + 4.0f * unit(random));
        if (sink < 0.0f)
            distance = std::min(distance, depth / -sink); // the path ends at the surface
        x.emplace_back(c, slant, depth, sink);
        y.emplace_back(distance, 0, 0, 0);
    }
    const auto got = test_support::GpuFunction(
        "lib/medium.glsl",
        "result.rgb = path_radiance(vec3(0.01), vec3(x.x), vec3(2.0), x.y, x.z, x.w, y.x);")(x, y);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double expected =
            reference::path_radiance(glm::dvec3(0.01), glm::dvec3(x[i].x), glm::dvec3(2.0), x[i].y,
                                     x[i].z, x[i].w, y[i].x)
                .x;
        // float32 exponents of up to c * depth carry their own rounding: 6e-8 of each.
        const double exponent = x[i].x * (x[i].y * x[i].z + 2.5 * y[i].x);
        ASSERT_NEAR(got[i].x, expected, expected * (2e-5 + 3e-7 * exponent) + 1e-12)
            << "c " << x[i].x << " slant " << x[i].y << " depth " << x[i].z << " sink " << x[i].w
            << " d " << y[i].x;
    }
}
