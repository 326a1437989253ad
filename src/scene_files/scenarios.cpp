#include "scene_files/scenarios.hpp"

#include "core/text.hpp"

#include <nlohmann/json.hpp>

namespace tarn::scene_files {

namespace {

std::string number(const std::optional<double>& v, int digits) {
    return v ? fixed(*v, digits) : std::string();
}

/// RFC 4180.
std::string field(const std::string& word) {
    if (word.find_first_of(",\"\n") == std::string::npos)
        return word;
    std::string out = "\"";
    for (const char c : word)
        out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

} // namespace

std::string scenarios_csv(const Scenarios& scenarios) {
    std::string out = "level_m,camera,time,picture,area_m2,true_area_m2,volume_m3,true_volume_m3,"
                      "max_depth_m,mean_depth_m,shoreline_m,islands,exposed_bed_m2,flooded_m2,"
                      "open_at_edge\n";
    for (const Scenario& s : scenarios.rows)
        out += text(s.level_m, ",", field(s.camera), ",", field(s.time), ",", field(s.picture), ",",
                    fixed(s.area_m2, 4), ",", fixed(s.true_area_m2, 4), ",", number(s.volume_m3, 4),
                    ",", number(s.true_volume_m3, 4), ",", number(s.max_depth_m, 4), ",",
                    number(s.mean_depth_m, 4), ",", fixed(s.shoreline_m, 2), ",", s.islands, ",",
                    fixed(s.exposed_bed_m2, 4), ",", fixed(s.flooded_m2, 4), ",",
                    s.open_at_edge ? "true" : "false", "\n");
    return out;
}

std::string scenarios_json(const Scenarios& scenarios) {
    using json = nlohmann::ordered_json;
    const auto number_or_null = [](const std::optional<double>& v) {
        return v ? json(*v) : json(nullptr);
    };
    json rows = json::array();
    for (const Scenario& s : scenarios.rows)
        rows.push_back({{"level_m", s.level_m},
                        {"camera", s.camera},
                        {"time", s.time},
                        {"picture", s.picture},
                        {"done", s.done},
                        {"area_m2", s.area_m2},
                        {"true_area_m2", s.true_area_m2},
                        {"volume_m3", number_or_null(s.volume_m3)},
                        {"true_volume_m3", number_or_null(s.true_volume_m3)},
                        {"max_depth_m", number_or_null(s.max_depth_m)},
                        {"mean_depth_m", number_or_null(s.mean_depth_m)},
                        {"shoreline_m", s.shoreline_m},
                        {"islands", s.islands},
                        {"exposed_bed_m2", s.exposed_bed_m2},
                        {"flooded_m2", s.flooded_m2},
                        {"open_at_edge", s.open_at_edge},
                        {"command", s.command}});
    const LakeRecord& lake = scenarios.lake;
    return json{{"scene", scenarios.scene},
                {"lake",
                 {{"id", lake.id},
                  {"name", lake.name},
                  {"level_m", lake.level_m},
                  {"bed", to_string(lake.bed)}}},
                {"scenarios", rows}}
               .dump(2, ' ', false, json::error_handler_t::replace) +
           "\n";
}

} // namespace tarn::scene_files
