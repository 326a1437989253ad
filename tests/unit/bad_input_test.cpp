// Input that is wrong, damaged or odd: each is refused with one clear line, or taken with what was
// assumed on record. scripts/data-report writes the list into docs/bad-inputs.md.
#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/import.hpp"
#include "dem/write.hpp"
#include "support/files.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <limits>

using namespace tarn;
using test_support::TempFolder;

namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

struct Kind {
    int cols = 61, rows = 61, bands = 1;
    GDALDataType type = GDT_Float32;
    std::string crs = "EPSG:32633";
    std::vector<double> transform = {500'000, 10, 0, 5'300'000, 0, -10};
    std::optional<double> nodata;
    std::string unit;
    double scale = 1.0, offset = 0.0;
    bool georeferenced = true;
    GDALColorInterp colour = GCI_Undefined;
};

/// z(col, row) of a bowl with a lake: 40 m deep in the middle of 61 x 61 nodes.
double bowl(int c, int r) { return 0.05 * (std::pow(c - 30, 2) + std::pow(r - 30, 2)); }

/// Writes a GeoTIFF of any kind, well-formed or not.
void make(const std::filesystem::path& path, const Kind& kind,
          const std::function<double(int, int)>& z = bowl) {
    dem::register_drivers();
    dem::Dataset ds(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        path.c_str(), kind.cols, kind.rows, kind.bands, kind.type, nullptr));
    ASSERT_TRUE(ds);
    if (kind.georeferenced) {
        auto t = kind.transform;
        ds->SetGeoTransform(t.data());
    }
    if (!kind.crs.empty()) {
        OGRSpatialReference srs;
        ASSERT_EQ(srs.SetFromUserInput(kind.crs.c_str()), OGRERR_NONE) << kind.crs;
        ds->SetSpatialRef(&srs);
    }
    for (int b = 1; b <= kind.bands; ++b) {
        GDALRasterBand& band = *ds->GetRasterBand(b);
        if (kind.nodata)
            band.SetNoDataValue(*kind.nodata);
        if (!kind.unit.empty())
            band.SetUnitType(kind.unit.c_str());
        if (kind.scale != 1.0 || kind.offset != 0.0) {
            band.SetScale(kind.scale);
            band.SetOffset(kind.offset);
        }
        if (kind.colour != GCI_Undefined)
            band.SetColorInterpretation(kind.colour);
        std::vector<double> line(std::size_t(kind.cols));
        for (int r = 0; r < kind.rows; ++r) {
            for (int c = 0; c < kind.cols; ++c)
                line[std::size_t(c)] = z(c, r);
            ASSERT_EQ(band.RasterIO(GF_Write, 0, r, kind.cols, 1, line.data(), kind.cols, 1,
                                    GDT_Float64, 0, 0),
                      CE_None);
        }
    }
}

void put(const std::filesystem::path& path, const std::string& content) {
    std::ofstream(path, std::ios::binary) << content;
}

std::string asc(const std::string& header, int values, const std::string& value = "5") {
    std::string out = header;
    for (int i = 0; i < values; ++i)
        out += value + (i % 10 == 9 ? "\n" : " ");
    return out;
}

const std::string asc_header = "ncols 10\nnrows 10\nxllcorner 500000\nyllcorner 5300000\n"
                               "cellsize 10\nNODATA_value -9999\n";

struct Report {
    std::string rows;
    int cases = 0;
    TempFolder folder;

    void add(const std::string& what, const std::string& said) {
        ++cases;
        rows += "| " + std::to_string(cases) + " | " + what + " | " + said + " |\n";
    }
    std::string clean(std::string words) const { // no paths of this machine in the docs
        for (std::size_t at; (at = words.find(folder.path().string() + "/")) != std::string::npos;)
            words.erase(at, folder.path().string().size() + 1);
        return words;
    }
    /// The import must fail with one line that holds `words`.
    void refused(const std::string& what, const dem::ImportOptions& options,
                 const std::string& words) {
        std::string said;
        try {
            dem::import_dem(options, {});
            said = "NO ERROR";
        } catch (const Error& error) {
            said = error.what();
        }
        EXPECT_NE(said.find(words), std::string::npos) << what << ": " << said;
        EXPECT_EQ(said.find('\n'), std::string::npos) << what << ": " << said;
        EXPECT_LT(said.size(), 420u) << what << ": " << said;
        add(what, clean(said));
    }
    /// The import must work and its report hold `words`.
    void taken(const std::string& what, const dem::ImportOptions& options, const std::string& words,
               double area_m2 = 0.0) {
        std::string notes;
        try {
            const auto result = dem::import_dem(options, {});
            for (const std::string& note : result.report.notes)
                notes += (notes.empty() ? "" : "; ") + note;
            if (area_m2 > 0.0)
                EXPECT_NEAR(result.lakes[0].area_m2 / area_m2, 1.0, 0.02) << what;
            for (const float z : result.heights_m.values)
                ASSERT_TRUE(std::isnan(z) || std::abs(z) < 12'000.0f) << what;
            EXPECT_NE(notes.find(words), std::string::npos) << what << ": " << notes;
            for (const std::string& note : result.report.notes)
                if (note.find(words) != std::string::npos) {
                    notes = note;
                    break;
                }
        } catch (const Error& error) {
            ADD_FAILURE() << what << ": " << error.what();
        }
        add(what, "taken: " + clean(words.empty() ? std::string("as it is") : notes));
    }
};

} // namespace

TEST(BadInput, EachGetsOneClearLineOrIsTakenOnRecord) {
    Report report;
    const auto at = [&](const std::string& name) { return report.folder / name; };
    const auto with = [&](const std::string& name, std::optional<double> level = 20.0) {
        return dem::ImportOptions{.dems = {at(name)}, .level_m = level};
    };
    const double lake = M_PI * 400 * 100.0; // bowl: 20 m = .05 r^2
    make(at("good.tif"), {});
    report.taken("(a good file)", with("good.tif"), "vertical unit not declared", lake);

    // --- files -------------------------------------------------------------------------------
    report.refused("no such file", with("none.tif"), "no such file");
    std::filesystem::create_directory(at("folder"));
    report.refused("a folder", with("folder"), "GDAL cannot read it");
    put(at("empty.tif"), "");
    report.refused("an empty file", with("empty.tif"), "GDAL cannot read it");
    put(at("text.tif"), "this is no raster");
    report.refused("text named .tif", with("text.tif"), "GDAL cannot read it");
    const std::string bytes = test_support::read_file(at("good.tif"));
    put(at("half.tif"), bytes.substr(0, bytes.size() / 2));
    report.refused("a GeoTIFF cut in half", with("half.tif"), "half.tif");
    put(at("head.tif"), bytes.substr(0, 10));
    report.refused("ten bytes of a GeoTIFF", with("head.tif"), "GDAL cannot read it");
    std::string lying = bytes;
    for (std::size_t i = 8; i + 12 < 200; ++i) // the TIFF tag ImageWidth (256): a lie of 2^30
        if (static_cast<unsigned char>(lying[i]) == 0 &&
            static_cast<unsigned char>(lying[i + 1]) == 1 && lying[i + 2] == 3 &&
            lying[i + 3] == 0) {
            lying[i + 2] = 4;
            lying[i + 8] = lying[i + 9] = lying[i + 10] = 0;
            lying[i + 11] = 0x40;
            break;
        }
    put(at("lying.tif"), lying);
    report.refused("a GeoTIFF whose header claims 2^30 columns", with("lying.tif"),
                   "nodes, more than 16384");
    put(at("gone.vrt"), "<VRTDataset rasterXSize=\"20\" rasterYSize=\"20\"><SRS>EPSG:32633</SRS>"
                        "<GeoTransform>500000,10,0,5300000,0,-10</GeoTransform>"
                        "<VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource>"
                        "<SourceFilename relativeToVRT=\"1\">gone.tif</SourceFilename>"
                        "<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>");
    report.refused("a VRT of a file that is gone", with("gone.vrt"), "cannot be read");
    put(at("self.vrt"), "<VRTDataset rasterXSize=\"20\" rasterYSize=\"20\"><SRS>EPSG:32633</SRS>"
                        "<GeoTransform>500000,10,0,5300000,0,-10</GeoTransform>"
                        "<VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource>"
                        "<SourceFilename relativeToVRT=\"1\">self.vrt</SourceFilename>"
                        "<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>");
    report.refused("a VRT of itself", with("self.vrt"), "read");
    put(at("huge.vrt"),
        "<VRTDataset rasterXSize=\"2000000000\" rasterYSize=\"2000000000\"><SRS>EPSG:32633</SRS>"
        "<GeoTransform>0,0.001,0,5300000,0,-0.001</GeoTransform>"
        "<VRTRasterBand dataType=\"Float32\" band=\"1\"/></VRTDataset>");
    report.refused("a VRT of 2 000 000 000 pixels a side", with("huge.vrt"), "more than 16384");
    put(at("N45E009.hgt"), std::string(1000, '\0'));
    report.refused("an .hgt of the wrong size", with("N45E009.hgt"), "GDAL cannot read it");
    put(at("lake.hgt"), std::string(2 * 1201 * 1201, '\0'));
    report.refused("an .hgt whose name is no place", with("lake.hgt"), "GDAL cannot read it");
    put(at("bad.zip"), "PK\x03\x04 this is no archive");
    report.refused("a damaged zip", with("bad.zip"), "holds no raster");

    // --- ESRI ASCII -----------------------------------------------------------------------------
    put(at("plain.asc"), asc(asc_header, 100));
    report.refused("an .asc without CRS", with("plain.asc"), "no CRS; give one with --crs");
    auto ascii = [&](const std::string& name) {
        auto o = with(name);
        o.crs = "EPSG:32633";
        return o;
    };
    put(at("short.asc"), asc(asc_header, 37));
    report.refused("an .asc with fewer values than its header says", ascii("short.asc"),
                   "short.asc");
    put(at("zero.asc"), asc("ncols 10\nnrows 10\nxllcorner 0\nyllcorner 0\ncellsize 0\n", 100));
    report.refused("an .asc with cells of no size", ascii("zero.asc"), "zero.asc");
    put(at("minus.asc"), asc("ncols -10\nnrows 10\nxllcorner 0\nyllcorner 0\ncellsize 1\n", 100));
    report.refused("an .asc with -10 columns", ascii("minus.asc"), "minus.asc");

    // --- georeference ---------------------------------------------------------------------------
    make(at("nogeo.tif"), {.georeferenced = false});
    report.refused("no geotransform", with("nogeo.tif"), "no georeference");
    make(at("nocrs.tif"), {.crs = ""});
    report.refused("no CRS", with("nocrs.tif"), "no CRS; give one with --crs");
    auto given = with("nocrs.tif");
    given.crs = "EPSG:32633";
    report.taken("no CRS, but --crs", given, "", lake);
    given.crs = "EPSG:nonsense";
    report.refused("--crs that is none", given, "--crs 'EPSG:nonsense' is not understood");
    given.crs = "EPSG:4326";
    report.refused("metres with --crs EPSG:4326", given, "look like metres");
    put(at("flat.vrt"), "<VRTDataset rasterXSize=\"20\" rasterYSize=\"20\"><SRS>EPSG:32633</SRS>"
                        "<GeoTransform>500000,0,0,5300000,0,-10</GeoTransform>"
                        "<VRTRasterBand dataType=\"Float32\" band=\"1\"/></VRTDataset>");
    report.refused("pixels of no width", with("flat.vrt"), "has no area");
    make(at("nan.tif"), {.transform = {std::nan(""), 10, 0, 5'300'000, 0, -10}});
    report.refused("a geotransform that is not finite", with("nan.tif"), "nan.tif");
    make(at("local.tif"), {.crs = "LOCAL_CS[\"a survey of one's own\",UNIT[\"metre\",1]]"});
    report.refused("a local CRS", with("local.tif"), "does not say where on Earth");
    make(at("xyz.tif"), {.crs = "EPSG:4978"});
    report.refused("a geocentric CRS", with("xyz.tif"), "does not say where on Earth");
    make(at("degrees.tif"), {.transform = {15.0, 0.0003, 0, 47.8, 0, -0.0003}});
    report.refused("degrees declared as UTM", with("degrees.tif"), "look like degrees");
    make(at("metres.tif"), {.crs = "EPSG:4326"});
    report.refused("UTM metres declared as degrees", with("metres.tif"), "look like metres");
    make(at("pole.tif"), {.crs = "EPSG:4326", .transform = {10, 0.1, 0, 95, 0, -0.1}});
    report.refused("latitudes beyond the pole", with("pole.tif"), "look like metres");
    make(at("space.tif"), {.transform = {9e8, 10, 0, 9e8, 0, -10}});
    report.refused("UTM coordinates of 900 000 km", with("space.tif"), "CRS");
    make(at("up.tif"), {.transform = {500'000, 10, 0, 5'299'390, 0, 10}});
    report.taken("south side up", with("up.tif"), "", lake);
    make(at("turned.tif"), {.transform = {500'000, 7.0711, 7.0711, 5'300'000, 7.0711, -7.0711}});
    report.taken("turned by 45 degrees", with("turned.tif"), "", lake);
    make(at("oblong.tif"), {.cols = 121, .transform = {500'000, 5, 0, 5'300'000, 0, -10}},
         [](int c, int r) { return 0.05 * (std::pow(c / 2.0 - 30, 2) + std::pow(r - 30, 2)); });
    report.taken("oblong pixels", with("oblong.tif"), "", lake);

    // --- size ------------------------------------------------------------------------------------
    make(at("one.tif"), {.cols = 1, .rows = 1});
    report.refused("1 x 1", with("one.tif"), "is no elevation grid");
    make(at("line.tif"), {.cols = 300, .rows = 1});
    report.refused("300 x 1", with("line.tif"), "is no elevation grid");
    make(at("two.tif"), {.cols = 2, .rows = 2}, [](int c, int r) { return 30.0 - 20.0 * (c & r); });
    report.taken("2 x 2", with("two.tif"), "runs out of the data");
    auto fine = with("good.tif");
    fine.spacing_m = 0.01;
    report.refused("--spacing .01 on 600 m", fine, "nodes, more than 16384");

    // --- values ----------------------------------------------------------------------------------
    make(at("allnan.tif"), {}, [](int, int) { return double(none); });
    report.refused("nothing but NaN", with("allnan.tif"), "no elevation data in this region");
    make(at("allvoid.tif"), {.type = GDT_Int16, .nodata = -32768.0},
         [](int, int) { return -32768.0; });
    report.refused("nothing but nodata", with("allvoid.tif"), "no elevation data in this region");
    const auto hole = [](double value) {
        return [value](int c, int r) { return c == 5 && r > 4 && r < 9 ? value : bowl(c, r); };
    };
    make(at("inf.tif"), {}, hole(std::numeric_limits<double>::infinity()));
    report.taken("infinite heights", with("inf.tif"), "taken as no data", lake);
    make(at("holes.tif"), {}, hole(double(none)));
    report.taken("NaN without nodata declared", with("holes.tif"), "taken as no data", lake);
    make(at("forgot.tif"), {}, hole(-9999.0));
    report.taken("-9999 that nobody declared", with("forgot.tif"), "taken as no data", lake);
    make(at("max.tif"), {}, hole(-3.4028234663852886e38));
    report.taken("-3.4e38 that nobody declared", with("max.tif"), "taken as no data", lake);
    make(at("wide.tif"), {.type = GDT_UInt16}, hole(65535.0));
    report.taken("65535 that nobody declared", with("wide.tif"), "");
    make(at("nines.tif"), {}, hole(9999.0));
    report.refused("9999 that nobody declared", with("nines.tif"), "above any place on Earth");
    make(at("feet.tif"), {}, [](int c, int r) { return 9000.0 + bowl(c, r) / 0.3048; });
    report.refused("feet that nobody declared", with("feet.tif", 2750.0), "give --unit ft");
    auto feet = with("feet.tif", 9000.0 * 0.3048 + 20.0);
    feet.unit = "ft";
    report.taken("the same with --unit ft", feet, "heights taken as ft (--unit)", lake);
    make(at("declared.tif"), {.unit = "ft"}, [](int c, int r) { return bowl(c, r) / 0.3048; });
    report.taken("feet that are declared", with("declared.tif"), "turned into metres", lake);
    make(at("fathom.tif"), {.unit = "fathom"});
    report.taken("a unit nobody knows", with("fathom.tif"), "'fathom' is not known", lake);
    make(at("scaled.tif"), {.type = GDT_Int16, .scale = 0.01, .offset = 100.0},
         [](int c, int r) { return (bowl(c, r) - 100.0) / 0.01; });
    report.taken("a band scale and offset", with("scaled.tif"), "applied", lake);
    make(at("noscale.tif"), {.type = GDT_Int16, .scale = 0.0, .offset = 5.0});
    report.refused("a band scale of 0", with("noscale.tif"), "make no heights");
    make(at("collar.tif"), {.type = GDT_Int16},
         [](int c, int r) { return c < 4 || r < 3 ? 0.0 : std::round(200.0 + bowl(c, r)); });
    report.taken("a collar of zeros that nobody declared", with("collar.tif", 220.0),
                 "reach the raster's edge and nothing else lies within 3 m");
    make(at("rgb.tif"), {.bands = 3, .type = GDT_Byte, .colour = GCI_RedBand});
    report.refused("a picture", with("rgb.tif"), "is a picture, not elevations");
    make(at("complex.tif"), {.type = GDT_CFloat32});
    report.refused("complex numbers", with("complex.tif"), "complex numbers");
    make(at("bands.tif"), {.bands = 2});
    report.taken("two bands", with("bands.tif"), "the first is taken", lake);
    make(at("plate.tif"), {}, [](int, int) { return 5.0; });
    report.taken("a DEM that is flat all over", with("plate.tif", std::nullopt),
                 "touches the edge");

    // --- several tiles ---------------------------------------------------------------------------
    auto twice = with("good.tif");
    twice.dems.push_back(at("good.tif"));
    report.taken("the same tile twice", twice, "", lake);
    make(at("shift.tif"), {.transform = {500'103, 10, 0, 5'299'996, 0, -10}},
         [](int c, int r) { return bowl(c + 10, r); });
    auto phase = with("good.tif");
    phase.dems.push_back(at("shift.tif"));
    report.taken("overlapping tiles out of phase", phase, "out of phase");
    make(at("far.tif"), {.crs = "EPSG:32733", .transform = {500'000, 10, 0, 3'300'000, 0, -10}});
    auto apart = with("good.tif");
    apart.dems.push_back(at("far.tif"));
    report.refused("tiles a continent apart", apart, "cut it with --at and --radius");
    make(at("datum.tif"), {.crs = "EPSG:32633+5703"});
    auto datums = with("good.tif");
    datums.dems.push_back(at("datum.tif"));
    report.taken("tiles of two vertical datums", datums, "vertical datum", lake);

    // --- questions that make no sense -----------------------------------------------------------
    auto q = with("good.tif");
    q.dems.clear();
    report.refused("no DEM", q, "no elevation data given");
    report.refused("--level below all ground", with("good.tif", -5.0),
                   "nothing lies below the level");
    report.refused("--level nan", with("good.tif", std::nan("")), "--level");
    report.refused("--level 99999", with("good.tif", 99'999.0), "--level is 99999");
    report.taken("--level above all ground", with("good.tif", 500.0), "m it stays inside");
    report.refused("--level auto without a water surface", with("good.tif", std::nullopt),
                   "no flat water surface");
    q = with("good.tif");
    q.at = GeoPoint{10.0, 10.0};
    report.refused("--at elsewhere", q, "outside the elevation data");
    q.at = GeoPoint{95.0, 10.0};
    report.refused("--at off the Earth", q, "is not on Earth");
    q.at = GeoPoint{47.8526, 15.0001}; // on the slope, far above the water
    report.refused("--at on the mountain", q, "above the level");
    q = with("good.tif");
    q.bounds = dem::Bounds{20, 20, 21, 21};
    report.refused("--bounds elsewhere", q, "outside the elevation data");
    q.bounds = dem::Bounds{5, 5, 4, 6};
    report.refused("--bounds west of east", q, "--bounds must be");
    q = with("good.tif");
    q.radius_km = 5.0;
    report.refused("--radius without --at", q, "needs a centre");

    // --- beds and pictures -----------------------------------------------------------------------
    q = with("good.tif");
    make(at("elsewhere.tif"), {.transform = {700'000, 10, 0, 5'300'000, 0, -10}});
    q.bathymetry = at("elsewhere.tif");
    report.refused("a bathymetry of another place", q, "has no value inside the lake");
    q.bathymetry = at("allnan.tif");
    report.refused("a bathymetry of nothing", q, "has no value inside the lake");
    q.soundings = at("depths.csv");
    report.refused("bathymetry and soundings", q, "exclude each other");
    q.bathymetry.reset();
    report.refused("soundings that are not there", q, "no such file");
    const auto sounding = [&](const std::string& what, const std::string& content,
                              const std::string& words) {
        put(at("depths.csv"), content);
        report.refused(what, q, words);
    };
    sounding("soundings without a depth column", "lon,lat,name\n15.0,47.85,a\n",
             "has a position and a depth");
    sounding("soundings with words for depths", "lon,lat,depth\n15.0,47.85,deep\n",
             "has a position and a depth");
    sounding("soundings without a first line", "15.0,47.85,3\n15.1,47.85,4\n",
             "has a position and a depth");
    sounding("soundings elsewhere", "lon,lat,depth\n1.0,1.0,3\n1.1,1.0,4\n", "inside the lake");
    sounding("soundings in metres without a CRS", "x,y,depth\n500300,5299700,3\n",
             "is no longitude and latitude");
    put(at("junk.shp"), "this is no shapefile");
    q.soundings = at("junk.shp");
    report.refused("a shapefile of junk", q, "holds no points or lines");
    put(at("depths.csv"), "lon,lat,depth\n15.004,47.8506,3\n");
    q.soundings = at("depths.csv");
    q.depth_field = "tiefe";
    report.refused("--depth-field that is not there", q, "has no field 'tiefe'");
    q = with("good.tif");
    q.estimate_depth_m = 10.0;
    report.refused("--estimate-depth over a measured bed", q, "is for lakes of unknown depth");
    q.estimate_depth_m = -1.0;
    report.refused("--estimate-depth -1", q, "--estimate-depth is -1");
    q = with("good.tif", std::nullopt);
    q.depths = true;
    report.refused("--depths without --level", q, "needs the level");
    q = with("good.tif");
    q.ortho = at("nocrs.tif");
    report.refused("an orthophoto without CRS", q, "no CRS");
    q.ortho = at("elsewhere.tif");
    report.refused("an orthophoto of another place", q, "lies outside the scene");
    q.ortho = at("text.tif");
    report.refused("an orthophoto that is none", q, "GDAL cannot read it");

    EXPECT_GE(report.cases, 80);
    if (const char* path = std::getenv("TARN_BAD_INPUT_REPORT"))
        std::ofstream(path, std::ios::app)
            << "| | input | what `tarn import` says |\n| --: | --- | --- |\n"
            << report.rows;
}
