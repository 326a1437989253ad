#pragma once
/// @file soundings.hpp  Measured depths from vector data: points, or contours by their vertices.
#include "dem/bed.hpp"
#include "dem/mosaic.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace tarn::dem {

struct SoundingFile {
    std::vector<Sounding> soundings; ///< in nodes of the mosaic
    ImportInput input;
    std::vector<std::string> notes;
};

/// Reads points (CSV with columns like lon,lat,depth; anything OGR reads) or contour lines, whose
/// vertices are taken, and more between them where they are farther apart than the nodes.
/// @param field  name of the attribute that holds the depth; "" looks for depth, z, elevation, ...
///               and then for a third coordinate
/// @param crs    "" takes the file's own; a CSV without one is read as longitude, latitude (WGS 84)
/// @throws tarn::Error  naming the file: cannot be read, no such field, no usable number, or
///                      coordinates that are no longitudes and latitudes and have no CRS
SoundingFile read_soundings(const std::filesystem::path& path, const std::string& field,
                            const std::string& crs, const Mosaic& mosaic);

} // namespace tarn::dem
