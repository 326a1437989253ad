#pragma once
/// @file frame.hpp  Latitude and longitude <-> scene metres, by GeographicLib.
///
/// Source  Karney (2011), Transverse Mercator with an accuracy of a few nanometers, J. Geodesy 85,
///         as GeographicLib::TransverseMercator. GDAL/PROJ warps the rasters with its own code;
///         tests/unit/frame_test.cpp holds the two together (1 mm; 1 cm for shifted datums).
#include "core/geo.hpp"
#include "geo/frame_data.hpp"

#include <vector>

namespace tarn::geo {

/// A frame of our own: WGS 84, true scale, centred on `centre`, which becomes scene (0, 0).
Frame local_frame(GeoPoint centre);

/// @throws tarn::Error  if the ellipsoid or scale cannot be used, or the point is not finite
ScenePoint to_scene(const Frame& frame, GeoPoint point);
GeoPoint to_geo(const Frame& frame, ScenePoint point);

/// Grid length over true length on the ellipsoid, near 1.
double scale_factor(const Frame& frame, ScenePoint point);

/// Angle from true north to grid north, clockwise positive [deg]:
/// grid azimuth = true azimuth - convergence.
double convergence_deg(const Frame& frame, ScenePoint point);

/// Area inside a polygon of geodesics on WGS 84 [m2], whatever its orientation.
double geodesic_area_m2(const std::vector<GeoPoint>& polygon);

/// Length of the geodesic on WGS 84 [m].
double geodesic_distance_m(GeoPoint a, GeoPoint b);

} // namespace tarn::geo
