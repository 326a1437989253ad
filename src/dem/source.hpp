#pragma once
/// @file source.hpp  One elevation raster as the user gave it, opened and made comparable.
#include "core/import_report.hpp"
#include "dem/gdal_door.hpp"
#include "dem/height_view.hpp"

#include <filesystem>
#include <ogr_spatialref.h>
#include <optional>
#include <string>
#include <vector>

namespace tarn::dem {

/// A raster with one Float32 band of metres, NaN where there is no data, its CRS known.
struct Source {
    std::string name; ///< file name, for messages
    std::string path; ///< as GDAL opens it
    Dataset raster;   ///< what everyone reads
    Dataset original; ///< the file itself, which `raster` is a view of; outlives it
    int band = 1;     ///< of the original
    OGRSpatialReference crs;
    GeoTransform transform;
    int cols = 0, rows = 0;
    ImportInput input;
    bool unit_declared = true;                ///< the file says in which unit its heights are
    std::vector<std::string> notes;           ///< what was assumed while opening
    std::shared_ptr<HeightFindings> findings; ///< what reading has met so far
    Source();
    Source(Source&&) noexcept;
    Source& operator=(Source&&) noexcept;
    ~Source();
};

struct SourceOptions {
    std::string crs;              ///< used for every raster instead of its own; "" keeps it
    std::optional<double> nodata; ///< void besides what the files declare; NaN: only those, and
                                  ///< no collar of zeros is looked for
    std::string unit;             ///< "m", "ft", "us-ft": instead of what the files declare
    std::optional<double> depths_below_m; ///< the values are depths (of either sign) below this
    std::string crs_hint = "give one with --crs EPSG:..."; ///< what a missing CRS's message says
};

/// Opens a file, or every raster in a zip archive.
/// @throws tarn::Error  naming the file: cannot be read, holds no raster, has no CRS, no
///                      georeference, or is a picture rather than elevations
std::vector<Source> open_sources(const std::filesystem::path& path, const SourceOptions& options);

/// As above for pictures (orthophotos): the dataset as it is, CRS checked.
Source open_picture(const std::filesystem::path& path, const std::string& crs);

/// Metres per unit of height by the unit's name in files and options; 0 if it is not known.
double metres_per_unit(const std::string& unit);

/// "EPSG:..." or the name a CRS carries.
std::string describe(const OGRSpatialReference& crs);

} // namespace tarn::dem
