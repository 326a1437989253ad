// A real window on a real (if virtual) screen, driven as a person would.
#include "core/text.hpp"
#include "support/desk.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace tarn;
using test_support::Desk;
using test_support::pause;
namespace fs = std::filesystem;

namespace {

/// The caldera sample as DEM and scene, made once.
struct Sample {
    test_support::TempFolder folder;
    std::string dem = (folder / "caldera.tif").string(), scene = (folder / "caldera").string();
    Sample() {
        EXPECT_EQ(std::system((std::string(TARN_SAMPLES_PROGRAM) + " " + folder.path().string() +
                               " caldera >/dev/null")
                                  .c_str()),
                  0);
        const auto made =
            test_support::run("tarn import " + dem + " --level 1883 --name Caldera -o " + scene);
        EXPECT_EQ(made.code, 0) << made.err;
    }
};

Sample& sample() {
    static Sample once;
    return once;
}

struct Rgb {
    double r = 0, g = 0, b = 0;
};

Rgb mean(const Picture& p, int x0, int y0, int x1, int y1) {
    Rgb sum;
    double count = 0;
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
            const std::uint8_t* c =
                &p.bytes[(std::size_t(y) * std::size_t(p.width_px) + std::size_t(x)) *
                         std::size_t(p.channels)];
            sum.r += c[0];
            sum.g += c[1];
            sum.b += c[2];
            ++count;
        }
    return {sum.r / count, sum.g / count, sum.b / count};
}

double difference(const Picture& a, const Picture& b, int x0, int y0, int x1, int y1) {
    double sum = 0, count = 0;
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t i =
                    (std::size_t(y) * std::size_t(a.width_px) + std::size_t(x)) * 4 + k;
                sum += std::abs(double(a.bytes[i]) - double(b.bytes[i]));
                ++count;
            }
    return sum / count;
}

/// Middles of the panel's headers, from the top: rows where their colour goes on for a while.
std::vector<int> headers(const Picture& p) {
    std::vector<int> out;
    int first = -1;
    for (int y = 30; y < Desk::height_px - 50; ++y) {
        int alike = 0;
        for (int x = 240; x < 310; ++x) { // right of all their names
            const Rgb c = mean(p, x, y, x + 1, y + 1);
            alike += c.g > c.r + 28 && c.b > c.g + 8 && c.b < c.g + 26 && c.g > 55 && c.g < 90;
        }
        if (alike > 65) {
            if (first < 0)
                first = y;
        } else {
            if (first >= 0 && y - first >= 12 && y - first <= 30)
                out.push_back((first + y) / 2);
            first = -1;
        }
    }
    return out;
}

} // namespace

TEST(Driven, OpensOnAGoodView) {
    TARN_NEEDS_DESK();
    Desk desk;
    desk.open(sample().scene);
    RecordProperty("start_ms", int(desk.last("first picture")["start_ms"].get<double>()));
    pause(5.0); // at rest the picture gets sharp
    const Picture shot = desk.screenshot();
    // Right of the panel, down one column after the other: sky first, then land or water.
    int water = 0, all = 0;
    std::vector<int> horizon;
    for (int x = 360; x < 940; x += 20) {
        int y = 60;
        const Rgb top = mean(shot, x, 50, x + 4, 54);
        EXPECT_GT(top.b, top.r) << "no sky at the top of column " << x;
        while (y < 660) {
            const Rgb c = mean(shot, x, y, x + 4, y + 4);
            if (c.b < c.g || c.r + c.g + c.b < 0.6 * (top.r + top.g + top.b))
                break;
            y += 2;
        }
        horizon.push_back(y);
        for (int row = y; row < 660; row += 8, ++all) {
            const Rgb c = mean(shot, x, row, x + 4, row + 4);
            water += c.b > 1.15 * c.r && c.b > c.g * 0.9;
        }
    }
    std::sort(horizon.begin(), horizon.end());
    EXPECT_GT(horizon[horizon.size() / 2], 70);
    EXPECT_LT(horizon[horizon.size() / 2], 420);
    EXPECT_GT(water, all / 12) << "the lake is to be seen, and blue";
    // The panel can be read: bright words on a dark ground, and its headers are there.
    const Rgb panel = mean(shot, 12, 30, 330, 640);
    EXPECT_LT(panel.r + panel.g + panel.b, 3 * 90.0);
    int bright = 0;
    for (int y = 10; y < 640; ++y)
        for (int x = 12; x < 330; ++x) {
            const Rgb c = mean(shot, x, y, x + 1, y + 1);
            bright += c.r > 180 && c.g > 180 && c.b > 180;
        }
    EXPECT_GT(bright, 1500);
    EXPECT_EQ(headers(shot).size(), 12u);
    desk.key("ctrl+q");
    EXPECT_EQ(desk.program().wait(20.0), 0) << desk.said();
    EXPECT_EQ(desk.count("closed"), 1);
    EXPECT_EQ(desk.count("gl error"), 0);
    EXPECT_EQ(desk.count("complaint"), 0);
}

TEST(Driven, FliesDivesAndTakesItBack) {
    TARN_NEEDS_DESK();
    Desk desk;
    desk.open(sample().scene);
    // The pointer on the lake: how deep it is, and how deep it looks.
    desk.xdo("mousemove 700 560");
    ASSERT_TRUE(desk.wait_for("depth read", 5.0));
    const auto depth = desk.last("depth read");
    EXPECT_GT(depth["depth_m"], 1.0);
    EXPECT_LT(depth["apparent_depth_m"], 0.76 * depth["seen_depth_m"].get<double>());
    EXPECT_GT(depth["apparent_depth_m"], 0.1 * depth["seen_depth_m"].get<double>());
    desk.xdo("mousemove 700 350");
    desk.hold("w", 2.0);
    ASSERT_TRUE(desk.wait_for("pose", 5.0));
    const auto flown = desk.last("pose");
    desk.key("4", 4.0); // the scene's fourth camera dives
    const auto dived = desk.last("pose");
    EXPECT_EQ(dived["under_water"], 1.0);
    const Rgb c = mean(desk.screenshot(), 400, 200, 900, 600);
    EXPECT_GT(c.g, c.r);
    EXPECT_GT(c.b, c.r);
    desk.hold("w", 1.0);
    EXPECT_GE(desk.last("pose")["z"], desk.last("pose")["ground_m"].get<double>() + 0.29);
    desk.key("ctrl+z", 1.0);
    desk.key("ctrl+z", 1.0);
    desk.hold("w", 0.3); // poses are written when a movement ends
    EXPECT_EQ(desk.last("pose")["under_water"], 0.0) << "Ctrl Z brings the camera out again";
    // Orbit: drag with the left button; then look around with the right one.
    const double heading = desk.last("pose")["heading_deg"];
    desk.xdo("mousemove 700 450 mousedown 1 sleep .3 mousemove 760 450 sleep .3 mousemove 820 450 "
             "sleep .3 mouseup 1");
    pause(1.0);
    EXPECT_GT(std::abs(desk.last("pose")["heading_deg"].get<double>() - heading), 5.0);
    desk.key("ctrl+q");
    EXPECT_EQ(desk.program().wait(20.0), 0) << desk.said();
    EXPECT_EQ(desk.count("gl error"), 0);
}

TEST(Driven, TheLevelIsDraggedAndCounted) {
    TARN_NEEDS_DESK();
    Desk desk;
    desk.open(sample().scene);
    ASSERT_TRUE(desk.wait_for("level", 30.0)); // the water has been followed
    pause(1.0);
    const Picture before = desk.screenshot();
    const std::vector<int> rows = headers(before);
    ASSERT_EQ(rows.size(), 12u);
    const int slider = rows[0] + 24;
    desk.xdo(text("mousemove 200 ", slider, " mousedown 1"));
    for (int x = 195; x > 120; x -= 15) {
        desk.xdo(text("mousemove ", x, " ", slider));
        pause(0.4);
    }
    // A machine that has other work takes longer to follow; the hand waits for it, held down.
    for (int i = 0; i < 25 && desk.count("level") < 3; ++i) {
        desk.xdo(text("mousemove ", 121 + i % 2 * 4, " ", slider));
        pause(0.4);
    }
    desk.xdo("mouseup 1");
    pause(4.0);
    const auto level = desk.last("level");
    EXPECT_GE(desk.count("level"), 3) << "it follows the hand";
    EXPECT_LT(level["level_m"], 1880.0);
    EXPECT_GT(level["level_m"], 1289.0);
    EXPECT_GT(difference(before, desk.screenshot(), 400, 200, 950, 640), 1.0);
    // The same area as tarn stats says.
    const auto stats = test_support::run("tarn stats " + sample().scene + " --levels " +
                                         fixed(level["level_m"].get<double>(), 2) + " --json");
    ASSERT_EQ(stats.code, 0) << stats.err;
    EXPECT_NEAR(level["area_m2"].get<double>(),
                nlohmann::json::parse(stats.out)["stages"][0]["area_m2"].get<double>(), 1.0);
    desk.key("bracketright", 1.5); // .1 m up
    EXPECT_NEAR(desk.last("level")["level_m"].get<double>(), level["level_m"].get<double>() + 0.1,
                0.006);
    desk.key("ctrl+q");
    EXPECT_EQ(desk.program().wait(20.0), 0) << desk.said();
    EXPECT_EQ(desk.count("gl error"), 0);
    EXPECT_EQ(desk.count("complaint"), 0);
}

TEST(Driven, EveryPanelOpens) {
    TARN_NEEDS_DESK();
    Desk desk;
    desk.open(sample().scene);
    ASSERT_TRUE(desk.wait_for("level", 30.0));
    pause(4.0);
    Picture before = desk.screenshot();
    const std::vector<int> rows = headers(before);
    ASSERT_EQ(rows.size(), 12u); // all sections
    // From the last up, so that those above stay where they are, and left open: each is held
    // against the picture before its own click. The first two are open at first.
    for (std::size_t i = rows.size(); i-- > 0;) {
        desk.click(150, rows[i], 0.35);
        Picture after = desk.screenshot("panel_" + std::to_string(i));
        const int bottom = std::min(rows[i] + 60, Desk::height_px - 60);
        EXPECT_GT(difference(before, after, 20, rows[i] + 12, 325, bottom), 0.5) << "section " << i;
        before = std::move(after);
    }
    EXPECT_EQ(desk.count("complaint"), 0);
    EXPECT_EQ(desk.count("gl error"), 0);
    desk.key("ctrl+q");
    EXPECT_EQ(desk.program().wait(20.0), 0) << desk.said();
}

// A screen with 192 dots an inch: letters and panels twice as large, the picture as before.
TEST(Driven, SavesAPictureAsExr) {
    TARN_NEEDS_DESK();
    Desk desk;
    desk.open(sample().scene, {"--samples", "1", "--picture-format", "exr"});
    pause(1.0);
    desk.key("F12");
    for (int i = 0; i < 300 && !fs::exists(desk / "tarn_001.json"); ++i)
        pause(0.2);
    const Image picture = image::read_exr(desk / "tarn_001.exr");
    EXPECT_EQ(picture.width_px, 1920);
    EXPECT_TRUE(std::isfinite(picture.distance_m[std::size_t(1920) * 800 + 960])); // the lake
    EXPECT_FALSE(fs::exists(desk / "tarn_001.png"));
    desk.key("ctrl+q");
    EXPECT_EQ(desk.program().wait(20.0), 0) << desk.said();
    EXPECT_EQ(desk.count("complaint"), 0);
}

TEST(Driven, FinePixelsGetLargePanels) {
    TARN_NEEDS_DESK();
    const auto panel_height = [](int dpi) {
        Desk desk;
        if (dpi > 0)
            desk.set_dpi(dpi);
        desk.open(sample().scene);
        pause(1.0);
        const Picture p = desk.screenshot();
        EXPECT_EQ(desk.count("gl error"), 0);
        desk.key("ctrl+q");
        EXPECT_EQ(desk.program().wait(20.0), 0) << desk.said();
        // The first header: rows of its colour near the panel's left end.
        int first = -1, last = -1;
        for (int y = dpi > 96 ? 60 : 30; y < 300 && last < 0; ++y) { // below the title
            const int x = dpi > 96 ? 480 : 240;                      // right of the name
            const Rgb c = mean(p, x, y, x + 2, y + 1);
            const bool here =
                c.g > c.r + 28 && c.b > c.g + 8 && c.b < c.g + 26 && c.g > 55 && c.g < 90;
            if (here && first < 0)
                first = y;
            if (!here && first >= 0 && y - first >= 8)
                last = y;
        }
        return double(last - first);
    };
    const double usual = panel_height(0), fine = panel_height(192);
    EXPECT_GT(usual, 12.0);
    EXPECT_NEAR(fine / usual, 2.0, 0.15) << usual << " and " << fine << " rows";
}

// The planner's section: a click finds out what the view needs, and says so.
TEST(Driven, PlansTheViewAndDrawsEverythingAgain) {
    TARN_NEEDS_DESK();
    Desk desk;
    desk.open(sample().scene, {}, "640x860");
    ASSERT_TRUE(desk.wait_for("level", 60.0));
    pause(3.0);
    std::vector<int> rows = headers(desk.screenshot());
    ASSERT_EQ(rows.size(), 12u);
    desk.click(150, rows[8], 1.0); // "No more than it needs"
    const int line = rows[11] - rows[10];
    desk.click(70, rows[8] + 2 * line, 0.5); // below a slider, "plan this view"
    ASSERT_TRUE(desk.wait_for("plan", 120.0)) << "not planned";
    EXPECT_GE(desk.last("plan")["reasons"].get<double>(), 2.0); // curvature, and the sum of all
    pause(1.0);
    desk.screenshot("planned");
    EXPECT_EQ(desk.count("complaint"), 0);
    EXPECT_EQ(desk.count("gl error"), 0);
    desk.key("ctrl+q");
    EXPECT_EQ(desk.program().wait(20.0), 0) << desk.said();
}

TEST(Driven, ResizesHidesAndSavesAPicture) {
    TARN_NEEDS_DESK();
    Desk desk;
    desk.open(sample().scene, {"--wind", "5", "--samples", "1"});
    pause(3.0);
    desk.xdo("search --class tarn windowsize 1250 895");
    pause(4.0);
    const Picture large = desk.screenshot();
    const Rgb corner = mean(large, 1150, 650, 1240, 800); // was beyond the window
    EXPECT_GT(corner.r + corner.g + corner.b, 30.0);
    desk.xdo("search --class tarn windowsize 300 200");
    pause(2.0);
    desk.xdo("search --class tarn windowsize 1 1");
    pause(1.0);
    desk.xdo("search --class tarn windowsize 1000 860");
    pause(1.0);
    desk.xdo("search --class tarn windowunmap");
    pause(1.5);
    EXPECT_TRUE(desk.program().alive());
    desk.xdo("search --class tarn windowmap");
    pause(2.0);
    desk.focus();
    desk.key("F12");
    for (int i = 0; i < 300 && !fs::exists(desk / "tarn_001.json"); ++i)
        pause(0.2);
    // The picture, and how to make it again: the same but for a bit of dithering.
    ASSERT_TRUE(fs::exists(desk / "tarn_001.png"));
    const auto again = test_support::run("tarn render " + sample().scene + " --settings " +
                                         (desk / "tarn_001.json").string() + " -o " +
                                         (desk / "again.png").string());
    ASSERT_EQ(again.code, 0) << again.err;
    const Picture a = image::read_rgba(desk / "tarn_001.png"),
                  b = image::read_rgba(desk / "again.png");
    ASSERT_EQ(a.width_px, b.width_px);
    ASSERT_EQ(a.height_px, b.height_px);
    EXPECT_LT(difference(a, b, 0, 0, a.width_px, a.height_px), 0.1);
    desk.key("ctrl+q");
    EXPECT_EQ(desk.program().wait(20.0), 0) << desk.said();
    EXPECT_EQ(desk.count("gl error"), 0);
    EXPECT_EQ(desk.count("complaint"), 0);
}

TEST(Driven, HalfAMinuteOfRandomInput) {
    TARN_NEEDS_DESK();
    Desk desk;
    desk.open(sample().scene, {"--wind", "4"});
    ASSERT_TRUE(desk.wait_for("level", 30.0));
    std::mt19937 random(20261126);
    const auto any = [&](int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(random);
    };
    static const char* keys[] = {"w",      "a",      "s",         "d",           "e",
                                 "q",      "1",      "2",         "3",           "4",
                                 "Tab",    "F1",     "space",     "bracketleft", "Escape",
                                 "ctrl+z", "ctrl+y", "BackSpace", "shift+w",     "ctrl+c"};
    double first_mb = 0.0;
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    int steps = 0;
    while (seconds() < 30.0 && desk.program().alive()) {
        ++steps;
        const std::string at = text("mousemove ", any(1, 998), " ", any(1, 858), " ");
        switch (any(0, 5)) {
        case 0:
            desk.xdo(at + "click " + std::to_string(any(1, 5)));
            break;
        case 1:
            desk.xdo(at + text("mousedown ", 1 + 2 * any(0, 1), " sleep .1 mousemove ", any(1, 998),
                               " ", any(1, 858), " sleep .1 mouseup 1 mouseup 3"));
            break;
        case 2: {
            const std::string key = keys[any(0, int(std::size(keys)) - 1)];
            desk.xdo("keydown " + key + text(" sleep .", any(1, 4)) + " keyup " + key);
            break;
        }
        case 3:
            desk.xdo(at + "click --repeat 2 --delay 60 1");
            break;
        case 4: // into the panel
            desk.xdo(text("mousemove ", any(15, 320), " ", any(20, 800), " sleep .1 click 1"));
            break;
        default:
            desk.xdo("type --delay 20 '" + std::to_string(any(0, 9999)) + "'");
        }
        if (first_mb == 0.0 && seconds() > 12.0)
            first_mb = desk.program().resident_mb();
    }
    ASSERT_TRUE(desk.program().alive()) << desk.said();
    EXPECT_GT(steps, 20);
    EXPECT_EQ(desk.count("gl error"), 0);
    // Pictures of other sizes, other programs: some more, but not more and more.
    EXPECT_LT(desk.program().resident_mb(), first_mb + 400.0);
    desk.xdo("mouseup 1 mouseup 3 keyup ctrl keyup shift");
    desk.xdo("mousemove 990 400 click 1");
    desk.key("Escape");
    desk.key("Escape");
    desk.focus();
    for (int i = 0; i < 3 && desk.program().alive(); ++i)
        desk.key("ctrl+q", 2.0);
    EXPECT_EQ(desk.program().wait(30.0), 0) << desk.said();
}

TEST(Driven, AnotherSceneAndOneThatIsDeletedMeanwhile) {
    TARN_NEEDS_DESK();
    Desk desk;
    const std::string one = (desk / "one").string(), two = (desk / "two").string();
    fs::copy(sample().scene, one, fs::copy_options::recursive);
    fs::copy(sample().scene, two, fs::copy_options::recursive);
    desk.open(one);
    ASSERT_TRUE(desk.wait_for("level", 30.0));
    pause(1.0);
    std::vector<int> rows = headers(desk.screenshot());
    ASSERT_EQ(rows.size(), 12u);
    fs::remove_all(one); // while it is shown
    desk.hold("w", 1.0);
    EXPECT_TRUE(desk.program().alive());
    // A bookmark cannot be kept now, and the window says so: section "Cameras", its field, "keep".
    desk.click(150, rows[4]);
    const int field = rows[4] + 48; // below the row of cameras
    desk.click(100, field);
    desk.xdo("type here");
    pause(0.5);
    desk.click(275, field);
    EXPECT_TRUE(desk.wait_for("complaint", 5.0)) << "nothing was said about the bookmark";
    desk.click(150, rows[4]);
    // The other scene, by its name.
    rows = headers(desk.screenshot());
    desk.click(150, rows.back());
    desk.click(100, rows.back() + 24);
    desk.xdo("type --delay 15 " + two);
    pause(0.5);
    desk.click(275, rows.back() + 24, 4.0);
    EXPECT_EQ(desk.count("closed"), 1) << "the first window has gone";
    EXPECT_TRUE(desk.program().alive());
    pause(3.0);
    desk.focus();
    desk.key("ctrl+q");
    EXPECT_EQ(desk.program().wait(20.0), 0) << desk.said();
    EXPECT_EQ(desk.count("gl error"), 0);
}

TEST(Driven, ADemOpensByItself) {
    TARN_NEEDS_DESK();
    Desk desk;
    desk.open(sample().dem, {"--level", "1883"});
    pause(1.0);
    desk.key("ctrl+q");
    EXPECT_EQ(desk.program().wait(20.0), 0) << desk.said();
    for (const auto& entry : fs::directory_iterator(fs::temp_directory_path()))
        EXPECT_FALSE(entry.path().filename().string().starts_with("tarn-view-")) << entry.path();
}

TEST(Driven, WithoutADisplayItSaysWhatToDo) {
    const auto o = test_support::run("env -u DISPLAY -u WAYLAND_DISPLAY " +
                                     std::string(TARN_PROGRAM) + " view " + sample().scene);
    EXPECT_EQ(o.code, 1);
    EXPECT_NE(o.err.find("tarn render"), std::string::npos) << o.err;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
}
