#include "reference/waves.hpp"

#include "reference/fft.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::reference {

namespace {

constexpr double pi = 3.14159265358979323846;

/// Of a periodic lattice, by the cubic through four neighbours on each axis.
double cubic(const std::vector<double>& values, int side, double x, double y) {
    const double fx = std::floor(x), fy = std::floor(y);
    const double u = x - fx, v = y - fy;
    const auto weights = [](double t, double* w) {
        w[0] = 0.5 * t * (-1.0 + t * (2.0 - t));
        w[1] = 0.5 * (2.0 + t * t * (-5.0 + 3.0 * t));
        w[2] = 0.5 * t * (1.0 + t * (4.0 - 3.0 * t));
        w[3] = 0.5 * t * t * (t - 1.0);
    };
    double wx[4], wy[4];
    weights(u, wx);
    weights(v, wy);
    const auto wrap = [side](long i) { return std::size_t(((i % side) + side) % side); };
    double sum = 0.0;
    for (int j = 0; j < 4; ++j) {
        const std::size_t row = wrap(long(fy) + j - 1) * std::size_t(side);
        for (int i = 0; i < 4; ++i)
            sum += wx[i] * wy[j] * values[row + wrap(long(fx) + i - 1)];
    }
    return sum;
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
            fields_.emplace_back();
            continue;
        }
        fields_.push_back(wave_fields(c, time_s, sea.settings.loop_s, 2));
        step_m_ = std::min(step_m_, 0.05 * c.texel_m());
        double most = 0.0; // of the displaced surface; a fifth more for what lies between nodes
        const WaveFields& f = fields_.back();
        for (std::size_t i = 0; i < f.height.size(); ++i) {
            const double xx = 1.0 + c.choppiness * f.dxx[i], yy = 1.0 + c.choppiness * f.dyy[i],
                         xy = c.choppiness * f.dxy[i];
            const double determinant = std::max(xx * yy - xy * xy, 0.05);
            most = std::max(most, std::hypot(yy * f.slope_x[i] - xy * f.slope_y[i],
                                             xx * f.slope_y[i] - xy * f.slope_x[i]) /
                                      determinant);
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

WaveSurface::Sample WaveSurface::at(std::size_t number, glm::dvec2 place) const {
    const waves::Cascade& c = sea_.cascades[number];
    const WaveFields& f = fields_[number];
    const double per_m = f.side / c.patch_m;
    const auto look = [&](const std::vector<double>& values, glm::dvec2 p) {
        return cubic(values, f.side, p.x * per_m, p.y * per_m);
    };
    const double chop = c.choppiness;
    glm::dvec2 p = place; // the point that is now over the place
    double xx = 1.0, xy = 0.0, yy = 1.0;
    for (int i = 0; i < 20 && chop > 0.0; ++i) {
        xx = 1.0 + chop * look(f.dxx, p);
        xy = chop * look(f.dxy, p);
        yy = 1.0 + chop * look(f.dyy, p);
        const double ex = place.x - p.x - chop * look(f.dx, p),
                     ey = place.y - p.y - chop * look(f.dy, p);
        const double determinant = std::max(xx * yy - xy * xy, 0.05);
        p += glm::dvec2(yy * ex - xy * ey, xx * ey - xy * ex) / determinant;
        if (std::hypot(ex, ey) < 1e-9 * c.patch_m)
            break;
    }
    const double sx = look(f.slope_x, p), sy = look(f.slope_y, p);
    const double determinant = std::max(xx * yy - xy * xy, 0.0025);
    return {std::clamp(look(f.height, p), -c.bound_m, c.bound_m),
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
