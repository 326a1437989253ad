#include "scene/water_colour.hpp"

#include "core/angles.hpp"
#include "scene/forward_glow.hpp"
#include "scene/water_types.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::scene {

namespace {

/// One wavelength, or one channel of three.
struct Band {
    glm::dvec3 weight;
    double attenuation_per_m, backscattering_per_m;
    double beam_per_m; ///< a + b
    double pattern_per_m, forward_per_m;
};

/// One lobe of the fit: a Gaussian of two widths.
double lobe(double nm, double middle, double left, double right) {
    const double t = (nm - middle) * (nm < middle ? left : right);
    return std::exp(-0.5 * t * t);
}

std::vector<Band> bands_of(const WaterOptics& optics, bool spectral) {
    std::vector<Band> out;
    const glm::dvec3 k = optics.attenuation_per_m();
    if (!spectral || optics.bands.empty()) {
        for (int c = 0; c < 3; ++c) {
            glm::dvec3 weight(0.0);
            weight[c] = 1.0;
            out.push_back({weight, k[c], optics.backscattering_per_m[c], k[c], k[c], 0.0});
        }
        return out;
    }
    glm::dvec3 sum(0.0);
    for (int nm = 400; nm <= 700; ++nm) { // the trapezoid rule: ends count half
        const WaterBand band = band_at(optics.bands, nm);
        const glm::dvec3 weight = sunlight_colour(nm) * (nm == 400 || nm == 700 ? 0.5 : 1.0);
        out.push_back({weight, band.attenuation_per_m(), band.backscattering_per_m,
                       band.absorption_per_m + band.scattering_per_m, band.pattern_per_m(),
                       band.forward_per_m()});
        sum += weight;
    }
    for (Band& band : out)
        band.weight /= sum;
    return out;
}

struct Angle {
    double cosine, share; ///< share: 2 mu F d mu
};

/// Midpoints on both sides of the critical angle, where F has its kink.
std::vector<Angle> mirrored_angles(double n) {
    std::vector<Angle> out;
    const double critical = std::sqrt(std::max(0.0, 1.0 - 1.0 / (n * n)));
    for (int i = 0; i < 64; ++i)
        if (critical > 0.0) {
            const double mu = critical * (i + 0.5) / 64;
            out.push_back({mu, 2.0 * mu * critical / 64});
        }
    for (int i = 0; i < 512; ++i) { // crowded towards the critical angle
        const double t = (i + 0.5) / 512, mu = critical + (1.0 - critical) * t * t;
        out.push_back(
            {mu, 2.0 * mu * reflectance_from_below(mu, n) * (1.0 - critical) * 2.0 * t / 512});
    }
    return out;
}

} // namespace

double reflectance_from_below(double mu, double n) {
    const double sin2 = n * n * (1.0 - mu * mu);
    if (sin2 >= 1.0)
        return 1.0;
    const double out = std::sqrt(1.0 - sin2);
    const double s = (n * mu - out) / (n * mu + out), p = (mu - n * out) / (mu + n * out);
    return 0.5 * (s * s + p * p);
}

glm::dvec3 sunlight_colour(double nm) {
    const double x = 0.362 * lobe(nm, 442.0, 0.0624, 0.0374) +
                     1.056 * lobe(nm, 599.8, 0.0264, 0.0323) -
                     0.065 * lobe(nm, 501.1, 0.0490, 0.0382);
    const double y =
        0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322);
    const double z =
        1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725);
    const double um = 1e-3 * nm;
    const double sun = std::pow(um, -5.0) / std::expm1(14387.769 / (um * 5772.0));
    return sun * glm::dvec3(3.2406 * x - 1.5372 * y - 0.4986 * z,
                            -0.9689 * x + 1.8758 * y + 0.0415 * z,
                            0.0557 * x - 0.2040 * y + 1.0570 * z);
}

double WaterTable::path_m(double share, double longest_m) {
    return shortest_m * std::expm1(std::log1p(longest_m / shortest_m) * share);
}

std::vector<glm::vec4> WaterTable::packed() const {
    std::vector<glm::vec4> out;
    for (const auto& row : rows)
        for (const glm::vec3& value : row)
            out.emplace_back(value, 0.0f);
    return out;
}

glm::vec4 WaterTable::scale() const {
    return {float(1.0 / shortest_m), float((texels - 1) / std::log1p(longest_m / shortest_m)),
            float(greatest_attenuation_per_m), float(texels - 1)};
}

WaterTable make_water_table(const WaterOptics& optics, bool spectral) {
    const std::vector<Band> bands = bands_of(optics, spectral);
    WaterTable table;
    double least = 1e30;
    for (const Band& band : bands) {
        least = std::min(least, band.attenuation_per_m);
        table.greatest_attenuation_per_m =
            std::max(table.greatest_attenuation_per_m, band.attenuation_per_m);
    }
    table.longest_m = std::clamp(14.0 / std::max(least, 1e-9), 10.0, 1e7);
    const std::vector<Angle> angles = mirrored_angles(optics.index);
    double from_below = 0.0;
    for (const Angle& angle : angles)
        from_below += angle.share;
    // By reciprocity: (1 - R_above) = n^2 (1 - R_below) for an even sky.
    table.sky_entering = optics.index * optics.index * (1.0 - from_below);

    // B by optical depth, once for all wavelengths: in even steps of its root, as it falls steeply
    // at first.
    constexpr int steps = 256;
    constexpr double deepest = 9.0;
    std::array<double, steps + 1> thrown{};
    for (int i = 0; i <= steps; ++i) {
        const double tau = deepest * i * i / double(steps * steps);
        for (const Angle& angle : angles)
            thrown[std::size_t(i)] += angle.share * std::exp(-2.0 * tau / angle.cosine);
    }
    const auto thrown_back = [&](double tau) {
        const double place = std::sqrt(tau / deepest) * steps;
        if (place >= steps)
            return 0.0;
        const auto low = std::size_t(place);
        const double u = tau / deepest * steps * steps; // linear in tau between entries
        const double a = double(low * low), b = double((low + 1) * (low + 1));
        return std::lerp(thrown[low], thrown[low + 1], (u - a) / (b - a));
    };

    for (auto& row : table.rows)
        row.reserve(WaterTable::texels);
    for (int i = 0; i < WaterTable::texels; ++i) {
        const double x = table.path_m(i);
        glm::dvec3 transmitted(0.0), integral(0.0), source(0.0), thrown_row(0.0), beam(0.0),
            pattern(0.0);
        for (const Band& band : bands) {
            const double c = band.attenuation_per_m, left = std::exp(-c * x);
            const double per_m = band.backscattering_per_m / (2.0 * pi);
            transmitted += band.weight * left;
            beam += band.weight * std::exp(-band.beam_per_m * x);
            pattern += band.weight * std::exp(-band.pattern_per_m * x);
            source += band.weight * (per_m * left);
            integral +=
                band.weight *
                (per_m * (c * x < 0.01
                              ? x * (1.0 - c * x / 2.0 * (1.0 - c * x / 3.0 * (1.0 - c * x / 4.0)))
                              : (1.0 - left) / c));
            thrown_row += band.weight * thrown_back(c * x);
        }
        table.rows[0].emplace_back(transmitted);
        table.rows[1].emplace_back(integral);
        table.rows[2].emplace_back(source);
        table.rows[3].emplace_back(thrown_row);
        table.rows[4].emplace_back(beam);
        table.rows[5].emplace_back(pattern);
    }
    return table;
}

GlowColours make_glow_colours(const WaterOptics& optics, const GlowTable& glow, double longest_m) {
    GlowColours out;
    out.angles = glow.angles;
    const std::vector<Band> bands = bands_of(optics, true);
    std::vector<glm::dvec3> sum(std::size_t(glow.angles));
    for (int row = 0; row < out.paths; ++row) {
        const double x = WaterTable::path_m(double(row) / (out.paths - 1), longest_m);
        std::fill(sum.begin(), sum.end(), glm::dvec3(0.0));
        for (const Band& band : bands) {
            const glm::dvec3 left =
                band.weight * (band.forward_per_m * std::exp(-band.attenuation_per_m * x));
            const double place = glow.row_of(band.forward_per_m * x);
            const int low = std::min(int(place), glow.depths - 2);
            const double u = place - low;
            const float* entry = glow.h.data() + std::size_t(low * glow.angles);
            for (int a = 0; a < glow.angles; ++a, ++entry)
                sum[std::size_t(a)] +=
                    left * std::lerp(double(entry[0]), double(entry[glow.angles]), u);
        }
        for (const glm::dvec3& value : sum)
            out.rgb.emplace_back(value, 0.0);
    }
    return out;
}

} // namespace tarn::scene
