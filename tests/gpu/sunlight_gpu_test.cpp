#include "reference/sunlight.hpp"
#include "support/gpu_function.hpp"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

using namespace tarn;

TEST(SunlightGpu, DirectionAndShareBelowAgreeFromZenithToHorizon) {
    std::vector<glm::vec4> in;
    for (float elevation = -5.0f; elevation <= 90.0f; elevation += 0.25f)
        for (float azimuth = 0.0f; azimuth < 360.0f; azimuth += 45.0f) {
            const float e = elevation * float(M_PI) / 180, a = azimuth * float(M_PI) / 180;
            in.emplace_back(std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e),
                            1.333f);
        }
    const test_support::GpuFunction on_gpu(
        "lib/sunlight.glsl",
        "vec3 b = sun_below(x.xyz, x.w); result = vec4(b, sun_share_below(x.xyz, b, x.w, false));");
    const auto got = on_gpu(in);
    for (std::size_t i = 0; i < in.size(); ++i) {
        const glm::dvec3 sun(in[i]);
        const glm::dvec3 below = reference::sun_below(sun, 1.333);
        ASSERT_LT(glm::length(glm::dvec3(got[i]) - below), 1e-5) << in[i].z;
        ASSERT_NEAR(got[i].w, reference::sun_share_below(sun, below, 1.333, false), 1e-5);
        if (sun.z >
            0.0) // seen from below the sun never stands lower than the critical angle allows
            ASSERT_GE(below.z, std::cos(std::asin(1 / 1.333)) - 1e-9);
    }
}
