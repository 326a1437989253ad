// The glow around the sun seen from below, against photons that are scattered one by one.
#include "core/angles.hpp"
#include "reference/medium.hpp"
#include "scene/forward_glow.hpp"
#include "scene/water_colour.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;
using namespace tarn::scene;

namespace {

/// Draws angles by the phase function alone.
class Scatterer {
public:
    Scatterer() {
        for (int i = 0; i <= pieces; ++i)
            angle_.push_back(0.5 * M_PI * std::pow(double(i) / pieces, 3.0));
        below_.push_back(0.0);
        for (int i = 0; i < pieces; ++i) {
            double sum = 0.0;
            for (int k = 0; k < 8; ++k) {
                const double a = std::lerp(angle_[i], angle_[i + 1], (k + 0.5) / 8);
                sum +=
                    forward_phase(a) * 2.0 * M_PI * std::sin(a) * (angle_[i + 1] - angle_[i]) / 8;
            }
            below_.push_back(below_.back() + sum);
        }
    }
    double sum() const { return below_.back(); }
    double angle(double share) const {
        const auto next = std::upper_bound(below_.begin(), below_.end(), share * sum());
        const auto i = std::size_t(std::clamp<long>(next - below_.begin() - 1, 0, pieces - 1));
        return std::lerp(angle_[i], angle_[i + 1],
                         (share * sum() - below_[i]) / (below_[i + 1] - below_[i]));
    }

private:
    static constexpr int pieces = 4000;
    std::vector<double> angle_, below_;
};

struct Ring {
    double from_deg, to_deg;
};

/// Where light comes from below the surface, at random, and what flux it brings to a level plane,
/// for a scalar irradiance of 1.
struct Start {
    glm::dvec3 from;
    double flux;
};
using Light = std::function<Start(std::mt19937_64&)>;

Light light_of_sun(glm::dvec3 sun) {
    return [sun](std::mt19937_64&) { return Start{sun, sun.z}; };
}

/// Of an even sky, through the window in a flat surface.
Light light_of_sky() {
    constexpr double index = 1.333;
    const double rim = std::sqrt(1.0 - 1.0 / (index * index));
    double sum = 0.0;
    constexpr int n = 100'000;
    for (int i = 0; i < n; ++i)
        sum += (1.0 - reflectance_from_below(std::lerp(rim, 1.0, (i + 0.5) / n), index)) / n;
    return [rim, sum](std::mt19937_64& random) {
        std::uniform_real_distribution<double> even;
        const double cosine = std::lerp(rim, 1.0, even(random)), turn = 2.0 * M_PI * even(random),
                     sine = std::sqrt(1.0 - cosine * cosine);
        return Start{{sine * std::cos(turn), sine * std::sin(turn), cosine},
                     cosine * (1.0 - reflectance_from_below(cosine, index)) / sum};
    };
}

/// Radiance times solid angle of what was scattered, of rings around an axis at a depth, for a
/// scalar irradiance of 1 below the surface; directions flatter than `least_rise` left out.
/// Scattering is 1/m.
std::vector<double> by_photons(const std::vector<Ring>& rings, glm::dvec3 axis, const Light& light,
                               double loss_per_m, double depth_m, double least_rise, int photons) {
    const Scatterer scatterer;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> even;
    std::vector<double> sum(rings.size());
    for (int p = 0; p < photons; ++p) {
        const Start start = light(random);
        glm::dvec3 way = -start.from;
        double depth = 0.0, weight = 1.0;
        for (bool scattered = false; weight > 1e-6; scattered = true) {
            const double step = -std::log(1.0 - even(random)), next = depth - way.z * step;
            if (scattered && (depth < depth_m) != (next < depth_m) && -way.z > least_rise) {
                const double off = std::acos(std::min(glm::dot(-way, axis), 1.0)) / degree;
                const double left =
                    weight * std::exp(-loss_per_m * (depth_m - depth) / -way.z) / -way.z;
                for (std::size_t r = 0; r < rings.size(); ++r)
                    if (off > rings[r].from_deg && off < rings[r].to_deg)
                        sum[r] += left * start.flux / photons;
            }
            weight *= std::exp(-loss_per_m * step);
            depth = next;
            if (depth < 0.0 || depth > depth_m + 20.0 / (loss_per_m + 0.2))
                break;
            const double a = scatterer.angle(even(random)), turn = 2.0 * M_PI * even(random);
            const glm::dvec3 aside =
                std::abs(way.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
            const glm::dvec3 e = glm::normalize(glm::cross(way, aside)), f = glm::cross(way, e);
            way = glm::normalize(std::cos(a) * way +
                                 std::sin(a) * (std::cos(turn) * e + std::sin(turn) * f));
        }
    }
    return sum;
}

/// The model's sum over the same rings.
/// @param axis  the sun, or the vertical for the sky
std::vector<double> by_model(const std::vector<Ring>& rings, glm::dvec3 axis, bool sky,
                             double loss_per_m, double depth_m, double least_rise) {
    // Half of what is lost is scattered back, so that b_f = 1.
    WaterOptics optics;
    const double back = 0.5 * loss_per_m;
    for (const double nm : {400.0, 700.0})
        optics.bands.push_back({nm, loss_per_m - back, 1.0 + 2.0 * back, back});
    const reference::Medium medium(optics, true);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> even;
    const glm::dvec3 e(0, 1, 0), f = glm::cross(axis, e);
    constexpr int looks = 20000;
    std::vector<double> sum;
    for (const Ring& ring : rings) {
        double s = 0.0;
        const double c0 = std::cos(ring.from_deg * degree), c1 = std::cos(ring.to_deg * degree);
        for (int i = 0; i < looks; ++i) {
            const double c = std::lerp(c0, c1, even(random)), turn = 2.0 * M_PI * even(random);
            const glm::dvec3 view =
                c * axis + std::sqrt(1.0 - c * c) * (std::cos(turn) * e + std::sin(turn) * f);
            if (view.z > least_rise)
                s += (sky ? medium.sky_glow_radiance(depth_m, -view.z, 0.0, depth_m / view.z,
                                                     std::acos(c))
                          : medium.glow_radiance(1.0 / axis.z, depth_m, -view.z, 0.0,
                                                 depth_m / view.z, std::acos(c)))
                         .y *
                     2.0 * M_PI * (c0 - c1) / looks;
        }
        sum.push_back(s);
    }
    return sum;
}

} // namespace

TEST(Glow, ThePhaseFunctionIsPetzoldsInItsPeak) {
    const Scatterer scatterer;
    EXPECT_NEAR(scatterer.sum(), 1.0, 1e-3);
    EXPECT_EQ(forward_phase(91 * degree), 0.0);
    // Petzold's mean particles (Mobley 1994, table 3.10) put half of all scattering within some 5
    // degrees, and three fifths of the forward part beyond 2.5.
    double beyond = 0.0, mean_cosine = 0.0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
        const double a = scatterer.angle((i + 0.5) / n);
        beyond += a > 2.5 * degree ? 1.0 / n : 0.0;
        mean_cosine += std::cos(a) / n;
    }
    EXPECT_NEAR(beyond, scattered_wide, 0.05);
    EXPECT_NEAR(mean_cosine, 0.96, 0.02); // .924 with what comes back and goes evenly
}

// All that leaves the disc is in the glow, where it still goes forwards; of what leaves the window
// some goes beyond 70 degrees.
TEST(Glow, KeepsTheLight) {
    for (const bool sky : {false, true})
        for (const double tau : {0.1, 0.5, 1.0, 2.0}) {
            const GlowTable& table = sky ? sky_glow_table(1.333) : glow_table();
            double sum = 0.0;
            constexpr int n = 20000;
            for (int i = 0; i < n; ++i) {
                const double t = (i + 0.5) / n, a = M_PI * t * t * t;
                sum += table.at(a, tau) * tau * 2.0 * M_PI * std::sin(a) * 3.0 * M_PI * t * t / n;
            }
            EXPECT_NEAR(sum / (1.0 - std::exp(-tau)), sky ? 0.97 : 1.0, sky ? 0.025 : 0.01)
                << sky << " " << tau;
        }
}

TEST(Glow, OneScatteringIsThePhaseFunction) {
    for (const double deg : {2.0, 5.0, 20.0, 60.0})
        EXPECT_NEAR(glow_table().at(deg * degree, 0.0) / forward_phase(deg * degree), 1.0, 0.03)
            << deg;
}

TEST(Glow, AgreesWithPhotons) {
    const std::vector<Ring> rings = {{1.5, 2.5}, {4, 6}, {9, 11}, {18, 22}, {28, 32}, {40, 50}};
    double worst = 0.0;
    for (const double sun_deg : {0.0, 40.0})
        for (const double loss_per_m : {0.08, 0.6})
            for (const double tau : {0.5, 4.0}) {
                const glm::dvec3 sun(std::sin(sun_deg * degree), 0.0, std::cos(sun_deg * degree));
                const double depth = tau * sun.z, least_rise = 0.3;
                const auto photons = by_photons(rings, sun, light_of_sun(sun), loss_per_m, depth,
                                                least_rise, 40'000);
                const auto model = by_model(rings, sun, false, loss_per_m, depth, least_rise);
                for (std::size_t r = 0; r < rings.size(); ++r) {
                    worst = std::max(worst, std::abs(model[r] / photons[r] - 1.0));
                    EXPECT_NEAR(model[r] / photons[r], 1.0, 0.15)
                        << "sun " << sun_deg << ", loss " << loss_per_m << ", tau " << tau << ", "
                        << rings[r].from_deg << " degrees";
                }
            }
    std::printf("worst ring %.1f %% off\n", 100.0 * worst);
}

// The sky's, through Snell's window: inside it, over its rim at 48.6 degrees, beyond.
TEST(Glow, OfSkylightAgreesWithPhotons) {
    const std::vector<Ring> rings = {{0, 15}, {15, 30}, {30, 42}, {44, 50}, {50, 56}, {56, 66}};
    for (const double loss_per_m : {0.08, 0.6})
        for (const double tau : {0.5, 1.5, 4.0}) {
            const glm::dvec3 up(0, 0, 1);
            const auto photons =
                by_photons(rings, up, light_of_sky(), loss_per_m, tau, 0.3, 60'000);
            const auto model = by_model(rings, up, true, loss_per_m, tau, 0.3);
            std::printf("loss %.2f, tau %.1f:", loss_per_m, tau);
            for (std::size_t r = 0; r < rings.size(); ++r) {
                std::printf(" %.3f", model[r] / photons[r]);
                EXPECT_NEAR(model[r] / photons[r], 1.0, 0.12) << rings[r].from_deg << " degrees";
            }
            std::printf("\n");
        }
}
