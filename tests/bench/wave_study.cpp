// tarn_wave_study FOLDER — measures the sea that the GPU makes and writes the tables behind the
// plots of docs/waves.md (scripts/wave-study draws them).
#include "core/error.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "reference/fft.hpp"
#include "render/ripples.hpp"
#include "render/waves.hpp"
#include "scene/samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <glm/geometric.hpp>
#include <iostream>

namespace {

using namespace tarn;

waves::Sea sea_of(const waves::Settings& s) {
    static const scene::Scene scene = scene::tank();
    return waves::make_sea(scene.ground, scene.water, scene.lakes, s);
}

waves::Settings windy() {
    waves::Settings s;
    s.model = waves::Model::jonswap;
    s.wind_m_per_s = 6.0;
    s.fetch_m = 3000.0;
    s.depth_m = 1e4;
    s.choppiness = 0.0;
    return s;
}

/// Power of a sequence by wavenumber and frequency, and the curve that it should lie on.
void dispersion(const std::string& folder) {
    std::ofstream points(folder + "/dispersion.dat"), curves(folder + "/dispersion_curve.dat");
    for (const double depth : {1e4, 0.4}) {
        waves::Settings s = windy();
        s.texels = 128;
        s.cascades = 1;
        s.depth_m = depth;
        s.loop_s = 12.0;
        const int frames = 128, n = 128;
        render::WaveField field;
        field.set(sea_of(s));
        std::vector<reference::Complex> cube;
        for (int f = 0; f < frames; ++f) {
            field.move_to(s.loop_s * f / frames);
            for (const glm::vec3& texel : field.read(0))
                cube.emplace_back(texel.x, 0.0);
        }
        cube = reference::fft_forward_3d(std::move(cube), frames, n);
        const double dk = 2 * M_PI / field.sea().cascades[0].patch_m, dw = 2 * M_PI / s.loop_s;
        // By rings of whole wavenumber steps, both signs of the frequency together.
        std::vector<double> table(std::size_t(n / 2) * std::size_t(frames / 2), 0.0);
        double all = 0.0, near = 0.0;
        for (int f = 0; f < frames; ++f)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) {
                    const double power =
                        std::norm(cube[(std::size_t(f) * n + std::size_t(y)) * n + std::size_t(x)]);
                    const int kx = x < n / 2 ? x : x - n, ky = y < n / 2 ? y : y - n,
                              w = std::min(f, frames - f);
                    const double k = std::hypot(kx, ky);
                    all += power;
                    near +=
                        std::abs(w - waves::omega_per_s(dk * k, depth) / dw) <= 1.0 ? power : 0.0;
                    if (int(k + 0.5) < n / 2 && w < frames / 2)
                        table[std::size_t(int(k + 0.5)) * std::size_t(frames / 2) +
                              std::size_t(w)] += power;
                }
        for (int k = 0; k < n / 2; ++k)
            for (int w = 0; w < frames / 2; ++w) {
                const double share =
                    table[std::size_t(k) * std::size_t(frames / 2) + std::size_t(w)] / all;
                if (share > 1e-7)
                    points << depth << " " << k * dk << " " << w * dw << " " << share << "\n";
            }
        for (double k = 0.0; k < n / 2 * dk; k += 0.2 * dk)
            curves << k << " " << waves::omega_per_s(k, depth) << "\n";
        points << "\n\n";
        curves << "\n\n";
        std::printf("depth %g m: %.3f %% of the energy within one bin of the dispersion curve\n",
                    depth, 100 * near / all);
    }
}

/// Variance by wavenumber, and the distribution of heights, over some seeds.
void spectra(const std::string& folder) {
    waves::Settings s = windy();
    const int bins = 60, seeds = 8;
    const waves::Spectrum spectrum(s, 3000.0, 1e4);
    const double low = spectrum.lowest_k(), high = spectrum.highest_k(),
                 stride = std::log(high / low) / bins;
    std::vector<double> power(bins, 0.0), heights;
    double variance = 0.0, slope = 0.0, expected = 0.0, expected_slope = 0.0;
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        s.seed = seed;
        render::WaveField field;
        field.set(sea_of(s));
        field.move_to(33.0);
        std::vector<double> sum;
        for (std::size_t j = 0; j < field.sea().cascades.size(); ++j) {
            const waves::Cascade& c = field.sea().cascades[j];
            const auto texels = field.read(int(j));
            const int n = c.texels;
            sum.resize(texels.size(), 0.0);
            std::vector<reference::Complex> grid;
            for (std::size_t i = 0; i < texels.size(); ++i) {
                grid.emplace_back(texels[i].x, 0.0);
                sum[i] += texels[i].x;
                slope += (double(texels[i].y) * texels[i].y + double(texels[i].z) * texels[i].z) /
                         double(texels.size() * seeds);
            }
            grid = reference::fft_forward_3d(std::move(grid), 1, n);
            const double per = 1.0 / (double(n) * n);
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) {
                    const double k = 2 * M_PI / c.patch_m *
                                     std::hypot(x < n / 2 ? x : x - n, y < n / 2 ? y : y - n);
                    const int bin = k > 0 ? int(std::floor(std::log(k / low) / stride)) : -1;
                    if (bin >= 0 && bin < bins)
                        power[std::size_t(bin)] +=
                            std::norm(grid[std::size_t(y * n + x)] * per) / seeds;
                }
            expected += c.moments.height / seeds;
            expected_slope += c.moments.slope() / seeds;
        }
        for (const double h : sum)
            variance += h * h / double(sum.size() * seeds);
        heights.insert(heights.end(), sum.begin(), sum.end());
    }
    std::ofstream out(folder + "/spectrum.dat");
    for (int b = 0; b < bins; ++b) {
        const double k = low * std::exp((b + 0.5) * stride),
                     width = low * std::exp((b + 1) * stride) - low * std::exp(b * stride);
        out << k << " " << power[std::size_t(b)] / width << " " << spectrum.density(k) << "\n";
    }
    std::ofstream histogram(folder + "/heights.dat");
    const double sigma = std::sqrt(expected);
    std::vector<double> counts(81, 0.0);
    for (const double h : heights) {
        const int bin = int(std::lround(h / sigma * 8.0)) + 40;
        if (bin >= 0 && bin < 81)
            counts[std::size_t(bin)] += 8.0 / double(heights.size());
    }
    for (int b = 0; b < 81; ++b)
        histogram << (b - 40) / 8.0 << " " << counts[std::size_t(b)] << " "
                  << std::exp(-0.5 * std::pow((b - 40) / 8.0, 2)) / std::sqrt(2 * M_PI) << "\n";
    std::printf(
        "%d seas: variance %.4f of the spectrum's integral, slope variance %.4f; Hs %.3f m\n",
        seeds, variance / expected, slope / expected_slope, 4 * std::sqrt(variance));
}

/// One wave as it steepens, beside the closed form.
void trochoids(const std::string& folder) {
    std::ofstream out(folder + "/trochoids.dat");
    for (const double steepness : {0.1, 0.3, 0.6, 0.9, 0.97}) {
        waves::Settings s;
        s.model = waves::Model::gerstner;
        s.cascades = 1;
        s.depth_m = 1e4;
        const double k = 2 * M_PI / 10.0, amplitude = steepness / k;
        s.list = {{amplitude, 10.0, 90.0, 0.0}};
        render::WaveField field;
        field.set(sea_of(s));
        field.move_to(0.0);
        const auto texels = field.read(0);
        double worst = 0.0, worst_slope = 0.0;
        for (int i = -64; i <= 64; ++i) {
            const double x = i * field.sea().cascades[0].texel_m();
            double low = x - amplitude - 1, high = x + amplitude + 1;
            for (int it = 0; it < 100; ++it) {
                const double middle = 0.5 * (low + high);
                (middle - amplitude * std::sin(k * middle) < x ? low : high) = middle;
            }
            const glm::vec3& t = texels[std::size_t((i + 512) % 512)];
            const double want = amplitude * std::cos(k * low);
            const double slope =
                -steepness * std::sin(k * low) / (1 - steepness * std::cos(k * low));
            worst = std::max(worst, std::abs(t.x - want) / amplitude);
            worst_slope = std::max(worst_slope, std::abs(t.y - slope) / (1 + std::abs(slope)));
            out << x << " " << t.x << " " << want << "\n";
        }
        out << "\n\n";
        std::printf("kA %.2f: height within %.4f A, slope within %.4f of 1 + slope; least "
                    "eigenvalue %.3f\n",
                    steepness, worst, worst_slope, field.least_eigenvalue(0));
    }
}

/// What differences between neighbours would make of slopes, by texels a wave.
void slopes(const std::string& folder) {
    std::ofstream out(folder + "/slopes.dat");
    for (const int waves_a_patch : {4, 8, 16, 32, 64, 100, 128, 160, 192, 224}) {
        waves::Settings s;
        s.model = waves::Model::gerstner;
        s.cascades = 1;
        s.choppiness = 0.0;
        s.patch_m = 64.0;
        s.depth_m = 1e4;
        s.list = {{0.01, 64.0 / waves_a_patch, 90.0, 0.3}};
        waves::Sea sea = sea_of(s);
        if (sea.still())
            continue;
        render::WaveField field;
        field.set(sea);
        field.move_to(0.0);
        const auto t = field.read(0);
        const double texel = 64.0 / 512.0;
        double spectral = 0.0, differences = 0.0, truth = 0.0;
        for (int i = 0; i < 512; ++i) {
            const double k = 2 * M_PI * waves_a_patch / 64.0,
                         slope = -0.01 * k * std::sin(k * i * texel + 0.3);
            const double difference =
                (t[std::size_t((i + 1) % 512)].x - t[std::size_t((i + 511) % 512)].x) / (2 * texel);
            spectral += std::pow(t[std::size_t(i)].y - slope, 2);
            differences += std::pow(difference - slope, 2);
            truth += slope * slope;
        }
        out << 512.0 / waves_a_patch << " " << std::sqrt(spectral / truth) << " "
            << std::sqrt(differences / truth) << " "
            << 1.0 - std::sin(2 * M_PI * waves_a_patch / 512.0) / (2 * M_PI * waves_a_patch / 512.0)
            << "\n";
    }
}

/// A ring's radius and energy.
void ripples(const std::string& folder) {
    std::ofstream out(folder + "/ripples.dat");
    render::RipplePond pond{
        .texels = 512, .damping_per_s = 0.8, .edge = render::RipplePond::Edge::reflects};
    render::Ripples r(pond);
    r.move_to(0.0);
    r.poke({4.0, 4.0}, 0.01, 6 * pond.texel_m);
    double first = 0.0;
    for (double t = 0.5; t < 12.0; t += 0.5) {
        r.move_to(t);
        const auto h = r.read(), before = r.read(true);
        float top = 0.0f;
        for (const float v : h)
            top = std::max(top, std::abs(v));
        int front = 0;
        for (int x = 256; x < 512; ++x)
            if (std::abs(h[std::size_t(256 * 512 + x)]) > 0.3f * top)
                front = x - 256;
        double energy = 0.0;
        for (int y = 0; y < 511; ++y)
            for (int x = 0; x < 511; ++x) {
                const std::size_t i = std::size_t(y * 512 + x);
                const double v = (h[i] - before[i]) / r.step_s(),
                             c = pond.speed_m_per_s / pond.texel_m;
                energy += v * v + c * c *
                                      (double(h[i + 1] - h[i]) * (before[i + 1] - before[i]) +
                                       double(h[i + 512] - h[i]) * (before[i + 512] - before[i]));
            }
        first = first > 0.0 ? first : energy / std::exp(-2 * pond.damping_per_s * t);
        out << t << " " << front * pond.texel_m << " " << energy / first << " "
            << std::exp(-2 * pond.damping_per_s * t) << "\n";
    }
}

} // namespace

int main(int argc, char** argv) {
    try {
        if (argc != 2)
            throw Error("name a folder to write to");
        const gpu::Context context;
        std::cout << "device: " << context.renderer() << "\n";
        dispersion(argv[1]);
        spectra(argv[1]);
        trochoids(argv[1]);
        slopes(argv[1]);
        ripples(argv[1]);
        return 0;
    } catch (const std::exception& error) {
        std::cerr << "tarn_wave_study: " << error.what() << "\n";
        return 1;
    }
}
