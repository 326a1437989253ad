#pragma once
/// @file write.hpp  Heightfields and orthophotos as GeoTIFFs that QGIS shows in metres.
#include "core/heightfield.hpp"
#include "core/image.hpp"
#include "geo/frame_data.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace tarn::dem {

/// UInt16 GeoTIFF with GDAL scale and offset; pixel centres are the nodes.
/// @param nodata_zero  declare code 0 as nodata (for water)
/// @throws tarn::Error  if it cannot be written
void write_heightfield(const std::filesystem::path& path, const Heightfield& field,
                       const geo::Frame& frame, const std::string& description, bool nodata_zero);

/// Float32 GeoTIFF of exact heights on the grid of `place`; NaN is declared as nodata.
void write_heights(const std::filesystem::path& path, const Grid<float>& heights_m,
                   const Heightfield& place, const geo::Frame& frame);

/// UInt8 GeoTIFF of the ground's safety radii (core/safety_radius.hpp), a pixel a cell: its centre
/// lies between four nodes of `place`.
void write_safety_radii(const std::filesystem::path& path, const Grid<std::uint8_t>& radii,
                        const Heightfield& place, const geo::Frame& frame);

/// A class of a map and how it is drawn.
struct MapClass {
    std::string name;
    std::uint8_t red = 0, green = 0, blue = 0;
};

/// UInt8 GeoTIFF of classes 0, 1, ... with their names and colours, on the grid of `place`.
/// @param nodata  declare class 0 as nodata
void write_classes(const std::filesystem::path& path, const Grid<std::uint8_t>& classes,
                   const std::vector<MapClass>& meanings, const Heightfield& place,
                   const geo::Frame& frame, bool nodata);

void write_ortho(const std::filesystem::path& path, const Ortho& ortho, const geo::Frame& frame);

/// A plain Float32 GeoTIFF of elevations in any CRS; for samples and tests.
/// @param crs        EPSG:..., PROJ or WKT
/// @param transform  GDAL's six numbers, pixel edges
void write_elevations(const std::filesystem::path& path, const Grid<float>& elevation_m,
                      const std::string& crs, const double transform[6],
                      const std::string& description);

/// GDAL's and PROJ's release, for `tarn doctor`.
std::string library_versions();

} // namespace tarn::dem
