#include "dem/import.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/fill.hpp"
#include "dem/flat.hpp"
#include "dem/ortho.hpp"
#include "dem/statistics.hpp"
#include "dem/voids.hpp"
#include "dem/water.hpp"
#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tarn::dem {

void ImportOptions::validate() const {
    if (dems.empty())
        throw Error("no elevation data given", "name at least one raster");
    const auto range = [](const char* field, const std::optional<double>& value, double low,
                          double high) {
        if (value && !(*value >= low && *value <= high)) // also rejects NaN
            throw Error(text(field, " is ", *value, ", must be in [", low, ", ", high, "]"));
    };
    range("--level", level_m, -12'000.0, 12'000.0);
    range("--radius", radius_km, 0.01, 500.0);
    range("--spacing", spacing_m, 0.01, 100'000.0);
    if (at && !(std::abs(at->lat_deg) <= 90.0 && std::abs(at->lon_deg) <= 360.0))
        throw Error(text("--at ", at->lat_deg, ",", at->lon_deg, " is not on Earth"),
                    "write --at LAT,LON in degrees");
    if (radius_km && !at)
        throw Error("--radius needs a centre", "give --at LAT,LON");
    if (radius_km && bounds)
        throw Error("--radius and --bounds exclude each other");
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

struct Choice {
    double level_m = 0.0;
    Node seed;
};

/// `--level auto`: the water surface at (or nearest to) the seed, or the largest inland one.
Choice find_level(const Mosaic& mosaic, const std::vector<FlatSurface>& flats,
                  const Grid<unsigned char>& mask, std::optional<Node> at,
                  std::vector<std::string>& notes) {
    if (flats.empty())
        throw Error("no flat water surface was found in the elevation data",
                    "it may hold the lake's bed: give the level with --level M");
    const auto area = [&](const FlatSurface& f) {
        return fixed(double(f.nodes) * mosaic.spacing_m * mosaic.spacing_m / 1e6, 3) + " km2";
    };
    const FlatSurface* chosen = nullptr;
    if (at) {
        // The nearest flat node: a seed on an island or a jetty still means this lake.
        std::optional<Node> nearest;
        long best = 0;
        constexpr int reach = 50;
        for (int dr = -reach; dr <= reach; ++dr)
            for (int dc = -reach; dc <= reach; ++dc) {
                const Node n{at->col + dc, at->row + dr};
                const long d = long(dr) * dr + long(dc) * dc;
                if (mask.contains(n) && mask[n] && (!nearest || d < best)) {
                    nearest = n;
                    best = d;
                }
            }
        if (!nearest)
            throw Error(text("no flat water surface within ", reach, " nodes of --at"),
                        "move it onto the lake, or give the level with --level M");
        const double level = mosaic.elevation_m[*nearest];
        notes.push_back(text("level ", fixed(level, 4), " m taken from the flat surface at ",
                             place(mosaic, *nearest)));
        return {level, *nearest};
    }
    for (const FlatSurface& flat : flats) // the sea: at about 0 and open at the edge
        if (!(flat.touches_edge && std::abs(flat.level_m) <= 2.0f)) {
            chosen = &flat;
            break;
        }
    if (!chosen)
        chosen = &flats.front();
    notes.push_back(text("level ", fixed(chosen->level_m, 4), " m taken from the largest of ",
                         flats.size(), " flat surfaces: ", area(*chosen), " at ",
                         place(mosaic, chosen->deepest)));
    return {chosen->level_m, chosen->deepest};
}

/// A level typed from a rounded figure may lie some millimetres below the water surface that it
/// means (179.65 for 179.6513): then the surface itself is taken, and said.
double snapped(double level_m, const std::vector<FlatSurface>& flats, const Mosaic& mosaic,
               const std::optional<Node>& seed, std::vector<std::string>& notes) {
    constexpr double rounding_m = 0.005;
    for (const FlatSurface& flat : flats) { // largest first
        const double above = double(flat.level_m) - level_m;
        if (!(above > level_tolerance_m && above <= rounding_m) ||
            (seed && mosaic.elevation_m[*seed] != flat.level_m))
            continue;
        notes.push_back(text("level ", level_m, " m taken as ", fixed(flat.level_m, 4),
                             " m, the flat water surface at ", place(mosaic, flat.deepest)));
        return flat.level_m;
    }
    return level_m;
}

Node largest_basin_seed(const Mosaic& mosaic, const Voids& voids, double level_m,
                        std::vector<std::string>& notes) {
    const auto basins = find_basins(mosaic.elevation_m, voids.outside, level_m);
    const auto lake = largest_lake(basins);
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

} // namespace

ImportResult import_dem(const ImportOptions& options, const Progress& progress) {
    options.validate();
    ImportResult out;
    ImportReport& report = out.report;
    progress.report(0.0, "opening");

    std::vector<Source> sources;
    for (const auto& path : options.dems)
        for (Source& source : open_sources(path, {.crs = options.crs, .nodata = options.nodata})) {
            report.notes.insert(report.notes.end(), source.notes.begin(), source.notes.end());
            report.inputs.push_back(source.input);
            sources.push_back(std::move(source));
        }
    for (const Source& source : sources)
        if (source.input.vertical != sources.front().input.vertical)
            report.notes.push_back(
                source.name + ": its vertical datum '" + source.input.vertical +
                "' differs from the first tile's; heights are taken as they are");

    MosaicOptions mosaic_options{.bounds = options.bounds, .spacing_m = options.spacing_m};
    if (options.radius_km)
        mosaic_options.bounds = around(*options.at, *options.radius_km);
    Mosaic mosaic = build_mosaic(sources, mosaic_options, progress);
    mosaic.frame.vertical_datum = sources.front().input.vertical;
    report.resampling = mosaic.resampling;
    report.notes.insert(report.notes.end(), mosaic.notes.begin(), mosaic.notes.end());
    report.nodes = mosaic.elevation_m.size.count();

    progress.report(0.61, "finding water surfaces");
    const std::vector<FlatSurface> flats =
        find_flats(mosaic.elevation_m); // voids are still voids here
    Grid<unsigned char> flat = flat_mask(mosaic.elevation_m);
    progress.report(0.62, "filling voids");
    const Voids voids = fill_voids(mosaic.elevation_m);
    report.void_nodes = voids.count;
    report.filled_nodes = voids.inside;
    report.outside_nodes = voids.count - voids.inside;

    progress.report(0.66, "finding the lake");
    report.flat_share =
        double(std::count(flat.values.begin(), flat.values.end(), 1)) / double(flat.values.size());
    std::optional<Node> seed;
    if (options.at)
        seed = node_at(mosaic, *options.at);
    Choice choice;
    if (!options.level_m) {
        choice = find_level(mosaic, flats, flat, seed, report.notes);
    } else {
        choice.level_m = snapped(*options.level_m, flats, mosaic, seed, report.notes);
        if (seed) {
            const auto wet =
                nearest_wet(mosaic.elevation_m, voids.outside, choice.level_m, *seed, 10);
            if (wet && *wet != *seed)
                report.notes.push_back("--at lies above the level; the nearest node below it, at " +
                                       place(mosaic, *wet) + ", was taken");
            choice.seed = wet.value_or(*seed);
        } else {
            choice.seed = largest_basin_seed(mosaic, voids, choice.level_m, report.notes);
        }
    }

    WetLake lake{.level_m = choice.level_m, .wet = {}};
    LakeRecord record;
    record.id = 1;
    record.name = options.name;
    record.level_m = choice.level_m;
    lake.wet = fill_from(mosaic.elevation_m, voids.outside, choice.level_m, choice.seed,
                         &record.open_at_edge);
    if (!options.level_m && record.open_at_edge) {
        // A surface that was found flat and yet runs out of the data ends where the flat ends:
        // whole-metre models vary by one. (Closed lower ground is its bed.)
        bool open = false;
        const Grid<unsigned char> surface =
            fill_from(mosaic.elevation_m, voids.outside, choice.level_m, choice.seed, &open,
                      choice.level_m - 1.0);
        const auto all = std::count(lake.wet.values.begin(), lake.wet.values.end(), 1);
        const auto kept = std::count(surface.values.begin(), surface.values.end(), 1);
        if (kept < all) {
            report.notes.push_back(
                text(all - kept,
                     " nodes more than a metre below the found surface "
                     "connect to it (a dam or outlet that the grid does not show); "
                     "they were kept dry. --level ",
                     choice.level_m, " floods them"));
            lake.wet = surface;
            record.open_at_edge = open;
        }
    }
    // Neither a flat surface nor an interpolated void says anything about the bed.
    std::size_t nodes = 0, flat_nodes = 0, void_nodes = 0;
    for (std::size_t i = 0; i < lake.wet.values.size(); ++i) {
        nodes += lake.wet.values[i];
        void_nodes += lake.wet.values[i] & voids.filled.values[i];
        flat.values[i] |= voids.filled.values[i];
        flat_nodes += lake.wet.values[i] & flat.values[i];
    }
    record.flat_share = double(flat_nodes) / double(nodes);
    if (void_nodes > 0)
        report.notes.push_back(
            text(void_nodes, " nodes of the lake had no data; their heights are interpolated"));
    if (record.open_at_edge)
        report.notes.push_back("the lake touches the edge of the data: it may go on outside, and "
                               "its figures count only what is inside");

    if (options.bathymetry) {
        progress.report(0.7, "merging the bathymetry");
        auto surveys = open_sources(
            *options.bathymetry,
            {.crs = "",
             .nodata = {},
             .crs_hint = "set it in the file, for example with gdal_edit.py -a_srs EPSG:..."});
        Grid<float> survey(mosaic.elevation_m.size, std::numeric_limits<float>::quiet_NaN());
        for (Source& part : surveys) { // a zip may hold several; the last one counts, as with tiles
            part.input.role = "bathymetry";
            report.inputs.push_back(part.input);
            report.notes.insert(report.notes.end(), part.notes.begin(), part.notes.end());
            const Grid<float> values = onto_grid(part, mosaic, "bilinear");
            for (std::size_t i = 0; i < survey.values.size(); ++i)
                if (!std::isnan(values.values[i]))
                    survey.values[i] = values.values[i];
        }
        // Where the DEM holds the water's surface of its own day, depths count from that; ground
        // that a higher level floods besides is known.
        const bool surface_known = record.flat_share > 0.5;
        Grid<unsigned char> surface = lake.wet;
        double surface_m = choice.level_m;
        if (surface_known) {
            std::vector<float> heights;
            for (std::size_t i = 0; i < surface.values.size(); ++i) {
                surface.values[i] = lake.wet.values[i] & flat.values[i];
                if (surface.values[i])
                    heights.push_back(mosaic.elevation_m.values[i]);
            }
            std::nth_element(heights.begin(), heights.begin() + std::ptrdiff_t(heights.size() / 2),
                             heights.end());
            surface_m = heights[heights.size() / 2];
            if (std::abs(surface_m - choice.level_m) > 0.05)
                report.notes.push_back(text("depths count from the DEM's water surface at ",
                                            fixed(surface_m, 2), " m"));
        }
        const auto notes = merge_bathymetry(mosaic.elevation_m, lake.wet, surface, surface_m,
                                            std::move(survey), options.bathymetry_kind);
        report.notes.insert(report.notes.end(), notes.begin(), notes.end());
        record.bed = Bed::measured;
    } else {
        const bool unknown = options.bed == BedChoice::unknown ||
                             (options.bed == BedChoice::automatic && record.flat_share > 0.5);
        record.bed = unknown ? Bed::unknown : Bed::measured;
        if (unknown) {
            const std::size_t lowered =
                make_room(mosaic.elevation_m, lake.wet, flat, choice.level_m);
            report.notes.push_back(
                text("bed unknown: ", fixed(100.0 * record.flat_share, 1),
                     " % of the lake is flat in "
                     "the DEM, which holds the water's surface. ",
                     lowered,
                     " nodes were lowered nominally so that water has room; that is no depth. Give "
                     "--bathymetry for a real bed"));
        }
    }

    progress.report(0.78, "packing heights");
    out.ground = quantise(mosaic.elevation_m.values, mosaic.elevation_m.size, mosaic.spacing_m, 4,
                          choice.level_m);
    out.ground.west_m = mosaic.west_m;
    out.ground.north_m = mosaic.north_m;
    const std::size_t raised = separate(out.ground, lake);
    if (raised > 0)
        report.notes.push_back(text(raised,
                                    " nodes beside the water (no data, or below a dam) were "
                                    "raised to just above the level, where the lake ends"));
    measure(record, out.ground, lake.wet, mosaic.frame);
    out.water = water_surface(out.ground, std::span(&lake, 1));
    out.lakes = {record};
    out.frame = mosaic.frame;

    if (options.ortho) {
        Source picture = open_picture(*options.ortho, "");
        report.inputs.push_back(picture.input);
        out.ortho = warp_ortho(picture, out.frame, out.ground, progress);
    }
    return out;
}

} // namespace tarn::dem
