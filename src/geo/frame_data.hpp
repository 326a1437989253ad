#pragma once
/// @file frame_data.hpp  Where on Earth a scene lies: plain numbers, no library needed.
///
/// A frame is a transverse Mercator projection plus an origin: scene x = easting - origin east,
/// scene y = northing - origin north, z = height in the DEM's vertical datum, all in metres.
/// y points to GRID north; true north differs by the meridian convergence (geo/frame.hpp).
#include <string>
#include <vector>

namespace tarn::geo {

/// Ground coordinates on another datum than WGS 84 (OSGB36, DHDN, ...) differ from a plain
/// projection of WGS 84 positions by up to some hundred metres. The difference, asked of PROJ at
/// import (which may use a correction grid with kinks of its own), is kept on a square lattice of
/// `side` x `side` places over [-reach, reach]^2 scene metres, bilinear between them.
struct DatumShift {
    int side = 0;                        ///< 0: no shift; else >= 2
    double reach_m = 0.0;                ///< half the lattice's width, > 0
    std::vector<double> east_m, north_m; ///< side * side each, row by row from the south-west
    friend bool operator==(const DatumShift&, const DatumShift&) = default;
};

struct Frame {
    double semi_major_m = 6378137.0;           ///< WGS 84 unless the DEM's CRS says otherwise
    double inverse_flattening = 298.257223563; ///< 0 for a sphere
    double lat0_deg = 0.0, lon0_deg = 0.0;     ///< natural origin of the projection
    double scale0 = 1.0;                       ///< scale factor on the central meridian
    double false_easting_m = 0.0, false_northing_m = 0.0;
    double origin_easting_m = 0.0, origin_northing_m = 0.0; ///< projected place of scene (0, 0)
    DatumShift datum_shift; ///< none where the datum agrees with WGS 84
    std::string proj, wkt;  ///< the same CRS for other programs
    std::string vertical_datum = "not declared";
    friend bool operator==(const Frame&, const Frame&) = default;
};

} // namespace tarn::geo
