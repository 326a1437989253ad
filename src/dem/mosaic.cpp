#include "dem/mosaic.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/source_water.hpp"
#include "dem/warp.hpp"
#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::dem {

namespace {

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
    const double span = double(std::max(a.cols, b.cols)) + double(std::max(a.rows, b.rows));
    if (std::abs(p[1] - q[1]) * span > 0.01 * p[1] || std::abs(p[5] - q[5]) * span > -0.01 * p[5])
        return false;
    const double dx = (q[0] - p[0]) / p[1], dy = (q[3] - p[3]) / p[5];
    return std::abs(dx - std::round(dx)) < 0.01 && std::abs(dy - std::round(dy)) < 0.01;
}

Dataset join(const std::vector<Source*>& tiles) {
    const double* first = tiles.front()->transform.v;
    std::vector<JoinedTile> parts;
    long left = 0, top = 0, right = 0, bottom = 0; // in pixels of the first tile
    for (const Source* tile : tiles) {
        const double* g = tile->transform.v;
        const long col = std::lround((g[0] - first[0]) / first[1]);
        const long row = std::lround((g[3] - first[3]) / first[5]);
        left = std::min(left, col);
        top = std::min(top, row);
        right = std::max(right, col + tile->cols);
        bottom = std::max(bottom, row + tile->rows);
        if (right - left > 2'000'000'000L || bottom - top > 2'000'000'000L)
            throw Error(tile->name + ": lies too far from the other tiles to be joined",
                        "import tiles that belong together");
        parts.push_back({tile->raster.get(), int(col), int(row)});
    }
    for (JoinedTile& part : parts) {
        part.col -= int(left);
        part.row -= int(top);
    }
    GeoTransform transform = tiles.front()->transform;
    transform.v[0] += double(left) * first[1];
    transform.v[3] += double(top) * first[5];
    return join_views(std::move(parts), transform, {int(right - left), int(bottom - top)},
                      horizontal(tiles.front()->crs));
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

/// Rounds down to two digits, so that a spacing reads well and loses nothing.
double two_digits(double x) {
    const double unit = std::pow(10.0, std::floor(std::log10(x)) - 1.0);
    return std::floor(x / unit + 1e-9) * unit;
}

/// The box of all sources [deg]. Tiles on both sides of the 180th meridian are brought side by
/// side: those west of it count on beyond 180 degrees.
Extent join_over_the_date_line(std::vector<Source>& sources) {
    const auto box_of = [](const Source& source) {
        auto to = between(source.crs, wgs84());
        return image_of(outline(source), *to, source.name);
    };
    Extent all;
    std::vector<Extent> boxes;
    for (const Source& source : sources) {
        boxes.push_back(box_of(source));
        all.add(boxes.back().west, boxes.back().south);
        all.add(boxes.back().east, boxes.back().north);
    }
    if (all.east - all.west <= 180.0)
        return all;
    Extent joined;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        if (boxes[i].east <= 0.0 && sources[i].crs.IsGeographic()) {
            sources[i].transform.v[0] += 360.0;
            sources[i].raster->SetGeoTransform(sources[i].transform.v);
            boxes[i].west += 360.0;
            boxes[i].east += 360.0;
        }
        joined.add(boxes[i].west, boxes[i].south);
        joined.add(boxes[i].east, boxes[i].north);
    }
    return joined;
}

Mosaic warp_to_local(std::vector<Source>& sources, const MosaicOptions& options,
                     const Progress& progress) {
    const Extent all = join_over_the_date_line(sources);
    std::optional<Bounds> bounds = options.bounds;
    if (bounds) { // a place may be counted from either side of the 180th meridian
        const double turn = bounds->east_deg < all.west   ? 360.0
                            : bounds->west_deg > all.east ? -360.0
                                                          : 0.0;
        bounds->west_deg += turn;
        bounds->east_deg += turn;
    }
    Extent region = wanted_extent(all, bounds, wgs84());

    if (region.east - region.west > 60.0 || region.north - region.south > 60.0)
        throw Error(text("the data reach over ", fixed(region.east - region.west, 1), " x ",
                         fixed(region.north - region.south, 1), " degrees"),
                    "one scene serves one lake's surroundings: cut it with --at and --radius");

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
        // The far ends of a world map have no place in a local projection: only what is used
        // counts.
        Extent used = outline(source);
        if (options.bounds) {
            auto back = between(wgs84(), source.crs);
            const Extent wanted = image_of(region, *back, source.name);
            used = used.clipped_to({wanted.west - 0.05 * (wanted.east - wanted.west),
                                    wanted.south - 0.05 * (wanted.north - wanted.south),
                                    wanted.east + 0.05 * (wanted.east - wanted.west),
                                    wanted.north + 0.05 * (wanted.north - wanted.south)});
            if (used.empty())
                continue;
        }
        const Extent image = image_of(used, *to, source.name);
        box.add(image.west, image.south);
        box.add(image.east, image.north);
        const double* g = source.transform.v;
        double x[3] = {(used.west + used.east) / 2, 0, 0},
               y[3] = {(used.south + used.north) / 2, 0, 0};
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
        two_digits(side / (0.5 * native) <= affordable_side ? 0.5 * native : native));

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
    std::vector<const OGRSpatialReference*> crs;
    for (const auto& group : groups)
        crs.push_back(&group.front()->crs);
    SourceWater water(target, inputs, crs, progress);
    out.stepped = water.stepped();
    for (GDALDataset* input : inputs)
        declare_voids(*input, water.has_voids());
    out.elevation_m = warp(inputs, target, resampling, progress, "warping", 0.15, 0.5);
    out.resampling = text(resampling, " from ", fixed(native, 2), " m to ", fixed(spacing, 2),
                          " m; flat water surfaces by nearest neighbour");
    if (groups.size() > 1)
        out.notes.push_back(text(groups.size(),
                                 " grids out of phase with each other were resampled "
                                 "onto one; where they overlap the last one counts"));

    out.laid = water.lay(out.elevation_m, !coarser, progress);
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

Grid<float> onto_grid(Source& source, const Mosaic& mosaic, Node north_west, GridSize size,
                      const std::string& resampling) {
    Target target;
    target.size = size;
    const GeoTransform g =
        geo_transform(mosaic.frame, mosaic.west_m + north_west.col * mosaic.spacing_m,
                      mosaic.north_m - north_west.row * mosaic.spacing_m, mosaic.spacing_m);
    target.box = {g.v[0], g.v[3] - size.rows * mosaic.spacing_m,
                  g.v[0] + size.cols * mosaic.spacing_m, g.v[3]};
    target.wkt = mosaic.frame.wkt;
    return warp({source.raster.get()}, target, resampling, Progress{}, "", 0.0, 1.0);
}

} // namespace tarn::dem
