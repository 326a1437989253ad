#pragma once
/// @file view_options.hpp  Camera, light and picture settings as people write them -> a View.
#include "scene/settings.hpp"

#include <CLI/App.hpp>
#include <string>

namespace tarn::app {

/// What was typed; empty = not given. The same names serve on the command line and in a settings
/// file.
struct ViewWords {
    std::string camera = "overview", size = "1280x720";
    std::string time, sun, sun_direction, sun_irradiance, sky_radiance;
    std::string absorption, backscattering;
    std::optional<double> index;
    std::string fresnel = "exact", intersection = "cone-map";
    bool no_shadows = false, no_reflection = false, no_refraction = false, no_sun_disc = false;
    scene::RenderSettings settings;
    std::string settings_file;
};

/// Adds these options to a command, and --settings FILE that reads them.
void add_view_options(CLI::App& command, ViewWords& words);

/// Takes from the file named by --settings what was not typed.
/// @throws tarn::Error  naming the file and the line's name, if that is no option or has a bad
/// value
void apply_settings_file(CLI::App& command, const ViewWords& words);

/// The view that the words ask for. Water optics given by hand are put into the scene.
/// @throws tarn::Error  naming the option and what is wrong
scene::View make_view(const ViewWords& words, scene::Scene& scene);

/// Unit vector towards the sun in scene axes (grid north, not true north), at the first lake.
glm::dvec3 sun_direction(const scene::Scene& scene, double julian_date_utc);

} // namespace tarn::app
