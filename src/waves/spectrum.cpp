#include "waves/spectrum.hpp"

#include "core/angles.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::waves {

namespace {

double sech(double x) { return 1.0 / std::cosh(std::min(x, 300.0)); }

/// Of the JONSWAP shape over w = omega / omega_p: w^-5 exp(-1.25 w^-4) 3.3^r.
double shape_integral() {
    static const double value = [] {
        double sum = 0.0;
        const int steps = 20'000;
        const double low = std::log(0.3), stride = std::log(100.0 / 0.3) / steps;
        for (int i = 0; i < steps; ++i) {
            const double w = std::exp(low + (i + 0.5) * stride), width = w <= 1.0 ? 0.07 : 0.09;
            sum += std::pow(w, -4.0) * std::exp(-1.25 * std::pow(w, -4.0)) *
                   std::pow(3.3, std::exp(-0.5 * std::pow((w - 1.0) / width, 2.0))) * stride;
        }
        return sum;
    }();
    return value;
}

/// Integral over the circle of max(cos, 0)^p.
double half_circle_power(double p) {
    return std::sqrt(pi) * std::tgamma(0.5 * p + 0.5) / std::tgamma(0.5 * p + 1.0);
}

} // namespace

double omega_per_s(double k, double depth_m) {
    return std::sqrt((gravity_m_per_s2 * k * (1.0 + k * k * capillary_length2_m2)) *
                     std::tanh(std::min(k * depth_m, 300.0)));
}

double group_speed_m_per_s(double k, double depth_m) {
    const double omega = omega_per_s(k, depth_m);
    if (!(omega > 0.0))
        return 0.0;
    const double kd = std::min(k * depth_m, 300.0), t = std::tanh(kd), s = sech(kd);
    const double rise =
        gravity_m_per_s2 * (1.0 + 3.0 * k * k * capillary_length2_m2) * t +
        gravity_m_per_s2 * k * (1.0 + k * k * capillary_length2_m2) * depth_m * s * s;
    return rise / (2.0 * omega);
}

double cox_munk_slope(double wind_m_per_s) { return 0.003 + 0.00512 * wind_m_per_s; }

Spectrum::Spectrum(const Settings& settings, double fetch_m, double depth_m)
    : model_(settings.model), depth_m_(depth_m), exponent_(settings.spreading) {
    const double from = settings.wind_from_deg * pi / 180.0, wind = settings.wind_m_per_s;
    towards_ = {-std::sin(from), -std::cos(from)};
    exponent_norm_ = half_circle_power(exponent_);
    if (!(wind > 0.0) || !(depth_m > 0.0)) {
        still_ = true;
        return;
    }
    if (model_ == Model::phillips) {
        const double length = wind * wind / gravity_m_per_s2;
        peak_k_ = std::sqrt(2.0 / 3.0) / length; // of k^-3 exp(-1 / (kL)^2)
        peak_omega_ = omega_per_s(peak_k_, depth_m);
    } else {
        // Beyond this fetch the sea is fully grown: omega_p = .855 g / U.
        const double grown = std::pow(22.0 / 0.855, 3.0);
        const double fetch = std::min(gravity_m_per_s2 * fetch_m / (wind * wind), grown);
        // Energy by the growth that was measured; the formula for alpha fitted beside it, .076
        // fetch^-.22, gives up to a third too much height where the sea is nearly grown.
        const double variance =
            1.6e-7 * fetch * std::pow(wind, 4.0) / std::pow(gravity_m_per_s2, 2.0);
        peak_omega_ = 22.0 * std::cbrt(1.0 / fetch) * gravity_m_per_s2 / wind;
        alpha_ = variance * std::pow(peak_omega_, 4.0) /
                 (std::pow(gravity_m_per_s2, 2.0) * shape_integral());
        peak_k_ = peak_omega_ * peak_omega_ / gravity_m_per_s2;
        if (model_ == Model::tma) // the peak keeps its period and shortens
            for (int i = 0; i < 100; ++i)
                peak_k_ = 0.5 * peak_k_ + 0.5 * peak_omega_ * peak_omega_ /
                                              (gravity_m_per_s2 * std::tanh(peak_k_ * depth_m));
    }
    still_ = !(peak_k_ < 0.5 * greatest_k_per_m);
    if (still_)
        return;
    if (settings.shortest_m) {
        cutoff_m_ = *settings.shortest_m / (2.0 * pi);
    } else {
        // exp(-k^2 l^2) with the l that leaves the mean square slope which Cox & Munk measured at
        // this wind: no more small waves than there are.
        double low = 1e-4, high = 1.0 / peak_k_;
        for (int i = 0; i < 50; ++i) {
            cutoff_m_ = std::sqrt(low * high);
            (total_slope() > cox_munk_slope(wind) ? low : high) = cutoff_m_;
        }
    }
}

double Spectrum::uncut(double k) const {
    const double from_peak = peak_k_ / k;
    switch (model_) {
    case Model::phillips:
        return 0.5 * alpha_ / (k * k * k) * std::exp(-1.5 * from_peak * from_peak);
    case Model::tma: {
        const double omega = omega_per_s(k, depth_m_), r = omega / peak_omega_;
        const double width = r <= 1.0 ? 0.07 : 0.09;
        const double peak = std::exp(-0.5 * std::pow((r - 1.0) / width, 2.0));
        const double kd = std::min(k * depth_m_, 300.0);
        const double limit = std::pow(std::tanh(kd), 2.0) / (1.0 + 2.0 * kd / std::sinh(2.0 * kd));
        // In deep water alpha / 2 k^-3: short waves by the gravity part of omega alone.
        const double g_omega = std::sqrt(gravity_m_per_s2 * k * std::tanh(kd));
        const double speed = 0.5 * g_omega / k * (1.0 + 2.0 * kd / std::sinh(2.0 * kd));
        return alpha_ * gravity_m_per_s2 * gravity_m_per_s2 * std::pow(g_omega, -5.0) *
               std::exp(-1.25 * std::pow(peak_omega_ / g_omega, 4.0)) * std::pow(gamma_, peak) *
               limit * speed;
    }
    default: {
        const double r = std::sqrt(1.0 / from_peak), width = r <= 1.0 ? 0.07 : 0.09;
        const double peak = std::exp(-0.5 * std::pow((r - 1.0) / width, 2.0));
        return 0.5 * alpha_ / (k * k * k) * std::exp(-1.25 * from_peak * from_peak) *
               std::pow(gamma_, peak);
    }
    }
}

double Spectrum::density(double k) const {
    if (still_ || !(k > 0.0) || k > greatest_k_per_m)
        return 0.0;
    const double cut = std::exp(-k * k * cutoff_m_ * cutoff_m_);
    return cut > 1e-12 ? uncut(k) * cut : 0.0;
}

double Spectrum::spread(double k, double theta) const {
    if (model_ == Model::phillips) {
        const double c = std::cos(theta);
        return c > 0.0 ? std::pow(c, exponent_) / exponent_norm_ : 0.0;
    }
    const double r = std::sqrt(k / peak_k_); // omega over omega_p, in deep water
    double beta = 0.0;
    if (r < 0.95)
        beta = 2.61 * std::pow(std::max(r, 0.56), 1.3);
    else if (r < 1.6)
        beta = 2.28 * std::pow(r, -1.3);
    else
        beta = std::pow(10.0, -0.4 + 0.8393 * std::exp(-0.567 * std::log(r * r)));
    // sech^2 over the circle: its integral is 2 tanh(beta pi) / beta.
    const double s = sech(beta * std::remainder(theta, 2.0 * pi));
    return beta * s * s / (2.0 * std::tanh(beta * pi));
}

double Spectrum::at(glm::dvec2 k) const {
    const double length = std::hypot(k.x, k.y);
    if (!(length > 0.0))
        return 0.0;
    const double s = density(length);
    if (!(s > 0.0))
        return 0.0;
    const double theta =
        std::atan2(towards_.x * k.y - towards_.y * k.x, towards_.x * k.x + towards_.y * k.y);
    return s * spread(length, theta) / length;
}

double Spectrum::total_slope() const {
    const int steps = 400;
    const double low = lowest_k(), stride = std::log(highest_k() / low) / steps;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double k = low * std::exp((i + 0.5) * stride);
        sum += density(k) * k * k * k * stride;
    }
    return sum;
}

Moments Spectrum::moments(double low, double high) const {
    Moments m;
    if (still_ || !(high > low) || !(low > 0.0))
        return m;
    // Midpoints in log k: the densities are smooth there.
    const int steps = 400, angles = 72;
    const double stride = std::log(high / low) / steps;
    for (int i = 0; i < steps; ++i) {
        const double k = low * std::exp((i + 0.5) * stride), weight = density(k) * k * stride;
        if (!(weight > 0.0))
            continue;
        m.height += weight;
        double along = 0.0, all = 0.0;
        for (int j = 0; j < angles; ++j) {
            const double theta = (j + 0.5) * 2.0 * pi / angles - pi, d = spread(k, theta);
            along += d * std::cos(theta) * std::cos(theta);
            all += d;
        }
        const double slopes = weight * k * k;
        m.slope_along += slopes * along / all;
        m.slope_across += slopes * (1.0 - along / all);
    }
    return m;
}

double Spectrum::peak_period_s() const { return 2.0 * pi / peak_omega_; }
double Spectrum::significant_height_m() const { return 4.0 * std::sqrt(moments().height); }
double Spectrum::lowest_k() const { return (model_ == Model::phillips ? 0.45 : 0.4) * peak_k_; }
double Spectrum::highest_k() const {
    return cutoff_m_ > 0.0 ? std::min(greatest_k_per_m, std::max(3.0 / cutoff_m_, 2.0 * peak_k_))
                           : greatest_k_per_m;
}

} // namespace tarn::waves
