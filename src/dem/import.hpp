#pragma once
/// @file import.hpp  Georeferenced elevation data + water level -> ground and water in the frame.
#include "core/geo.hpp"
#include "core/heightfield.hpp"
#include "core/image.hpp"
#include "core/import_report.hpp"
#include "core/lake_record.hpp"
#include "core/progress.hpp"
#include "dem/bed.hpp"
#include "dem/mosaic.hpp"
#include "dem/remote.hpp"
#include "geo/frame_data.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tarn::dem {

/// Which bed the DEM is taken to hold where no bathymetry is given.
enum class BedChoice { automatic, measured, unknown };

/// Which lakes a scene holds besides the one that was asked for.
enum class LakeChoice { all, one };

/// Every field's default is what `tarn import --help` prints.
struct ImportOptions {
    std::vector<std::filesystem::path> dems;
    std::optional<RemoteSource> remote; ///< tiles from the network, besides or instead of `dems`
    FetchOptions fetch;
    std::optional<double> level_m;   ///< nothing = find the water surface
    std::optional<GeoPoint> at;      ///< a point in (or near) the lake
    std::optional<double> radius_km; ///< around `at`, (0, 500]
    std::optional<Bounds> bounds;
    LakeChoice lakes = LakeChoice::all;
    double min_area_km2 = 0.02;                      ///< smaller lakes are not found, [0, 1e6]
    std::optional<std::filesystem::path> bathymetry; ///< raster
    std::optional<std::filesystem::path> soundings;  ///< points or contours
    BathymetryKind bathymetry_kind = BathymetryKind::automatic;
    std::string bathymetry_crs;               ///< replaces the bathymetry's (or soundings') own
    double bathymetry_offset_m = 0.0;         ///< added to its elevations: difference of the datums
    std::optional<double> bathymetry_level_m; ///< level that its depths count from
    std::string bathymetry_unit;              ///< "m", "ft", ... replaces the bathymetry's own
    std::string depth_field;                  ///< of the soundings; "" looks for one
    std::optional<double> estimate_depth_m;   ///< greatest depth of an estimated bed, (0, 2000]
    BedChoice bed = BedChoice::automatic;
    std::optional<std::filesystem::path> ortho;
    std::optional<double> spacing_m; ///< [0.01, 100000]
    bool depths = false;             ///< the DEMs hold depths below level_m, of either sign
    std::string crs;                 ///< replaces the DEMs' own
    std::string unit;                ///< "m", "ft", "us-ft" replaces the DEMs' own; "" keeps it
    std::optional<double> nodata;    ///< void besides what the files declare
    std::string name;                ///< of the lake, free text

    /// @throws tarn::Error  naming the field, its value and the legal range
    void validate() const;
};

struct ImportResult {
    geo::Frame frame;
    Heightfield ground, water;
    Grid<float> heights_m; ///< what the statistics count: exact heights, NaN outside the data.
                           ///< Empty if a HeightsSink took them
    std::vector<LakeRecord> lakes; ///< the main one first
    std::optional<Ortho> ortho;
    ImportReport report;
};

/// Takes the exact heights as soon as they are final, so that their memory can go.
using HeightsSink = std::function<void(const Grid<float>& heights_m, const Heightfield& place,
                                       const geo::Frame& frame)>;

/// Peak memory is about 11 bytes a node, whatever the size of the sources.
/// @throws tarn::Error      on input that cannot be used; names the file and what to do
/// @throws tarn::Cancelled
ImportResult import_dem(const ImportOptions& options, const Progress& progress,
                        const HeightsSink& keep_heights = {});

struct Detection {
    std::vector<LakeRecord> lakes; ///< largest first; the sea, if there is any, last
    ImportReport report;
};

/// The lakes in the tiles, without making a scene; options about the level and beds are not used.
/// @throws as import_dem()
Detection detect_lakes(const ImportOptions& options, const Progress& progress);

} // namespace tarn::dem
