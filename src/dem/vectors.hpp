#pragma once
/// @file vectors.hpp  Lines, outlines and points of any vector file, in scene metres: for maps.
#include "core/geo.hpp"
#include "geo/frame_data.hpp"

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace tarn::dem {

/// A vertex and its height as the file says, NaN where it says none [m].
struct VectorPlace : ScenePoint {
    double z_m = std::numeric_limits<double>::quiet_NaN();
};

struct VectorFeature {
    std::vector<std::vector<VectorPlace>> lines; ///< outlines come back to their start
    std::vector<VectorPlace> points;
    std::string label; ///< of the field called name, label, title, ...; may be empty
};

/// Reads all layers (GeoJSON, GeoPackage, GPX, shapefile, ...). Places that cannot be transformed
/// are left out, and the points that GPX gives for each vertex of its tracks and routes again.
/// @throws tarn::Error  naming the file: missing, not readable, empty, or without a CRS and not in
///                      longitude and latitude
std::vector<VectorFeature> read_vectors(const std::filesystem::path& path, const geo::Frame& frame);

} // namespace tarn::dem
