// The fill against GRASS r.lake, cell for cell, on the grids that scenes hold.
#include "dem/import.hpp"
#include "dem/write.hpp"
#include "geo/frame.hpp"
#include "support/files.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

using namespace tarn;
using test_support::data;
using test_support::TempFolder;

namespace {

std::string exact(double v) {
    char out[64];
    std::snprintf(out, sizeof out, "%.17g", v);
    return out;
}

/// r.lake's lake on the grid in `heights.tif` of `folder`: 1 = wet.
Grid<unsigned char> grass_lake(const TempFolder& folder, double east, double north, float level) {
    const auto out = folder / "lake.tif";
    const std::string command = std::string(TARN_SOURCE_DIR) + "/tests/support/rlake.sh " +
                                (folder / "heights.tif").string() + " " + exact(east) + " " +
                                exact(north) + " " + exact(double(level)) + " " + out.string();
    const auto outcome = test_support::run(command);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    dem::Dataset ds(GDALDataset::Open(out.c_str(), GDAL_OF_RASTER));
    if (!ds)
        return {};
    Grid<unsigned char> wet({ds->GetRasterXSize(), ds->GetRasterYSize()});
    std::vector<float> depth(wet.values.size());
    EXPECT_EQ(ds->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, wet.size.cols, wet.size.rows,
                                             depth.data(), wet.size.cols, wet.size.rows,
                                             GDT_Float32, 0, 0),
              CE_None);
    for (std::size_t i = 0; i < depth.size(); ++i)
        wet.values[i] = depth[i] > 0.0f;
    return wet;
}

bool have_grass() { return std::system("command -v grass >/dev/null 2>&1") == 0; }

} // namespace

TEST(Grass, RLakeFillsTheSameCellsOnSevenDataSets) {
    if (!have_grass())
        GTEST_SKIP() << "GRASS is not here (apt-get install grass-core)";
    TARN_NEEDS_DATA("rotoma/rotoma_topobathy_32m.tif");
    struct Case {
        const char* name;
        std::vector<const char*> files;
        double level_m;
        GeoPoint at;
    };
    const std::vector<Case> cases = {
        {"rotoma", {"rotoma/rotoma_topobathy_32m.tif"}, 313.31, {-38.0454, 176.5858}},
        {"rotoma, spilling", {"rotoma/rotoma_topobathy_32m.tif"}, 320.0, {-38.0454, 176.5858}},
        {"pleasant_wi", {"pleasant_wi/pleasant_topobathy.tif"}, 299.0544, {43.9849, -89.5497}},
        {"thirlmere", {"thirlmere/thirlmere_eudem.tif"}, 181.0, {54.5470, -3.0706}},
        {"ozarks", {"ozarks/ozarks_srtm_30m.tif"}, 203.5, {38.2068, -92.7595}},
        {"sainte_croix", {"sainte_croix/N43E006.hgt"}, 477.0, {43.766, 6.184}},
        {"fuji, Sai", {"fuji_five_lakes/fuji_srtm_90m.tif"}, 902.0, {35.499, 138.685}},
        {"crater_lake",
         {"crater_lake/ned_n43w124.tif", "crater_lake/ned_n43w123.tif"},
         1882.01,
         {42.9446, -122.1090}},
    };
    for (const Case& c : cases) {
        dem::ImportOptions options{.level_m = c.level_m, .at = c.at, .radius_km = 25.0};
        options.lakes = dem::LakeChoice::one;
        for (const char* file : c.files)
            options.dems.push_back(data(file));
        const TempFolder folder;
        const auto scene = dem::import_dem(options, {});
        dem::write_heights(folder / "heights.tif", scene.heights_m, scene.ground, scene.frame);
        const LakeRecord& lake = scene.lakes[0];
        const auto wet = grass_lake(
            folder, scene.frame.origin_easting_m + scene.ground.x_m(lake.seed.col),
            scene.frame.origin_northing_m + scene.ground.y_m(lake.seed.row), float(c.level_m));
        ASSERT_EQ(wet.size, scene.ground.size()) << c.name;
        std::size_t ours = 0, theirs = 0, differ = 0;
        for (int r = 0; r < wet.size.rows; ++r)
            for (int col = 0; col < wet.size.cols; ++col) {
                const Node n{col, r};
                const bool here = scene.water.codes[n] != no_water_code &&
                                  scene.ground.elevation_m(n) < scene.water.elevation_m(n);
                ours += here;
                theirs += wet[n];
                differ += here != (wet[n] != 0);
            }
        EXPECT_EQ(differ, 0u) << c.name;
        EXPECT_EQ(double(theirs) * scene.ground.spacing_m * scene.ground.spacing_m, lake.area_m2);
        std::printf("%-18s %4d x %4d  level %8.2f m  r.lake %7zu cells, tarn %7zu, differing %zu\n",
                    c.name, wet.size.cols, wet.size.rows, c.level_m, theirs, ours, differ);
    }
}
