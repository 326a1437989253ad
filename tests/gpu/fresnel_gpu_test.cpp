// shaders/lib/fresnel.glsl on the GPU against src/reference/fresnel.hpp, over the whole domain.
#include "reference/fresnel.hpp"
#include "support/gpu_function.hpp"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;
using test_support::GpuFunction;

namespace {

/// Property: the GPU answer is the exact answer for SOME index within four float32 roundings of the
/// given one, give or take 1e-6. Such a tolerance is wide only where the physics is steep (at the
/// critical angle the slope is infinite) and tight everywhere else.
template <class Exact>
void expect_within_rounding(const std::string& name, Exact exact) {
    std::mt19937 random(20240501); // ONE generator for all draws
    std::uniform_real_distribution<float> cosine(0.0f, 1.0f), index(0.5f, 2.0f);
    std::vector<glm::vec4> inputs = {
        {0, .75f, 0, 0}, {0, 1, 0, 0}, {1, 1, 0, 0}, {1e-6f, 1.333f, 0, 0}, {1, 1.333f, 0, 0}};
    for (int i = 0; i < 100'000; ++i)
        inputs.emplace_back(cosine(random), index(random), 0, 0);
    const GpuFunction on_gpu("lib/fresnel.glsl", "result.x = " + name + "(x.x, x.y);");
    const auto got = on_gpu(inputs);
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        const double c = inputs[i].x, eta = inputs[i].y, rounding = 4.0 * 0x1p-24;
        const double value = exact(c, eta);
        const double allowed = 1e-6 + std::max(std::abs(exact(c, eta * (1.0 - rounding)) - value),
                                               std::abs(exact(c, eta * (1.0 + rounding)) - value));
        ASSERT_NEAR(got[i].x, value, allowed)
            << name << " cos_i " << c << ", eta " << eta; // fails on NaN too
    }
}

} // namespace

TEST(FresnelGpu, DielectricAgreesWithTheReference) {
    expect_within_rounding("fresnel_dielectric", reference::fresnel_dielectric);
}

TEST(FresnelGpu, SchlickAgreesWithTheReference) {
    expect_within_rounding("fresnel_schlick", reference::fresnel_schlick);
}

TEST(FresnelGpu, RefractedDirectionsAgree) {
    std::mt19937 random(5);
    std::normal_distribution<float> normal;
    std::vector<glm::vec4> in, facing;
    for (int i = 0; i < 20'000; ++i) {
        const glm::vec3 d =
            glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
        glm::vec3 n = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
        n = glm::dot(n, d) > 0.0f ? -n : n;
        const float eta = i % 2 ? 0.75f : 1.333f;
        if (eta * glm::length(glm::cross(n, d)) > 0.999f)
            continue;
        in.emplace_back(d, eta);
        facing.emplace_back(n, 0.0f);
    }
    const GpuFunction on_gpu("lib/fresnel.glsl", "result.xyz = refracted(x.xyz, y.xyz, x.w);");
    const auto got = on_gpu(in, facing);
    for (std::size_t i = 0; i < in.size(); ++i) {
        const glm::dvec3 expected =
            reference::refracted(glm::dvec3(in[i]), glm::dvec3(facing[i]), in[i].w);
        ASSERT_LT(glm::length(glm::dvec3(got[i]) - expected), 1e-5);
    }
}
