// Ways of finding a first hit: the exact ones miss nothing on any field or ray that we could think of.
#include "bench/adversary.hpp"
#include "support/gpu_function.hpp"

#include <gtest/gtest.h>

using namespace tarn;

namespace {

/// Every exact method on one field: the default one on all rays, the slow ones on a tenth of them.
void expect_exact(const std::string& name, const scene::Scene& scene, int rays_a_class) {
    test_support::context();
    render::Renderer renderer(scene);
    long rays = 0, hits = 0;
    for (std::size_t k = 0; k < bench::ray_class_names.size(); ++k)
        for (const bool with_water : {false, true}) {
            const auto kind = static_cast<bench::RayClass>(k);
            if (with_water && kind == bench::RayClass::from_below)
                continue; // from below the surface is not a thing to stop at
            std::vector<bench::TestRay> all = bench::make_rays(scene, kind, rays_a_class, unsigned(k + 1));
            const auto rounded = bench::round_rays(scene, all);
            for (const scene::WalkMethod& method : scene::walk_methods()) {
                if (!method.exact)
                    continue;
                const std::size_t count =
                    method.walk == scene::Walk::cone_map ? all.size() : all.size() / 10;
                const auto got = renderer.trace_rays(std::span(rounded).first(count), method.walk, 0.0, with_water);
                const bench::Verdict v = bench::judge_hits(
                    scene, {all.begin(), all.begin() + std::ptrdiff_t(count)}, got, with_water);
                EXPECT_EQ(v.failures(), 0)
                    << name << ", " << method.name << ", " << bench::ray_class_names[k]
                    << (with_water ? ", with water" : "") << ": of " << v.rays << " rays " << v.missed
                    << " missed, " << v.invented << " invented, " << v.off << " off (worst "
                    << v.worst_m << " m), " << v.other_surface << " other surface";
                if (method.walk == scene::Walk::cone_map) {
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
INSTANTIATE_TEST_SUITE_P(AllFields, WalksGpu, ::testing::Range(0, 8));
