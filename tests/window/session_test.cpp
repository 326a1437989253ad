#include "core/error.hpp"
#include "geo/frame.hpp"
#include "scene/presets.hpp"
#include "scene/samples.hpp"
#include "view/session.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <thread>

using namespace tarn;
using view::Options;
using view::Session;

namespace {

/// Levels of the bowl by its formulas.
class BowlLevels : public view::LevelControl {
public:
    double lowest_m() const override { return 0.1; }
    double highest_m() const override { return 40.0; }
    double usual_m() const override { return 10.0; }
    std::optional<double> spill_m() const override { return 39.0; }
    view::Figures figures(double level_m) const override {
        const double area = M_PI * 250'000.0 * level_m / 40.0;
        return {level_m, area, area * level_m / 2.0, level_m, level_m >= 39.0};
    }
    std::vector<view::Figures> curve(int count, double up_to_m) const override {
        std::vector<view::Figures> out;
        for (int i = 0; i < count; ++i)
            out.push_back(figures(0.1 + (up_to_m - 0.1) * i / (count - 1)));
        return out;
    }
    void fill(double level_m, scene::Scene& scene, bool shore) override {
        scene.water.offset_m += level_m - scene.lakes[0].level_m; // where it is wet it moves
        scene.lakes[0].level_m = level_m;
        shore_counted = shore;
    }
    bool shore_counted = false;
};

struct Seat {
    scene::Scene scene = scene::bowl(129);
    view::Services services;
    int kept = 0;
    Seat() {
        scene.frame = geo::local_frame({46.0, 8.0});
        services.make_view = [this](const Options& options, scene::Scene& s) {
            if (options.count("wind") && options.at("wind") == "much")
                throw Error("--wind: 'much' is no number");
            scene::View view;
            view.camera = scene::preset_camera(s, s.lakes[0], "overview", {0, 0, 1}, 1.5);
            view.lighting = scene::clear_sky({0, 0, 1});
            if (options.count("secchi"))
                s.optics.name = "by Secchi depth";
            return view;
        };
        services.command = [](const Options& options, const std::string&) {
            std::string out = "tarn render bowl";
            for (const auto& [name, value] : options)
                out += " --" + name + " " + value;
            return out;
        };
        services.open_levels = [] { return std::make_unique<BowlLevels>(); };
        services.save_cameras = [this](const std::vector<scene::NamedCamera>& cameras) {
            if (cameras.size() > 3)
                throw Error("the disk is full");
            kept = int(cameras.size());
        };
        services.read_layer = [](const std::string& path) -> scene::MapLayer {
            if (path != "track.gpx" && path != "flat.gpx")
                throw Error(path + ": no such file");
            const double z = path == "flat.gpx" ? std::nan("") : 2.0;
            return {"track", {{{{-50, 0, z}, {50, 0, z}}}, {{0, 10, z}}}, {"buoy"}};
        };
    }
};

void wait_for_levels(Session& session) {
    session.open_levels();
    for (int i = 0; i < 200 && !session.levels(); ++i) {
        session.advance(0.01);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ASSERT_TRUE(session.levels());
}

} // namespace

TEST(Session, WhatCannotBeChangesNothing) {
    Seat seat;
    Session session(seat.scene, seat.services, {});
    EXPECT_TRUE(session.set("wind", "5"));
    EXPECT_FALSE(session.set("wind", "much"));
    EXPECT_EQ(session.option("wind"), "5");
    ASSERT_EQ(session.messages.size(), 1u);
    EXPECT_TRUE(session.messages[0].error);
    EXPECT_NE(session.messages[0].text.find("no number"), std::string::npos);
    EXPECT_TRUE(session.set("wind", "")); // taken away
    EXPECT_EQ(session.options().count("wind"), 0u);
}

// A plan's options are taken back with it; what somebody changes meanwhile is theirs, and stays.
TEST(Session, APlanIsTakenBackAndOnesOwnChangesStay) {
    Seat seat;
    Session session(seat.scene, seat.services, {{"wind", "4"}, {"caustics", "mesh"}});
    view::Planned plan;
    plan.options = {{"waves", "calm"}, {"caustics", "off"}, {"no-shadows", "true"}};
    plan.reasons = {"waves: a plane"};
    session.take_plan(plan);
    EXPECT_EQ(session.option("waves"), "calm");
    EXPECT_EQ(session.option("caustics"), "off");
    EXPECT_TRUE(session.planned_for == session.flight.pose());
    plan.options = {{"caustics", "splat"}}; // the next says nothing of waves and shadows
    session.take_plan(plan);
    EXPECT_EQ(session.option("waves"), "");
    EXPECT_EQ(session.option("no-shadows"), "");
    EXPECT_EQ(session.option("caustics"), "splat");
    session.drop_plan();
    EXPECT_EQ(session.option("caustics"), "mesh");
    EXPECT_EQ(session.option("wind"), "4");
    EXPECT_TRUE(session.reasons.empty());
    session.take_plan(plan);
    session.set("caustics", "back");
    session.drop_plan();
    EXPECT_EQ(session.option("caustics"), "back");
}

TEST(Session, WaterGoesBackToTheScenes) {
    Seat seat;
    const std::string usual = seat.scene.optics.name;
    Session session(seat.scene, seat.services, {});
    session.set("secchi", "5");
    EXPECT_EQ(seat.scene.optics.name, "by Secchi depth");
    session.set("secchi", "");
    EXPECT_EQ(seat.scene.optics.name, usual);
    // Also where the window was opened with another one.
    Seat other;
    Session begun(other.scene, other.services, {{"secchi", "5"}});
    EXPECT_EQ(other.scene.optics.name, "by Secchi depth");
    begun.set("secchi", "");
    EXPECT_EQ(other.scene.optics.name, usual);
}

TEST(Session, EverythingIsInTheCommand) {
    Seat seat;
    Session session(seat.scene, seat.services, {{"time", "2026-06-21T09:30"}});
    session.set("wind", "5");
    wait_for_levels(session);
    session.set_level(8.0, true);
    const std::string command = seat.services.command(session.all_options(), "png");
    for (const char* part : {"--wind 5", "--time 2026-06-21T09:30", "--level 8.000", "--camera x="})
        EXPECT_NE(command.find(part), std::string::npos) << command;
    session.set_level(10.0, true); // as imported: nothing to say
    EXPECT_EQ(session.all_options().count("level"), 0u);
}

TEST(Session, TheLevelStaysWithinReach) {
    Seat seat;
    Session session(seat.scene, seat.services, {});
    session.set_level(5.0, true); // before it is ready: nothing
    EXPECT_FALSE(session.take_scene_changed());
    wait_for_levels(session);
    session.set_level(-100.0, false);
    EXPECT_EQ(session.level_m(), 0.1);
    EXPECT_TRUE(session.take_scene_changed());
    EXPECT_FALSE(session.take_scene_changed()); // once
    session.set_level(1000.0, true);
    EXPECT_EQ(session.level_m(), 40.0);
    EXPECT_TRUE(session.figures()->open_at_edge);
    EXPECT_EQ(session.curve().size(), 160u);
    EXPECT_NEAR(session.curve()[80].area_m2, M_PI * 250'000.0 * session.curve()[80].level_m / 40.0,
                1e-6);
}

TEST(Session, BookmarksAreKeptOrSaidNotToBe) {
    Seat seat;
    seat.scene.cameras.clear();
    Session session(seat.scene, seat.services, {});
    session.add_bookmark("");
    EXPECT_EQ(seat.kept, 0);
    for (const char* name : {"one", "two", "two", "three"})
        session.add_bookmark(name);
    EXPECT_EQ(seat.kept, 3);
    session.messages.clear();
    session.add_bookmark("four");
    ASSERT_EQ(session.messages.size(), 1u);
    EXPECT_NE(session.messages[0].text.find("the disk is full"), std::string::npos);
    session.flight.jump({{0, 0, 500}, 10, -20, 50});
    session.go_to("one");
    EXPECT_TRUE(session.flight.under_way());
}

TEST(Session, LayersAreDrapedAndNamed) {
    Seat seat;
    Session session(seat.scene, seat.services, {});
    session.add_layer("nothing.gpx");
    EXPECT_TRUE(session.layers.empty());
    session.add_layer("track.gpx");
    ASSERT_TRUE(seat.scene.drape);
    EXPECT_TRUE(session.take_map_changed());
    EXPECT_EQ(session.all_options().at("layers"), "track.gpx");
    // On the line it is nearest.
    const scene::Drape& d = *seat.scene.drape;
    const int c = int((0.0 - d.west_m) / d.texel_m), r = int((d.north_m - 0.0) / d.texel_m);
    EXPECT_GT(d.nearness[std::size_t(r) * std::size_t(d.cols) + std::size_t(c)], 200);
    session.remove_layer(0);
    EXPECT_FALSE(seat.scene.drape);
    EXPECT_EQ(session.all_options().count("layers"), 0u);
}

TEST(Session, LayersInSpaceHangWhereTheyShould) {
    Seat seat;
    Session session(seat.scene, seat.services, {{"layers-3d", "track.gpx"}});
    const double level = seat.scene.lakes.front().level_m;
    ASSERT_EQ(seat.scene.space_strokes.size(), 2u); // a line and a point
    EXPECT_FALSE(seat.scene.drape);
    EXPECT_EQ(seat.scene.space_strokes[0].from.z, 2.0);
    EXPECT_EQ(session.all_options().at("layers-3d"), "track.gpx");
    session.count_heights_from("level");
    EXPECT_EQ(seat.scene.space_strokes[0].from.z, level + 2.0);
    EXPECT_EQ(seat.scene.labels.at(0).place.z, level + 2.0);
    EXPECT_EQ(session.all_options().at("layers-3d-heights"), "level");
    // They go with the water.
    wait_for_levels(session);
    session.set_level(level - 1.0, true);
    EXPECT_NEAR(seat.scene.space_strokes[0].from.z, session.level_m() + 2.0, 1e-2);
    // Along the ground in pieces as long as a cell.
    session.count_heights_from("ground");
    EXPECT_GT(seat.scene.space_strokes.size(), 10u);
    for (const scene::SpaceStroke& s : seat.scene.space_strokes)
        EXPECT_NEAR(s.from.z, seat.scene.ground.elevation_m(s.from.x, s.from.y) + 2.0, 1e-9);
    // Without heights none can count from the datum; nothing changes.
    session.messages.clear();
    session.add_layer("flat.gpx", true); // at the ground
    ASSERT_EQ(session.layers.size(), 2u);
    session.count_heights_from("datum");
    EXPECT_EQ(session.option("layers-3d-heights"), "ground");
    ASSERT_FALSE(session.messages.empty());
    EXPECT_NE(session.messages.back().text.find("no height"), std::string::npos);
    session.remove_layer(1);
    session.count_heights_from("datum");
    session.add_layer("flat.gpx", true);
    EXPECT_EQ(session.layers.size(), 1u);
}

TEST(Session, SolarTimeGoesThereAndBack) {
    for (int day : {1, 59, 60, 172, 365})
        for (double hour : {0.0, 9.5, 23.75}) {
            const std::string words = view::format_solar({2026, day, hour});
            const auto back = view::parse_solar(words);
            ASSERT_TRUE(back) << words;
            EXPECT_EQ(back->day, day);
            EXPECT_NEAR(back->hour, hour, 0.5 / 60.0);
        }
    EXPECT_EQ(view::format_solar({2026, 172, 9.5}), "2026-06-21T09:30");
    EXPECT_FALSE(view::parse_solar("2026-06-21T09:30Z"));
    EXPECT_FALSE(view::parse_solar("2026-13-21T09:30"));
    EXPECT_FALSE(view::parse_solar("now"));
}

TEST(Session, TheSunGoesOn) {
    Seat seat;
    Session session(seat.scene, seat.services, {{"time", "2026-06-21T23:00"}});
    session.play_sun = true;
    EXPECT_TRUE(session.advance(4.0)); // two hours
    EXPECT_EQ(session.option("time"), "2026-06-21T01:00");
    for (int i = 0; i < 600; ++i) // at 300 pictures a second, too
        session.advance(1.0 / 300.0);
    EXPECT_EQ(session.option("time"), "2026-06-21T02:00");
    // South of the equator midsummer is in December.
    seat.scene.lakes[0].position = {-38.0, 176.0};
    Session south(seat.scene, seat.services, {});
    EXPECT_EQ(view::format_solar(south.usual_time()), "2026-12-21T09:30");
}
