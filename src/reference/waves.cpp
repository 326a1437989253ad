#include "reference/waves.hpp"

#include "core/angles.hpp"
#include "reference/fft.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::reference {

namespace {

/// Weights of the cubic through four neighbours (Catmull & Rom), t in [0, 1) behind the second.
std::array<double, 4> cubic_weights(double t) {
    return {0.5 * t * (-1.0 + t * (2.0 - t)), 0.5 * (2.0 + t * t * (-5.0 + 3.0 * t)),
            0.5 * t * (1.0 + t * (4.0 - 3.0 * t)), 0.5 * t * t * (t - 1.0)};
}

} // namespace

WaveFields wave_fields(const waves::Cascade& c, double time_s, double loop_s, int finer) {
    const int n = c.texels, m = n * finer;
    const double dk = 2.0 * pi / c.patch_m, turn = std::fmod(time_s, loop_s) / loop_s;
    // Two real fields in one transform, each from its own Hermitian spectrum.
    std::vector<Complex> spectra[4];
    for (auto& s : spectra)
        s.assign(std::size_t(m) * std::size_t(m), Complex(0.0));
    const Complex i(0.0, 1.0);
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const std::size_t from = std::size_t(y) * std::size_t(n) + std::size_t(x);
            const glm::vec4& h0 = c.h0[from];
            const int kx = x < n / 2 ? x : x - n, ky = y < n / 2 ? y : y - n;
            const double phase = 2.0 * pi * std::fmod(turn * c.turns[from], 1.0);
            const Complex h = Complex(h0.x, h0.y) * std::exp(-i * phase) +
                              Complex(h0.z, h0.w) * std::exp(i * phase);
            const double px = dk * kx, py = dk * ky, k = std::hypot(px, py);
            const double per = k > 0.0 ? 1.0 / k : 0.0;
            const std::size_t to =
                std::size_t((ky + m) % m) * std::size_t(m) + std::size_t((kx + m) % m);
            spectra[0][to] = h + i * (i * px * h);
            spectra[1][to] = i * py * h + i * (i * px * per * h);
            spectra[2][to] = i * py * per * h + i * (-px * px * per * h);
            spectra[3][to] = -px * py * per * h + i * (-py * py * per * h);
        }
    WaveFields out;
    out.side = m;
    std::vector<double>* fields[8] = {&out.height, &out.slope_x, &out.slope_y, &out.dx,
                                      &out.dy,     &out.dxx,     &out.dxy,     &out.dyy};
    for (int f = 0; f < 4; ++f) {
        const std::vector<Complex> both = fft_inverse_2d(std::move(spectra[f]), m);
        fields[2 * f]->reserve(both.size());
        fields[2 * f + 1]->reserve(both.size());
        for (const Complex& v : both) {
            fields[2 * f]->push_back(v.real());
            fields[2 * f + 1]->push_back(v.imag());
        }
    }
    return out;
}

WaveSurface::WaveSurface(const waves::Sea& sea, double time_s)
    : sea_(sea), time_s_(time_s), bound_m_(sea.bound_m), step_m_(1e9) {
    for (const waves::Cascade& c : sea.cascades) {
        if (c.ripples) { // counted as roughness by the tracer
            lattices_.emplace_back();
            continue;
        }
        const WaveFields f = wave_fields(c, time_s, sea.settings.loop_s, 2);
        step_m_ = std::min(step_m_, 0.05 * c.texel_m());
        double most = 0.0; // of the displaced surface; a fifth more for what lies between nodes
        Lattice& lattice = lattices_.emplace_back(Lattice{.side = f.side, .nodes = {}});
        lattice.nodes.reserve(f.height.size());
        for (std::size_t i = 0; i < f.height.size(); ++i) {
            const double xx = 1.0 + c.choppiness * f.dxx[i], yy = 1.0 + c.choppiness * f.dyy[i],
                         xy = c.choppiness * f.dxy[i];
            const double determinant = std::max(xx * yy - xy * xy, 0.05);
            most = std::max(most, std::hypot(yy * f.slope_x[i] - xy * f.slope_y[i],
                                             xx * f.slope_y[i] - xy * f.slope_x[i]) /
                                      determinant);
            lattice.nodes.push_back({f.height[i], f.slope_x[i], f.slope_y[i], f.dx[i], f.dy[i],
                                     f.dxx[i], f.dxy[i], f.dyy[i]});
        }
        steepest_ += 1.2 * most;
    }
    for (const waves::SineWave& w : sea.sines) {
        const double k = std::hypot(w.k_per_m.x, w.k_per_m.y);
        step_m_ = std::min(step_m_, 0.01 / k);
        steepest_ += w.amplitude_m * k;
    }
}

double WaveSurface::share(glm::dvec2 place, std::size_t cascade) const {
    const GridSize size = sea_.amplitude.size;
    const double side = sea_.amplitude_side_m;
    const double col =
        std::clamp((place.x - sea_.amplitude_west_m) / side - 0.5, 0.0, size.cols - 1.0);
    const double row =
        std::clamp((sea_.amplitude_north_m - place.y) / side - 0.5, 0.0, size.rows - 1.0);
    const int c = std::min(int(col), size.cols - 1), r = std::min(int(row), size.rows - 1);
    const int c1 = std::min(c + 1, size.cols - 1), r1 = std::min(r + 1, size.rows - 1);
    const auto at = [&](int x, int y) { return sea_.amplitude[{x, y}][cascade] / 255.0; };
    return std::lerp(std::lerp(at(c, r), at(c1, r), col - c),
                     std::lerp(at(c, r1), at(c1, r1), col - c), row - r);
}

std::array<double, 8> WaveSurface::Lattice::at(double x, double y) const {
    const double fx = std::floor(x), fy = std::floor(y);
    const std::array<double, 4> wx = cubic_weights(x - fx), wy = cubic_weights(y - fy);
    const long mask = side - 1;
    std::array<double, 8> sum{};
    for (long j = 0; j < 4; ++j) {
        const std::array<double, 8>* row = &nodes[std::size_t(((long(fy) + j - 1) & mask) * side)];
        for (long i = 0; i < 4; ++i) {
            const std::array<double, 8>& node = row[(long(fx) + i - 1) & mask];
            const double weight = wx[std::size_t(i)] * wy[std::size_t(j)];
            for (std::size_t k = 0; k < 8; ++k)
                sum[k] += weight * node[k];
        }
    }
    return sum;
}

WaveSurface::Sample WaveSurface::at(std::size_t number, glm::dvec2 place) const {
    const waves::Cascade& c = sea_.cascades[number];
    const Lattice& lattice = lattices_[number];
    const double per_m = lattice.side / c.patch_m, chop = c.choppiness;
    glm::dvec2 p = place; // the point that is now over the place
    auto [height, sx, sy, dx, dy, dxx, dxy, dyy] = lattice.at(p.x * per_m, p.y * per_m);
    double xx = 1.0, xy = 0.0, yy = 1.0;
    for (int i = 0; i < 20 && chop > 0.0; ++i) {
        xx = 1.0 + chop * dxx;
        xy = chop * dxy;
        yy = 1.0 + chop * dyy;
        const double ex = place.x - p.x - chop * dx, ey = place.y - p.y - chop * dy;
        const double determinant = std::max(xx * yy - xy * xy, 0.05);
        p += glm::dvec2(yy * ex - xy * ey, xx * ey - xy * ex) / determinant;
        const std::array<double, 8> next = lattice.at(p.x * per_m, p.y * per_m);
        height = next[0], sx = next[1], sy = next[2], dx = next[3], dy = next[4], dxx = next[5],
        dxy = next[6], dyy = next[7];
        if (std::hypot(ex, ey) < 1e-9 * c.patch_m)
            break;
    }
    const double determinant = std::max(xx * yy - xy * xy, 0.0025);
    return {std::clamp(height, -c.bound_m, c.bound_m),
            {(yy * sx - xy * sy) / determinant, (xx * sy - xy * sx) / determinant}};
}

WaveSurface::Sample WaveSurface::sum(glm::dvec2 place, double depth_m) const {
    const double fade = std::clamp(depth_m / std::max(sea_.full_depth_m, 1e-6), 0.0, 1.0);
    Sample out{0.0, glm::dvec2(0.0)};
    for (std::size_t j = 0; j < sea_.cascades.size(); ++j) {
        const double a = fade * share(place, j);
        if (!(a > 0.0) || sea_.cascades[j].ripples)
            continue;
        const Sample s = at(j, place);
        out.height += a * s.height;
        out.slope += a * s.slope;
    }
    for (const waves::SineWave& w : sea_.sines) {
        const double a = fade * share(place, 0) * w.amplitude_m;
        const double phase = w.k_per_m.x * place.x + w.k_per_m.y * place.y + w.phase_rad -
                             std::fmod(w.omega_per_s * time_s_, 2.0 * pi);
        out.height += a * std::cos(phase);
        out.slope -= a * std::sin(phase) * w.k_per_m;
    }
    return out;
}

double WaveSurface::finest_share(glm::dvec2 place, double depth_m) const {
    std::size_t finest = 0;
    for (std::size_t j = 0; j < sea_.cascades.size(); ++j)
        if (!sea_.cascades[j].ripples)
            finest = j;
    return std::clamp(depth_m / std::max(sea_.full_depth_m, 1e-6), 0.0, 1.0) * share(place, finest);
}

std::vector<double> WaveSurface::shares(glm::dvec2 place, double depth_m) const {
    const double fade = std::clamp(depth_m / std::max(sea_.full_depth_m, 1e-6), 0.0, 1.0);
    std::vector<double> out;
    for (std::size_t j = 0; j < sea_.cascades.size(); ++j)
        out.push_back(fade * share(place, j));
    return out;
}

double WaveSurface::height_m(glm::dvec2 place, double depth_m) const {
    return sum(place, depth_m).height;
}
glm::dvec2 WaveSurface::slope(glm::dvec2 place, double depth_m) const {
    return sum(place, depth_m).slope;
}

} // namespace tarn::reference
