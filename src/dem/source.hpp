#pragma once
/// @file source.hpp  One elevation raster as the user gave it, opened and made comparable.
#include "core/import_report.hpp"
#include "dem/gdal_door.hpp"

#include <filesystem>
#include <ogr_spatialref.h>
#include <optional>
#include <string>
#include <vector>

namespace tarn::dem {

/// A raster with one Float32 band of metres, its nodata declared, its CRS known.
struct Source {
    std::string name; ///< file name, for messages
    Dataset raster;
    std::vector<Dataset> steps; ///< views between `original` and `raster`
    Dataset original;           ///< what they read from; outlives them
    OGRSpatialReference crs;
    GeoTransform transform;
    int cols = 0, rows = 0;
    ImportInput input;
    std::vector<std::string> notes; ///< what was assumed while opening
    Source();
    Source(Source&&) noexcept;
    Source& operator=(Source&&) noexcept;
    ~Source();
};

struct SourceOptions {
    std::string crs;              ///< used for every raster instead of its own; "" keeps it
    std::optional<double> nodata; ///< used for every raster besides its own
    std::string crs_hint = "give one with --crs EPSG:..."; ///< what a missing CRS's message says
};

/// Opens a file, or every raster in a zip archive.
/// @throws tarn::Error  naming the file: cannot be read, holds no raster, has no CRS, no
///                      georeference, or is a picture rather than elevations
std::vector<Source> open_sources(const std::filesystem::path& path, const SourceOptions& options);

/// As above for pictures (orthophotos): the dataset as it is, CRS checked.
Source open_picture(const std::filesystem::path& path, const std::string& crs);

/// "EPSG:..." or the name a CRS carries.
std::string describe(const OGRSpatialReference& crs);

} // namespace tarn::dem
