#include "dem/mosaic.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/flat.hpp"
#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>
#include <gdal_alg.h>
#include <gdal_utils.h>
#include <limits>
#include <memory>
#include <span>
#include <unordered_map>

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
    Arguments arguments{"-vrtnodata", "nan"};
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
    return out; // views hold NaN where there is no data
}

struct Target {
    GridSize size;
    Extent box; ///< outer edges of the cells around the nodes, projected coordinates
    std::string wkt;
    GeoTransform transform() const {
        return {{box.west, (box.east - box.west) / size.cols, 0.0, box.north, 0.0,
                 -(box.north - box.south) / size.rows}};
    }
};

Grid<float> warp(const std::vector<GDALDataset*>& inputs, const Target& target,
                 const std::string& resampling, const Progress& progress, const std::string& what,
                 double from, double to) {
    GdalMessages messages;
    std::vector<GDALDatasetH> handles;
    for (GDALDataset* input : inputs)
        handles.push_back(GDALDataset::ToHandle(input));
    Grid<float> out(target.size, void_m);
    Dataset onto = wrap_memory(out.values.data(), target.size, GDT_Float32);
    OGRSpatialReference crs;
    crs.SetFromUserInput(target.wkt.c_str());
    GeoTransform transform = target.transform();
    onto->SetGeoTransform(transform.v);
    onto->SetSpatialRef(&crs);
    onto->GetRasterBand(1)->SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
    Arguments arguments{"-r", resampling, "-et", "0.02", "-wo", "NUM_THREADS=ALL_CPUS",
                        "-novshiftgrid"};
    GDALWarpAppOptions* options = GDALWarpAppOptionsNew(arguments.get(), nullptr);
    GdalProgress watcher(progress, what, from, to);
    GDALWarpAppOptionsSetProgress(options, &GdalProgress::callback, &watcher);
    const bool done = GDALWarp(nullptr, GDALDataset::ToHandle(onto.get()), int(handles.size()),
                               handles.data(), options, nullptr) != nullptr;
    GDALWarpAppOptionsFree(options);
    watcher.check();
    if (!done || messages.failed())
        throw Error("the rasters cannot be warped (" + messages.last() + ")",
                    "check that the files are whole (gdalinfo -checksum) and their CRS is right");
    onto->FlushCache(false);
    return out;
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

constexpr int cubic_reach = 4; // nodes: two source cells at half their spacing

/// Flat surfaces of one source grid, to be asked by pixel.
class FlatRows {
public:
    FlatRows(std::vector<FlatSurface> flats, int first_col, int first_row, int rows)
        : flats_(std::move(flats)), first_col_(first_col), first_row_(first_row),
          rows_(std::size_t(rows)) {
        for (std::size_t i = 0; i < flats_.size(); ++i)
            for (const Run& run : flats_[i].runs)
                rows_[std::size_t(run.row)].push_back({run.first, run.last, int(i)});
        for (auto& row : rows_)
            std::sort(row.begin(), row.end(),
                      [](const Span& a, const Span& b) { return a.first < b.first; });
    }
    const std::vector<FlatSurface>& flats() const { return flats_; }
    int first_col() const { return first_col_; }
    int first_row() const { return first_row_; }

    /// Which surface a pixel of the source belongs to; -1: none.
    int at(int col, int row) const {
        col -= first_col_;
        row -= first_row_;
        if (row < 0 || row >= int(rows_.size()))
            return -1;
        const auto& spans = rows_[std::size_t(row)];
        auto after = std::upper_bound(spans.begin(), spans.end(), col,
                                      [](int c, const Span& s) { return c < s.first; });
        return after != spans.begin() && (--after)->last >= col ? after->flat : -1;
    }

private:
    struct Span {
        int first, last, flat;
    };
    std::vector<FlatSurface> flats_;
    int first_col_, first_row_;
    std::vector<std::vector<Span>> rows_;
};

/// Searches the part of a source that the scene uses, a few rows at a time.
FlatRows find_source_flats(GDALDataset& ds, int c0, int r0, int c1, int r1) {
    FlatFinder finder(c1 - c0);
    constexpr int strip = 64;
    for (int row = r0; row < r1; row += strip) {
        const Grid<float> part = read_window(ds, c0, row, {c1 - c0, std::min(strip, r1 - row)});
        for (int r = 0; r < part.size.rows; ++r)
            finder.add_row(std::span(part.values)
                               .subspan(part.index({0, r}), std::size_t(part.size.cols)));
    }
    return {finder.finish(), c0, r0, r1 - r0};
}

/// Between the target's pixels and a source's, as gdalwarp goes.
class PixelMap {
public:
    PixelMap(const OGRSpatialReference& source_crs, const double source_transform[6],
             const Target& target) {
        OGRSpatialReference local;
        local.SetFromUserInput(target.wkt.c_str());
        local.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        const OGRSpatialReference plane = horizontal(source_crs);
        const GeoTransform onto = target.transform();
        GdalMessages messages;
        exact_ = GDALCreateGenImgProjTransformer3(wkt_of(plane).c_str(), source_transform,
                                                  wkt_of(local).c_str(), onto.v);
        if (!exact_)
            throw Error("water surfaces cannot be placed in the scene (" + messages.last() + ")",
                        "check the CRS");
        quick_ = GDALCreateApproxTransformer(GDALGenImgProjTransform, exact_, 0.02);
    }
    ~PixelMap() {
        GDALDestroyApproxTransformer(quick_);
        GDALDestroyGenImgProjTransformer(exact_);
    }
    PixelMap(const PixelMap&) = delete;
    PixelMap& operator=(const PixelMap&) = delete;

    /// Source coordinates [pixels] of the target's pixel centres in a row; NaN where there are
    /// none.
    struct Row {
        std::vector<double> x, y;
    };
    void row(int row, int cols, Row& out) {
        const auto n = std::size_t(cols);
        out.x.resize(n);
        out.y.assign(n, row + 0.5);
        z_.assign(n, 0.0);
        good_.assign(n, 0);
        for (std::size_t i = 0; i < n; ++i)
            out.x[i] = double(i) + 0.5;
        GdalMessages quiet;
        GDALApproxTransform(quick_, TRUE, cols, out.x.data(), out.y.data(), z_.data(),
                            good_.data());
        for (std::size_t i = 0; i < n; ++i)
            if (!good_[i] || !(std::abs(out.x[i]) < 1e9 && std::abs(out.y[i]) < 1e9))
                out.x[i] = out.y[i] = std::numeric_limits<double>::quiet_NaN();
    }
    /// Area that a source pixel covers in the target, in target pixels.
    double pixel_area(int col, int row) {
        double x[4] = {col + 0.0, col + 1.0, col + 1.0, col + 0.0};
        double y[4] = {row + 0.0, row + 0.0, row + 1.0, row + 1.0};
        double z[4] = {};
        int good[4] = {};
        GdalMessages quiet;
        GDALGenImgProjTransform(exact_, FALSE, 4, x, y, z, good);
        double twice = 0.0;
        for (int k = 0; k < 4; ++k) {
            const int m = (k + 1) % 4;
            if (!good[k])
                return 0.0;
            twice += x[k] * y[m] - x[m] * y[k];
        }
        return 0.5 * std::abs(twice);
    }

private:
    void* exact_ = nullptr;
    void* quick_ = nullptr;
    std::vector<double> z_;
    std::vector<int> good_;
};

struct Lift {
    Node at;
    float to;
};

/// Puts the flat surfaces of rows [r0, r1) into a ground that cubics interpolated, and notes land
/// beside them that a cubic pulled below their level although bilinear interpolation keeps it
/// above: it is to be lifted, so that there are no puddles along the shore. Land that is really
/// lower (a polder, the river below a dam) is lower in both.
/// @param flat    levels of rows [r0 - cubic_reach, r1 + cubic_reach), NaN outside surfaces
/// @param linear  heights of the same rows by bilinear interpolation; empty: lift nothing
void lay_flats(Grid<float>& z, const Grid<float>& flat, const Grid<float>& linear, int r0, int r1,
               std::vector<Lift>& lifts) {
    const int top = r0 - cubic_reach;
    constexpr int width = 2 * cubic_reach + 1;
    constexpr float puddle_m = 0.01f; // pits shallower than this beside a lake are noise
    for (int row = r0; row < r1; ++row)
        for (int col = 0; col < z.size.cols; ++col) {
            const Node at{col, row};
            const float level = flat[{col, row - top}];
            if (std::isnan(level))
                continue;
            z[at] = level;
            if (linear.values.empty())
                continue;
            bool rim = false;
            for (const Node n :
                 {Node{col - 1, row}, Node{col + 1, row}, Node{col, row - 1}, Node{col, row + 1}})
                rim |= z.contains(n) && std::isnan(flat[{n.col, n.row - top}]);
            for (int k = 0; rim && k < width * width; ++k) {
                const Node n{col + k % width - cubic_reach, row + k / width - cubic_reach};
                const Node in_strip{n.col, n.row - top};
                if (z.contains(n) && std::isnan(flat[in_strip]) && !(z[n] > level) &&
                    linear[in_strip] >= level - puddle_m)
                    lifts.push_back(
                        {n, std::max(linear[in_strip],
                                     std::nextafter(level, std::numeric_limits<float>::max()))});
            }
        }
}

/// The surfaces of one source, and how to find them from the target.
struct FlatLayer {
    FlatRows flats;
    std::unique_ptr<PixelMap> map;
    GDALDataset* source;
    std::unordered_map<std::size_t, int> changed; ///< node -> surface (-1: none) against "nearest"

    /// Has it a height at this pixel? (Asked only where layers overlap on a surface.)
    bool covers(int col, int row) const {
        if (col < 0 || row < 0 || col >= source->GetRasterXSize() ||
            row >= source->GetRasterYSize())
            return false;
        return !std::isnan(read_window(*source, col, row, {1, 1}).values[0]);
    }
    /// The surface at a node: nearest neighbour, but for what keep_areas() changed.
    int at(std::size_t node, double x, double y) const {
        if (!changed.empty())
            if (const auto found = changed.find(node); found != changed.end())
                return found->second;
        return std::isnan(x) ? -1 : flats.at(int(std::floor(x)), int(std::floor(y)));
    }
};

/// Nearest neighbour moves a shore by up to half a cell here and there; over a small lake that is a
/// percent of its area. Nodes at the very rim are given or taken, the nearest to it first, until
/// the nodes count the source's area. Surfaces that the target's edge cuts stay as they are.
void keep_areas(FlatLayer& layer, const Target& target) {
    struct Near {
        float distance; ///< to the surface's rim, in source pixels
        std::size_t node;
    };
    struct Balance {
        std::size_t inside = 0;
        bool cut = false;
        std::vector<Near> in, out;
    };
    std::vector<Balance> balance(layer.flats.flats().size());
    if (balance.empty())
        return;
    constexpr double reach = 0.35; // pixels; the correction needs a tenth of that
    const int cols = target.size.cols;
    PixelMap::Row places;
    for (int row = 0; row < target.size.rows; ++row) {
        layer.map->row(row, cols, places);
        for (int col = 0; col < cols; ++col) {
            const double x = places.x[std::size_t(col)], y = places.y[std::size_t(col)];
            if (std::isnan(x))
                continue;
            const int px = int(std::floor(x)), py = int(std::floor(y));
            const double fx = x - px, fy = y - py;
            const int here = layer.flats.at(px, py);
            const std::size_t node = std::size_t(row) * std::size_t(cols) + std::size_t(col);
            if (here >= 0) {
                Balance& b = balance[std::size_t(here)];
                ++b.inside;
                b.cut |= row == 0 || col == 0 || row + 1 == target.size.rows || col + 1 == cols;
            }
            // Only the neighbours on the node's own side can be near.
            const int sx = fx < 0.5 ? -1 : 1, sy = fy < 0.5 ? -1 : 1;
            const double dx = fx < 0.5 ? fx : 1.0 - fx, dy = fy < 0.5 ? fy : 1.0 - fy;
            if (std::min(dx, dy) >= reach)
                continue;
            const struct {
                int flat;
                double distance;
            } beside[3] = {{layer.flats.at(px + sx, py), dx},
                           {layer.flats.at(px, py + sy), dy},
                           {layer.flats.at(px + sx, py + sy), std::hypot(dx, dy)}};
            double nearest = reach;
            int other = -1;
            for (const auto& b : beside)
                if (b.distance < nearest && b.flat != here && (here >= 0 || b.flat >= 0)) {
                    nearest = b.distance;
                    other = b.flat;
                }
            if (nearest == reach)
                continue;
            if (here >= 0)
                balance[std::size_t(here)].in.push_back({float(nearest), node});
            else
                balance[std::size_t(other)].out.push_back({float(nearest), node});
        }
    }
    for (std::size_t i = 0; i < balance.size(); ++i) {
        Balance& b = balance[i];
        const FlatSurface& flat = layer.flats.flats()[i];
        if (b.cut || b.inside == 0)
            continue;
        double area = 0.0;
        for (const Run& run : flat.runs)
            area += (run.last - run.first + 1) *
                    layer.map->pixel_area(layer.flats.first_col() + (run.first + run.last) / 2,
                                          layer.flats.first_row() + run.row);
        const long lacking = std::lround(area) - long(b.inside);
        std::vector<Near>& from = lacking > 0 ? b.out : b.in;
        const auto count = std::min(std::size_t(std::abs(lacking)), from.size());
        std::partial_sort(from.begin(), from.begin() + std::ptrdiff_t(count), from.end(),
                          [](const Near& l, const Near& r) { return l.distance < r.distance; });
        for (std::size_t k = 0; k < count; ++k)
            layer.changed[from[k].node] = lacking > 0 ? int(i) : -1;
    }
}

/// Water surfaces by nearest neighbour, strip by strip: level and area stay (see the header).
void keep_flats(Grid<float>& z, const Target& target, const std::vector<GDALDataset*>& inputs,
                const std::vector<const OGRSpatialReference*>& crs, bool cubic,
                const Progress& progress) {
    std::vector<FlatLayer> layers;
    OGRSpatialReference local;
    local.SetFromUserInput(target.wkt.c_str());
    local.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        progress.report(0.42 + 0.08 * double(i) / double(inputs.size()), "finding flat water");
        double g[6];
        inputs[i]->GetGeoTransform(g);
        // Only the part that the scene uses is read.
        auto back = between(local, *crs[i]);
        const Extent used = image_of(target.box, *back, "scene");
        int c0 = 0, r0 = 0, c1 = inputs[i]->GetRasterXSize(), r1 = inputs[i]->GetRasterYSize();
        if (g[2] == 0.0 && g[4] == 0.0) {
            const double ca = (used.west - g[0]) / g[1], cb = (used.east - g[0]) / g[1];
            const double ra = (used.south - g[3]) / g[5], rb = (used.north - g[3]) / g[5];
            const auto pixel = [](double v) { return int(std::clamp(v, -1e9, 1e9)); };
            c0 = std::max(c0, pixel(std::floor(std::min(ca, cb))) - 2);
            c1 = std::min(c1, pixel(std::ceil(std::max(ca, cb))) + 2);
            r0 = std::max(r0, pixel(std::floor(std::min(ra, rb))) - 2);
            r1 = std::min(r1, pixel(std::ceil(std::max(ra, rb))) + 2);
        }
        if (c0 >= c1 || r0 >= r1)
            continue;
        layers.push_back({.flats = find_source_flats(*inputs[i], c0, r0, c1, r1),
                          .map = std::make_unique<PixelMap>(*crs[i], g, target),
                          .source = inputs[i],
                          .changed = {}});
        keep_areas(layers.back(), target);
    }
    std::vector<Lift> lifts;
    PixelMap::Row places;
    constexpr int strip = 512;
    for (int r0 = 0; r0 < target.size.rows; r0 += strip) {
        progress.report(0.5 + 0.1 * r0 / target.size.rows, "keeping lakes flat");
        const int r1 = std::min(r0 + strip, target.size.rows);
        Grid<float> flat({target.size.cols, r1 - r0 + 2 * cubic_reach}, void_m);
        bool any = false;
        const int top = std::max(r0 - cubic_reach, 0),
                  bottom = std::min(r1 + cubic_reach, target.size.rows);
        for (int row = top; row < bottom; ++row)
            for (FlatLayer& layer : layers) { // the last one that covers a place counts
                if (layer.flats.flats().empty() && !any)
                    continue;
                layer.map->row(row, target.size.cols, places);
                for (int col = 0; col < target.size.cols; ++col) {
                    const double x = places.x[std::size_t(col)], y = places.y[std::size_t(col)];
                    const int surface = layer.at(
                        std::size_t(row) * std::size_t(target.size.cols) + std::size_t(col), x, y);
                    float& here = flat[{col, row - r0 + cubic_reach}];
                    if (surface >= 0) {
                        here = layer.flats.flats()[std::size_t(surface)].level_m;
                        any = true;
                    } else if (!std::isnan(here) && !std::isnan(x) &&
                               layer.covers(int(std::floor(x)), int(std::floor(y)))) {
                        here = void_m;
                    }
                }
            }
        if (!any)
            continue;
        Grid<float> linear;
        if (cubic) {
            Target part = target;
            part.size.rows = bottom - top;
            const double s = (target.box.north - target.box.south) / target.size.rows;
            part.box.north = target.box.north - top * s;
            part.box.south = target.box.north - bottom * s;
            const Grid<float> rows = warp(inputs, part, "bilinear", Progress{}, "", 0.0, 1.0);
            linear = Grid<float>(flat.size, void_m);
            std::copy(rows.values.begin(), rows.values.end(),
                      linear.values.begin() +
                          std::ptrdiff_t(linear.index({0, top - r0 + cubic_reach})));
        }
        lay_flats(z, flat, linear, r0, r1, lifts);
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
    out.elevation_m = warp(inputs, target, resampling, progress, "warping", 0.05, 0.4);
    out.resampling = text(resampling, " from ", fixed(native, 2), " m to ", fixed(spacing, 2),
                          " m; flat water surfaces by nearest neighbour");
    if (groups.size() > 1)
        out.notes.push_back(text(groups.size(),
                                 " grids out of phase with each other were resampled "
                                 "onto one; where they overlap the last one counts"));

    std::vector<const OGRSpatialReference*> crs;
    for (const auto& group : groups)
        crs.push_back(&group.front()->crs);
    keep_flats(out.elevation_m, target, inputs, crs, !coarser, progress);
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
