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
#include "geo/frame_data.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tarn::dem {

/// Which bed the DEM is taken to hold where no bathymetry is given.
enum class BedChoice { automatic, measured, unknown };

/// Every field's default is what `tarn import --help` prints.
struct ImportOptions {
    std::vector<std::filesystem::path> dems;
    std::optional<double> level_m;   ///< nothing = find the water surface
    std::optional<GeoPoint> at;      ///< a point in (or near) the lake
    std::optional<double> radius_km; ///< around `at`, (0, 500]
    std::optional<Bounds> bounds;
    std::optional<std::filesystem::path> bathymetry;
    BathymetryKind bathymetry_kind = BathymetryKind::automatic;
    BedChoice bed = BedChoice::automatic;
    std::optional<std::filesystem::path> ortho;
    std::optional<double> spacing_m; ///< [0.01, 100000]
    std::string crs;                 ///< replaces the DEMs' own
    std::optional<double> nodata;    ///< void besides what the files declare
    std::string name;                ///< of the lake, free text

    /// @throws tarn::Error  naming the field, its value and the legal range
    void validate() const;
};

struct ImportResult {
    geo::Frame frame;
    Heightfield ground, water;
    std::vector<LakeRecord> lakes;
    std::optional<Ortho> ortho;
    ImportReport report;
};

/// @throws tarn::Error      on input that cannot be used; names the file and what to do
/// @throws tarn::Cancelled
ImportResult import_dem(const ImportOptions& options, const Progress& progress);

} // namespace tarn::dem
