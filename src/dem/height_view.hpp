#pragma once
/// @file height_view.hpp  Any band as Float32 metres with NaN where there is no data, read block by
///                        block: nothing is copied, however large the raster.
#include "dem/gdal_door.hpp"

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

namespace tarn::dem {

/// How stored values become metres: metres = factor * (offset + scale * stored).
struct HeightRule {
    double scale = 1.0, offset = 0.0; ///< of the band
    double factor = 1.0;              ///< metres per unit
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

} // namespace tarn::dem
