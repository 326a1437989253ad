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

struct SoundingOptions {
    std::string field; ///< attribute that holds the depth; "" looks for depth, z, elevation, ...
                       ///< and then for a third coordinate
    std::string crs; ///< "" takes the file's own; a CSV without one is longitude, latitude (WGS 84)
    std::string unit; ///< "m", "ft", ...; "" is metres, or feet if the field's name ends in _ft
};

/// Reads points (CSV with columns like lon,lat,depth; anything OGR reads) or contour lines, whose
/// vertices are taken, and more between them where they are farther apart than the nodes.
/// Numbers that stand for "none" (-9999, -32768, 9999, 99999, beyond 12 km) are left out.
/// @throws tarn::Error  naming the file: cannot be read, no such field, no usable number, or
///                      coordinates that are no longitudes and latitudes and have no CRS
SoundingFile read_soundings(const std::filesystem::path& path, const SoundingOptions& options,
                            const Mosaic& mosaic);

} // namespace tarn::dem
