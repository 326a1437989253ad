#include "waves/settings.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <cmath>
#include <tuple>

namespace tarn::waves {

namespace {
void require_range(const std::string& field, double value, double low, double high) {
    if (!(value >= low && value <= high)) // also rejects NaN
        throw Error(text("waves: ", field, " is ", value, ", must be in [", low, ", ", high, "]"));
}
} // namespace

const std::vector<ModelName>& model_names() {
    static const std::vector<ModelName> names = {
        {Model::calm, "calm", "a plane"},
        {Model::sines, "sines", "plane sine waves of a list"},
        {Model::gerstner, "gerstner", "trochoidal waves of a list, or picked from the wind's"},
        {Model::phillips, "phillips", "long-blown sea (Phillips, Tessendorf 2001)"},
        {Model::jonswap, "jonswap", "limited by fetch, deep water (Hasselmann et al. 1973)"},
        {Model::tma, "tma", "limited by fetch and depth (Bouws et al. 1985)"}};
    return names;
}

Model model_from_name(const std::string& name) {
    std::string all;
    for (const ModelName& known : model_names()) {
        if (name == known.name)
            return known.model;
        all += (all.empty() ? "" : ", ") + std::string(known.name);
    }
    throw Error("waves: no model is called '" + name + "'", "use one of " + all);
}

const char* name_of(Model model) {
    for (const ModelName& known : model_names())
        if (model == known.model)
            return known.name;
    return "calm";
}

void Settings::validate() const {
    require_range("wind [m/s]", wind_m_per_s, 0.0, 100.0);
    require_range("wind direction [deg]", wind_from_deg, -1e4, 1e4);
    // Sines are summed at every place; trochoids once for a patch.
    const std::size_t most = model == Model::sines ? 64 : 4096;
    if (list.size() > most)
        throw Error(
            text("waves: the list has ", list.size(), " waves, at most ", most, " are drawn"));
    for (const PlaneWave& w : list) {
        require_range("amplitude [m]", w.amplitude_m, 0.0, 50.0);
        require_range("length [m]", w.length_m, 0.002, 1e4);
        require_range("direction [deg]", w.towards_deg, -1e4, 1e4);
        require_range("phase [rad]", w.phase_rad, -1e6, 1e6);
    }
    if (model == Model::sines && list.empty())
        throw Error("waves: the model 'sines' needs a list of waves", "give it with --wave-list");
    require_range("time [s]", time_s, -1e10, 1e10);
    require_range("loop [s]", loop_s, 0.01, 1e5);
    require_range("choppiness", choppiness, 0.0, 2.0);
    require_range("number of cascades", cascades, 1, 4);
    if (texels < 128 || texels > 2048 || (texels & (texels - 1)) != 0)
        throw Error(text("waves: texels is ", texels, ", must be 128, 256, 512, 1024 or 2048"));
    require_range("spreading", spreading, 0.0, 20.0);
    if (fetch_m)
        require_range("fetch [m]", *fetch_m, 1.0, 1e6);
    if (depth_m)
        require_range("depth [m]", *depth_m, 0.0, 1e4);
    if (shortest_m)
        require_range("shortest wave [m]", *shortest_m, 0.017, 1e3);
    if (patch_m)
        require_range("patch [m]", *patch_m, 0.5, 1e5);
    require_range("rain [drops/(m2 s)]", ripples.rain_drops_per_m2_s, 0.0, 1e4);
    if (cascades + (ripples.rain_drops_per_m2_s > 0.0) + !ripples.pokes.empty() > 4)
        throw Error(
            "waves: rain and pokes take the place of a cascade each, four patches are drawn",
            "use fewer --wave-cascades");
    if (ripples.pokes.size() > 16)
        throw Error(text("waves: ", ripples.pokes.size(), " pokes, at most 16 are drawn"));
    for (const Poke& poke : ripples.pokes) {
        require_range("place of a poke [m]", std::abs(poke.x_m) + std::abs(poke.y_m), 0.0, 1e8);
        require_range("height of a poke [m]", poke.height_m, -5.0, 5.0);
        require_range("radius of a poke [m]", poke.radius_m, 0.05, 20.0);
        require_range("time of a poke [s]", poke.time_s, -1e10, 1e10);
    }
    require_range("height of drops [m]", ripples.drop_height_m, 0.0, 0.1);
}

bool operator==(const Settings& a, const Settings& b) {
    const auto flat = [](const Settings& s) {
        std::vector<double> list;
        for (const PlaneWave& w : s.list)
            list.insert(list.end(), {w.amplitude_m, w.length_m, w.towards_deg, w.phase_rad});
        return std::tuple(s.model, s.wind_m_per_s, s.wind_from_deg, list, s.time_s, s.loop_s,
                          s.choppiness, s.cascades, s.texels, s.seed, s.spreading, s.fetch_m,
                          s.depth_m, s.shortest_m, s.patch_m, s.ripples.rain_drops_per_m2_s,
                          s.ripples.drop_height_m);
    };
    return flat(a) == flat(b) && a.ripples.pokes == b.ripples.pokes;
}

} // namespace tarn::waves
