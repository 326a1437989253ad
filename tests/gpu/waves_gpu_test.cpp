// The sea on the GPU against FFTW and against theory.
#include "reference/fft.hpp"
#include "reference/waves.hpp"
#include "render/waves.hpp"
#include "scene/samples.hpp"
#include "support/gpu_function.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

using namespace tarn;

namespace {

waves::Settings windy(waves::Model model, int texels, int cascades = 3) {
    waves::Settings s;
    s.model = model;
    s.wind_m_per_s = 6.0;
    s.fetch_m = 3000.0;
    s.depth_m = 5.0;
    s.texels = texels;
    s.cascades = cascades;
    return s;
}

waves::Sea sea_of(const waves::Settings& settings) {
    static const scene::Scene tank = scene::tank();
    return waves::make_sea(tank.ground, tank.water, tank.lakes, settings);
}

double rms(const std::vector<double>& v) {
    double sum = 0.0;
    for (const double x : v)
        sum += x * x;
    return std::sqrt(sum / double(v.size()));
}

} // namespace

// Heights and slopes of every size of cascade, several times, within 1e-4 of their rms of FFTW's.
TEST(WavesGpu, TransformsAgreeWithFftw) {
    test_support::context();
    for (const int texels : {128, 256, 512, 1024, 2048}) {
        waves::Settings s = windy(waves::Model::jonswap, texels, texels > 512 ? 1 : 3);
        s.choppiness = 0.0;
        render::WaveField field;
        field.set(sea_of(s));
        for (const double time : texels > 512 ? std::vector{12.3} : std::vector{0.0, 12.3, -4e8}) {
            field.move_to(time);
            for (std::size_t j = 0; j < field.sea().cascades.size(); ++j) {
                const auto got = field.read(int(j));
                const auto expected =
                    reference::wave_fields(field.sea().cascades[j], time, s.loop_s);
                double height = 0.0, slope = 0.0;
                for (std::size_t i = 0; i < got.size(); ++i) {
                    height += std::pow(got[i].x - expected.height[i], 2);
                    slope += std::pow(got[i].y - expected.slope_x[i], 2) +
                             std::pow(got[i].z - expected.slope_y[i], 2);
                }
                const double count = double(got.size());
                EXPECT_LT(std::sqrt(height / count), 1e-4 * rms(expected.height))
                    << texels << " " << time;
                // Slopes are kept in 16-bit floats: steps of a 2048th, which software GL
                // cuts off.
                EXPECT_LT(std::sqrt(slope / count),
                          5e-4 * std::hypot(rms(expected.slope_x), rms(expected.slope_y)))
                    << texels << " " << time;
            }
        }
    }
}

// Tessendorf's experiment (his section 3.6): the power of a sequence over wave vector and frequency
// lies on the dispersion curve, here within one bin of the unquantised one. And it travels with the
// wind.
TEST(WavesGpu, PowerLiesOnTheDispersionCurve) {
    test_support::context();
    for (const double depth : {1e4, 0.4}) {
        waves::Settings s = windy(waves::Model::jonswap, 128, 1);
        s.choppiness = 0.0;
        s.depth_m = depth;
        s.loop_s = 12.0;
        const int frames = 128, n = 128;
        render::WaveField field;
        field.set(sea_of(s));
        const waves::Cascade& c = field.sea().cascades[0];
        ASSERT_LT(waves::omega_per_s(c.high_k, depth) * s.loop_s / (2 * M_PI), frames / 2 - 1);
        std::vector<reference::Complex> cube;
        for (int f = 0; f < frames; ++f) {
            field.move_to(s.loop_s * f / frames);
            for (const glm::vec3& texel : field.read(0))
                cube.emplace_back(texel.x, 0.0);
        }
        cube = reference::fft_forward_3d(std::move(cube), frames, n);
        double all = 0.0, near = 0.0, downwind = 0.0;
        const glm::dvec2 towards = waves::Spectrum(s, 3000, depth).towards();
        const auto index = [](int i, int size) { return i < size / 2 ? i : i - size; };
        for (int f = 0; f < frames; ++f)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) {
                    const double power =
                        std::norm(cube[(std::size_t(f) * n + std::size_t(y)) * n + std::size_t(x)]);
                    const glm::dvec2 k =
                        2 * M_PI / c.patch_m * glm::dvec2(index(x, n), index(y, n));
                    const double bin =
                        waves::omega_per_s(glm::length(k), depth) * s.loop_s / (2 * M_PI);
                    all += power;
                    if (std::abs(std::abs(index(f, frames)) - bin) <= 1.0)
                        near += power;
                    // exp(i (k x - omega t)): a wave that runs along k has its power at -omega.
                    const double way = glm::dot(k, towards) * -index(f, frames);
                    if (way > 0.0)
                        downwind += power;
                }
        EXPECT_GT(near / all, 0.99) << depth;
        EXPECT_GT(downwind / all, 0.9) << depth; // the spreading sends little against the wind
        RecordProperty(text("near_", depth), text(near / all));
    }
}

TEST(WavesGpu, HeightsAreGaussianWithTheSpectrumsVariance) {
    test_support::context();
    waves::Settings s = windy(waves::Model::jonswap, 512, 3);
    s.choppiness = 0.0;
    std::vector<double> each; // variance of each sea
    double variance = 0.0, slope = 0.0, third = 0.0, fourth = 0.0, samples = 0.0;
    render::WaveField field;
    waves::Sea sea;
    for (std::uint32_t seed = 1; seed <= 12; ++seed) {
        s.seed = seed;
        sea = sea_of(s);
        field.set(sea);
        field.move_to(100.0);
        // The cascades are independent: their variances add up.
        std::vector<std::vector<glm::vec3>> all;
        for (std::size_t j = 0; j < sea.cascades.size(); ++j)
            all.push_back(field.read(int(j)));
        std::vector<double> sum(all[0].size(), 0.0);
        for (const auto& texels : all)
            for (std::size_t i = 0; i < texels.size(); ++i) {
                sum[i] += texels[i].x;
                slope += double(texels[i].y) * texels[i].y + double(texels[i].z) * texels[i].z;
            }
        double here = 0.0;
        for (const double h : sum) {
            here += h * h;
            third += h * h * h;
            fourth += h * h * h * h;
        }
        variance += here;
        each.push_back(here / double(sum.size()));
        samples += double(sum.size());
    }
    variance /= samples;
    slope /= samples;
    double expected = 0.0, expected_slope = 0.0;
    for (const waves::Cascade& c : sea.cascades) {
        expected += c.moments.height;
        expected_slope += c.moments.slope();
    }
    // A sea of finite extent has its own variance: the mean over twelve, within three of its
    // standard errors. The slopes, of far more waves, are nearer.
    double spread = 0.0;
    for (const double v : each)
        spread += std::pow(v - variance, 2);
    const double error = std::sqrt(spread / double(each.size() - 1) / double(each.size()));
    EXPECT_LT(error, 0.015 * expected);
    EXPECT_NEAR(variance, expected, 3.0 * error);
    EXPECT_NEAR(slope / expected_slope, 1.0, 0.01);
    EXPECT_NEAR(third / samples / std::pow(variance, 1.5), 0.0, 0.03);
    EXPECT_NEAR(fourth / samples / (variance * variance), 3.0, 0.05);
    EXPECT_NEAR(4 * std::sqrt(expected), sea.report.significant_height_m,
                0.01 * sea.report.significant_height_m);
}

TEST(WavesGpu, TheLoopClosesAndAnyTimeIsReachedDirectly) {
    test_support::context();
    waves::Settings s = windy(waves::Model::tma, 256, 2);
    s.loop_s = 40.0;
    render::WaveField field;
    field.set(sea_of(s));
    const auto at = [&](double time) {
        field.move_to(time);
        return field.read(0);
    };
    const auto start = at(3.0), there = at(23.0);
    EXPECT_NE(start, there);
    EXPECT_EQ(start, at(43.0));
    EXPECT_EQ(start, at(-37.0));
    EXPECT_EQ(start, at(3.0 + 40.0 * 25'000'000)); // 32 years on
    EXPECT_EQ(there, at(23.0));
}

// A trochoid (Gerstner 1802): the point over x came from x' with x' - A sin(k x') = x, its height
// is A cos(k x'). Crests and troughs, and slopes at every texel, from long waves up to k A = .97.
TEST(WavesGpu, GerstnerWavesAreTrochoids) {
    test_support::context();
    for (const double steepness : {0.05, 0.3, 0.6, 0.9, 0.97}) {
        waves::Settings s;
        s.model = waves::Model::gerstner;
        s.texels = 512;
        s.cascades = 1;
        const double length = 10.0, k = 2 * M_PI / length, amplitude = steepness / k;
        s.list = {{.amplitude_m = amplitude, .length_m = length, .towards_deg = 90.0}};
        s.depth_m = 1e4;
        render::WaveField field;
        field.set(sea_of(s));
        field.move_to(0.0);
        const waves::Cascade& c = field.sea().cascades[0];
        ASSERT_NEAR(std::remainder(c.patch_m, length), 0.0, 1e-9);
        ASSERT_EQ(c.choppiness, 1.0);
        const auto texels = field.read(0);
        double highest = -1e9, lowest = 1e9, worst = 0.0, worst_slope = 0.0;
        for (int i = 0; i < 512; ++i) {
            const double x = i * c.texel_m();
            double low = x - amplitude - 1.0,
                   high = x + amplitude + 1.0; // x' - A sin(k x') grows with x'
            for (int it = 0; it < 100; ++it) {
                const double middle = 0.5 * (low + high);
                (middle - amplitude * std::sin(k * middle) < x ? low : high) = middle;
            }
            const double phase = k * low;
            const double slope =
                -amplitude * k * std::sin(phase) / (1.0 - amplitude * k * std::cos(phase));
            const glm::vec3& t = texels[std::size_t(i)];
            worst = std::max(worst, std::abs(t.x - amplitude * std::cos(phase)));
            worst_slope = std::max(worst_slope, std::abs(t.y - slope) / (1.0 + std::abs(slope)));
            highest = std::max(highest, double(t.x));
            lowest = std::min(lowest, double(t.x));
            EXPECT_NEAR(t.z, 0.0, 1e-4);
        }
        EXPECT_NEAR(highest, amplitude, 0.01 * amplitude) << steepness;
        EXPECT_NEAR(lowest, -amplitude, 0.01 * amplitude) << steepness;
        std::printf("kA %.2f: height off by %.4f A, slope by %.4f (relative to 1 + slope)\n",
                    steepness, worst / amplitude, worst_slope);
        // Sixty-four texels a wave; points within a hundredth of a texel, slopes in 16 bits.
        EXPECT_LT(worst / amplitude, 0.003) << steepness;
        EXPECT_LT(worst_slope, 0.004) << steepness;
    }
}

// The bound on choppiness keeps the surface from folding; four times as much would fold it.
TEST(WavesGpu, NothingFoldsAtTheBoundAndFarBeyondItWould) {
    test_support::context();
    for (const double wind : {6.0, 20.0, 60.0}) {
        waves::Settings s = windy(waves::Model::jonswap, 512, 3);
        s.wind_m_per_s = wind;
        s.choppiness = 2.0;
        waves::Sea sea = sea_of(s);
        render::WaveField field;
        field.set(sea);
        double least = 1.0;
        for (const double time : {0.0, 50.0, 170.0}) {
            field.move_to(time);
            for (std::size_t j = 0; j < sea.cascades.size(); ++j)
                least = std::min(least, field.least_eigenvalue(int(j)));
        }
        EXPECT_GT(least, 0.0) << wind;
        if (wind > 50.0) {
            for (waves::Cascade& c : sea.cascades)
                c.choppiness *= 4.0; // the bound is for six deviations, a patch has five
            field.set(sea);
            field.move_to(0.0);
            EXPECT_LT(field.least_eigenvalue(int(sea.cascades.size()) - 1), 0.0);
        }
    }
}

// What the walk trusts: no water is higher, none steeper between texels; coarser levels are means
// of four.
TEST(WavesGpu, LimitsHoldForTheWavesThatAreThere) {
    test_support::context();
    for (const int texels : {128, 256, 512}) {
        waves::Settings s = windy(waves::Model::jonswap, texels, 3);
        s.ripples.rain_drops_per_m2_s = 30.0;
        render::WaveField field;
        field.set(sea_of(s));
        for (const double time : {5.0, 250.0}) {
            field.move_to(time);
            for (std::size_t j = 0; j < field.sea().cascades.size(); ++j) {
                const auto texel = field.read(int(j));
                const auto limits = field.limits(int(j));
                std::vector<double> level(texel.size());
                double steepest = 0.0;
                for (int y = 0; y < texels; ++y)
                    for (int x = 0; x < texels; ++x) {
                        const auto at = [&](int c, int r) {
                            return double(texel[std::size_t((r % texels) * texels + c % texels)].x);
                        };
                        level[std::size_t(y * texels + x)] = at(x, y);
                        steepest = std::max(
                            steepest, std::hypot(at(x + 1, y) - at(x, y), at(x, y + 1) - at(x, y)));
                    }
                EXPECT_GE(limits[TARN_WAVE_LEVELS] * 1.000001,
                          steepest / field.sea().cascades[j].texel_m());
                EXPECT_LE(limits[TARN_WAVE_LEVELS],
                          2.1 * steepest / field.sea().cascades[j].texel_m());
                int side = texels;
                for (int l = 0; side >= 4; ++l, side /= 2) {
                    double top = 0.0;
                    for (const double h : level)
                        top = std::max(top, std::abs(h));
                    EXPECT_NEAR(limits[std::size_t(l)], top, 1e-5 * limits[0] + 1e-9)
                        << texels << " " << j << " " << l;
                    std::vector<double> next(level.size() / 4);
                    for (int y = 0; y < side / 2; ++y)
                        for (int x = 0; x < side / 2; ++x)
                            for (int k = 0; k < 4; ++k)
                                next[std::size_t(y * (side / 2) + x)] +=
                                    0.25 *
                                    level[std::size_t((2 * y + k / 2) * side + 2 * x + k % 2)];
                    level = next;
                }
            }
        }
    }
}

// The library's sums at any place against the double-precision surface, near enough that nothing is
// filtered: cascades and closed-form sines.
TEST(WavesGpu, HeightsAndSlopesAgreeWithTheReferenceBetweenTexels) {
    test_support::context();
    for (const bool sines : {false, true}) {
        waves::Settings s = windy(waves::Model::jonswap, 256, 3);
        if (sines) {
            s.model = waves::Model::sines;
            s.list = {{0.2, 7.3, 40.0, 0.5}, {0.05, 1.1, 200.0, 2.0}};
        }
        s.time_s = 0.0;
        const waves::Sea sea = sea_of(s);
        render::WaveField field;
        field.set(sea);
        field.move_to(77.0);
        const glm::dvec2 base(12'345.0, -6'789.0);
        field.bind(base, sea.bound_m);
        const reference::WaveSurface surface(sea, 77.0);
        const test_support::GpuFunction on_gpu(
            "lib/waves.glsl",
            "vec4 a = wave_fade(waves, x.z) * wave_amplitude(amplitudes, waves, x.xy); vec3 taken; "
            "result = vec4(wave_height(heights, table, waves, x.xy, 0.0, a), wave_slopes(slopes, "
            "table, waves, x.xy, 0.0, a, taken), 0);",
            text("layout(binding = TARN_BLOCK_WAVES, std140) uniform Waves { WaveBlock waves; };\n"
                 "layout(binding = TARN_TEXTURE_WAVES) uniform sampler2DArray heights;\n"
                 "layout(binding = TARN_TEXTURE_SLOPES) uniform sampler2DArray slopes;\n"
                 "layout(binding = TARN_TEXTURE_AMPLITUDE) uniform sampler2D amplitudes;\n"
                 "layout(binding = TARN_TEXTURE_WAVE_TABLE) uniform sampler2D table;\n"),
            text("#define TARN_CASCADES ", sea.cascades.size(), "\n"));
        std::vector<glm::vec4> places;
        for (int i = 0; i < 4000; ++i)
            places.emplace_back(std::fmod(i * 7.61803, 60.0) - 30, std::fmod(i * 3.3247, 60.0) - 30,
                                i % 3 == 0 ? 0.1 : 5.0, 0);
        const auto got = on_gpu(places);
        double height = 0.0, slope = 0.0, rms_height = 0.0, rms_slope = 0.0;
        for (std::size_t i = 0; i < places.size(); ++i) {
            const glm::dvec2 at = base + glm::dvec2(places[i].x, places[i].y);
            const double h = surface.height_m(at, places[i].z);
            const glm::dvec2 g = surface.slope(at, places[i].z);
            height += std::pow(got[i].x - h, 2);
            slope += std::pow(got[i].y - g.x, 2) + std::pow(got[i].z - g.y, 2);
            rms_height += h * h;
            rms_slope += glm::dot(g, g);
        }
        // Bilinear look-up: at the peak's twelve texels a wave up to 3 % of the height are lost
        // midway between them, at the four of a band's short end a third; most of the slopes are
        // there.
        EXPECT_LT(std::sqrt(height / rms_height), sines ? 1e-5 : 0.05);
        EXPECT_LT(std::sqrt(slope / rms_slope), sines ? 1e-5 : 0.25);
        std::printf("%s: height off by %.5f, slope by %.5f of their rms\n",
                    sines ? "sines" : "cascades", std::sqrt(height / rms_height),
                    std::sqrt(slope / rms_slope));
    }
}
