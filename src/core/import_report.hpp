#pragma once
/// @file import_report.hpp  What an import read, did and assumed; kept in the scene folder.
#include <cstdint>
#include <string>
#include <vector>

namespace tarn {

struct ImportInput {
    std::string name;     ///< file name without its folder
    std::string role;     ///< "dem", "bathymetry" or "ortho"
    std::string format;   ///< GDAL driver
    std::string crs;      ///< name as declared, or "not declared"
    std::string vertical; ///< vertical datum as declared, or "not declared"
    std::string size;     ///< "cols x rows"
    std::string checksum; ///< CRC-32 of the file's bytes, hexadecimal
};

struct ImportReport {
    std::string command; ///< as the user typed it
    std::string created; ///< UTC, ISO 8601
    std::string tarn_version;
    std::vector<ImportInput> inputs;
    std::string resampling;          ///< "none" or how and from what spacing
    std::uint64_t nodes = 0;         ///< of the scene's grid
    std::uint64_t void_nodes = 0;    ///< had no data
    std::uint64_t filled_nodes = 0;  ///< voids inside the data, interpolated
    std::uint64_t outside_nodes = 0; ///< voids open to the edge: filled for the eye, never flooded
    double flat_share = 0.0;         ///< part of all nodes in flat surfaces (water without a bed)
    std::vector<std::string> notes;  ///< everything assumed, one sentence each
};

} // namespace tarn
