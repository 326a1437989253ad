// What three channels get wrong about the colour of water, and what each type of water is like:
// figures and plots of docs/physics/water-types.md. Writes data files for scripts/water-study.
#include "core/text.hpp"
#include "reference/medium.hpp"
#include "scene/water_types.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <iostream>

using namespace tarn;

namespace {

/// CIELAB of linear sRGB, white 1; colours outside the gamut are brought in by clipping.
glm::dvec3 lab(glm::dvec3 c) {
    c = glm::max(c, glm::dvec3(0.0));
    const glm::dvec3 xyz(0.4124 * c.x + 0.3576 * c.y + 0.1805 * c.z,
                         0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z,
                         0.0193 * c.x + 0.1192 * c.y + 0.9505 * c.z);
    const auto f = [](double t) {
        return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0;
    };
    const double x = f(xyz.x / 0.9505), y = f(xyz.y), z = f(xyz.z / 1.089);
    return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: tarn_water_study FOLDER\n";
        return 2;
    }
    const std::filesystem::path folder = argv[1];
    std::ofstream colours(folder / "colours.dat"), spectra(folder / "spectra.dat");
    std::cout << "| water | Secchi depth [m] | farthest light [nm] | Kd there [1/m] | c at 550 nm "
                 "[1/m] | "
                 "greatest colour error of three channels (delta E) | at depth [m] |\n"
                 "| --- | --- | --- | --- | --- | --- | --- |\n";
    for (const std::string& name : scene::water_type_names()) {
        const scene::WaterOptics optics = scene::water_type(name);
        const reference::Medium spectral(optics, true), rgb(optics, false);
        double worst = 0.0, worst_at = 0.0;
        colours << "# " << name << "\n";
        for (double depth = 0.0; depth <= 40.0; depth += 0.25) {
            // A white bed straight below: down and up again.
            const glm::dvec3 s = spectral.transmittance(2.0 * depth),
                             t = rgb.transmittance(2.0 * depth);
            const double error = glm::length(lab(s) - lab(t));
            if (error > worst) {
                worst = error;
                worst_at = depth;
            }
            colours << depth << " " << error << " " << s.x << " " << s.y << " " << s.z << " " << t.x
                    << " " << t.y << " " << t.z << "\n";
        }
        colours << "\n\n";
        const auto clearest =
            std::min_element(optics.bands.begin(), optics.bands.end(), [](auto& a, auto& b) {
                return scene::diffuse_attenuation_per_m(a) < scene::diffuse_attenuation_per_m(b);
            });
        spectra << "# " << name << "\n";
        for (const scene::WaterBand& b : optics.bands)
            spectra << b.wavelength_nm << " " << scene::diffuse_attenuation_per_m(b) << " "
                    << b.absorption_per_m << " " << b.scattering_per_m << "\n";
        spectra << "\n\n";
        const scene::WaterBand green = scene::band_at(optics.bands, 550);
        std::cout << "| " << name << " | " << fixed(scene::secchi_depth_m(optics), 1) << " | "
                  << clearest->wavelength_nm << " | "
                  << fixed(scene::diffuse_attenuation_per_m(*clearest), 3) << " | "
                  << fixed(green.absorption_per_m + green.scattering_per_m, 3) << " | "
                  << fixed(worst, 1) << " | " << fixed(worst_at, 1) << " |\n";
    }
}
