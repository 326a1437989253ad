#include "reference/sky.hpp"
#include "scene/environment.hpp"
#include "support/gpu_function.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace tarn;

namespace {
std::vector<glm::vec4> directions(int count) {
    std::mt19937 random(6);
    std::normal_distribution<float> normal;
    std::vector<glm::vec4> out = {{0, 0, 1, 0}, {0, 0, -1, 0}, {1, 0, 0, 0}};
    for (int i = 0; i < count; ++i)
        out.emplace_back(
            glm::normalize(glm::vec3(normal(random), normal(random), 0.6f * normal(random))), 0);
    return out;
}
} // namespace

TEST(SkyGpu, TableRadianceAgrees) {
    const glm::dvec3 sun = glm::normalize(glm::dvec3(0.6, -0.5, 0.7));
    const scene::Lighting light = scene::clear_sky(sun);
    test_support::context();
    gpu::Texture2D table(GL_RGB32F, light.sky.azimuths, light.sky.elevations, 1,
                         gpu::Filter::linear, "sky");
    table.upload(GL_RGB, GL_FLOAT, light.sky.radiance.data());
    const auto in = directions(20'000);
    const test_support::GpuFunction on_gpu("lib/sky.glsl",
                                           text("result.rgb = sky_radiance(table, x.xyz, vec3(",
                                                sun.x, ", ", sun.y, ", ", sun.z, "));"),
                                           "layout(binding = 2) uniform sampler2D table;\n");
    table.bind(2);
    const auto got = on_gpu(in);
    double worst = 0.0;
    for (std::size_t i = 3; i < in.size(); ++i) {
        const glm::dvec3 expected = reference::sky_radiance(light.sky, glm::dvec3(in[i]), sun);
        for (int k = 0; k < 3; ++k)
            worst = std::max(worst, std::abs(got[i][k] / expected[k] - 1.0));
    }
    // Hardware filters with weights of 8 bits: 1/512 of the step between neighbours, here < 20 %.
    EXPECT_LT(worst, 2e-3);
    for (int k = 0; k < 3; ++k)
        EXPECT_TRUE(std::isfinite(got[std::size_t(k)].x));
}

// A map of the whole turn: bright in the north-east, looked up by both; also where its first and
// last column meet.
TEST(SkyGpu, AnEnvironmentMapIsLookedUpAlike) {
    Image map{.width_px = 256, .height_px = 128, .radiance = {}, .distance_m = {}};
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 256; ++x) {
            const double azimuth = ((x + 0.5) / 256 - 0.5) * 2 * M_PI,
                         elevation = (0.5 - (y + 0.5) / 128) * M_PI;
            map.radiance.emplace_back(1.5 + std::cos(azimuth - 0.8), 1.2 + std::sin(azimuth),
                                      1.5 + std::cos(elevation));
        }
    const scene::Lighting light = scene::environment(map);
    EXPECT_EQ(light.sun_irradiance.g, 0.0);
    test_support::context();
    gpu::Texture2D table(GL_RGB32F, light.sky.azimuths, light.sky.elevations, 1,
                         gpu::Filter::linear, "sky");
    table.upload(GL_RGB, GL_FLOAT, light.sky.radiance.data());
    auto in = directions(20'000);
    in.emplace_back(1e-7f, 1.0f, 0.0f, 0.0f);
    in.emplace_back(-1e-7f, 1.0f, 0.0f, 0.0f);
    const test_support::GpuFunction on_gpu(
        "lib/sky.glsl", "result.rgb = sky_radiance(table, x.xyz, vec3(0.0, 0.0, 1.0));",
        "layout(binding = 2) uniform sampler2D table;\n", "#define TARN_WHOLE_SKY 1\n");
    table.bind(2);
    const auto got = on_gpu(in);
    for (std::size_t i = 3; i < in.size(); ++i) {
        const glm::dvec3 d = glm::normalize(glm::dvec3(in[i]));
        const glm::dvec3 looked = reference::sky_radiance(light.sky, d, {0, 0, 1});
        const double azimuth = std::atan2(d.x, d.y), elevation = std::max(std::asin(d.z), 0.0);
        const glm::dvec3 exact(1.5 + std::cos(azimuth - 0.8), 1.2 + std::sin(azimuth),
                               1.5 + std::cos(elevation));
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(got[i][k] / looked[k], 1.0, 2e-3) << i;
            EXPECT_NEAR(got[i][k], exact[k], 0.01) << i << " " << k;
        }
    }
}

TEST(SkyGpu, TheDiscHasItsSizeAndASoftEdge) {
    std::vector<glm::vec4> in;
    for (int i = 0; i <= 1000; ++i) {
        const double angle = 0.01 * i / 1000;
        in.emplace_back(float(std::sin(angle)), 0.0f, float(std::cos(angle)), 0.0f);
    }
    const auto got = test_support::GpuFunction(
        "lib/sky.glsl", "result.x = disc_share(x.xyz, vec3(0.0, 0.0, 1.0), 0.004654, 0.0005);")(in);
    for (std::size_t i = 0; i < in.size(); ++i)
        ASSERT_NEAR(
            got[i].x,
            reference::disc_share(glm::normalize(glm::dvec3(in[i])), {0, 0, 1}, 0.004654, 0.0005),
            2e-3);
    EXPECT_EQ(got[0].x, 1.0f);
    EXPECT_EQ(got[1000].x, 0.0f);
}
