// Tiles from a server on this machine that speaks HTTP with ranges: what is asked for, what is
// kept, and what a server that fails, hangs or lacks tiles comes to.
#include "core/error.hpp"
#include "dem/import.hpp"
#include "dem/remote.hpp"
#include "dem/write.hpp"
#include "scene_files/source_list.hpp"
#include "support/files.hpp"
#include "support/http_server.hpp"

#include <cmath>
#include <cstdlib>
#include <gdal_utils.h>
#include <gtest/gtest.h>

using namespace tarn;
using test_support::HttpServer;
using test_support::TempFolder;

namespace {

constexpr double step = 1.0 / 1200.0; // 3" tiles with a shared column, cloud-optimised

/// A lake of some kilometres around 46.0 N 9.0 E, where four tiles meet.
float height(double lat, double lon) {
    const double x = (lon - 9.0) * 78.0, y = (lat - 46.0) * 111.0, r = std::hypot(x, y); // km
    return r < 3.0 ? 200.0f
                   : float(200.0 + (40.0 + 15.0 * std::sin(9 * x) * std::sin(7 * y)) * (r - 3.0));
}

void make_tile(const std::filesystem::path& root, int lat, int lon, const std::string& name) {
    Grid<float> z({1201, 1201});
    for (int r = 0; r < 1201; ++r)
        for (int c = 0; c < 1201; ++c)
            z[{c, r}] = height(lat + 1 - r * step, lon + c * step);
    const auto plain = root / (name + ".plain.tif");
    const double t[6] = {lon - step / 2, step, 0, lat + 1 + step / 2, 0, -step};
    dem::write_elevations(plain, z, "EPSG:4326", t, "");
    dem::Dataset in(GDALDataset::Open(plain.c_str(), GDAL_OF_RASTER));
    dem::Arguments words{"-of", "COG", "-co", "BLOCKSIZE=128", "-co", "COMPRESS=DEFLATE"};
    GDALTranslateOptions* options = GDALTranslateOptionsNew(words.get(), nullptr);
    dem::Dataset out(GDALDataset::FromHandle(
        GDALTranslate((root / name).c_str(), GDALDataset::ToHandle(in.get()), options, nullptr)));
    GDALTranslateOptionsFree(options);
    ASSERT_TRUE(out);
    std::filesystem::remove(plain);
}

/// Four tiles on a server, one of them left out if asked.
struct Place {
    explicit Place(bool all = true) : server(root.path()) {
        ::setenv("no_proxy", "127.0.0.1", 1);
        dem::register_drivers();
        make_tile(root.path(), 46, 9, "N46E009.tif");
        make_tile(root.path(), 46, 8, "N46E008.tif");
        make_tile(root.path(), 45, 9, "N45E009.tif");
        if (all)
            make_tile(root.path(), 45, 8, "N45E008.tif");
        source.name = "here";
        source.url = server.url() + "/{NS}{lat}{EW}{lon}.tif";
        source.about = "a test";
        options.cache = cache.path();
        options.timeout_s = 5.0;
    }
    std::string says(const dem::Bounds& bounds) {
        try {
            dem::fetch_tiles(source, bounds, options, Progress{});
            return "no error";
        } catch (const Error& error) {
            return error.what();
        }
    }
    TempFolder root, cache;
    HttpServer server;
    RemoteSource source;
    dem::FetchOptions options;
};

const dem::Bounds around_lake{8.93, 45.95, 9.07, 46.05};

} // namespace

TEST(Remote, UrlsFollowTheDocumentedLayouts) {
    const auto& known = dem::known_sources();
    ASSERT_EQ(known.at(0).name, "copernicus");
    EXPECT_EQ(dem::tile_url(known[0], 43, 6), "https://copernicus-dem-30m.s3.amazonaws.com/"
                                              "Copernicus_DSM_COG_10_N43_00_E006_00_DEM/"
                                              "Copernicus_DSM_COG_10_N43_00_E006_00_DEM.tif");
    EXPECT_NE(dem::tile_url(known[0], -39, -177).find("_S39_00_W177_00_DEM.tif"),
              std::string::npos);
    // USGS names a tile by its north-western corner: n43w123 holds Crater Lake, 42..43 N.
    EXPECT_EQ(dem::tile_url(known.at(1), 42, -123),
              "https://prd-tnm.s3.amazonaws.com/StagedProducts/Elevation/13/TIFF/current/n43w123/"
              "USGS_13_n43w123.tif");
    EXPECT_THROW(dem::tile_url({.name = "x", .url = "http://h/{zoom}.tif"}, 1, 1), Error);
}

TEST(Remote, SourcesOfOnesOwnComeFromAFile) {
    const TempFolder folder;
    const auto file = folder / "sources.json";
    const auto read = [&](const std::string& content) -> std::string {
        std::ofstream(file) << content;
        try {
            const auto sources = scene_files::read_sources(file);
            return sources.size() == 1 ? dem::tile_url(sources[0], -39, 176) : "not one";
        } catch (const Error& error) {
            return error.what();
        }
    };
    EXPECT_EQ(read(R"({"sources": [{"name": "mine", "url": "https://h/{ns}{lat}{ew}{lon}.tif",
                                    "named_by_north": true, "missing_status": [403]}]})"),
              "https://h/s38e176.tif");
    EXPECT_NE(
        read(R"({"sources": [{"name": "mine", "url": "ftp://h/{lat}{lon}"}]})").find("http://"),
        std::string::npos);
    EXPECT_NE(read(R"({"sources": [{"name": "mine", "url": "http://h/a.tif"}]})").find("no {lat}"),
              std::string::npos);
    EXPECT_NE(read(R"({"sources": [{"name": "../up", "url": "http://h/{lat}{lon}"}]})")
                  .find("no plain word"),
              std::string::npos);
    EXPECT_NE(read(R"({"sources": [{"name": "m", "url": "http://h/{lat}{lon}", "tiledeg": 2}]})")
                  .find("'tiledeg', which is no field"),
              std::string::npos);
    EXPECT_NE(read("{").find("sources.json"), std::string::npos);
}

TEST(Remote, FetchesTheBlocksOfTheRegionAndKeepsThem) {
    Place place;
    const auto first = dem::fetch_tiles(place.source, around_lake, place.options, Progress{});
    EXPECT_EQ(first.tiles.size(), 4u);
    EXPECT_GT(first.blocks_fetched, 0u);
    EXPECT_EQ(first.blocks_cached, 0u);
    // .14 x .10 degrees of four: 168 x 120 pixels, in blocks of 128, are a few blocks a tile.
    std::size_t whole = 0;
    for (const auto& entry : std::filesystem::directory_iterator(place.root.path()))
        whole += entry.file_size();
    EXPECT_LT(place.server.bytes_sent(), whole / 4);
    const auto requests = place.server.requests();
    EXPECT_LE(requests.size(), 4u * 5u); // asked, header, one or two ranges
    for (const auto& request : requests)
        EXPECT_TRUE(request.method == "HEAD" || request.from >= 0) << request.path;

    place.server.clear();
    const auto again = dem::fetch_tiles(place.source, around_lake, place.options, Progress{});
    EXPECT_EQ(place.server.requests().size(), 0u); // the second time nothing is asked
    EXPECT_EQ(again.blocks_fetched, 0u);
    EXPECT_EQ(again.blocks_cached, first.blocks_fetched);

    const auto wider = dem::fetch_tiles(place.source, {8.8, 45.95, 9.07, 46.05}, place.options,
                                        Progress{}); // westward: only what is new
    EXPECT_GT(wider.blocks_fetched, 0u);
    EXPECT_EQ(wider.blocks_cached, first.blocks_fetched);
}

TEST(Remote, AnImportOfFetchedTilesIsThatOfTheFilesThemselves) {
    Place place;
    dem::ImportOptions options{.remote = place.source,
                               .fetch = place.options,
                               .at = GeoPoint{46.0, 9.0},
                               .radius_km = 5.0};
    const auto fetched = dem::import_dem(options, {});
    dem::ImportOptions local{.at = options.at, .radius_km = options.radius_km};
    for (const char* name : {"N45E008.tif", "N45E009.tif", "N46E008.tif", "N46E009.tif"})
        local.dems.push_back(place.root.path() / name);
    const auto files = dem::import_dem(local, {});
    EXPECT_EQ(fetched.ground.codes.values, files.ground.codes.values);
    EXPECT_EQ(fetched.water.codes.values, files.water.codes.values);
    const double degrees = 77.47 / 78.0 * 111.15 / 111.0; // the formula's against the ellipsoid's
    EXPECT_NEAR(fetched.lakes[0].true_area_m2, M_PI * 9e6 * degrees, 0.005 * M_PI * 9e6);
    EXPECT_NE(fetched.report.notes.front().find("blocks fetched"), std::string::npos);
}

TEST(Remote, MissingTilesAreSaidAndNoneAtAllIsAnError) {
    Place place(false);
    const auto fetched = dem::fetch_tiles(place.source, around_lake, place.options, Progress{});
    EXPECT_EQ(fetched.tiles.size(), 3u);
    ASSERT_EQ(fetched.notes.size(), 2u);
    EXPECT_NE(fetched.notes[1].find("1 of 4 tiles do not exist"), std::string::npos);
    EXPECT_NE(place.says({20.1, 10.1, 20.2, 10.2}).find("has no tile there (asked for "),
              std::string::npos);
    EXPECT_NE(place.says({-170, 0, 170, 60}).find("choose a smaller --radius"), std::string::npos);
}

TEST(Remote, AServerThatFailsOrHangsGivesOneLineAndKeepsTheCache) {
    Place place;
    place.server.set_status(500);
    std::string said = place.says(around_lake);
    EXPECT_NE(said.find("no answer that can be used"), std::string::npos) << said;
    EXPECT_NE(said.find("500"), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos);
    place.server.set_status(0);
    place.server.set_delay(std::chrono::seconds(30));
    place.options.timeout_s = 1.0;
    const auto begin = std::chrono::steady_clock::now();
    said = place.says(around_lake);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(15));
    EXPECT_NE(said.find("raise --timeout"), std::string::npos) << said;
    place.server.set_delay(std::chrono::milliseconds(0));
    // Cut in the middle of a body: an error, no half tile, and the next try is whole.
    place.server.set_cut(true);
    EXPECT_NE(place.says(around_lake), "no error");
    place.server.set_cut(false);
    const auto whole = dem::fetch_tiles(place.source, around_lake, place.options, Progress{});
    EXPECT_EQ(whole.tiles.size(), 4u);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(place.cache.path()))
        EXPECT_EQ(entry.path().string().find(".partial"), std::string::npos) << entry.path();
    // What is in the cache needs no server.
    place.server.set_status(503);
    EXPECT_EQ(place.says(around_lake), "no error");
    // A damaged copy is fetched anew.
    place.server.set_status(0);
    int broken = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(place.cache.path()))
        if (entry.path().filename() == "N46E009.tif") {
            std::ofstream(entry.path()) << "not a tiff";
            ++broken;
        }
    EXPECT_EQ(broken, 1);
    EXPECT_EQ(place.says(around_lake), "no error");
}

TEST(Remote, TilesOfOneNameInManyFoldersAndStripsStayApart) {
    Place place;
    // {lat} as a folder; strips instead of blocks.
    for (const char* lat : {"N45", "N46"}) {
        std::filesystem::create_directory(place.root / lat);
        dem::Dataset in(GDALDataset::Open((place.root / (std::string(lat) + "E009.tif")).c_str(),
                                          GDAL_OF_RASTER));
        dem::Arguments words{"-of", "GTiff", "-co", "BLOCKYSIZE=50"};
        GDALTranslateOptions* options = GDALTranslateOptionsNew(words.get(), nullptr);
        dem::Dataset out(GDALDataset::FromHandle(
            GDALTranslate((place.root / lat / "E009.tif").c_str(), GDALDataset::ToHandle(in.get()),
                          options, nullptr)));
        GDALTranslateOptionsFree(options);
        ASSERT_TRUE(out);
    }
    place.source.url = place.server.url() + "/{NS}{lat}/{EW}{lon}.tif";
    const auto first =
        dem::fetch_tiles(place.source, {9.01, 45.95, 9.05, 46.05}, place.options, Progress{});
    ASSERT_EQ(first.tiles.size(), 2u);
    EXPECT_NE(first.tiles[0], first.tiles[1]);
    // Wider: what was kept and what is new together hold every height.
    const auto wider =
        dem::fetch_tiles(place.source, {9.01, 45.8, 9.05, 46.2}, place.options, Progress{});
    EXPECT_GT(wider.blocks_cached, 0u);
    for (const auto& [path, lat] : {std::pair{wider.tiles[0], 45}, std::pair{wider.tiles[1], 46}}) {
        dem::Dataset ds(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER));
        for (int r = 0; r < 1201; ++r) {
            const double at = lat + 1 - r * step;
            if (at < 45.8 || at > 46.2)
                continue;
            float z = 0;
            ASSERT_EQ(
                ds->GetRasterBand(1)->RasterIO(GF_Read, 40, r, 1, 1, &z, 1, 1, GDT_Float32, 0, 0),
                CE_None);
            ASSERT_FLOAT_EQ(z, height(at, 9 + 40 * step)) << at;
        }
    }
}

TEST(Remote, NothingIsAskedUnlessASourceIsNamed) {
    dem::ImportOptions options{.remote = RemoteSource{.name = "x", .url = "http://127.0.0.1:1/a"}};
    EXPECT_THROW(options.validate(), Error); // no place given
    const TempFolder folder;
    Grid<float> z({50, 50}, 10.0f);
    const double t[6] = {500'000, 10, 0, 5'300'000, 0, -10};
    dem::write_elevations(folder / "flat.tif", z, "EPSG:32633", t, "");
    // A proxy that nobody answers at: any request would fail the import.
    ::setenv("http_proxy", "http://127.0.0.1:1", 1);
    ::setenv("https_proxy", "http://127.0.0.1:1", 1);
    EXPECT_NO_THROW(dem::import_dem({.dems = {folder / "flat.tif"}}, {}));
    ::unsetenv("http_proxy");
    ::unsetenv("https_proxy");
}
