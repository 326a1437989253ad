#include "reference/caustics.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <mutex>
#include <random>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tarn::reference {

Photon photon_below(glm::dvec3 sun, glm::dvec2 slope, double index, bool schlick) {
    // By the plane of incidence instead of the GPU's vectors: angles, then the part along the facet.
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

std::vector<double> sunlight_by_photons(const SurfaceFunction& surface, const PhotonLight& light,
                                        const SunlitSquare& square, double depth_m) {
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
        margin = int(std::ceil((depth_m + 1.0) * reach / texel)) + 2;
    }
    const int m = light.photons_a_side;
    std::vector<double> sum(std::size_t(n) * std::size_t(n), 0.0);
    std::mutex adding;
    const glm::dvec3 side_of_sun = glm::normalize(
        std::abs(light.sun.z) < 0.9 ? glm::cross(light.sun, glm::dvec3(0, 0, 1))
                                    : glm::cross(light.sun, glm::dvec3(1, 0, 0)));
    const glm::dvec3 top_of_sun = glm::cross(light.sun, side_of_sun);
    tbb::parallel_for(tbb::blocked_range<int>(-margin, n + margin, 8), [&](const auto& rows) {
        std::vector<double> own(sum.size(), 0.0);
        for (int row = rows.begin(); row < rows.end(); ++row) {
            std::mt19937_64 random(std::uint64_t(row + 100'000));
            std::uniform_real_distribution<double> even(0.0, 1.0);
            for (int col = -margin; col < n + margin; ++col)
                for (int k = 0; k < m * m; ++k) {
                    const glm::dvec2 in_texel((k % m + even(random)) / m,
                                              (k / m + even(random)) / m);
                    const glm::dvec2 at = square.corner_m + texel * (glm::dvec2(col, row) + in_texel);
                    const SurfacePoint s = surface(at);
                    glm::dvec3 sun = light.sun;
                    if (light.disc_rad > 0.0) {
                        const double r = light.disc_rad * std::sqrt(even(random)),
                                     a = 6.283185307179586 * even(random);
                        sun = glm::normalize(sun + r * (std::cos(a) * side_of_sun +
                                                        std::sin(a) * top_of_sun));
                    }
                    const Photon p = photon_below(sun, s.slope, light.index, light.schlick);
                    const glm::dvec2 lands =
                        at + std::max(depth_m + s.height_m, 0.0) * p.lean - depth_m * straight;
                    const glm::dvec2 in = (lands - square.corner_m) / texel;
                    long x = long(std::floor(in.x)), y = long(std::floor(in.y));
                    if (square.periodic) {
                        x = ((x % n) + n) % n;
                        y = ((y % n) + n) % n;
                    } else if (x < 0 || y < 0 || x >= n || y >= n) {
                        continue;
                    }
                    own[std::size_t(y) * std::size_t(n) + std::size_t(x)] += p.share;
                }
        }
        const std::lock_guard lock(adding);
        for (std::size_t i = 0; i < sum.size(); ++i)
            sum[i] += own[i];
    });
    for (double& v : sum)
        v /= double(m * m);
    return sum;
}

} // namespace tarn::reference
