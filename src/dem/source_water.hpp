#pragma once
/// @file source_water.hpp  The water surfaces of warped sources: found in the source's own pixels,
///                         laid into the scene's grid with their level and area.
#include "dem/warp.hpp"

#include <cstdint>
#include <memory>

namespace tarn::dem {

/// The water surfaces of all sources, the later over the earlier.
class SourceWater {
public:
    /// Searches the parts of the sources that the target uses.
    /// @param inputs  height views, the later over the earlier; they must outlive this
    SourceWater(const Target& target, const std::vector<GDALDataset*>& inputs,
                const std::vector<const OGRSpatialReference*>& crs, const Progress& progress);
    ~SourceWater();
    SourceWater(const SourceWater&) = delete;
    SourceWater& operator=(const SourceWater&) = delete;

    bool has_voids() const { return voids_; } ///< a node without data was met
    bool stepped() const { return stepped_; } ///< heights of a source come in steps

    /// Lays the surfaces by nearest neighbour: level and area stay. Then land beside them that a
    /// cubic pulled below their level, although bilinear interpolation keeps it above, is lifted:
    /// no puddles along the shore. Land that is really lower (a polder, the river below a dam) is
    /// lower in both.
    /// @param elevation_m  the sources warped onto the target
    /// @param cubic        by cubics
    /// @return 1 where a surface was laid
    Grid<std::uint8_t> lay(Grid<float>& elevation_m, bool cubic, const Progress& progress);

private:
    class Layer;
    Target target_;
    std::vector<std::unique_ptr<Layer>> layers_;
    bool voids_ = false, stepped_ = false;
};

} // namespace tarn::dem
