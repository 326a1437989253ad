#include "reference/camera.hpp"
#include "scene/camera.hpp"
#include "support/gpu_function.hpp"

#include <gtest/gtest.h>

using namespace tarn;

TEST(CameraGpu, PixelDirectionsAgreeWithTheReferenceAndTheScene) {
    const scene::Camera camera = scene::look({0, 0, 0}, 37.0, -21.0, 65.0);
    const glm::dvec2 half(std::tan(65.0 / 2 * M_PI / 180) * 1.5, std::tan(65.0 / 2 * M_PI / 180));
    std::vector<glm::vec4> places;
    for (int y = 0; y <= 20; ++y)
        for (int x = 0; x <= 30; ++x)
            places.emplace_back(x / 30.0f, y / 20.0f, 0, 0);
    const auto vec = [](const glm::dvec3& v) {
        return text("vec3(", v.x, ", ", v.y, ", ", v.z, ")");
    };
    const test_support::GpuFunction on_gpu(
        "lib/camera.glsl",
        text("result.xyz = pixel_direction(", vec(camera.forward), ", ", vec(camera.right), ", ",
             vec(camera.up), ", vec2(", half.x, ", ", half.y, "), x.xy);"));
    const auto got = on_gpu(places);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const glm::dvec3 twin = reference::pixel_direction(camera.forward, camera.right, camera.up,
                                                           half, glm::dvec2(places[i]));
        const glm::dvec3 plain = glm::normalize(
            scene::pixel_direction(camera, 300.0 * places[i].x, 200.0 * places[i].y, 300, 200));
        ASSERT_LT(glm::length(twin - plain), 1e-7);
        ASSERT_LT(glm::length(glm::dvec3(got[i]) - twin), 1e-6);
    }
}
