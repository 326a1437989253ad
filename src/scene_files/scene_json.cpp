#include "scene_files/scene_json.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace tarn::scene_files {

using json = nlohmann::ordered_json;

namespace {

// --- writing ------------------------------------------------------------------------------------

json vector_of(const glm::dvec3& v) { return json::array({v.x, v.y, v.z}); }

template <class T>
json or_null(const std::optional<T>& value) {
    return value ? json(*value) : json(nullptr);
}

json spill_json(const std::optional<LakeSpill>& spill) {
    if (!spill)
        return nullptr;
    return {{"level_m", spill->level_m},
            {"lat_deg", spill->pass.lat_deg},
            {"lon_deg", spill->pass.lon_deg},
            {"at_surface", spill->at_surface}};
}

json nodes_json(const std::vector<Node>& nodes) {
    json out = json::array();
    for (const Node n : nodes)
        out.push_back({n.col, n.row});
    return out;
}

json lake_json(const LakeRecord& lake) {
    return {{"id", lake.id},
            {"name", lake.name},
            {"kind", lake.sea ? "sea" : "lake"},
            {"level_m", lake.level_m},
            {"bed", to_string(lake.bed)},
            {"area_m2", lake.area_m2},
            {"true_area_m2", lake.true_area_m2},
            {"volume_m3", or_null(lake.volume_m3)},
            {"true_volume_m3", or_null(lake.true_volume_m3)},
            {"max_depth_m", or_null(lake.max_depth_m)},
            {"mean_depth_m", or_null(lake.mean_depth_m)},
            {"shoreline_m", lake.shoreline_m},
            {"islands", lake.islands},
            {"open_at_edge", lake.open_at_edge},
            {"spill", spill_json(lake.spill)},
            {"flat_share", lake.flat_share},
            {"lat_deg", lake.position.lat_deg},
            {"lon_deg", lake.position.lon_deg},
            {"seed_node", {lake.seed.col, lake.seed.row}},
            {"part_nodes", nodes_json(lake.parts)},
            {"box_nodes",
             {lake.west_north.col, lake.west_north.row, lake.east_south.col, lake.east_south.row}}};
}

// --- reading ------------------------------------------------------------------------------------

/// A JSON value that knows where it stands, so that every complaint names its field.
class Field {
public:
    Field(const json& value, std::string path) : value_(value), path_(std::move(path)) {}

    Field operator[](const char* key) const {
        if (!value_.is_object() || !value_.contains(key))
            throw Error(where(key) + " is missing",
                        "import the scene again, or restore scene.json");
        return {value_.at(key), where(key)};
    }
    bool has(const char* key) const {
        return value_.is_object() && value_.contains(key) && !value_.at(key).is_null();
    }
    Field at(std::size_t index) const { return {value_.at(index), text(path_, "[", index, "]")}; }
    std::size_t array_size(std::size_t least, std::size_t most) const {
        if (!value_.is_array() || value_.size() < least || value_.size() > most)
            throw Error(text(path_, " must be a list of ", least, " to ", most, " entries"));
        return value_.size();
    }
    double number(double low, double high) const {
        if (!value_.is_number())
            throw Error(path_ + " must be a number");
        const double v = value_.get<double>();
        if (!(v >= low && v <= high))
            throw Error(text(path_, " is ", v, ", must be in [", low, ", ", high, "]"));
        return v;
    }
    std::optional<double> number_or_null(double low, double high) const {
        if (value_.is_null())
            return {};
        return number(low, high);
    }
    int integer(int low, int high) const {
        if (!value_.is_number_integer())
            throw Error(path_ + " must be a whole number");
        // Compared as double: a 64-bit value must not wrap around into the range.
        return static_cast<int>(number(low, high));
    }
    std::string string() const {
        if (!value_.is_string())
            throw Error(path_ + " must be a text");
        return value_.get<std::string>();
    }
    bool boolean() const {
        if (!value_.is_boolean())
            throw Error(path_ + " must be true or false");
        return value_.get<bool>();
    }
    glm::dvec3 vector(double low, double high) const {
        array_size(3, 3);
        return {at(0).number(low, high), at(1).number(low, high), at(2).number(low, high)};
    }
    Node node(std::size_t first, GridSize size) const {
        return {at(first).integer(0, size.cols - 1), at(first + 1).integer(0, size.rows - 1)};
    }
    /// A name in the scene folder: nothing that could lead elsewhere.
    std::string file_name() const {
        const std::string name = string();
        if (name.empty() || name.size() > 200 || name[0] == '.' ||
            name.find_first_of("/\\") != std::string::npos || name.find('\0') != std::string::npos)
            throw Error(path_ + " is '" + name +
                        "', which is no plain file name in the scene folder");
        return name;
    }

private:
    std::string where(const char* key) const { return path_.empty() ? key : path_ + "." + key; }
    const json& value_;
    std::string path_;
};

constexpr double huge = 1e15;

LakeRecord read_lake(const Field& f, GridSize size) {
    LakeRecord lake;
    lake.id = f["id"].integer(0, 1'000'000'000);
    lake.name = f["name"].string();
    lake.level_m = f["level_m"].number(-12'000, 12'000);
    lake.bed = bed_from_string(f["bed"].string());
    lake.area_m2 = f["area_m2"].number(0, huge);
    lake.true_area_m2 = f["true_area_m2"].number(0, huge);
    const std::string kind = f["kind"].string();
    if (kind != "lake" && kind != "sea")
        throw Error("kind is '" + kind + "', must be lake or sea", "import the scene again");
    lake.sea = kind == "sea";
    lake.volume_m3 = f["volume_m3"].number_or_null(0, huge);
    lake.true_volume_m3 = f["true_volume_m3"].number_or_null(0, huge);
    lake.max_depth_m = f["max_depth_m"].number_or_null(0, 30'000);
    lake.mean_depth_m = f["mean_depth_m"].number_or_null(0, 30'000);
    lake.shoreline_m = f["shoreline_m"].number(0, huge);
    lake.islands = f["islands"].integer(0, 2'000'000'000);
    lake.open_at_edge = f["open_at_edge"].boolean();
    if (f.has("spill")) {
        const Field spill = f["spill"];
        lake.spill = LakeSpill{
            .level_m = spill["level_m"].number(-12'000, 12'000),
            .pass = {spill["lat_deg"].number(-90, 90), spill["lon_deg"].number(-540, 540)},
            .at_surface = spill["at_surface"].boolean()};
    }
    lake.flat_share = f["flat_share"].number(0, 1);
    lake.position = {f["lat_deg"].number(-90, 90), f["lon_deg"].number(-540, 540)};
    f["seed_node"].array_size(2, 2);
    lake.seed = f["seed_node"].node(0, size);
    const Field parts = f["part_nodes"];
    for (std::size_t i = 0, n = parts.array_size(0, 1'000'000); i < n; ++i) {
        parts.at(i).array_size(2, 2);
        lake.parts.push_back(parts.at(i).node(0, size));
    }
    f["box_nodes"].array_size(4, 4);
    lake.west_north = f["box_nodes"].node(0, size);
    lake.east_south = f["box_nodes"].node(2, size);
    return lake;
}

void read_heights(const Field& f, const Field& grid, GridSize size, Heightfield& out) {
    out.codes.size = size;
    out.spacing_m = grid["spacing_m"].number(1e-4, 1e6);
    out.west_m = grid["west_m"].number(-1e8, 1e8);
    out.north_m = grid["north_m"].number(-1e8, 1e8);
    out.offset_m = f["offset_m"].number(-1e5, 1e5);
    out.scale_m = f["scale_m"].number(1e-9, 1e4);
}

/// [wavelength nm, a, b, b_b] of each.
json bands_json(const scene::WaterOptics& optics) {
    json out = json::array();
    for (const scene::WaterBand& band : optics.bands)
        out.push_back({band.wavelength_nm, band.absorption_per_m, band.scattering_per_m,
                       band.backscattering_per_m});
    return out;
}

json wave_settings_json(const waves::Settings& s) {
    json out = {{"model", waves::name_of(s.model)},
                {"wind_m_per_s", s.wind_m_per_s},
                {"wind_from_deg", s.wind_from_deg},
                {"time_s", s.time_s},
                {"loop_s", s.loop_s},
                {"choppiness", s.choppiness},
                {"cascades", s.cascades},
                {"texels", s.texels},
                {"seed", s.seed},
                {"spreading", s.spreading},
                {"fetch_m", or_null(s.fetch_m)},
                {"depth_m", or_null(s.depth_m)},
                {"shortest_m", or_null(s.shortest_m)},
                {"patch_m", or_null(s.patch_m)},
                {"rain_drops_per_m2_s", s.ripples.rain_drops_per_m2_s},
                {"drop_height_m", s.ripples.drop_height_m}};
    json list = json::array();
    for (const waves::PlaneWave& w : s.list)
        list.push_back({{"amplitude_m", w.amplitude_m},
                        {"length_m", w.length_m},
                        {"towards_deg", w.towards_deg},
                        {"phase_rad", w.phase_rad}});
    out["list"] = list;
    json pokes = json::array();
    for (const waves::Poke& p : s.ripples.pokes)
        pokes.push_back({{"x_m", p.x_m},
                         {"y_m", p.y_m},
                         {"height_m", p.height_m},
                         {"radius_m", p.radius_m},
                         {"time_s", p.time_s}});
    out["pokes"] = pokes;
    return out;
}

waves::Settings read_waves(const Field& f) {
    waves::Settings s;
    s.model = waves::model_from_name(f["model"].string());
    s.wind_m_per_s = f["wind_m_per_s"].number(0, 100);
    s.wind_from_deg = f["wind_from_deg"].number(-1e4, 1e4);
    s.time_s = f["time_s"].number(-1e10, 1e10);
    s.loop_s = f["loop_s"].number(0.01, 1e5);
    s.choppiness = f["choppiness"].number(0, 2);
    s.cascades = f["cascades"].integer(1, 4);
    s.texels = f["texels"].integer(128, 2048);
    s.seed = std::uint32_t(f["seed"].number(0, 4294967295.0));
    s.spreading = f["spreading"].number(0, 20);
    s.fetch_m = f["fetch_m"].number_or_null(1, 1e6);
    s.depth_m = f["depth_m"].number_or_null(0, 1e4);
    s.shortest_m = f["shortest_m"].number_or_null(0.017, 1e3);
    s.patch_m = f["patch_m"].number_or_null(0.5, 1e5);
    s.ripples.rain_drops_per_m2_s = f["rain_drops_per_m2_s"].number(0, 1e4);
    s.ripples.drop_height_m = f["drop_height_m"].number(0, 0.1);
    const Field pokes = f["pokes"];
    for (std::size_t i = 0, n = pokes.array_size(0, 16); i < n; ++i) {
        const Field p = pokes.at(i);
        s.ripples.pokes.push_back({p["x_m"].number(-1e8, 1e8), p["y_m"].number(-1e8, 1e8),
                                   p["height_m"].number(-5, 5), p["radius_m"].number(0.05, 20),
                                   p["time_s"].number(-1e10, 1e10)});
    }
    const Field list = f["list"];
    for (std::size_t i = 0, n = list.array_size(0, 4096); i < n; ++i) {
        const Field w = list.at(i);
        s.list.push_back({w["amplitude_m"].number(0, 50), w["length_m"].number(0.002, 1e4),
                          w["towards_deg"].number(-1e4, 1e4), w["phase_rad"].number(-1e6, 1e6)});
    }
    s.validate();
    return s;
}

ImportReport read_report(const Field& f) {
    ImportReport r;
    r.command = f["command"].string();
    r.created = f["created"].string();
    r.tarn_version = f["tarn_version"].string();
    r.resampling = f["resampling"].string();
    const auto count = [&](const char* key) {
        return static_cast<std::uint64_t>(f[key].number(0, 1e12));
    };
    r.nodes = count("nodes");
    r.void_nodes = count("void_nodes");
    r.filled_nodes = count("filled_nodes");
    r.outside_nodes = count("outside_nodes");
    r.flat_share = f["flat_share"].number(0, 1);
    const Field inputs = f["inputs"];
    for (std::size_t i = 0, n = inputs.array_size(0, 100'000); i < n; ++i) {
        const Field in = inputs.at(i);
        r.inputs.push_back({in["name"].string(), in["role"].string(), in["format"].string(),
                            in["crs"].string(), in["vertical_datum"].string(), in["size"].string(),
                            in["crc32"].string()});
    }
    const Field notes = f["notes"];
    for (std::size_t i = 0, n = notes.array_size(0, 100'000); i < n; ++i)
        r.notes.push_back(notes.at(i).string());
    return r;
}

geo::Frame read_frame(const Field& f) {
    geo::Frame frame;
    frame.semi_major_m = f["semi_major_m"].number(1e6, 1e7);
    frame.inverse_flattening = f["inverse_flattening"].number(0, 1e9);
    frame.lat0_deg = f["lat0_deg"].number(-90, 90);
    frame.lon0_deg = f["lon0_deg"].number(-540, 540);
    frame.scale0 = f["scale0"].number(0.5, 2);
    frame.false_easting_m = f["false_easting_m"].number(-1e9, 1e9);
    frame.false_northing_m = f["false_northing_m"].number(-1e9, 1e9);
    frame.origin_easting_m = f["origin_easting_m"].number(-1e9, 1e9);
    frame.origin_northing_m = f["origin_northing_m"].number(-1e9, 1e9);
    frame.vertical_datum = f["vertical_datum"].string();
    frame.proj = f["proj"].string();
    frame.wkt = f["wkt"].string();
    if (f.has("datum_shift")) {
        const Field d = f["datum_shift"];
        geo::DatumShift& shift = frame.datum_shift;
        shift.side = d["side"].integer(2, 257);
        shift.reach_m = d["reach_m"].number(1e-3, 1e8);
        const auto count = std::size_t(shift.side) * std::size_t(shift.side);
        for (const auto& [name, values] :
             {std::pair{"east_m", &shift.east_m}, std::pair{"north_m", &shift.north_m}}) {
            const Field list = d[name];
            list.array_size(count, count);
            for (std::size_t k = 0; k < count; ++k)
                values->push_back(list.at(k).number(-1e4, 1e4));
        }
    }
    return frame;
}

json cameras_json(const std::vector<scene::NamedCamera>& list) {
    json cameras = json::array();
    for (const scene::NamedCamera& c : list)
        cameras.push_back({{"name", c.name},
                           {"position_m", vector_of(c.camera.position)},
                           {"direction", vector_of(c.camera.forward)},
                           {"up", vector_of(c.camera.up)},
                           {"fov_deg", c.camera.fov_deg}});
    return cameras;
}

json report_json(const ImportReport& r) {
    json inputs = json::array();
    for (const ImportInput& in : r.inputs)
        inputs.push_back({{"name", in.name},
                          {"role", in.role},
                          {"format", in.format},
                          {"crs", in.crs},
                          {"vertical_datum", in.vertical},
                          {"size", in.size},
                          {"crc32", in.checksum}});
    return {{"command", r.command},
            {"created", r.created},
            {"tarn_version", r.tarn_version},
            {"inputs", inputs},
            {"resampling", r.resampling},
            {"nodes", r.nodes},
            {"void_nodes", r.void_nodes},
            {"filled_nodes", r.filled_nodes},
            {"outside_nodes", r.outside_nodes},
            {"flat_share", r.flat_share},
            {"notes", r.notes}};
}

} // namespace

std::string detection_json(const std::vector<LakeRecord>& lakes, const ImportReport& report) {
    json out = {{"lakes", json::array()}, {"import", report_json(report)}};
    for (const LakeRecord& lake : lakes)
        out["lakes"].push_back(lake_json(lake));
    return out.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

std::string stages_json(const LakeRecord& lake, const std::optional<LakeSpill>& spill,
                        const std::vector<StageRow>& rows) {
    json out = {{"lake", lake_json(lake)}, {"spill", spill_json(spill)}, {"stages", json::array()}};
    for (const StageRow& r : rows)
        out["stages"].push_back({{"level_m", r.level_m},
                                 {"area_m2", r.area_m2},
                                 {"true_area_m2", r.true_area_m2},
                                 {"volume_m3", or_null(r.volume_m3)},
                                 {"true_volume_m3", or_null(r.true_volume_m3)},
                                 {"max_depth_m", or_null(r.max_depth_m)},
                                 {"mean_depth_m", or_null(r.mean_depth_m)},
                                 {"shoreline_m", r.shoreline_m},
                                 {"islands", r.islands},
                                 {"pools", r.pools},
                                 {"open_at_edge", r.open_at_edge}});
    return out.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

std::string waves_json(const WavesReport& r) {
    const auto numbers = [](const waves::SeaReport& s) {
        return json{{"fetch_m", s.fetch_m},
                    {"depth_m", s.depth_m},
                    {"significant_height_m", s.significant_height_m},
                    {"peak_period_s", s.peak_period_s},
                    {"peak_length_m", s.peak_length_m},
                    {"mean_square_slope", s.mean_square_slope}};
    };
    json out = {{"model", r.sea.model},
                {"wind_m_per_s", r.sea.wind_m_per_s},
                {"wind_from_deg", r.sea.wind_from_deg}};
    json drawn = numbers(r.sea);
    drawn["drawn_height_m"] = r.sea.drawn_height_m;
    drawn["drawn_slope"] = r.sea.drawn_slope;
    drawn["longest_m"] = r.sea.longest_m;
    drawn["shortest_m"] = r.sea.shortest_m;
    drawn["choppiness"] = r.sea.choppiness;
    drawn["notes"] = r.sea.notes;
    drawn["texels"] = r.texels;
    json cascades = json::array(), lakes = json::array(), fetches = json::array(),
         rose = json::array();
    for (const auto& c : r.cascades)
        cascades.push_back({{"patch_m", c.patch_m},
                            {"shortest_m", c.shortest_m},
                            {"longest_m", c.longest_m},
                            {"significant_height_m", c.significant_height_m},
                            {"mean_square_slope", c.mean_square_slope},
                            {"choppiness", c.choppiness}});
    drawn["cascades"] = cascades;
    out["drawn"] = drawn;
    for (const LakeWaves& lake : r.lakes) {
        json one = {{"id", lake.id}, {"name", lake.name}};
        one.update(numbers(lake.report));
        lakes.push_back(one);
    }
    out["lakes"] = lakes;
    for (const FetchRow& row : r.fetches)
        fetches.push_back({{"wind_from_deg", row.from_deg}, {"fetch_m", row.fetch_m}});
    out["fetches"] = fetches;
    for (const auto& row : r.rose)
        rose.push_back({{"wind_from_deg", row.from_deg},
                        {"wind_m_per_s", row.speed_m_per_s},
                        {"share", row.share},
                        {"significant_height_m", row.significant_height_m},
                        {"peak_period_s", row.peak_period_s}});
    out["wind_rose"] = rose;
    return out.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

std::string to_json(const scene::Scene& scene, const FileNames& files) {
    const geo::Frame& f = scene.frame;
    json frame = {{"semi_major_m", f.semi_major_m},
                  {"inverse_flattening", f.inverse_flattening},
                  {"lat0_deg", f.lat0_deg},
                  {"lon0_deg", f.lon0_deg},
                  {"scale0", f.scale0},
                  {"false_easting_m", f.false_easting_m},
                  {"false_northing_m", f.false_northing_m},
                  {"origin_easting_m", f.origin_easting_m},
                  {"origin_northing_m", f.origin_northing_m},
                  {"vertical_datum", f.vertical_datum},
                  {"proj", f.proj},
                  {"wkt", f.wkt}};
    if (!(f.datum_shift == geo::DatumShift{}))
        frame["datum_shift"] = {{"side", f.datum_shift.side},
                                {"reach_m", f.datum_shift.reach_m},
                                {"east_m", f.datum_shift.east_m},
                                {"north_m", f.datum_shift.north_m}};
    const auto heights = [](const Heightfield& h, const std::string& file) {
        return json{{"file", file}, {"offset_m", h.offset_m}, {"scale_m", h.scale_m}};
    };
    json lakes = json::array();
    for (const LakeRecord& lake : scene.lakes)
        lakes.push_back(lake_json(lake));
    json out = {
        {"format", "tarn scene"},
        {"version", schema_version},
        {"frame", frame},
        {"grid",
         {{"cols", scene.ground.size().cols},
          {"rows", scene.ground.size().rows},
          {"spacing_m", scene.ground.spacing_m},
          {"west_m", scene.ground.west_m},
          {"north_m", scene.ground.north_m}}},
        {"ground", heights(scene.ground, files.ground)},
        {"water", heights(scene.water, files.water)},
        {"heights", {{"file", files.heights}}},
        {"lakes", lakes},
        {"optics",
         {{"name", scene.optics.name},
          {"absorption_per_m", vector_of(scene.optics.absorption_per_m)},
          {"backscattering_per_m", vector_of(scene.optics.backscattering_per_m)},
          {"index", scene.optics.index},
          {"bands", bands_json(scene.optics)}}},
        {"waves", wave_settings_json(scene.waves)},
        {"look",
         {{"tree_line_m", scene.look.tree_line_m}, {"snow_line_m", scene.look.snow_line_m}}},
        {"cameras", cameras_json(scene.cameras)}};
    if (!files.safety_ground.empty())
        out["safety_ground"] = {{"file", files.safety_ground}, {"ground_sum", files.safety_sum}};
    if (scene.ortho)
        out["ortho"] = {{"file", files.ortho},
                        {"width_px", scene.ortho->picture.width_px},
                        {"height_px", scene.ortho->picture.height_px},
                        {"west_m", scene.ortho->west_m},
                        {"north_m", scene.ortho->north_m},
                        {"spacing_m", scene.ortho->spacing_m}};
    out["import"] = report_json(scene.report);
    return out.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

std::string with_cameras(const std::string& text, const std::vector<scene::NamedCamera>& cameras) {
    json root = json::parse(text, nullptr, false);
    if (!root.is_object())
        throw Error("scene.json is damaged", "import the scene again");
    root["cameras"] = cameras_json(cameras);
    return root.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

scene::Scene from_json(const std::string& source, FileNames& files) {
    json parsed;
    try {
        parsed = json::parse(source);
    } catch (const json::exception& error) {
        throw Error(std::string("is not valid JSON (") + error.what() + ")",
                    "import the scene again, or restore scene.json");
    }
    const Field root(parsed, "");
    if (root["format"].string() != "tarn scene")
        throw Error("format is not 'tarn scene'", "name a folder that tarn import made");
    const int version = root["version"].integer(0, 1'000'000);
    if (version != schema_version)
        throw Error(text("version is ", version, ", this tarn reads version ", schema_version),
                    "import the scene again with this tarn");

    scene::Scene scene;
    scene.frame = read_frame(root["frame"]);
    const Field grid = root["grid"];
    const GridSize size{grid["cols"].integer(2, 65536), grid["rows"].integer(2, 65536)};
    read_heights(root["ground"], grid, size, scene.ground);
    read_heights(root["water"], grid, size, scene.water);
    files.ground = root["ground"]["file"].file_name();
    files.water = root["water"]["file"].file_name();
    files.heights = root["heights"]["file"].file_name();
    if (root.has("safety_ground")) {
        files.safety_ground = root["safety_ground"]["file"].file_name();
        files.safety_sum = root["safety_ground"]["ground_sum"].string();
    }
    const Field lakes = root["lakes"];
    for (std::size_t i = 0, n = lakes.array_size(1, 100'000); i < n; ++i)
        scene.lakes.push_back(read_lake(lakes.at(i), size));
    const Field optics = root["optics"];
    scene.optics.name = optics["name"].string();
    scene.optics.absorption_per_m = optics["absorption_per_m"].vector(0, 100);
    scene.optics.backscattering_per_m = optics["backscattering_per_m"].vector(0, 100);
    scene.optics.index = optics["index"].number(1, 3);
    if (optics.has("bands")) { // folders of an earlier tarn have three channels only
        const Field bands = optics["bands"];
        for (std::size_t i = 0, n = bands.array_size(0, 1000); i < n; ++i) {
            const Field band = bands.at(i);
            band.array_size(4, 4);
            const double b = band.at(2).number(0, 1000);
            scene.optics.bands.push_back({band.at(0).number(350, 800), band.at(1).number(0, 100), b,
                                          band.at(3).number(0, std::min(b, 100.0))});
        }
    }
    if (root.has("waves")) // folders of an earlier tarn are calm
        scene.waves = read_waves(root["waves"]);
    scene.look.tree_line_m = root["look"]["tree_line_m"].number(-1e5, 1e5);
    scene.look.snow_line_m = root["look"]["snow_line_m"].number(-1e5, 1e5);
    const Field cameras = root["cameras"];
    for (std::size_t i = 0, n = cameras.array_size(0, 10'000); i < n; ++i) {
        const Field c = cameras.at(i);
        scene.cameras.push_back(
            {c["name"].string(),
             scene::look_along(c["position_m"].vector(-1e8, 1e8), c["direction"].vector(-1e3, 1e3),
                               c["up"].vector(-1e3, 1e3), c["fov_deg"].number(1e-3, 170))});
    }
    if (root.has("ortho")) {
        const Field o = root["ortho"];
        Ortho ortho;
        files.ortho = o["file"].file_name();
        ortho.picture.width_px = o["width_px"].integer(1, 65536);
        ortho.picture.height_px = o["height_px"].integer(1, 65536);
        ortho.west_m = o["west_m"].number(-1e8, 1e8);
        ortho.north_m = o["north_m"].number(-1e8, 1e8);
        ortho.spacing_m = o["spacing_m"].number(1e-6, 1e6);
        scene.ortho = ortho;
    }
    scene.report = read_report(root["import"]);
    return scene;
}

} // namespace tarn::scene_files
