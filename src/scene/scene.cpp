#include "scene/scene.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::scene {

namespace {

void require_range(const char* field, double value, double low, double high) {
    if (!(value >= low && value <= high)) // also rejects NaN
        throw Error(text(field, " is ", value, ", must be in [", low, ", ", high, "]"));
}

void validate_field(const char* name, const Heightfield& field) {
    if (field.size().cols < 2 || field.size().rows < 2 ||
        field.codes.values.size() != field.size().count())
        throw Error(text(name, " is ", field.size().cols, " x ", field.size().rows,
                         ", need at least 2 x 2"));
    require_range(text(name, " spacing_m").c_str(), field.spacing_m, 1e-4, 1e6);
    require_range(text(name, " scale_m").c_str(), field.scale_m, 1e-9, 1e4);
    require_range(text(name, " offset_m").c_str(), field.offset_m, -1e5, 1e5);
    require_range(text(name, " west_m").c_str(), field.west_m, -1e8, 1e8);
    require_range(text(name, " north_m").c_str(), field.north_m, -1e8, 1e8);
}

} // namespace

void WaterOptics::validate() const {
    if (bands.size() == 1 || bands.size() > 1000)
        throw Error(text("the water has ", bands.size(), " bands, must have none or 2 to 1000"));
    double before = 0.0;
    for (const WaterBand& band : bands) {
        const std::string at = text(" at ", band.wavelength_nm, " nm");
        require_range("wavelength_nm", band.wavelength_nm, 350.0, 800.0);
        require_range(("absorption_per_m" + at).c_str(), band.absorption_per_m, 0.0, 100.0);
        require_range(("scattering_per_m" + at).c_str(), band.scattering_per_m, 0.0, 1000.0);
        require_range(("backscattering_per_m" + at).c_str(), band.backscattering_per_m, 0.0,
                      std::min(band.scattering_per_m, 100.0));
        if (!(band.wavelength_nm > before))
            throw Error(text("the water's wavelengths must rise", at));
        before = band.wavelength_nm;
    }
    for (int k = 0; k < 3; ++k) {
        require_range("absorption_per_m", absorption_per_m[k], 0.0, 100.0);
        require_range("backscattering_per_m", backscattering_per_m[k], 0.0, 100.0);
    }
    require_range("index", index, 1.0, 3.0);
}

GroundLook ground_look(double lat_deg) {
    const double snow = 5400.0 - 58.0 * std::abs(lat_deg);
    return {.tree_line_m = snow - 800.0, .snow_line_m = snow};
}

const LakeRecord& Scene::lake_at_level(double level_m) const {
    return *std::min_element(lakes.begin(), lakes.end(), [&](const auto& a, const auto& b) {
        return std::abs(a.level_m - level_m) < std::abs(b.level_m - level_m);
    });
}

std::optional<double> Scene::water_level_m(double x, double y) const {
    const double c = water.col(x), r = water.row(y);
    if (!(c >= 0.0 && r >= 0.0 && c <= water.size().cols - 1 && r <= water.size().rows - 1))
        return {};
    // A cell that touches water holds its level at all four nodes: the nearest node will do.
    const Node node{int(std::lround(c)), int(std::lround(r))};
    if (water.codes[node] == no_water_code)
        return {};
    const double level = water.elevation_m(node);
    if (ground.elevation_m(x, y) >= level)
        return {};
    return level;
}

bool Scene::under_water(const glm::dvec3& place) const {
    const auto level = water_level_m(place.x, place.y);
    return level && place.z < *level;
}

void Scene::validate() const {
    validate_field("ground", ground);
    validate_field("water", water);
    if (!(ground.size() == water.size()) || ground.spacing_m != water.spacing_m ||
        ground.west_m != water.west_m || ground.north_m != water.north_m)
        throw Error("ground and water are not on one grid", "import the scene again");
    if (lakes.empty())
        throw Error("the scene has no lake", "import it again with --level");
    for (const LakeRecord& lake : lakes) {
        require_range("lake level_m", lake.level_m, -12'000.0, 12'000.0);
        if (!ground.codes.contains(lake.seed) || !ground.codes.contains(lake.west_north) ||
            !ground.codes.contains(lake.east_south))
            throw Error(text("lake ", lake.id, " lies outside the grid"), "import the scene again");
        const double drawn_m = water.elevation_m(lake.seed);
        // Levels far apart share 16 bits: half a step is as near as they come.
        const double near_m = std::max(0.01, 0.51 * water.scale_m);
        if (water.codes[lake.seed] == no_water_code || std::abs(drawn_m - lake.level_m) > near_m)
            throw Error(
                text("lake ", lake.id, " level_m is ", lake.level_m,
                     ", but the water heights hold ",
                     water.codes[lake.seed] == no_water_code ? "no water" : text(drawn_m, " m"),
                     " at its seed"),
                "import the scene again with the new --level");
        if (lake.bed != Bed::unknown &&
            (!lake.volume_m3 || !lake.max_depth_m || !lake.mean_depth_m))
            throw Error(text("lake ", lake.id, " has a bed but no volume or depth"),
                        "import the scene again");
    }
    optics.validate();
    require_range("tree_line_m", look.tree_line_m, -1e5, 1e5);
    require_range("snow_line_m", look.snow_line_m, -1e5, 1e5);
}

} // namespace tarn::scene
