#pragma once
/// @file mosaic.hpp  Several rasters on their own grids -> one grid of metres in the scene's frame.
///
/// A grid that already is metric and square in a transverse Mercator projection is kept, cell for
/// node, nothing resampled. Everything else is warped by GDAL to a local transverse Mercator.
/// Flat surfaces (water) are carried over by nearest neighbour, so that a lake keeps its level
/// and its area; land is interpolated by cubics, held above the water beside it.
#include "core/grid.hpp"
#include "core/progress.hpp"
#include "dem/crs.hpp"
#include "dem/source.hpp"
#include "geo/frame_data.hpp"

#include <cstdint>
#include <optional>

namespace tarn::dem {

/// Elevations in the frame; NaN where there is no data.
struct Mosaic {
    geo::Frame frame;
    Grid<float> elevation_m;
    double spacing_m = 0.0;
    double west_m = 0.0, north_m = 0.0; ///< scene position of node (0, 0)
    std::string resampling = "none";
    std::vector<std::string> notes;
    bool stepped = false;    ///< a warped source's heights come in steps (whole metres, ...)
    Grid<std::uint8_t> laid; ///< 1 where a warped source's water surface was laid; empty if kept
};

/// Region of interest on WGS 84 [deg].
struct Bounds {
    double west_deg = 0.0, south_deg = 0.0, east_deg = 0.0, north_deg = 0.0;
};

struct MosaicOptions {
    std::optional<Bounds> bounds;
    std::optional<double> spacing_m; ///< > 0; asks for resampling
    int max_side = 16384;            ///< nodes; more is refused with a hint
};

/// @throws tarn::Error  if the rasters cannot be brought together, the region is outside them,
///                      or the grid would be too large
/// @throws tarn::Cancelled
Mosaic build_mosaic(std::vector<Source>& sources, const MosaicOptions& options,
                    const Progress& progress);

/// Brings one more raster onto a part of an existing mosaic's grid (NaN outside it).
Grid<float> onto_grid(Source& source, const Mosaic& mosaic, Node north_west, GridSize size,
                      const std::string& resampling);

} // namespace tarn::dem
