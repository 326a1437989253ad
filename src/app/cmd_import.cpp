// `tarn import` — options, help text and body in one screen; the work itself is in dem/.
#include "app/command.hpp"
#include "app/console.hpp"
#include "app/preview.hpp"
#include "app/report.hpp"
#include "app/view_options.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/import.hpp"
#include "dem/write.hpp"
#include "geo/frame.hpp"
#include "geo/sun.hpp"
#include "image/files.hpp"
#include "scene/presets.hpp"
#include "scene_files/scene_folder.hpp"
#include "scene_files/scene_json.hpp"

#include <iostream>
#include <memory>

namespace tarn::app {

namespace {

struct Words {
    dem::ImportOptions options;
    std::vector<std::string> dems;
    std::string level = "auto", at, bounds, bathymetry, ortho, scene;
    std::string bathymetry_kind = "auto", bed = "auto";
};

int run_import(Words& words) {
    dem::ImportOptions& options = words.options;
    options.dems.assign(words.dems.begin(), words.dems.end());
    if (words.level != "auto")
        options.level_m = parse_numbers("--level", words.level, 1)[0];
    if (!words.at.empty())
        options.at = parse_place("--at", words.at);
    if (!words.bounds.empty()) {
        const auto v = parse_numbers("--bounds", words.bounds, 4);
        options.bounds = dem::Bounds{v[0], v[1], v[2], v[3]};
    }
    if (!words.bathymetry.empty())
        options.bathymetry = words.bathymetry;
    if (!words.ortho.empty())
        options.ortho = words.ortho;
    options.bathymetry_kind = words.bathymetry_kind == "elevation" ? dem::BathymetryKind::elevation
                              : words.bathymetry_kind == "depth"   ? dem::BathymetryKind::depth
                                                                   : dem::BathymetryKind::automatic;
    options.bed = words.bed == "measured"  ? dem::BedChoice::measured
                  : words.bed == "unknown" ? dem::BedChoice::unknown
                                           : dem::BedChoice::automatic;
    options.validate();
    scene_files::StagedFolder folder(words.scene); // refuses before any work is done

    const Progress progress = console_progress();
    dem::ImportResult result = dem::import_dem(options, progress);
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
    const auto sun = sun_direction(scene, geo::default_time(lake.position));
    for (const std::string& name : scene::preset_names())
        scene.cameras.push_back({name, scene::preset_camera(scene, lake, name, sun, 16.0 / 9.0)});
    scene.validate();

    progress.report(0.95, "writing");
    scene_files::FileNames files;
    dem::write_heightfield(folder.path() / files.ground, scene.ground, scene.frame, "ground",
                           false);
    dem::write_heightfield(folder.path() / files.water, scene.water, scene.frame, "water level",
                           true);
    if (scene.ortho) {
        files.ortho = "ortho.tif";
        dem::write_ortho(folder.path() / files.ortho, *scene.ortho, scene.frame);
    }
    image::write_png(folder.path() / "preview.png", draw_preview(scene), {});
    folder.write_text("scene.json", scene_files::to_json(scene, files));
    progress.report(0.99, "writing");
    folder.commit();
    end_progress();
    std::cout << "wrote " << words.scene << "\n" << summary(scene);
    return 0;
}

} // namespace

void add_import(CLI::App& app, Run& run) {
    auto words = std::make_shared<Words>();
    dem::ImportOptions& options = words->options;
    CLI::App* c = app.add_subcommand("import", "elevation tiles + water level -> scene folder");
    c->add_option("DEM", words->dems,
                  "elevation rasters (GeoTIFF, .hgt, .asc, .zip: what GDAL reads)")
        ->required();
    c->add_option("-o,--output", words->scene, "scene folder to write")->required();
    c->add_option(
         "--level", words->level,
         "water level [m] in the DEM's vertical datum, or auto: the flat water surface found")
        ->capture_default_str();
    c->add_option("--at", words->at, "LAT,LON of a point in the lake; default: the largest lake");
    c->add_option("--radius", options.radius_km, "cut the scene to this many km around --at");
    c->add_option("--bounds", words->bounds,
                  "cut the scene to WEST,SOUTH,EAST,NORTH [deg, WGS 84]");
    c->add_option("--bathymetry", words->bathymetry,
                  "raster of the lake's bed: elevations or depths");
    c->add_option("--bathymetry-kind", words->bathymetry_kind, "what its values are")
        ->check(CLI::IsMember({"auto", "elevation", "depth"}))
        ->capture_default_str();
    c->add_option("--bed", words->bed,
                  "whether the DEM itself holds the bed; auto: not if it is flat")
        ->check(CLI::IsMember({"auto", "measured", "unknown"}))
        ->capture_default_str();
    c->add_option("--ortho", words->ortho, "aerial picture to drape over the land");
    c->add_option("--spacing", options.spacing_m,
                  "distance between nodes [m]; default: loses nothing");
    c->add_option("--crs", options.crs, "CRS of the DEMs instead of their own, e.g. EPSG:27700");
    c->add_option("--nodata", options.nodata,
                  "value that means no data, besides what the files declare");
    c->add_option("--name", options.name, "name of the lake");
    c->footer(
        "Examples:\n"
        "  tarn import rotoma.tif --level 313.31 -o rotoma\n"
        "  tarn import N43E006.hgt N43E007.hgt.zip --at 43.766,6.184 -o sainte-croix\n"
        "  tarn import tiles/*.asc --crs EPSG:27700 --level 60 --at 51.83,-2.72 --radius 2 -o usk");
    c->callback([words, &run] { run = [words] { return run_import(*words); }; });
}

} // namespace tarn::app
