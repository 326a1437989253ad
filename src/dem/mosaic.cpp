#include "dem/mosaic.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/flat.hpp"
#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>
#include <gdal_utils.h>
#include <limits>

namespace tarn::dem {

namespace {

constexpr float void_m = std::numeric_limits<float>::quiet_NaN();

struct Extent {
    double west = 1e300, south = 1e300, east = -1e300, north = -1e300;
    void add(double x, double y) {
        west = std::min(west, x);
        east = std::max(east, x);
        south = std::min(south, y);
        north = std::max(north, y);
    }
    bool empty() const { return !(west < east && south < north); }
    Extent clipped_to(const Extent& other) const {
        return {std::max(west, other.west), std::max(south, other.south),
                std::min(east, other.east), std::min(north, other.north)};
    }
};

/// The box that holds the image of a rectangle's outline; points PROJ refuses are left out.
Extent image_of(const Extent& box, OGRCoordinateTransformation& to, const std::string& name) {
    Extent out;
    constexpr int steps = 32;
    for (int i = 0; i <= steps; ++i) {
        const double f = double(i) / steps;
        const double xs[4] = {box.west + f * (box.east - box.west),
                              box.west + f * (box.east - box.west), box.west, box.east};
        const double ys[4] = {box.south, box.north, box.south + f * (box.north - box.south),
                              box.south + f * (box.north - box.south)};
        for (int k = 0; k < 4; ++k) {
            double x = xs[k], y = ys[k];
            GdalMessages quiet;
            if (to.Transform(1, &x, &y) && std::isfinite(x) && std::isfinite(y))
                out.add(x, y);
        }
    }
    if (out.empty())
        throw Error(name + ": its corners cannot be placed on Earth",
                    "check its CRS and georeference, or give --crs");
    return out;
}

Extent outline(const Source& source) {
    const double* g = source.transform.v;
    Extent out;
    for (int k = 0; k < 4; ++k) {
        const double c = (k & 1) ? source.cols : 0, r = (k & 2) ? source.rows : 0;
        out.add(g[0] + c * g[1] + r * g[2], g[3] + c * g[4] + r * g[5]);
    }
    return out;
}

/// Same CRS, same spacing, and node on node (to a hundredth of a cell over the whole width).
bool in_phase(const Source& a, const Source& b) {
    if (!a.transform.north_up() || !b.transform.north_up() || !same_crs(a.crs, b.crs))
        return false;
    const double* p = a.transform.v;
    const double* q = b.transform.v;
    const double span = std::max(a.cols, b.cols) + std::max(a.rows, b.rows);
    if (std::abs(p[1] - q[1]) * span > 0.01 * p[1] || std::abs(p[5] - q[5]) * span > -0.01 * p[5])
        return false;
    const double dx = (q[0] - p[0]) / p[1], dy = (q[3] - p[3]) / p[5];
    return std::abs(dx - std::round(dx)) < 0.01 && std::abs(dy - std::round(dy)) < 0.01;
}

Dataset join(const std::vector<Source*>& tiles) {
    GdalMessages messages;
    std::vector<GDALDatasetH> handles;
    for (const Source* tile : tiles) {
        // GDAL would leave out tiles whose vertical datum is declared differently.
        const OGRSpatialReference plane = horizontal(tile->crs);
        tile->raster->SetSpatialRef(&plane);
        handles.push_back(GDALDataset::ToHandle(tile->raster.get()));
    }
    Arguments arguments{"-vrtnodata", "-32768"}; // each tile's own nodata is honoured as well
    GDALBuildVRTOptions* options = GDALBuildVRTOptionsNew(arguments.get(), nullptr);
    Dataset vrt(GDALDataset::FromHandle(
        GDALBuildVRT("", int(handles.size()), handles.data(), nullptr, options, nullptr)));
    GDALBuildVRTOptionsFree(options);
    if (!vrt || messages.warned()) // a warning means a tile left out
        throw Error("the tiles cannot be joined (" + messages.last() + ")",
                    "check with gdalinfo that they belong together");
    return vrt;
}

/// Reads a window of band 1; outside the raster and on nodata: NaN.
Grid<float> read_window(GDALDataset& ds, int col, int row, GridSize size) {
    Grid<float> out(size, void_m);
    const int c0 = std::max(col, 0), r0 = std::max(row, 0);
    const int c1 = std::min(col + size.cols, ds.GetRasterXSize());
    const int r1 = std::min(row + size.rows, ds.GetRasterYSize());
    if (c0 >= c1 || r0 >= r1)
        return out;
    GdalMessages messages;
    GDALRasterBand& band = *ds.GetRasterBand(1);
    float* first = out.values.data() + out.index({c0 - col, r0 - row});
    if (band.RasterIO(GF_Read, c0, r0, c1 - c0, r1 - r0, first, c1 - c0, r1 - r0, GDT_Float32, 4,
                      GSpacing(size.cols) * 4) != CE_None)
        throw Error("heights cannot be read (" + messages.last() + ")",
                    "the file may be cut off: check it with gdalinfo -checksum");
    int has_nodata = 0;
    const auto nodata = static_cast<float>(band.GetNoDataValue(&has_nodata));
    for (float& z : out.values) // no height on Earth exceeds 12 km: lost nodata tags do
        if ((has_nodata && z == nodata) || !(std::abs(z) < 12'000.0f))
            z = void_m;
    return out;
}

Dataset in_memory(const Grid<float>& grid, const GeoTransform& transform,
                  const OGRSpatialReference& crs) {
    auto* driver = GetGDALDriverManager()->GetDriverByName("MEM");
    Dataset out(driver->Create("", grid.size.cols, grid.size.rows, 1, GDT_Float32, nullptr));
    if (!out)
        throw Error("out of memory");
    GeoTransform copy = transform;
    out->SetGeoTransform(copy.v);
    out->SetSpatialRef(&crs);
    out->GetRasterBand(1)->SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
    if (out->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, grid.size.cols, grid.size.rows,
                                        const_cast<float*>(grid.values.data()), grid.size.cols,
                                        grid.size.rows, GDT_Float32, 0, 0) != CE_None)
        throw Error("out of memory");
    return out;
}

struct Target {
    GridSize size;
    Extent box; ///< outer edges of the cells around the nodes, projected coordinates
    std::string wkt;
};

Grid<float> warp(const std::vector<GDALDataset*>& inputs, const Target& target,
                 const std::string& resampling, const Progress& progress, const std::string& what,
                 double from, double to) {
    GdalMessages messages;
    std::vector<GDALDatasetH> handles;
    for (GDALDataset* input : inputs)
        handles.push_back(GDALDataset::ToHandle(input));
    Arguments arguments{"-of",
                        "MEM",
                        "-ot",
                        "Float32",
                        "-t_srs",
                        target.wkt,
                        "-te",
                        text(target.box.west),
                        text(target.box.south),
                        text(target.box.east),
                        text(target.box.north),
                        "-ts",
                        text(target.size.cols),
                        text(target.size.rows),
                        "-r",
                        resampling,
                        "-dstnodata",
                        "nan",
                        "-et",
                        "0.02",
                        "-wo",
                        "NUM_THREADS=ALL_CPUS",
                        "-novshiftgrid"};
    GDALWarpAppOptions* options = GDALWarpAppOptionsNew(arguments.get(), nullptr);
    GdalProgress watcher(progress, what, from, to);
    GDALWarpAppOptionsSetProgress(options, &GdalProgress::callback, &watcher);
    Dataset out(GDALDataset::FromHandle(
        GDALWarp("", nullptr, int(handles.size()), handles.data(), options, nullptr)));
    GDALWarpAppOptionsFree(options);
    watcher.check();
    if (!out)
        throw Error("the rasters cannot be warped (" + messages.last() + ")",
                    "check that the files are whole (gdalinfo -checksum) and their CRS is right");
    return read_window(*out, 0, 0, target.size);
}

void refuse_too_large(GridSize size, const MosaicOptions& options) {
    if (size.cols < 2 || size.rows < 2)
        throw Error(text("the region is only ", size.cols, " x ", size.rows, " nodes"),
                    "choose a larger --radius or --bounds, or a finer --spacing");
    if (size.cols > options.max_side || size.rows > options.max_side)
        throw Error(text("the scene would have ", size.cols, " x ", size.rows, " nodes, more than ",
                         options.max_side, " a side"),
                    "cut it with --at and --radius, or choose a coarser --spacing");
}

Extent wanted_extent(const Extent& available, const std::optional<Bounds>& bounds,
                     const OGRSpatialReference& crs) {
    if (!bounds)
        return available;
    auto to = between(wgs84(), crs);
    const Extent asked =
        image_of({bounds->west_deg, bounds->south_deg, bounds->east_deg, bounds->north_deg}, *to,
                 "--bounds");
    const Extent both = asked.clipped_to(available);
    if (both.empty())
        throw Error("the region asked for lies outside the elevation data",
                    "check --at, --radius or --bounds (degrees, WGS 84)");
    return both;
}

/// The straight case: every tile on one square metric grid; read, do not resample.
Mosaic keep_grid(std::vector<Source>& sources, const MosaicOptions& options,
                 const geo::Frame& projection, const Progress& progress) {
    const double* g = sources.front().transform.v;
    const double s = g[1];
    Extent all;
    std::vector<Source*> tiles;
    for (Source& source : sources) {
        const Extent box = outline(source);
        all.add(box.west, box.south);
        all.add(box.east, box.north);
        tiles.push_back(&source);
    }
    const Extent want = wanted_extent(all, options.bounds, sources.front().crs);
    // Whole cells, in phase with the first tile.
    const auto c0 = std::lround(std::floor((want.west - all.west) / s + 1e-6));
    const auto r0 = std::lround(std::floor((all.north - want.north) / s + 1e-6));
    const auto c1 = std::lround(std::ceil((want.east - all.west) / s - 1e-6));
    const auto r1 = std::lround(std::ceil((all.north - want.south) / s - 1e-6));
    const GridSize size{int(c1 - c0), int(r1 - r0)};
    refuse_too_large(size, options);

    Mosaic out;
    out.frame = projection;
    progress.report(0.1, "reading");
    if (tiles.size() == 1) {
        out.elevation_m = read_window(*tiles.front()->raster, int(c0), int(r0), size);
    } else {
        const Dataset vrt = join(tiles);
        double joined[6];
        vrt->GetGeoTransform(joined);
        const auto dc = std::lround((all.west - joined[0]) / s);
        const auto dr = std::lround((joined[3] - all.north) / s);
        out.elevation_m = read_window(*vrt, int(c0 + dc), int(r0 + dr), size);
    }
    out.spacing_m = s;
    const double west = all.west + (double(c0) + 0.5) * s;
    const double north = all.north - (double(r0) + 0.5) * s;
    // Whole metres for the origin keep the numbers in scene.json readable.
    out.frame.origin_easting_m = std::round(west + 0.5 * (size.cols - 1) * s);
    out.frame.origin_northing_m = std::round(north - 0.5 * (size.rows - 1) * s);
    out.west_m = west - out.frame.origin_easting_m;
    out.north_m = north - out.frame.origin_northing_m;
    const double reach = 0.5 * s * std::max(size.cols, size.rows);
    const double residual = sample_datum_shift(out.frame, sources.front().crs, reach);
    if (residual > 0.005)
        out.notes.push_back(text("latitude and longitude follow the datum shift to ",
                                 fixed(residual, 3), " m only"));
    return out;
}

/// Rounds down to three digits, so that a spacing reads well and loses nothing.
double three_digits(double x) {
    const double unit = std::pow(10.0, std::floor(std::log10(x)) - 2.0);
    return std::floor(x / unit + 1e-9) * unit;
}

constexpr int cubic_reach = 4; // nodes: two source cells at half their spacing

/// Could a cubic have dipped from above `level_m` to this node's height? By up to .15 of the
/// highest step within its kernel; real lower ground, below a dam say, lies beside no such step.
bool dipped(const Grid<float>& z, Node at, float level_m) {
    float highest = level_m;
    for (int dr = -cubic_reach; dr <= cubic_reach; ++dr)
        for (int dc = -cubic_reach; dc <= cubic_reach; ++dc) {
            const Node n{at.col + dc, at.row + dr};
            if (z.contains(n) && z[n] > highest)
                highest = z[n];
        }
    return z[at] > level_m - 0.15f * (highest - level_m) - 2.0f;
}

/// Puts flat surfaces into an interpolated ground, and lifts land beside them that a cubic pulled
/// below their level to just above it: no puddles along the shore.
void lay_flats(Grid<float>& z, const Grid<float>& flat) {
    struct Lift {
        Node at;
        float to;
    };
    std::vector<Lift> lifts;
    for (int row = 0; row < z.size.rows; ++row)
        for (int col = 0; col < z.size.cols; ++col) {
            const Node at{col, row};
            const float level = flat[at];
            if (std::isnan(level))
                continue;
            // Lower ground here comes from another raster that knows the bed: it stays.
            if (!(z[at] >= level || std::isnan(z[at]) || dipped(z, at, level)))
                continue;
            z[at] = level;
            bool rim = false;
            for (const Node n :
                 {Node{col - 1, row}, Node{col + 1, row}, Node{col, row - 1}, Node{col, row + 1}})
                rim |= z.contains(n) && std::isnan(flat[n]);
            for (int k = 0; rim && k < (2 * cubic_reach + 1) * (2 * cubic_reach + 1); ++k) {
                const Node n{col + k % (2 * cubic_reach + 1) - cubic_reach,
                             row + k / (2 * cubic_reach + 1) - cubic_reach};
                if (z.contains(n) && std::isnan(flat[n]) && z[n] < level + 0.01f &&
                    dipped(z, n, level))
                    lifts.push_back({n, level + 0.01f});
            }
        }
    for (const Lift& lift : lifts)
        z[lift.at] = std::max(z[lift.at], lift.to);
}

Mosaic warp_to_local(std::vector<Source>& sources, const MosaicOptions& options,
                     const Progress& progress) {
    Extent all;
    for (Source& source : sources) {
        auto to = between(source.crs, wgs84());
        const Extent box = image_of(outline(source), *to, source.name);
        all.add(box.west, box.south);
        all.add(box.east, box.north);
    }
    if (all.east - all.west > 60.0 || all.north - all.south > 60.0)
        throw Error(text("the data reach over ", fixed(all.east - all.west, 1), " x ",
                         fixed(all.north - all.south, 1), " degrees"),
                    "one scene serves one lake's surroundings: cut it with --at and --radius");
    Extent region = wanted_extent(all, options.bounds, wgs84());

    Mosaic out;
    out.frame =
        geo::local_frame({(region.south + region.north) / 2, (region.west + region.east) / 2});
    OGRSpatialReference local;
    local.SetFromUserInput(out.frame.proj.c_str());
    local.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    out.frame.wkt = wkt_of(local);

    // What the finest source resolves at its own place, along its finer axis.
    double spacing = 1e300;
    Extent box;
    for (Source& source : sources) {
        auto to = between(source.crs, local);
        const Extent image = image_of(outline(source), *to, source.name);
        box.add(image.west, image.south);
        box.add(image.east, image.north);
        const double* g = source.transform.v;
        const double c = source.cols / 2.0, r = source.rows / 2.0;
        double x[3] = {g[0] + c * g[1] + r * g[2], 0, 0}, y[3] = {g[3] + c * g[4] + r * g[5], 0, 0};
        x[1] = x[0] + g[1], y[1] = y[0] + g[4];
        x[2] = x[0] + g[2], y[2] = y[0] + g[5];
        GdalMessages quiet;
        if (to->Transform(3, x, y))
            spacing = std::min({spacing, std::hypot(x[1] - x[0], y[1] - y[0]),
                                std::hypot(x[2] - x[0], y[2] - y[0])});
    }
    if (!(spacing > 0.0 && spacing < 1e6))
        throw Error("the data's ground resolution cannot be worked out", "give --spacing M");
    const double native = spacing;
    if (options.bounds) {
        auto to = between(wgs84(), local);
        box = box.clipped_to(image_of(region, *to, "--bounds"));
    }
    // Sampling theory asks for half the source's spacing when the phases differ: a shore drawn
    // anew at the same spacing moves by up to half a cell (crater_lake: .8 % of its area, .1 % at
    // half). Large grids have shore enough for that to average out and stay at the source's.
    constexpr double affordable_side = 4096.0;
    const double side = std::max(box.east - box.west, box.north - box.south);
    spacing = options.spacing_m.value_or(
        three_digits(side / (0.5 * native) <= affordable_side ? 0.5 * native : native));

    Target target;
    target.size = {int(std::clamp(std::ceil((box.east - box.west) / spacing), 0.0, 1e8)),
                   int(std::clamp(std::ceil((box.north - box.south) / spacing), 0.0, 1e8))};
    refuse_too_large(target.size, options);
    const double cx = std::round((box.west + box.east) / 2),
                 cy = std::round((box.south + box.north) / 2);
    target.box = {cx - 0.5 * target.size.cols * spacing, cy - 0.5 * target.size.rows * spacing,
                  cx + 0.5 * target.size.cols * spacing, cy + 0.5 * target.size.rows * spacing};
    target.wkt = out.frame.wkt;
    out.spacing_m = spacing;
    out.west_m = target.box.west + 0.5 * spacing;
    out.north_m = target.box.north - 0.5 * spacing;

    // Tiles on one grid are joined first, so that no seam is interpolated where they abut.
    std::vector<std::vector<Source*>> groups;
    for (Source& source : sources) {
        auto home = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
            return in_phase(*group.front(), source);
        });
        if (home == groups.end())
            groups.push_back({&source});
        else
            home->push_back(&source);
    }
    std::vector<Dataset> joined;
    std::vector<GDALDataset*> inputs;
    for (const auto& group : groups) {
        if (group.size() == 1) {
            inputs.push_back(group.front()->raster.get());
        } else {
            joined.push_back(join(group));
            inputs.push_back(joined.back().get());
        }
    }
    const bool coarser = spacing > 1.5 * native;
    const std::string resampling = coarser ? "average" : "cubic";
    out.elevation_m = warp(inputs, target, resampling, progress, "warping", 0.05, 0.4);
    out.resampling = text(resampling, " from ", fixed(native, 2), " m to ", fixed(spacing, 2),
                          " m; flat water surfaces by nearest neighbour");
    if (groups.size() > 1)
        out.notes.push_back(text(groups.size(),
                                 " grids out of phase with each other were resampled "
                                 "onto one; where they overlap the last one counts"));

    // Water surfaces: nearest neighbour, so that level and area stay (see the header).
    std::vector<Dataset> flats;
    std::vector<GDALDataset*> flat_inputs;
    auto to_local = wgs84();
    for (std::size_t i = 0; i < groups.size(); ++i) {
        double g[6];
        inputs[i]->GetGeoTransform(g);
        // Only the part that the scene uses is read.
        Extent source_box;
        {
            auto back = between(local, groups[i].front()->crs);
            source_box = image_of(target.box, *back, "scene");
        }
        int c0 = 0, r0 = 0, c1 = inputs[i]->GetRasterXSize(), r1 = inputs[i]->GetRasterYSize();
        if (g[2] == 0.0 && g[4] == 0.0) {
            const double ca = (source_box.west - g[0]) / g[1], cb = (source_box.east - g[0]) / g[1];
            const double ra = (source_box.south - g[3]) / g[5],
                         rb = (source_box.north - g[3]) / g[5];
            c0 = std::max(c0, int(std::floor(std::min(ca, cb))) - 2);
            c1 = std::min(c1, int(std::ceil(std::max(ca, cb))) + 2);
            r0 = std::max(r0, int(std::floor(std::min(ra, rb))) - 2);
            r1 = std::min(r1, int(std::ceil(std::max(ra, rb))) + 2);
        }
        if (c0 >= c1 || r0 >= r1)
            continue;
        Grid<float> part = read_window(*inputs[i], c0, r0, {c1 - c0, r1 - r0});
        keep_only_flats(part);
        GeoTransform transform;
        std::copy(g, g + 6, transform.v);
        transform.v[0] = g[0] + c0 * g[1] + r0 * g[2];
        transform.v[3] = g[3] + c0 * g[4] + r0 * g[5];
        flats.push_back(in_memory(part, transform, groups[i].front()->crs));
        flat_inputs.push_back(flats.back().get());
        progress.report(0.45, "finding flat water");
    }
    if (!flat_inputs.empty()) {
        const Grid<float> level =
            warp(flat_inputs, target, "near", progress, "keeping lakes flat", 0.45, 0.6);
        lay_flats(out.elevation_m, level);
    }
    return out;
}

} // namespace

Mosaic build_mosaic(std::vector<Source>& sources, const MosaicOptions& options,
                    const Progress& progress) {
    if (sources.empty())
        throw Error("no elevation data given", "name at least one raster");
    const Source& first = sources.front();
    const double* g = first.transform.v;
    const auto projection = transverse_mercator(first.crs);
    const double drift = std::abs(g[1] + g[5]) * std::max(first.cols, first.rows);
    const bool square = first.transform.north_up() && drift < 0.01 * g[1];
    const bool one_grid = std::all_of(sources.begin(), sources.end(),
                                      [&](const Source& s) { return in_phase(first, s); });
    const bool same_spacing =
        !options.spacing_m || std::abs(*options.spacing_m / g[1] - 1.0) < 1e-6;
    if (projection && square && one_grid && same_spacing)
        return keep_grid(sources, options, *projection, progress);
    return warp_to_local(sources, options, progress);
}

Grid<float> onto_grid(Source& source, const Mosaic& mosaic, const std::string& resampling) {
    Target target;
    target.size = mosaic.elevation_m.size;
    const GeoTransform g =
        geo_transform(mosaic.frame, mosaic.west_m, mosaic.north_m, mosaic.spacing_m);
    target.box = {g.v[0], g.v[3] - target.size.rows * mosaic.spacing_m,
                  g.v[0] + target.size.cols * mosaic.spacing_m, g.v[3]};
    target.wkt = mosaic.frame.wkt;
    return warp({source.raster.get()}, target, resampling, Progress{}, "", 0.0, 1.0);
}

} // namespace tarn::dem
