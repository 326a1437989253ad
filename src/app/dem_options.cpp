#include "app/dem_options.hpp"

#include "app/console.hpp"
#include "core/error.hpp"
#include "scene_files/source_list.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <limits>

namespace tarn::app {

namespace {

namespace fs = std::filesystem;

void choose_source(DemWords& words) {
    std::vector<RemoteSource> sources = dem::known_sources();
    fs::path file = words.sources;
    std::error_code failed;
    if (file.empty())
        file = user_folder("XDG_CONFIG_HOME", ".config") / "tarn" / "sources.json";
    if (!words.sources.empty() || fs::exists(file, failed))
        for (const RemoteSource& own : scene_files::read_sources(file)) {
            std::erase_if(sources, [&](const RemoteSource& s) { return s.name == own.name; });
            sources.push_back(own);
        }
    std::string names;
    for (const RemoteSource& source : sources) {
        if (source.name == words.source)
            words.options.remote = source;
        names += (names.empty() ? "" : ", ") + source.name;
    }
    if (!words.options.remote)
        throw Error("--source '" + words.source + "' is not known", "there are: " + names);
    words.options.fetch.cache = words.cache.empty()
                                    ? user_folder("XDG_CACHE_HOME", ".cache") / "tarn"
                                    : fs::path(words.cache);
}

} // namespace

fs::path user_folder(const char* variable, const char* fallback) {
    if (const char* chosen = std::getenv(variable); chosen && *chosen)
        return chosen;
    const char* home = std::getenv("HOME");
    return fs::path(home && *home ? home : "/tmp") / fallback;
}

void add_dem_options(CLI::App& c, DemWords& words) {
    dem::ImportOptions& options = words.options;
    c.add_option("DEM", words.dems,
                 "elevation rasters (GeoTIFF, .hgt, .asc, .zip: what GDAL reads)");
    c.add_option("--at", words.at, "LAT,LON of a point in the lake; default: the largest lake");
    c.add_option("--radius", options.radius_km, "cut to this many km around --at");
    c.add_option("--bounds", words.bounds, "cut to WEST,SOUTH,EAST,NORTH [deg, WGS 84]");
    c.add_option("--min-area", options.min_area_km2, "find no lakes smaller than this [km2]")
        ->capture_default_str();
    c.add_option("--spacing", options.spacing_m,
                 "distance between nodes [m]; default: loses nothing");
    c.add_option("--crs", options.crs, "CRS of the DEMs instead of their own, e.g. EPSG:27700");
    c.add_option("--unit", options.unit, "unit of the DEMs' heights instead of their own")
        ->check(CLI::IsMember({"m", "ft", "us-ft", "cm", "dm", "mm"}));
    c.add_option("--source", words.source,
                 "fetch tiles from the network: copernicus, 3dep, or one of your own");
    c.add_option("--sources", words.sources,
                 "JSON file with sources of your own; default: tarn/sources.json in the user's "
                 "configuration");
    c.add_option("--cache", words.cache, "where fetched tiles are kept; default: the user's cache");
    c.add_option("--timeout", options.fetch.timeout_s, "seconds to wait for each answer")
        ->capture_default_str();
    c.add_option(
        "--nodata", words.nodata,
        "value that means no data, besides what the files declare; none: no collar of 0 is "
        "looked for");
}

void read_dem_words(DemWords& words) {
    dem::ImportOptions& options = words.options;
    options.dems.assign(words.dems.begin(), words.dems.end());
    if (!words.at.empty())
        options.at = parse_place("--at", words.at);
    if (!words.bounds.empty()) {
        const auto v = parse_numbers("--bounds", words.bounds, 4);
        options.bounds = dem::Bounds{v[0], v[1], v[2], v[3]};
    }
    if (!words.source.empty())
        choose_source(words);
    if (words.nodata == "none")
        options.nodata = std::numeric_limits<double>::quiet_NaN();
    else if (!words.nodata.empty())
        options.nodata = parse_numbers("--nodata", words.nodata, 1)[0];
}

} // namespace tarn::app
