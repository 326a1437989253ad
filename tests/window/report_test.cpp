// Measures the window and takes its pictures for docs/window.md; run by scripts/window-study.
#include "core/text.hpp"
#include "image/annotate.hpp"
#include "support/desk.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <thread>

using namespace tarn;
using test_support::Desk;
using test_support::pause;
namespace fs = std::filesystem;

namespace {

std::vector<double> values(const std::vector<nlohmann::json>& log, const std::string& event,
                           const std::string& name, double from_s = 0.0, double to_s = 1e9) {
    std::vector<double> out;
    for (const auto& line : log)
        if (line["event"] == event && line["t"] >= from_s && line["t"] <= to_s)
            out.push_back(line[name]);
    return out;
}

double median(std::vector<double> v) {
    if (v.empty())
        return 0.0;
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
}

Picture cut(const Picture& p, int x, int y, int width, int height) {
    Picture out{.width_px = width, .height_px = height, .channels = 3, .bytes = {}};
    out.bytes.assign(std::size_t(width) * std::size_t(height) * 3, 0);
    image::paste(out, p, -x, -y);
    return out;
}

double now_in(const Desk& desk) {
    const auto log = desk.log();
    return log.empty() ? 0.0 : log.back()["t"].get<double>();
}

} // namespace

TEST(WindowReport, FiguresAndPictures) {
    const char* folder = std::getenv("TARN_WINDOW_REPORT");
    if (!folder)
        GTEST_SKIP() << "scripts/window-study runs this";
    ASSERT_TRUE(test_support::has_desk());
    test_support::TempFolder t;
    const std::string scene = (t / "large").string();
    ASSERT_EQ(std::system((std::string(TARN_SAMPLES_PROGRAM) + " " + t.path().string() +
                           " caldera >/dev/null")
                              .c_str()),
              0);
    const auto made = test_support::run(
        "tarn import " + (t / "caldera.tif").string() +
        " --level 1883 --spacing 5.19 --name 'Crater Lake (reconstruction)' -o " + scene);
    ASSERT_EQ(made.code, 0) << made.err;
    const auto info =
        nlohmann::json::parse(test_support::run("tarn info " + scene + " --json").out);
    std::ostringstream table;
    std::string device, kept;
    const auto row = [&](const std::string& what, const std::string& figure) {
        table << "| " << what << " | " << figure << " |\n";
    };
    const auto moving = [&](Desk& desk, const std::string& what, const std::string& key) {
        desk.xdo("mousemove 600 300");
        const double from = now_in(desk);
        desk.hold(key, 7.0);
        pause(1.5);
        const double ms = median(values(desk.log(), "moving", "median_ms", from + 1.5));
        row(what, fixed(ms, 0) + " ms a frame, " + fixed(1000.0 / ms, 1) + " frames/s");
    };
    {
        Desk desk;
        desk.open(scene, {}, "800x600");
        device = desk.last("first picture")["text"];
        row("first picture, from the start of the command",
            fixed(desk.last("first picture")["start_ms"], 0) + " ms");
        ASSERT_TRUE(desk.wait_for("level", 60.0));
        row("water followed, the slider is ready",
            fixed(values(desk.log(), "level", "t").front(), 1) + " s");
        pause(6.0);
        moving(desk, "flying over calm water", "w");
        desk.key("3", 4.0);
        moving(desk, "flying, straight down", "e");
        desk.key("4", 4.0);
        moving(desk, "diving", "s");
        desk.key("1", 5.0);
        const double from = now_in(desk);
        desk.xdo("mousemove 200 70 mousedown 1");
        for (int x = 199; x > 180; --x) {
            desk.xdo(text("mousemove ", x, " 70"));
            pause(0.35);
        }
        desk.xdo("mouseup 1");
        pause(2.0);
        row("level dragged: refill",
            fixed(median(values(desk.log(), "level", "refill_ms", from)), 0) + " ms");
        row("level dragged: to the GPU",
            fixed(median(values(desk.log(), "upload", "ms", from)), 0) + " ms");
        row("level dragged: a frame, all in all",
            fixed(median(values(desk.log(), "moving", "median_ms", from)), 0) + " ms");
        desk.key("ctrl+q");
        EXPECT_EQ(desk.program().wait(20.0), 0);
        EXPECT_EQ(desk.count("gl error"), 0);
        kept = test_support::read_file(desk.log_path());
    }
    {
        Desk desk;
        desk.open(scene, {"--wind", "5"}, "800x600");
        pause(8.0);
        moving(desk, "flying over waves, which stand still meanwhile", "w");
        desk.key("space", 0.3);
        pause(6.0);
        const double from = now_in(desk);
        pause(5.0);
        const double ms = median(values(desk.log(), "moving", "median_ms", from));
        row("moving water", fixed(ms, 0) + " ms a frame, " + fixed(1000.0 / ms, 1) + " frames/s");
        desk.key("ctrl+q");
        EXPECT_EQ(desk.program().wait(20.0), 0);
    }
    {
        // Every section alone: the first two are open at first.
        Desk desk;
        desk.open(scene, {"--level", "1840", "--wind", "3"});
        ASSERT_TRUE(desk.wait_for("level", 60.0));
        pause(12.0);
        const Picture whole = desk.screenshot();
        image::write_png(fs::path(folder) / "window.png", cut(whole, 0, 0, 1000, 860), {});
        constexpr int high = 420;
        Picture sheet{.width_px = 4 * 340, .height_px = 2 * (high + 4), .channels = 3, .bytes = {}};
        sheet.bytes.assign(std::size_t(sheet.width_px) * std::size_t(sheet.height_px) * 3, 24);
        image::paste(sheet, cut(whole, 0, 30, 336, high), 0, 0);
        desk.click(150, 316); // sun
        desk.click(150, 46);  // water: all are shut, headers every 24 pixels
        const int sections[] = {2, 3, 4, 5, 7, 9, 6}; // the taller ones of those that are left
        for (int i = 0; i < 7; ++i) {
            const int y = 46 + 24 * sections[i];
            desk.click(150, y, 0.8);
            image::paste(sheet, cut(desk.screenshot(), 0, 30, 336, high), ((i + 1) % 4) * 340,
                         (i + 1) / 4 * (high + 4));
            desk.click(150, y, 0.5);
        }
        image::write_png(fs::path(folder) / "panels.png", sheet, {});
        desk.key("ctrl+q");
        EXPECT_EQ(desk.program().wait(20.0), 0);
    }
    {
        Desk desk;
        desk.open(scene, {"--wind", "3", "--camera", "dive"});
        pause(25.0);
        image::write_png(fs::path(folder) / "dive.png", cut(desk.screenshot(), 0, 0, 1000, 860),
                         {});
        desk.key("ctrl+q");
        EXPECT_EQ(desk.program().wait(20.0), 0);
    }
    std::ofstream out(fs::path(folder) / "figures.md");
    out << "# The window, measured\n\nWritten by `scripts/window-study`: " << device << ", "
        << std::thread::hardware_concurrency()
        << " threads, window of 800 x 600, the caldera sample on "
        << info["grid"]["cols"].get<int>() << " x " << info["grid"]["rows"].get<int>()
        << " nodes. Frames are medians of the window's whole "
        << "loop while a key is held.\n\n| | |\n| --- | --- |\n"
        << table.str() << "\nThe log of the first of these sessions: [session.log](session.log).\n";
    std::ofstream(fs::path(folder) / "session.log") << kept;
}
