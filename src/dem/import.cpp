#include "dem/import.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/checksums.hpp"
#include "dem/fill.hpp"
#include "dem/flat.hpp"
#include "dem/lakes.hpp"
#include "dem/median.hpp"
#include "dem/ortho.hpp"
#include "dem/parallel.hpp"
#include "dem/soundings.hpp"
#include "dem/statistics.hpp"
#include "dem/voids.hpp"
#include "dem/water.hpp"
#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tarn::dem {

void ImportOptions::validate() const {
    if (dems.empty() && !remote)
        throw Error("no elevation data given", "name at least one raster, or give --source");
    if (remote && !radius_km && !bounds)
        throw Error("--source needs a place", "give --at LAT,LON and --radius KM, or --bounds");
    const auto range = [](const char* field, const std::optional<double>& value, double low,
                          double high) {
        if (value && !(*value >= low && *value <= high)) // also rejects NaN
            throw Error(text(field, " is ", *value, ", must be in [", low, ", ", high, "]"));
    };
    range("--level", level_m, -12'000.0, 12'000.0);
    range("--radius", radius_km, 0.01, 500.0);
    range("--spacing", spacing_m, 0.01, 100'000.0);
    range("--min-area", min_area_km2, 0.0, 1e6);
    range("--bathymetry-offset", bathymetry_offset_m, -12'000.0, 12'000.0);
    range("--bathymetry-level", bathymetry_level_m, -12'000.0, 12'000.0);
    range("--estimate-depth", estimate_depth_m, 0.01, 2000.0);
    for (const std::string& asked : {unit, bathymetry_unit})
        if (!asked.empty() && metres_per_unit(asked) == 0.0)
            throw Error("unit '" + asked + "' is not known", "give m, ft, us-ft, cm, dm or mm");
    if (depths && !level_m)
        throw Error("--depths needs the level that they count from",
                    "give --level M (any, if it is not known)");
    if (bathymetry && soundings)
        throw Error("--bathymetry and --soundings exclude each other",
                    "merge them before, or import with one");
    if (at && !(std::abs(at->lat_deg) <= 90.0 && std::abs(at->lon_deg) <= 360.0))
        throw Error(text("--at ", at->lat_deg, ",", at->lon_deg, " is not on Earth"),
                    "write --at LAT,LON in degrees");
    if (radius_km && !at)
        throw Error("--radius needs a centre", "give --at LAT,LON");
    if (radius_km && bounds)
        throw Error("--radius and --bounds exclude each other");
    if (bounds && !(std::abs(bounds->west_deg) <= 540.0 && std::abs(bounds->east_deg) <= 540.0))
        throw Error("--bounds reaches beyond 540 degrees",
                    "write WEST,SOUTH,EAST,NORTH in degrees");
    if (bounds && !(bounds->west_deg < bounds->east_deg && bounds->south_deg < bounds->north_deg &&
                    bounds->south_deg >= -90.0 && bounds->north_deg <= 90.0))
        throw Error(
            "--bounds must be WEST,SOUTH,EAST,NORTH in degrees, west < east, south < north");
}

namespace {

Bounds around(GeoPoint centre, double radius_km) {
    constexpr double km_per_degree =
        111.2; // along a meridian; a little short errs on the wide side
    const double dlat = radius_km / 110.5;
    const double dlon =
        radius_km / (km_per_degree * std::max(0.01, std::cos(centre.lat_deg * M_PI / 180)));
    return {centre.lon_deg - dlon, std::max(-90.0, centre.lat_deg - dlat), centre.lon_deg + dlon,
            std::min(90.0, centre.lat_deg + dlat)};
}

Node node_at(const Mosaic& mosaic, GeoPoint at) {
    const ScenePoint p = geo::to_scene(mosaic.frame, at);
    const double col = (p.x_m - mosaic.west_m) / mosaic.spacing_m;
    const double row = (mosaic.north_m - p.y_m) / mosaic.spacing_m;
    const GridSize size = mosaic.elevation_m.size;
    if (!(col > -0.5 && row > -0.5 && col < size.cols - 0.5 && row < size.rows - 0.5))
        throw Error(text("--at ", at.lat_deg, ",", at.lon_deg, " lies outside the elevation data"),
                    "latitude first, then longitude; west and south are negative");
    return {int(std::lround(col)), int(std::lround(row))};
}

std::string place(const Mosaic& mosaic, Node n) {
    const GeoPoint p = geo::to_geo(mosaic.frame, {mosaic.west_m + n.col * mosaic.spacing_m,
                                                  mosaic.north_m - n.row * mosaic.spacing_m});
    return fixed(p.lat_deg, 4) + "," + fixed(p.lon_deg, 4);
}

/// Eight winds, for people.
const char* compass(double dx, double dy) {
    static const char* winds[] = {"east", "north-east", "north", "north-west",
                                  "west", "south-west", "south", "south-east"};
    const double turns = std::atan2(dy, dx) / (2.0 * M_PI) * 8.0;
    return winds[std::size_t(std::lround(turns) + 8) % 8];
}

/// A level typed from a rounded figure may lie some millimetres below the water surface that it
/// means (179.65 for 179.6513): then the surface itself is taken, and said.
double snapped(double level_m, const std::vector<FlatSurface>& flats, const Mosaic& mosaic,
               const std::optional<Node>& seed, std::vector<std::string>& notes) {
    constexpr double rounding_m = 0.005;
    if (has_surface(flats, level_m))
        return level_m;
    for (const FlatSurface& flat : flats) { // largest first
        const double above = double(flat.level_m) - level_m;
        if (!(above > 0.0 && above <= rounding_m) ||
            (seed && mosaic.elevation_m[*seed] != flat.level_m))
            continue;
        notes.push_back(text("level ", level_m, " m taken as ", fixed(flat.level_m, 4),
                             " m, the flat water surface at ", place(mosaic, flat.middle)));
        return flat.level_m;
    }
    return level_m;
}

Node largest_basin_seed(const Mosaic& mosaic, Marks& marks, double level_m, float highest_wet_m,
                        bool depths, std::vector<std::string>& notes) {
    const auto basins = find_basins(mosaic.elevation_m, marks, highest_wet_m);
    auto lake = largest_lake(basins);
    if (depths && !basins.empty()) // there the data end at the shore: every lake looks open
        lake = basins.front();
    if (!lake)
        throw Error(text("nothing lies below the level of ", fixed(level_m, 2),
                         " m: the ground reaches from ",
                         fixed(*std::min_element(mosaic.elevation_m.values.begin(),
                                                 mosaic.elevation_m.values.end()),
                               2),
                         " m up"),
                    "raise --level, or check its vertical datum");
    const double cell = mosaic.spacing_m * mosaic.spacing_m;
    notes.push_back("no seed given; the largest lake at this level was taken, at " +
                    place(mosaic, lake->seed));
    if (basins.front().nodes > lake->nodes)
        notes.push_back(text(
            "larger ground below this level is open at the data's edge and was not taken for a "
            "lake: ",
            fixed(double(basins.front().nodes) * cell / 1e6, 3), " km2 around ",
            place(mosaic, basins.front().seed), "; --at LAT,LON takes it"));
    return lake->seed;
}

/// An import on its way: each step adds to what the next one needs.
class Work {
public:
    Work(const ImportOptions& options, const Progress& progress)
        : options_(options), progress_(progress) {
        options.validate();
    }

    void open();
    void build_grid();
    void find_surfaces();
    void choose_and_fill();
    void find_all(); ///< every lake, none asked for
    void make_beds();
    std::vector<LakeRecord> measure_lakes();
    void tell_spill(LakeRecord& lake);
    ImportResult pack(std::vector<LakeRecord> lakes, const HeightsSink& keep_heights);

    ImportReport finish_report();

private:
    void note(const std::string& words) { report_.notes.push_back(words); }
    Bounds region() const {
        return options_.bounds ? *options_.bounds : around(*options_.at, *options_.radius_km);
    }
    void add_input(Source& source, const std::string& role);
    std::size_t least_nodes() const;
    LakeSearch search() {
        return {.elevation_m = mosaic_.elevation_m,
                .marks = marks_,
                .lake_of = lake_of_,
                .stepped = stepped_,
                .least_nodes = least_nodes()};
    }
    void fill_level(double level_m, std::optional<Node> seed);
    void fill_found(Node at);
    void tell_cut_short() {
        constexpr std::size_t many = 40;
        if (stepped_ && lakes_.size() > many)
            note(text("heights come in steps, where level ground looks like water: some of the ",
                      lakes_.size(), " surfaces may be none (--min-area leaves out small ones)"));
        if (lakes_.size() >= search().most_lakes)
            note(text("only the ", lakes_.size(),
                      " largest lakes were kept; --min-area leaves out the small ones"));
    }
    void number_lakes();
    void open_surveys();
    void make_bed(const FoundLake& lake, std::size_t& made);
    double surface_height(const FoundLake& lake) const;
    Surface surface() const {
        return {mosaic_.elevation_m, mosaic_.spacing_m, mosaic_.west_m, mosaic_.north_m};
    }

    const ImportOptions& options_;
    const Progress& progress_;
    ImportReport report_;
    Checksums checksums_; ///< of report_.inputs, in their order
    std::vector<Source> sources_, surveys_;
    SoundingFile soundings_;
    Mosaic mosaic_;
    Marks marks_;
    LakeOf lake_of_;
    std::vector<FlatSurface> surfaces_;
    std::vector<FoundLake> lakes_; ///< lakes_[i].id == i + 1
    std::vector<double> flat_share_;
    std::vector<Bed> beds_;
    Boxes boxes_;
    bool stepped_ = false; ///< the data's heights come in steps
};

void Work::add_input(Source& source, const std::string& role) {
    source.input.role = role;
    report_.notes.insert(report_.notes.end(), source.notes.begin(), source.notes.end());
    report_.inputs.push_back(source.input);
    checksums_.add(source.path);
}

void Work::open() {
    progress_.report(0.0, "opening");
    std::vector<std::string> without_unit;
    std::vector<std::filesystem::path> paths = options_.dems;
    if (options_.remote) {
        const Fetched fetched = fetch_tiles(*options_.remote, region(), options_.fetch, progress_);
        paths.insert(paths.end(), fetched.tiles.begin(), fetched.tiles.end());
        report_.notes.insert(report_.notes.end(), fetched.notes.begin(), fetched.notes.end());
    }
    for (const auto& path : paths)
        for (Source& source : open_sources(
                 path, {.crs = options_.crs,
                       .nodata = options_.nodata,
                       .unit = options_.unit,
                       .depths_below_m = options_.depths ? options_.level_m : std::nullopt})) {
            add_input(source, "dem");
            if (!source.unit_declared)
                without_unit.push_back(source.name);
            sources_.push_back(std::move(source));
        }
    if (!without_unit.empty())
        note(text("vertical unit not declared (", without_unit.front(),
                  without_unit.size() > 1 ? text(" and ", without_unit.size() - 1, " more") : "",
                  "); taken as metres (--unit says otherwise)"));
    for (const Source& source : sources_)
        if (source.input.vertical != sources_.front().input.vertical)
            note(source.name + ": its vertical datum '" + source.input.vertical +
                 "' differs from the first tile's; heights are taken as they are");
}

void Work::build_grid() {
    MosaicOptions mosaic_options{.bounds = options_.bounds, .spacing_m = options_.spacing_m};
    if (options_.radius_km)
        mosaic_options.bounds = region();
    mosaic_ = build_mosaic(sources_, mosaic_options, progress_);
    mosaic_.frame.vertical_datum = sources_.front().input.vertical;
    report_.resampling = mosaic_.resampling;
    report_.notes.insert(report_.notes.end(), mosaic_.notes.begin(), mosaic_.notes.end());
    report_.nodes = mosaic_.elevation_m.size.count();
    for (const Source& source : sources_)
        if (source.findings->forgotten)
            note(source.name + ": undeclared voids (NaN, -9999) taken as no data");
    sources_.clear();
    checksums_.start();
    float highest = -1e9f;
    for (const float z : mosaic_.elevation_m.values)
        highest = z > highest ? z : highest; // NaN compares false
    constexpr float everest_m = 8849.0f;
    if (highest > everest_m)
        throw Error(text("heights reach ", fixed(highest, 0), " m, above any place on Earth"),
                    "if they are feet give --unit ft; if that is a no-data value give --nodata");
}

void Work::find_surfaces() {
    progress_.report(0.61, "finding water surfaces");
    bool stepped = false;
    auto flats = find_flats(mosaic_.elevation_m, &stepped); // voids are still voids here
    stepped_ = stepped || mosaic_.stepped;
    if (!mosaic_.laid.values.empty()) // what the source did not take for water is none here
        std::erase_if(flats, [&](const FlatSurface& flat) {
            std::size_t laid = 0;
            for (const Run& run : flat.runs)
                for (int col = run.first; col <= run.last; ++col)
                    laid += mosaic_.laid[{col, run.row}];
            return 2 * laid < flat.nodes;
        });
    mosaic_.laid = {};
    progress_.report(0.64, "filling voids");
    marks_ = Marks(mosaic_.elevation_m.size);
    const VoidCount voids = fill_voids(mosaic_.elevation_m, marks_);
    report_.void_nodes = voids.all;
    report_.filled_nodes = voids.inside;
    report_.outside_nodes = voids.all - voids.inside;
    surfaces_ =
        complete_surfaces(mosaic_.elevation_m, marks_, std::move(flats), stepped_, report_.notes);
    std::size_t flat = 0;
    for (const unsigned char m : marks_.values)
        flat += (m & mark::flat) != 0;
    report_.flat_share = double(flat) / double(marks_.values.size());
    lake_of_ = LakeOf(mosaic_.elevation_m.size);
}

std::size_t Work::least_nodes() const {
    const double cell = mosaic_.spacing_m * mosaic_.spacing_m;
    return std::size_t(std::max(1.0, std::ceil(options_.min_area_km2 * 1e6 / cell)));
}

/// `--level M`: all that the level reaches from the seed.
void Work::fill_level(double level_m, std::optional<Node> seed) {
    level_m = snapped(level_m, surfaces_, mosaic_, seed, report_.notes);
    const float highest = highest_wet(level_m, has_surface(surfaces_, level_m));
    if (seed) {
        const auto wet = nearest_wet(mosaic_.elevation_m, marks_, highest, *seed, 10);
        if (wet && *wet != *seed)
            note("--at lies above the level; the nearest node below it, at " +
                 place(mosaic_, *wet) + ", was taken");
        seed = wet.value_or(*seed);
    } else {
        seed =
            largest_basin_seed(mosaic_, marks_, level_m, highest, options_.depths, report_.notes);
    }
    FoundLake lake{.id = 1, .level_m = level_m, .seeds = {*seed}};
    Filled filled = fill_from(mosaic_.elevation_m, marks_, highest, lake.seeds, 1, lake_of_);
    const float below = highest_wet(level_m, false);
    if (highest != below && filled.flat_at_level == 0 && mosaic_.elevation_m[*seed] <= below) {
        drain(lake_of_, lake.seeds); // a surface of just this height, but of another lake
        filled = fill_from(mosaic_.elevation_m, marks_, below, lake.seeds, 1, lake_of_);
    }
    lake.nodes = filled.nodes;
    lake.open_at_edge = filled.open_at_edge && !options_.depths;
    lakes_.push_back(lake);
}

/// `--level auto --at`: the water surface at the point or nearest to it.
void Work::fill_found(Node at) {
    constexpr int reach = 50;
    // A seed on an island or a jetty still means this lake.
    std::optional<Node> nearest;
    long best = 0;
    for (int dr = -reach; dr <= reach; ++dr)
        for (int dc = -reach; dc <= reach; ++dc) {
            const Node n{at.col + dc, at.row + dr};
            const long d = long(dr) * dr + long(dc) * dc;
            if (marks_.contains(n) && (marks_[n] & mark::flat) && (!nearest || d < best)) {
                nearest = n;
                best = d;
            }
        }
    if (!nearest)
        throw Error(text("no flat water surface within ", reach, " nodes of --at"),
                    "move it onto the lake, or give the level with --level M");
    const float level = mosaic_.elevation_m[*nearest];
    note(text("level ", fixed(level, 4), " m taken from the flat surface at ",
              place(mosaic_, *nearest)));
    FlatSurface here;
    here.level_m = level;
    for (const FlatSurface& surface : surfaces_)
        for (const Run& run : surface.runs)
            if (run.row == nearest->row && run.first <= nearest->col && nearest->col <= run.last)
                here = surface;
    here.middle = *nearest;
    FoundLake lake = fill_surface(search(), here, 1);
    if (lake.nodes == 0) { // the user knows that it is one
        const Filled filled =
            fill_from(mosaic_.elevation_m, marks_, level, lake.seeds, 1, lake_of_);
        lake.nodes = filled.nodes;
        lake.open_at_edge = filled.open_at_edge;
    }
    join_bays(search(), surfaces_, lake);
    lakes_.push_back(lake);
}

void Work::choose_and_fill() {
    progress_.report(0.68, "filling the lakes");
    std::optional<Node> seed;
    if (options_.at)
        seed = node_at(mosaic_, *options_.at);
    if (options_.level_m)
        fill_level(*options_.level_m, seed);
    else if (seed)
        fill_found(*seed);
    if (options_.lakes == LakeChoice::all || lakes_.empty()) {
        auto others = find_lakes(search(), surfaces_, int(lakes_.size()) + 1);
        lakes_.insert(lakes_.end(), others.begin(), others.end());
    }
    if (lakes_.empty())
        throw Error("no flat water surface was found in the elevation data",
                    "it may hold the lake's bed: give the level with --level M");
    const bool chosen = options_.level_m || options_.at;
    if (!chosen) { // the largest inland one comes first
        const auto main = std::max_element(lakes_.begin(), lakes_.end(),
                                           [](const FoundLake& a, const FoundLake& b) {
                                               return a.sea != b.sea ? a.sea : a.nodes < b.nodes;
                                           });
        if (main != lakes_.end())
            std::rotate(lakes_.begin(), main, main + 1);
        if (options_.lakes == LakeChoice::one) {
            for (std::size_t i = 1; i < lakes_.size(); ++i)
                drain(lake_of_, lakes_[i].seeds);
            lakes_.resize(1);
        }
        note(text("level ", fixed(lakes_[0].level_m, 4), " m taken from the largest of ",
                  surfaces_.size(), " flat surfaces: ",
                  fixed(double(lakes_[0].nodes) * mosaic_.spacing_m * mosaic_.spacing_m / 1e6, 3),
                  " km2 at ", place(mosaic_, lakes_[0].seeds.front())));
    }
    tell_cut_short();
    number_lakes();
    if (lakes_.size() > 1)
        note(text(lakes_.size() - 1,
                  " other water surfaces of the data stand at their own levels (--lakes one "
                  "leaves them out)"));
}

void Work::find_all() {
    progress_.report(0.68, "filling the lakes");
    lakes_ = find_lakes(search(), surfaces_, 1);
    std::stable_partition(lakes_.begin(), lakes_.end(),
                          [](const FoundLake& lake) { return !lake.sea; });
    tell_cut_short();
    number_lakes();
}

/// Ids follow the order of lakes_; lakes that touch are parted; what is left is counted.
void Work::number_lakes() {
    std::vector<std::uint16_t> renumber(65536, 0);
    std::vector<double> levels;
    for (std::size_t i = 0; i < lakes_.size(); ++i) {
        renumber[std::size_t(lakes_[i].id)] = static_cast<std::uint16_t>(i + 1);
        lakes_[i].id = int(i + 1);
        levels.push_back(lakes_[i].level_m);
    }
    for (std::uint16_t& id : lake_of_.values)
        id = renumber[id];
    if (const std::size_t dried = part_lakes(lake_of_, levels); dried > 0)
        note(text(dried, " nodes where lakes of different levels touch were taken for the land "
                         "between them"));
    boxes_ = boxes_of(lake_of_, int(lakes_.size()));
    // Neither a flat surface nor an interpolated void says anything about the bed.
    std::vector<std::size_t> nodes(lakes_.size()), flat(lakes_.size()), voids(lakes_.size());
    for (std::size_t i = 0; i < lake_of_.values.size(); ++i)
        if (const int id = lake_of_.values[i]; id > 0) {
            const auto k = std::size_t(id - 1);
            ++nodes[k];
            flat[k] += (marks_.values[i] & (mark::flat | mark::filled)) != 0;
            voids[k] += (marks_.values[i] & mark::filled) != 0;
        }
    if (!lakes_.empty() && nodes[0] == 0)
        throw Error("the lake lies against others and keeps no node of its own",
                    "give --lakes one, or another --level");
    for (std::size_t k = 0; k < lakes_.size(); ++k) {
        lakes_[k].nodes = nodes[k];
        flat_share_.push_back(nodes[k] ? double(flat[k]) / double(nodes[k]) : 0.0);
        if (voids[k] > 0 && k == 0)
            note(text(voids[k], " nodes of the lake had no data; their heights are interpolated"));
    }
}

/// Height of the water surface that the DEM holds of a lake: the median of its flat nodes.
double Work::surface_height(const FoundLake& lake) const {
    std::vector<float> heights;
    const auto [low, high] = boxes_[std::size_t(lake.id - 1)];
    for (int row = low.row; row <= high.row; ++row)
        for (int col = low.col; col <= high.col; ++col) {
            const Node n{col, row};
            if (lake_of_[n] == lake.id && (marks_[n] & (mark::flat | mark::filled)))
                heights.push_back(mosaic_.elevation_m[n]);
        }
    return heights.empty() ? lake.level_m : double(median(std::move(heights)));
}

/// Merges what was surveyed into one lake; `made` counts the lakes that it reached.
void Work::make_bed(const FoundLake& lake, std::size_t& made) {
    const auto k = std::size_t(lake.id - 1);
    BedPlace place{.lake_of = lake_of_,
                   .marks = marks_,
                   .id = lake.id,
                   .box = boxes_[k],
                   .surface_m = lake.level_m,
                   .surface_known = flat_share_[k] > 0.5};
    // Where the DEM holds the water's surface of its own day, depths count from that; ground
    // that a higher level floods besides is known.
    if (place.surface_known)
        place.surface_m = surface_height(lake);
    if (options_.bathymetry_level_m)
        place.surface_m = *options_.bathymetry_level_m;
    const Box box = place.widened();
    Grid<float> survey(place.size(), std::numeric_limits<float>::quiet_NaN());
    BathymetryKind kind = options_.bathymetry_kind;
    const double offset_m = options_.bathymetry_offset_m;
    const auto settle_kind = [&](const std::vector<float>& inside) {
        if (kind != BathymetryKind::automatic || inside.empty())
            return;
        kind = judge_kind(inside, place.surface_m - offset_m);
        note(std::string("bathymetry values taken as ") +
             (kind == BathymetryKind::depth ? "depths" : "elevations") +
             " (by their values near the shore; --bathymetry-kind says otherwise)");
    };
    std::vector<float> inside;
    if (options_.bathymetry) {
        for (Source& part :
             surveys_) { // a zip may hold several; the last one counts, as with tiles
            const Grid<float> values = onto_grid(part, mosaic_, box.first, survey.size, "bilinear");
            for (std::size_t i = 0; i < survey.values.size(); ++i)
                if (!std::isnan(values.values[i]))
                    survey.values[i] = values.values[i];
        }
        for (int row = 0; row < survey.size.rows; ++row)
            for (int col = 0; col < survey.size.cols; ++col)
                if (place.wet({box.first.col + col, box.first.row + row}) &&
                    !std::isnan(survey[{col, row}]))
                    inside.push_back(survey[{col, row}]);
        settle_kind(inside);
        if (kind == BathymetryKind::elevation)
            for (float& v : survey.values)
                v += float(offset_m);
    } else {
        for (const Sounding& s : soundings_.soundings)
            if (place.wet({int(std::lround(s.col)), int(std::lround(s.row))}))
                inside.push_back(float(s.value));
        settle_kind(inside);
        if (!inside.empty()) {
            std::vector<Sounding> moved = soundings_.soundings;
            if (kind == BathymetryKind::elevation)
                for (Sounding& s : moved)
                    s.value += offset_m;
            note(text(inside.size(), " of ", moved.size(),
                      " soundings lie in the lake; the bed between them and the shore (depth 0) is "
                      "interpolated linearly over triangles"));
            survey =
                grid_soundings(place, moved, kind == BathymetryKind::depth ? 0.0 : place.surface_m);
        }
    }
    if (inside.empty())
        return;
    if (std::abs(place.surface_m - lake.level_m) > 0.05)
        note(text("depths count from ", fixed(place.surface_m, 2), " m",
                  options_.bathymetry_level_m ? "" : ", the DEM's own water surface"));
    const Merged merged = merge_bathymetry(mosaic_.elevation_m, place, survey, kind);
    report_.notes.insert(report_.notes.end(), merged.notes.begin(), merged.notes.end());
    // Half a survey is no measured bed.
    beds_[k] = options_.bathymetry && merged.coverage >= 0.8 ? Bed::measured : Bed::interpolated;
    ++made;
}

void Work::open_surveys() {
    if (options_.bathymetry) {
        surveys_ = open_sources(
            *options_.bathymetry,
            {.crs = options_.bathymetry_crs,
             .nodata = std::numeric_limits<double>::quiet_NaN(), // 0 is a depth, no collar
             .unit = options_.bathymetry_unit,
             .depths_below_m = {},
             .crs_hint = "give it with --bathymetry-crs EPSG:..."});
        for (Source& part : surveys_)
            add_input(part, "bathymetry");
        return;
    }
    soundings_ = read_soundings(*options_.soundings,
                                {.field = options_.depth_field,
                                 .crs = options_.bathymetry_crs,
                                 .unit = options_.bathymetry_unit},
                                mosaic_);
    report_.inputs.push_back(soundings_.input);
    checksums_.add(options_.soundings->string());
    report_.notes.insert(report_.notes.end(), soundings_.notes.begin(), soundings_.notes.end());
}

void Work::make_beds() {
    for (std::size_t k = 0; k < lakes_.size(); ++k) {
        const bool unknown = options_.bed == BedChoice::unknown ||
                             (options_.bed == BedChoice::automatic && flat_share_[k] > 0.5);
        beds_.push_back(unknown ? Bed::unknown : Bed::measured);
    }
    if (options_.bathymetry || options_.soundings) {
        progress_.report(0.72, "merging the bathymetry");
        open_surveys();
        std::size_t made = 0;
        for (const FoundLake& lake : lakes_)
            if (!lake.sea && lake.nodes > 0)
                make_bed(lake, made);
        if (made == 0)
            throw Error((options_.bathymetry ? *options_.bathymetry : *options_.soundings)
                                .filename()
                                .string() +
                            ": has no value inside the lake",
                        "check its CRS, its nodata value and that it shows this lake");
    }
    if (options_.estimate_depth_m && lakes_[0].nodes > 0) {
        const BedPlace place{.lake_of = lake_of_,
                             .marks = marks_,
                             .id = 1,
                             .box = boxes_[0],
                             .surface_m = lakes_[0].level_m,
                             .surface_known = beds_[0] != Bed::unknown || flat_share_[0] > 0.5};
        if (beds_[0] != Bed::unknown)
            throw Error("--estimate-depth is for lakes of unknown depth; the bed of this one is " +
                            to_string(beds_[0]),
                        "leave it out, or say --bed unknown");
        estimate_depths(mosaic_.elevation_m, place, *options_.estimate_depth_m);
        beds_[0] = Bed::estimated;
        note(text("bed ESTIMATED from the distance to the shore and a greatest depth of ",
                  *options_.estimate_depth_m, " m (--estimate-depth); it is no survey"));
    }
    std::size_t unknown = 0;
    for (const Bed bed : beds_)
        unknown += bed == Bed::unknown;
    if (!beds_.empty() && beds_[0] == Bed::unknown)
        note(text("bed unknown: ", fixed(100.0 * flat_share_[0], 1),
                  " % of the lake is flat in the DEM, which holds the water's surface. It is drawn "
                  "over a nominal floor; that is no depth. Give --bathymetry or --soundings for a "
                  "real bed, --estimate-depth for a likely one"));
    else if (unknown > 0)
        note(text("the bed of ", unknown, " other lakes is unknown"));
}

std::vector<LakeRecord> Work::measure_lakes() {
    progress_.report(0.76, "measuring");
    std::vector<LakeRecord> out(lakes_.size());
    each_in_parallel(int(lakes_.size()), [&](int i) {
        const auto k = std::size_t(i);
        LakeRecord& record = out[k];
        record.id = lakes_[k].id;
        record.name = lakes_[k].sea ? "sea" : "";
        record.sea = lakes_[k].sea;
        record.level_m = lakes_[k].level_m;
        record.open_at_edge = lakes_[k].open_at_edge;
        record.flat_share = flat_share_[k];
        record.bed =
            beds_.empty() ? (flat_share_[k] > 0.5 ? Bed::unknown : Bed::measured) : beds_[k];
        if (lakes_[k].nodes > 0) {
            measure(record, surface(), lake_of_, boxes_[k], mosaic_.frame);
            record.parts = parts_of(lake_of_, marks_, record.id, boxes_[k]); // marks its own nodes
        }
    });
    clear(marks_, mark::seen);
    return out;
}

/// Where the main lake would spill, or does.
void Work::tell_spill(LakeRecord& lake) {
    if (options_.depths) // nothing is known of the land
        return;
    const auto& z = mosaic_.elevation_m;
    const auto spill = lake.open_at_edge ? find_spill(z, marks_, lakes_[0].seeds.front())
                                         : find_spill(z, marks_, lake_of_, 1, lake.level_m);
    if (!spill)
        return;
    const auto where = [&](Node n) {
        return ScenePoint{mosaic_.west_m + n.col * mosaic_.spacing_m,
                          mosaic_.north_m - n.row * mosaic_.spacing_m};
    };
    lake.spill = LakeSpill{.level_m = spill->level_m,
                           .pass = geo::to_geo(mosaic_.frame, where(spill->pass)),
                           .at_surface = false};
    const ScenePoint from = where(lakes_[0].seeds.front()), pass = where(spill->pass);
    if (!lake.open_at_edge)
        return;
    // A lake that is cut by the edge leaves at its surface; one that is too high, over a pass.
    double surface_m = -1e9;
    for (const FlatSurface& s : surfaces_)
        for (const Node seed : lakes_[0].seeds)
            if (s.middle == seed)
                surface_m = std::max(surface_m, double(s.level_m));
    if (spill->level_m <= surface_m) {
        lake.spill->at_surface = true;
        note("the lake touches the edge of the data: it may go on outside, and its figures count "
             "only what is inside");
        return;
    }
    if (spill->pass == spill->exit) {
        note(text(
            "at ", fixed(lake.level_m, 2), " m the water runs out of the data at ",
            place(mosaic_, spill->exit), ", over ground of ", fixed(spill->level_m, 2),
            " m: the lake may go on outside, and its figures count only what is inside; up to ",
            fixed(spill->level_m, 2), " m it stays inside"));
        return;
    }
    note(text("at ", fixed(lake.level_m, 2), " m the water spills over a pass of ",
              fixed(spill->level_m, 2), " m at ", place(mosaic_, spill->pass), ", ",
              fixed(std::hypot(pass.x_m - from.x_m, pass.y_m - from.y_m) / 1000.0, 1), " km ",
              compass(pass.x_m - from.x_m, pass.y_m - from.y_m), " of the lake at ",
              place(mosaic_, lakes_[0].seeds.front()), ", and runs out of the data at ",
              place(mosaic_, spill->exit), "; it may rise to ", fixed(spill->level_m, 2), " m"));
}

ImportResult Work::pack(std::vector<LakeRecord> lakes, const HeightsSink& keep_heights) {
    progress_.report(0.8, "packing heights");
    ImportResult out;
    std::vector<double> levels, reach, rooms;
    for (const LakeRecord& lake : lakes) {
        levels.push_back(lake.level_m);
        reach.push_back(lake.level_m);
        rooms.push_back(lake.bed == Bed::unknown ? lake.level_m
                                                 : std::numeric_limits<double>::quiet_NaN());
        if (lake.bed == Bed::unknown)
            reach.push_back(lake.level_m - greatest_room_m);
    }
    Grid<float>& z = mosaic_.elevation_m;
    out.ground = quantise(z.values, z.size, mosaic_.spacing_m, 4, reach);
    out.ground.west_m = mosaic_.west_m;
    out.ground.north_m = mosaic_.north_m;
    for (std::size_t i = 0; i < z.values.size(); ++i)
        if (marks_.values[i] & mark::outside)
            z.values[i] = std::numeric_limits<float>::quiet_NaN();
    if (keep_heights) {
        progress_.report(0.82, "writing heights");
        keep_heights(z, out.ground, mosaic_.frame);
        z = {};
    } else {
        out.heights_m = std::move(z);
    }
    const std::size_t lowered = make_room(out.ground, lake_of_, marks_, rooms);
    if (lowered > 0 && lakes[0].bed == Bed::unknown)
        note(text(lowered, " nodes of water without a bed were lowered nominally in ground.tif"));
    marks_ = {};
    out.water = empty_water(out.ground, levels);
    for (double& level : levels)
        level = drawn_level_m(out.water, level);
    const std::size_t raised = pour(out.ground, lake_of_, levels, out.ground, out.water);
    if (raised > 0)
        note(text(raised, " nodes beside the water (no data, or below a dam) were raised to just "
                          "above the level, where the lake ends"));
    lake_of_ = {};
    std::erase_if(lakes, [](const LakeRecord& lake) { return lake.area_m2 == 0.0; });
    out.lakes = std::move(lakes);
    out.frame = mosaic_.frame;
    if (options_.ortho) {
        Source picture = open_picture(*options_.ortho, "");
        add_input(picture, "ortho");
        const std::size_t known = picture.notes.size();
        out.ortho = warp_ortho(picture, out.frame, out.ground, progress_);
        for (std::size_t i = known; i < picture.notes.size(); ++i)
            note(picture.notes[i]);
    }
    return out;
}

ImportReport Work::finish_report() {
    const auto sums = checksums_.finish(progress_);
    for (std::size_t i = 0; i < sums.size(); ++i)
        report_.inputs[i].checksum = sums[i];
    return std::move(report_);
}

} // namespace

ImportResult import_dem(const ImportOptions& options, const Progress& progress,
                        const HeightsSink& keep_heights) {
    Work work(options, progress);
    work.open();
    work.build_grid();
    work.find_surfaces();
    work.choose_and_fill();
    work.make_beds();
    auto lakes = work.measure_lakes();
    lakes.front().name = options.name;
    work.tell_spill(lakes.front());
    ImportResult out = work.pack(std::move(lakes), keep_heights);
    out.report = work.finish_report();
    return out;
}

Detection detect_lakes(const ImportOptions& options, const Progress& progress) {
    Work work(options, progress);
    work.open();
    work.build_grid();
    work.find_surfaces();
    work.find_all();
    Detection out;
    out.lakes = work.measure_lakes();
    std::erase_if(out.lakes, [](const LakeRecord& lake) { return lake.area_m2 == 0.0; });
    std::stable_sort(out.lakes.begin(), out.lakes.end(),
                     [](const LakeRecord& a, const LakeRecord& b) {
                         return a.sea != b.sea ? b.sea : a.area_m2 > b.area_m2;
                     });
    for (std::size_t i = 0; i < out.lakes.size(); ++i)
        out.lakes[i].id = int(i + 1);
    out.report = work.finish_report();
    return out;
}

} // namespace tarn::dem
