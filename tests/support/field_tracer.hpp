#pragma once
/// @file field_tracer.hpp  Sends any rays through a scene with shaders/lib/heightfield.glsl.
#include "render/renderer.hpp"
#include "support/gpu_function.hpp"

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace tarn::test_support {

struct TestRay {
    glm::dvec3 origin;    ///< scene metres
    glm::dvec3 direction; ///< unit, scene axes
};

struct TestHit {
    bool hit = false, water = false;
    double t = 0.0;
    double col = 0.0, row = 0.0;
};

/// What float32 makes of the rays on their way to the GPU is put back into `rays`, so that both
/// tracers are asked the same question.
inline std::vector<TestHit> trace_on_gpu(const scene::Scene& scene, std::vector<TestRay>& rays,
                                         bool with_water,
                                         scene::Walk walk = scene::Walk::cone_map) {
    context();
    render::Renderer renderer(scene);
    std::string file = scene::walk_method(walk).name;
    std::replace(file.begin(), file.end(), '-', '_');
    const GpuFunction trace(
        "lib/walks/" + file + ".glsl",
        text("Hit hit; vec2 whole = floor(x.xy); Ray ray = ray_from(field_of(view), whole, "
             "vec3(x.xy - whole, x.z), y.xyz); bool found = "
             "trace_field(heights, "
             "bounds, field_of(view), ray, 1e9, ",
             with_water ? "true" : "false",
             ", hit);\n    if (found) result = vec4(hit.t, hit.water ? 2.0 : 1.0, "
             "float(hit.cell.x) + hit.inside.x, float(hit.cell.y) + hit.inside.y);"),
        "layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;\n"
        "layout(binding = TARN_TEXTURE_BOUNDS) uniform sampler2D bounds;\n"
        "layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };\n");
    renderer.bind_field(walk, with_water);
    const Heightfield& g = scene.ground;
    std::vector<glm::vec4> origins, directions;
    for (TestRay& ray : rays) {
        const glm::vec3 grid(float(g.col(ray.origin.x)), float(g.row(ray.origin.y)),
                             float(ray.origin.z - g.offset_m));
        const glm::vec3 direction(ray.direction);
        origins.emplace_back(grid, 0.0f);
        directions.emplace_back(direction, 0.0f);
        ray.origin = {g.x_m(grid.x), g.y_m(grid.y), g.offset_m + double(grid.z)};
        ray.direction = glm::dvec3(direction);
    }
    std::vector<TestHit> out;
    for (const glm::vec4& r : trace(origins, directions))
        out.push_back({r.y > 0.5f, r.y > 1.5f, r.x, r.z, r.w});
    return out;
}

} // namespace tarn::test_support
