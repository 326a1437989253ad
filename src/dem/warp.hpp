#pragma once
/// @file warp.hpp  Windows of rasters, and rasters warped onto a grid, by GDAL.
#include "core/grid.hpp"
#include "core/progress.hpp"
#include "dem/gdal_door.hpp"

#include <limits>
#include <ogr_spatialref.h>
#include <string>
#include <vector>

namespace tarn::dem {

inline constexpr float void_m = std::numeric_limits<float>::quiet_NaN();

/// A box in some projection's coordinates; empty until something is added.
struct Extent {
    double west = 1e300, south = 1e300, east = -1e300, north = -1e300;
    void add(double x, double y) {
        west = std::min(west, x);
        east = std::max(east, x);
        south = std::min(south, y);
        north = std::max(north, y);
    }
    bool empty() const { return !(west < east && south < north); }
    Extent clipped_to(const Extent& other) const {
        return {std::max(west, other.west), std::max(south, other.south),
                std::min(east, other.east), std::min(north, other.north)};
    }
};

/// The box that holds the image of a rectangle's outline; points PROJ refuses are left out.
/// @throws tarn::Error  naming `name`, if none of it can be placed
Extent image_of(const Extent& box, OGRCoordinateTransformation& to, const std::string& name);

/// A grid in the scene's projection.
struct Target {
    GridSize size;
    Extent box; ///< outer edges of the cells around the nodes, projected coordinates
    std::string wkt;
    GeoTransform transform() const {
        return {{box.west, (box.east - box.west) / size.cols, 0.0, box.north, 0.0,
                 -(box.north - box.south) / size.rows}};
    }
};

/// Reads a window of band 1 of a height view; outside the raster NaN.
/// @throws tarn::Error  if it cannot be read
Grid<float> read_window(GDALDataset& ds, int col, int row, GridSize size);

/// Warps height views onto a grid, the later over the earlier; NaN where none has a height.
/// @param resampling  GDAL's word: cubic, bilinear, average
/// @throws tarn::Error      if GDAL cannot
/// @throws tarn::Cancelled
Grid<float> warp(const std::vector<GDALDataset*>& inputs, const Target& target,
                 const std::string& resampling, const Progress& progress, const std::string& what,
                 double from, double to);

} // namespace tarn::dem
