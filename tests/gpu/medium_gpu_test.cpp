#include "reference/medium.hpp"
#include "scene/water_colour.hpp"
#include "scene/water_types.hpp"
#include "support/gpu_function.hpp"

#include <glm/common.hpp>
#include <gtest/gtest.h>
#include <optional>
#include <random>

using namespace tarn;

namespace {

/// One function of lib/medium.glsl with the table of a water.
class MediumFunction {
public:
    MediumFunction(const scene::WaterOptics& optics, const std::string& body) {
        test_support::context();
        const scene::WaterTable table = scene::make_water_table(optics, true);
        const glm::vec4 scale = table.scale();
        texture_ = gpu::Texture2D(GL_RGBA32F, table.texels, int(table.rows.size()), 1,
                                  gpu::Filter::nearest, "water");
        texture_.upload(GL_RGBA, GL_FLOAT, table.packed().data());
        function_.emplace(
            "lib/medium.glsl", body,
            text("layout(binding = 0) uniform sampler2D water;\nconst vec4 scale = vec4(", scale.x,
                 ", ", scale.y, ", ", scale.z, ", ", scale.w, ");\n"));
    }
    std::vector<glm::vec4> operator()(const std::vector<glm::vec4>& x,
                                      const std::vector<glm::vec4>& y = {}) const {
        texture_.bind(0);
        return (*function_)(x, y);
    }

private:
    gpu::Texture2D texture_;
    std::optional<test_support::GpuFunction> function_;
};

/// From crystal to mud, with bands and without.
std::vector<scene::WaterOptics> waters() {
    std::vector<scene::WaterOptics> out = {
        scene::water_type("pure"),       scene::water_type("clear lake"),
        scene::water_type("humic lake"), scene::water_type("glacial lake"),
        scene::water_type("jerlov 9C"),  scene::water_by_secchi(0.2)};
    out.push_back({.name = "lab",
                   .absorption_per_m = {0.0, 0.02, 20.0},
                   .backscattering_per_m = {0.0, 0.01, 1.0}});
    return out;
}

} // namespace

TEST(MediumGpu, TransmittanceAndWhatIsThrownBackAgree) {
    for (const scene::WaterOptics& optics : waters()) {
        const reference::Medium medium(optics, true);
        std::vector<glm::vec4> x;
        for (double d = 0.0; d < 600.0; d = d * 1.1 + 0.003)
            x.emplace_back(d, 0, 0, 0);
        const auto passed =
            MediumFunction(optics, "result.rgb = transmittance(water, scale, x.x);")(x);
        const auto thrown =
            MediumFunction(optics, "result.rgb = thrown_back(water, scale, x.x);")(x);
        const auto drawn =
            MediumFunction(optics, "result.rgb = image_transmittance(water, scale, x.x);")(x);
        const auto pattern =
            MediumFunction(optics, "result.rgb = pattern_transmittance(water, scale, x.x);")(x);
        for (std::size_t i = 0; i < x.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                ASSERT_NEAR(pattern[i][k], medium.pattern_transmittance(x[i].x)[k], 3e-4)
                    << optics.name << " " << x[i].x << " m, channel " << k;
                ASSERT_NEAR(drawn[i][k], medium.image_transmittance(x[i].x)[k], 3e-4)
                    << optics.name << " " << x[i].x << " m, channel " << k;
                // Of what falls in, white is 1; the oracle sums in other steps (2.5 nm).
                ASSERT_NEAR(passed[i][k], medium.transmittance(x[i].x)[k], 1e-4)
                    << optics.name << " " << x[i].x << " m, channel " << k;
                ASSERT_NEAR(thrown[i][k], medium.thrown_back(x[i].x)[k], 2e-3)
                    << optics.name << " " << x[i].x << " m, channel " << k;
            }
    }
}

// Up, level and down, thin and thick, where the gain of path nearly cancels (sink = -1 / slant).
TEST(MediumGpu, PathRadianceAgrees) {
    for (const scene::WaterOptics& optics : waters()) {
        const reference::Medium medium(optics, true);
        std::mt19937 random(3);
        std::uniform_real_distribution<float> unit(0.0f, 1.0f);
        std::vector<glm::vec4> x, y;
        for (int i = 0; i < 4000; ++i) {
            const float slant = 1.0f + 0.5f * unit(random), depth = 40.0f * unit(random);
            const float sink = i % 5 == 0   ? -1.0f / slant
                               : i % 5 == 1 ? -1.0f
                                            : 2.0f * unit(random) - 1.0f;
            float distance = std::pow(10.0f, -2.0f + 4.0f * unit(random));
            if (sink < 0.0f)
                distance = std::min(distance, depth / -sink); // the path ends at the surface
            x.emplace_back(slant, depth, sink, i % 3 == 0 ? 5.0f * unit(random) : 0.0f);
            y.emplace_back(distance, 0, 0, 0);
        }
        const auto got = MediumFunction(
            optics, "result.rgb = path_radiance(water, scale, x.x, x.y, x.z, x.w, y.x);")(x, y);
        // A channel beside the brightest one may cancel to nothing: what counts is white's error.
        const auto greatest = [](glm::dvec3 v) {
            return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        };
        const double bright = greatest(medium.path_radiance(1.0, 0.0, 1.0, 0.0, 1e4));
        double worst = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const glm::dvec3 expected =
                medium.path_radiance(x[i].x, x[i].y, x[i].z, x[i].w, y[i].x);
            const double error = greatest(glm::dvec3(got[i]) - expected);
            const double limit = 1e-3 * greatest(expected) + 1e-4 * bright;
            ASSERT_LE(error, limit) << optics.name << ", slant " << x[i].x << " depth " << x[i].y
                                    << " sink " << x[i].z << " d " << y[i].x;
            worst = std::max(worst, error / limit);
        }
        std::printf("%-24s worst %.2f of the limit\n", optics.name.c_str(), worst);
    }
}
