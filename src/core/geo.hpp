#pragma once
/// @file geo.hpp  Quantities that are easy to swap get their own type; the rest stay `double`.

namespace tarn {

/// A point on the WGS 84 ellipsoid; lat_deg in [-90, 90], lon_deg east-positive.
struct GeoPoint {
    double lat_deg = 0.0, lon_deg = 0.0;
};

/// A point in the scene's plane: x east, y north [m] (docs/units-and-frames.md).
struct ScenePoint {
    double x_m = 0.0, y_m = 0.0;
};

} // namespace tarn
