#include "reference/space_lines.hpp"
#include "support/gpu_function.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace tarn;

TEST(SpaceLinesGpu, NearestPlacesAreTheReferences) {
    const test_support::GpuFunction nearest(
        "lib/space_lines.glsl",
        "StrokeSeen seen = near_stroke(vec3(0.0, 0.0, 1.0), x.xyz, y.xyz);"
        "result = vec4(seen.apart_rad, seen.t, stroke_cover(x.w, y.w), 0.0);");
    std::mt19937 random(11);
    std::uniform_real_distribution<float> even(-1.0f, 1.0f);
    std::vector<glm::vec4> from, to;
    for (int i = 0; i < 20000; ++i) {
        const float far = std::exp(4.0f * even(random)); // from centimetres to 50 m
        const glm::vec3 a(even(random), even(random), even(random) + 0.3f);
        glm::vec3 b(even(random), even(random), even(random) + 0.3f);
        if (i % 4 == 0)
            b = a; // a point
        else if (i % 4 == 1)
            b = a + 0.01f * b; // short
        from.emplace_back(far * a, 4.0f * std::abs(even(random)));
        to.emplace_back(far * b, 1.0f + 3.0f * std::abs(even(random)));
    }
    const auto out = nearest(from, to);
    int before = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const reference::StrokeSeen seen =
            reference::near_stroke({0, 0, 1}, glm::vec3(from[i]), glm::vec3(to[i]));
        EXPECT_NEAR(out[i].z, reference::stroke_cover(from[i].w, to[i].w), 1e-6);
        if (seen.t <= 0.0 || seen.apart_rad > 0.3)
            continue; // behind, or wide of it: no pixel asks
        ++before;
        EXPECT_NEAR(out[i].x, seen.apart_rad, 2e-5) << i;
        // Where a stroke runs at the eye, its nearest place is not one but many.
        const double reach = glm::length(glm::vec3(to[i] - from[i])) + 1e-6;
        EXPECT_NEAR(out[i].y, seen.t, 2e-3 * (seen.t + reach)) << i;
    }
    EXPECT_GT(before, 500);
}
