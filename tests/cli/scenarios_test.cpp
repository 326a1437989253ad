// Levels, scenarios, recordings and layers as people and scripts use them.
#include "core/geo.hpp"
#include "dem/gdal_door.hpp"
#include "image/files.hpp"
#include "support/bowl_scene.hpp"
#include "support/files.hpp"

#include <atomic>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <iomanip>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

using namespace tarn;
using test_support::expect_one_line;
using test_support::lines;
using test_support::Outcome;
using test_support::run;
using test_support::shared;
using test_support::TempFolder;
namespace fs = std::filesystem;

namespace {

const std::string small = " --size 64x40 --samples 1 ";

std::vector<std::vector<std::string>> csv_rows(const fs::path& path) {
    std::vector<std::vector<std::string>> out;
    std::ifstream in(path);
    for (std::string line; std::getline(in, line);) {
        out.emplace_back();
        std::istringstream fields(line);
        for (std::string field; std::getline(fields, field, ',');)
            out.back().push_back(field);
    }
    return out;
}

GeoPoint lake_place(const std::string& scene) {
    const auto lake = nlohmann::json::parse(run("tarn info " + scene + " --json").out)["lakes"][0];
    return {lake["lat_deg"], lake["lon_deg"]};
}

} // namespace

TEST(Level, MovesTheWaterOfAPicture) {
    const std::string scene = shared().scene;
    const TempFolder t;
    // Straight down, the share of places met at the level grows as it: radius^2 = R^2 level / 40.
    const auto wet = [&](const std::string& level) {
        const fs::path path = t / ("at" + level + ".exr");
        const Outcome o = run("tarn render " + scene + " --camera top --level " + level + small +
                              "-o " + path.string());
        EXPECT_EQ(o.code, 0) << o.err;
        const Image image = image::read_exr(path);
        const std::string camera = image::read_metadata(path)["tarn:camera"];
        const double z = std::stod(camera.substr(camera.find(",z=") + 3)),
                     fov = std::stod(camera.substr(camera.find("fov=") + 4));
        const double half = std::tan(0.5 * fov * M_PI / 180.0);
        int count = 0;
        for (int y = 0; y < image.height_px; ++y)
            for (int x = 0; x < image.width_px; ++x) {
                const double u = (2.0 * (x + 0.5) / image.width_px - 1.0) * half * image.width_px /
                                 image.height_px,
                             v = (2.0 * (y + 0.5) / image.height_px - 1.0) * half;
                const double met =
                    z - std::abs(double(image.distance_m[std::size_t(y * image.width_px + x)])) /
                            std::sqrt(1.0 + u * u + v * v);
                count += std::abs(met - std::stod(level)) < 0.02;
            }
        return double(count);
    };
    const double at5 = wet("5"), at10 = wet("10"), at20 = wet("20");
    EXPECT_NEAR(at10 / at5, 2.0, 0.35);
    EXPECT_NEAR(at20 / at10, 2.0, 0.35);
    expect_one_line("tarn render " + scene + " --level 300" + small + "-o " +
                        (t / "x.png").string(),
                    1, "cannot stand at 300 m");
    expect_one_line("tarn render " + scene + " --level 5 --lake 2" + small + "-o " +
                        (t / "x.png").string(),
                    1, "no lake 2");
    EXPECT_FALSE(fs::exists(t / "x.png"));
}

TEST(Level, FallsDryAndShowsBareBedAsTheReferenceDoes) {
    const std::string scene = shared().scene;
    const TempFolder t;
    const std::string view = " --camera overview --level 4 --size 160x100 --samples 1 ";
    ASSERT_EQ(run("tarn render " + scene + view + "--reference -o " + (t / "r.exr").string()).code,
              0);
    const Outcome o = run("tarn render " + scene + view + "-o " + (t / "g.exr").string() +
                          " --against " + (t / "r.exr").string());
    ASSERT_EQ(o.code, 0) << o.err;
    std::smatch found;
    ASSERT_TRUE(std::regex_search(o.out, found, std::regex("error mean ([0-9.]+) %")));
    EXPECT_LT(std::stod(found[1]), 0.05);
    // Where the lake was and is not, it looks otherwise than land that was never wet.
    ASSERT_EQ(run("tarn render " + scene +
                  " --camera top --level 4 --size 160x100 --samples 1 -o " +
                  (t / "low.exr").string())
                  .code,
              0);
    const Image low = image::read_exr(t / "low.exr");
    const auto luminance_at = [&](double share) { // of the bowl's radius, to the east
        const int x = 80 + int(share * 50.0);
        const glm::vec3 c = low.radiance[std::size_t(50 * 160 + x)];
        return double(c.r + c.g + c.b);
    };
    EXPECT_GT(luminance_at(0.85 * 0.5), 1.3 * luminance_at(1.2));
}

TEST(Picture, IsMadeAgainFromItsSidecar) {
    const TempFolder t;
    const std::string first = (t / "first.png").string(), again = (t / "again.png").string();
    const Outcome o = run("tarn render " + shared().scene + " --camera shore --wind 4 --level 8" +
                          small + "--caption --sidecar -o " + first);
    ASSERT_EQ(o.code, 0) << o.err;
    const auto sidecar = nlohmann::json::parse(test_support::read_file(t / "first.json"));
    EXPECT_EQ(sidecar["options"]["level"], "8");
    EXPECT_EQ(sidecar["options"]["wind"], "4");
    EXPECT_EQ(sidecar["picture"], "first.png");
    ASSERT_EQ(run("tarn render " + shared().scene + " --settings " + (t / "first.json").string() +
                  " -o " + again)
                  .code,
              0);
    const Picture a = image::read_rgba(first), b = image::read_rgba(again);
    EXPECT_EQ(a.bytes, b.bytes);
    EXPECT_EQ(a.height_px, 40 + 24); // the bar below
    std::ofstream(t / "bad.json") << "{\"options\": {\"wind\": 4}}";
    expect_one_line("tarn render " + shared().scene + " --settings " + (t / "bad.json").string() +
                        " -o " + again,
                    1, "options.wind must be a string");
    std::ofstream(t / "worse.json") << "{\"options\": {\"wnd\": \"4\"}}";
    expect_one_line("tarn render " + shared().scene + " --settings " + (t / "worse.json").string() +
                        " -o " + again,
                    1, "no option is called 'wnd'");
}

TEST(Sweep, MakesPicturesTablesAndMaps) {
    const TempFolder t;
    const std::string out = (t / "s").string();
    const std::string command = "tarn sweep " + shared().scene +
                                " --levels 4,10,16 --cameras overview/bank:x=300,y=0,above_ground=5"
                                " --difference 10:4" +
                                small + "-o " + out;
    const Outcome o = run(command);
    ASSERT_EQ(o.code, 0) << o.err;
    const auto rows = csv_rows(t / "s/scenarios.csv");
    ASSERT_EQ(rows.size(), 7u);
    EXPECT_EQ(rows[0][4], "area_m2");
    const Outcome stats = run("tarn stats " + shared().scene + " --levels 4,10,16");
    std::istringstream lines_of(stats.out);
    std::string line;
    std::getline(lines_of, line);
    for (std::size_t level = 0; level < 3; ++level) {
        std::getline(lines_of, line); // level_m,area_m2,true_area_m2,volume_m3,...
        const std::string area = line.substr(line.find(',') + 1);
        for (std::size_t camera = 0; camera < 2; ++camera) {
            const auto& row = rows[1 + 2 * level + camera];
            EXPECT_EQ(row[4], area.substr(0, area.find(','))) << row[0];
            EXPECT_TRUE(fs::exists(t / ("s/" + row[3]))) << row[3];
        }
    }
    // Exposed and flooded against the scene's own level.
    EXPECT_NEAR(std::stod(rows[1][12]), std::stod(rows[3][4]) - std::stod(rows[1][4]), 0.01);
    EXPECT_EQ(std::stod(rows[1][13]), 0.0);
    EXPECT_NEAR(std::stod(rows[5][13]), std::stod(rows[5][4]) - std::stod(rows[3][4]), 0.01);
    // The map says the same, cell by cell.
    dem::register_drivers();
    const auto map =
        dem::Dataset(GDALDataset::Open((t / "s/from_10.00_to_4.00.tif").c_str(), GDAL_OF_RASTER));
    ASSERT_TRUE(map);
    const int cols = map->GetRasterXSize(), height = map->GetRasterYSize();
    std::vector<std::uint8_t> classes(std::size_t(cols) * std::size_t(height));
    ASSERT_EQ(map->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, cols, height, classes.data(), cols,
                                              height, GDT_Byte, 0, 0),
              CE_None);
    double transform[6];
    map->GetGeoTransform(transform);
    const double cell = transform[1] * transform[1];
    EXPECT_NEAR(cell * double(std::count(classes.begin(), classes.end(), 2)),
                std::stod(rows[1][12]), 0.5 * cell);
    EXPECT_NEAR(cell * double(std::count(classes.begin(), classes.end(), 3)), std::stod(rows[1][4]),
                0.5 * cell);
    EXPECT_EQ(std::count(classes.begin(), classes.end(), 1), 0);
    EXPECT_TRUE(map->GetSpatialRef());
    const Picture sheet = image::read_rgba(t / "s/contact_sheet.png");
    EXPECT_GT(sheet.width_px, 2 * 480);
    const auto json = nlohmann::json::parse(test_support::read_file(t / "s/scenarios.json"));
    EXPECT_EQ(json["scenarios"].size(), 6u);
    EXPECT_TRUE(json["scenarios"][0]["done"]);
    // The command in the table makes the very picture.
    std::string again = json["scenarios"][0]["command"];
    again.replace(again.find(" -o "), std::string::npos, " -o " + (t / "again.png").string());
    ASSERT_EQ(run(again).code, 0) << again;
    EXPECT_EQ(image::read_rgba(t / "again.png").bytes,
              image::read_rgba(t / ("s/" + rows[1][3])).bytes);
}

TEST(Sweep, IsTakenUpWhereItStopped) {
    const TempFolder t;
    const std::string command = "tarn sweep " + shared().scene + " --levels 8:12:1 --cameras top" +
                                small + "-o " + (t / "s").string();
    const Outcome list = run(command + " --list");
    EXPECT_EQ(list.code, 0);
    EXPECT_EQ(lines(list.out), 5);
    EXPECT_EQ(list.out.find("done"), std::string::npos);
    EXPECT_FALSE(fs::exists(t / "s")) << "listing makes nothing";
    ASSERT_EQ(run(command + " --job 2").code, 0);
    EXPECT_TRUE(fs::exists(t / "s/level_9.00_top.png"));
    EXPECT_FALSE(fs::exists(t / "s/level_8.00_top.png"));
    EXPECT_NE(run(command + " --list").out.find("2\tdone"), std::string::npos);
    const auto written = fs::last_write_time(t / "s/level_9.00_top.png");
    std::ofstream(t / "s/level_10.00_top.png") << "torn"; // without a sidecar it counts for nothing
    ASSERT_EQ(run(command).code, 0);
    EXPECT_EQ(fs::last_write_time(t / "s/level_9.00_top.png"), written) << "drawn again";
    EXPECT_GT(fs::file_size(t / "s/level_10.00_top.png"), 1000u);
    // Other options, other pictures.
    ASSERT_EQ(run(command + " --no-shadows --job 2").code, 0);
    EXPECT_NE(fs::last_write_time(t / "s/level_9.00_top.png"), written);
    expect_one_line(command + " --job 6", 1, "jobs 1 to 5");
}

TEST(Sweep, SharesItsWorkBetweenProcesses) {
    const TempFolder t;
    const auto command = [&](const std::string& folder, const std::string& more) {
        return "tarn sweep " + shared().scene + " --levels 8:12:1 --cameras top/overview" + small +
               more + "-o " + (t / folder).string();
    };
    ASSERT_EQ(run(command("one", "")).code, 0);
    const Outcome o = run(command("three", "--processes 3 "));
    ASSERT_EQ(o.code, 0) << o.err;
    int pictures = 0;
    for (const auto& entry : fs::directory_iterator(t / "one"))
        if (entry.path().extension() == ".png" &&
            entry.path().filename().string().starts_with("level")) {
            ++pictures;
            EXPECT_EQ(image::read_rgba(entry.path()).bytes,
                      image::read_rgba(t / "three" / entry.path().filename()).bytes)
                << entry.path();
        }
    EXPECT_EQ(pictures, 10);
}

TEST(Sweep, SaysWhatCannotBeBeforeAnyWork) {
    const TempFolder t;
    const std::string to = " -o " + (t / "s").string(), scene = shared().scene;
    expect_one_line("tarn sweep " + scene + " --levels 5,99" + to, 1, "cannot stand at 99 m");
    expect_one_line("tarn sweep " + scene + " --levels 5 --cameras nowhere" + to, 1,
                    "no camera is called 'nowhere'");
    expect_one_line("tarn sweep " + scene + " --levels 5,5.001 --cameras top" + to, 1,
                    "two pictures would be called");
    expect_one_line("tarn sweep " + scene + " --levels 5 --times 2026-99-01" + to, 1, "2026-99-01");
    expect_one_line("tarn sweep " + scene + " --levels 5 --level 4" + to, 1, "--levels");
    expect_one_line("tarn sweep " + scene + " --levels 5 --processes 0" + to, 1, "--processes");
    EXPECT_FALSE(fs::exists(t / "s"));
}

TEST(Layers, AreDrawnWhereTheyLie) {
    const TempFolder t;
    const std::string scene = shared().scene;
    const auto [lat, lon] = lake_place(scene);
    std::ofstream(t / "track.geojson")
        << "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{},"
           "\"geometry\":{\"type\":\"LineString\",\"coordinates\":[["
        << std::setprecision(12) << lon - 0.004 << "," << lat << "],[" << lon + 0.004 << "," << lat
        << "]]}}]}";
    const std::string view = " --camera top --size 200x200 --samples 4 --depth-colours 10 ";
    ASSERT_EQ(run("tarn render " + scene + view + "-o " + (t / "without.png").string()).code, 0);
    const Outcome o = run("tarn render " + scene + view + "--exposure 1 --layers " +
                          (t / "track.geojson").string() + " -o " + (t / "with.png").string());
    ASSERT_EQ(o.code, 0) << o.err;
    const Picture p = image::read_rgba(t / "with.png");
    std::map<int, int> reds; // by row
    for (int y = 0; y < 200; ++y)
        for (int x = 60; x < 140; ++x) {
            const std::uint8_t* c = &p.bytes[std::size_t(y * 200 + x) * 4];
            reds[y] += c[0] > c[2] + 60;
        }
    int rows_with = 0;
    for (const auto& [y, count] : reds)
        rows_with += count > 60;
    EXPECT_GE(rows_with, 1); // a line from west to east
    EXPECT_LE(rows_with, 5);
    // Cut by the level: the track from west to east lies half in the water.
    std::map<std::string, int> red;
    for (const char* part : {"all", "dry", "flooded"}) {
        const std::string out = (t / (std::string(part) + ".png")).string();
        ASSERT_EQ(run("tarn render " + scene + view + "--exposure 1 --layers-on " + part +
                      " --layers " + (t / "track.geojson").string() + " -o " + out)
                      .code,
                  0);
        const Picture cut = image::read_rgba(out);
        for (std::size_t i = 0; i + 4 <= cut.bytes.size(); i += 4)
            red[part] +=
                cut.bytes[i] > cut.bytes[i + 2] + 60 && cut.bytes[i] > cut.bytes[i + 1] + 60;
    }
    EXPECT_GT(red["dry"], 10);
    EXPECT_GT(red["flooded"], 60);
    EXPECT_NEAR(red["dry"] + red["flooded"], red["all"], 0.15 * red["all"])
        << red["dry"] << " " << red["flooded"];
    expect_one_line("tarn render " + scene + " --layers nothing.gpkg -o " + (t / "x.png").string(),
                    1, "nothing.gpkg: no such file");
    std::ofstream(t / "far.geojson")
        << "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Point\","
           "\"coordinates\":[100,10]}}";
    expect_one_line("tarn render " + scene + " --layers " + (t / "far.geojson").string() + " -o " +
                        (t / "x.png").string(),
                    1, "nothing of them lies on the scene");
}

// A pole of a GeoJSON file and a GPX track, both with heights, over the lake; names beside points.
TEST(Layers, HangInSpaceAtTheirOwnHeights) {
    const TempFolder t;
    const std::string scene = shared().scene;
    const auto [lat, lon] = lake_place(scene);
    std::ofstream(t / "track.gpx")
        << std::setprecision(12) << "<gpx version=\"1.1\" creator=\"test\"><wpt lat=\"" << lat
        << "\" lon=\"" << lon << "\"><ele>14</ele><name>Buoy 7</name></wpt><trk><trkseg>"
        << "<trkpt lat=\"" << lat << "\" lon=\"" << lon - 0.004 << "\"><ele>14</ele></trkpt>"
        << "<trkpt lat=\"" << lat << "\" lon=\"" << lon + 0.004 << "\"><ele>14</ele></trkpt>"
        << "</trkseg></trk></gpx>";
    const std::string view = " --camera x=0,y=-150,z=14,heading=0,pitch=0,fov=60 --size 200x200 "
                             "--exposure 1 --layers-3d " +
                             (t / "track.gpx").string();
    // Rows with much red, from the middle.
    const auto rows = [&](const std::string& more) {
        const std::string out = (t / "out.png").string();
        const Outcome o = run("tarn render " + scene + view + more + " -o " + out);
        EXPECT_EQ(o.code, 0) << o.err;
        const Picture p = image::read_rgba(out);
        std::vector<double> found;
        for (int y = 0; y < 200; ++y) {
            int reds = 0;
            for (int x = 0; x < 90; ++x) { // left of the buoy
                const std::uint8_t* c = &p.bytes[std::size_t(y * 200 + x) * 4];
                reds += c[0] > c[1] + 40 && c[0] > c[2] + 40;
            }
            if (reds > 40)
                found.push_back(y + 0.5 - 100.0);
        }
        return found;
    };
    // At 14 m, as high as the camera; 14 m over the level of 10 m, 150 m away: 200 / 2 / tan 30 x
    // 10 / 150 pixels up.
    for (const auto& [more, up_px] :
         {std::pair("", 0.0), std::pair(" --layers-3d-heights level", 173.2 * 10.0 / 150.0),
          std::pair(" --layers-3d-heights level --level 12", 173.2 * 12.0 / 150.0)}) {
        const auto found = rows(std::string(more) + " --layers-on dry --no-reflection");
        ASSERT_FALSE(found.empty()) << more;
        const double middle =
            std::accumulate(found.begin(), found.end(), 0.0) / double(found.size());
        EXPECT_NEAR(middle, -up_px, 1.0) << more;
        EXPECT_LE(found.size(), 4u) << more;
    }
    EXPECT_GE(rows("").size(), 2u);                    // itself and in the water, mirrored
    EXPECT_TRUE(rows(" --layers-on flooded").empty()); // all of it is in the air
    // A name is written where the buoy is.
    const auto words = [&](const std::string& more) {
        const std::string out = (t / "out.png").string();
        EXPECT_EQ(run("tarn render " + scene + view + more + " -o " + out).code, 0);
        const Picture p = image::read_rgba(out);
        int white = 0;
        for (int y = 80; y < 110; ++y)
            for (int x = 100; x < 180; ++x) {
                const std::uint8_t* c = &p.bytes[std::size_t(y * 200 + x) * 4];
                white += c[0] > 240 && c[1] > 240 && c[2] > 240;
            }
        return white;
    };
    EXPECT_GT(words(" --labels"), 20);
    EXPECT_EQ(words(""), 0);
    // Without heights nothing can count from the datum.
    std::ofstream(t / "flat.geojson")
        << std::setprecision(12)
        << "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Point\","
        << "\"coordinates\":[" << lon << "," << lat << "]}}";
    const std::string flat = "tarn render " + scene + " --size 64x64 --layers-3d " +
                             (t / "flat.geojson").string() + " -o " + (t / "x.png").string();
    expect_one_line(flat, 1, "flat.geojson: a vertex has no height");
    EXPECT_EQ(run(flat + " --layers-3d-heights level").code, 0);
}

TEST(Record, WritesPicturesOnceAndKeepsThem) {
    const TempFolder t;
    const std::string command = "tarn record " + shared().scene +
                                " --path overview/shore --seconds 1 --fps 4 --wind 3" + small +
                                "-o " + (t / "f").string();
    const Outcome first = run(command);
    ASSERT_EQ(first.code, 0) << first.err;
    for (int i = 1; i <= 4; ++i)
        EXPECT_TRUE(fs::exists(t / ("f/frame_0000" + std::to_string(i) + ".png")));
    fs::remove(t / "f/frame_00003.png");
    EXPECT_NE(run(command).out.find("wrote 1 of 4"), std::string::npos);
    expect_one_line(command + " --no-shadows", 1, "holds another recording");
    expect_one_line("tarn record " + shared().scene + small + "-o " + (t / "g").string(), 1,
                    "--path or --track");
    expect_one_line("tarn record " + shared().scene + " --path shore --fps 0" + small + "-o " +
                        (t / "g").string(),
                    1, "--fps is 0");
}

TEST(Manual, HasAPageForEveryCommandAndCompletesItsOptions) {
    const TempFolder t;
    ASSERT_EQ(run("tarn manual " + t.path().string()).code, 0);
    const std::string help = run("tarn").out;
    EXPECT_EQ(help.find("manual"), std::string::npos) << "it is for the build";
    int commands = 0;
    const std::regex line("\n  ([a-z]+)  +[a-z0-9]");
    for (std::sregex_iterator i(help.begin(), help.end(), line), end; i != end; ++i) {
        ++commands;
        const std::string page = test_support::read_file(t / ("tarn-" + (*i)[1].str() + ".1"));
        EXPECT_NE(page.find(".SH OPTIONS"), std::string::npos) << (*i)[1];
    }
    EXPECT_GE(commands, 11);
    const Outcome done =
        run("bash -c '. " + (t / "tarn.bash").string() +
            "; COMP_WORDS=(tarn sweep --lev); COMP_CWORD=2; _tarn; echo ${COMPREPLY[@]}; "
            "COMP_WORDS=(tarn swe); COMP_CWORD=1; _tarn; echo ${COMPREPLY[@]}'");
    EXPECT_EQ(done.out, "--levels --level\nsweep\n") << done.err;
    if (run("command -v groff").code == 0) // no complaints from roff itself
        EXPECT_EQ(run("groff -ww -man -Tascii " + (t / "tarn-render.1").string()).err, "");
}

// A disk that fills up in the middle of a sweep: a line for each picture that failed, whole
// pictures only, and the rest when there is room again.
TEST(Sweep, AFullDiskLeavesWholePicturesAndIsTakenUpAgain) {
    const TempFolder t;
    const std::string command = "tarn sweep " + shared().scene +
                                " --levels 8,10 --cameras overview --size 160x120 --samples 1 -o " +
                                (t / "s").string();
    // Files may grow to so many blocks of 512 bytes and no further: sidecars fit, pictures do not;
    // then nothing does.
    for (const int blocks : {20, 1}) {
        const Outcome full = run("sh -c \"ulimit -f " + std::to_string(blocks) +
                                 "; trap '' XFSZ; exec " + TARN_PROGRAM + command.substr(4) + "\"");
        EXPECT_EQ(full.code, 1);
        EXPECT_EQ(lines(full.err), 3) << full.err; // two pictures, and what is made from them
        EXPECT_NE(full.err.find("level_8.00_overview: cannot write into"), std::string::npos)
            << full.err;
        for (const auto& entry : fs::recursive_directory_iterator(t.path())) {
            const std::string name = entry.path().filename().string();
            EXPECT_EQ(name.find(".partial"), std::string::npos) << name;
            EXPECT_NE(entry.path().extension(), ".png") << name;
        }
    }
    ASSERT_EQ(run(command).code, 0);
    EXPECT_TRUE(fs::exists(t / "s/scenarios.csv"));
    for (const char* name : {"s/level_8.00_overview.png", "s/level_10.00_overview.png"})
        EXPECT_EQ(image::read_rgba(t / name).width_px, 160);
}

// A GPU that has no more memory, or is lost while it draws: one line, exit code 1, no file.
TEST(Render, AGpuThatFailsIsOneLine) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer must be loaded first";
#endif
    const TempFolder t;
    const std::string out = (t / "p.png").string();
    struct Case {
        const char* fault;
        const char* words;
    };
    for (const Case& c : {Case{"memory:texture", "out of GPU memory"},
                          Case{"memory:draw", "out of GPU memory"}, Case{"lost", "lost"}}) {
        const Outcome o = run("env LD_PRELOAD=" + std::string(TARN_FAULTY_GL) +
                              " TARN_TEST_GL_FAULT=" + c.fault + " " + TARN_PROGRAM + " render " +
                              shared().scene + " --size 64x48 --samples 1 -o " + out);
        EXPECT_EQ(o.code, 1) << c.fault;
        EXPECT_EQ(lines(o.err), 1) << o.err;
        EXPECT_NE(o.err.find(c.words), std::string::npos) << o.err;
        EXPECT_FALSE(fs::exists(out)) << c.fault;
        EXPECT_TRUE(fs::is_empty(t.path())) << c.fault;
    }
}

// Two programs with one scene: a picture shows the scene before or after an import that replaces
// it, never a mixture, and two that write one picture leave one whole one.
TEST(SceneFolder, TwoProgramsAtOnceSeeWholeScenes) {
    const TempFolder t;
    const std::string scene = (t / "s").string();
    const auto import = [&](int level) {
        return "tarn import " + shared().dem + " --level " + std::to_string(level) + " -o " + scene;
    };
    ASSERT_EQ(run(import(10)).code, 0);
    std::atomic<bool> done{false};
    int imports = 0;
    std::thread other([&] {
        while (!done) {
            EXPECT_EQ(run(import(imports % 2 ? 10 : 12)).code, 0);
            ++imports;
        }
    });
    std::set<double> levels;
    // Pictures may take as long as two imports do, and always find the same level: then others
    // look.
    for (int i = 0; i < 6 || (levels.size() < 2 && i < 100); ++i) {
        const std::string out = (t / ("p" + std::to_string(i) + ".png")).string();
        const Outcome o = run("tarn info " + scene + " --json");
        ASSERT_EQ(o.code, 0) << o.err;
        const auto lake = nlohmann::json::parse(o.out).at("lakes").at(0);
        const double level = lake.at("level_m").get<double>(),
                     area = lake.at("area_m2").get<double>();
        levels.insert(level);
        EXPECT_NEAR(area, M_PI * 500.0 * 500.0 * level / 40.0, 0.01 * area)
            << "level and area of two scenes";
        if (i >= 6)
            continue;
        const Outcome drawn =
            run("tarn render " + scene + " --camera top --size 64x48 --samples 1 -o " + out);
        EXPECT_EQ(drawn.code, 0) << drawn.err;
    }
    done = true;
    other.join();
    EXPECT_GT(imports, 1);
    EXPECT_EQ(levels.size(), 2u) << "nothing happened at the same time";
    // One picture, two writers.
    const std::string both = (t / "both.png").string(),
                      draw = std::string(TARN_PROGRAM) + " render " + scene +
                             " --size 200x150 --samples 1 -o " + both;
    ASSERT_EQ(
        std::system(("sh -c '" + draw + " >/dev/null & " + draw + " >/dev/null; wait'").c_str()),
        0);
    EXPECT_EQ(image::read_rgba(both).width_px, 200);
}
