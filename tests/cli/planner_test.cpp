// Budgets and the bench, as typed.
#include "support/bowl_scene.hpp"

#include <nlohmann/json.hpp>

using namespace tarn;
using test_support::expect_one_line;
using test_support::Outcome;
using test_support::run;
using test_support::shared;
using test_support::TempFolder;

TEST(Planner, ExplainsWhatItLeavesOutAndTheSidecarDrawsTheSamePicture) {
    const TempFolder t;
    const std::string a = (t / "a.exr").string(), b = (t / "b.exr").string();
    const Outcome o = run("tarn render " + shared().scene +
                          " --camera shore --size 160x120 --samples 1 --max-error 0.02 --explain "
                          "--sidecar -o " +
                          a);
    EXPECT_EQ(o.code, 0) << o.err;
    for (const char* words : {"shadows", "reflection", "refraction", "the same by hand:", "trials"})
        EXPECT_NE(o.out.find(words), std::string::npos) << o.out;
    EXPECT_EQ(o.out.find("CANNOT"), std::string::npos) << o.out;
    const std::string sidecar = test_support::read_file(t / "a.json");
    EXPECT_EQ(sidecar.find("\"max-error\""), std::string::npos)
        << "another plan might be made from it: " << sidecar;
    ASSERT_EQ(
        run("tarn render " + shared().scene + " --settings " + (t / "a.json").string() + " -o " + b)
            .code,
        0);
    const Outcome same = run("tarn render " + shared().scene + " --settings " +
                             (t / "a.json").string() + " --against " + a + " -o " + b);
    EXPECT_NE(same.out.find("mean 0.0000 %"), std::string::npos) << same.out << same.err;
}

TEST(Planner, BudgetsThatCannotBeAreToldBeforeAnyWork) {
    const std::string render = "tarn render " + shared().scene + " --size 64x48 -o /tmp/never.png ";
    expect_one_line(render + "--max-error 0", 1, "must be in [0.0001, 10]");
    expect_one_line(render + "--frame-time -3", 1, "must be in [0.01, 1e7]");
    expect_one_line(render + "--explain", 1, "need something to plan for");
    expect_one_line(render + "--max-error 0.01 --reference", 1, "cannot be planned");
    const TempFolder t;
    const Outcome o =
        run("tarn render " + shared().scene + " --size 64x48 --samples 1 --frame-time 0.01 -o " +
            (t / "a.png").string());
    EXPECT_EQ(o.code, 0);
    EXPECT_NE(o.err.find("cannot be kept"), std::string::npos) << o.err;
}

// A small run of the whole bench; its numbers stay in the build folder (bench_small.json).
TEST(Bench, TheMatrixIsMeasuredReportedAndComparedWithItself) {
    const TempFolder t;
    const std::string json =
        (std::filesystem::path(TARN_PROGRAM).parent_path() / "bench_small.json").string();
    const Outcome o = run(
        "tarn bench bowl --wind 0 --views shore,dive-up --size 96x72,48x36 --samples 1 --runs 1 "
        "--max-error 0.02 --cache " +
        (t / "cache").string() + " --json " + json + " --report " + (t / "report").string());
    ASSERT_EQ(o.code, 0) << o.err;
    const auto all = nlohmann::json::parse(test_support::read_file(json));
    std::size_t planned = 0, judged = 0;
    for (const auto& r : all.at("results")) {
        const double error = r.at("error").at("mean");
        EXPECT_GT(r.at("time_ms").get<double>(), 0.0);
        EXPECT_GT(r.at("passes_ms").size(), 1u);
        const std::string variant = r.at("settings").at("variant");
        if (variant == "best")
            EXPECT_EQ(error, 0.0);
        planned += variant.find("planned") == 0;
        if (variant.find("planned") == 0)
            EXPECT_LE(error, 0.02);
        if (r.contains("error_from_reference") && variant == "best") {
            ++judged;
            EXPECT_LT(r.at("error_from_reference").at("mean").get<double>(), 1e-3);
        }
    }
    EXPECT_EQ(planned, 4u);
    EXPECT_EQ(judged, 2u);
    const std::string report = test_support::read_file(t / "report/report.md");
    for (const char* words : {"## bowl, calm", "trade_bowl__calm.png",
                              "Share of the picture's time", "cone-steps", "48x36"})
        EXPECT_NE(report.find(words), std::string::npos) << words;
    EXPECT_GT(std::filesystem::file_size(t / "report/trade_bowl__calm.png"), 10'000u);
    const Outcome same = run("tarn bench --from " + json + " --against " + json);
    EXPECT_NE(same.out.find(" rows compared, 0 differences"), std::string::npos) << same.out;
    // A run that errs more and takes longer is noticed.
    nlohmann::json worse = all;
    for (auto& r : worse.at("results"))
        if (r.at("settings").at("variant") == "Schlick") {
            r["time_ms"] = 100.0 + 3.0 * r.at("time_ms").get<double>();
            r["error"]["mean"] = 0.5;
        }
    std::ofstream(t / "worse.json") << worse.dump();
    const Outcome noticed =
        run("tarn bench --from " + (t / "worse.json").string() + " --against " + json);
    EXPECT_NE(noticed.out.find("(slower)"), std::string::npos) << noticed.out;
    EXPECT_NE(noticed.out.find("(worse)"), std::string::npos) << noticed.out;
}

TEST(Bench, TheMatrixRefusesWhatItCannotMeasure) {
    expect_one_line("tarn bench nowhere", 1, "nowhere: is no scene");
    expect_one_line("tarn bench mountain:5", 1, "must be in [17, 16384]");
    expect_one_line("tarn bench bowl --size 0x3", 1, "width is 0");
    expect_one_line("tarn bench bowl --views moon --wind 0", 1, "has none called 'moon'");
    expect_one_line("tarn bench bowl --against /nowhere.json", 1, "no such file");
    expect_one_line("tarn bench bowl --chart a.png", 1, "belong to --intersection");
    expect_one_line("tarn bench a b --intersection", 1, "takes one scene");
}
