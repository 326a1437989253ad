#include "reference/caustics.hpp"

#include "core/checksum.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <mutex>
#include <random>
#include <sstream>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tarn::reference {

Photon photon_below(glm::dvec3 sun, glm::dvec2 slope, double index, bool schlick) {
    // By the plane of incidence instead of the GPU's vectors: angles, then the part along the
    // facet.
    const glm::dvec3 normal = glm::normalize(glm::dvec3(-slope.x, -slope.y, 1.0));
    const double cosine = glm::dot(sun, normal);
    if (!(cosine > 0.0))
        return {};
    const double eta = 1.0 / index;
    const glm::dvec3 along = cosine * normal - sun; // length: sine of incidence
    const double sine = glm::length(along) / index, deep = std::cos(std::asin(sine));
    const glm::dvec3 down = along / index - deep * normal;
    if (!(down.z < -0.05))
        return {};
    const auto mirror = [&](double c) {
        return schlick ? fresnel_schlick(c, eta) : fresnel_dielectric(c, eta);
    };
    const double area = 1.0 / normal.z; // of facet over a horizontal metre
    return {glm::dvec2(down.x, down.y) / -down.z,
            (1.0 - mirror(cosine)) * cosine * area / ((1.0 - mirror(sun.z)) * sun.z)};
}

SurfaceFunction tabulated(const SurfaceFunction& surface, glm::dvec2 corner_m, double side_m,
                          int nodes) {
    auto table = std::make_shared<std::vector<glm::dvec3>>(std::size_t(nodes) * std::size_t(nodes));
    tbb::parallel_for(0, nodes, [&](int row) {
        for (int col = 0; col < nodes; ++col) {
            const SurfacePoint p = surface(corner_m + side_m / nodes * glm::dvec2(col, row));
            (*table)[std::size_t(row) * std::size_t(nodes) + std::size_t(col)] = {
                p.height_m, p.slope.x, p.slope.y};
        }
    });
    return [=](glm::dvec2 at) {
        const glm::dvec2 in = (at - corner_m) * (nodes / side_m), low = glm::floor(in);
        double wx[4], wy[4];
        const auto weights = [](double t, double* w) { // Catmull & Rom
            w[0] = 0.5 * t * (-1.0 + t * (2.0 - t));
            w[1] = 0.5 * (2.0 + t * t * (-5.0 + 3.0 * t));
            w[2] = 0.5 * t * (1.0 + t * (4.0 - 3.0 * t));
            w[3] = 0.5 * t * t * (t - 1.0);
        };
        weights(in.x - low.x, wx);
        weights(in.y - low.y, wy);
        const auto wrap = [nodes](long i) { return std::size_t(((i % nodes) + nodes) % nodes); };
        glm::dvec3 sum(0.0);
        for (int j = 0; j < 4; ++j) {
            const std::size_t row = wrap(long(low.y) + j - 1) * std::size_t(nodes);
            for (int i = 0; i < 4; ++i)
                sum += wx[i] * wy[j] * (*table)[row + wrap(long(low.x) + i - 1)];
        }
        return SurfacePoint{sum.x, {sum.y, sum.z}};
    };
}

std::vector<std::vector<double>> sunlight_by_photons(const SurfaceFunction& surface,
                                                     const PhotonLight& light,
                                                     const SunlitSquare& square,
                                                     const std::vector<double>& depths_m) {
    const double deepest_m = *std::max_element(depths_m.begin(), depths_m.end());
    const int n = square.texels;
    const double texel = square.side_m / n;
    const glm::dvec2 straight = photon_below(light.sun, {0, 0}, light.index, light.schlick).lean;
    int margin = 0; // texels that light comes in from beside the square
    if (!square.periodic) {
        const double most = std::min(light.steepest, 2.0);
        double reach = 0.0;
        for (int k = 0; k < 16; ++k) {
            const double a = k * 0.39269908169872414;
            const Photon p = photon_below(light.sun, most * glm::dvec2(std::cos(a), std::sin(a)),
                                          light.index, light.schlick);
            if (p.share > 0.0)
                reach = std::max(reach, glm::length(p.lean - straight));
        }
        margin = int(std::ceil((deepest_m + 1.0) * reach / texel)) + 2;
    }
    const int m = light.photons_a_side;
    const std::size_t texels = std::size_t(n) * std::size_t(n);
    std::vector<double> sum(texels * depths_m.size(), 0.0); // a plane after the other
    std::mutex adding;
    const glm::dvec3 side_of_sun =
        glm::normalize(std::abs(light.sun.z) < 0.9 ? glm::cross(light.sun, glm::dvec3(0, 0, 1))
                                                   : glm::cross(light.sun, glm::dvec3(1, 0, 0)));
    const glm::dvec3 top_of_sun = glm::cross(light.sun, side_of_sun);
    tbb::parallel_for(
        tbb::blocked_range<int>(-margin, n + margin, std::max(8, n / 8)), [&](const auto& rows) {
            std::vector<double> own(sum.size(), 0.0);
            for (int row = rows.begin(); row < rows.end(); ++row) {
                std::mt19937_64 random(std::uint64_t(row + 100'000) +
                                       (std::uint64_t(light.seed) << 32));
                std::uniform_real_distribution<double> even(0.0, 1.0);
                for (int col = -margin; col < n + margin; ++col)
                    for (int k = 0; k < m * m; ++k) {
                        const glm::dvec2 in_texel((k % m + even(random)) / m,
                                                  (k / m + even(random)) / m);
                        const glm::dvec2 at =
                            square.corner_m + texel * (glm::dvec2(col, row) + in_texel);
                        const SurfacePoint s = surface(at);
                        glm::dvec3 sun = light.sun;
                        if (light.disc_rad > 0.0) {
                            const double r = light.disc_rad * std::sqrt(even(random)),
                                         a = 6.283185307179586 * even(random);
                            sun = glm::normalize(
                                sun + r * (std::cos(a) * side_of_sun + std::sin(a) * top_of_sun));
                        }
                        const Photon p = photon_below(sun, s.slope, light.index, light.schlick);
                        for (std::size_t plane = 0; plane < depths_m.size(); ++plane) {
                            const double depth_m = depths_m[plane];
                            const glm::dvec2 lands = at +
                                                     std::max(depth_m + s.height_m, 0.0) * p.lean -
                                                     depth_m * straight;
                            const glm::dvec2 in = (lands - square.corner_m) / texel;
                            long x = long(std::floor(in.x)), y = long(std::floor(in.y));
                            if (square.periodic) {
                                x = ((x % n) + n) % n;
                                y = ((y % n) + n) % n;
                            } else if (x < 0 || y < 0 || x >= n || y >= n) {
                                continue;
                            }
                            own[plane * texels + std::size_t(y) * std::size_t(n) +
                                std::size_t(x)] += p.share;
                        }
                    }
            }
            const std::lock_guard lock(adding);
            for (std::size_t i = 0; i < sum.size(); ++i)
                sum[i] += own[i];
        });
    std::vector<std::vector<double>> planes;
    for (std::size_t plane = 0; plane < depths_m.size(); ++plane) {
        const auto first = sum.begin() + std::ptrdiff_t(plane * texels);
        planes.emplace_back(first, first + std::ptrdiff_t(texels));
        for (double& v : planes.back())
            v /= double(m * m);
    }
    return planes;
}

std::vector<double> sunlight_by_photons(const SurfaceFunction& surface, const PhotonLight& light,
                                        const SunlitSquare& square, double depth_m) {
    return sunlight_by_photons(surface, light, square, std::vector<double>{depth_m}).front();
}

SunTiles::SunTiles(const waves::Sea& sea, double time_s, const PhotonLight& light,
                   double deepest_m) {
    const auto lean = [&](glm::dvec2 slope) {
        return photon_below(light.sun, slope, light.index, light.schlick).lean;
    };
    beam_ = lean({0, 0});
    const double step = 1e-4;
    const glm::dvec2 by_x = (lean({step, 0}) - lean({-step, 0})) / (2.0 * step);
    const glm::dvec2 by_y = (lean({0, step}) - lean({0, -step})) / (2.0 * step);
    const double bend2 = 0.5 * (glm::dot(by_x, by_x) + glm::dot(by_y, by_y));
    const double disc = light.disc_rad / light.index;
    disc_variance_ = 0.25 * disc * disc * (1.0 + glm::dot(beam_, beam_));
    const waves::SlopeCovariance& r = sea.roughness;
    rough_variance_ = 0.5 * (r.xx * glm::dot(by_x, by_x) + 2.0 * r.xy * glm::dot(by_x, by_y) +
                             r.yy * glm::dot(by_y, by_y));
    for (std::size_t j = 0; j < sea.cascades.size(); ++j) {
        const waves::Cascade& c = sea.cascades[j];
        Cascade out{.patch_m = c.patch_m,
                    .first_m = 1.0,
                    .slices_a_doubling = 2.5,
                    .lean_variance = 0.5 * bend2 * c.moments.slope(),
                    .window = c.window,
                    .corner_m = c.corner_m,
                    .slices = {}};
        if (!c.ripples) {
            finest_ = j;
            waves::Sea one = sea;
            one.cascades = {c};
            one.sines.clear();
            std::fill(one.amplitude.values.begin(), one.amplitude.values.end(),
                      std::array<std::uint8_t, waves::most_cascades>{255, 255, 255, 255});
            const WaveSurface surface(one, time_s);
            const auto table = tabulated(
                [&](glm::dvec2 p) {
                    return SurfacePoint{surface.height_m(p, 1e6), surface.slope(p, 1e6)};
                },
                {0, 0}, c.patch_m, c.texels);
            // Depth where the waves focus, by the curvature of the surface itself.
            double curvature = 0.0;
            const double h = c.texel_m();
            for (int k = 0; k < 4096; ++k) {
                const glm::dvec2 p(c.patch_m * (k % 64) / 64.0, c.patch_m * (k / 64) / 64.0);
                const double xx =
                    (table(p + glm::dvec2(h, 0)).slope.x - table(p - glm::dvec2(h, 0)).slope.x) /
                    (2.0 * h);
                const double yy =
                    (table(p + glm::dvec2(0, h)).slope.y - table(p - glm::dvec2(0, h)).slope.y) /
                    (2.0 * h);
                curvature += (xx + yy) * (xx + yy) / 4096.0;
            }
            const double focus = 1.0 / std::max(std::sqrt(bend2 * curvature), 1e-3);
            side_ = c.texels / 2;
            out.first_m = focus / 10.0;
            const double doublings =
                std::min(std::log2(200.0), std::log2(std::max(2.0 * deepest_m / out.first_m, 2.0)));
            PhotonLight even = light;
            even.disc_rad = 0.0; // blurred with the rest
            even.photons_a_side = 8;
            std::vector<double> depths_m;
            for (int k = 0; k <= int(std::ceil(doublings * out.slices_a_doubling)); ++k)
                depths_m.push_back(out.first_m * std::exp2(k / out.slices_a_doubling));
            out.slices = sunlight_by_photons(
                table, even, {.corner_m = {0, 0}, .side_m = c.patch_m, .texels = side_}, depths_m);
        }
        cascades_.push_back(std::move(out));
    }
}

double SunTiles::focus(glm::dvec2 at_m, double depth_m, const std::vector<double>& amplitude,
                       const std::function<double()>& random) const {
    const glm::dvec2 straight = at_m - depth_m * beam_;
    double variance = disc_variance_ + rough_variance_ * amplitude[finest_] * amplitude[finest_],
           product = 1.0;
    for (std::size_t j = cascades_.size(); j-- > 0;) {
        const Cascade& c = cascades_[j];
        const double weak = amplitude[j] * depth_m;
        if (!c.slices.empty() && weak > 0.0) {
            // A normal draw on both axes (Box & Muller 1958).
            const double radius =
                depth_m * std::sqrt(variance) * std::sqrt(-2.0 * std::log(1.0 - random()));
            const double turn = 6.283185307179586 * random();
            const glm::dvec2 p = (straight + radius * glm::dvec2(std::cos(turn), std::sin(turn))) /
                                     c.patch_m * double(side_) -
                                 0.5;
            const double place = std::clamp(std::log2(weak / c.first_m) * c.slices_a_doubling, 0.0,
                                            double(c.slices.size()) - 1.001);
            const double x0 = std::floor(p.x), y0 = std::floor(p.y);
            const auto at = [&](std::size_t slice) {
                const auto wrap = [this](double v) {
                    return std::size_t(((long(v) % side_) + side_) % side_);
                };
                const auto value = [&](double x, double y) {
                    return c.slices[slice][wrap(y) * std::size_t(side_) + wrap(x)];
                };
                return std::lerp(std::lerp(value(x0, y0), value(x0 + 1, y0), p.x - x0),
                                 std::lerp(value(x0, y0 + 1), value(x0 + 1, y0 + 1), p.x - x0),
                                 p.y - y0);
            };
            const std::size_t low = std::size_t(place);
            const double value = std::lerp(at(low), at(low + 1), place - double(low));
            product *= 1.0 + std::min(weak / c.first_m, 1.0) * (value - 1.0);
        }
        variance += c.lean_variance * amplitude[j] * amplitude[j];
    }
    return product;
}

namespace {

/// Everything that sunlight below waves depends on, in a string.
std::string mark_of(const waves::Sea& sea, double time_s, const PhotonLight& light,
                    double deepest_m) {
    Checksum sum;
    const auto add = [&sum](const auto& values) {
        sum.add(values.data(), values.size() * sizeof values[0]);
    };
    std::ostringstream out;
    out.precision(17);
    const auto word = [&out](double v) { out << v << ' '; };
    for (const double v :
         {time_s, deepest_m, light.sun.x, light.sun.y, light.sun.z, light.index, light.disc_rad,
          light.schlick ? 1.0 : 0.0, double(light.photons_a_side), double(light.seed),
          light.steepest, sea.full_depth_m, sea.bound_m, sea.roughness.xx, sea.roughness.xy,
          sea.roughness.yy, sea.settings.loop_s})
        word(v);
    for (const waves::Cascade& c : sea.cascades) {
        for (const double v :
             {c.patch_m, double(c.texels), c.choppiness, double(c.ripples), double(c.window),
              c.corner_m.x, c.corner_m.y, c.bound_m, c.moments.slope_along, c.moments.slope_across})
            word(v);
        add(c.mask);
        add(c.h0);
        add(c.turns);
    }
    for (const waves::SineWave& w : sea.sines)
        for (const double v : {w.k_per_m.x, w.k_per_m.y, w.amplitude_m, w.omega_per_s, w.phase_rad})
            word(v);
    out << sum.value();
    return out.str();
}

} // namespace

std::shared_ptr<const SunTiles> shared_sun_tiles(const waves::Sea& sea, double time_s,
                                                 const PhotonLight& light, double deepest_m) {
    static std::mutex guard;
    static std::string known;
    static std::shared_ptr<const SunTiles> kept;
    const std::scoped_lock lock(guard);
    const std::string mark = mark_of(sea, time_s, light, deepest_m);
    if (mark != known) {
        kept = std::make_shared<const SunTiles>(sea, time_s, light, deepest_m);
        known = mark;
    }
    return kept;
}

} // namespace tarn::reference
