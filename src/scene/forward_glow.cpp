#include "scene/forward_glow.hpp"

#include "core/angles.hpp"
#include "scene/lighting.hpp"
#include "scene/water_colour.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

namespace tarn::scene {

namespace {

/// Of natural water's particles: [1/sr], 1 over the sphere but for the rounding of its parameters.
double fournier_forand(double theta) {
    constexpr double n = 1.10, mu = 3.5835, nu = (3.0 - mu) / 2.0;
    const double s2 = std::pow(std::sin(0.5 * theta), 2.0);
    const double scale = 4.0 / (3.0 * (n - 1.0) * (n - 1.0));
    const double off = scale * s2 - 1.0, d180 = scale;
    const double d = std::abs(off) < 1e-5 ? 1.0 + 1e-5 : scale * s2; // at 1 the form is 0 / 0
    const double dn = std::pow(d, nu), d180n = std::pow(d180, nu);
    const double peak = nu * (1.0 - d) - (1.0 - dn) + (d * (1.0 - dn) - nu * (1.0 - d)) / s2;
    return peak / (4.0 * pi * (1.0 - d) * (1.0 - d) * dn) +
           (1.0 - d180n) / (16.0 * pi * (d180 - 1.0) * d180n) *
               (3.0 * std::cos(theta) * std::cos(theta) - 1.0);
}

/// Angles crowded towards nothing, where the phase function has its peak, with their solid angles.
struct Rule {
    std::vector<double> theta, solid_angle;
};

Rule angles_of_half_sphere() {
    constexpr int count = 6000;
    Rule rule;
    for (int i = 0; i < count; ++i) {
        const double t = (i + 0.5) / count, theta = 0.5 * pi * t * t * t;
        rule.theta.push_back(theta);
        rule.solid_angle.push_back(2.0 * pi * std::sin(theta) * 0.5 * pi * 3.0 * t * t / count);
    }
    return rule;
}

/// The even part that goes both ways alike: what comes back at a right angle.
double peaked_part(double theta) {
    static const double even = fournier_forand(0.5 * pi);
    return theta < 0.5 * pi ? std::max(fournier_forand(std::max(theta, 1e-7)) - even, 0.0) : 0.0;
}

double peaked_sum() {
    static const double sum = [] {
        const Rule rule = angles_of_half_sphere();
        double s = 0.0;
        for (std::size_t i = 0; i < rule.theta.size(); ++i)
            s += rule.solid_angle[i] * peaked_part(rule.theta[i]);
        return s;
    }();
    return sum;
}

// Moments beyond these say nothing once the sun's own width has blurred them.
constexpr int moments = 1400;

/// P_l at each of some cosines: each(l, values), l from 0 on.
template <class Each>
void legendre(const std::vector<double>& cosines, Each&& each) {
    std::vector<double> before(cosines.size(), 1.0), now = cosines;
    for (int l = 0; l < moments; ++l) {
        each(l, before);
        for (std::size_t i = 0; i < cosines.size(); ++i) {
            const double next = ((2 * l + 3) * cosines[i] * now[i] - (l + 1) * before[i]) / (l + 2);
            before[i] = now[i];
            now[i] = next;
        }
    }
}

/// Legendre moments of what lies at some angles with some weights.
std::vector<double> moments_of(const std::vector<double>& theta,
                               const std::vector<double>& weight) {
    std::vector<double> cosines, out(moments);
    for (const double angle : theta)
        cosines.push_back(std::cos(angle));
    legendre(cosines, [&](int l, const std::vector<double>& p) {
        for (std::size_t i = 0; i < weight.size(); ++i)
            out[std::size_t(l)] += weight[i] * p[i];
    });
    return out;
}

const std::vector<double>& phase_moments() {
    static const std::vector<double> out = [] {
        const Rule rule = angles_of_half_sphere();
        std::vector<double> weight;
        for (std::size_t i = 0; i < rule.theta.size(); ++i)
            weight.push_back(rule.solid_angle[i] * forward_phase(rule.theta[i]));
        return moments_of(rule.theta, weight);
    }();
    return out;
}

/// @param light  moments of where the light comes from, before anything is scattered
GlowTable make_table(const std::vector<double>& light) {
    GlowTable out;
    const std::vector<double>& phase = phase_moments();
    std::vector<double> sum(std::size_t(out.angles) * out.depths), cosines;
    for (int c = 0; c < out.angles; ++c)
        cosines.push_back(std::cos(out.angle_rad(c)));
    legendre(cosines, [&](int l, const std::vector<double>& p) {
        for (int r = 0; r < out.depths; ++r) {
            const double tau = out.tau(r), m = phase[std::size_t(l)];
            const double scattered = tau > 0.0 ? std::exp(-tau) * std::expm1(tau * m) / tau : m;
            const double factor = (2 * l + 1) / (4.0 * pi) * scattered * light[std::size_t(l)];
            for (int c = 0; c < out.angles; ++c)
                sum[std::size_t(r * out.angles + c)] += factor * p[std::size_t(c)];
        }
    });
    for (int i = 0; i < out.angles * out.depths; ++i) {
        const double t =
            std::clamp((90.0 - out.angle_rad(i % out.angles) / degree) / 20.0, 0.0, 1.0);
        out.h.push_back(float(std::max(sum[std::size_t(i)], 0.0) * t * t * (3.0 - 2.0 * t)));
    }
    return out;
}

} // namespace

double forward_phase(double theta) { return peaked_part(theta) / peaked_sum(); }

double GlowTable::angle_rad(int column) {
    return least_rad * std::expm1(std::log1p(pi / least_rad) * column / (angles - 1));
}

double GlowTable::tau(int row) {
    return least_tau * std::expm1(std::log1p(greatest_tau / least_tau) * row / (depths - 1));
}

double GlowTable::row_of(double tau_here) {
    return std::clamp(std::log1p(tau_here / least_tau) / std::log1p(greatest_tau / least_tau), 0.0,
                      1.0) *
           (depths - 1);
}

double GlowTable::column_of(double theta) {
    return std::clamp(std::log1p(theta / least_rad) / std::log1p(pi / least_rad), 0.0, 1.0) *
           (angles - 1);
}

double GlowTable::at_place(double x, double y) const {
    const int column = std::min(int(x), angles - 2), row = std::min(int(y), depths - 2);
    const float* entry = h.data() + std::size_t(row * angles + column);
    return std::lerp(std::lerp(double(entry[0]), double(entry[1]), x - column),
                     std::lerp(double(entry[angles]), double(entry[angles + 1]), x - column),
                     y - row);
}

const GlowTable& glow_table() {
    static const GlowTable table = [] {
        std::vector<double> disc;
        for (int l = 0; l < moments; ++l)
            disc.push_back(std::exp(-0.5 * l * (l + 1) * sun_radius_rad * sun_radius_rad));
        return make_table(disc);
    }();
    return table;
}

const GlowTable& sky_glow_table(double index) {
    static std::mutex guard;
    static std::map<double, GlowTable> made; // references into it stay
    const std::scoped_lock lock(guard);
    if (const auto known = made.find(index); known != made.end())
        return known->second;
    // Crowded towards the window's rim, where its radiance falls to nothing like a root.
    constexpr int count = 2000;
    const double rim = std::asin(1.0 / index);
    std::vector<double> theta, weight;
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        const double t = (i + 0.5) / count, angle = rim * (1.0 - t * t);
        theta.push_back(angle);
        weight.push_back((1.0 - reflectance_from_below(std::cos(angle), index)) * std::sin(angle) *
                         t);
        sum += weight.back();
    }
    for (double& w : weight)
        w /= sum;
    return made.emplace(index, make_table(moments_of(theta, weight))).first->second;
}

} // namespace tarn::scene
