#pragma once
/// @file wind_rose.hpp  How often the wind blows from where, and how strongly.
#include <filesystem>
#include <vector>

namespace tarn::waves {

struct WindSector {
    double from_deg = 0.0; ///< clockwise from true north, [0, 360]
    double speed_m_per_s = 0.0;
    double share = 0.0; ///< of the time, > 0; all together 1
};

/// Reads a table of direction [deg], speed [m/s] and frequency (any unit), one row a class of wind,
/// with commas, semicolons, tabs or blanks between them; a first line without numbers is a heading,
/// '#' begins a remark.
/// @throws tarn::Error  naming the file and line: cannot be read, not three numbers, out of range,
///                      or no wind in it
std::vector<WindSector> read_wind_rose(const std::filesystem::path& path);

/// The class of wind that blows most often.
const WindSector& prevailing(const std::vector<WindSector>& rose);

} // namespace tarn::waves
