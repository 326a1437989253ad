#include "core/image.hpp"
#include "image/tone.hpp"
#include "reference/tone.hpp"
#include "support/gpu_function.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace tarn;

TEST(ToneGpu, CurveIsTheReferences) {
    const test_support::GpuFunction curve("lib/tone.glsl", "result.xyz = tone_curve(x.xyz, x.w);");
    std::mt19937 random(5);
    std::uniform_real_distribution<float> exponent(-7.0f, 4.0f);
    std::vector<glm::vec4> in;
    for (int i = 0; i < 5000; ++i)
        in.emplace_back(std::pow(10.0f, exponent(random)), std::pow(10.0f, exponent(random)), 0.0f,
                        std::pow(10.0f, 0.3f * exponent(random)));
    const auto out = curve(in);
    for (std::size_t i = 0; i < in.size(); ++i)
        for (int k = 0; k < 3; ++k) // a hundredth of an 8-bit step
            EXPECT_NEAR(out[i][k], reference::tone_curve(in[i][k], in[i].w), 4e-5) << in[i][k];
    EXPECT_NEAR(reference::tone_curve(0.18, 1.0), image::srgb_encode(0.18), 1e-12);
}

TEST(ToneGpu, ColoursComeIntoGamut) {
    const test_support::GpuFunction gamut("lib/tone.glsl", "result.xyz = into_gamut(x.xyz);");
    std::mt19937 random(6);
    std::uniform_real_distribution<float> channel(-0.5f, 1.0f);
    std::vector<glm::vec4> in;
    for (int i = 0; i < 5000; ++i)
        in.emplace_back(channel(random), channel(random), channel(random), 0.0f);
    const auto out = gamut(in);
    for (std::size_t i = 0; i < in.size(); ++i) {
        const glm::dvec3 expected = reference::into_gamut(glm::dvec3(in[i]));
        const glm::vec3 on_cpu = image::into_gamut(glm::vec3(in[i]));
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(out[i][k], expected[k], 2e-5);
            EXPECT_NEAR(on_cpu[k], expected[k], 2e-5);
            EXPECT_GE(out[i][k], 0.0f);
        }
    }
}
