#pragma once
/// @file water_types.hpp  Named waters, and waters by what a limnologist measures -> WaterOptics.
///
/// Every result has 31 bands, 400 to 700 nm in steps of 10, and the three channels taken from
/// them. Models and their sources: docs/physics/water-types.md.
#include "scene/water_optics.hpp"

#include <filesystem>

namespace tarn::scene {

/// What is in the water besides water.
struct Constituents {
    double chlorophyll_mg_per_m3 = 0.0; ///< phytoplankton, [0, 1000]
    double cdom_per_m = 0.0;        ///< absorption of dissolved organic matter at 440 nm, [0, 50]
    double minerals_g_per_m3 = 0.0; ///< suspended; about the turbidity in NTU, [0, 1000]

    /// @throws tarn::Error  naming the field, its value and the legal range
    void validate() const;
};

/// The names that water_type() knows: pure, lakes, Jerlov's types.
const std::vector<std::string>& water_type_names();

/// @throws tarn::Error  if there is no type of that name; lists those that there are
WaterOptics water_type(const std::string& name);

/// @throws tarn::Error  if a constituent is out of range
WaterOptics lake_water(const Constituents& constituents);

/// Water in which a white disc disappears at that depth, of a middling lake's make-up.
///
/// @param secchi_m  [0.1, 80]
/// Source  (c + Kd) Z = ln(C0 / Cmin) = 8.7 (Tyler 1968; Preisendorfer 1986) where light goes
///         farthest, Kd by Kirk (1984).
/// @throws tarn::Error  if the depth is out of range
WaterOptics water_by_secchi(double secchi_m);

/// The Secchi depth that the same rule gives for any water with bands [m].
double secchi_depth_m(const WaterOptics& optics);

/// Diffuse attenuation of downward light [1/m]: sqrt(a^2 + .256 a b) / .86 (Kirk 1984, for light
/// whose mean cosine below the surface is .86).
double diffuse_attenuation_per_m(const WaterBand& band);

/// A table of one's own: lines of wavelength [nm], a, b [1/m] and, optionally, b_b (otherwise
/// .0183 b, Petzold's mean); separated by commas or blanks; `#` and a heading are passed over.
/// @throws tarn::Error  naming file and line
WaterOptics read_water_table(const std::filesystem::path& path);

/// The band at a wavelength, linear between bands, the last one beyond them.
/// @pre  bands are not empty
WaterBand band_at(const std::vector<WaterBand>& bands, double wavelength_nm);

} // namespace tarn::scene
