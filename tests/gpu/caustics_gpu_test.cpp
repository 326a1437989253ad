// Sunlight below waves: the GPU's tiles against theory and against many photons.
#include "reference/caustics.hpp"
#include "render/sunlight.hpp"
#include "scene/samples.hpp"
#include "support/gpu_function.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;

namespace {

constexpr scene::Caustics all_methods[] = {scene::Caustics::splat, scene::Caustics::photon_map,
                                           scene::Caustics::mesh, scene::Caustics::back};

glm::dvec3 sun_at(double elevation_deg, double azimuth_deg = 200.0) {
    const double e = elevation_deg * M_PI / 180.0, a = azimuth_deg * M_PI / 180.0;
    return {std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e)};
}

waves::Sea sea_of(double wind_m_per_s, int texels, int cascades) {
    static const scene::Scene tank = scene::tank();
    waves::Settings s;
    s.model = waves::Model::jonswap;
    s.wind_m_per_s = wind_m_per_s;
    s.fetch_m = 3000.0;
    s.depth_m = 20.0;
    s.texels = texels;
    s.cascades = cascades;
    return waves::make_sea(tank.ground, tank.water, tank.lakes, s);
}

/// One patch with one wave, or none.
waves::Sea sea_of_one_wave(double amplitude_m, int waves_a_patch, double patch_m, int texels) {
    waves::Sea sea = sea_of(4.0, texels, 1);
    waves::Cascade& c = sea.cascades[0];
    c.patch_m = patch_m;
    c.choppiness = 0.0;
    c.bound_m = 1.0;
    std::fill(c.h0.begin(), c.h0.end(), glm::vec4(0.0f));
    if (amplitude_m > 0.0) { // eta = amplitude cos(k x): half on k, half on -k, at rest at time 0
        const std::size_t n = std::size_t(texels), k = std::size_t(waves_a_patch);
        c.h0[k] = {0.25f * float(amplitude_m), 0, 0.25f * float(amplitude_m), 0};
        c.h0[n - k] = {0.25f * float(amplitude_m), 0, 0.25f * float(amplitude_m), 0};
    }
    sea.roughness = {};
    return sea;
}

/// The tiles of a sea at time 0.
struct Tiles {
    render::WaveField waves;
    render::SunlightVolume sunlight;

    Tiles(waves::Sea sea, const render::SunlightSettings& settings) {
        test_support::context();
        waves.set(std::move(sea));
        waves.move_to(0.0);
        sunlight.set(waves.sea(), settings);
        sunlight.update(waves);
    }
};

double mean(const std::vector<float>& v) {
    double sum = 0.0;
    for (const float x : v)
        sum += x;
    return sum / double(v.size());
}

double relative_l1(const std::vector<float>& got, const std::vector<double>& expected) {
    double off = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < got.size(); ++i) {
        off += std::abs(got[i] - expected[i]);
        sum += expected[i];
    }
    return off / sum;
}

reference::SurfaceFunction surface_of(const waves::Sea& sea) {
    const auto fields = std::make_shared<reference::WaveSurface>(sea, 0.0);
    return [fields](glm::dvec2 p) {
        return reference::SurfacePoint{fields->height_m(p, 1e3), fields->slope(p, 1e3)};
    };
}

} // namespace

TEST(CausticsGpu, PhotonAgrees) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> even(-1.0f, 1.0f);
    std::vector<glm::vec4> suns, slopes;
    for (int i = 0; i < 4000; ++i) {
        const double elevation = 1.0 + 89.0 * std::abs(even(random));
        const glm::dvec3 sun = sun_at(elevation, 180.0 * even(random));
        suns.emplace_back(glm::vec3(sun), i % 2);
        slopes.emplace_back(0.6f * even(random), 0.6f * even(random), 0, 0);
    }
    const test_support::GpuFunction on_gpu(
        "lib/caustics.glsl",
        "Photon p = photon_below(x.xyz, y.xy, 1.333, x.w > 0.5); result = vec4(p.lean, p.share, 0.0);");
    const auto got = on_gpu(suns, slopes);
    for (std::size_t i = 0; i < got.size(); ++i) {
        const reference::Photon p = reference::photon_below(
            glm::normalize(glm::dvec3(suns[i])), {slopes[i].x, slopes[i].y}, 1.333, suns[i].w > 0.5f);
        EXPECT_NEAR(got[i].z, p.share, 2e-4 * std::max(1.0, p.share)) << i;
        EXPECT_NEAR(got[i].x, p.lean.x, 1e-5 * (1.0 + 10.0 * std::abs(p.lean.x))) << i;
        EXPECT_NEAR(got[i].y, p.lean.y, 1e-5 * (1.0 + 10.0 * std::abs(p.lean.y))) << i;
    }
}

// Under flat water every method gives exactly 1 everywhere, whatever the sun.
TEST(CausticsGpu, FlatWaterIsOne) {
    for (const scene::Caustics method : all_methods)
        for (const double elevation : {90.0, 40.0, 1.0}) {
            Tiles t(sea_of_one_wave(0.0, 1, 10.0, 128), {.sun = sun_at(elevation), .method = method});
            for (const int slice : {0, 7, 13})
                for (const float v : t.sunlight.read(0, slice))
                    ASSERT_EQ(v, 1.0f)
                        << int(method) << " " << elevation << " " << slice;
        }
}

// Light only moves: at every depth the mean is that of the photons that enter, for seas from a breeze to a gale and
// the sun from the zenith to a degree above the horizon.
TEST(CausticsGpu, FluxIsConserved) {
    for (const scene::Caustics method : all_methods)
        for (const double wind : {2.0, 6.0, 15.0})
            for (const double elevation : {90.0, 30.0, 1.0}) {
                const glm::dvec3 sun = sun_at(elevation);
                Tiles t(sea_of(wind, 128, 2), {.sun = sun, .method = method, .slices = 6});
                for (int j = 0; j < 2; ++j) {
                    double entering = 0.0;
                    const auto surface = t.waves.read(j);
                    for (const glm::vec3& s : surface)
                        entering += reference::photon_below(sun, {s.y, s.z}, 1.333, false).share;
                    entering /= double(surface.size());
                    for (int k = 0; k < t.sunlight.slices_of(j); ++k) {
                        const double got = mean(t.sunlight.read(j, k)) / entering;
                        if (method == scene::Caustics::splat || method == scene::Caustics::mesh)
                            EXPECT_NEAR(got, 1.0, 0.005)
                                << int(method) << " wind " << wind << " sun " << elevation << " cascade "
                                << j << " slice " << k;
                        else
                            std::printf("method %d wind %g sun %g cascade %d slice %d: %.3f\n", int(method), wind, elevation, j, k, got);
                    }
                }
            }
}

TEST(CausticsGpu, PatternAgreesWithManyPhotons) {
    for (const scene::Caustics method : all_methods) {
        for (const int texels : {256, 512}) {
        Tiles t(sea_of(4.0, 512, 3), {.sun = sun_at(50.0), .method = method, .texels = texels});
        for (int j = 1; j < 2; ++j) {
            waves::Sea one = t.waves.sea();
            const waves::Cascade own = one.cascades[j];
            one.cascades = {own};
            std::fill(one.amplitude.values.begin(), one.amplitude.values.end(),
                      std::array<std::uint8_t, 4>{255, 255, 255, 255});
            const auto surface = surface_of(one);
            for (int k = 2; k < 20; k += 4) {
                const double depth = t.sunlight.slice_depth_m(j, k);
                const auto expected = reference::sunlight_by_photons(
                    surface, {.sun = sun_at(50.0), .photons_a_side = 512 / texels * 3},
                    {.corner_m = glm::dvec2(-0.5 * own.texel_m()), .side_m = own.patch_m, .texels = texels}, depth);
                std::printf("method %d side %d cascade %d depth %.3f: L1 %.4f\n", int(method), texels, j, depth, relative_l1(t.sunlight.read(j, k), expected));
            }
        }
        }
    }
}
