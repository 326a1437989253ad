#include "waves/wind_rose.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <fstream>

namespace tarn::waves {

std::vector<WindSector> read_wind_rose(const std::filesystem::path& path) {
    std::ifstream in(path);
    if (!in || !std::filesystem::is_regular_file(path))
        throw Error(path.string() + ": cannot be read", "check the path given with --wind-rose");
    std::vector<WindSector> rose;
    std::string line;
    double sum = 0.0;
    for (int number = 1; std::getline(in, line); ++number) {
        if (number > 100'000)
            throw Error(path.string() + ": has more than 100000 lines",
                        "give a table of direction, speed and frequency");
        line = line.substr(0, line.find('#'));
        for (char& c : line)
            if (c == ',' || c == ';' || c == '\t' || c == '\r')
                c = ' ';
        if (line.find_first_not_of(' ') == std::string::npos)
            continue;
        std::istringstream words(line);
        WindSector s;
        std::string more;
        if (!(words >> s.from_deg >> s.speed_m_per_s >> s.share) || words >> more) {
            if (rose.empty() && line.find_first_of("0123456789") == std::string::npos)
                continue; // a heading
            throw Error(text(path.string(), ", line ", number, ": is not three numbers"),
                        "write direction [deg], speed [m/s], frequency");
        }
        if (!(s.from_deg >= 0.0 && s.from_deg <= 360.0) ||
            !(s.speed_m_per_s >= 0.0 && s.speed_m_per_s <= 100.0) ||
            !(s.share >= 0.0 && s.share < 1e12))
            throw Error(text(path.string(), ", line ", number, ": ", s.from_deg, " deg, ",
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
