#include "app/dem_options.hpp"

#include "app/console.hpp"

#include <CLI/CLI.hpp>
#include <limits>

namespace tarn::app {

void add_dem_options(CLI::App& c, DemWords& words) {
    dem::ImportOptions& options = words.options;
    c.add_option("DEM", words.dems,
                 "elevation rasters (GeoTIFF, .hgt, .asc, .zip: what GDAL reads)")
        ->required();
    c.add_option("--at", words.at, "LAT,LON of a point in the lake; default: the largest lake");
    c.add_option("--radius", options.radius_km, "cut to this many km around --at");
    c.add_option("--bounds", words.bounds, "cut to WEST,SOUTH,EAST,NORTH [deg, WGS 84]");
    c.add_option("--min-area", options.min_area_km2, "find no lakes smaller than this [km2]")
        ->capture_default_str();
    c.add_option("--spacing", options.spacing_m,
                 "distance between nodes [m]; default: loses nothing");
    c.add_option("--crs", options.crs, "CRS of the DEMs instead of their own, e.g. EPSG:27700");
    c.add_option("--unit", options.unit, "unit of the DEMs' heights instead of their own")
        ->check(CLI::IsMember({"m", "ft", "us-ft"}));
    c.add_option("--nodata", words.nodata,
                 "value that means no data, besides what the files declare; none: nothing does");
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
    if (words.nodata == "none")
        options.nodata = std::numeric_limits<double>::quiet_NaN();
    else if (!words.nodata.empty())
        options.nodata = parse_numbers("--nodata", words.nodata, 1)[0];
}

} // namespace tarn::app
