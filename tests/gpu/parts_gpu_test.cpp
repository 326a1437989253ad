#include "reference/parts.hpp"
#include "support/gpu_function.hpp"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;

TEST(PartsGpu, TheSplitAgreesWithTheReference) {
    std::mt19937 random(15);
    std::normal_distribution<float> normal;
    std::vector<glm::vec4> in, kind;
    for (int i = 0; i < 20'000; ++i) {
        glm::vec3 d = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
        const bool below = i % 2 == 0, schlick = i % 4 < 2;
        d.z = (below ? 1.0f : -1.0f) * std::abs(d.z);
        // Slopes up to 1 in a quarter of the cases, else level water.
        const glm::vec2 slope =
            i % 3 == 0 ? 0.4f * glm::vec2(normal(random), normal(random)) : glm::vec2(0.0f);
        const double sine =
            1.333 * glm::length(glm::cross(glm::dvec3(d), glm::normalize(glm::dvec3(-slope, 1.0))));
        if (below && std::abs(sine - 1.0) < 2e-3) // at the critical angle the slope is infinite
            continue;
        in.emplace_back(d, 1.333f);
        kind.emplace_back(below, schlick, slope);
    }
    const test_support::GpuFunction directions(
        "lib/parts.glsl",
        "result.xyz = split_at_surface(x.xyz, normalize(vec3(-y.zw, 1.0)), x.w, y.x > 0.5, "
        "y.y > 0.5).refracted;");
    const test_support::GpuFunction weights(
        "lib/parts.glsl",
        "Split s = split_at_surface(x.xyz, normalize(vec3(-y.zw, 1.0)), x.w, y.x > 0.5, y.y > "
        "0.5); result = vec4(s.mirror, s.through, s.reflected.z, 0);");
    const auto d = directions(in, kind), w = weights(in, kind);
    for (std::size_t i = 0; i < in.size(); ++i) {
        const auto s = reference::split_at_surface(
            glm::dvec3(in[i]), glm::normalize(glm::dvec3(-kind[i].z, -kind[i].w, 1.0)), in[i].w,
            kind[i].x > 0.5f, kind[i].y > 0.5f);
        ASSERT_NEAR(w[i].x, s.mirror, 1e-4);
        ASSERT_NEAR(w[i].y, s.through, 2e-4);
        ASSERT_NEAR(w[i].z, s.reflected.z, 1e-5);
        if (s.mirror < 0.999) // else rounding decides whether there is such a ray
            ASSERT_LT(glm::length(glm::dvec3(d[i]) - s.refracted), 1e-3);
    }
}

TEST(PartsGpu, EndsSurviveTheirPacking) {
    std::mt19937 random(16);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::vector<glm::vec4> in, inside;
    for (int i = 0; i < 10'000; ++i) {
        in.emplace_back(std::pow(10.0f, 9 * unit(random)), int(16383 * unit(random)),
                        int(16383 * unit(random)), i % 16);
        inside.emplace_back(i % 10 ? unit(random) : float(i % 20 != 0), unit(random), 0, 0);
    }
    const test_support::GpuFunction numbers(
        "lib/parts.glsl", "End e = unpack_end(pack_end(End(x.x, ivec2(x.yz), y.xy, uint(x.w)))); "
                          "result = vec4(e.t, vec2(e.cell), e.flags);");
    const test_support::GpuFunction places("lib/parts.glsl",
                                           "End e = unpack_end(pack_end(End(x.x, ivec2(x.yz), "
                                           "y.xy, uint(x.w)))); result.xy = e.inside;");
    const auto a = numbers(in, inside), b = places(in, inside);
    for (std::size_t i = 0; i < in.size(); ++i) {
        ASSERT_EQ(a[i], in[i]);
        ASSERT_NEAR(b[i].x, inside[i].x, 0.51 / 65535);
        ASSERT_NEAR(b[i].y, inside[i].y, 0.51 / 65535);
    }
}
