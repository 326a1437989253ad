#pragma once
/// @file crs.hpp  Coordinate reference systems: from GDAL's words to the scene's frame.
#include "dem/gdal_door.hpp"
#include "geo/frame_data.hpp"

#include <memory>
#include <ogr_spatialref.h>
#include <optional>
#include <string>

namespace tarn::dem {

std::string wkt_of(const OGRSpatialReference& crs);  ///< WKT 2 (2019)
std::string proj_of(const OGRSpatialReference& crs); ///< PROJ string, empty if there is none

/// Without its vertical part, coordinates in the order of GIS (x, y; longitude, latitude).
OGRSpatialReference horizontal(const OGRSpatialReference& crs);
OGRSpatialReference wgs84();

/// Are the horizontal parts equivalent?
bool same_crs(const OGRSpatialReference& a, const OGRSpatialReference& b);

using Transformation = std::unique_ptr<OGRCoordinateTransformation>;

/// Horizontal transformation by PROJ's best operation.
/// @throws tarn::Error  if there is none
Transformation between(const OGRSpatialReference& from, const OGRSpatialReference& to);

/// The frame of a transverse Mercator CRS in metres; nothing if `crs` is something else.
/// The origin stays (0, 0); datum_shift is fitted later, over the scene.
std::optional<geo::Frame> transverse_mercator(const OGRSpatialReference& crs);

/// Asks PROJ how the frame's datum differs from WGS 84 over a square of half side `reach_m`
/// around scene (0, 0), and stores it. Returns the greatest error [m] found between the lattice's
/// places.
double sample_datum_shift(geo::Frame& frame, const OGRSpatialReference& crs, double reach_m);

/// GDAL's affine of a grid whose pixel CENTRES are the mosaic's nodes.
GeoTransform geo_transform(const geo::Frame& frame, double west_m, double north_m,
                           double spacing_m);

} // namespace tarn::dem
