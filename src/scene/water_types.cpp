#include "scene/water_types.hpp"

#include "core/error.hpp"
#include "core/number_table.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tarn::scene {

namespace {

constexpr int band_count = 31;
constexpr double first_nm = 400.0, step_nm = 10.0;

/// Absorption of pure water, 400 to 700 nm (Pope & Fry 1997) [1/m].
constexpr std::array<double, band_count> pure_absorption = {
    .00663, .00473, .00454, .00495, .00635, .00922, .00979, .0106, .0127, .0150, .0204,
    .0325,  .0409,  .0434,  .0474,  .0565,  .0619,  .0695,  .0896, .1351, .2224, .2644,
    .2755,  .2916,  .3108,  .340,   .410,   .439,   .465,   .516,  .624};

/// Jerlov (1976), Table XXVII: Kd at 400, 425, ... 700 nm [1/m]; scattering b at 550 nm: Williamson
/// & Hollins (2022) for IB to 5C, continued by us for the others.
struct Jerlov {
    const char* name;
    double scattering_550;
    std::array<double, 13> kd;
};
constexpr std::array<Jerlov, 10> jerlov_types = {{
    {"I", .05, {.027, .022, .019, .018, .027, .043, .063, .089, .235, .305, .36, .42, .56}},
    {"IA", .08, {.038, .031, .026, .025, .032, .048, .067, .094, .24, .31, .37, .43, .57}},
    {"IB", .122, {.051, .042, .036, .033, .042, .054, .072, .099, .245, .315, .375, .435, .58}},
    {"II", .176, {.096, .081, .068, .062, .07, .076, .089, .115, .26, .335, .4, .465, .61}},
    {"III", .287, {.185, .16, .135, .116, .115, .116, .12, .148, .295, .375, .445, .52, .66}},
    {"1C", .427, {.51, .36, .25, .17, .14, .13, .12, .15, .3, .37, .45, .51, .65}},
    {"3C", .644, {.78, .54, .39, .29, .22, .2, .19, .21, .33, .4, .46, .56, .71}},
    {"5C", 1.194, {1.1, .78, .56, .43, .36, .31, .3, .33, .4, .48, .54, .65, .8}},
    {"7C", 2.1, {1.6, 1.2, .89, .71, .58, .49, .46, .46, .48, .54, .63, .78, .92}},
    {"9C", 3.6, {2.4, 1.9, 1.6, 1.23, .99, .78, .63, .58, .6, .65, .76, .92, 1.1}},
}};

struct Named {
    const char* name;
    Constituents in;
};
constexpr std::array<Named, 7> lakes = {{
    {"pure", {0.0, 0.0, 0.0}},
    {"alpine lake", {0.3, 0.02, 0.15}},
    {"clear lake", {0.6, 0.03, 0.4}},
    {"mesotrophic lake", {4.0, 0.3, 1.0}},
    {"eutrophic lake", {30.0, 0.8, 4.0}},
    {"humic lake", {4.0, 8.0, 0.5}},
    {"glacial lake", {0.3, 0.03, 12.0}},
}};

/// Share of what minerals scatter that goes backwards: Petzold's mean (Mobley 1994).
constexpr double petzold_backward = 0.0183;
/// Cosine that turns path into depth for light below the surface, in the mean over days and skies.
constexpr double mean_cosine = 0.86;

double wavelength(int i) { return first_nm + step_nm * i; }

double gauss(double x, double middle, double width) {
    const double t = (x - middle) / width;
    return std::exp(-0.5 * t * t);
}

/// Absorption of phytoplankton relative to 440 nm: the pigments' blue and red bands, by eye after
/// the tables of Bricaud et al. (1995).
double pigment_shape(double nm) {
    const double sum = gauss(nm, 438, 32) + 0.45 * gauss(nm, 490, 28) + 0.14 * gauss(nm, 590, 60) +
                       0.48 * gauss(nm, 676, 13);
    const double at_440 = gauss(440, 438, 32) + 0.45 * gauss(440, 490, 28) +
                          0.14 * gauss(440, 590, 60) + 0.48 * gauss(440, 676, 13);
    return sum / at_440;
}

/// Pure fresh water scatters .0015 /m at 550 nm, half of it backwards (Morel 1974).
double pure_scattering(double nm) { return 0.0015 * std::pow(550.0 / nm, 4.32); }

std::vector<WaterBand> bands_of(const Constituents& in) {
    std::vector<WaterBand> bands;
    for (int i = 0; i < band_count; ++i) {
        const double nm = wavelength(i), chl = in.chlorophyll_mg_per_m3;
        const double pigments = 0.0403 * std::pow(chl, 0.668) * pigment_shape(nm);
        const double dissolved = in.cdom_per_m * std::exp(-0.015 * (nm - 440.0));
        const double mineral_a =
            0.041 * in.minerals_g_per_m3 * std::exp(-0.0123 * (nm - 443.0)); // Babin et al. 2003
        const double algae_b = 0.30 * std::pow(chl, 0.62) * 550.0 / nm;      // Gordon & Morel 1983
        const double mineral_b = 0.51 * in.minerals_g_per_m3 * 550.0 / nm;
        const double water_b = pure_scattering(nm);
        bands.push_back(
            {.wavelength_nm = nm,
             .absorption_per_m = pure_absorption[std::size_t(i)] + pigments + dissolved + mineral_a,
             .scattering_per_m = water_b + algae_b + mineral_b,
             .backscattering_per_m =
                 0.5 * water_b + 0.01 * algae_b + petzold_backward * mineral_b});
    }
    return bands;
}

/// a and b_b so that the model's light fades as Jerlov's does: a + b_b = .86 Kd.
std::vector<WaterBand> bands_of(const Jerlov& type) {
    std::vector<WaterBand> bands;
    for (int i = 0; i < band_count; ++i) {
        const double nm = wavelength(i), place = (nm - 400.0) / 25.0;
        const auto low = std::size_t(std::min(int(place), 11));
        const double kd = std::lerp(type.kd[low], type.kd[low + 1], place - double(low));
        const double water_b = pure_scattering(nm);
        const double particles = std::max(type.scattering_550 * 550.0 / nm - water_b, 0.0);
        const double bb = 0.5 * water_b + petzold_backward * particles;
        bands.push_back({.wavelength_nm = nm,
                         .absorption_per_m = std::max(mean_cosine * kd - bb, 0.0),
                         .scattering_per_m = water_b + particles,
                         .backscattering_per_m = bb});
    }
    return bands;
}

/// The channels are what the bands say at their wavelengths.
WaterOptics optics_of(std::string name, std::vector<WaterBand> bands) {
    WaterOptics out;
    out.name = std::move(name);
    out.bands = std::move(bands);
    out.validate(); // bands first: what follows trusts their order
    constexpr double channel_nm[3] = {620.0, 545.0, 450.0};
    for (int c = 0; c < 3; ++c) {
        const WaterBand band = band_at(out.bands, channel_nm[c]);
        out.absorption_per_m[c] = band.absorption_per_m;
        out.backscattering_per_m[c] = band.backscattering_per_m;
    }
    return out;
}

void require(const char* what, double value, double low, double high) {
    if (!(value >= low && value <= high))
        throw Error(text(what, " is ", value, ", must be in [", low, ", ", high, "]"));
}

constexpr double secchi_constant = 8.7; // ln(40 / .0066): docs/physics/water-types.md

double secchi_of(const std::vector<WaterBand>& bands) {
    double least = 1e30;
    for (const WaterBand& band : bands)
        least = std::min(least, band.absorption_per_m + band.scattering_per_m +
                                    diffuse_attenuation_per_m(band));
    return secchi_constant / least;
}

/// Of a middling lake with that much chlorophyll [mg/m3]: chosen between the named lakes.
Constituents middling(double chlorophyll) {
    return {chlorophyll, 0.08 * std::pow(chlorophyll, 0.7), 0.15 * chlorophyll};
}

} // namespace

void Constituents::validate() const {
    require("chlorophyll [mg/m3]", chlorophyll_mg_per_m3, 0.0, 1000.0);
    require("dissolved organic matter's absorption at 440 nm [1/m]", cdom_per_m, 0.0, 50.0);
    require("turbidity [g/m3]", minerals_g_per_m3, 0.0, 1000.0);
}

const std::vector<std::string>& water_type_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> out;
        for (const Named& n : lakes)
            out.emplace_back(n.name);
        for (const Jerlov& j : jerlov_types)
            out.push_back(text("jerlov ", j.name));
        return out;
    }();
    return names;
}

WaterOptics water_type(const std::string& name) {
    for (const Named& n : lakes)
        if (name == n.name)
            return optics_of(name, bands_of(n.in));
    for (const Jerlov& j : jerlov_types)
        if (name == text("jerlov ", j.name))
            return optics_of(name, bands_of(j));
    std::string known;
    for (const std::string& n : water_type_names())
        known += (known.empty() ? "" : ", ") + n;
    throw Error("no water is called '" + name + "'", "use one of: " + known);
}

WaterOptics lake_water(const Constituents& in) {
    in.validate();
    return optics_of(text("chlorophyll ", in.chlorophyll_mg_per_m3, " mg/m3, CDOM ", in.cdom_per_m,
                          " /m at 440 nm, minerals ", in.minerals_g_per_m3, " g/m3"),
                     bands_of(in));
}

double diffuse_attenuation_per_m(const WaterBand& band) {
    const double a = band.absorption_per_m, b = band.scattering_per_m;
    return std::sqrt(a * a + 0.256 * a * b) / mean_cosine;
}

double secchi_depth_m(const WaterOptics& optics) {
    if (optics.bands.empty())
        throw Error("the water '" + optics.name + "' has no bands", "give its scattering, too");
    return secchi_of(optics.bands);
}

WaterOptics water_by_secchi(double secchi_m) {
    require("Secchi depth [m]", secchi_m, 0.1, 80.0);
    double low = 1e-6, high = 1e4; // clear and turbid
    for (int i = 0; i < 100; ++i) {
        const double middle = std::sqrt(low * high);
        const bool clearer = secchi_of(bands_of(middling(middle))) > secchi_m;
        (clearer ? low : high) = middle;
    }
    const Constituents in = middling(low);
    return optics_of(text("Secchi depth ", secchi_m, " m"), bands_of(in));
}

WaterBand band_at(const std::vector<WaterBand>& bands, double nm) {
    const auto above =
        std::lower_bound(bands.begin(), bands.end(), nm, [](const WaterBand& band, double value) {
            return band.wavelength_nm < value;
        });
    if (above == bands.begin())
        return bands.front();
    if (above == bands.end())
        return bands.back();
    const WaterBand &low = *(above - 1), &high = *above;
    const double t = (nm - low.wavelength_nm) / (high.wavelength_nm - low.wavelength_nm);
    return {.wavelength_nm = nm,
            .absorption_per_m = std::lerp(low.absorption_per_m, high.absorption_per_m, t),
            .scattering_per_m = std::lerp(low.scattering_per_m, high.scattering_per_m, t),
            .backscattering_per_m =
                std::lerp(low.backscattering_per_m, high.backscattering_per_m, t)};
}

WaterOptics read_water_table(const std::filesystem::path& path) {
    const std::string hint =
        "write wavelength [nm], a, b [1/m] and, if known, b_b [1/m] on each line";
    std::vector<WaterBand> bands;
    for (const NumberRow& row : read_number_table(path, 3, 4, hint)) {
        const auto& v = row.values;
        bands.push_back({v[0], v[1], v[2], v.size() == 4 ? v[3] : petzold_backward * v[2]});
    }
    if (bands.size() < 2)
        throw Error(path.string() + ": holds fewer than two wavelengths", hint);
    try {
        return optics_of("table " + path.filename().string(), std::move(bands));
    } catch (Error& error) {
        error.during("reading " + path.string());
        throw;
    }
}

} // namespace tarn::scene
