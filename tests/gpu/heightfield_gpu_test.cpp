// The walk over block maxima against the double-precision grid walk: no hit missed, none invented.
#include "reference/heightfield.hpp"
#include "scene/samples.hpp"
#include "support/field_tracer.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;
using test_support::TestHit;
using test_support::TestRay;

namespace {

/// A scene of given heights, all of its lower part flooded (levels do not matter to the walk).
scene::Scene field(int cols, int rows, double spacing,
                   const std::function<double(int, int)>& height, double level = -1e9) {
    std::vector<float> z;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < cols; ++c)
            z.push_back(float(height(c, r)));
    scene::Scene scene = scene::bowl(9);
    scene.ground = quantise(z, {cols, rows}, spacing, 4);
    scene.ground.north_m = (rows - 1) * spacing;
    scene.water = scene.ground;
    scene.water.scale_m = 0.001;
    scene.water.offset_m = level - 0.001;
    std::fill(scene.water.codes.values.begin(), scene.water.codes.values.end(), no_water_code);
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < cols; ++c)
            if (scene.ground.elevation_m(Node{c, r}) < level)
                for (int k = 0; k < 9; ++k) {
                    const Node n{c + k % 3 - 1, r + k / 3 - 1};
                    if (scene.water.codes.contains(n))
                        scene.water.codes[n] = 1;
                }
    scene.lakes[0].level_m = level > -1e8 ? level : scene.ground.min_elevation_m();
    return scene;
}

struct Verdict {
    int rays = 0, hits = 0, missed = 0, invented = 0, off = 0, other_surface = 0;
    double worst = 0.0; ///< greatest distance error over the allowed one
};

/// Allowed: max(1 quantum, 1e-5 of the distance), both seen along the ray. Where the ray skims a
/// surface, the place of the hit is as uncertain as its height over the sine between the two.
Verdict judge(const scene::Scene& scene, std::vector<TestRay> rays, bool with_water,
              scene::Walk walk = scene::Walk::cone_map) {
    const auto got = test_support::trace_on_gpu(scene, rays, with_water, walk);
    Verdict v;
    const double quantum = scene.ground.scale_m, bottom = scene::block_bottom_m(scene.ground);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ++v.rays;
        const double length = glm::length(rays[i].direction);
        const auto hit = reference::trace_field(scene.ground, with_water ? &scene.water : nullptr,
                                                rays[i].origin, rays[i].direction, 1e9, bottom);
        v.hits += hit.has_value();
        // A miss or hit by less than a quantum is no mistake: lower and raise the ray by one; nor
        // is one by a ten-thousandth of a cell sideways, at the field's rim and at needles.
        const auto shifted = [&](double dz, double dx = 0.0, double dy = 0.0) {
            return reference::trace_field(scene.ground, with_water ? &scene.water : nullptr,
                                          rays[i].origin + glm::dvec3(dx, dy, dz),
                                          rays[i].direction, 1e9);
        };
        const double aside = 1e-4 * scene.ground.spacing_m;
        if (hit && !got[i].hit) {
            v.missed += shifted(quantum) && shifted(0, aside) && shifted(0, -aside) &&
                        shifted(0, 0, aside) && shifted(0, 0, -aside);
            continue;
        }
        if (!hit) {
            if (got[i].hit)
                v.invented += !shifted(-quantum) && !shifted(0, aside) && !shifted(0, -aside) &&
                              !shifted(0, 0, aside) && !shifted(0, 0, -aside);
            continue;
        }
        const double allowed = std::max(quantum, 1e-5 * hit->t * length);
        const double error = std::abs(got[i].t - hit->t) * length;
        if (error > allowed) {
            // Between the hits of the ray a quantum lower and a quantum higher it is still right.
            const auto low = shifted(-quantum), high = shifted(quantum);
            const double first = low ? low->t : 0.0, last = high ? high->t : 1e300;
            if (got[i].t < first - allowed || got[i].t > last + allowed) {
                ++v.off;
                v.worst = std::max(v.worst, error / allowed);
            }
        } else if (got[i].water != hit->water && with_water) {
            // Where the two lie within a quantum of each other either may be named.
            const glm::dvec3 p = hit->point;
            v.other_surface +=
                std::abs(scene.ground.elevation_m(p.x, p.y) - scene.lakes[0].level_m) > 2 * quantum;
        }
    }
    return v;
}

std::vector<TestRay> random_rays(const scene::Scene& scene, int count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const Heightfield& g = scene.ground;
    const double w = g.east_m() - g.west_m, h = g.north_m - g.south_m();
    const double low = g.min_elevation_m(), relief = g.max_elevation_m() - low + g.spacing_m;
    const auto place = [&](double margin) {
        return glm::dvec2(g.west_m + w * (unit(random) * (1 + 2 * margin) - margin),
                          g.south_m() + h * (unit(random) * (1 + 2 * margin) - margin));
    };
    std::vector<TestRay> rays;
    for (int i = 0; i < count; ++i) {
        const glm::dvec2 a = place(0.3), b = place(0.0);
        glm::dvec3 from(a, low + relief * (0.2 + 1.3 * unit(random)));
        glm::dvec3 to(b, low + relief * unit(random));
        switch (i % 8) {
        case 0:
            to = {from.x, from.y, low - 1};
            from.z = low + 2 * relief;
            break; // straight down
        case 1:
            to.z = from.z - 1e-4 * glm::length(b - a);
            break; // grazing
        case 2:
            to.y = from.y;
            break; // along grid rows
        case 3:    // along a grid line, exactly
            from.y = to.y = g.y_m(std::floor(g.row(b.y)));
            break;
        case 4: { // through nodes, diagonally
            const double c = std::floor(g.col(b.x)), r = std::floor(g.row(b.y));
            to = {g.x_m(c), g.y_m(r), to.z};
            from = {g.x_m(c - 20), g.y_m(r - 20), from.z};
            break;
        }
        case 5: // from on the surface, upwards
            from = {b, g.elevation_m(b.x, b.y) + 0.01 * g.spacing_m};
            to = from + glm::dvec3(a - b, relief * unit(random));
            break;
        default:
            break;
        }
        if (glm::length(to - from) > 1e-9)
            rays.push_back({from, glm::normalize(to - from)});
    }
    return rays;
}

void expect_exact(const char* name, const scene::Scene& scene, int count, bool with_water) {
    const Verdict v = judge(scene, random_rays(scene, count, 77), with_water);
    EXPECT_EQ(v.missed, 0) << name;
    EXPECT_EQ(v.invented, 0) << name;
    EXPECT_EQ(v.off, 0) << name << ", worst " << v.worst << " times the allowed error";
    EXPECT_EQ(v.other_surface, 0) << name;
    EXPECT_GT(v.hits, v.rays / 5) << name; // the rays did test something
    ::testing::Test::RecordProperty(name, v.hits);
}

} // namespace

TEST(HeightfieldGpu, MountainsWithAndWithoutTheLake) {
    const scene::Scene scene = scene::mountain_lake(513);
    expect_exact("mountains, ground", scene, 60'000, false);
    expect_exact("mountains, ground and water", scene, 60'000, true);
}

TEST(HeightfieldGpu, SpikesAndCliffs) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const scene::Scene spikes =
        field(100, 77, 1.0, [&](int, int) { return unit(random) < 0.02 ? 60.0 : 0.0; });
    expect_exact("spikes", spikes, 40'000, false);
    const scene::Scene cliffs =
        field(70, 131, 5.0, [](int c, int r) { return ((c / 9 + r / 7) % 2) * 300.0; });
    expect_exact("cliffs", cliffs, 40'000, false);
    const scene::Scene rough = field(64, 64, 1.0, [&](int, int) { return 10.0 * unit(random); });
    expect_exact("noise", rough, 40'000, false);
}

TEST(HeightfieldGpu, PlateauAtWaterLevelAndThinFilms) {
    const scene::Scene plateau = field(
        60, 60, 10.0,
        [](int c, int r) { return c < 20   ? 99.0
                                  : c < 40 ? 100.0
                                           : 100.0 + 0.001 * (r % 3); },
        100.0);
    expect_exact("plateau", plateau, 40'000, true);
}

TEST(HeightfieldGpu, SizesThatAreNoPowersOfTwoAndLongStrips) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (const auto& [cols, rows] : std::vector<std::pair<int, int>>{
             {2, 2}, {3, 2}, {5, 5}, {6, 17}, {2, 300}, {401, 3}, {65, 66}, {257, 130}})
        expect_exact(text(cols, "x", rows).c_str(),
                     field(cols, rows, 3.0, [&](int, int) { return 4.0 * unit(random); }), 8'000,
                     false);
}

TEST(HeightfieldGpu, FirstCrossingIsTheRootThatBisectionFinds) {
    // f(s) = curve s^2 + (below - above - curve) s + above, against bisection in long double.
    std::mt19937 random(12);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    std::vector<glm::vec4> in;
    for (int i = 0; i < 200'000; ++i) {
        const float above = std::pow(10.0f, 4 * unit(random)),
                    below = (i % 3 ? 1.0f : 1e-4f) * unit(random) * above;
        const float curve = i % 4 == 0 ? 1e-7f * unit(random) * above : 6.0f * unit(random) * above;
        in.emplace_back(above, below, curve, 0);
    }
    const auto got = test_support::GpuFunction("lib/heightfield.glsl",
                                               "result.x = first_crossing(Gap(x.x, x.y, x.z));")(in);
    int crossings = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
        const long double c = in[i].x, e = in[i].y, a = in[i].z, b = e - c - a;
        const auto f = [&](long double s) { return (a * s + b) * s + c; };
        long double high = 1.0L;
        bool crosses = e <= 0.0L;
        if (!crosses && a > 0.0L && -b / (2 * a) > 0.0L && -b / (2 * a) < 1.0L &&
            f(-b / (2 * a)) <= 0.0L) {
            high = -b / (2 * a);
            crosses = true;
        }
        // Near-tangent: the discriminant is below its own float32 rounding; either answer is right.
        const long double rounding = 1e-6L * (b * b + std::abs(4 * a * c));
        if (e > 0.0L && std::abs(b * b - 4 * a * c) < rounding)
            continue;
        if (!crosses) {
            ASSERT_GT(got[i].x, 1.0f) << double(c) << " " << double(e) << " " << double(a);
            continue;
        }
        ++crossings;
        long double low = 0.0L;
        for (int k = 0; k < 80; ++k) {
            const long double m = (low + high) / 2;
            (f(m) > 0.0L ? low : high) = m;
        }
        // The root is as certain as f over its slope there.
        const long double slope = std::abs(2 * a * low + b);
        const long double certain =
            4e-7L * (c + std::abs(a) + std::abs(b)) / std::max(slope, 1e-30L) + 2e-7L;
        ASSERT_NEAR(got[i].x, double(low), double(std::min(certain, 1.0L)))
            << double(c) << " " << double(e) << " " << double(a);
    }
    EXPECT_GT(crossings, 50'000);
}
