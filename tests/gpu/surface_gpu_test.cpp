#include "reference/surface.hpp"
#include "render/renderer.hpp"
#include "scene/samples.hpp"
#include "support/gpu_function.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace tarn;

TEST(SurfaceGpu, GradientsAndNormalsAgreeEverywhereIncludingTheEdges) {
    const scene::Scene scene = scene::mountain_lake(67);
    test_support::context();
    render::Renderer renderer(scene);
    std::mt19937 random(8);
    std::uniform_int_distribution<int> cell(0, 65);
    std::uniform_real_distribution<float> inside(0.0f, 1.0f);
    std::vector<glm::vec4> in;
    for (int i = 0; i < 20'000; ++i)
        in.emplace_back(i % 7 == 0 ? 65 * (i % 2) : cell(random),
                        i % 5 == 0 ? 65 * (i % 2) : cell(random), inside(random), inside(random));
    const test_support::GpuFunction on_gpu(
        "lib/surface.glsl",
        text("vec2 g = ground_gradient(heights, vec2(67.0), ivec2(x.xy), x.zw, ",
             scene.ground.scale_m * 65535.0, "); result = vec4(normal_of(g, ",
             scene.ground.spacing_m, "), length(g));"),
        "layout(binding = 0) uniform sampler2D heights;\n");
    renderer.bind_field(scene::Walk::cone_map, false);
    const auto got = on_gpu(in);
    for (std::size_t i = 0; i < in.size(); ++i) {
        const glm::dvec2 g =
            reference::ground_gradient(scene.ground, in[i].x + in[i].z, in[i].y + in[i].w);
        ASSERT_NEAR(got[i].w, glm::length(g), 1e-3 + 1e-5 * glm::length(g))
            << in[i].x << "," << in[i].y;
        ASSERT_LT(glm::length(glm::dvec3(got[i]) - reference::normal_of(g, scene.ground.spacing_m)),
                  1e-4);
    }
}

TEST(SurfaceGpu, WaterShareIsOneInTheLakeAndZeroAway) {
    const scene::Scene scene = scene::bowl(65);
    test_support::context();
    render::Renderer renderer(scene);
    std::vector<glm::vec4> in = {{32, 32, 0.5f, 0.5f}, {2, 2, 0.5f, 0.5f}};
    for (int col = 0; col < 64; ++col)
        in.emplace_back(col, 32, 0.25f, 0.75f);
    const test_support::GpuFunction on_gpu(
        "lib/surface.glsl", "result.x = water_share(heights, vec2(65.0), ivec2(x.xy), x.zw);",
        "layout(binding = 0) uniform sampler2D heights;\n");
    renderer.bind_field(scene::Walk::cone_map, false);
    const auto got = on_gpu(in);
    EXPECT_EQ(got[0].x, 1.0f);
    EXPECT_EQ(got[1].x, 0.0f);
    for (std::size_t i = 2; i < in.size(); ++i) {
        double expected = 0.0;
        for (int k = 0; k < 4; ++k)
            if (scene.water.codes[{int(in[i].x) + k % 2, 32 + k / 2}] != no_water_code)
                expected += (k % 2 ? 0.25 : 0.75) * (k / 2 ? 0.75 : 0.25);
        ASSERT_NEAR(got[i].x, expected, 1e-6);
    }
}
