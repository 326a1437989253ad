#include "waves/sea.hpp"

#include "core/angles.hpp"
#include "core/parallel.hpp"
#include "core/text.hpp"
#include "waves/ripples.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>

namespace tarn::waves {

namespace {

constexpr double deep_m = 1e4;
/// Heights beyond this many standard deviations are held back: once in 5e8.
constexpr double bound_sigmas = 6.0;

/// Two independent normal numbers for a place of the lattice: same seed, same numbers.
std::complex<double> normal_pair(std::uint32_t seed, std::uint32_t cascade, std::uint32_t x,
                                 std::uint32_t y) {
    const auto mix = [](std::uint64_t v) { // splitmix64 (Steele, Lea & Flood 2014)
        v += 0x9e3779b97f4a7c15ull;
        v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9ull;
        v = (v ^ (v >> 27)) * 0x94d049bb133111ebull;
        return v ^ (v >> 31);
    };
    const std::uint64_t place =
        mix((std::uint64_t(seed) << 32 | cascade) ^ mix(std::uint64_t(x) << 32 | y));
    const double u = (double(place >> 32) + 0.5) / 4294967296.0;
    const double v = (double(place & 0xffffffffu) + 0.5) / 4294967296.0;
    return std::polar(std::sqrt(-2.0 * std::log(u)), 2.0 * pi * v); // Box & Muller 1958
}

double sinc(double x) { return std::abs(x) < 1e-8 ? 1.0 : std::sin(x) / x; }

/// Share of a wave's variance that is left after a square filter and bilinear look-up.
double passed(glm::dvec2 k, double texel_m, int level) {
    const double wide = std::ldexp(texel_m, level);
    double share = 1.0;
    for (const double part : {k.x, k.y}) {
        const double box = level > 0 ? sinc(0.5 * part * wide) : 1.0;
        share *= box * box * (2.0 + std::cos(part * wide)) / 3.0;
    }
    return share;
}

/// Adds what the filters take from the waves of a density.
void count_unresolved(Cascade& c, const Spectrum& spectrum) {
    const int steps = 96, angles = 36;
    const double stride = std::log(c.high_k / c.low_k) / steps;
    const glm::dvec2 along = spectrum.towards(), across{-along.y, along.x};
    for (int i = 0; i < steps; ++i) {
        const double k = c.low_k * std::exp((i + 0.5) * stride);
        const double weight = spectrum.density(k) * k * stride;
        if (!(weight > 0.0))
            continue;
        double all = 0.0;
        for (int j = 0; j < angles; ++j)
            all += spectrum.spread(k, (j + 0.5) * 2.0 * pi / angles - pi);
        for (int j = 0; j < angles; ++j) {
            const double theta = (j + 0.5) * 2.0 * pi / angles - pi;
            const double share = weight * spectrum.spread(k, theta) / all;
            const glm::dvec2 v = k * (std::cos(theta) * along + std::sin(theta) * across);
            for (int level = 0; level < filter_levels; ++level) {
                const double lost = share * (1.0 - passed(v, c.texel_m(), level));
                c.unresolved[std::size_t(level)].add(lost, v);
            }
        }
    }
}

SlopeCovariance covariance(const Moments& m, glm::dvec2 along) {
    const double a = m.slope_along, b = m.slope_across;
    return {a * along.x * along.x + b * along.y * along.y, (a - b) * along.x * along.y,
            a * along.y * along.y + b * along.x * along.x};
}

/// Signed index of a frequency in FFT order.
int signed_index(int i, int n) { return i < n / 2 ? i : i - n; }

void set_turns(Cascade& c, double depth_m, double loop_s) {
    const int n = c.texels;
    c.turns.resize(std::size_t(n) * std::size_t(n));
    const double dk = 2.0 * pi / c.patch_m;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const double k = dk * std::hypot(signed_index(x, n), signed_index(y, n));
            c.turns[std::size_t(y) * std::size_t(n) + std::size_t(x)] =
                std::uint32_t(std::lround(omega_per_s(k, depth_m) * loop_s / (2.0 * pi)));
        }
}

/// Second half of each entry: the conjugate of the first half of the opposite wave vector.
void pair_opposites(Cascade& c) {
    const int n = c.texels;
    const auto at = [&](int x, int y) -> glm::vec4& {
        return c.h0[std::size_t(y) * std::size_t(n) + std::size_t(x)];
    };
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const glm::vec4& other = at((n - x) % n, (n - y) % n);
            at(x, y).z = other.x;
            at(x, y).w = -other.y;
        }
}

/// Amplitudes of a spectrum's band on the lattice.
void draw_lots(Cascade& c, const Spectrum& spectrum, std::uint32_t seed, std::uint32_t number) {
    const int n = c.texels;
    c.h0.assign(std::size_t(n) * std::size_t(n), glm::vec4(0.0f));
    const double dk = 2.0 * pi / c.patch_m;
    share_out(n, 0, [&](int first, int last) {
        for (int y = first; y < last; ++y)
            for (int x = 0; x < n; ++x) {
                const glm::dvec2 k = dk * glm::dvec2(signed_index(x, n), signed_index(y, n));
                const double length = std::hypot(k.x, k.y);
                if (!(length >= c.low_k && length < c.high_k))
                    continue;
                const double variance = spectrum.at(k) * dk * dk;
                if (!(variance > 0.0))
                    continue;
                const auto lot = normal_pair(seed, number, std::uint32_t(x), std::uint32_t(y)) *
                                 std::sqrt(0.25 * variance);
                glm::vec4& out = c.h0[std::size_t(y) * std::size_t(n) + std::size_t(x)];
                out.x = float(lot.real());
                out.y = float(lot.imag());
            }
    });
    pair_opposites(c);
}

/// Patches and bands for the waves from low_k to high_k.
///
/// The first patch holds the waves around the peak, as many side by side as it can, so that their
/// repetition is far away; each further one takes over where the one before has four texels a
/// wave. Sides are in no simple ratio: the sum repeats nowhere.
std::vector<Cascade> lay_out(const Spectrum& spectrum, const Settings& settings) {
    const int count = settings.cascades, n = settings.texels;
    const double low = spectrum.lowest_k(), high = spectrum.highest_k();
    const double peak_m = 2.0 * pi / spectrum.peak_k();
    std::vector<Cascade> out;
    const auto add = [&](double patch_m, double from_k, double to_k) {
        Cascade c;
        c.patch_m = patch_m;
        c.texels = n;
        c.low_k = std::max(from_k, 2.0 * pi / patch_m);    // no longer wave fits
        c.high_k = std::min(to_k, 0.5 * pi * n / patch_m); // four texels a wave
        out.push_back(c);
    };
    // Twelve texels for the wave at the peak.
    const double side = settings.patch_m.value_or(std::min(48.0, n / 12.0) * peak_m);
    double from = low;
    if (count == 1) {
        add(settings.patch_m.value_or(std::min(24.0, n / 16.0) * peak_m), low, high);
        return out;
    }
    const double first_top = std::min(0.5 * pi * n / side, 1.15 * spectrum.peak_k());
    if (first_top > std::max(low, 2.0 * pi / side) * 1.01)
        add(side, low, first_top);
    from = std::max(first_top, std::min(2.0 * pi / side, 0.5 * high));
    // Twelve waves a patch at least; what is then left at the short end counts as roughness.
    const double ratio = std::clamp(std::pow(high / from, 1.0 / (count - 1)), 1.5, n / 48.0);
    static const double out_of_step[] = {0.977, 0.941, 0.913};
    for (int j = 1; j < count; ++j) {
        const double to = std::min(from * ratio, high);
        if (!(to > from * 1.01))
            break;
        add(0.5 * pi * n / to * out_of_step[j - 1], from, to);
        from = out.back().high_k;
    }
    return out;
}

/// How far, relative to their own, wave vectors are from the lattice of a patch; by their power.
double misfit(std::span<const PlaneWave> waves, double patch_m) {
    double sum = 0.0, weight = 1e-30;
    for (const PlaneWave& w : waves) {
        const double turns = patch_m / w.length_m, a = w.towards_deg * pi / 180.0;
        const double x = turns * std::sin(a), y = turns * std::cos(a),
                     power = w.amplitude_m * w.amplitude_m;
        const double off = std::hypot(x - std::round(x), y - std::round(y)) / turns;
        sum += power * off * off;
        weight += power;
    }
    return std::sqrt(sum / weight);
}

/// The list's waves on the lattices of patches, long ones first; a patch holds eight of its longest
/// side by side and has eight texels for its shortest. Within that its side is the one that the
/// waves' vectors fit best: one wave fits as it is.
std::vector<Cascade> lay_out_list(const std::vector<PlaneWave>& list, const Settings& settings,
                                  double depth_m, double& worst_misfit, int& dropped) {
    std::vector<PlaneWave> waves = list;
    std::sort(waves.begin(), waves.end(),
              [](const PlaneWave& a, const PlaneWave& b) { return a.length_m > b.length_m; });
    std::vector<Cascade> out;
    const int n = settings.texels;
    std::size_t next = 0;
    worst_misfit = 0.0;
    while (next < waves.size() && int(out.size()) < settings.cascades) {
        Cascade c;
        c.texels = n;
        const bool last = int(out.size()) + 1 == settings.cascades;
        const double longest = waves[next].length_m;
        const double shortest = last ? waves.back().length_m : longest * 64.0 / n;
        std::size_t end = next;
        while (end < waves.size() && (last || waves[end].length_m >= shortest))
            ++end;
        const std::span<const PlaneWave> these(&waves[next], end - next);
        const double least = 8.0 * longest, most = std::max(2.0 * least, n * shortest / 8.0);
        double best = 1e9;
        for (int i = 0; i < 20'000 && best > 1e-9 && !settings.patch_m; ++i) {
            const double side = least * std::pow(most / least, i / 20'000.0);
            const double off = misfit(these, side) * (1.0 + 0.2 * i / 20'000.0); // rather small
            if (off < best) {
                best = off;
                c.patch_m = side;
            }
        }
        c.patch_m = settings.patch_m.value_or(c.patch_m);
        worst_misfit = std::max(worst_misfit, misfit(these, c.patch_m));
        c.h0.assign(std::size_t(n) * std::size_t(n), glm::vec4(0.0f));
        const double dk = 2.0 * pi / c.patch_m;
        double steepness = 0.0, height = 0.0;
        c.high_k = 0.5 * pi * n / c.patch_m;
        c.low_k = c.high_k;
        for (; next < waves.size(); ++next) {
            const PlaneWave& w = waves[next];
            const double k = 2.0 * pi / w.length_m;
            if (!last && w.length_m < shortest)
                break;
            if (k > c.high_k) { // too short for the last patch
                ++dropped;
                continue;
            }
            const double a = w.towards_deg * pi / 180.0;
            const int x = int(std::lround(k * std::sin(a) / dk)),
                      y = int(std::lround(k * std::cos(a) / dk));
            if (x == 0 && y == 0)
                continue;
            // A cos(k x - w t + phase) = h0 e^{i(kx - wt)} + its conjugate, h0 = A/2 e^{i phase}.
            glm::vec4& at =
                c.h0[std::size_t((y + n) % n) * std::size_t(n) + std::size_t((x + n) % n)];
            at.x += float(0.5 * w.amplitude_m * std::cos(w.phase_rad));
            at.y += float(0.5 * w.amplitude_m * std::sin(w.phase_rad));
            const double drawn = dk * std::hypot(x, y),
                         variance = 0.5 * w.amplitude_m * w.amplitude_m;
            c.low_k = std::min(c.low_k, drawn);
            steepness += drawn * w.amplitude_m;
            height += w.amplitude_m;
            c.moments.height += variance;
            c.moments.slope_along += variance * drawn * drawn;
            const glm::dvec2 v = dk * glm::dvec2(x, y);
            for (int level = 0; level < filter_levels; ++level) {
                const double lost = variance * (1.0 - passed(v, c.texel_m(), level));
                c.unresolved[std::size_t(level)].add(lost, v);
            }
        }
        if (c.moments.height > 0.0) {
            pair_opposites(c);
            c.bound_m = height;
            c.choppiness = std::min(settings.choppiness, 0.98 / std::max(steepness, 1e-9));
            set_turns(c, depth_m, settings.loop_s);
            out.push_back(std::move(c));
        }
    }
    return out;
}

/// Waves that carry the spectrum's variance, a hand's width of frequencies and directions each.
std::vector<PlaneWave> pick_waves(const Spectrum& spectrum, std::uint32_t seed) {
    std::vector<PlaneWave> out;
    const int count = 32;
    const double low = 0.6 * spectrum.peak_k(),
                 high = std::min(12.0 * spectrum.peak_k(), spectrum.highest_k());
    const double stride = std::log(high / low) / count;
    const double towards = std::atan2(spectrum.towards().x, spectrum.towards().y);
    for (int i = 0; i < count; ++i) {
        const double k = low * std::exp((i + 0.5) * stride);
        const double variance =
            spectrum.moments(k * std::exp(-0.5 * stride), k * std::exp(0.5 * stride)).height;
        const auto lot = normal_pair(seed, 77, std::uint32_t(i), 0);
        // Directions by the spread's own distribution, by halving its integral.
        const double share = 0.5 * (1.0 + std::erf(lot.real() / std::sqrt(2.0)));
        double theta = -pi, sum = 0.0;
        for (int j = 0; j < 360 && sum < share; ++j) {
            sum += spectrum.spread(k, theta) * 2.0 * pi / 360.0;
            theta += 2.0 * pi / 360.0;
        }
        out.push_back({.amplitude_m = std::sqrt(2.0 * variance),
                       .length_m = 2.0 * pi / k,
                       .towards_deg = (towards - theta) * 180.0 / pi,
                       .phase_rad = std::arg(lot)});
    }
    return out;
}

double depth_of(const std::vector<LakeRecord>& lakes, const Settings& settings) {
    const LakeRecord& lake = lakes.front();
    if (settings.depth_m)
        return *settings.depth_m;
    return lake.mean_depth_m && *lake.mean_depth_m > 0.0 ? *lake.mean_depth_m : deep_m;
}

bool by_wind(const Settings& s) {
    return s.model == Model::phillips || s.model == Model::jonswap || s.model == Model::tma ||
           (s.model == Model::gerstner && s.list.empty());
}

/// How high each cascade's waves are where the fetch or the depth is less.
void map_amplitudes(Sea& sea, const WaterMask& mask, const Grid<float>& fetch, double most_fetch,
                    double depth_m) {
    const GridSize size = mask.open.size;
    sea.amplitude = Grid<std::array<std::uint8_t, most_cascades>>(size);
    sea.amplitude_side_m = mask.side_m;
    sea.amplitude_west_m = mask.west_m;
    sea.amplitude_north_m = mask.north_m;
    const std::size_t count = sea.cascades.size();
    // A table over the fetch; a long-blown sea (phillips) does not know it, so JONSWAP tells.
    Settings growth = sea.settings;
    growth.model = sea.settings.model == Model::tma ? Model::tma : Model::jonswap;
    const int steps = 32;
    const double least = 1.0, stride = std::log(std::max(most_fetch, 2.0) / least) / steps;
    std::vector<std::array<double, most_cascades>> table(steps + 1);
    for (int i = 0; i <= steps; ++i) {
        const Spectrum there(growth, least * std::exp(i * stride), depth_m);
        for (std::size_t j = 0; j < count; ++j)
            table[std::size_t(i)][j] =
                std::sqrt(there.moments(sea.cascades[j].low_k, sea.cascades[j].high_k).height);
    }
    const std::array<double, most_cascades> most = table.back();
    const auto share = [&](double fetch_m, std::size_t j) {
        const double at =
            std::clamp(std::log(std::max(fetch_m, least) / least) / stride, 0.0, double(steps));
        const std::size_t i = std::min(std::size_t(at), std::size_t(steps - 1));
        const double f = at - double(i), v = table[i][j] * (1.0 - f) + table[i + 1][j] * f;
        return most[j] > 0.0 ? std::min(v / most[j], 1.0) : 0.0;
    };
    for (std::size_t i = 0; i < size.count(); ++i)
        for (std::size_t j = 0; j < count; ++j) {
            if (!(fetch.values[i] > 0.0f))
                continue;
            double a = share(fetch.values[i], j);
            if (sea.settings.model == Model::tma) { // Kitaigorodskii's factor where it is shallower
                const Cascade& c = sea.cascades[j];
                const double k = std::sqrt(c.low_k * c.high_k);
                const auto limit = [&](double d) {
                    const double kd = std::clamp(k * d, 1e-6, 300.0), t = std::tanh(kd);
                    return t * t / (1.0 + 2.0 * kd / std::sinh(2.0 * kd));
                };
                a *= std::sqrt(std::min(1.0, limit(mask.depth_m.values[i]) / limit(depth_m)));
            }
            sea.amplitude.values[i][j] = std::uint8_t(std::lround(255.0 * a));
        }
    // Land takes its neighbours' greatest, ring by ring, so that a sample by the shore is not
    // drawn towards nothing: there the depth alone lets waves fade.
    Grid<std::uint8_t> known(size);
    for (std::size_t i = 0; i < size.count(); ++i)
        known.values[i] = fetch.values[i] > 0.0f;
    for (int ring = 0; ring < 2; ++ring) {
        const Grid<std::uint8_t> before = known;
        for (int row = 0; row < size.rows; ++row)
            for (int col = 0; col < size.cols; ++col) {
                if (before[{col, row}])
                    continue;
                for (int k = 0; k < 9; ++k) {
                    const Node n{col + k % 3 - 1, row + k / 3 - 1};
                    if (!before.contains(n) || !before[n])
                        continue;
                    known[{col, row}] = 1;
                    for (std::size_t j = 0; j < count; ++j)
                        sea.amplitude[{col, row}][j] =
                            std::max(sea.amplitude[{col, row}][j], sea.amplitude[n][j]);
                }
            }
    }
}

/// Rain on all water, deep or not, as one more patch.
void add_rain(Sea& sea) {
    const RippleSettings& rain = sea.settings.ripples;
    if (!(rain.rain_drops_per_m2_s > 0.0))
        return;
    Cascade c;
    c.ripples = true;
    c.texels = sea.settings.texels;
    c.patch_m = c.texels * ripple_texel_m;
    c.low_k = 2.0 * pi / (8.0 * drop_radius_m);
    c.high_k = 2.0 * pi / (1.5 * drop_radius_m);
    c.bound_m = 6.0 * rain.drop_height_m;
    c.moments.slope_along = c.moments.slope_across = 0.5 * rain_slope(rain);
    const double k = drop_k_per_m, turn = k * c.texel_m();
    // Slopes are differences over two texels, which see less of waves so short.
    const double differences = sinc(turn) * sinc(turn);
    c.moments.height = c.moments.slope() / (k * k);
    for (int level = 0; level < filter_levels; ++level)
        for (int j = 0; j < 16; ++j) { // all directions alike
            const double theta = (j + 0.5) * pi / 8.0;
            const glm::dvec2 v = k * glm::dvec2(std::cos(theta), std::sin(theta));
            const double lost =
                c.moments.slope() / 16.0 * (1.0 - differences * passed(v, c.texel_m(), level));
            c.unresolved[std::size_t(level)].add(lost, v / k);
        }
    for (auto& shares : sea.amplitude.values)
        shares[sea.cascades.size()] = 255;
    sea.bound_m += c.bound_m;
    sea.full_depth_m = std::max(sea.full_depth_m, sea.bound_m / 0.95);
    sea.report.mean_square_slope += c.moments.slope();
    sea.report.drawn_slope += c.moments.slope();
    sea.cascades.push_back(std::move(c));
}

/// A square of water around what was poked, with the lake's own shores.
void add_pokes(Sea& sea, const Heightfield& ground, const Heightfield& water) {
    const std::vector<Poke>& pokes = sea.settings.ripples.pokes;
    if (pokes.empty())
        return;
    Cascade c;
    c.ripples = c.window = true;
    c.texels = sea.settings.texels;
    double radius = 1e9;
    glm::dvec2 low(1e18), high(-1e18);
    for (const Poke& p : pokes) {
        radius = std::min(radius, p.radius_m);
        low = {std::min(low.x, p.x_m), std::min(low.y, p.y_m)};
        high = {std::max(high.x, p.x_m), std::max(high.y, p.y_m)};
        c.bound_m += 2.0 * std::abs(p.height_m);
    }
    // Five texels for the smallest dent's radius: rings are resolved.
    c.patch_m = c.texels * radius / 5.0;
    c.corner_m = 0.5 * (low + high) - 0.5 * c.patch_m;
    c.low_k = 2.0 * pi / c.patch_m;
    c.high_k = 0.5 * pi / c.texel_m();
    c.mask.assign(std::size_t(c.texels) * std::size_t(c.texels), 1);
    for (int y = 0; y < c.texels; ++y)
        for (int x = 0; x < c.texels; ++x) {
            const glm::dvec2 at = c.corner_m + c.texel_m() * glm::dvec2(x, y);
            const double col = water.col(at.x), row = water.row(at.y);
            if (!(col >= 0.0 && row >= 0.0 && col <= water.size().cols - 1 &&
                  row <= water.size().rows - 1))
                continue;
            const Node node{int(std::lround(col)), int(std::lround(row))};
            if (water.codes[node] != no_water_code &&
                ground.elevation_m(at.x, at.y) < water.elevation_m(node))
                c.mask[std::size_t(y) * std::size_t(c.texels) + std::size_t(x)] = 0;
        }
    const bool outside = high.x - low.x > 0.8 * c.patch_m || high.y - low.y > 0.8 * c.patch_m;
    if (outside)
        sea.report.notes.push_back(text("the pokes lie farther apart than the ",
                                        fixed(c.patch_m, 1),
                                        " m of water that show their rings: some are left out"));
    for (auto& shares : sea.amplitude.values)
        shares[sea.cascades.size()] = 255;
    sea.bound_m += c.bound_m;
    sea.full_depth_m = std::max(sea.full_depth_m, sea.bound_m / 0.95);
    sea.cascades.push_back(std::move(c));
}

double greatest(const Grid<float>& fetch) {
    float most = 0.0f;
    for (const float f : fetch.values)
        most = std::max(most, f);
    return most;
}

void fill_report(SeaReport& r, const Settings& s, const Spectrum& spectrum, double fetch_m) {
    r.model = name_of(s.model);
    r.wind_m_per_s = s.wind_m_per_s;
    r.wind_from_deg = s.wind_from_deg;
    r.fetch_m = fetch_m;
    r.depth_m = spectrum.depth_m();
    if (spectrum.still())
        return;
    const Moments m = spectrum.moments();
    r.significant_height_m = 4.0 * std::sqrt(m.height);
    r.peak_period_s = spectrum.peak_period_s();
    r.peak_length_m = 2.0 * pi / spectrum.peak_k();
    r.mean_square_slope = m.slope();
}

} // namespace

std::uint32_t loop_fraction(double time_s, double loop_s) {
    double part = std::fmod(time_s, loop_s) / loop_s;
    part -= std::floor(part);
    return std::uint32_t(std::uint64_t(std::llround(part * 4294967296.0)) & 0xffffffffu);
}

SeaReport report_for(const WaterMask& mask, const Grid<float>& fetch, const Heightfield& ground,
                     const Heightfield& water, const LakeRecord& lake, const Settings& settings) {
    double most = 0.0;
    const double stride = mask.side_m / ground.spacing_m;
    for (int row = 0; row < mask.open.size.rows; ++row)
        for (int col = 0; col < mask.open.size.cols; ++col) {
            const Node node{std::min(int((col + 0.5) * stride), ground.size().cols - 1),
                            std::min(int((row + 0.5) * stride), ground.size().rows - 1)};
            if (fetch[{col, row}] > 0.0f && node.col >= lake.west_north.col &&
                node.col <= lake.east_south.col && node.row >= lake.west_north.row &&
                node.row <= lake.east_south.row &&
                std::abs(water.elevation_m(node) - lake.level_m) < 0.01)
                most = std::max(most, double(fetch[{col, row}]));
        }
    if (!(most > 0.0)) // smaller than a square: as wide as it is large
        most = std::sqrt(std::max(lake.area_m2, 1.0));
    Settings s = settings;
    if (s.model == Model::calm || s.model == Model::sines || s.model == Model::gerstner)
        s.model = Model::jonswap;
    const double fetch_m = settings.fetch_m.value_or(most);
    const Spectrum spectrum(s, fetch_m, depth_of({lake}, settings));
    SeaReport r;
    fill_report(r, s, spectrum, fetch_m);
    return r;
}

Sea make_sea(const Heightfield& ground, const Heightfield& water,
             const std::vector<LakeRecord>& lakes, const Settings& settings) {
    settings.validate();
    Sea sea;
    sea.settings = settings;
    sea.report.model = name_of(settings.model);
    sea.amplitude = Grid<std::array<std::uint8_t, most_cascades>>({1, 1}, {255, 255, 255, 255});
    sea.amplitude_side_m = 1e9;
    if (settings.model == Model::calm) {
        add_rain(sea);
        add_pokes(sea, ground, water);
        return sea;
    }
    const double depth_m = depth_of(lakes, settings);
    const WaterMask mask = water_mask(ground, water);
    const auto note = [&](const std::string& words) { sea.report.notes.push_back(words); };
    double steepest_rms = 0.0;
    if (settings.model == Model::sines) {
        for (const PlaneWave& w : settings.list) {
            const double k = 2.0 * pi / w.length_m, a = w.towards_deg * pi / 180.0;
            sea.sines.push_back({k * glm::dvec2(std::sin(a), std::cos(a)), w.amplitude_m,
                                 omega_per_s(k, depth_m), w.phase_rad});
            sea.bound_m += w.amplitude_m;
        }
        sea.full_depth_m = sea.bound_m / 0.9;
    } else {
        Settings spectral = settings;
        if (settings.model == Model::gerstner)
            spectral.model = Model::jonswap;
        const bool windy = by_wind(settings);
        Grid<float> fetch;
        double most_fetch = settings.fetch_m.value_or(1000.0);
        if (windy && !settings.fetch_m) {
            fetch = effective_fetch_m(mask, settings.wind_from_deg);
            most_fetch = greatest(fetch);
            if (!(most_fetch > 0.0)) // every lake is smaller than a square
                most_fetch = std::sqrt(std::max(lakes.front().area_m2, 1.0));
        }
        const Spectrum spectrum(spectral, most_fetch, depth_m);
        if (windy) {
            fill_report(sea.report, settings, spectrum, most_fetch);
            sea.report.model = name_of(settings.model);
            if (spectrum.still()) {
                note(depth_m > 0.0 ? text("a wind of ", settings.wind_m_per_s,
                                          " m/s raises no wave longer than 3 cm here: drawn calm")
                                   : "the depth is 0: drawn calm");
                add_rain(sea);
                add_pokes(sea, ground, water);
                return sea;
            }
        }
        if (settings.model == Model::gerstner) {
            double off = 0.0;
            int dropped = 0;
            sea.cascades = lay_out_list(windy ? pick_waves(spectrum, settings.seed) : settings.list,
                                        settings, depth_m, off, dropped);
            if (dropped > 0 && !windy)
                note(text(dropped,
                          " waves of the list are shorter than four texels and left out: more "
                          "--wave-cascades or --wave-texels would hold them"));
            if (off > 0.005 && !windy)
                note(text("wave vectors of the list are drawn as the patches' lattices have them, ",
                          fixed(100.0 * off, 1), " % off (rms)"));
        } else {
            sea.cascades = lay_out(spectrum, settings);
            std::uint32_t number = 0;
            for (Cascade& c : sea.cascades) {
                c.moments = spectrum.moments(c.low_k, c.high_k);
                draw_lots(c, spectrum, settings.seed, number++);
                set_turns(c, depth_m, settings.loop_s);
                count_unresolved(c, spectrum);
                c.bound_m = bound_sigmas * std::sqrt(c.moments.height);
                c.choppiness =
                    std::min(settings.choppiness,
                             0.95 / (bound_sigmas * std::sqrt(std::max(c.moments.slope(), 1e-9))));
            }
        }
        if (windy) {
            double top = 0.0;
            for (const Cascade& c : sea.cascades)
                top = std::max(top, c.high_k);
            if (settings.model ==
                Model::gerstner) // picked from the bands below twelve times the peak
                top = std::min(12.0 * spectrum.peak_k(), spectrum.highest_k());
            sea.roughness =
                covariance(spectrum.moments(top, spectrum.highest_k()), spectrum.towards());
            if (fetch.size.count() > 0)
                map_amplitudes(sea, mask, fetch, most_fetch, depth_m);
        }
        double variance = 0.0;
        for (const Cascade& c : sea.cascades) {
            sea.bound_m += c.bound_m;
            variance += c.moments.height;
            steepest_rms += c.moments.slope();
            if (c.choppiness < settings.choppiness * 0.999)
                note(text("choppiness of the waves of ", fixed(2.0 * pi / c.high_k, 2), " to ",
                          fixed(2.0 * pi / c.low_k, 2), " m held at ", fixed(c.choppiness, 2),
                          " of ", fixed(settings.choppiness, 2), ": beyond it they could fold"));
        }
        // Waves break where they are .59 of the depth high; then no trough reaches the bed.
        sea.full_depth_m = std::max(1.7 * 4.0 * std::sqrt(variance), sea.bound_m / 0.95);
        if (!windy) {
            sea.report.significant_height_m = 4.0 * std::sqrt(variance);
            sea.report.mean_square_slope = steepest_rms;
            sea.report.depth_m = depth_m;
        }
    }
    double longest = 0.0, shortest = 1e9, choppiness = settings.choppiness, slowest = 1e9,
           drawn_variance = 0.0;
    std::size_t stuck = 0;
    for (const Cascade& c : sea.cascades) {
        longest = std::max(longest, 2.0 * pi / c.low_k);
        shortest = std::min(shortest, 2.0 * pi / c.high_k);
        choppiness = std::min(choppiness, c.choppiness);
        sea.report.drawn_slope += c.moments.slope();
        drawn_variance += c.moments.height;
        for (std::size_t i = 0; i < c.turns.size(); ++i)
            stuck += c.turns[i] == 0 && (c.h0[i].x != 0.0f || c.h0[i].y != 0.0f);
        slowest = std::min(slowest, omega_per_s(c.low_k, depth_m));
    }
    if (stuck > 0)
        note(slowest > 0.0
                 ? text("the loop of ", settings.loop_s, " s is shorter than half the period of ",
                        stuck, " waves: those stand still; a loop of ",
                        std::ceil(2.0 * pi / slowest), " s moves them all")
                 : std::string("the depth is 0: the waves stand still"));
    double sine_variance = 0.0, sine_slope = 0.0;
    for (const SineWave& w : sea.sines) {
        const double k = std::hypot(w.k_per_m.x, w.k_per_m.y);
        longest = std::max(longest, 2.0 * pi / k);
        shortest = std::min(shortest, 2.0 * pi / k);
        sine_variance += 0.5 * w.amplitude_m * w.amplitude_m;
        sine_slope += 0.5 * w.amplitude_m * w.amplitude_m * k * k;
    }
    if (!sea.sines.empty()) {
        sea.report.significant_height_m = 4.0 * std::sqrt(sine_variance);
        sea.report.mean_square_slope = sea.report.drawn_slope = sine_slope;
        sea.report.depth_m = depth_m;
    }
    sea.report.drawn_height_m = 4.0 * std::sqrt(drawn_variance + sine_variance);
    if (by_wind(settings) && sea.report.drawn_height_m < 0.7 * sea.report.significant_height_m)
        note(text("the patches hold waves of ", fixed(sea.report.drawn_height_m, 3), " m of the ",
                  fixed(sea.report.significant_height_m, 3),
                  " m that the wind raises: larger or more "
                  "of them would hold more"));
    sea.report.longest_m = longest;
    sea.report.shortest_m = shortest;
    sea.report.choppiness = sea.sines.empty() ? choppiness : 0.0;
    add_rain(sea);
    add_pokes(sea, ground, water);
    return sea;
}

} // namespace tarn::waves
