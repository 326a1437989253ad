#pragma once
/// @file caldera.hpp  Crater Lake, Oregon, put together from published figures alone.
///
/// NOT a survey: a smooth caldera of the right place, size, depth and rim heights, for trying tarn
/// without downloading anything. What is published, and where it enters:
///   level 1883 m; area 53 km2; greatest depth 594 m; volume 18.7 km3   (USGS survey of 2000; NPS)
///   the lake measures about 9.7 km east-west and 8.0 km north-south     (NPS)
///   Wizard Island: summit 2113 m, area 1.28 km2 (316 acres), in the west (USGS, NPS)
///   rim: Hillman Peak 2484 m, The Watchman 2442, Llao Rock 2453, Cloudcap 2458, Garfield Peak
///   2455, Rim Village 2164; Mount Scott 2721 m, outside the eastern rim       (USGS topographic
///   map)
#include "core/grid.hpp"

namespace tarn::samples {

struct Caldera {
    Grid<float> elevation_m;
    double spacing_m = 25.0;
    double west_m = 0.0, north_m = 0.0; ///< UTM 10N easting and northing of the north-west corner
    double area_m2 = 0.0, volume_m3 = 0.0, max_depth_m = 0.0; ///< what the fit reached
};

inline constexpr double caldera_level_m = 1883.0, caldera_area_m2 = 53.0e6,
                        caldera_volume_m3 = 18.7e9, caldera_depth_m = 594.0;

/// Fits size and bed profile until area, volume and depth meet the published figures on the grid.
Caldera make_caldera(double spacing_m);

} // namespace tarn::samples
