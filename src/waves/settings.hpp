#pragma once
/// @file settings.hpp  Which waves a picture shows: plain data, as a scene folder or a person says
/// it.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tarn::waves {

enum class Model {
    calm,     ///< a plane; costs nothing
    sines,    ///< the plane sine waves of a list, in closed form
    gerstner, ///< trochoidal waves: of a list, or picked from the lake's spectrum
    phillips, ///< spectrum of a sea that the wind has long blown over (Phillips; Tessendorf 2001)
    jonswap,  ///< spectrum of waves that the fetch limits, deep water (Hasselmann et al. 1973)
    tma       ///< the same in shallow water (Bouws et al. 1985)
};

struct ModelName {
    Model model;
    const char* name;  ///< as typed and shown
    const char* about; ///< one line
};
/// All models, calm first.
const std::vector<ModelName>& model_names();
/// @throws tarn::Error  if there is none of that name; lists those that there are
Model model_from_name(const std::string& name);
const char* name_of(Model model);

/// eta = amplitude cos(k . x - omega t + phase), with omega from the dispersion relation.
struct PlaneWave {
    double amplitude_m = 0.0; ///< [0, 50]
    double length_m = 1.0;    ///< [0.002, 1e4]
    double towards_deg = 0.0; ///< the way it travels, clockwise from grid north
    double phase_rad = 0.0;
};

/// Something that falls into the water, or a finger that dips into it.
struct Poke {
    double x_m = 0.0, y_m = 0.0; ///< scene place
    double height_m = 0.2;       ///< of the dent that it leaves, [-5, 5]
    double radius_m = 0.5;       ///< [0.05, 20]
    double time_s = 0.0;         ///< [-1e10, 1e10]
    friend bool operator==(const Poke&, const Poke&) = default;
};

/// Rain and drops on a square of water that moves by the wave equation (waves/ripples.hpp).
struct RippleSettings {
    double rain_drops_per_m2_s = 0.0; ///< [0, 1e4]; 0: no ripples
    std::vector<Poke> pokes;          ///< at most 16, rings of all on one square of water
    double drop_height_m = 0.004;     ///< of the ring that a drop leaves, [0, 0.1]
};

/// Every field has a unit, a legal range and a default that suits most lakes.
struct Settings {
    Model model = Model::calm;
    double wind_m_per_s = 4.0;    ///< at 10 m, [0, 100]
    double wind_from_deg = 240.0; ///< clockwise from grid north
    std::vector<PlaneWave> list;  ///< of `sines`, at most 64, and `gerstner`, at most 4096
    double time_s = 0.0;          ///< [-1e10, 1e10]
    double loop_s = 600.0;        ///< the water repeats itself after this, [0.01, 1e5]
    double choppiness = 1.0; ///< share of the horizontal displacement, [0, 2]; bounded: see Sea
    int cascades = 3;        ///< [1, 4]
    int texels = 512;        ///< a side of each: 128, 256, 512, 1024 or 2048
    std::uint32_t seed = 1;  ///< same seed, same sea
    double spreading = 2.0;  ///< Phillips' directional exponent, [0, 20]
    std::optional<double> fetch_m;    ///< [1, 1e6]; none: from the lake's shape
    std::optional<double> depth_m;    ///< of the dispersion relation, [0, 1e4]; none: lake's mean
    std::optional<double> shortest_m; ///< small-wave cut-off, [0.017, 1e3]; none: by Cox & Munk
    std::optional<double> patch_m;    ///< side of the first cascade, [0.5, 1e5]; none: by the waves
    RippleSettings ripples;

    bool calm() const {
        return model == Model::calm && !(ripples.rain_drops_per_m2_s > 0.0) &&
               ripples.pokes.empty();
    }
    /// @throws tarn::Error  naming the field, its value and the legal range
    void validate() const;
    friend bool operator==(const Settings&, const Settings&);
};

} // namespace tarn::waves
