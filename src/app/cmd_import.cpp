// `tarn import` — options, help text and body in one screen; the work itself is in dem/.
#include "app/command.hpp"
#include "app/console.hpp"
#include "app/dem_options.hpp"
#include "app/preview.hpp"
#include "app/report.hpp"
#include "app/view_options.hpp"
#include "core/error.hpp"
#include "core/safety_radius.hpp"
#include "core/text.hpp"
#include "dem/import.hpp"
#include "dem/write.hpp"
#include "geo/frame.hpp"
#include "geo/sun.hpp"
#include "image/files.hpp"
#include "scene/presets.hpp"
#include "scene/water_types.hpp"
#include "scene_files/scene_folder.hpp"
#include "scene_files/scene_json.hpp"

#include <future>
#include <iostream>
#include <memory>

namespace tarn::app {

namespace {

struct ImportWords {
    DemWords dem;
    ViewWords waves; ///< only its waves and its water are asked for
    std::string level = "auto", lakes = "all", bathymetry, soundings, ortho, scene;
    std::string bathymetry_kind = "auto", bed = "auto";
};

void read_words(ImportWords& words) {
    read_dem_words(words.dem);
    dem::ImportOptions& options = words.dem.options;
    if (words.level != "auto")
        options.level_m = parse_numbers("--level", words.level, 1)[0];
    options.lakes = words.lakes == "one" ? dem::LakeChoice::one : dem::LakeChoice::all;
    if (!words.bathymetry.empty())
        options.bathymetry = words.bathymetry;
    if (!words.soundings.empty())
        options.soundings = words.soundings;
    if (!words.ortho.empty())
        options.ortho = words.ortho;
    options.bathymetry_kind = words.bathymetry_kind == "elevation" ? dem::BathymetryKind::elevation
                              : words.bathymetry_kind == "depth"   ? dem::BathymetryKind::depth
                                                                   : dem::BathymetryKind::automatic;
    options.bed = words.bed == "measured"  ? dem::BedChoice::measured
                  : words.bed == "unknown" ? dem::BedChoice::unknown
                                           : dem::BedChoice::automatic;
    options.validate();
}

int run_import(ImportWords& words) {
    read_words(words);
    dem::ImportOptions& options = words.dem.options;
    scene_files::StagedFolder folder(words.scene); // refuses before any work is done

    const Progress progress = console_progress();
    scene_files::FileNames files;
    dem::ImportResult result = dem::import_dem(
        options, progress,
        [&](const Grid<float>& heights_m, const Heightfield& place, const geo::Frame& frame) {
            dem::write_heights(folder.path() / files.heights, heights_m, place, frame);
        });
    scene::Scene scene;
    scene.frame = result.frame;
    scene.ground = std::move(result.ground);
    scene.water = std::move(result.water);
    scene.lakes = std::move(result.lakes);
    scene.ortho = std::move(result.ortho);
    scene.report = std::move(result.report);
    scene.report.command = command_line();
    scene.report.created = utc_now();
    scene.report.tarn_version = TARN_VERSION;
    const LakeRecord& lake = scene.lakes.front();
    scene.look = scene::ground_look(lake.position.lat_deg);
    scene.optics = scene::water_type("clear lake");
    scene.optics = make_water(words.waves, scene);
    const auto sun = sun_direction(scene, lake.position, geo::default_time(lake.position));
    for (const std::string& name : scene::preset_names())
        scene.cameras.push_back({name, scene::preset_camera(scene, lake, name, sun, 16.0 / 9.0)});
    scene.waves.wind_from_deg -= convergence_deg(scene); // the default counts from true north, too
    scene.waves = make_waves(words.waves, scene);
    scene.validate();

    progress.report(0.95, "writing");
    // On the other cores while the rasters are compressed.
    auto radii = std::async(std::launch::async, [&scene] { return safety_radii(scene.ground); });
    dem::write_heightfield(folder.path() / files.ground, scene.ground, scene.frame, "ground",
                           false);
    dem::write_heightfield(folder.path() / files.water, scene.water, scene.frame, "water level",
                           true);
    if (scene.ortho) {
        files.ortho = "ortho.tif";
        dem::write_ortho(folder.path() / files.ortho, *scene.ortho, scene.frame);
    }
    files.safety_ground = "safety_ground.tif";
    files.safety_sum = ground_sum(scene.ground);
    dem::write_safety_radii(folder.path() / files.safety_ground, radii.get(), scene.ground,
                            scene.frame);
    image::write_png(folder.path() / "preview.png", draw_preview(scene), {});
    folder.write_text("scene.json", scene_files::to_json(scene, files));
    progress.report(0.99, "writing");
    folder.commit();
    end_progress();
    std::cout << "wrote " << words.scene << "\n" << summary(scene);
    return 0;
}

} // namespace

void import_for_viewing(const std::string& dem, const std::string& scene,
                        std::optional<double> level_m) {
    ImportWords words;
    if (level_m)
        words.level = text(*level_m);
    words.dem.dems = {dem};
    words.scene = scene;
    run_import(words);
}

void add_import(CLI::App& app, Run& run) {
    auto words = std::make_shared<ImportWords>();
    dem::ImportOptions& options = words->dem.options;
    CLI::App* c = app.add_subcommand("import", "elevation tiles + water level -> scene folder");
    add_dem_options(*c, words->dem);
    c->add_option("-o,--output", words->scene, "scene folder to write")->required();
    c->add_option(
         "--level", words->level,
         "water level [m] in the DEM's vertical datum, or auto: the flat water surface found")
        ->capture_default_str();
    c->add_option("--lakes", words->lakes,
                  "all: other water surfaces stand at their own levels; one: only the lake asked "
                  "for")
        ->check(CLI::IsMember({"all", "one"}))
        ->capture_default_str();
    c->add_flag("--depths", options.depths,
                "the DEM itself holds depths below --level, of either sign, not elevations");
    c->add_option("--bathymetry", words->bathymetry,
                  "raster of the lake's bed: elevations or depths");
    c->add_option("--soundings", words->soundings,
                  "measured depths: CSV lon,lat,depth, or any points or contour lines");
    c->add_option("--depth-field", options.depth_field,
                  "attribute of the soundings that holds the depth; default: looked for");
    c->add_option("--bathymetry-kind", words->bathymetry_kind, "what its values are")
        ->check(CLI::IsMember({"auto", "elevation", "depth"}))
        ->capture_default_str();
    c->add_option("--bathymetry-crs,--soundings-crs", options.bathymetry_crs,
                  "CRS of bathymetry or soundings instead of their own");
    c->add_option("--bathymetry-unit", options.bathymetry_unit,
                  "unit of bathymetry or soundings instead of their own")
        ->check(CLI::IsMember({"m", "ft", "us-ft", "cm", "dm", "mm"}));
    c->add_option("--bathymetry-offset", options.bathymetry_offset_m,
                  "added to its elevations [m]: from its vertical datum to the DEM's")
        ->capture_default_str();
    c->add_option("--bathymetry-level", options.bathymetry_level_m,
                  "level [m] that its depths count from; default: the DEM's water surface");
    c->add_option("--estimate-depth", options.estimate_depth_m,
                  "greatest depth [m]: makes up a bed from the distance to the shore");
    c->add_option("--bed", words->bed,
                  "whether the DEM itself holds the bed; auto: not if it is flat")
        ->check(CLI::IsMember({"auto", "measured", "unknown"}))
        ->capture_default_str();
    c->add_option("--ortho", words->ortho, "aerial picture to drape over the land");
    add_water_options(*c, words->waves);
    add_wave_options(*c, words->waves);
    c->add_option("--name", options.name, "name of the lake");
    c->footer(
        "Examples:\n"
        "  tarn import rotoma.tif --level 313.31 -o rotoma\n"
        "  tarn import N43E006.hgt N43E007.hgt.zip --at 43.766,6.184 -o sainte-croix\n"
        "  tarn import dem.tif --soundings depths.csv -o lake\n"
        "  tarn import tiles/*.asc --crs EPSG:27700 --level 60 --at 51.83,-2.72 --radius 2 -o usk");
    c->callback([words, &run] { run = [words] { return run_import(*words); }; });
}

} // namespace tarn::app
