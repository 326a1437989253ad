// Ways of finding a first hit: the exact ones miss nothing on any field or ray that we could think
// of.
#include "bench/adversary.hpp"
#include "reference/camera.hpp"
#include "support/gpu_function.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace tarn;

namespace {

/// Every exact method on one field: the default one on all rays, the slow ones on a tenth of them.
void expect_exact(const std::string& name, const scene::Scene& scene, int rays_a_class) {
    test_support::context();
    render::Renderer renderer(scene);
    render::Renderer in_step(scene, true); // the loop that GPUs run: on a tenth of the rays
    long rays = 0, hits = 0;
    for (std::size_t k = 0; k < bench::ray_class_names.size(); ++k)
        for (const bool with_water : {false, true}) {
            const auto kind = static_cast<bench::RayClass>(k);
            if (with_water && kind == bench::RayClass::from_below)
                continue; // from below the surface is not a thing to stop at
            std::vector<bench::TestRay> all =
                bench::make_rays(scene, kind, rays_a_class, unsigned(k + 1));
            const auto rounded = bench::round_rays(scene, all);
            for (const scene::WalkMethod& method : scene::walk_methods()) {
                if (!method.exact)
                    continue;
                const std::size_t count =
                    method.walk == scene::Walk::cone_map ? all.size() : all.size() / 10;
                const auto got = renderer.trace_rays(std::span(rounded).first(count), method.walk,
                                                     0.0, with_water);
                const bench::Verdict v = bench::judge_hits(
                    scene, {all.begin(), all.begin() + std::ptrdiff_t(count)}, got, with_water);
                EXPECT_EQ(v.failures(), 0)
                    << name << ", " << method.name << ", " << bench::ray_class_names[k]
                    << (with_water ? ", with water" : "") << ": of " << v.rays << " rays "
                    << v.missed << " missed, " << v.invented << " invented, " << v.off
                    << " off (worst " << v.worst_m << " m), " << v.other_surface
                    << " other surface";
                if (method.walk == scene::Walk::cone_map) {
                    const std::size_t tenth = all.size() / 10;
                    const bench::Verdict w =
                        bench::judge_hits(scene, {all.begin(), all.begin() + std::ptrdiff_t(tenth)},
                                          in_step.trace_rays(std::span(rounded).first(tenth),
                                                             method.walk, 0.0, with_water),
                                          with_water);
                    EXPECT_EQ(w.failures(), 0)
                        << name << ", in step, " << bench::ray_class_names[k];
                    rays += v.rays;
                    hits += v.hits;
                }
            }
        }
    EXPECT_GT(hits, rays / 4) << name; // the rays did test something
    std::printf("%s: %ld rays by the default method, %ld hits\n", name.c_str(), rays, hits);
}

int rays_a_class() {
    // 8 fields x 19 classes (with and without water) x 66 000 = 10^7 rays.
    const char* wanted = std::getenv("TARN_RAYS");
    return wanted ? std::max(10, std::atoi(wanted)) : 66'000;
}

class WalksGpu : public ::testing::TestWithParam<int> {};

} // namespace

TEST_P(WalksGpu, ExactMethodsMissNothing) {
    const auto fields = bench::adversarial_fields();
    const auto& field = fields[std::size_t(GetParam())];
    expect_exact(field.name, field.scene, rays_a_class());
}

TEST(WalksGpu, SizesThatAreNoPowersOfTwoAndLongStrips) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (const auto& [cols, rows] : std::vector<std::pair<int, int>>{
             {2, 2}, {3, 2}, {5, 5}, {6, 17}, {2, 300}, {401, 3}, {65, 66}, {257, 130}})
        expect_exact(
            text(cols, "x", rows),
            bench::field_scene({cols, rows}, 3.0, [&](int, int) { return 4.0 * unit(random); }),
            600);
}

TEST(WalksGpu, PlateausAtTheWatersLevelAndThinFilms) {
    expect_exact("thin films",
                 bench::field_scene(
                     {60, 60}, 10.0,
                     [](int c, int r) {
                         return c < 20 ? 99.0 : c < 40 ? 100.0 : 100.0 + 0.001 * (r % 3);
                     },
                     100.0),
                 5'000);
}

// The same for devices that run rays in step: another loop, see lib/walks/cone_map.glsl.
TEST(WalksGpu, RaysInStepFindTheSame) {
    test_support::context();
    for (const auto& field : bench::adversarial_fields()) {
        render::Renderer one_by_one(field.scene, false), in_step(field.scene, true);
        auto rays = bench::make_rays(field.scene, bench::RayClass::any, 20'000, 5);
        const auto rounded = bench::round_rays(field.scene, rays);
        const auto a = one_by_one.trace_rays(rounded, scene::Walk::cone_map, 0.0, true);
        const auto b = in_step.trace_rays(rounded, scene::Walk::cone_map, 0.0, true);
        for (std::size_t i = 0; i < a.size(); ++i) {
            ASSERT_EQ(a[i].kind, b[i].kind) << field.name;
            ASSERT_NEAR(a[i].t, b[i].t, 1e-5 * a[i].t + 1e-3) << field.name;
        }
    }
}

// First hits of pictures, which start where their beams leave off: cameras outside, far, below the
// block, in the ground, wide angles, sizes that fit no tile.
TEST(WalksGpu, BeamsNeverReachThroughTheSurface) {
    test_support::context();
    const auto fields = bench::adversarial_fields();
    std::mt19937 random(8);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    long judged = 0, hits = 0;
    for (const auto& field : fields) {
        const Heightfield& g = field.scene.ground;
        const double w = g.east_m() - g.west_m, low = g.min_elevation_m(),
                     relief = g.max_elevation_m() - low + 1.0;
        for (const bool in_step : {false, true}) {
            render::Renderer renderer(field.scene, in_step);
            for (int i = 0; i < 12; ++i) {
                const double far = i % 3 == 0 ? 20.0 : i % 3 == 1 ? 1.0 : 0.2;
                const glm::dvec3 middle(g.west_m + 0.5 * w, 0.5 * (g.north_m + g.south_m()),
                                        low + 0.5 * relief);
                const glm::dvec3 from =
                    middle + glm::dvec3(w * far * (unit(random) - 0.5),
                                        w * far * (unit(random) - 0.5),
                                        relief * (3 * unit(random) - 1.0) * std::max(far, 0.5));
                scene::View view;
                view.camera =
                    scene::look_along(from, middle - from + glm::dvec3(0.01, 0, 0), {0, 0, 1},
                                      i % 4 == 0 ? 170.0 : 20.0 + 60.0 * unit(random));
                view.lighting = scene::uniform_sky({0, 0, 1}, glm::dvec3(1), glm::dvec3(1));
                view.settings.width_px = i % 5 == 0 ? 1 : 61;
                view.settings.height_px = i % 5 == 0 ? 1 : 43;
                view.settings.samples = 1;
                renderer.prepare(view);
                renderer.find_first_hits();
                const auto got = renderer.read_first_hits();
                const double half = std::tan(0.5 * view.camera.fov_deg * M_PI / 180);
                const int px = view.settings.width_px, py = view.settings.height_px;
                const auto water = field.scene.water_level_m(from.x, from.y);
                const bool below = water && from.z < *water;
                std::vector<bench::TestRay> rays;
                std::vector<render::FieldHit> answers;
                for (int k = 0; k < px * py; ++k) {
                    rays.push_back({from, reference::pixel_direction(
                                              view.camera.forward, view.camera.right,
                                              view.camera.up, {half * px / py, half},
                                              {(k % px + 0.5) / px, (k / px + 0.5) / py})});
                    const float t = got[std::size_t(k)];
                    answers.push_back({std::abs(t), t == 0 ? 0.0f : t < 0 ? 2.0f : 1.0f, 0, 0});
                }
                const bench::Verdict v = bench::judge_hits(field.scene, rays, answers, !below);
                EXPECT_EQ(v.missed + v.invented + v.off, 0)
                    << field.name << " view " << i << ": " << v.missed << " missed, " << v.invented
                    << " invented, " << v.off << " off (worst " << v.worst_m << ")";
                judged += v.rays;
                hits += v.hits;
            }
        }
    }
    EXPECT_GT(hits, judged / 4);
    std::printf("%ld rays, %ld hits\n", judged, hits);
}

// Not exact, and known to be: each approximate method does fail here, or its entry in the failure
// table would be wrong.
TEST(WalksGpu, ApproximateMethodsFailWhereTheirFilesSayThatTheyDo) {
    test_support::context();
    for (const auto& field : bench::adversarial_fields()) {
        if (field.name != "needles" && field.name != "spikes" && field.name != "rough")
            continue;
        render::Renderer renderer(field.scene);
        auto rays = bench::make_rays(field.scene, bench::RayClass::any, 20'000, 3);
        const auto rounded = bench::round_rays(field.scene, rays);
        for (const scene::WalkMethod& method : scene::walk_methods()) {
            const auto got = renderer.trace_rays(rounded, method.walk, 0.0, false);
            const int failures = bench::judge_hits(field.scene, rays, got, false).failures();
            EXPECT_EQ(failures == 0, method.exact) << method.name << " on " << field.name;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(AllFields, WalksGpu, ::testing::Range(0, 8));
