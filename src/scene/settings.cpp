#include "scene/settings.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::scene {

namespace {
template <class T>
void require_range(const char* field, T value, T low, T high) {
    if (!(value >= low && value <= high)) // also rejects NaN
        throw Error(text(field, " is ", value, ", must be in [", low, ", ", high, "]"));
}
} // namespace

void RenderSettings::validate() const {
    require_range("width", width_px, 1, 16384);
    require_range("height", height_px, 1, 16384);
    require_range("samples", samples, 1, 1024);
    if (strip) {
        require_range("first row of the strip", strip->first_row, 0, height_px - 1);
        require_range("rows of the strip", strip->rows, 1, height_px - strip->first_row);
        if (strip->first_row % 8 != 0)
            throw Error(
                text("first row of the strip is ", strip->first_row, ", must be a multiple of 8"));
    }
    require_range("least transmittance", least_transmittance, 1e-6, 0.5);
    if (caustic_texels != 0)
        require_range("texels of the caustics", caustic_texels, 16, 2048);
    if (caustic_photons != 1 && caustic_photons != 2 && caustic_photons != 4)
        throw Error(
            text("photons of the caustics are ", caustic_photons, " a side, must be 1, 2 or 4"));
    require_range("steps of the shafts", shaft_steps, 0, 256);
    require_range("prisms of light", shaft_prisms, 4, 512);
    require_range("splits of the reference", reference_splits, 1, 8);
    require_range("dive light", dive_light_cd, 0.0, 1e6);
    require_range("radius of the port", port_m, 0.0, 2.0);
    if (walk_setting != 0.0)
        require_range("intersection setting", walk_setting, 1.0, 65536.0);
    if (ground_albedo)
        require_range("ground albedo", *ground_albedo, 0.0, 1.0);
    if (contours_m)
        require_range("interval of the contours", *contours_m, 0.01, 1e4);
    if (depth_contours_m)
        require_range("interval of the depth contours", *depth_contours_m, 0.01, 1e4);
    if (depth_colours_m)
        require_range("depth of the darkest colour", *depth_colours_m, 0.01, 1e5);
}

const std::vector<WalkMethod>& walk_methods() {
    static const std::vector<WalkMethod> methods = {
        {Walk::cone_map, "cone-map", "after Dummer 2006, made exact", true, 0, ""},
        {Walk::maximum_mipmap, "maximum-mipmap", "after Tevs et al. 2008", true, 0, ""},
        {Walk::safety_exact, "safety-exact", "after Baboud & Decoret 2006, made exact", true, 0,
         ""},
        {Walk::grid, "grid", "Amanatides & Woo 1987", true, 0, ""},
        {Walk::safety_radius, "safety-radius", "Baboud & Decoret 2006", false, 8, "halvings"},
        {Walk::cone_steps, "cone-steps", "Dummer 2006", false, 32, "steps"},
        {Walk::uniform_steps, "uniform-steps", "Policarpo et al. 2005", false, 64, "steps"},
        {Walk::direction_steps, "direction-steps", "Tatarchuk 2006", false, 48, "steps"},
    };
    return methods;
}

const std::vector<CausticsMethod>& caustics_methods() {
    static const std::vector<CausticsMethod> methods = {
        {Caustics::off, "off", "as below flat water"},
        {Caustics::splat, "splat", "photons shared out where they land"},
        {Caustics::photon_map, "photon-map", "Baboud & Decoret 2006"},
        {Caustics::mesh, "mesh", "Wallace 2016"},
        {Caustics::back, "back", "after Guardado & Sanchez-Crespo 2004"},
    };
    return methods;
}

const WalkMethod& walk_method(Walk walk) {
    const auto& methods = walk_methods();
    return *std::find_if(methods.begin(), methods.end(),
                         [&](const WalkMethod& m) { return m.walk == walk; });
}

View at_its_best(View view) {
    RenderSettings& s = view.settings;
    s.least_transmittance = std::min(s.least_transmittance, 1e-4);
    if (s.caustics != Caustics::off) {
        s.caustics = Caustics::splat;
        s.caustic_texels = view.waves.texels;
        s.caustic_photons = 2;
        s.shafts = Shafts::march;
        if (s.shaft_steps > 0)
            s.shaft_steps = std::max(s.shaft_steps, 16);
    }
    return view;
}

glm::dvec2 sample_offset(int index, int count) {
    if (count == 1)
        return {0.5, 0.5};
    constexpr double plastic = 1.32471795724474602596; // root of x^3 = x + 1
    const auto fraction = [](double x) { return x - std::floor(x); };
    return {fraction(0.5 + (index + 1) / plastic),
            fraction(0.5 + (index + 1) / (plastic * plastic))};
}

double shadow_lift_m(const Heightfield& ground) {
    return 0.01 * ground.spacing_m + 2.0 * ground.scale_m;
}

double block_bottom_m(const Heightfield& ground) {
    const double side = std::max(ground.size().cols, ground.size().rows) * ground.spacing_m;
    return ground.min_elevation_m() - side / 30.0;
}

double greatest_path_m(const WaterOptics& optics, const RenderSettings& settings) {
    const glm::dvec3 c = optics.attenuation_per_m();
    double least = std::min({c.x, c.y, c.z});
    if (settings.spectral)
        for (const WaterBand& band : optics.bands)
            if (band.wavelength_nm >= 400.0 && band.wavelength_nm <= 700.0)
                least = std::min(least, band.attenuation_per_m());
    return least > 1e-8 ? std::min(1e9, -std::log(settings.least_transmittance) / least) : 1e9;
}

} // namespace tarn::scene
