#include "reference/noise.hpp"
#include "support/gpu_function.hpp"

#include <cstring>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;

TEST(NoiseGpu, TheHashIsEqualBitForBit) {
    std::mt19937 random(9);
    std::vector<glm::vec4> in;
    for (int i = 0; i < 50'000; ++i) {
        const std::int32_t words[3] = {std::int32_t(random()), std::int32_t(random()),
                                       std::int32_t(random() % 64)};
        glm::vec4 v(0);
        // Below 2^24 the numbers travel exactly as floats; the sign is kept.
        v.x = float(words[0] % 16'000'000);
        v.y = float(words[1] % 16'000'000);
        v.z = float(words[2]);
        in.push_back(v);
    }
    const auto got = test_support::GpuFunction(
        "lib/noise.glsl",
        "uint h = lattice_hash(ivec2(x.xy), uint(x.z)); result.xy = vec2(h >> 16, h & 0xffffu);")(
        in);
    for (std::size_t i = 0; i < in.size(); ++i) {
        const std::uint32_t h = reference::lattice_hash(
            std::int32_t(in[i].x), std::int32_t(in[i].y), std::uint32_t(in[i].z));
        ASSERT_EQ(std::uint32_t(got[i].x), h >> 16);
        ASSERT_EQ(std::uint32_t(got[i].y), h & 0xffffu);
    }
}

TEST(NoiseGpu, FadedNoiseAgreesAndStaysInRange) {
    std::mt19937 random(10);
    std::uniform_real_distribution<float> place(0.0f, 60'000.0f), footprint(0.0f, 60.0f);
    std::vector<glm::vec4> in;
    for (int i = 0; i < 20'000; ++i)
        in.emplace_back(place(random), place(random), i % 3 ? footprint(random) : 0.0f,
                        i % 2 ? 90.0f : 5.0f);
    const auto got = test_support::GpuFunction("lib/noise.glsl",
                                               "result.x = faded_noise(x.xy, x.w, x.z, 11u);")(in);
    for (std::size_t i = 0; i < in.size(); ++i) {
        const double expected = reference::faded_noise(glm::dvec2(in[i]), in[i].w, in[i].z, 11);
        // 60 km in float32 are known to 4 mm: of the finest lattice, .8 m, half a percent.
        ASSERT_NEAR(got[i].x, expected, 0.02) << in[i].x << "," << in[i].y;
        ASSERT_GE(got[i].x, 0.0f);
        ASSERT_LE(got[i].x, 1.0f);
        if (in[i].z > in[i].w)
            ASSERT_EQ(got[i].x, 0.5f); // faded to its mean
    }
}
