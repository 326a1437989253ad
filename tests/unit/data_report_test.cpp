// The real data sets: every lake that data/README.md names, with the level and area it gives,
// against what tarn finds. Prints the table of docs/accuracy.md (scripts/data-report writes it).
#include "core/text.hpp"
#include "dem/import.hpp"
#include "dem/stages.hpp"
#include "geo/frame.hpp"
#include "support/files.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

using namespace tarn;
using test_support::data;

namespace {

struct Named {
    const char* name;
    GeoPoint at; ///< a place in it or at its shore
    double level_m;
    double area_km2; ///< 0: none is given
    double percent;  ///< allowed difference; what the source's own cells leave open
};

struct DataSet {
    const char* name;
    std::vector<const char*> files;
    dem::ImportOptions options;
    std::vector<Named> lakes;
};

std::vector<DataSet> data_sets() {
    return {
        {"rotoma (DEM)",
         {"rotoma/rotoma_dem_32m.tif"},
         {},
         {{"Rotomā", {-38.0454, 176.5858}, 313.30, 0.0, 0.0},
          {"Rotoehu", {-38.0256, 176.5348}, 294.25, 0.0, 0.0},
          {"Rotoiti (cut)", {-38.0406, 176.4794}, 278.50, 0.0, 0.0}}},
        {"rotoma (topobathy)",
         {"rotoma/rotoma_topobathy_32m.tif"},
         {},
         {{"Rotomā", {-38.0454, 176.5858}, 313.30, 11.140, 0.1},
          {"Rotoehu", {-38.0256, 176.5348}, 294.25, 0.0, 0.0},
          {"Rotoiti (cut)", {-38.0406, 176.4794}, 278.50, 0.0, 0.0}}},
        {"crater_lake",
         {"crater_lake/ned_n43w124.tif", "crater_lake/ned_n43w123.tif"},
         {},
         {{"Crater Lake", {42.9446, -122.1090}, 1882.01, 53.29, 0.3},
          {"Upper Klamath", {42.5427, -122.0291}, 1262.04, 0.0, 0.0},
          {"Upper Klamath, marsh", {42.4585, -122.0236}, 1263.95, 0.0, 0.0},
          {"Lake of the Woods", {42.2651, -122.1854}, 1506.63, 0.0, 0.0}}},
        {"sainte_croix",
         {"sainte_croix/N43E006.hgt", "sainte_croix/N43E007.hgt.zip"},
         {},
         {{"Sainte-Croix", {43.766, 6.184}, 470.0, 18.8, 1.0},
          {"Castillon", {43.907, 6.532}, 867.0, 3.26, 1.0},
          // the README's area counts more arms than lie connected at 145 m
          {"Saint-Cassien", {43.585, 6.808}, 145.0, 2.61, 4.0},
          {"sea", {43.3, 7.6}, 0.0, 0.0, 0.0}}},
        {"fuji_five_lakes",
         {"fuji_five_lakes/fuji_srtm_90m.tif"},
         {},
         {{"Yamanaka", {35.419, 138.874}, 984.0, 6.61, 1.0},
          {"Kawaguchi", {35.513, 138.748}, 829.0, 5.23, 1.0},
          {"Motosu", {35.464, 138.585}, 896.0, 4.48, 1.0},
          {"Sai", {35.499, 138.685}, 899.0, 2.02, 1.0},
          {"Ashi (cut)", {35.2338, 138.9904}, 720.0, 0.0, 0.0},
          {"sea", {35.05, 138.70}, 0.0, 0.0, 0.0}}},
        {"thirlmere",
         {"thirlmere/thirlmere_eudem.tif"},
         {},
         {{"Thirlmere", {54.5470, -3.0706}, 179.65, 3.29, 0.3},
          {"Derwentwater (cut)", {54.5633, -3.1478}, 74.60, 0.0, 0.0},
          {"Grasmere", {54.4482, -3.0189}, 63.00, 0.61, 1.0},
          {"Rydal Water", {54.4469, -2.9959}, 57.30, 0.32, 1.0}}},
        {"ozarks",
         {"ozarks/ozarks_srtm_30m.tif"},
         {},
         {{"Lake of the Ozarks (part)", {38.2068, -92.7595}, 202.0, 133.5, 0.3}}},
        {"granby",
         {"granby/granby_dem.tif"},
         {},
         {{"Lake Granby (part)", {40.168, -105.873}, 2523.0, 5.5, 2.0}}},
        {"swellendam",
         {"swellendam/swellendam_srtm_utm33s.tif"},
         {.min_area_km2 = 0.02},
         {{"Buffeljags", {-34.010, 20.542}, 87.0, 0.0, 0.0}}},
    };
}

/// Where scripts/data-report wants the tables.
void publish(const std::string& section) {
    std::printf("%s", section.c_str());
    if (const char* path = std::getenv("TARN_DATA_REPORT"))
        std::ofstream(path, std::ios::app) << section;
}

std::string percent(double found, double expected) {
    const double p = 100.0 * (found / expected - 1.0);
    return (p >= 0 ? "+" : "") + fixed(p, std::abs(p) < 0.01 ? 4 : 2) + " %";
}

} // namespace

TEST(DataReport, EveryNamedLakeIsFoundWithItsLevelAndArea) {
    TARN_NEEDS_DATA("rotoma/rotoma_dem_32m.tif");
    std::ostringstream table;
    table << "\n## Lakes found (`tarn detect`, no options)\n\n"
             "| data | lake | level found | README | area found km² | README km² | difference |\n"
             "| --- | --- | --: | --: | --: | --: | --: |\n";
    std::ostringstream others;
    for (DataSet& set : data_sets()) {
        dem::ImportOptions options = set.options;
        for (const char* file : set.files) {
            ASSERT_TRUE(std::filesystem::exists(data(file))) << file;
            options.dems.push_back(data(file));
        }
        const dem::Detection found = dem::detect_lakes(options, {});
        std::vector<bool> taken(found.lakes.size());
        for (const Named& lake : set.lakes) {
            // The nearest lake at that level.
            int best = -1;
            double nearest = 12'000.0;
            for (std::size_t i = 0; i < found.lakes.size(); ++i) {
                const LakeRecord& l = found.lakes[i];
                const double away = l.sea ? 0.0 : geo::geodesic_distance_m(l.position, lake.at);
                if (std::abs(l.level_m - lake.level_m) <= 0.01 && away < nearest) {
                    best = int(i);
                    nearest = away;
                }
            }
            ASSERT_GE(best, 0) << set.name << ": " << lake.name << " was not found";
            taken[std::size_t(best)] = true;
            const LakeRecord& l = found.lakes[std::size_t(best)];
            table << "| " << set.name << " | " << lake.name << " | " << fixed(l.level_m, 2) << " | "
                  << fixed(lake.level_m, 2) << " | " << fixed(l.area_m2 / 1e6, 3) << " | "
                  << (lake.area_km2 > 0 ? fixed(lake.area_km2, 2) : std::string("–")) << " | "
                  << (lake.area_km2 > 0 ? percent(l.area_m2 / 1e6, lake.area_km2)
                                        : std::string("–"))
                  << " |\n";
            if (lake.area_km2 > 0)
                EXPECT_NEAR(l.area_m2 / 1e6 / lake.area_km2, 1.0, lake.percent / 100.0)
                    << set.name << " " << lake.name;
        }
        others << "| " << set.name << " | " << found.lakes.size() << " | " << set.lakes.size()
               << " | ";
        std::size_t count = 0;
        for (std::size_t i = 0; i < found.lakes.size(); ++i)
            if (!taken[i])
                others << (count++ ? "; " : "") << fixed(found.lakes[i].level_m, 2) << " m "
                       << fixed(found.lakes[i].area_m2 / 1e6, 2) << " km²";
        others << (count ? "" : "none") << " |\n";
        EXPECT_LE(found.lakes.size(), set.lakes.size() + 11) << set.name;
    }
    table << "\n### What else was found\n\nSurfaces of at least .02 km² that the README does not "
             "name: tarns, ponds, reservoirs, reaches of rivers.\n\n"
             "| data | found | named | the others |\n| --- | --: | --: | --- |\n"
          << others.str();
    publish(table.str());
}

TEST(DataReport, NothingIsFoundWhereThereIsNoLakeSurface) {
    TARN_NEEDS_DATA("pleasant_wi/pleasant_topobathy.tif");
    // A topobathy whose water has no surface in it, and river reaches under a size limit.
    EXPECT_TRUE(dem::detect_lakes({.dems = {data("pleasant_wi/pleasant_topobathy.tif")}}, {})
                    .lakes.empty());
    EXPECT_TRUE(dem::detect_lakes(
                    {.dems = {data("osgb_asc/osgb_dsm_2m_tiles.zip")}, .crs = "EPSG:27700"}, {})
                    .lakes.empty());
    const auto ponds = dem::detect_lakes({.dems = {data("osgb_asc/osgb_dsm_2m_tiles.zip")},
                                          .min_area_km2 = 0.0005,
                                          .crs = "EPSG:27700"},
                                         {});
    EXPECT_EQ(ponds.lakes.size(), 3u); // voids over water, and water beside them with laser noise
}

TEST(DataReport, StageTablesOfPleasantAndRotoma) {
    TARN_NEEDS_DATA("pleasant_wi/pleasant_topobathy.tif");
    TARN_NEEDS_DATA("rotoma/rotoma_topobathy_32m.tif");
    std::ostringstream out;
    {
        std::ifstream in(data("pleasant_wi/pleasant_stage_area_volume.csv"));
        std::string line;
        std::getline(in, line);
        std::vector<double> levels, areas, volumes;
        while (std::getline(in, line)) {
            double l = 0, a = 0, v = 0;
            if (std::sscanf(line.c_str(), "%lf,%lf,%lf", &l, &a, &v) == 3) {
                levels.push_back(l);
                areas.push_back(a);
                volumes.push_back(v);
            }
        }
        ASSERT_EQ(levels.size(), 290u);
        // Filled to the brim, then lowered: the table counts every cell of the basin.
        const auto scene = dem::import_dem(
            {.dems = {data("pleasant_wi/pleasant_topobathy.tif")}, .level_m = 299.96}, {});
        const auto table = dem::stage_table(scene.heights_m, scene.ground, scene.water, scene.frame,
                                            scene.lakes[0], levels, 8, {});
        double worst_area = 0.0, worst_volume = 0.0;
        for (std::size_t i = 0; i < levels.size(); ++i) {
            const double a = table.stages[i].area_m2, v = *table.stages[i].volume_m3;
            if (areas[i] == 0.0) { // the table's first row: nothing below
                EXPECT_EQ(a, 0.0);
                EXPECT_EQ(v, 0.0);
                continue;
            }
            worst_area = std::max(worst_area, std::abs(a / areas[i] - 1.0));
            worst_volume = std::max(worst_volume, std::abs(v / volumes[i] - 1.0));
            EXPECT_NEAR(a / areas[i], 1.0, 1e-4) << levels[i];
            EXPECT_NEAR(v / volumes[i], 1.0, 1e-4) << levels[i];
        }
        out << "\n## pleasant_wi: the published table\n\nAll 290 rows; greatest difference: area "
            << fixed(100 * worst_area, 6) << " %, volume " << fixed(100 * worst_volume, 4)
            << " %.\n";
    }
    {
        struct Row {
            double level, area_km2, volume_km3, depth;
        };
        const Row rows[] = {{300, 8.526, 0.3100, 67.2},     {310, 9.999, 0.4016, 77.2},
                            {313.31, 11.140, 0.4361, 80.5}, {315, 11.393, 0.4552, 82.2},
                            {316, 11.872, 0.4674, 83.2},    {318, 12.264, 0.4916, 85.2}};
        const auto scene = dem::import_dem(
            {.dems = {data("rotoma/rotoma_topobathy_32m.tif")}, .level_m = 313.31}, {});
        std::vector<double> levels;
        for (const Row& row : rows)
            levels.push_back(row.level);
        levels.push_back(320.0);
        // The README's table connects over 4 neighbours, tarn and r.lake over 8.
        const auto four = dem::stage_table(scene.heights_m, scene.ground, scene.water, scene.frame,
                                           scene.lakes[0], levels, 4, {});
        const auto eight = dem::stage_table(scene.heights_m, scene.ground, scene.water, scene.frame,
                                            scene.lakes[0], levels, 8, {});
        out << "\n## rotoma: the README's table\n\n| level m | area km² (4 neighbours) | README | "
               "difference | volume km³ | README | difference | area with 8 neighbours |\n"
               "| --: | --: | --: | --: | --: | --: | --: | --: |\n";
        for (std::size_t i = 0; i < std::size(rows); ++i) {
            const auto& s = four.stages[i];
            out << "| " << fixed(rows[i].level, 2) << " | " << fixed(s.area_m2 / 1e6, 4) << " | "
                << fixed(rows[i].area_km2, 3) << " | " << percent(s.area_m2 / 1e6, rows[i].area_km2)
                << " | " << fixed(*s.volume_m3 / 1e9, 5) << " | " << fixed(rows[i].volume_km3, 4)
                << " | " << percent(*s.volume_m3 / 1e9, rows[i].volume_km3) << " | "
                << fixed(eight.stages[i].area_m2 / 1e6, 4) << " |\n";
            EXPECT_NEAR(s.area_m2 / 1e6 / rows[i].area_km2, 1.0, 1e-3) << rows[i].level;
            EXPECT_NEAR(*s.volume_m3 / 1e9 / rows[i].volume_km3, 1.0, 1e-3) << rows[i].level;
            EXPECT_NEAR(*s.max_depth_m, rows[i].depth, 0.05) << rows[i].level;
            EXPECT_FALSE(s.open_at_edge);
        }
        EXPECT_NEAR(four.stages.back().area_m2 / 1e6, 91.5, 0.05);
        EXPECT_TRUE(four.stages.back().open_at_edge);
        ASSERT_TRUE(eight.spill.has_value());
        EXPECT_GT(eight.spill->level_m, 318.0);
        EXPECT_LT(eight.spill->level_m, 320.0);
        EXPECT_LT(eight.spill->pass.lon_deg, scene.lakes[0].position.lon_deg); // westward
        out << "\nAt 320 m: " << fixed(four.stages.back().area_m2 / 1e6, 1)
            << " km² inside the data (README 91.5, \"spills westward out of the basin and over the "
               "raster's edge\"). tarn: the lake may rise to "
            << fixed(eight.spill->level_m, 2) << " m; then it spills over the pass at "
            << fixed(eight.spill->pass.lat_deg, 4) << "," << fixed(eight.spill->pass.lon_deg, 4)
            << ", west of the lake.\n";
        // An import at 320 m says the same.
        const auto high = dem::import_dem({.dems = {data("rotoma/rotoma_topobathy_32m.tif")},
                                           .level_m = 320.0,
                                           .at = GeoPoint{-38.0454, 176.5858}},
                                          {});
        bool said = false;
        for (const std::string& note : high.report.notes)
            said |= note.find("spills over a pass of 318.") != std::string::npos &&
                    note.find("west of the lake") != std::string::npos &&
                    note.find("it may rise to 318.") != std::string::npos;
        std::string all;
        for (const std::string& note : high.report.notes)
            all += note + "\n";
        EXPECT_TRUE(said) << all;
        EXPECT_TRUE(high.lakes[0].open_at_edge);
    }
    publish(out.str());
}

TEST(DataReport, BedsFromSoundingsAndDepths) {
    TARN_NEEDS_DATA("rotoma/rotoma_depth_points.csv");
    TARN_NEEDS_DATA("long_lake_ns/longlake_depth.tif");
    std::ostringstream out;
    const auto made = dem::import_dem({.dems = {data("rotoma/rotoma_dem_32m.tif")},
                                       .at = GeoPoint{-38.0454, 176.5858},
                                       .lakes = dem::LakeChoice::one,
                                       .soundings = data("rotoma/rotoma_depth_points.csv")},
                                      {});
    const auto given = dem::import_dem({.dems = {data("rotoma/rotoma_topobathy_32m.tif")},
                                        .level_m = 313.31,
                                        .lakes = dem::LakeChoice::one},
                                       {});
    ASSERT_EQ(made.heights_m.size, given.heights_m.size);
    EXPECT_EQ(made.lakes[0].bed, Bed::interpolated);
    std::vector<double> differences, rim, rim_given;
    const GridSize size = made.heights_m.size;
    for (int r = 1; r + 1 < size.rows; ++r)
        for (int c = 1; c + 1 < size.cols; ++c) {
            const Node n{c, r};
            const auto wet = [&](Node m) {
                return made.water.codes[m] != no_water_code &&
                       made.ground.elevation_m(m) < made.water.elevation_m(m);
            };
            if (!wet(n) || made.lakes[0].level_m - made.water.elevation_m(n) > 0.01)
                continue;
            differences.push_back(std::abs(made.heights_m[n] - given.heights_m[n]));
            bool shore = false;
            for (const Node m : {Node{c - 1, r}, Node{c + 1, r}, Node{c, r - 1}, Node{c, r + 1}})
                shore |= !wet(m);
            if (shore) {
                rim.push_back(313.3 - made.heights_m[n]);
                rim_given.push_back(313.3 - given.heights_m[n]);
            }
        }
    const auto at = [](std::vector<double>& v, double share) {
        const auto k = std::ptrdiff_t(share * double(v.size() - 1));
        std::nth_element(v.begin(), v.begin() + k, v.end());
        return v[std::size_t(k)];
    };
    const double median = at(differences, 0.5), p90 = at(differences, 0.9);
    EXPECT_LE(median, 0.3);
    // No cliff: the first wet node is no deeper than where the given bed puts it.
    const double rim_median = at(rim, 0.5), given_median = at(rim_given, 0.5);
    EXPECT_LE(rim_median, given_median + 0.1);
    EXPECT_LE(at(rim, 0.9), at(rim_given, 0.9) + 0.5);
    out << "\n## rotoma: soundings into the DEM with flat lakes\n\nBed against the given topobathy "
           "over the lake's "
        << differences.size() << " nodes: median difference " << fixed(median, 3)
        << " m, 90th percentile " << fixed(p90, 2) << " m. First wet node: median depth "
        << fixed(rim_median, 2) << " m, in the topobathy " << fixed(given_median, 2) << " m.\n";
    const auto depths = dem::import_dem(
        {.dems = {data("long_lake_ns/longlake_depth.tif")}, .level_m = 20.0, .depths = true}, {});
    EXPECT_EQ(depths.lakes[0].bed, Bed::measured);
    EXPECT_NEAR(depths.lakes[0].area_m2 / 1e6, 0.970, 0.02 * 0.970);
    EXPECT_NEAR(*depths.lakes[0].volume_m3 / 1e6, 0.931, 0.02 * 0.931);
    EXPECT_NEAR(*depths.lakes[0].max_depth_m, 2.04, 0.03);
    out << "\n## long_lake_ns: depths alone (`--depths`)\n\nArea "
        << fixed(depths.lakes[0].area_m2 / 1e6, 3) << " km² (README .970), volume "
        << fixed(*depths.lakes[0].volume_m3 / 1e6, 3) << " million m³ (.931), greatest depth "
        << fixed(*depths.lakes[0].max_depth_m, 2) << " m (2.04).\n";
    publish(out.str());
}
