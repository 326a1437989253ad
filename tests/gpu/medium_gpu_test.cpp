#include "reference/medium.hpp"
#include "scene/water_colour.hpp"
#include "scene/water_types.hpp"
#include "support/gpu_function.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <optional>
#include <random>

using namespace tarn;

namespace {

/// One function of lib/medium.glsl with the table of a water.
class MediumFunction {
public:
    /// @param glow  whose light glows
    MediumFunction(const scene::WaterOptics& optics, const std::string& body,
                   const scene::GlowTable& glow = scene::glow_table()) {
        test_support::context();
        const scene::WaterTable table = scene::make_water_table(optics, true);
        const glm::vec4 scale = table.scale();
        texture_ = gpu::Texture2D(GL_RGBA32F, table.texels, int(table.rows.size()), 1,
                                  gpu::Filter::nearest, "water");
        texture_.upload(GL_RGBA, GL_FLOAT, table.packed().data());
        if (!optics.bands.empty()) {
            const scene::GlowColours colours =
                scene::make_glow_colours(optics, glow, table.longest_m);
            glow_ = gpu::Texture2D(GL_RGBA32F, colours.angles, colours.paths, 1,
                                   gpu::Filter::linear, "glow");
            glow_.upload(GL_RGBA, GL_FLOAT, colours.rgb.data());
        }
        function_.emplace(
            "lib/medium.glsl", body,
            text("layout(binding = 0) uniform sampler2D water;\n"
                 "layout(binding = 1) uniform sampler2D glow;\nconst vec4 scale = vec4(",
                 scale.x, ", ", scale.y, ", ", scale.z, ", ", scale.w, ");\n"));
    }
    std::vector<glm::vec4> operator()(const std::vector<glm::vec4>& x,
                                      const std::vector<glm::vec4>& y = {}) const {
        texture_.bind(0);
        if (glow_.id() != 0)
            glow_.bind(1);
        return (*function_)(x, y);
    }

private:
    gpu::Texture2D texture_, glow_;
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

// The oracle sums over wavelengths, each with its own mean path. A camera up to four optical depths
// down looks up, level and down; the sun stands in the zenith to at the horizon.
TEST(MediumGpu, GlowAgrees) {
    for (const scene::WaterOptics& optics : waters()) {
        if (optics.bands.empty())
            continue;
        const reference::Medium medium(optics, true);
        const scene::WaterTable table = scene::make_water_table(optics, true);
        const glm::dvec3 luminance(0.2126, 0.7152, 0.0722);
        int third = 1;
        while (glm::dot(luminance, glm::dvec3(table.rows[0][std::size_t(third)])) > 0.3679)
            ++third;
        const double fall = 1.0 / table.path_m(third);
        std::mt19937 random(3);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        std::vector<glm::vec4> x, y;
        for (int i = 0; i < 4000; ++i) {
            const double sun = 0.84 * unit(random), off = std::pow(unit(random), 2.0) * 1.2,
                         turn = 6.2832 * unit(random);
            const glm::dvec3 to_sun(std::sin(sun), 0.0, std::cos(sun));
            const glm::dvec3 view =
                std::cos(off) * to_sun +
                std::sin(off) * (std::cos(turn) * glm::dvec3(to_sun.z, 0, -to_sun.x) +
                                 std::sin(turn) * glm::dvec3(0, 1, 0));
            const double depth = 4.0 * unit(random) / fall, farthest = 7.0 / fall;
            const double distance = view.z > 0.0 ? std::min(depth / view.z, farthest) : farthest;
            x.emplace_back(1.0 / to_sun.z, depth, -view.z, 0.0);
            y.emplace_back(distance, off, fall, 0.0);
        }
        const auto got = MediumFunction(
            optics,
            "result.rgb = glow_radiance(glow, scale, y.z, x.x, x.y, x.z, x.w, y.x, y.y);")(x, y);
        const auto greatest = [](glm::dvec3 v) {
            return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        };
        double worst_near = 0.0, worst_far = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const glm::dvec3 expected =
                medium.glow_radiance(x[i].x, x[i].y, x[i].z, x[i].w, y[i].x, y[i].y);
            const double error = greatest(glm::dvec3(got[i]) - expected);
            const glm::dvec3 even = medium.path_radiance(x[i].x, x[i].y, x[i].z, x[i].w, y[i].x);
            if (y[i].y < 0.17f) // 10 degrees
                worst_near = std::max(worst_near, error / std::max(greatest(expected), 1e-12));
            else
                worst_far = std::max(worst_far, error / greatest(expected + even));
        }
        // The sky's: off the vertical, by its mean slant.
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double off = 1.3 * unit(random), rise = std::cos(off);
            x[i].x = float(reference::sky_glow_slant(off));
            x[i].z = float(-rise);
            y[i].x = float(std::min(double(x[i].y) / rise, 7.0 / fall));
            y[i].y = float(off);
        }
        const auto got_sky = MediumFunction(
            optics, "result.rgb = glow_radiance(glow, scale, y.z, x.x, x.y, x.z, x.w, y.x, y.y);",
            scene::sky_glow_table(optics.index))(x, y);
        double worst_sky = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const glm::dvec3 expected =
                                 medium.sky_glow_radiance(x[i].y, x[i].z, x[i].w, y[i].x, y[i].y),
                             even = medium.path_radiance(x[i].x, x[i].y, x[i].z, x[i].w, y[i].x);
            worst_sky = std::max(worst_sky, greatest(glm::dvec3(got_sky[i]) - expected) /
                                                greatest(expected + even));
        }
        std::printf(
            "%-24s worst %.3f, of all scattered light more than 10 degrees off the sun %.3f, the "
            "sky's %.3f\n",
            optics.name.c_str(), worst_near, worst_far, worst_sky);
        EXPECT_LE(worst_near, 0.015) << optics.name;
        EXPECT_LE(worst_far, 0.015) << optics.name;
        EXPECT_LE(worst_sky, 0.015) << optics.name;
    }
}
