#include "app/view_options.hpp"

#include "app/console.hpp"
#include "app/layers.hpp"
#include "core/angles.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "geo/frame.hpp"
#include "geo/sun.hpp"
#include "image/files.hpp"
#include "scene/environment.hpp"
#include "scene/presets.hpp"
#include "scene/water_types.hpp"
#include "scene_files/scene_folder.hpp"
#include "scene_files/sidecar.hpp"
#include "waves/wind_rose.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <map>

namespace tarn::app {

namespace {

glm::dvec3 towards(double azimuth_deg, double elevation_deg) {
    const double a = azimuth_deg * degree, e = elevation_deg * degree;
    return {std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e)};
}

/// True minus grid azimuth at a place of the scene.
double convergence_at(const scene::Scene& scene, double x, double y) {
    return geo::convergence_deg(scene.frame, {x, y});
}

/// "key=value,key=value" with every key known.
std::map<std::string, double> parse_pairs(const std::string& words) {
    static const char* known[] = {"lat",         "lon",     "x",     "y",   "z",  "above_ground",
                                  "above_water", "heading", "pitch", "fov", "dx", "dy",
                                  "dz",          "ux",      "uy",    "uz"};
    std::map<std::string, double> out;
    std::size_t from = 0;
    while (from <= words.size()) {
        const std::size_t comma = std::min(words.find(',', from), words.size());
        const std::string pair = words.substr(from, comma - from);
        const std::size_t equals = pair.find('=');
        const std::string key = pair.substr(0, equals);
        if (equals == std::string::npos ||
            std::find(std::begin(known), std::end(known), key) == std::end(known))
            throw Error("--camera: '" + pair + "' is not understood",
                        "use a camera's name, or lat, lon or x, y; above_ground, above_water or z; "
                        "heading, pitch or dx, dy, dz, ux, uy, uz; fov - each as key=number");
        if (!out.emplace(key, parse_numbers("--camera " + key, pair.substr(equals + 1), 1)[0])
                 .second)
            throw Error("--camera: '" + key + "' is given twice");
        from = comma + 1;
    }
    return out;
}

scene::Camera parse_camera(const std::string& words, const scene::Scene& scene, glm::dvec3 sun,
                           double aspect) {
    if (words.find('=') == std::string::npos) {
        for (const scene::NamedCamera& named : scene.cameras)
            if (named.name == words)
                return named.camera;
        const auto& presets = scene::preset_names();
        if (std::find(presets.begin(), presets.end(), words) == presets.end()) {
            std::string names;
            for (const scene::NamedCamera& named : scene.cameras)
                names += (names.empty() ? "" : ", ") + named.name;
            throw Error("--camera: no camera is called '" + words + "'",
                        "use " + names + ", or key=number pairs (tarn render --help)");
        }
        return scene::preset_camera(scene, scene.lakes.front(), words, sun, aspect);
    }
    const auto pairs = parse_pairs(words);
    const auto has = [&](const char* key) { return pairs.count(key) != 0; };
    const auto get = [&](const char* key, double otherwise) {
        return has(key) ? pairs.at(key) : otherwise;
    };
    const auto exclude = [&](const char* a, const char* b) {
        if (has(a) && has(b))
            throw Error(text("--camera: ", a, " and ", b, " exclude each other"));
    };
    glm::dvec3 position(0.0);
    if (has("lat") || has("lon")) {
        exclude("lat", "x");
        exclude("lat", "y");
        if (!has("lat") || !has("lon"))
            throw Error("--camera: lat and lon go together");
        const ScenePoint p = geo::to_scene(scene.frame, {pairs.at("lat"), pairs.at("lon")});
        position = {p.x_m, p.y_m, 0.0};
    } else if (has("x") && has("y")) {
        position = {pairs.at("x"), pairs.at("y"), 0.0};
    } else {
        throw Error("--camera: no place given", "add lat=..,lon=.. or x=..,y=.. (scene metres)");
    }
    exclude("above_ground", "above_water");
    exclude("above_ground", "z");
    exclude("above_water", "z");
    if (has("z"))
        position.z = pairs.at("z");
    else if (has("above_water"))
        position.z =
            scene.water_level_m(position.x, position.y).value_or(scene.lakes.front().level_m) +
            pairs.at("above_water");
    else
        position.z = scene.ground.elevation_m(position.x, position.y) + get("above_ground", 2.0);
    const double fov = get("fov", 50.0);
    if (has("dx") || has("dy") || has("dz")) {
        exclude("dx", "heading");
        exclude("dy", "heading");
        exclude("dz", "pitch");
        return scene::look_along(
            position, {get("dx", 0), get("dy", 0), get("dz", 0)},
            {get("ux", 0), get("uy", 0), get("uz", has("ux") || has("uy") ? 0 : 1)}, fov);
    }
    const double heading = get("heading", 0.0) - convergence_at(scene, position.x, position.y);
    if (!(fov > 0.0 && fov <= 170.0))
        throw Error(text("--camera: fov is ", fov, " degrees, must be in (0, 170]"));
    return scene::look(position, heading, std::clamp(get("pitch", 0.0), -90.0, 90.0), fov);
}

} // namespace

std::vector<double> parse_levels(const std::string& words) {
    std::vector<double> out;
    if (words.find(':') == std::string::npos) {
        const auto count = std::size_t(std::count(words.begin(), words.end(), ',')) + 1;
        out = parse_numbers("--levels", words, count);
    } else {
        std::string commas = words;
        std::replace(commas.begin(), commas.end(), ':', ',');
        if (std::count(words.begin(), words.end(), ':') != 2)
            throw Error("--levels " + words + " makes no table", "write FROM:TO:STEP or a list");
        const auto v = parse_numbers("--levels", commas, 3);
        if (!(v[2] > 0.0 && v[1] >= v[0]) || !((v[1] - v[0]) / v[2] < 10'000.0))
            throw Error("--levels " + words + " makes no table",
                        "write FROM:TO:STEP with FROM <= TO, a positive step and at most 10000 "
                        "levels");
        for (int i = 0; v[0] + i * v[2] <= v[1] + 1e-6 * v[2]; ++i)
            out.push_back(v[0] + i * v[2]);
    }
    for (const double level : out)
        if (!(std::abs(level) <= 12'000.0))
            throw Error(text("--levels: ", level, " m is no level, must be in [-12000, 12000]"));
    return out;
}

scene::Scene load_scene(const std::string& folder, const ViewWords& words) {
    scene::Scene scene = scene_files::load(folder);
    const std::vector<scene::MapLayer> layers = read_layers(words, scene.frame);
    if (words.level_m) {
        const Progress progress = console_progress();
        dem::Refill refill = make_refill(folder, scene, words.lake, progress);
        move_level(refill, *words.level_m, scene, true);
        end_progress();
    }
    lay_layers(layers, scene);
    return scene;
}

void move_level(dem::Refill& refill, double level_m, scene::Scene& scene, bool shore) {
    refill.fill(level_m, scene.ground, scene.water, scene.lakes, shore);
    scene.exposed_bed.reset();
    if (level_m < refill.lake().level_m)
        if (auto bare = refill.exposed_bed())
            scene.exposed_bed = {refill.lake().level_m, std::move(*bare)};
}

dem::Refill make_refill(const std::string& folder, const scene::Scene& scene, int lake_id,
                        const Progress& progress) {
    return dem::Refill(scene_files::load_heights(folder, scene), scene.ground, scene.water,
                       scene.frame, scene.lakes, lake_id, progress);
}

GeoPoint sun_place(const ViewWords& w, const scene::Scene& scene) {
    if (w.sun_place.empty())
        return scene.lakes.front().position;
    const auto v = parse_numbers("--sun-place", w.sun_place, 2);
    if (std::abs(v[0]) > 90.0 || std::abs(v[1]) > 360.0)
        throw Error("--sun-place '" + w.sun_place + "' is nowhere on Earth",
                    "write LATITUDE,LONGITUDE in degrees");
    return {v[0], v[1]};
}

glm::dvec3 sun_direction(const scene::Scene& scene, const GeoPoint& place, double julian_date_utc) {
    const geo::SunPosition sun = geo::sun_position(place, julian_date_utc);
    // Wherever the sun is seen from, its azimuth is turned from the lake's true north.
    const ScenePoint p = geo::to_scene(scene.frame, scene.lakes.front().position);
    return towards(sun.azimuth_deg - convergence_at(scene, p.x_m, p.y_m), sun.elevation_deg);
}

void add_wave_options(CLI::App& c, ViewWords& w) {
    std::vector<std::string> models;
    for (const waves::ModelName& model : waves::model_names())
        models.emplace_back(model.name);
    const waves::Settings usual;
    c.add_option("--waves", w.waves,
                 "model of the waves; default: the scene's, else calm, or jonswap with --wind")
        ->check(CLI::IsMember(models));
    c.add_option("--wind", w.wind,
                 text("speed of the wind at 10 m [m/s]; default ", usual.wind_m_per_s));
    c.add_option("--wind-from", w.wind_from,
                 text("where it comes from [deg from true north]; default ", usual.wind_from_deg));
    c.add_option(
        "--wind-rose", w.wind_rose,
        "file with direction [deg], speed [m/s] and frequency of each class of wind: the most "
        "frequent one blows");
    c.add_option("--wave-time", w.wave_time, "time at which the waves are shown [s]");
    c.add_option("--wave-loop", w.wave_loop,
                 text("they repeat themselves after this [s]; default ", usual.loop_s));
    c.add_option("--wave-list", w.wave_list,
                 "AMPLITUDE,LENGTH,TOWARDS[,PHASE] of each wave [m, m, deg, rad], with / between "
                 "them: for the models sines and gerstner");
    c.add_option("--fetch", w.fetch, "open water upwind [m]; default: by the lake's shape");
    c.add_option("--wave-depth", w.wave_depth,
                 "depth that waves run in [m]; default: the lake's mean");
    c.add_option(
        "--choppiness", w.choppiness,
        text("of spectral waves, 0 round to 1 and above peaked; default ", usual.choppiness));
    c.add_option("--spreading", w.spreading,
                 text("power of the cosine of phillips' directions; default ", usual.spreading));
    c.add_option("--shortest-wave", w.shortest_wave,
                 "shorter ones are damped [m]; default: by Cox and Munk's slopes");
    c.add_option("--wave-patch", w.wave_patch,
                 "side of the largest patch [m]; default: by the longest waves");
    c.add_option(
        "--rain", w.rain,
        "drops a second on a square metre: ripples (some 10 in drizzle, 200 in heavy rain)");
    c.add_option(
        "--poke", w.pokes,
        "X,Y[,HEIGHT[,RADIUS[,TIME]]] of things that fall into the water [scene m, m, m, s], "
        "with / between them; default .2 m high, .5 m wide, at 0 s; their rings are shown at "
        "--wave-time");
    c.add_option("--wave-cascades", w.wave_cascades,
                 text("patches of different size, 1 to 4; default ", usual.cascades));
    c.add_option("--wave-texels", w.wave_texels,
                 text("a side of each, 128 to 2048; default ", usual.texels));
    c.add_option("--wave-seed", w.wave_seed, text("same seed, same sea; default ", usual.seed));
}

void add_water_options(CLI::App& c, ViewWords& w) {
    c.add_option("--water", w.water, "type of the water; default: the scene's, else clear lake")
        ->check(CLI::IsMember(scene::water_type_names()));
    c.add_option("--secchi", w.secchi, "water by the depth where a white disc disappears [m]");
    c.add_option("--chlorophyll", w.chlorophyll,
                 "water by what is in it: phytoplankton [mg/m3 of chlorophyll]");
    c.add_option("--cdom", w.cdom,
                 "the same: absorption of dissolved organic matter at 440 nm [1/m]");
    c.add_option("--turbidity", w.turbidity, "the same: suspended minerals [g/m3, about NTU]");
    c.add_option(
        "--water-table", w.water_table,
        "water by a file with wavelength [nm], a, b [1/m] and, if known, b_b [1/m] a line");
    c.add_option("--absorption-per-m", w.absorption,
                 "R,G,B or one number: of the water [1/m], three channels (lab)");
    c.add_option("--backscattering-per-m", w.backscattering,
                 "R,G,B or one number: of the water [1/m], three channels (lab)");
    c.add_option("--index", w.index, "of refraction of the water, [1, 3]");
}

scene::WaterOptics make_water(const ViewWords& w, const scene::Scene& scene) {
    const bool made = w.chlorophyll || w.cdom || w.turbidity,
               by_hand = !w.absorption.empty() || !w.backscattering.empty();
    if (int(w.water.has_value()) + int(w.secchi.has_value()) + int(made) +
            int(w.water_table.has_value()) + int(by_hand) >
        1)
        throw Error("--water, --secchi, --chlorophyll with --cdom and --turbidity, --water-table "
                    "and --absorption-per-m with --backscattering-per-m exclude each other",
                    "describe the water in one way");
    scene::WaterOptics out = scene.optics;
    if (w.water)
        out = scene::water_type(*w.water);
    else if (w.secchi)
        out = scene::water_by_secchi(*w.secchi);
    else if (made)
        out = scene::lake_water(
            {w.chlorophyll.value_or(0.0), w.cdom.value_or(0.0), w.turbidity.value_or(0.0)});
    else if (w.water_table)
        out = scene::read_water_table(*w.water_table);
    else if (by_hand) {
        out.name = "given by hand";
        out.bands.clear();
        if (!w.absorption.empty())
            out.absorption_per_m = parse_triple("--absorption-per-m", w.absorption);
        if (!w.backscattering.empty())
            out.backscattering_per_m = parse_triple("--backscattering-per-m", w.backscattering);
    }
    out.index = w.index.value_or(scene.optics.index);
    out.validate();
    return out;
}

void add_view_options(CLI::App& c, ViewWords& w) {
    c.add_option(
         "--camera", w.camera,
         "a camera of the scene (overview, shore, top, dive, ...) or key=number pairs: lat,lon or "
         "x,y [scene m]; above_ground, above_water or z [m]; heading, pitch or dx,dy,dz,ux,uy,uz; "
         "fov")
        ->capture_default_str();
    c.add_option("--contours", w.settings.contours_m,
                 "contour lines on land, so far apart in height [m]; every fifth is broader");
    c.add_option("--depth-contours", w.settings.depth_contours_m,
                 "contour lines on beds, so far apart in depth [m]");
    c.add_option("--depth-colours", w.settings.depth_colours_m,
                 "show water as a map of its depth, the darkest at this one [m]");
    c.add_option(
        "--layers", w.layers,
        "vector files (GeoJSON, GeoPackage, GPX, shapefile ...) with : between them, drawn "
        "on ground and bed");
    c.add_option("--layers-3d", w.layers_3d,
                 "the same at heights of their own: lines and points in air and water");
    c.add_option("--layers-3d-heights", w.layers_3d_heights,
                 "what those heights count from: the scene's datum, the water's level, the ground "
                 "or bed; without heights they lie there")
        ->check(CLI::IsMember({"datum", "level", "ground"}))
        ->capture_default_str();
    c.add_flag("--layers-3d-lit", w.layers_3d_lit,
               "as things that light falls on and water hides; else as signs, bright wherever they "
               "are");
    c.add_option("--layers-on", w.layers_on,
                 "where they show, cut by the water's level: all, dry (land), flooded (bed)")
        ->check(CLI::IsMember({"all", "dry", "flooded"}));
    c.add_option("--level", w.level_m, "water level to show [m]; default: as imported");
    c.add_option("--lake", w.lake, "id of the lake whose level that is (tarn info)")
        ->capture_default_str();
    c.add_option("--size", w.size, "WIDTHxHEIGHT [px], up to 16384 each")->capture_default_str();
    c.add_option("--samples", w.settings.samples, "rays a pixel, 1 to 1024")->capture_default_str();
    c.add_option("--time", w.time,
                 "date and time for the sun: 2026-06-21T15:00Z, +HH:MM, or none for solar time; "
                 "default: 09:30 solar time at midsummer");
    c.add_option(
        "--sun-place", w.sun_place,
        "LAT,LON that the sun is seen from, and whose solar time it is; default: the lake");
    c.add_option("--sun", w.sun,
                 "AZIMUTH,ELEVATION of the sun [deg from true north, above horizon]");
    c.add_option("--sun-direction", w.sun_direction, "X,Y,Z towards the sun in scene axes (lab)");
    c.add_option("--sun-irradiance", w.sun_irradiance, "R,G,B or one number, facing the sun (lab)");
    c.add_option("--sky-radiance", w.sky_radiance,
                 "R,G,B or one number: an even sky instead of the clear one (lab)");
    c.add_option(
        "--environment", w.environment,
        "picture of the whole sky, EXR or HDR in latitude and longitude with the zenith at "
        "the top and grid north in the middle, instead of the clear sky and its sun");
    c.add_option("--environment-turn", w.environment_turn_deg,
                 "it is turned so far clockwise [deg]")
        ->capture_default_str();
    c.add_option("--visibility", w.visibility_km,
                 "of the air [km], .1 to 1000: haze over distance; default: clear air");
    c.add_option("--ground-albedo", w.settings.ground_albedo,
                 "one grey in [0, 1] for all ground (lab)");
    add_water_options(c, w);
    c.add_option("--colour", w.colour, "of the water: by all wavelengths, or three narrow channels")
        ->check(CLI::IsMember({"spectral", "rgb"}))
        ->capture_default_str();
    c.add_flag("--no-thrown-back", w.no_thrown_back,
               "leave out what the surface throws back at the bed");
    c.add_flag(
        "--no-forward-glow", w.no_forward_glow,
        "seen from below, no light glows around the sun, and Snell's window has a sharp rim");
    std::vector<std::string> methods;
    for (const scene::WalkMethod& method : scene::walk_methods())
        methods.emplace_back(method.name);
    c.add_option("--intersection", w.intersection, "how rays find the ground and the water")
        ->check(CLI::IsMember(methods))
        ->capture_default_str();
    c.add_option("--intersection-setting", w.settings.walk_setting,
                 "steps or halvings of the methods that have a number of them; 0: their default")
        ->capture_default_str();
    c.add_option("--fresnel", w.fresnel, "formula for the reflectance of the surface")
        ->check(CLI::IsMember({"exact", "schlick"}))
        ->capture_default_str();
    std::vector<std::string> caustics;
    for (const scene::CausticsMethod& method : scene::caustics_methods())
        caustics.emplace_back(method.name);
    c.add_option("--caustics", w.caustics, "how light that waves focus is gathered, or off")
        ->check(CLI::IsMember(caustics))
        ->capture_default_str();
    c.add_option("--caustic-texels", w.settings.caustic_texels,
                 "a side of a tile of caustics; 0: half as many as the waves'")
        ->capture_default_str();
    c.add_option("--caustic-photons", w.settings.caustic_photons,
                 "of splat, on a side of a texel of the waves: 1, 2 or 4")
        ->capture_default_str();
    c.add_option(
         "--shaft-steps", w.settings.shaft_steps,
         "places along a view in the water where each pixel looks for shafts of light; 0: none")
        ->capture_default_str();
    c.add_option("--shafts", w.shafts,
                 "shafts of light seen from below: looked for along each view, or prisms of light "
                 "under a grid about the sun's image")
        ->check(CLI::IsMember({"march", "prisms"}))
        ->capture_default_str();
    c.add_option("--shaft-prisms", w.settings.shaft_prisms, "on a side of that grid, 4 to 512")
        ->capture_default_str();
    c.add_option("--least-transmittance", w.settings.least_transmittance,
                 "underwater paths end where less is left")
        ->capture_default_str();
    c.add_flag("--no-shadows", w.no_shadows, "leave out the sun's shadows");
    c.add_flag("--no-reflection", w.no_reflection, "leave out what the water mirrors");
    c.add_option("--curvature", w.curvature,
                 "the Earth's: on, off, or auto: where its drop could be more than a pixel")
        ->check(CLI::IsMember({"auto", "on", "off"}));
    c.add_option("--dive-light", w.settings.dive_light_cd,
                 "a diver's lamp by the lens, in candela; 0: none, 10000 is a strong one");
    c.add_option("--reference-splits", w.settings.reference_splits,
                 "how often --reference splits a path at the water, 1 to 8; pictures do once")
        ->capture_default_str();
    c.add_option(
        "--port", w.settings.port_m,
        "radius of the dome before the lens [m]: a camera at the surface sees above and below "
        "the water at once");
    c.add_flag("--coarse-far-land", w.coarse_far_land,
               "take far land's blocks that are narrower than a pixel at their tops");
    c.add_flag("--no-mirrored-land", w.no_mirrored_land, "let the water mirror the sky alone");
    c.add_flag("--no-refraction", w.no_refraction, "leave out what is seen through the surface");
    c.add_flag("--no-sun-disc", w.no_sun_disc, "leave out the sun itself");
    add_wave_options(c, w);
    c.add_option("--settings", w.settings_file,
                 "file with any of these options, one name = value a line");
}

void apply_settings_file(CLI::App& c, const ViewWords& w) {
    if (w.settings_file.empty())
        return;
    const auto take = [&](const std::string& name, const std::vector<std::string>& values) {
        CLI::Option* option = c.get_option_no_throw("--" + name);
        if (!option || name == "settings" || name == "help")
            throw Error(w.settings_file + ": no option is called '" + name + "'",
                        "the names are those of tarn render --help, without the dashes");
        if (option->count() > 0)
            return; // what is typed wins
        option->add_result(values);
        option->run_callback();
    };
    std::ifstream in(w.settings_file);
    if (!in || !std::filesystem::is_regular_file(w.settings_file))
        throw Error(w.settings_file + ": cannot be read", "check the path given with --settings");
    try {
        if (w.settings_file.ends_with(".json")) {
            for (const auto& [name, value] : scene_files::read_sidecar(w.settings_file))
                take(name, {value});
            return;
        }
        CLI::ConfigTOML format;
        format.arrayDelimiter('|'); // commas belong to the values
        for (const CLI::ConfigItem& item : format.from_config(in)) {
            if (item.name == "++" || item.name == "--")
                continue; // marks of sections
            take(item.parents.empty() ? item.name : item.fullname(), item.inputs);
        }
    } catch (const CLI::Error& error) {
        throw Error(w.settings_file + ": " + error.what(), "write one name = value a line");
    }
}

double convergence_deg(const scene::Scene& scene) {
    const ScenePoint p = geo::to_scene(scene.frame, scene.lakes.front().position);
    return convergence_at(scene, p.x_m, p.y_m);
}

waves::Settings make_waves(const ViewWords& w, const scene::Scene& scene) {
    waves::Settings s = scene.waves;
    if (w.waves)
        s.model = waves::model_from_name(*w.waves);
    else if ((w.wind || w.wind_rose) && s.model == waves::Model::calm)
        s.model = waves::Model::jonswap;
    if (w.wind_rose) {
        if (w.wind || w.wind_from)
            throw Error("--wind-rose excludes --wind and --wind-from");
        const std::vector<waves::WindSector> rose = waves::read_wind_rose(*w.wind_rose);
        s.wind_m_per_s = waves::prevailing(rose).speed_m_per_s;
        s.wind_from_deg = waves::prevailing(rose).from_deg - convergence_deg(scene);
    }
    s.wind_m_per_s = w.wind.value_or(s.wind_m_per_s);
    if (w.wind_from)
        s.wind_from_deg = *w.wind_from - convergence_deg(scene);
    s.ripples.rain_drops_per_m2_s = w.rain.value_or(s.ripples.rain_drops_per_m2_s);
    s.time_s = w.wave_time.value_or(s.time_s);
    s.loop_s = w.wave_loop.value_or(s.loop_s);
    s.choppiness = w.choppiness.value_or(s.choppiness);
    s.spreading = w.spreading.value_or(s.spreading);
    s.cascades = w.wave_cascades.value_or(s.cascades);
    s.texels = w.wave_texels.value_or(s.texels);
    s.seed = w.wave_seed.value_or(s.seed);
    if (w.fetch)
        s.fetch_m = w.fetch;
    if (w.wave_depth)
        s.depth_m = w.wave_depth;
    if (w.shortest_wave)
        s.shortest_m = w.shortest_wave;
    if (w.wave_patch)
        s.patch_m = w.wave_patch;
    if (w.pokes) {
        s.ripples.pokes.clear();
        for (const std::string& one : split(*w.pokes, '/')) {
            const std::size_t numbers = 1 + std::size_t(std::count(one.begin(), one.end(), ','));
            if (numbers < 2 || numbers > 5)
                throw Error("--poke: '" + one + "' is not understood",
                            "write X,Y or X,Y,HEIGHT,RADIUS,TIME");
            const auto v = parse_numbers("--poke", one, numbers);
            waves::Poke poke{.x_m = v[0], .y_m = v[1]};
            if (numbers > 2)
                poke.height_m = v[2];
            if (numbers > 3)
                poke.radius_m = v[3];
            if (numbers > 4)
                poke.time_s = v[4];
            s.ripples.pokes.push_back(poke);
        }
    }
    if (w.wave_list) {
        s.list.clear();
        for (const std::string& one : split(*w.wave_list, '/')) {
            const std::size_t numbers = 1 + std::size_t(std::count(one.begin(), one.end(), ','));
            if (numbers != 3 && numbers != 4)
                throw Error("--wave-list: '" + one + "' is not understood",
                            "write AMPLITUDE,LENGTH,TOWARDS or AMPLITUDE,LENGTH,TOWARDS,PHASE");
            const auto v = parse_numbers("--wave-list", one, numbers);
            s.list.push_back({v[0], v[1], v[2], numbers == 4 ? v[3] : 0.0});
        }
    }
    s.validate();
    return s;
}

scene::View make_view(const ViewWords& w, scene::Scene& scene) {
    scene::View view;
    view.settings = w.settings;
    int width = 0, height = 0;
    char extra = 0;
    if (std::sscanf(w.size.c_str(), "%dx%d%c", &width, &height, &extra) != 2)
        throw Error("--size '" + w.size + "' is not understood",
                    "write WIDTHxHEIGHT, like 1280x720");
    view.settings.width_px = width;
    view.settings.height_px = height;
    view.settings.fresnel =
        w.fresnel == "schlick" ? scene::Fresnel::schlick : scene::Fresnel::exact;
    for (const scene::WalkMethod& method : scene::walk_methods())
        if (w.intersection == method.name)
            view.settings.walk = method.walk;
    view.settings.shafts = w.shafts == "prisms" ? scene::Shafts::prisms : scene::Shafts::march;
    for (const scene::CausticsMethod& method : scene::caustics_methods())
        if (w.caustics == method.name)
            view.settings.caustics = method.caustics;
    view.settings.shadows = !w.no_shadows;
    view.settings.reflection = !w.no_reflection;
    view.settings.mirrored_land = !w.no_mirrored_land;
    view.settings.drape_on = w.layers_on == "dry"       ? scene::DrapeOn::dry
                             : w.layers_on == "flooded" ? scene::DrapeOn::flooded
                                                        : scene::DrapeOn::all;
    view.settings.space_lines_lit = w.layers_3d_lit;
    view.settings.coarse_far_land = w.coarse_far_land;
    if (w.curvature != "auto")
        view.settings.earth_curvature = w.curvature == "on";
    view.settings.refraction = !w.no_refraction;
    view.settings.validate();
    view.waves = make_waves(w, scene);

    scene.optics = make_water(w, scene);
    view.settings.spectral = w.colour == "spectral";
    view.settings.thrown_back = !w.no_thrown_back;
    view.settings.forward_glow = !w.no_forward_glow;

    if (!w.sun_place.empty() &&
        (!w.sun.empty() || !w.sun_direction.empty() || !w.environment.empty()))
        throw Error(
            "--sun-place goes with --time, not with --sun, --sun-direction or --environment");
    if (int(!w.time.empty()) + int(!w.sun.empty()) + int(!w.sun_direction.empty()) > 1)
        throw Error("--time, --sun and --sun-direction exclude each other");
    const GeoPoint place = scene.lakes.front().position;
    glm::dvec3 sun(0.0);
    if (!w.sun_direction.empty()) {
        sun = parse_triple("--sun-direction", w.sun_direction);
        if (!(glm::length(sun) > 0.0))
            throw Error("--sun-direction is zero", "give X,Y,Z towards the sun");
        sun = glm::normalize(sun);
    } else if (!w.sun.empty()) {
        const auto v = parse_numbers("--sun", w.sun, 2);
        if (std::abs(v[1]) > 90.0)
            throw Error("--sun: the elevation must be in [-90, 90] degrees",
                        "write AZIMUTH,ELEVATION");
        const ScenePoint p = geo::to_scene(scene.frame, place);
        sun = towards(v[0] - convergence_at(scene, p.x_m, p.y_m), v[1]);
    } else {
        const GeoPoint seen_from = sun_place(w, scene);
        sun = sun_direction(scene, seen_from,
                            w.time.empty() ? geo::default_time(seen_from)
                                           : geo::parse_time(w.time, seen_from));
    }
    view.lighting = scene::clear_sky(sun);
    if (!w.sky_radiance.empty()) {
        const glm::dvec3 sky = parse_triple("--sky-radiance", w.sky_radiance);
        view.lighting = scene::uniform_sky(sun, view.lighting.sun_irradiance, sky);
    }
    if (!w.environment.empty()) {
        if (!w.time.empty() || !w.sun.empty() || !w.sun_direction.empty() ||
            !w.sky_radiance.empty())
            throw Error("--environment brings its own sun and sky",
                        "leave out --time, --sun, --sun-direction and --sky-radiance");
        if (!std::isfinite(w.environment_turn_deg))
            throw Error("--environment-turn must be a number of degrees");
        const Image map = image::read_light(w.environment);
        try {
            view.lighting = scene::environment(map, w.environment_turn_deg);
        } catch (Error& e) {
            e.during(w.environment);
            throw;
        }
        sun = view.lighting.sun_direction;
    }
    if (!w.sun_irradiance.empty())
        view.lighting.sun_irradiance = parse_triple("--sun-irradiance", w.sun_irradiance);
    for (int k = 0; k < 3; ++k)
        if (!(view.lighting.sun_irradiance[k] >= 0.0 && view.lighting.sky_irradiance[k] >= 0.0))
            throw Error("--sun-irradiance and --sky-radiance must not be negative");
    if (w.visibility_km) {
        if (!(*w.visibility_km >= 0.1 && *w.visibility_km <= 1000.0))
            throw Error(text("--visibility is ", *w.visibility_km, " km, must be in [0.1, 1000]"));
        view.lighting.visibility_m = 1000.0 * *w.visibility_km;
    }
    if (w.no_sun_disc)
        view.lighting.sun_disc = false;
    view.camera = parse_camera(w.camera, scene, sun, double(width) / height);
    return view;
}

} // namespace tarn::app
