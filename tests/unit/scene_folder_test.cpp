// scene.json: round trip, every broken field named; scene folders replaced as a whole or not at
// all.
#include "core/error.hpp"
#include "dem/write.hpp"
#include "geo/frame.hpp"
#include "image/files.hpp"
#include "scene/samples.hpp"
#include "scene/water_types.hpp"
#include "scene_files/scene_folder.hpp"
#include "scene_files/scene_json.hpp"
#include "support/files.hpp"

#include <gtest/gtest.h>

using namespace tarn;
using test_support::TempFolder;
namespace fs = std::filesystem;

namespace {

scene::Scene sample() {
    scene::Scene s = scene::bowl(33);
    s.frame = geo::local_frame({46, 9});
    s.frame.wkt = "EPSG:32632";
    s.frame.datum_shift = {
        .side = 2, .reach_m = 100, .east_m = {1, 2, 3, 4}, .north_m = {4, 3, 2, 1}};
    s.lakes[0].name = "Lake \"Ä\"";
    s.lakes[0].bed = Bed::unknown;
    s.optics = scene::water_type("humic lake");
    s.lakes[0].volume_m3.reset();
    s.cameras.push_back({"here", scene::look({1, 2, 30}, 10, -20, 50)});
    s.report.notes = {"a note"};
    s.report.inputs = {{"a.tif", "dem", "GTiff", "x", "y", "3 x 3", "00"}};
    return s;
}

void write_scene(const scene::Scene& s, const fs::path& folder) {
    scene_files::StagedFolder staged(folder);
    dem::write_heightfield(staged.path() / "ground.tif", s.ground, s.frame, "ground", false);
    dem::write_heightfield(staged.path() / "water.tif", s.water, s.frame, "water", true);
    staged.write_text("scene.json", scene_files::to_json(s, {}));
    staged.commit();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

} // namespace

TEST(SceneJson, RoundTripsEveryField) {
    const scene::Scene a = sample();
    scene_files::FileNames files;
    const std::string first = scene_files::to_json(a, {});
    scene::Scene b = scene_files::from_json(first, files);
    // All but the camera's axes, which are made perpendicular anew and may move by a rounding.
    const std::string second = scene_files::to_json(b, files);
    EXPECT_NEAR(b.cameras[0].camera.up.x, a.cameras[0].camera.up.x, 1e-15);
    EXPECT_EQ(second.substr(0, second.find("cameras")), first.substr(0, first.find("cameras")));
    EXPECT_EQ(second.substr(second.find("\"import\"")), first.substr(first.find("\"import\"")));
    EXPECT_EQ(b.frame, a.frame);
    EXPECT_EQ(b.lakes[0].name, a.lakes[0].name);
    ASSERT_EQ(b.optics.bands.size(), 31u);
    EXPECT_EQ(b.optics.bands[7].backscattering_per_m, a.optics.bands[7].backscattering_per_m);
    EXPECT_FALSE(b.lakes[0].volume_m3.has_value());
    EXPECT_EQ(b.ground.size(), a.ground.size());
}

TEST(SceneJson, EveryBrokenFieldIsNamed) {
    const std::string good = scene_files::to_json(sample(), {});
    const auto says = [](const std::string& text) -> std::string {
        try {
            scene_files::FileNames files;
            scene_files::from_json(text, files);
            return "no error";
        } catch (const Error& error) {
            return error.what();
        }
    };
    EXPECT_EQ(says(good), "no error");
    const std::vector<std::array<std::string, 3>> cases = {
        {"\"version\": 2", "\"version\": 1", "version is 1"},
        {"\"version\": 2", "\"version\": 2.5", "version must be a whole number"},
        {"\"format\": \"tarn scene\"", "\"format\": \"x\"", "format is not"},
        {"\"cols\": 33", "\"cols\": -33", "grid.cols is -33"},
        {"\"cols\": 33", "\"cols\": 4294967329", "grid.cols is 4294967329"},
        {"\"cols\": 33", "\"cols\": \"33\"", "grid.cols must be a whole number"},
        {"\"spacing_m\": 31.25", "\"spacing_m\": 0", "grid.spacing_m is 0"},
        {"\"spacing_m\": 31.25", "\"spacing_m\": 1e999", "JSON"},
        {"\"level_m\": 10.0", "\"level\": 10.0", "lakes[0].level_m is missing"},
        {"\"bed\": \"unknown\"", "\"bed\": \"mud\"", "bed is 'mud'"},
        {"\"file\": \"ground.tif\"", "\"file\": \"../../etc/passwd\"",
         "ground.file is '../../etc/passwd'"},
        {"\"file\": \"ground.tif\"", "\"file\": \"/etc/passwd\"", "no plain file name"},
        {"\"file\": \"water.tif\"", "\"file\": \"..\"", "no plain file name"},
        {"\"index\": 1.333", "\"index\": null", "optics.index must be a number"},
        {"\"bands\": [", "\"bands\": [[400, 0.1, 0.1, 0.2],", "optics.bands[0][3] is 0.2"},
        {"\"fov_deg\": 50.0", "\"fov_deg\": 500", "cameras[0].fov_deg is 500"},
        {"\"seed_node\": [\n", "\"seed_node\": [99,\n", "seed_node must be a list of 2"},
    };
    for (const auto& [from, to, words] : cases)
        EXPECT_NE(says(replaced(good, from, to)).find(words), std::string::npos)
            << to << " -> " << says(replaced(good, from, to));
    EXPECT_NE(says("").find("not valid JSON"), std::string::npos);
    EXPECT_NE(says("[]").find("format is missing"), std::string::npos);
    EXPECT_NE(says(good.substr(0, good.size() / 2)).find("not valid JSON"), std::string::npos);
}

TEST(SceneFolder, LoadsWhatWasWrittenAndRefusesDamage) {
    const TempFolder temp;
    const scene::Scene a = sample();
    write_scene(a, temp / "scene");
    const scene::Scene b = scene_files::load(temp / "scene");
    EXPECT_EQ(b.ground.codes.values, a.ground.codes.values);
    EXPECT_EQ(b.water.codes.values, a.water.codes.values);

    const auto says = [&] {
        try {
            scene_files::load(temp / "scene");
            return std::string("no error");
        } catch (const Error& error) {
            return std::string(error.what());
        }
    };
    const std::string ground = test_support::read_file(temp / "scene/ground.tif");
    const auto restore = [&] {
        std::ofstream(temp / "scene/ground.tif", std::ios::binary) << ground;
    };
    fs::remove(temp / "scene/ground.tif");
    EXPECT_NE(says().find("ground.tif: is missing"), std::string::npos) << says();
    std::ofstream(temp / "scene/ground.tif") << "II*";
    EXPECT_NE(says().find("ground.tif"), std::string::npos) << says();
    std::ofstream(temp / "scene/ground.tif", std::ios::binary)
        << ground.substr(0, ground.size() / 2);
    EXPECT_NE(says(), "no error");
    fs::remove(temp / "scene/ground.tif");
    fs::create_symlink("/etc/hostname", temp / "scene/ground.tif");
    EXPECT_NE(says().find("is a link"), std::string::npos) << says();
    fs::remove(temp / "scene/ground.tif");
    restore();
    EXPECT_EQ(says(), "no error");
    dem::write_heightfield(temp / "scene/water.tif", scene::bowl(17).water, a.frame, "water", true);
    EXPECT_NE(says().find("is 17 x 17, scene.json says 33 x 33"), std::string::npos) << says();
    // A level edited by hand that the water heights do not hold.
    write_scene(a, temp / "scene");
    const std::string json = test_support::read_file(temp / "scene/scene.json");
    std::ofstream(temp / "scene/scene.json")
        << replaced(json, "\"level_m\": 10.0", "\"level_m\": 12.0");
    EXPECT_NE(says().find("level_m is 12, but the water heights hold 10"), std::string::npos)
        << says();
    EXPECT_THROW(scene_files::load(temp / "nowhere"), Error);
    EXPECT_THROW(scene_files::load(temp.path()), Error);
}

TEST(SceneFolder, IsReplacedAsAWholeOrNotAtAll) {
    const TempFolder temp;
    write_scene(sample(), temp / "scene");
    const std::string before = test_support::read_file(temp / "scene/scene.json");
    {
        scene_files::StagedFolder abandoned(temp / "scene");
        abandoned.write_text("scene.json", "half");
    }
    EXPECT_EQ(test_support::read_file(temp / "scene/scene.json"), before);
    scene::Scene other = sample();
    other.lakes[0].name = "other";
    write_scene(other, temp / "scene/"); // a trailing slash means the same folder
    EXPECT_EQ(scene_files::load(temp / "scene").lakes[0].name, "other");
    int entries = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(temp.path()))
        ++entries;
    EXPECT_EQ(entries, 1); // nothing left beside it

    fs::create_directory(temp / "mine");
    std::ofstream(temp / "mine/thesis.txt") << "precious";
    EXPECT_THROW(scene_files::StagedFolder(temp / "mine"), Error);
    EXPECT_EQ(test_support::read_file(temp / "mine/thesis.txt"), "precious");
    // A scene with something of the user's in it, and a project that has a scene.json of its own.
    std::ofstream(temp / "scene/notes.txt") << "precious";
    EXPECT_THROW(scene_files::StagedFolder(temp / "scene"), Error);
    fs::remove(temp / "scene/notes.txt");
    std::ofstream(temp / "mine/scene.json") << "{}";
    EXPECT_THROW(scene_files::StagedFolder(temp / "mine"), Error);
    EXPECT_EQ(test_support::read_file(temp / "mine/thesis.txt"), "precious");
    std::ofstream(temp / "file") << "x";
    EXPECT_THROW(scene_files::StagedFolder(temp / "file"), Error);
    // What a killed import of the same name left behind goes with the next one.
    fs::create_directory(temp / ".scene.partial-999999999");
    write_scene(other, temp / "scene");
    EXPECT_FALSE(fs::exists(temp / ".scene.partial-999999999"));
}
