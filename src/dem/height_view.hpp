#pragma once
/// @file height_view.hpp  Any band as Float32 metres with NaN where there is no data, read block by
///                        block: nothing is copied, however large the raster.
#include "dem/gdal_door.hpp"

#include <atomic>
#include <memory>
#include <ogr_spatialref.h>
#include <optional>
#include <vector>

namespace tarn::dem {

/// How stored values become metres: metres = base + factor * (offset + scale * stored).
struct HeightRule {
    double base = 0.0;                ///< the level that depths count from
    double scale = 1.0, offset = 0.0; ///< of the band
    double factor = 1.0;              ///< metres per unit; negative for depths
    std::vector<double> void_values;  ///< stored values that mean no data
    bool use_mask = false;            ///< the band has a mask or alpha of its own
    bool find_forgotten = false;      ///< floating point without declared nodata: -9999 and -32768
                                      ///< are voids too, as writers forget to say
};

/// What reading met that a report must name; written while blocks are read.
struct HeightFindings {
    std::atomic<bool> forgotten{false}; ///< undeclared -9999, -32768 or not finite
};

/// A read-only view of one band of `source`, which must outlive it. Heights beyond 12 km are
/// voids: no place on Earth reaches them, lost nodata tags do.
Dataset view_heights(GDALDataset& source, int band, HeightRule rule,
                     std::shared_ptr<HeightFindings> findings);

/// Says whether NaN is declared as nodata (it is until told otherwise). GDAL warps much faster if
/// it need not look for voids; tell it so only if there are none.
void declare_voids(GDALDataset& view, bool declared);

/// A tile within a joined raster: where its first pixel lies.
struct JoinedTile {
    GDALDataset* raster; ///< a view as above; outlives the joined raster
    int col, row;
};

/// Tiles of one grid (same spacing, whole pixels apart) as one raster, read as it is asked for;
/// where they overlap the last one that has a height counts.
Dataset join_views(std::vector<JoinedTile> tiles, const GeoTransform& transform, GridSize size,
                   const OGRSpatialReference& crs);

} // namespace tarn::dem
