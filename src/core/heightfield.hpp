#pragma once
/// @file heightfield.hpp
/// A 16-bit elevation grid in a local metric frame: the one terrain type that crosses rooms.
///
/// Shape   `codes.size` nodes, row-major; row 0 is the NORTH edge, column 0 the WEST edge. A code
///         belongs to a NODE; between nodes the surface is bilinear.
/// Units   codes are unitless; elevation [m] = offset_m + scale_m * code. spacing_m is [m].
/// Frame   local east-north-up metres of the scene (docs/units-and-frames.md). Node (0, 0) lies at
///         west_m, north_m.
/// Errors  quantise() throws tarn::Error on bad input; accessors only assert.
/// Source  uniform quantiser: |error| <= scale_m / 2 (Baboud & Decoret 2006, sec. 3.2: one offset
///         and amplitude per texture, so that the 16 bits serve the range there is).
#include "core/grid.hpp"

#include <cstdint>
#include <span>

namespace tarn {

struct Heightfield {
    Grid<std::uint16_t> codes;
    double spacing_m = 0.0; ///< distance between nodes, same east and north, > 0
    double west_m = 0.0;    ///< x of column 0
    double north_m = 0.0;   ///< y of row 0
    double offset_m = 0.0;  ///< elevation of code 0
    double scale_m = 1.0;   ///< elevation step per code, > 0

    GridSize size() const { return codes.size; }
    double elevation_m(Node node) const { return offset_m + scale_m * codes[node]; }
    double x_m(double col) const { return west_m + col * spacing_m; }
    double y_m(double row) const { return north_m - row * spacing_m; }
    double col(double x) const { return (x - west_m) / spacing_m; }
    double row(double y) const { return (north_m - y) / spacing_m; }
    double east_m() const { return x_m(codes.size.cols - 1); }
    double south_m() const { return y_m(codes.size.rows - 1); }

    /// Bilinear elevation at scene position (x, y); outside the field the nearest edge counts.
    double elevation_m(double x, double y) const;
    /// Of all codes there could be: no node lies beyond, and at once.
    double lower_bound_m() const { return offset_m; }
    double upper_bound_m() const { return offset_m + 65535.0 * scale_m; }
    /// Of the nodes; looks at all of them.
    double min_elevation_m() const;
    double max_elevation_m() const;
};

/// Code of "no water here" in a water heightfield. Its stored height means nothing: whoever
/// decodes it takes a height below the ground. GIS programs see it as nodata.
inline constexpr std::uint16_t no_water_code = 0;

/// Packs elevations into 16-bit codes that span exactly [min, max] of the input.
///
/// @param elevations_m  size.count() values, row-major from the north-west [m]
/// @param size          both sides >= 2
/// @param spare_codes   codes left unused at either end, so that a node can still be moved just
///                      below the lowest or above the highest elevation, [0, 1000]
/// @param include_m     heights that the codes must reach too, water levels say
/// @return  a grid whose elevation_m() differs from the input by at most scale_m / 2
/// @throws  tarn::Error  if an argument breaks these rules, or naming the node that is not finite
Heightfield quantise(std::span<const float> elevations_m, GridSize size, double spacing_m,
                     int spare_codes = 0, std::span<const double> include_m = {});

} // namespace tarn
