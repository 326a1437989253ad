// The whole import on files: made ones with known answers, and the real ones where they are.
#include "caldera.hpp"
#include "core/error.hpp"
#include "dem/import.hpp"
#include "dem/write.hpp"
#include "geo/frame.hpp"
#include "support/files.hpp"

#include <array>
#include <cmath>
#include <gdal_utils.h>
#include <gtest/gtest.h>
#include <iomanip>

using namespace tarn;
using test_support::data;
using test_support::TempFolder;

namespace {

/// A lake with a real bed in UTM 33N: z = 40 (r/500)^2, spacing 5 m.
Grid<float> bowl(int side, double spacing, double shift_x = 0.0, double shift_y = 0.0) {
    Grid<float> z({side, side});
    const double half = 0.5 * (side - 1) * spacing;
    for (int r = 0; r < side; ++r)
        for (int c = 0; c < side; ++c) {
            const double x = c * spacing - half + shift_x, y = half - r * spacing + shift_y;
            z[{c, r}] = float(40.0 * (x * x + y * y) / 250'000.0);
        }
    return z;
}

void write(const std::filesystem::path& path, const Grid<float>& z, double east, double north,
           double spacing, const std::string& crs = "EPSG:32633") {
    const double t[6] = {east, spacing, 0, north, 0, -spacing};
    dem::write_elevations(path, z, crs, t, "test");
}

const LakeRecord& only(const dem::ImportResult& result) {
    EXPECT_GE(result.lakes.size(), 1u); // the lake asked for; others of the data may follow
    return result.lakes.front();
}

} // namespace

TEST(Import, AMetricTransverseMercatorGridIsKeptNodeForNode) {
    const TempFolder folder;
    const Grid<float> z = bowl(201, 5.0);
    write(folder / "bowl.tif", z, 500'000, 5'300'000, 5.0);
    const auto result = dem::import_dem({.dems = {folder / "bowl.tif"}, .level_m = 10.0}, {});
    EXPECT_EQ(result.report.resampling, "none");
    ASSERT_EQ(result.ground.size(), z.size);
    for (std::size_t i = 0; i < z.values.size(); ++i) { // within half a code; a shore node one more
        const double got =
            result.ground.offset_m + result.ground.scale_m * result.ground.codes.values[i];
        ASSERT_NEAR(got, z.values[i], 1.01 * result.ground.scale_m);
    }
    // Node (0, 0) is the centre of the north-west pixel.
    EXPECT_DOUBLE_EQ(result.frame.origin_easting_m + result.ground.west_m, 500'002.5);
    EXPECT_DOUBLE_EQ(result.frame.origin_northing_m + result.ground.north_m, 5'299'997.5);
    EXPECT_NEAR(only(result).area_m2, M_PI * 250 * 250, 0.005 * M_PI * 250 * 250);
    EXPECT_NEAR(*only(result).volume_m3, M_PI * 250 * 250 * 5, 0.005 * M_PI * 250 * 250 * 5);
}

TEST(Import, TilesInPhaseAreJoinedWithoutResampling) {
    const TempFolder folder;
    const Grid<float> whole = bowl(200, 5.0);
    for (int k = 0; k < 4; ++k) {
        Grid<float> part({100, 100});
        for (int r = 0; r < 100; ++r)
            for (int c = 0; c < 100; ++c)
                part[{c, r}] = whole[{c + (k % 2) * 100, r + (k / 2) * 100}];
        write(folder / ("t" + std::to_string(k) + ".tif"), part, 500'000 + (k % 2) * 500.0,
              5'300'000 - (k / 2) * 500.0, 5.0);
    }
    const auto tiles = dem::import_dem(
        {.dems = {folder / "t3.tif", folder / "t0.tif", folder / "t2.tif", folder / "t1.tif"},
         .level_m = 10.0},
        {});
    write(folder / "whole.tif", whole, 500'000, 5'300'000, 5.0);
    const auto one = dem::import_dem({.dems = {folder / "whole.tif"}, .level_m = 10.0}, {});
    EXPECT_EQ(tiles.report.resampling, "none");
    EXPECT_EQ(tiles.ground.codes.values, one.ground.codes.values);
    EXPECT_EQ(tiles.ground.west_m, one.ground.west_m);
    EXPECT_EQ(tiles.ground.north_m, one.ground.north_m);
}

TEST(Import, AGeographicGridIsWarpedAndLandsInItsPlace) {
    // A conical pit at 46 N 9 E, given in degrees: z = .2 of the distance from its middle.
    const TempFolder folder;
    const double step = 1.0 / 3600;
    Grid<float> z({240, 240});
    const GeoPoint middle{46.0, 9.0};
    const geo::Frame local = geo::local_frame(middle);
    for (int r = 0; r < 240; ++r)
        for (int c = 0; c < 240; ++c) {
            const ScenePoint p =
                geo::to_scene(local, {46.0 + (119.5 - r) * step, 9.0 + (c - 119.5) * step});
            z[{c, r}] = float(0.2 * std::hypot(p.x_m, p.y_m));
        }
    write(folder / "pit.tif", z, 9.0 - 120 * step, 46.0 + 120 * step, step, "EPSG:4326");
    const auto result = dem::import_dem({.dems = {folder / "pit.tif"}, .level_m = 200.0}, {});
    EXPECT_NE(result.report.resampling, "none");
    EXPECT_NEAR(only(result).area_m2, M_PI * 1e6, 0.004 * M_PI * 1e6); // radius 1000 m
    // The tip falls between the source's cells: its lowest one stands .2 x half a diagonal higher.
    EXPECT_NEAR(*only(result).max_depth_m, 200.0, 0.2 * 0.5 * std::hypot(30.9, 21.5) + 0.5);
    EXPECT_NEAR(only(result).position.lat_deg, 46.0, 5e-4);
    EXPECT_NEAR(only(result).position.lon_deg, 9.0, 5e-4);
    EXPECT_NEAR(only(result).true_area_m2, M_PI * 1e6, 0.004 * M_PI * 1e6);
    // Heights where the source says they are: on the slope, within the source's own resolution.
    for (const double x : {-1500.0, 700.0, 1800.0}) {
        const ScenePoint p = geo::to_scene(result.frame, geo::to_geo(local, {x, 0.4 * x}));
        EXPECT_NEAR(result.ground.elevation_m(p.x_m, p.y_m), 0.2 * std::hypot(x, 0.4 * x), 1.0);
    }
}

TEST(Import, FeetAndBandScalesBecomeMetres) {
    const TempFolder folder;
    Grid<float> z = bowl(101, 10.0);
    for (float& v : z.values)
        v = v / 0.3048f;
    write(folder / "feet.tif", z, 500'000, 5'300'000, 10.0);
    {
        dem::register_drivers();
        dem::Dataset ds(
            GDALDataset::Open((folder / "feet.tif").c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
        ds->GetRasterBand(1)->SetUnitType("ft");
    }
    const auto result = dem::import_dem({.dems = {folder / "feet.tif"}, .level_m = 10.0}, {});
    EXPECT_NEAR(*only(result).volume_m3, M_PI * 250 * 250 * 5, 0.01 * M_PI * 250 * 250 * 5);
    ASSERT_FALSE(result.report.notes.empty());
    EXPECT_NE(result.report.notes.front().find("turned into metres"), std::string::npos);
}

TEST(Import, BoundsAndRadiusCutTheScene) {
    const TempFolder folder;
    write(folder / "bowl.tif", bowl(401, 5.0), 500'000, 5'300'000, 5.0);
    const geo::Frame utm =
        dem::import_dem({.dems = {folder / "bowl.tif"}, .level_m = 10.0}, {}).frame;
    const GeoPoint middle = geo::to_geo(utm, {0, 0});
    const auto cut = dem::import_dem(
        {.dems = {folder / "bowl.tif"}, .level_m = 10.0, .at = middle, .radius_km = 0.4}, {});
    EXPECT_NEAR(cut.ground.size().cols * 5.0, 800.0, 20.0);
    EXPECT_NEAR(cut.ground.size().rows * 5.0, 800.0, 20.0);
    EXPECT_NEAR(only(cut).area_m2, M_PI * 250 * 250, 0.01 * M_PI * 250 * 250);
    EXPECT_FALSE(only(cut).open_at_edge);
    const auto tight = dem::import_dem(
        {.dems = {folder / "bowl.tif"}, .level_m = 10.0, .at = middle, .radius_km = 0.2}, {});
    EXPECT_TRUE(only(tight).open_at_edge);
}

TEST(Import, BadInputGetsOneClearLine) {
    const TempFolder folder;
    write(folder / "bowl.tif", bowl(51, 20.0), 500'000, 5'300'000, 20.0);
    const auto says = [](const dem::ImportOptions& options) -> std::string {
        try {
            dem::import_dem(options, {});
            return "no error";
        } catch (const Error& error) {
            return error.what();
        }
    };
    const auto bowl_tif = folder / "bowl.tif";
    const auto has = [&](const dem::ImportOptions& options, const std::string& words) {
        const std::string said = says(options);
        EXPECT_NE(said.find(words), std::string::npos) << said;
        EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    };
    has({.dems = {}}, "no elevation data");
    has({.dems = {folder / "none.tif"}, .level_m = 1.0}, "no such file");
    std::ofstream(folder / "text.tif") << "this is no raster";
    has({.dems = {folder / "text.tif"}, .level_m = 1.0}, "GDAL cannot read it");
    std::ofstream(folder / "empty.tif") << "";
    has({.dems = {folder / "empty.tif"}, .level_m = 1.0}, "GDAL cannot read it");
    const std::string bytes = test_support::read_file(bowl_tif);
    std::ofstream(folder / "cut.tif", std::ios::binary) << bytes.substr(0, bytes.size() / 2);
    has({.dems = {folder / "cut.tif"}, .level_m = 1.0}, "cut.tif");
    has({.dems = {bowl_tif}, .level_m = -5.0}, "nothing lies below the level");
    has({.dems = {bowl_tif}, .level_m = NAN}, "--level");
    has({.dems = {bowl_tif}}, "no flat water surface");
    has({.dems = {bowl_tif}, .level_m = 10.0, .at = GeoPoint{0, 0}}, "outside the elevation data");
    has({.dems = {bowl_tif}, .level_m = 10.0, .radius_km = 3.0}, "--radius needs a centre");
    has({.dems = {bowl_tif}, .level_m = 10.0, .bounds = dem::Bounds{1, 1, 0, 0}},
        "--bounds must be");
    has({.dems = {bowl_tif}, .level_m = 10.0, .bounds = dem::Bounds{-60, -60, -59, -59}},
        "lies outside");
    has({.dems = {bowl_tif}, .level_m = 10.0, .spacing_m = 0.0}, "--spacing");
    has({.dems = {bowl_tif}, .level_m = 10.0, .spacing_m = 0.01}, "nodes, more than 16384");
    has({.dems = {bowl_tif}, .level_m = 10.0, .crs = "EPSG:nonsense"}, "--crs");
    has({.dems = {bowl_tif}, .level_m = 10.0, .crs = "EPSG:4326"}, "look like metres");
    has({.dems = {bowl_tif}, .level_m = 10.0, .bathymetry = folder / "none.tif"}, "no such file");
    write(folder / "degrees.tif", bowl(51, 20.0), 15.0, 45.0, 0.0003);
    has({.dems = {folder / "degrees.tif"}, .level_m = 10.0}, "look like degrees");
    write(folder / "plane.tif", Grid<float>({20, 20}, NAN), 500'000, 5'300'000, 20.0);
    has({.dems = {folder / "plane.tif"}, .level_m = 10.0}, "no elevation data in this region");
    {
        const double t[6] = {0, 1, 0, 0, 0, -1};
        dem::write_elevations(folder / "nocrs.tif", bowl(11, 5.0), "LOCAL_CS[\"nowhere\"]", t, "");
        has({.dems = {folder / "nocrs.tif"}, .level_m = 10.0}, "give one with --crs");
    }
    int calls = 0;
    EXPECT_THROW(dem::import_dem({.dems = {bowl_tif}, .level_m = 10.0},
                                 Progress([&](double, const std::string&) { return ++calls < 3; })),
                 Cancelled);
}

TEST(Import, TilesOnBothSidesOfTheDateLineAreJoined) {
    // A lake across 180 degrees, from an eastern and a western tile.
    const TempFolder folder;
    const double step = 1.0 / 1200.0;
    const geo::Frame local = geo::local_frame({-17.0, 180.0});
    for (int side = 0; side < 2; ++side) {
        Grid<float> z({120, 120});
        const double west = side == 0 ? 180.0 - 120 * step : -180.0;
        for (int r = 0; r < 120; ++r)
            for (int c = 0; c < 120; ++c) {
                const ScenePoint p =
                    geo::to_scene(local, {-17.0 + (59.5 - r) * step, west + (c + 0.5) * step});
                z[{c, r}] = float(std::max(50.0, 0.05 * std::hypot(p.x_m, p.y_m)));
            }
        write(folder / (side ? "w.tif" : "e.tif"), z, west, -17.0 + 60 * step, step, "EPSG:4326");
    }
    for (const double lon : {179.999, -179.999}) {
        const auto result = dem::import_dem({.dems = {folder / "e.tif", folder / "w.tif"},
                                             .at = GeoPoint{-17.0, lon},
                                             .radius_km = 4.0},
                                            {});
        // Both halves; cells of 92 x 88 m make the circle.
        EXPECT_NEAR(only(result).area_m2, M_PI * 1e6, 0.05 * M_PI * 1e6);
        EXPECT_FALSE(only(result).open_at_edge);
    }
}

TEST(Import, AWorldMapCanBeCut) {
    const TempFolder folder;
    Grid<float> z({1440, 720}, 500.0f);
    for (int r = 170; r < 180; ++r) // a great lake around 46 N 9 E
        for (int c = 750; c < 762; ++c)
            z[{c, r}] = 400.0f;
    write(folder / "world.tif", z, -180.0, 90.0, 0.25, "EPSG:4326");
    const auto result = dem::import_dem({.dems = {folder / "world.tif"},
                                         .level_m = 450.0,
                                         .at = GeoPoint{46.0, 9.0},
                                         .radius_km = 300.0},
                                        {});
    EXPECT_NEAR(only(result).true_area_m2, 10 * 0.25 * 111.2e3 * 12 * 0.25 * 77.3e3, 0.1 * 6.4e10);
    EXPECT_FALSE(only(result).open_at_edge);
}

TEST(Import, ADatumOffsetMovesElevationsAndNotDepths) {
    const TempFolder folder;
    Grid<float> z = bowl(201, 5.0);
    for (float& v : z.values)
        v += 100.0f;
    Grid<float> bed = z, depth(z.size, NAN);
    for (std::size_t i = 0; i < z.values.size(); ++i)
        if (z.values[i] < 110.0f) {
            depth.values[i] = 110.0f - z.values[i];
            z.values[i] = 110.0f; // the DEM holds the surface
        } else {
            bed.values[i] = NAN;
        }
    for (float& v : bed.values)
        v -= 3.0f; // a datum three metres off
    write(folder / "flat.tif", z, 500'000, 5'300'000, 5.0);
    write(folder / "bed.tif", bed, 500'000, 5'300'000, 5.0);
    write(folder / "depth.tif", depth, 500'000, 5'300'000, 5.0);
    std::ofstream csv(folder / "elevations.csv");
    csv << "x,y,z\n";
    for (int r = 0; r < 201; r += 3)
        for (int c = 0; c < 201; c += 3)
            if (!std::isnan(bed[Node(c, r)]))
                csv << 500'002.5 + 5 * c << "," << 5'299'997.5 - 5 * r << "," << bed[Node(c, r)]
                    << "\n";
    csv.close();
    dem::ImportOptions options{.dems = {folder / "flat.tif"}, .level_m = 110.0};
    options.bathymetry_offset_m = 3.0;
    const double volume = M_PI * 250 * 250 * 5;
    for (const char* file : {"bed.tif", "depth.tif"}) {
        options.bathymetry = folder / file;
        const auto result = dem::import_dem(options, {});
        EXPECT_NEAR(*only(result).volume_m3, volume, 0.01 * volume) << file;
        EXPECT_NEAR(*only(result).max_depth_m, 10.0, 0.05) << file;
    }
    options.bathymetry.reset();
    options.soundings = folder / "elevations.csv";
    options.bathymetry_crs = "EPSG:32633";
    const auto result = dem::import_dem(options, {});
    EXPECT_NEAR(*only(result).volume_m3, volume, 0.015 * volume);
    EXPECT_EQ(only(result).bed, Bed::interpolated);
}

TEST(Import, ContoursAndABathymetryInAnotherCrsMakeTheBed) {
    const TempFolder folder;
    Grid<float> z = bowl(201, 5.0), bed = z;
    for (float& v : z.values)
        v = std::max(v, 10.0f); // the DEM holds the surface of a lake 10 m deep
    for (float& v : bed.values)
        v = 10.0f - v; // depths, negative on land
    write(folder / "flat.tif", z, 500'000, 5'300'000, 5.0);
    const double volume = M_PI * 250 * 250 * 5;
    {
        // Depth contours every metre, as lines in longitude and latitude.
        const geo::Frame utm =
            dem::import_dem({.dems = {folder / "flat.tif"}, .level_m = 10.0}, {}).frame;
        std::ofstream json(folder / "contours.geojson");
        json << R"({"type":"FeatureCollection","features":[)";
        for (int depth = 1; depth <= 9; ++depth) {
            json << (depth > 1 ? "," : "") << R"({"type":"Feature","properties":{"depth":)" << depth
                 << R"(},"geometry":{"type":"LineString","coordinates":[)";
            const double r = std::sqrt((10.0 - depth) / 40.0) * 500.0;
            for (int k = 0; k <= 90; ++k) { // the middle of the bowl is at 500 502.5, 5 299 497.5
                const double a = 2 * M_PI * k / 90;
                const GeoPoint p =
                    geo::to_geo(utm, {500'502.5 + r * std::cos(a) - utm.origin_easting_m,
                                      5'299'497.5 + r * std::sin(a) - utm.origin_northing_m});
                json << (k ? "," : "") << std::setprecision(12) << "[" << p.lon_deg << ","
                     << p.lat_deg << "]";
            }
            json << "]}}";
        }
        json << "]}";
    }
    const auto contours = dem::import_dem(
        {.dems = {folder / "flat.tif"}, .level_m = 10.0, .soundings = folder / "contours.geojson"},
        {});
    EXPECT_EQ(only(contours).bed, Bed::interpolated);
    EXPECT_NEAR(*only(contours).volume_m3, volume, 0.02 * volume);
    EXPECT_NEAR(*only(contours).max_depth_m, 9.0, 0.1); // nothing is known inside the innermost
    // The same bed as a raster in another projection, grid and extent.
    write(folder / "bed.tif", bed, 500'000, 5'300'000, 5.0);
    dem::Dataset in(GDALDataset::Open((folder / "bed.tif").c_str(), GDAL_OF_RASTER));
    dem::Arguments words{"-t_srs", "EPSG:3035", "-tr",        "7",  "7",
                         "-r",     "cubic",     "-dstnodata", "nan"};
    GDALWarpAppOptions* options = GDALWarpAppOptionsNew(words.get(), nullptr);
    GDALDatasetH handle = GDALDataset::ToHandle(in.get());
    dem::Dataset(GDALDataset::FromHandle(
        GDALWarp((folder / "laea.tif").c_str(), nullptr, 1, &handle, options, nullptr)));
    GDALWarpAppOptionsFree(options);
    const auto warped = dem::import_dem(
        {.dems = {folder / "flat.tif"}, .level_m = 10.0, .bathymetry = folder / "laea.tif"}, {});
    EXPECT_EQ(only(warped).bed, Bed::measured);
    EXPECT_NEAR(*only(warped).volume_m3, volume, 0.01 * volume);
    EXPECT_NEAR(*only(warped).max_depth_m, 10.0, 0.05);
}

TEST(Import, NoTileIsDroppedForItsVerticalDatum) {
    const TempFolder folder;
    const Grid<float> whole = bowl(200, 5.0);
    for (int k = 0; k < 2; ++k) {
        Grid<float> part({100, 200});
        for (int r = 0; r < 200; ++r)
            for (int c = 0; c < 100; ++c)
                part[{c, r}] = whole[{c + k * 100, r}];
        write(folder / (k ? "east.tif" : "west.tif"), part, 500'000 + k * 500.0, 5'300'000, 5.0,
              k ? "EPSG:32633" : "EPSG:32633+5703");
    }
    const auto result =
        dem::import_dem({.dems = {folder / "west.tif", folder / "east.tif"}, .level_m = 10.0}, {});
    EXPECT_NEAR(only(result).area_m2, M_PI * 250 * 250, 0.005 * M_PI * 250 * 250);
    EXPECT_NE(result.report.notes.front().find("vertical datum"), std::string::npos);
}

TEST(Import, ForgottenVoidsAndMasksAreVoids) {
    const TempFolder folder;
    Grid<float> z = bowl(201, 5.0);
    z[Node(20, 30)] = -9999.0f;
    z[Node(25, 30)] = NAN;
    z[Node(120, 100)] = NAN; // in the lake
    write(folder / "holes.tif", z, 500'000, 5'300'000, 5.0);
    const auto holes = dem::import_dem({.dems = {folder / "holes.tif"}, .level_m = 10.0}, {});
    EXPECT_EQ(holes.report.void_nodes, 3u);
    EXPECT_NEAR(*only(holes).max_depth_m, 10.0, 0.05);
    EXPECT_LT(holes.ground.scale_m, 0.01); // the codes do not reach down to -9999 m
    // A mask over the south-western quarter.
    write(folder / "masked.tif", bowl(201, 5.0), 500'000, 5'300'000, 5.0);
    {
        dem::register_drivers();
        dem::Dataset ds(
            GDALDataset::Open((folder / "masked.tif").c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
        CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES");
        ASSERT_EQ(ds->CreateMaskBand(GMF_PER_DATASET), CE_None);
        std::vector<unsigned char> mask(201 * 201, 255);
        for (int r = 101; r < 201; ++r)
            std::fill_n(mask.begin() + r * 201, 100, 0);
        ASSERT_EQ(ds->GetRasterBand(1)->GetMaskBand()->RasterIO(
                      GF_Write, 0, 0, 201, 201, mask.data(), 201, 201, GDT_Byte, 0, 0),
                  CE_None);
    }
    const auto masked = dem::import_dem({.dems = {folder / "masked.tif"}, .level_m = 10.0}, {});
    EXPECT_EQ(masked.report.outside_nodes, 100u * 100u);
    EXPECT_NEAR(only(masked).area_m2, 0.75 * M_PI * 250 * 250, 0.01 * M_PI * 250 * 250);
    EXPECT_TRUE(only(masked).open_at_edge);
}

TEST(Import, AVoidLakeHasNoDepthAndABathymetryCountsFromTheSurfaceItWasMadeOn) {
    const TempFolder folder;
    // A bowl whose lake at 10 m is void, as laser surveys leave it.
    Grid<float> z = bowl(301, 5.0), flat = z, depth(z.size, NAN);
    for (std::size_t i = 0; i < z.values.size(); ++i)
        if (z.values[i] <= 10.0f) {
            depth.values[i] = 10.0f - z.values[i];
            z.values[i] = NAN;
            flat.values[i] = 10.0f;
        }
    write(folder / "void.tif", z, 500'000, 5'300'000, 5.0);
    const auto hollow = dem::import_dem({.dems = {folder / "void.tif"}, .level_m = 11.0}, {});
    EXPECT_EQ(only(hollow).bed, Bed::unknown);
    EXPECT_FALSE(only(hollow).max_depth_m.has_value());
    // The surface at 10 m, depths surveyed from it, and a level of 15 m: flooded land keeps its
    // heights.
    write(folder / "flat.tif", flat, 500'000, 5'300'000, 5.0);
    write(folder / "depth.tif", depth, 500'000, 5'300'000, 5.0);
    const auto raised = dem::import_dem(
        {.dems = {folder / "flat.tif"}, .level_m = 15.0, .bathymetry = folder / "depth.tif"}, {});
    const double radius_squared =
        15.0 / 40.0 * 500.0 * 500.0; // volume of a paraboloid: pi r^2 h / 2
    EXPECT_NEAR(*only(raised).volume_m3, M_PI * radius_squared * 15.0 / 2,
                0.005 * M_PI * radius_squared * 7.5);
    EXPECT_EQ(only(raised).bed, Bed::measured);
}

TEST(Import, ALevelAboveAllGroundKeepsTheShoreRuleAtVoids) {
    const TempFolder folder;
    Grid<float> z = bowl(101, 10.0);
    for (int r = 0; r < 20; ++r)
        for (int c = 0; c < 20 - r; ++c)
            z[{c, r}] = NAN;
    write(folder / "corner.tif", z, 500'000, 5'300'000, 10.0);
    const auto result = dem::import_dem({.dems = {folder / "corner.tif"}, .level_m = 500.0}, {});
    const auto& ground = result.ground;
    const auto& water = result.water;
    int wet = 0, margin = 0;
    for (int r = 0; r < 101; ++r)
        for (int c = 0; c < 101; ++c) {
            const Node n{c, r};
            const bool outside = r < 20 && c < 20 - r;
            if (outside) {
                margin += water.codes[n] != no_water_code;
                EXPECT_TRUE(water.codes[n] == no_water_code || ground.elevation_m(n) > 500.0);
            } else {
                ++wet;
                EXPECT_LT(ground.elevation_m(n), water.elevation_m(n));
            }
        }
    EXPECT_GT(margin, 10);
    EXPECT_NEAR(only(result).area_m2, wet * 100.0, 1e-6);
}

TEST(Import, SixteenBitPicturesKeepTheirAlpha) {
    const TempFolder folder;
    write(folder / "bowl.tif", bowl(101, 10.0), 500'000, 5'300'000, 10.0);
    {
        dem::register_drivers();
        dem::Dataset ds(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
            (folder / "photo.tif").c_str(), 50, 50, 4, GDT_UInt16, nullptr));
        double g[6] = {500'200, 10, 0, 5'299'800, 0, -10};
        ds->SetGeoTransform(g);
        OGRSpatialReference srs;
        srs.SetFromUserInput("EPSG:32633");
        ds->SetSpatialRef(&srs);
        for (int b = 1; b <= 4; ++b) {
            std::vector<std::uint16_t> v(2500);
            for (std::size_t i = 0; i < v.size(); ++i)
                v[i] = b == 4 ? 65535 : std::uint16_t(i * 20);
            ds->GetRasterBand(b)->SetColorInterpretation(
                b == 4 ? GCI_AlphaBand : GDALColorInterp(GCI_RedBand + b - 1));
            ASSERT_EQ(ds->GetRasterBand(b)->RasterIO(GF_Write, 0, 0, 50, 50, v.data(), 50, 50,
                                                     GDT_UInt16, 0, 0),
                      CE_None);
        }
    }
    const auto result = dem::import_dem(
        {.dems = {folder / "bowl.tif"}, .level_m = 10.0, .ortho = folder / "photo.tif"}, {});
    ASSERT_TRUE(result.ortho.has_value());
    const auto& p = result.ortho->picture;
    std::size_t opaque = 0;
    int brightest = 0;
    for (std::size_t i = 0; i < p.bytes.size(); i += 4) {
        opaque += p.bytes[i + 3] == 255;
        brightest = std::max<int>(brightest, p.bytes[i]);
    }
    EXPECT_GT(opaque, p.bytes.size() / 4 * 9 / 10);
    EXPECT_GT(brightest, 240);
    EXPECT_NEAR(result.frame.origin_easting_m + result.ortho->west_m, 500'200.0, 1e-6);
}

namespace {

/// A picture over the middle of bowl(101, 10): `bands` of `type`, filled by set(band, col, row).
template <class Set>
void write_picture(const std::filesystem::path& path, int bands, GDALDataType type, Set set,
                   std::optional<double> nodata = {}, GDALColorTable* palette = nullptr) {
    dem::register_drivers();
    CPLStringList options;
    dem::Dataset ds(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        path.c_str(), 60, 40, bands, type, options.List()));
    double g[6] = {500'200, 10, 0, 5'299'800, 0, -10};
    ds->SetGeoTransform(g);
    OGRSpatialReference srs;
    srs.SetFromUserInput("EPSG:32633");
    ds->SetSpatialRef(&srs);
    for (int b = 1; b <= bands; ++b) {
        GDALRasterBand& band = *ds->GetRasterBand(b);
        if (palette)
            band.SetColorTable(palette);
        if (nodata)
            band.SetNoDataValue(*nodata);
        std::vector<double> line(60);
        for (int r = 0; r < 40; ++r) {
            for (int c = 0; c < 60; ++c)
                line[std::size_t(c)] = set(b, c, r);
            ASSERT_EQ(band.RasterIO(GF_Write, 0, r, 60, 1, line.data(), 60, 1, GDT_Float64, 0, 0),
                      CE_None);
        }
    }
}

/// RGBA that the drape shows at a place of the picture's own grid.
std::array<int, 4> draped(const Ortho& ortho, const geo::Frame& frame, double col, double row) {
    const double x = 500'200 + 10 * (col + 0.5) - frame.origin_easting_m;
    const double y = 5'299'800 - 10 * (row + 0.5) - frame.origin_northing_m;
    const int c = int((x - ortho.west_m) / ortho.spacing_m),
              r = int((ortho.north_m - y) / ortho.spacing_m);
    std::array<int, 4> out{};
    for (std::size_t k = 0; k < 4; ++k)
        out[k] =
            ortho.picture
                .bytes[(std::size_t(r) * std::size_t(ortho.picture.width_px) + std::size_t(c)) * 4 +
                       k];
    return out;
}

} // namespace

TEST(Import, PicturesOfAnyKindFallBackWhereTheyHaveNothing) {
    const TempFolder folder;
    write(folder / "bowl.tif", bowl(101, 10.0), 500'000, 5'300'000, 10.0);
    const auto drape = [&](const std::string& name) {
        return dem::import_dem(
            {.dems = {folder / "bowl.tif"}, .level_m = 10.0, .ortho = folder / name}, {});
    };
    // 8 bits, nodata 255 in the left half.
    write_picture(
        folder / "byte.tif", 3, GDT_Byte,
        [](int b, int c, int) { return c < 30 ? 255.0 : 40.0 * b; }, 255.0);
    auto result = drape("byte.tif");
    EXPECT_EQ(draped(*result.ortho, result.frame, 10, 20)[3], 0);
    EXPECT_EQ(draped(*result.ortho, result.frame, 50, 20), (std::array{40, 80, 120, 255}));
    // 16 bits, nodata 0 in the left half, values up to 4000: stretched by what is there.
    write_picture(
        folder / "deep.tif", 3, GDT_UInt16,
        [](int b, int c, int r) { return c < 30 ? 0.0 : 1000.0 * b + 25.0 * r; }, 0.0);
    result = drape("deep.tif");
    EXPECT_EQ(draped(*result.ortho, result.frame, 10, 20)[3], 0);
    const auto low = draped(*result.ortho, result.frame, 50, 2),
               high = draped(*result.ortho, result.frame, 50, 37);
    EXPECT_EQ(low[3], 255);
    EXPECT_GT(high[0], low[0] + 30);
    EXPECT_GT(high[2], high[0]); // one stretch for all bands: a blue picture stays blue
    // A palette with a transparent entry.
    GDALColorTable palette;
    const GDALColorEntry red{200, 10, 20, 255}, none{0, 0, 0, 0};
    palette.SetColorEntry(0, &none);
    palette.SetColorEntry(1, &red);
    write_picture(
        folder / "palette.tif", 1, GDT_Byte, [](int, int c, int) { return c < 30 ? 0.0 : 1.0; },
        0.0, &palette);
    result = drape("palette.tif");
    EXPECT_EQ(draped(*result.ortho, result.frame, 10, 20)[3], 0);
    EXPECT_EQ(draped(*result.ortho, result.frame, 50, 20), (std::array{200, 10, 20, 255}));
    // Grey with nodata.
    write_picture(
        folder / "grey.tif", 1, GDT_Byte, [](int, int c, int) { return c < 30 ? 7.0 : 99.0; }, 7.0);
    result = drape("grey.tif");
    EXPECT_EQ(draped(*result.ortho, result.frame, 10, 20)[3], 0);
    EXPECT_EQ(draped(*result.ortho, result.frame, 50, 20), (std::array{99, 99, 99, 255}));
    // The picture covers 600 x 400 m of 1010 x 1010: the rest has none.
    EXPECT_LT(result.ortho->picture.width_px * result.ortho->spacing_m, 620.0);
}

TEST(Samples, TheCalderaMeetsThePublishedFiguresWithinOnePercent) {
    const TempFolder folder;
    const auto c = samples::make_caldera(25.0);
    const double t[6] = {c.west_m, 25, 0, c.north_m, 0, -25};
    dem::write_elevations(folder / "caldera.tif", c.elevation_m, "EPSG:32610", t, "");
    const auto result = dem::import_dem({.dems = {folder / "caldera.tif"}, .level_m = 1883.0}, {});
    const LakeRecord& lake = only(result);
    EXPECT_NEAR(lake.area_m2, 53.0e6, 0.01 * 53.0e6);
    EXPECT_NEAR(*lake.volume_m3, 18.7e9, 0.01 * 18.7e9);
    EXPECT_NEAR(*lake.max_depth_m, 594.0, 5.94);
    EXPECT_EQ(lake.islands, 1);
    EXPECT_EQ(lake.bed, Bed::measured);
    EXPECT_LT(geo::geodesic_distance_m(lake.position, {42.9446, -122.1090}), 3000.0);
    // Wizard Island: summit height, and its area from the hole in the lake.
    EXPECT_NEAR(result.ground.max_elevation_m(), 2721.0, 27.0); // Mount Scott
    double island = 0.0, summit = 0.0;
    const geo::Frame& frame = result.frame;
    const ScenePoint wizard = geo::to_scene(frame, {42.9380, -122.1460});
    for (double x = -1500; x <= 1500; x += 25)
        for (double y = -1500; y <= 1500; y += 25) {
            const double z = result.ground.elevation_m(wizard.x_m + x, wizard.y_m + y);
            if (z > 1883.0 && std::hypot(x, y) < 1100) {
                island += 625;
                summit = std::max(summit, z);
            }
        }
    EXPECT_NEAR(summit, 2113.0, 21.0);
    EXPECT_NEAR(island, 1.28e6, 0.15e6);
}

// --- real data
// ------------------------------------------------------------------------------------

TEST(RealData, RotomaHasItsAreaVolumeAndDepth) {
    TARN_NEEDS_DATA("rotoma/rotoma_topobathy_32m.tif");
    const auto result =
        dem::import_dem({.dems = {data("rotoma/rotoma_topobathy_32m.tif")}, .level_m = 313.31}, {});
    EXPECT_EQ(result.report.resampling, "none");
    EXPECT_NEAR(only(result).area_m2, 11.140e6, 0.001 * 11.140e6);
    EXPECT_NEAR(*only(result).volume_m3, 0.4361e9, 0.001 * 0.4361e9);
    EXPECT_NEAR(*only(result).max_depth_m, 80.5, 0.0805);
    EXPECT_FALSE(only(result).open_at_edge);
    EXPECT_EQ(result.frame.vertical_datum, "NZVD2016 height");
}

TEST(RealData, PleasantLakeMeetsItsPublishedStageTable) {
    TARN_NEEDS_DATA("pleasant_wi/pleasant_topobathy.tif");
    struct Row {
        double level, area, volume;
    };
    for (const Row row :
         {Row{299.0544, 552'830.5, 2'737'258.0}, Row{295.5622392, 365'964.3758, 1'138'486.99},
          Row{299.9232, 579'137.5712, 3'229'245.23}}) {
        const auto result = dem::import_dem(
            {.dems = {data("pleasant_wi/pleasant_topobathy.tif")}, .level_m = row.level}, {});
        EXPECT_EQ(result.report.resampling, "none");
        EXPECT_NEAR(only(result).area_m2 / row.area, 1.0, 1e-3) << row.level;
        EXPECT_NEAR(*only(result).volume_m3 / row.volume, 1.0, 1e-3) << row.level;
    }
}

TEST(RealData, CraterLakeFromTwoTilesOutOfPhase) {
    TARN_NEEDS_DATA("crater_lake/ned_n43w123.tif");
    const std::vector<std::filesystem::path> tiles = {data("crater_lake/ned_n43w124.tif"),
                                                      data("crater_lake/ned_n43w123.tif")};
    const auto given = dem::import_dem({.dems = tiles, .level_m = 1882.01}, {});
    EXPECT_NEAR(only(given).area_m2, 53.3e6, 0.005 * 53.3e6);
    EXPECT_EQ(only(given).bed, Bed::unknown);
    EXPECT_FALSE(only(given).volume_m3.has_value());
    const auto found = dem::import_dem({.dems = tiles}, {});
    EXPECT_NEAR(only(found).level_m, 1882.01, 0.005);
    EXPECT_NEAR(only(found).area_m2, 53.3e6, 0.005 * 53.3e6);
}

TEST(RealData, LakesAreFoundAtTheirSeedsWithTheirLevels) {
    struct Lake {
        std::vector<const char*> files;
        GeoPoint at;
        double level, area_km2, tolerance;
    };
    // Areas as computed from the files (data/README.md); SRTM shores differ by connection rules.
    const std::vector<Lake> lakes = {
        {{"sainte_croix/N43E006.hgt", "sainte_croix/N43E007.hgt.zip"},
         {43.766, 6.184},
         470,
         18.8,
         0.02},
        {{"sainte_croix/N43E006.hgt"}, {43.907, 6.532}, 867, 3.26, 0.03},
        {{"fuji_five_lakes/fuji_srtm_90m.tif"}, {35.419, 138.874}, 984, 6.61, 0.02},
        {{"fuji_five_lakes/fuji_srtm_90m.tif"}, {35.513, 138.748}, 829, 5.23, 0.03},
        {{"fuji_five_lakes/fuji_srtm_90m.tif"}, {35.464, 138.585}, 896, 4.48, 0.03},
        {{"fuji_five_lakes/fuji_srtm_90m.tif"}, {35.499, 138.685}, 899, 2.02, 0.03},
        {{"thirlmere/thirlmere_eudem.tif"}, {54.5470, -3.0706}, 179.65, 3.29, 0.01},
        {{"ozarks/ozarks_srtm_30m.tif"}, {38.2068, -92.7595}, 202, 133.5, 0.01},
        {{"rotoma/rotoma_dem_32m.tif"},
         {-38.0454, 176.5858},
         313.30,
         10.50,
         0.01}, // 10252 nodes at 313.30
    };
    for (const Lake& lake : lakes) {
        dem::ImportOptions options{.at = lake.at};
        for (const char* file : lake.files) {
            TARN_NEEDS_DATA(file);
            options.dems.push_back(data(file));
        }
        const auto result = dem::import_dem(options, {});
        EXPECT_NEAR(only(result).level_m, lake.level, 0.01) << lake.files[0];
        EXPECT_NEAR(only(result).area_m2 / 1e6 / lake.area_km2, 1.0, lake.tolerance)
            << lake.files[0] << " " << lake.level;
        EXPECT_EQ(only(result).bed, Bed::unknown) << lake.files[0];
    }
}

TEST(RealData, ALevelTypedFromItsRoundedFigureAndFoundInATopobathyIsTheLake) {
    TARN_NEEDS_DATA("thirlmere/thirlmere_eudem.tif");
    TARN_NEEDS_DATA("rotoma/rotoma_topobathy_32m.tif");
    // The file holds 179.6513 m; people read, and type, 179.65.
    const auto typed =
        dem::import_dem({.dems = {data("thirlmere/thirlmere_eudem.tif")}, .level_m = 179.65}, {});
    EXPECT_NEAR(only(typed).area_m2, 3.29e6, 0.03e6);
    const auto found = dem::import_dem({.dems = {data("thirlmere/thirlmere_eudem.tif")}}, {});
    EXPECT_NEAR(only(found).area_m2, 3.29e6, 0.03e6);
    // A few flat nodes by the shore give the level; the bed below them is the lake's.
    const auto bed = dem::import_dem(
        {.dems = {data("rotoma/rotoma_topobathy_32m.tif")}, .at = GeoPoint{-38.05, 176.58}}, {});
    EXPECT_NEAR(only(bed).area_m2, 11.14e6, 0.02e6);
    EXPECT_EQ(only(bed).bed, Bed::measured);
}

TEST(RealData, AZipWithoutCrsIsRefusedAndTakenWithOne) {
    TARN_NEEDS_DATA("osgb_asc/osgb_dsm_2m_tiles.zip");
    dem::ImportOptions options{.dems = {data("osgb_asc/osgb_dsm_2m_tiles.zip")}, .level_m = 55.0};
    try {
        dem::import_dem(options, {});
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("so2316_dsm_2m.asc: no CRS; give one with --crs"),
                  std::string::npos)
            << error.what();
    }
    options.crs = "EPSG:27700";
    options.at = GeoPoint{51.8383, -3.1120}; // in tile so2316, beside the Usk
    options.radius_km = 0.4;
    options.level_m = 70.0;
    const auto result = dem::import_dem(options, {});
    EXPECT_EQ(result.report.resampling, "none");
    EXPECT_DOUBLE_EQ(result.ground.spacing_m, 2.0);
}
