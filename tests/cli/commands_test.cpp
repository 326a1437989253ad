// The program as people and scripts use it.
#include "dem/gdal_door.hpp"
#include "dem/write.hpp"
#include "image/compare.hpp"
#include "image/files.hpp"
#include "scene_files/scene_folder.hpp"
#include "support/bowl_scene.hpp"
#include "support/files.hpp"

#include <cmath>
#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <iomanip>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

using namespace tarn;
using test_support::expect_one_line;
using test_support::lines;
using test_support::Outcome;
using test_support::run;
using test_support::shared;
using test_support::TempFolder;
namespace fs = std::filesystem;

TEST(Help, EveryCommandHasExamplesAndExitsWithZero) {
    EXPECT_EQ(run("tarn").code, 0);
    EXPECT_NE(run("tarn").out.find("Start with"), std::string::npos);
    EXPECT_EQ(run("tarn --version").out, "0.1.0\n");
    for (const char* command : {"import", "info", "render", "doctor"}) {
        const Outcome o = run(std::string("tarn ") + command + " --help");
        EXPECT_EQ(o.code, 0);
        EXPECT_TRUE(o.out.find("Examples") != std::string::npos ||
                    o.out.find("Exit code") != std::string::npos)
            << o.out;
    }
}

TEST(Usage, MistakesExitWithTwo) {
    EXPECT_EQ(run("tarn fly").code, 2);
    EXPECT_EQ(run("tarn import").code, 2);
    EXPECT_EQ(run("tarn render").code, 2);
    EXPECT_EQ(run("tarn render x -o y.png --no-such-option").code, 2);
    EXPECT_EQ(run("tarn render x -o y.png --fresnel maybe").code, 2);
}

TEST(Errors, AreOneLineThatSaysWhatAndWhatToDo) {
    const std::string scene = shared().scene, dem = shared().dem;
    const TempFolder t;
    const std::string out = " -o " + (t / "x.png").string();
    expect_one_line("tarn import nowhere.tif --level 1 -o " + (t / "s").string(), 1,
                    "no such file");
    expect_one_line("tarn import " + dem + " --level high -o " + (t / "s").string(), 1,
                    "--level: 'high' is no number");
    expect_one_line("tarn import " + dem + " --level 10 --at 1 -o " + (t / "s").string(), 1,
                    "need 2 numbers");
    expect_one_line("tarn import " + dem + " --level -10 -o " + (t / "s").string(), 1,
                    "nothing lies below");
    expect_one_line("tarn import " + dem + " --level 10 -o " + t.path().string() + "/../..", 1,
                    "scene");
    expect_one_line("tarn info " + t.path().string(), 1, "holds no scene.json");
    expect_one_line("tarn info " + (t / "none").string(), 1, "no such scene folder");
    expect_one_line("tarn render " + scene + " -o " + (t / "x.jpg").string(), 1, ".png or .exr");
    expect_one_line("tarn render " + scene + " -o " + (t / "no/x.png").string(), 1,
                    "no such folder");
    expect_one_line("tarn render " + scene + out + " --camera moon", 1,
                    "no camera is called 'moon'");
    expect_one_line("tarn render " + scene + out + " --camera x=1,y=2,q=3", 1,
                    "'q=3' is not understood");
    expect_one_line("tarn render " + scene + out + " --camera x=1,y=2,z=3,above_water=4", 1,
                    "exclude each other");
    expect_one_line("tarn render " + scene + out + " --camera fov=40", 1, "no place given");
    expect_one_line("tarn render " + scene + out + " --camera x=0,y=0,fov=-1", 1, "fov is -1");
    expect_one_line("tarn render " + scene + out + " --camera x=nan,y=0", 1, "is no number");
    expect_one_line("tarn render " + scene + out + " --size 0x10", 1, "width is 0");
    expect_one_line("tarn render " + scene + out + " --size 20000x10", 1, "width is 20000");
    expect_one_line("tarn render " + scene + out + " --size big", 1, "WIDTHxHEIGHT");
    expect_one_line("tarn render " + scene + out + " --samples 0", 1, "samples is 0");
    expect_one_line("tarn render " + scene + out + " --time noon", 1, "'noon' is no time");
    expect_one_line("tarn render " + scene + out + " --sun 10,20 --time 2026-01-01T10:00Z", 1,
                    "exclude each other");
    expect_one_line("tarn render " + scene + out + " --sun-direction 0,0,0", 1,
                    "--sun-direction is zero");
    expect_one_line("tarn render " + scene + out + " --ground-albedo 2", 1, "ground albedo is 2");
    expect_one_line("tarn render " + scene + out + " --index 0.5", 1, "index is 0.5");
    expect_one_line("tarn render " + scene + out + " --absorption-per-m 1,2", 1, "need 3 numbers");
    expect_one_line("tarn render " + scene + out + " --exposure 0 --size 16x16 --samples 1", 1,
                    "--exposure");
    EXPECT_TRUE(fs::is_empty(t.path()));
}

TEST(Errors, ACutOffTileIsOneLineAlsoWhenItIsWarped) {
    const TempFolder t;
    Grid<float> z({300, 300});
    for (std::size_t i = 0; i < z.values.size(); ++i)
        z.values[i] = float(i * 7919 % 1000);
    const double g[6] = {9.0, 1.0 / 3600, 0, 46.0, 0, -1.0 / 3600};
    dem::write_elevations(t / "whole.tif", z, "EPSG:4326", g, "");
    const std::string bytes = test_support::read_file(t / "whole.tif");
    std::ofstream(t / "cut.tif", std::ios::binary) << bytes.substr(0, bytes.size() * 2 / 3);
    expect_one_line("tarn import " + (t / "cut.tif").string() + " --level 500 -o " +
                        (t / "s").string(),
                    1, "cut.tif");
}

TEST(Info, JsonHoldsWhatProgramsRelyOn) {
    const Outcome o = run("tarn info " + shared().scene + " --json");
    ASSERT_EQ(o.code, 0) << o.err;
    const auto j = nlohmann::json::parse(o.out);
    const auto& lake = j.at("lakes").at(0);
    for (const char* name :
         {"id", "name", "level_m", "area_m2", "true_area_m2", "volume_m3", "max_depth_m",
          "mean_depth_m", "shoreline_m", "islands", "lat_deg", "lon_deg", "open_at_edge", "bed"})
        EXPECT_TRUE(lake.contains(name)) << name;
    EXPECT_NEAR(lake["area_m2"].get<double>(), M_PI * 250 * 250, 0.002 * M_PI * 250 * 250);
    EXPECT_NEAR(lake["volume_m3"].get<double>(), M_PI * 250 * 250 * 5,
                0.002 * M_PI * 250 * 250 * 5);
    EXPECT_EQ(lake["bed"], "measured");
    const Outcome words = run("tarn info " + shared().scene);
    EXPECT_NE(words.out.find("10.00 m greatest, 5.00 m mean (bed measured)"), std::string::npos)
        << words.out;
    EXPECT_NE(words.out.find("dem bowl.tif (GTiff, 501 x 501"), std::string::npos) << words.out;
}

TEST(SceneFolder, OpensInGisProgramsInMetresAtTheRightPlace) {
    dem::register_drivers();
    for (const auto& [name, expected] :
         {std::pair{"ground.tif", 40.0 * (3.0 * 3.0) / 250'000.0}, std::pair{"water.tif", 10.0}}) {
        dem::Dataset ds(
            GDALDataset::Open((fs::path(shared().scene) / name).c_str(), GDAL_OF_RASTER));
        ASSERT_TRUE(ds);
        double g[6];
        ds->GetGeoTransform(g);
        GDALRasterBand& band = *ds->GetRasterBand(1);
        // The node 3 m east of the bowl's middle ... the grid is 2 m: take 2 m east, 0 north: r
        // = 2.
        const int col = int(std::floor((500'002.0 - g[0]) / g[1])),
                  row = int(std::floor((5'300'000.0 - g[3]) / g[5]));
        std::uint16_t code = 0;
        ASSERT_EQ(band.RasterIO(GF_Read, col, row, 1, 1, &code, 1, 1, GDT_UInt16, 0, 0), CE_None);
        const double metres = band.GetOffset() + band.GetScale() * code;
        EXPECT_NEAR(metres, std::string(name) == "water.tif" ? expected : 40.0 * 4.0 / 250'000.0,
                    0.002)
            << name;
        EXPECT_STREQ(band.GetUnitType(), "m");
        EXPECT_STREQ(ds->GetSpatialRef()->GetAuthorityCode(nullptr), "32633");
    }
    EXPECT_TRUE(fs::exists(fs::path(shared().scene) / "preview.png"));
}

TEST(Render, StripsMakeTheSameFiles) {
    const TempFolder t;
    const std::string command = "tarn render " + shared().scene +
                                " --camera shore --size 120x90 --samples 2 --caption --exposure 1";
    const auto at = [&](const char* name) { return (t / name).string(); };
    ASSERT_EQ(run(command + " -o " + at("a.png") + " -o " + at("a.exr")).code, 0);
    ASSERT_EQ(run(command + " --strip-rows 32 -o " + at("b.png") + " -o " + at("b.exr")).code, 0);
    const Picture a = image::read_rgba(t / "a.png"), b = image::read_rgba(t / "b.png");
    ASSERT_EQ(a.height_px, b.height_px);
    int differ = 0;
    for (std::size_t i = 0; i < 4 * 120 * 90; ++i) // the bar's scale comes from a smaller picture
        differ += a.bytes[i] != b.bytes[i];
    EXPECT_LT(differ, 20);
    const image::Difference d =
        image::compare(image::read_exr(t / "a.exr"), image::read_exr(t / "b.exr"));
    EXPECT_LT(d.p99_relative, 1e-3);
    expect_one_line(command + " --strip-rows 30 -o " + at("c.png"), 1, "--strip-rows is 30");
    expect_one_line(command + " --strip-rows 32 --reference -o " + at("c.png"), 1,
                    "need the picture whole");
    expect_one_line(command + " --against " + at("a.exr") + " --error-map map.xyz -o " +
                        at("c.png"),
                    1, "map.xyz");
    EXPECT_FALSE(std::filesystem::exists(t / "c.png"));
}

TEST(Render, WritesPicturesThatSayWhereTheyAreFrom) {
    const TempFolder t;
    const Outcome o =
        run("tarn render " + shared().scene + " --size 160x120 --samples 1 --camera shore -o " +
            (t / "a.png").string() + " -o " + (t / "a.exr").string());
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_EQ(lines(o.out), 2);
    for (const char* name : {"a.png", "a.exr"}) {
        const auto m = image::read_metadata(t / name);
        EXPECT_EQ(m.at("tarn:level_m"), "10") << name;
        EXPECT_EQ(m.at("tarn:bed"), "measured");
        EXPECT_NE(m.at("tarn:camera").find("fov="), std::string::npos);
        EXPECT_NE(m.at("tarn:place").find(","), std::string::npos);
    }
    const Picture p = image::read_rgba(t / "a.png");
    EXPECT_EQ(p.width_px, 160);
    // Sky above and water below.
    const auto row = [&](int y) {
        double sum[3] = {};
        for (int x = 0; x < 160; ++x)
            for (std::size_t k = 0; k < 3; ++k)
                sum[k] += p.bytes[(std::size_t(y) * 160 + std::size_t(x)) * 4 + k] / 160.0;
        return glm::dvec3(sum[0], sum[1], sum[2]);
    };
    EXPECT_GT(row(5).b, row(5).r);
    EXPECT_GT(row(110).g, row(110).r); // the water has taken the red
    // The camera in the metadata gives the same picture again.
    const auto m = image::read_metadata(t / "a.exr");
    ASSERT_EQ(run("tarn render " + shared().scene + " --size 160x120 --samples 1 --camera " +
                  m.at("tarn:camera") + " --sun-direction " + m.at("tarn:sun_direction") + " -o " +
                  (t / "b.exr").string())
                  .code,
              0);
    const Image a = image::read_exr(t / "a.exr"), b = image::read_exr(t / "b.exr");
    double off = 0.0;
    for (std::size_t i = 0; i < a.radiance.size(); ++i)
        off += std::abs(a.radiance[i].g - b.radiance[i].g) / double(a.radiance.size());
    EXPECT_LT(off, 1e-4);
}

TEST(Render, CameraHeadingIsTrueNorthAndPlacesAreLatLon) {
    const TempFolder t;
    const auto info = nlohmann::json::parse(run("tarn info " + shared().scene + " --json").out);
    const double lat = info["lakes"][0]["lat_deg"], lon = info["lakes"][0]["lon_deg"];
    const Outcome o = run("tarn render " + shared().scene +
                          " --size 16x16 --samples 1 --camera lat=" + std::to_string(lat) +
                          ",lon=" + std::to_string(lon) +
                          ",above_water=30,heading=90,pitch=-10 -o " + (t / "a.exr").string());
    ASSERT_EQ(o.code, 0) << o.err;
    const std::string camera = image::read_metadata(t / "a.exr").at("tarn:camera");
    std::smatch m;
    ASSERT_TRUE(std::regex_search(
        camera, m, std::regex("x=([^,]*),y=([^,]*),z=([^,]*),dx=([^,]*),dy=([^,]*),dz=([^,]*)")));
    EXPECT_NEAR(std::stod(m[1]), 0.0, 3.0);
    EXPECT_NEAR(std::stod(m[3]), 40.0, 1e-6);
    EXPECT_NEAR(std::stod(m[4]), std::cos(10 * M_PI / 180), 1e-4);
    EXPECT_NEAR(std::stod(m[6]), -std::sin(10 * M_PI / 180), 1e-6);
}

// Noon in June: high in the south at 45 degrees north, in the north from the Cape, below the
// horizon on the other side.
TEST(Render, TheSunIsSeenFromThePlaceThatIsNamed) {
    const TempFolder t;
    const auto mean = [&](const std::string& options) {
        const std::string out = (t / "p.exr").string();
        const Outcome o = run("tarn render " + shared().scene +
                              " --camera top --size 32x32 --samples 1 --ground-albedo .3 " +
                              options + " -o " + out);
        EXPECT_EQ(o.code, 0) << o.err;
        double sum = 0.0;
        for (const glm::vec3& c : image::read_exr(out).radiance)
            sum += c.g;
        return sum / 1024.0;
    };
    const double here = mean("--time 2026-06-21T12:00Z --sun-place 45,0"),
                 cape = mean("--time 2026-06-21T12:00Z --sun-place -34,0"),
                 beyond = mean("--time 2026-06-21T12:00Z --sun-place 45,180");
    EXPECT_GT(here, 1.5 * cape);
    EXPECT_GT(cape, 20.0 * beyond);
    expect_one_line("tarn render " + shared().scene + " --sun-place 95,0 -o " +
                        (t / "x.png").string(),
                    1, "nowhere on Earth");
    expect_one_line("tarn render " + shared().scene + " --sun-place 5,0 --sun 90,20 -o " +
                        (t / "x.png").string(),
                    1, "--sun-place goes with --time");
}

TEST(Render, ASettingsFileMeansTheSameAsTheOptions) {
    const TempFolder t;
    std::ofstream(t / "lab.toml")
        << "ground-albedo = 0.5\nsky-radiance = \"0.2\"\nsun-direction = \"1,0,1\"\n"
           "sun-irradiance = \"3.14159\"\nabsorption-per-m = \"0.1,0.05,0.02\"\n"
           "backscattering-per-m = \"0\"\nindex = 1.34\nsize = \"64x48\"\nsamples = 1\n"
           "camera = \"x=0,y=-300,z=60,dx=0,dy=1,dz=-0.3,ux=0,uy=0,uz=1,fov=50\"\n";
    const std::string typed =
        "--ground-albedo 0.5 --sky-radiance 0.2 --sun-direction 1,0,1 --sun-irradiance 3.14159 "
        "--absorption-per-m 0.1,0.05,0.02 --backscattering-per-m 0 --index 1.34 --size 64x48 "
        "--samples 1 --camera x=0,y=-300,z=60,dx=0,dy=1,dz=-0.3,ux=0,uy=0,uz=1,fov=50";
    const Outcome a = run("tarn render " + shared().scene + " --settings " +
                          (t / "lab.toml").string() + " -o " + (t / "a.exr").string());
    ASSERT_EQ(a.code, 0) << a.err;
    ASSERT_EQ(
        run("tarn render " + shared().scene + " " + typed + " -o " + (t / "b.exr").string()).code,
        0);
    EXPECT_TRUE(image::read_exr(t / "a.exr").radiance == image::read_exr(t / "b.exr").radiance);
    std::ofstream(t / "wrong.toml") << "ground-albebo = 0.5\n";
    expect_one_line("tarn render " + shared().scene + " --settings " + (t / "wrong.toml").string() +
                        " -o " + (t / "c.exr").string(),
                    1, "wrong.toml: no option is called 'ground-albebo'");
    expect_one_line("tarn render " + shared().scene + " --settings " + (t / "none.toml").string() +
                        " -o " + (t / "c.exr").string(),
                    1, "none.toml: cannot be read");
    // What is typed wins over the file.
    ASSERT_EQ(run("tarn render " + shared().scene + " --settings " + (t / "lab.toml").string() +
                  " --size 32x24 -o " + (t / "d.exr").string())
                  .code,
              0);
    EXPECT_EQ(image::read_exr(t / "d.exr").width_px, 32);
}

TEST(Render, ReferenceGivesTheSamePictureAndPrintsTheDifference) {
    const TempFolder t;
    const std::string common =
        "tarn render " + shared().scene + " --size 96x64 --samples 2 --camera overview ";
    ASSERT_EQ(run(common + "--reference -o " + (t / "ref.exr").string()).code, 0);
    const Outcome o =
        run(common + "--against " + (t / "ref.exr").string() + " -o " + (t / "gpu.exr").string());
    ASSERT_EQ(o.code, 0) << o.err;
    std::smatch m;
    ASSERT_TRUE(std::regex_search(o.out, m, std::regex("error mean ([0-9.]+) %"))) << o.out;
    EXPECT_LT(std::stod(m[1]), 1.0);
    EXPECT_NE(o.out.find("first hits: 0 of"), std::string::npos) << o.out;
}

TEST(Render, WithoutAGpuItSaysSoInOneLine) {
    const TempFolder t;
    const std::string out = " --size 16x16 --samples 1 -o " + (t / "x.png").string();
    // No driver at all: libglvnd finds no vendor.
    const std::string blind =
        "__EGL_VENDOR_LIBRARY_DIRS=/nonexistent __EGL_VENDOR_LIBRARY_FILENAMES= ";
    const Outcome none = run(blind + TARN_PROGRAM + " render " + shared().scene + out);
    EXPECT_EQ(none.code, 1);
    EXPECT_EQ(lines(none.err), 1) << none.err;
    EXPECT_NE(none.err.find("no OpenGL 4.5 context"), std::string::npos) << none.err;
    const Outcome doctor = run(blind + TARN_PROGRAM + " doctor");
    EXPECT_EQ(doctor.code, 1);
    EXPECT_NE(doctor.out.find("can NOT render here"), std::string::npos) << doctor.out;
    EXPECT_EQ(run(blind + TARN_PROGRAM + " render " + shared().scene + " --reference" + out).code,
              0);
    // A driver that is too old: Mesa told to offer OpenGL 3.3 only.
    const Outcome old = run(std::string("MESA_GL_VERSION_OVERRIDE=3.3 ") + TARN_PROGRAM +
                            " render " + shared().scene + out);
    EXPECT_EQ(old.code, 1);
    EXPECT_NE(old.err.find("OpenGL 4.5"), std::string::npos) << old.err;
    const Outcome shaders = run(std::string("TARN_SHADERS=/nonexistent ") + TARN_PROGRAM +
                                " render " + shared().scene + out);
    EXPECT_EQ(shaders.code, 1);
    EXPECT_NE(shaders.err.find("shaders not found in /nonexistent"), std::string::npos)
        << shaders.err;
}

TEST(Bench, MeasuresWritesAndDrawsAndReadsItsOwnResults) {
    const TempFolder folder;
    const std::string json_file = (folder / "walks.json").string(),
                      chart = (folder / "walks.svg").string();
    const Outcome o = run(
        "tarn bench " + shared().scene +
        "/ --intersection --methods cone-map,uniform-steps --views overview --size 80x60 --runs 1 "
        "--rays 500 --json " +
        json_file + " --chart " + chart);
    ASSERT_EQ(o.code, 0) << o.err;
    std::ifstream in(json_file);
    const auto all = nlohmann::json::parse(in);
    EXPECT_FALSE(all.at("device").get<std::string>().empty());
    EXPECT_FALSE(all.at("commit").get<std::string>().empty());
    ASSERT_EQ(all.at("results").size(), 6u); // one exact method, one with five settings
    for (const auto& r : all.at("results")) {
        EXPECT_EQ(r.at("scene"), "bowl");
        EXPECT_GT(r.at("time_ms").get<double>(), 0.0);
        EXPECT_GT(r.at("hits").get<int>(), 100);
        if (r.at("exact").get<bool>())
            EXPECT_EQ(r.at("missed_rate").get<double>() + r.at("wrong_rate").get<double>(), 0.0);
    }
    EXPECT_TRUE(fs::exists(chart));
    const Outcome again = run("tarn bench --intersection --from " + json_file);
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(again.out, o.out);
}

TEST(Bench, BadInputGetsOneClearLineBeforeAnyWork) {
    const TempFolder folder;
    const auto with = [&](const std::string& content) {
        std::ofstream(folder / "bad.json") << content;
        return "tarn bench --intersection --from " + (folder / "bad.json").string();
    };
    expect_one_line(with("{"), 1, "is not understood");
    expect_one_line(with("[]"), 1, "has no 'device'");
    expect_one_line(with(R"({"device":"d","commit":"c","results":[]})"), 1, "holds no results");
    {
        const Outcome o = run(with(R"({"device":"d","commit":"c","results":[{}]})"));
        EXPECT_EQ(o.code, 1);
        EXPECT_NE(o.err.find("not understood"), std::string::npos) << o.err;
    }
    expect_one_line("tarn bench --methods grid", 1, "add --intersection");
    expect_one_line("tarn bench --intersection --size 9x", 1, "--size '9x' is not understood");
    expect_one_line("tarn bench --intersection --size 99999x9", 1, "width is 99999");
    expect_one_line("tarn bench --intersection --views up", 1, "no view is called 'up'");
    expect_one_line("tarn bench --intersection --json /nowhere/x.json", 1,
                    "/nowhere: no such folder");
    expect_one_line("tarn bench --intersection --chart x.gif", 1, "is no kind of plot");
    expect_one_line("tarn bench --intersection --methods conemap", 2, "--methods");
    expect_one_line("tarn bench --intersection --failures --json x", 2, "--json");
    expect_one_line("tarn render " + shared().scene + " --intersection cones -o x.png", 2,
                    "--intersection");
    expect_one_line("tarn render " + shared().scene + " --intersection-setting -3 -o x.png", 1,
                    "intersection setting");
}

// The radii in a scene folder belong to its ground: if that was edited, they are made anew.
TEST(SceneFolder, SafetyRadiiAreUsedOnlyForTheGroundTheyWereMadeFor) {
    const TempFolder folder;
    const std::string scene = (folder / "ridges").string(), dem = (folder / "ridges.tif").string();
    Grid<float> z({80, 80});
    for (int r = 0; r < 80; ++r)
        for (int c = 0; c < 80; ++c)
            z[{c, r}] = std::hypot(c - 40, r - 40) < 9 ? 0.0f
                        : c % 6 == 0                   ? 40.0f
                                                       : 5.0f + 0.01f * float(r);
    const double transform[6] = {500000, 10, 0, 5000000, 0, -10};
    dem::write_elevations(dem, z, "EPSG:32633", transform, "ridges");
    const Outcome made = run("tarn import " + dem + " --level 3 -o " + scene);
    ASSERT_EQ(made.code, 0) << made.err;
    const auto picture = [&](const std::string& method) {
        const std::string file = (folder / (method + ".exr")).string();
        const Outcome o =
            run("tarn render " + scene + " --size 120x80 --samples 1 --intersection " + method +
                " -o " + file);
        EXPECT_EQ(o.code, 0) << o.err;
        return image::read_exr(file).distance_m;
    };
    const auto differ = [&] {
        const auto a = picture("grid"), b = picture("safety-exact");
        int n = 0;
        for (std::size_t i = 0; i < a.size(); ++i)
            n += std::isfinite(a[i]) != std::isfinite(b[i]) || std::abs(a[i] - b[i]) > 0.01f;
        return n;
    };
    EXPECT_TRUE(fs::exists(scene + "/safety_ground.tif"));
    EXPECT_EQ(differ(), 0);
    // Radii of a plain: believed as long as they are said to belong to this ground, and rays step
    // over it ...
    const scene::Scene loaded = scene_files::load(scene);
    dem::write_safety_radii(
        scene + "/safety_ground.tif",
        Grid<std::uint8_t>({loaded.ground.size().cols - 1, loaded.ground.size().rows - 1}, 255),
        loaded.ground, loaded.frame);
    EXPECT_GT(differ(), 100);
    // ... and made anew as soon as they are not.
    std::ifstream in(scene + "/scene.json");
    auto json = nlohmann::json::parse(in);
    json.at("safety_ground").at("ground_sum") = "0";
    std::ofstream(scene + "/scene.json") << json.dump(2);
    EXPECT_EQ(differ(), 0);
}

TEST(Doctor, SaysWhatThereIs) {
    const Outcome o = run("tarn doctor");
    EXPECT_EQ(o.code, 0) << o.out << o.err;
    EXPECT_NE(o.out.find("tarn can render here"), std::string::npos);
    const auto j = nlohmann::json::parse(run("tarn doctor --json").out);
    EXPECT_TRUE(j.at("can_render"));
    EXPECT_GE(j.at("opengl").at("max_texture_side_px").get<int>(), 8192);
}

TEST(Import, AFailureLeavesNoHalfSceneAndKeepsTheOlderOne) {
    const TempFolder t;
    const std::string scene = (t / "s").string();
    ASSERT_EQ(run("tarn import " + shared().dem + " --level 10 -o " + scene).code, 0);
    const std::string before = test_support::read_file(t / "s/scene.json");
    EXPECT_EQ(run("tarn import " + shared().dem + " --level -50 -o " + scene).code, 1);
    // A full disk: files may grow to 64 KiB and no further.
    const Outcome full =
        run("sh -c \"ulimit -f 64; trap '' XFSZ; exec " + std::string(TARN_PROGRAM) + " import " +
            shared().dem + " --level 12 -o " + scene + "\"");
    EXPECT_EQ(full.code, 1);
    EXPECT_EQ(lines(full.err), 1) << full.err;
    EXPECT_TRUE(test_support::read_file(t / "s/scene.json") == before);
    EXPECT_EQ(std::distance(fs::directory_iterator(t.path()), {}), 1)
        << "something was left behind";
    EXPECT_EQ(run("tarn import " + shared().dem + " --level 12 -o " + scene).code, 0);
    EXPECT_TRUE(test_support::read_file(t / "s/scene.json") != before);
    EXPECT_EQ(std::distance(fs::directory_iterator(t.path()), {}), 1);
}

TEST(Errors, AFolderThatTakesNoFilesIsOneLine) {
    const std::string& scene = shared().scene;
    expect_one_line("tarn import " + shared().dem + " --level 10 -o /proc/s", 1, "/proc");
    expect_one_line("tarn render " + scene + " --size 32x24 --samples 1 -o /proc/p.png", 1,
                    "/proc");
    expect_one_line("tarn sweep " + scene + " --levels 8 --cameras top --size 32x24 -o /proc/s", 1,
                    "/proc");
}

TEST(Import, CtrlCAndKillLeaveNoHalfScene) {
    // A grid large enough to be interrupted; killed after various delays.
    const TempFolder t;
    Grid<float> z({2000, 2000});
    for (int r = 0; r < 2000; ++r)
        for (int c = 0; c < 2000; ++c)
            z[{c, r}] = float(std::hypot(c - 1000.0, r - 1000.0) +
                              5.0 * std::sin(c * 0.01) * std::cos(r * 0.013));
    const double g[6] = {500'000, 5, 0, 5'300'000, 0, -5};
    dem::write_elevations(t / "big.tif", z, "EPSG:32633", g, "");
    fs::create_directory(t / "work");
    const std::string scene = (t / "work/s").string();
    int interrupted = 0;
    for (const char* signal : {"INT", "INT", "INT", "KILL", "KILL", "KILL"})
        for (const char* delay : {"0.1", "0.3", "0.6"}) {
            // A child of its own process group: a shell's background jobs ignore Ctrl-C.
            const Outcome o =
                run("timeout --signal=" + std::string(signal) + " " + delay + " " + TARN_PROGRAM +
                    " import " + (t / "big.tif").string() + " --level 700 -o " + scene);
            interrupted += o.code != 0;
            if (fs::exists(scene))
                EXPECT_EQ(run("tarn info " + scene).code, 0) << signal << " " << delay;
            if (std::string(signal) == "INT")
                for (const auto& entry : fs::directory_iterator(t / "work"))
                    EXPECT_EQ(entry.path().filename().string()[0], 's')
                        << entry.path(); // nothing half
        }
    EXPECT_GT(interrupted, 3);
    EXPECT_EQ(run("tarn import " + (t / "big.tif").string() + " --level 700 -o " + scene).code, 0);
    EXPECT_EQ(run("tarn info " + scene).code, 0);
    EXPECT_EQ(std::distance(fs::directory_iterator(t / "work"), {}),
              1); // earlier remains are swept
}

TEST(Install, RunsFromWhereItIsInstalled) {
    const TempFolder t;
    const fs::path build = fs::path(TARN_PROGRAM).parent_path().parent_path();
    ASSERT_EQ(run("cmake --install " + build.string() + " --prefix " + (t / "usr").string()).code,
              0);
    const Outcome o = run((t / "usr/bin/tarn").string() + " doctor --json");
    EXPECT_EQ(o.code, 0) << o.err;
    EXPECT_EQ(nlohmann::json::parse(o.out).at("shaders").get<std::string>(),
              (t / "usr/share/tarn/shaders").string());
    EXPECT_EQ(run((t / "usr/bin/tarn").string() + " render " + shared().scene +
                  " --size 16x16 --samples 1 -o " + (t / "a.png").string())
                  .code,
              0);
}

TEST(Install, TheDebianPackageHoldsAProgramThatRuns) {
    const TempFolder t;
    const fs::path build = fs::path(TARN_PROGRAM).parent_path().parent_path();
    const Outcome packed =
        run("sh -c 'cd " + build.string() + " && cpack -B " + (t / "packages").string() + "'");
    ASSERT_EQ(packed.code, 0) << packed.out << packed.err;
    const std::string deb = (t / "packages/tarn_0.1.0_amd64.deb").string();
    ASSERT_TRUE(fs::exists(deb)) << packed.out;
    // Its libraries are named, so that apt brings them.
    const Outcome fields = run("dpkg-deb -f " + deb + " Depends");
    for (const char* library :
         {"libgdal", "libopenimageio", "libegl1", "libopengl0", "fonts-dejavu-core"})
        EXPECT_NE(fields.out.find(library), std::string::npos) << fields.out;
    ASSERT_EQ(run("dpkg-deb -x " + deb + " " + (t / "root").string()).code, 0);
    const Outcome doctor = run((t / "root/usr/bin/tarn").string() + " doctor --json");
    EXPECT_EQ(doctor.code, 0) << doctor.err;
    EXPECT_EQ(nlohmann::json::parse(doctor.out).at("shaders").get<std::string>(),
              (t / "root/usr/share/tarn/shaders").string());
}

TEST(Stats, TableAndPlotOfTheBowlAndNothingElseIsRun) {
    const TempFolder folder;
    const auto trap = folder / "trap";
    const Outcome made =
        run("tarn import " + shared().dem + " --level 10 --name 'Lake `touch " + trap.string() +
            "` \"$(touch " + trap.string() + ")\"' -o " + (folder / "named").string());
    ASSERT_EQ(made.code, 0) << made.err;
    const auto plot = folder / "it's a plot.png";
    const Outcome o = run("tarn stats " + (folder / "named").string() +
                          " --levels 2:10:2 --plot \"" + plot.string() + "\"");
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_FALSE(fs::exists(trap));
    EXPECT_GT(fs::file_size(plot), 5000u);
    std::istringstream table(o.out);
    std::string line;
    std::getline(table, line);
    EXPECT_EQ(line.substr(0, 15), "level_m,area_m2");
    int rows = 0;
    double before = -1.0;
    while (std::getline(table, line)) {
        double level = 0, area = 0;
        ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf", &level, &area), 2);
        EXPECT_NEAR(area, M_PI * 250'000 * level / 40, 0.03 * M_PI * 250'000 * level / 40);
        EXPECT_GT(area, before);
        before = area;
        ++rows;
    }
    EXPECT_EQ(rows, 5);
    const auto j =
        nlohmann::json::parse(run("tarn stats " + shared().scene + " --levels 10,5 --json").out);
    EXPECT_EQ(j["stages"].size(), 2u);
    const auto info = nlohmann::json::parse(run("tarn info " + shared().scene + " --json").out);
    EXPECT_EQ(j["stages"][0]["area_m2"], info["lakes"][0]["area_m2"]);
    EXPECT_NEAR(j["stages"][0]["volume_m3"].get<double>(),
                info["lakes"][0]["volume_m3"].get<double>(), 1.0);
    EXPECT_EQ(run("tarn stats " + shared().scene + " --levels 10:5:1").code, 1);
    EXPECT_EQ(run("tarn stats " + shared().scene + " --levels 1:9e9:1").code, 1);
    EXPECT_EQ(run("tarn stats " + shared().scene + " --levels 5 --lake 9").code, 1);
    EXPECT_EQ(run("tarn stats " + shared().scene + " --levels 5 --plot x.gif").code, 1);
}

TEST(Water, IsKeptInTheSceneAndNamedInThePicture) {
    const TempFolder t;
    const std::string scene = (t / "lake").string();
    ASSERT_EQ(run("tarn import " + shared().dem + " --level 10 --secchi 3 -o " + scene).code, 0);
    const scene::Scene kept = scene_files::load(scene);
    EXPECT_EQ(kept.optics.name, "Secchi depth 3 m");
    ASSERT_EQ(kept.optics.bands.size(), 31u);
    EXPECT_NE(run("tarn info " + scene).out.find("a white disc disappears at 3.0 m"),
              std::string::npos);
    const std::string picture = " --size 64x48 --samples 1 --camera top ";
    ASSERT_EQ(run("tarn render " + scene + picture + "-o " + (t / "a.exr").string()).code, 0);
    const auto named = [&](const std::string& option, const std::string& name) {
        const std::string out = (t / "b.exr").string();
        const Outcome o = run("tarn render " + scene + picture + option + " -o " + out);
        EXPECT_EQ(o.code, 0) << o.err;
        const std::string bytes = test_support::read_file(out);
        EXPECT_NE(bytes.find(name), std::string::npos) << option;
        return bytes;
    };
    named("", "Secchi depth 3 m; a ");
    named("", "; 31 bands");
    named("--water 'jerlov 3C'", "jerlov 3C; a ");
    named("--colour rgb", "; three channels");
    named("--chlorophyll 8 --cdom .5",
          "chlorophyll 8 mg/m3, CDOM 0.5 /m at 440 nm, minerals 0 g/m3");
    std::ofstream(t / "own.csv") << "nm a b\n400 .2 .3\n700 .7 .2\n";
    named("--water-table " + (t / "own.csv").string(), "table own.csv; a ");
    expect_one_line("tarn render " + scene + " --secchi 0 -o " + (t / "c.png").string(), 1,
                    "Secchi depth [m] is 0");
    expect_one_line("tarn render " + scene + " --secchi 2 --cdom 1 -o " + (t / "c.png").string(), 1,
                    "exclude each other");
    expect_one_line("tarn render " + scene + " --turbidity -1 -o " + (t / "c.png").string(), 1,
                    "turbidity [g/m3] is -1");
    expect_one_line("tarn render " + scene + " --water-table none.csv -o " + (t / "c.png").string(),
                    1, "none.csv: cannot be read");
    named("--visibility 12", "12000");
    expect_one_line("tarn render " + scene + " --visibility 0 -o " + (t / "c.png").string(), 1,
                    "--visibility is 0 km");
    EXPECT_EQ(run("tarn render " + scene + " --water ink -o " + (t / "c.png").string()).code, 2);
}

TEST(Waves, NumbersForPeopleAndPrograms) {
    const std::string scene = shared().scene;
    const Outcome o = run("tarn waves " + scene + " --wind 8 --wind-from 240");
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_NE(o.out.find("lake 1, Bowl: Hs 0."), std::string::npos) << o.out;
    EXPECT_NE(o.out.find("337.5 deg"), std::string::npos);
    const TempFolder t;
    std::ofstream(t / "rose.csv") << "from,speed,share\n0,3,20\n240,8,70\n90,5,10\n";
    const Outcome j =
        run("tarn waves " + scene + " --wind-rose " + (t / "rose.csv").string() + " --json");
    ASSERT_EQ(j.code, 0) << j.err;
    const auto report = nlohmann::json::parse(j.out);
    EXPECT_EQ(report["wind_m_per_s"], 8.0); // the most frequent
    EXPECT_EQ(report["wind_rose"].size(), 3u);
    EXPECT_EQ(report["fetches"].size(), 16u);
    // The bowl's water is a disc of 500 m: .0016 sqrt(g F) U / g for a fetch of some 400 m.
    const double fetch = report["lakes"][0]["fetch_m"],
                 hs = report["lakes"][0]["significant_height_m"];
    EXPECT_GT(fetch, 300.0);
    EXPECT_LT(fetch, 500.0);
    EXPECT_NEAR(hs, 0.0016 * std::sqrt(9.81 * fetch) * 8.0 / 9.81, 0.03 * hs);
    EXPECT_NEAR(double(report["drawn"]["mean_square_slope"]), 0.003 + 0.00512 * 8, 0.001);
    expect_one_line("tarn waves " + scene + " --wind -3", 1, "wind [m/s] is -3");
    expect_one_line("tarn waves " + scene + " --waves sines", 1, "needs a list");
    expect_one_line("tarn waves " + scene + " --wave-list 1,2", 1,
                    "--wave-list: '1,2' is not understood");
    expect_one_line("tarn waves " + scene + " --poke 1", 1, "--poke: '1' is not understood");
    expect_one_line("tarn waves " + scene + " --poke 0,0,99", 1, "height of a poke");
    expect_one_line("tarn waves " + scene + " --poke 0,0 --rain 3 --wave-cascades 3", 1,
                    "four patches");
    expect_one_line("tarn waves " + scene + " --wave-texels 100", 1, "must be 128");
    expect_one_line("tarn waves " + scene + " --wind-rose " + scene, 1, "cannot be read");
    expect_one_line("tarn waves " + scene + " --wind 3 --wind-rose " + (t / "rose.csv").string(), 1,
                    "excludes");
    EXPECT_EQ(run("tarn waves " + scene + " --waves tsunami").code, 2);
}

TEST(Waves, AreKeptInTheSceneAndDrawnFromIt) {
    const TempFolder t;
    const std::string scene = (t / "windy").string();
    ASSERT_EQ(
        run("tarn import " + shared().dem +
            " --level 10 --wind 5 --wind-from 90 --rain 20 --wave-cascades 2 --poke 0,0,0.3 -o " +
            scene)
            .code,
        0);
    const scene::Scene kept = scene_files::load(scene);
    EXPECT_EQ(kept.waves.model, waves::Model::jonswap);
    EXPECT_EQ(kept.waves.wind_m_per_s, 5.0);
    EXPECT_NEAR(kept.waves.wind_from_deg, 90.0, 0.5); // grid north
    EXPECT_EQ(kept.waves.ripples.rain_drops_per_m2_s, 20.0);
    ASSERT_EQ(kept.waves.ripples.pokes.size(), 1u);
    EXPECT_EQ(kept.waves.ripples.pokes[0].height_m, 0.3);
    const std::string picture = " --size 64x48 --samples 1 --camera shore --wave-texels 128 -o ";
    ASSERT_EQ(run("tarn render " + scene + picture + (t / "a.exr").string()).code, 0);
    ASSERT_EQ(run("tarn render " + scene + " --waves calm --rain 0 --poke 0,0,0" + picture +
                  (t / "b.exr").string())
                  .code,
              0);
    ASSERT_EQ(
        run("tarn render " + scene + " --wave-time 3" + picture + (t / "c.exr").string()).code, 0);
    ASSERT_EQ(
        run("tarn render " + scene + " --wave-time 603" + picture + (t / "d.exr").string()).code,
        0);
    const auto a = image::read_exr(t / "a.exr").radiance, b = image::read_exr(t / "b.exr").radiance;
    EXPECT_NE(a, b);
    EXPECT_NE(image::read_exr(t / "c.exr").radiance, a);
    const std::string told = image::read_metadata(t / "a.exr").at("tarn:waves");
    EXPECT_EQ(told.substr(0, 17), "jonswap; wind 5 m");
    EXPECT_NE(told.find("; rain 20 drops/(m^2 s); poke "), std::string::npos) << told;
    const Outcome o =
        run("tarn render " + scene + " --wind 0.1" + picture + (t / "e.png").string());
    EXPECT_EQ(o.code, 0);
    EXPECT_NE(o.err.find("drawn calm"), std::string::npos) << o.err;
}

TEST(Detect, ListsLakesForPeopleAndPrograms) {
    const TempFolder folder;
    Grid<float> z({200, 200});
    for (int r = 0; r < 200; ++r)
        for (int c = 0; c < 200; ++c) {
            z[{c, r}] =
                float(300 + 0.37 * c + 0.21 * r + 3 * std::sin(c * 0.7) * std::cos(r * 0.9));
            if (std::hypot(c - 60, r - 60) < 25)
                z[{c, r}] = 290.0f;
            if (std::hypot(c - 140, r - 150) < 15)
                z[{c, r}] = 295.5f;
        }
    const double t[6] = {500'000, 10, 0, 5'300'000, 0, -10};
    dem::write_elevations(folder / "two.tif", z, "EPSG:32633", t, "");
    const Outcome words = run("tarn detect " + (folder / "two.tif").string());
    ASSERT_EQ(words.code, 0) << words.err;
    EXPECT_NE(words.out.find("290.000"), std::string::npos) << words.out;
    EXPECT_NE(words.out.find("295.500"), std::string::npos) << words.out;
    const auto j =
        nlohmann::json::parse(run("tarn detect " + (folder / "two.tif").string() + " --json").out);
    ASSERT_EQ(j["lakes"].size(), 2u);
    for (const char* name :
         {"id", "name", "level_m", "area_m2", "true_area_m2", "volume_m3", "max_depth_m",
          "mean_depth_m", "shoreline_m", "islands", "lat_deg", "lon_deg", "open_at_edge", "bed"})
        EXPECT_TRUE(j["lakes"][0].contains(name)) << name;
    EXPECT_EQ(j["lakes"][0]["bed"], "unknown");
    const Outcome none = run("tarn detect " + (folder / "two.tif").string() + " --min-area 5");
    EXPECT_EQ(none.code, 0);
    EXPECT_NE(none.out.find("no water surface of at least 5.00 km2"), std::string::npos);
}
