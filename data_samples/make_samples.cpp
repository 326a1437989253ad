// tarn_make_samples FOLDER [caldera|bowl] — writes the sample elevation models that the README's
// tour uses.
#include "caldera.hpp"
#include "core/error.hpp"
#include "dem/write.hpp"

#include <cmath>
#include <filesystem>
#include <iostream>
#include <string>

namespace {

/// z = 40 (r/500)^2 m, so that everything about the lake at 10 m is known: docs/testing.md.
void write_bowl(const std::filesystem::path& path) {
    constexpr int side = 501;
    constexpr double spacing = 2.0, half = 0.5 * (side - 1) * spacing;
    tarn::Grid<float> z({side, side});
    for (int row = 0; row < side; ++row)
        for (int col = 0; col < side; ++col) {
            const double x = col * spacing - half, y = half - row * spacing;
            z[{col, row}] = static_cast<float>(40.0 * (x * x + y * y) / (500.0 * 500.0));
        }
    const double transform[6] = {500'000.0 - half - 1.0,   spacing, 0.0,
                                 5'300'000.0 + half + 1.0, 0.0,     -spacing};
    tarn::dem::write_elevations(path, z, "EPSG:32633", transform,
                                "Analytic bowl z = 40 (r/500)^2 m; not a real place");
}

} // namespace

int main(int argc, char** argv) {
    const std::string which = argc == 3 ? argv[2] : "";
    if (argc < 2 || argc > 3 || (argc == 3 && which != "caldera" && which != "bowl")) {
        std::cerr << "usage: tarn_make_samples FOLDER [caldera|bowl]\n";
        return 2;
    }
    try {
        const std::filesystem::path folder = argv[1];
        std::filesystem::create_directories(folder);
        if (which != "bowl") {
            const auto c = tarn::samples::make_caldera(25.0);
            const double transform[6] = {c.west_m, c.spacing_m, 0.0, c.north_m, 0.0, -c.spacing_m};
            tarn::dem::write_elevations(
                folder / "caldera.tif", c.elevation_m, "EPSG:32610", transform,
                "Crater Lake, Oregon: RECONSTRUCTION from published figures, not a survey");
            std::cout << "wrote " << (folder / "caldera.tif").string() << ": level "
                      << tarn::samples::caldera_level_m << " m, " << c.area_m2 / 1e6 << " km2, "
                      << c.volume_m3 / 1e9 << " km3, greatest depth " << c.max_depth_m << " m\n";
        }
        if (which != "caldera") {
            write_bowl(folder / "bowl.tif");
            std::cout << "wrote " << (folder / "bowl.tif").string() << "\n";
        }
        return 0;
    } catch (const std::exception& error) {
        std::cerr << "tarn_make_samples: " << error.what() << "\n";
        return 1;
    }
}
