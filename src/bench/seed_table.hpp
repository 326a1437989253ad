#pragma once
/// @file seed_table.hpp  Table 1 of Baboud & Decoret, "Realistic Water Volumes in Real-Time"
/// (2006), with tarn: how long a picture of 800 x 600 takes, by how much of it is water, and by
/// what is drawn of that.
#include "bench/timing.hpp"
#include "core/progress.hpp"
#include "scene/scene.hpp"

#include <iosfwd>
#include <string>
#include <vector>

namespace tarn::bench {

/// One row: a share of water, and a time for each of seed_table_modes.
struct SeedRow {
    double water_share = 0.0; ///< of the picture, measured
    std::vector<Times> times;
};

extern const std::vector<std::string> seed_table_modes;

/// Rows for all, half and a quarter of the picture. The camera stands 60 m over the lake and is
/// lifted from straight down to the sky until that much is water. Needs a current context.
/// @param scene         one with open water at (-400, -1500), as scene::mountain_lake()
/// @param wind_m_per_s  0: calm, where caustics and shafts are nothing
std::vector<SeedRow> measure_seed_table(const scene::Scene& scene, double wind_m_per_s, int runs,
                                        const Progress& progress);

/// {"nodes", "wind_m_per_s", "modes": [...], "rows": [{"water_share", "time_ms": [...]}]}
void write_seed_table(std::ostream& out, int nodes, double wind_m_per_s,
                      const std::vector<SeedRow>& rows);

} // namespace tarn::bench
