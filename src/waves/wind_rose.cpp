#include "waves/wind_rose.hpp"

#include "core/error.hpp"
#include "core/number_table.hpp"
#include "core/text.hpp"

#include <algorithm>

namespace tarn::waves {

std::vector<WindSector> read_wind_rose(const std::filesystem::path& path) {
    std::vector<WindSector> rose;
    double sum = 0.0;
    for (const NumberRow& row : read_number_table(
             path, 3, 3, "write direction [deg], speed [m/s], frequency on each line")) {
        const WindSector s{row.values[0], row.values[1], row.values[2]};
        if (!(s.from_deg >= 0.0 && s.from_deg <= 360.0) ||
            !(s.speed_m_per_s >= 0.0 && s.speed_m_per_s <= 100.0) ||
            !(s.share >= 0.0 && s.share < 1e12))
            throw Error(text(path.string(), ", line ", row.line, ": ", s.from_deg, " deg, ",
                             s.speed_m_per_s, " m/s, frequency ", s.share, " is out of range"),
                        "directions are 0 to 360, speeds 0 to 100 m/s, frequencies not negative");
        if (s.share > 0.0)
            rose.push_back(s);
        sum += s.share;
    }
    if (rose.empty())
        throw Error(path.string() + ": holds no wind",
                    "write direction [deg], speed [m/s], frequency on each line");
    for (WindSector& s : rose)
        s.share /= sum;
    return rose;
}

const WindSector& prevailing(const std::vector<WindSector>& rose) {
    return *std::max_element(
        rose.begin(), rose.end(),
        [](const WindSector& a, const WindSector& b) { return a.share < b.share; });
}

} // namespace tarn::waves
