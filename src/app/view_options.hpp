#pragma once
/// @file view_options.hpp  Camera, light and picture settings as people write them -> a View.
#include "dem/refill.hpp"
#include "scene/settings.hpp"

#include <CLI/App.hpp>
#include <string>

namespace tarn::app {

/// What was typed; empty = not given. The same names serve on the command line and in a settings
/// file.
struct ViewWords {
    std::string camera = "overview", size = "1280x720";
    std::string time, sun, sun_place, sun_direction, sun_irradiance, sky_radiance;
    std::string absorption, backscattering;
    std::optional<std::string> water, water_table;
    std::optional<double> visibility_km;
    std::string environment;
    double environment_turn_deg = 0.0;
    std::optional<double> secchi, chlorophyll, cdom, turbidity;
    std::string colour = "spectral";
    bool no_thrown_back = false, no_forward_glow = false;
    std::optional<double> index;
    std::string fresnel = "exact", intersection = "cone-map", caustics = "splat", shafts = "march";
    std::string curvature = "auto", layers_on = "all";
    bool coarse_far_land = false;
    bool no_shadows = false, no_reflection = false, no_mirrored_land = false, no_refraction = false,
         no_sun_disc = false;
    scene::RenderSettings settings;
    // Waves: what is not given is as the scene says.
    std::optional<std::string> waves, wave_list, wind_rose, pokes;
    std::optional<double> wind, wind_from, wave_time, wave_loop, choppiness, spreading, fetch,
        wave_depth, shortest_wave, wave_patch, rain;
    std::optional<int> wave_cascades, wave_texels;
    std::optional<std::uint32_t> wave_seed;
    std::optional<double> level_m; ///< of the lake that moves; default: as imported
    int lake = 1;                  ///< its id
    std::string layers, layers_3d; ///< vector files, colons between them
    std::string layers_3d_heights = "datum";
    bool layers_3d_lit = false;
    std::string settings_file;
};

/// Adds these options to a command, and --settings FILE that reads them.
void add_view_options(CLI::App& command, ViewWords& words);

/// True minus grid azimuth at the first lake.
double convergence_deg(const scene::Scene& scene);

/// Only those that choose the waves.
void add_wave_options(CLI::App& command, ViewWords& words);

/// Only those that choose the water.
void add_water_options(CLI::App& command, ViewWords& words);

/// The water that the words ask for, over what the scene says.
/// @throws tarn::Error  naming the option and what is wrong
scene::WaterOptics make_water(const ViewWords& words, const scene::Scene& scene);

/// The waves that the words ask for, over what the scene says.
/// @throws tarn::Error  naming the option and what is wrong
waves::Settings make_waves(const ViewWords& words, const scene::Scene& scene);

/// Takes from the file named by --settings what was not typed.
/// @throws tarn::Error  naming the file and the line's name, if that is no option or has a bad
/// value
void apply_settings_file(CLI::App& command, const ViewWords& words);

/// Reads a scene folder, its lake at the level that the words ask for.
/// @throws tarn::Error  naming what cannot be
scene::Scene load_scene(const std::string& folder, const ViewWords& words);

/// What moves the level of a lake of a scene just loaded; takes the folder's exact heights.
/// @throws tarn::Error
dem::Refill make_refill(const std::string& folder, const scene::Scene& scene, int lake_id,
                        const Progress& progress);

/// Moves the level of a scene: its water, lakes and the bed that falls dry.
/// @throws tarn::Error  if it cannot stand there
void move_level(dem::Refill& refill, double level_m, scene::Scene& scene, bool shore);

/// "300:320:0.5" (both ends included) or "300,310,313.31": levels [m].
/// @throws tarn::Error
std::vector<double> parse_levels(const std::string& words);

/// The view that the words ask for. Water optics given by hand are put into the scene.
/// @throws tarn::Error  naming the option and what is wrong
scene::View make_view(const ViewWords& words, scene::Scene& scene);

/// Unit vector towards the sun in scene axes (grid north, not true north), at the first lake.
glm::dvec3 sun_direction(const scene::Scene& scene, const GeoPoint& place, double julian_date_utc);

/// Where the sun is seen from: as was asked, else the first lake.
/// @throws tarn::Error  naming the option
GeoPoint sun_place(const ViewWords& words, const scene::Scene& scene);

} // namespace tarn::app
