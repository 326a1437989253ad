#include "dem/mosaic.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/flat.hpp"
#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>
#include <future>
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
    // No nodata is declared for the target: it begins as NaN and stays so where nothing is written,
    // and GDAL keeps to its quick kernels if the sources have no voids either.
    Arguments arguments{"-r",           resampling, "-et", "0.02", "-wo", "NUM_THREADS=ALL_CPUS",
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
    FlatRows() = default;
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
    int first_col_ = 0, first_row_ = 0;
    std::vector<std::vector<Span>> rows_;
};

/// Searches the part of a source that the scene uses, a few rows at a time.
/// @param voids  set if a node without data was met
FlatRows find_source_flats(GDALDataset& ds, int c0, int r0, int c1, int r1, bool& voids,
                           bool& stepped) {
    FlatFinder finder(c1 - c0);
    constexpr int strip = 64;
    // The next strip is read while this one is searched.
    const auto read = [&](int row) {
        return read_window(ds, c0, row, {c1 - c0, std::min(strip, r1 - row)});
    };
    auto coming = std::async(std::launch::async, read, r0);
    for (int row = r0; row < r1; row += strip) {
        const Grid<float> part = coming.get();
        if (row + strip < r1)
            coming = std::async(std::launch::async, read, row + strip);
        float sum = 0.0f; // NaN if any height is
        for (const float z : part.values)
            sum += z * 0.0f;
        voids |= std::isnan(sum);
        for (int r = 0; r < part.size.rows; ++r)
            finder.add_row(
                std::span(part.values).subspan(part.index({0, r}), std::size_t(part.size.cols)));
    }
    FlatRows out(finder.finish(), c0, r0, r1 - r0);
    stepped |= finder.stepped();
    return out;
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

    /// Source coordinates [pixels] of some target pixels' centres in a row; NaN where there are
    /// none.
    struct Row {
        std::vector<double> x, y;
    };
    void row(int row, int col, int cols, Row& out) {
        const auto n = std::size_t(cols);
        out.x.resize(n);
        out.y.assign(n, row + 0.5);
        z_.assign(n, 0.0);
        good_.assign(n, 0);
        for (std::size_t i = 0; i < n; ++i)
            out.x[i] = col + double(i) + 0.5;
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

constexpr int block_side = 64; // nodes; the unit in which places without water are passed over

/// The surfaces of one source, and how to find them from the target.
class FlatLayer {
public:
    FlatLayer(GDALDataset& source, const OGRSpatialReference& crs, const Target& target,
              bool& voids, bool& stepped)
        : source_(source) {
        source.GetGeoTransform(transform_.v);
        map_ = std::make_unique<PixelMap>(crs, transform_.v, target);
        OGRSpatialReference local;
        local.SetFromUserInput(target.wkt.c_str());
        local.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        // Only the part that the scene uses is read.
        auto back = between(local, crs);
        const Extent used = image_of(target.box, *back, "scene");
        const double* g = transform_.v;
        int c0 = 0, r0 = 0, c1 = source.GetRasterXSize(), r1 = source.GetRasterYSize();
        if (g[2] == 0.0 && g[4] == 0.0) {
            const double ca = (used.west - g[0]) / g[1], cb = (used.east - g[0]) / g[1];
            const double ra = (used.south - g[3]) / g[5], rb = (used.north - g[3]) / g[5];
            const auto pixel = [](double v) { return int(std::clamp(v, -1e9, 1e9)); };
            c0 = std::max(c0, pixel(std::floor(std::min(ca, cb))) - 2);
            c1 = std::min(c1, pixel(std::ceil(std::max(ca, cb))) + 2);
            r0 = std::max(r0, pixel(std::floor(std::min(ra, rb))) - 2);
            r1 = std::min(r1, pixel(std::ceil(std::max(ra, rb))) + 2);
        }
        if (c0 < c1 && r0 < r1)
            flats_ = find_source_flats(source, c0, r0, c1, r1, voids, stepped);
        find_blocks(target);
    }

    const std::vector<FlatSurface>& flats() const { return flats_.flats(); }
    PixelMap& map() { return *map_; }

    /// May this block of the target, counted in block_side, hold some of the surfaces?
    bool near(int block_col, int block_row) const {
        return blocks_.contains({block_col, block_row}) && blocks_[{block_col, block_row}];
    }
    /// The surface at a pixel of the source; -1: none.
    int at(int col, int row) const { return flats_.at(col, row); }
    /// The surface at a node: nearest neighbour, but for what keep_areas() changed.
    int at(std::size_t node, double x, double y) const {
        if (!changed.empty())
            if (const auto found = changed.find(node); found != changed.end())
                return found->second;
        return std::isnan(x) ? -1 : flats_.at(int(std::floor(x)), int(std::floor(y)));
    }
    double area(const FlatSurface& flat) {
        double sum = 0.0;
        for (const Run& run : flat.runs)
            sum += (run.last - run.first + 1) *
                   map_->pixel_area(flats_.first_col() + (run.first + run.last) / 2,
                                    flats_.first_row() + run.row);
        return sum;
    }
    /// Has the source a height at this pixel?
    bool covers(int col, int row) { return !std::isnan(height(col, row)); }
    /// Bilinear height at a place of the source [pixels]; NaN where it has none.
    float linear(double x, double y) {
        const int c = int(std::floor(x - 0.5)), r = int(std::floor(y - 0.5));
        const auto fx = float(x - 0.5 - c), fy = float(y - 0.5 - r);
        return (1 - fy) * ((1 - fx) * height(c, r) + fx * height(c + 1, r)) +
               fy * ((1 - fx) * height(c, r + 1) + fx * height(c + 1, r + 1));
    }

    std::unordered_map<std::size_t, int> changed; ///< node -> surface (-1: none) against "nearest"

private:
    /// Heights by windows that are kept: neighbours ask for neighbours.
    float height(int col, int row) {
        if (col < 0 || row < 0 || col >= source_.GetRasterXSize() ||
            row >= source_.GetRasterYSize())
            return void_m;
        constexpr int side = 256;
        if (window_.values.empty() || col < window_col_ || row < window_row_ ||
            col >= window_col_ + side || row >= window_row_ + side) {
            window_col_ = col / side * side;
            window_row_ = row / side * side;
            window_ = read_window(source_, window_col_, window_row_, {side, side});
        }
        return window_[{col - window_col_, row - window_row_}];
    }

    void find_blocks(const Target& target) {
        blocks_ = Grid<unsigned char>({(target.size.cols + block_side - 1) / block_side,
                                       (target.size.rows + block_side - 1) / block_side});
        if (flats().empty())
            return;
        // Which coarse squares of the source hold water?
        constexpr int coarse = 32;
        Grid<unsigned char> water(
            {source_.GetRasterXSize() / coarse + 1, source_.GetRasterYSize() / coarse + 1});
        for (const FlatSurface& flat : flats())
            for (const Run& run : flat.runs)
                for (int c = (flats_.first_col() + run.first) / coarse;
                     c <= (flats_.first_col() + run.last) / coarse; ++c)
                    water[{c, (flats_.first_row() + run.row) / coarse}] = 1;
        PixelMap::Row places;
        for (int row = 0; row < blocks_.size.rows; ++row)
            for (int col = 0; col < blocks_.size.cols; ++col) {
                // The image of a block is nearly straight: its corners, and a margin, bound it.
                Extent box;
                bool whole = true;
                for (const int edge : {row * block_side - 1, (row + 1) * block_side}) {
                    map_->row(edge, col * block_side - 1, block_side + 2, places);
                    for (std::size_t i = 0; i < places.x.size(); i += places.x.size() - 1) {
                        whole &= !std::isnan(places.x[i]);
                        box.add(places.x[i], places.y[i]);
                    }
                }
                bool found = !whole; // looked at more closely
                const double margin = 2.0;
                const auto square = [&](double v, int last) {
                    return std::clamp(int(std::floor(v / coarse)), 0, last);
                };
                if (whole && box.east + margin >= 0.0 && box.north + margin >= 0.0 &&
                    box.west - margin <= source_.GetRasterXSize() &&
                    box.south - margin <= source_.GetRasterYSize())
                    for (int r = square(box.south - margin, water.size.rows - 1);
                         r <= square(box.north + margin, water.size.rows - 1) && !found; ++r)
                        for (int c = square(box.west - margin, water.size.cols - 1);
                             c <= square(box.east + margin, water.size.cols - 1); ++c)
                            found |= water[{c, r}] != 0;
                blocks_[{col, row}] = found;
            }
    }

    GDALDataset& source_;
    GeoTransform transform_;
    std::unique_ptr<PixelMap> map_;
    FlatRows flats_;
    Grid<unsigned char> blocks_; ///< of the target
    Grid<float> window_;
    int window_col_ = 0, window_row_ = 0;
};

/// Visits the nodes of a block, a row at a time: visit(first node, count).
template <class Visit>
void each_block_row(const Target& target, int block_col, int block_row, Visit visit) {
    const int col = block_col * block_side;
    const int cols = std::min(block_side, target.size.cols - col);
    for (int row = block_row * block_side;
         row < std::min((block_row + 1) * block_side, target.size.rows); ++row)
        visit(Node{col, row}, cols);
}

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
    std::vector<Balance> balance(layer.flats().size());
    if (balance.empty())
        return;
    constexpr double reach = 0.35; // pixels; the correction needs a tenth of that
    const int cols = target.size.cols, rows = target.size.rows;
    PixelMap::Row places;
    const auto look = [&](Node n, double x, double y) {
        if (std::isnan(x))
            return;
        const int px = int(std::floor(x)), py = int(std::floor(y));
        const double fx = x - px, fy = y - py;
        const int here = layer.at(px, py);
        const std::size_t node = std::size_t(n.row) * std::size_t(cols) + std::size_t(n.col);
        if (here >= 0) {
            Balance& b = balance[std::size_t(here)];
            ++b.inside;
            b.cut |= n.row == 0 || n.col == 0 || n.row + 1 == rows || n.col + 1 == cols;
        }
        // Only the neighbours on the node's own side can be near.
        const int sx = fx < 0.5 ? -1 : 1, sy = fy < 0.5 ? -1 : 1;
        const double dx = fx < 0.5 ? fx : 1.0 - fx, dy = fy < 0.5 ? fy : 1.0 - fy;
        if (std::min(dx, dy) >= reach)
            return;
        const struct {
            int flat;
            double distance;
        } beside[3] = {{layer.at(px + sx, py), dx},
                       {layer.at(px, py + sy), dy},
                       {layer.at(px + sx, py + sy), std::sqrt(dx * dx + dy * dy)}};
        double nearest = reach;
        int other = -1;
        for (const auto& b : beside)
            if (b.distance < nearest && b.flat != here && (here >= 0 || b.flat >= 0)) {
                nearest = b.distance;
                other = b.flat;
            }
        if (nearest == reach)
            return;
        if (here >= 0)
            balance[std::size_t(here)].in.push_back({float(nearest), node});
        else
            balance[std::size_t(other)].out.push_back({float(nearest), node});
    };
    for (int br = 0; br * block_side < rows; ++br)
        for (int bc = 0; bc * block_side < cols; ++bc)
            if (layer.near(bc, br))
                each_block_row(target, bc, br, [&](Node first, int count) {
                    layer.map().row(first.row, first.col, count, places);
                    for (int i = 0; i < count; ++i)
                        look({first.col + i, first.row}, places.x[std::size_t(i)],
                             places.y[std::size_t(i)]);
                });
    for (std::size_t i = 0; i < balance.size(); ++i) {
        Balance& b = balance[i];
        if (b.cut || b.inside == 0)
            continue;
        const long lacking = std::lround(layer.area(layer.flats()[i])) - long(b.inside);
        std::vector<Near>& from = lacking > 0 ? b.out : b.in;
        const auto count = std::min(std::size_t(std::abs(lacking)), from.size());
        std::partial_sort(from.begin(), from.begin() + std::ptrdiff_t(count), from.end(),
                          [](const Near& l, const Near& r) { return l.distance < r.distance; });
        for (std::size_t k = 0; k < count; ++k)
            layer.changed[from[k].node] = lacking > 0 ? int(i) : -1;
    }
}

/// Finds the water surfaces of all sources, and whether these have voids.
std::vector<std::unique_ptr<FlatLayer>>
find_layers(const Target& target, const std::vector<GDALDataset*>& inputs,
            const std::vector<const OGRSpatialReference*>& crs, bool& voids, bool& stepped,
            const Progress& progress) {
    std::vector<std::unique_ptr<FlatLayer>> layers;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        progress.report(0.02 + 0.13 * double(i) / double(inputs.size()), "finding flat water");
        layers.push_back(std::make_unique<FlatLayer>(*inputs[i], *crs[i], target, voids, stepped));
        keep_areas(*layers.back(), target);
    }
    return layers;
}

/// Water surfaces by nearest neighbour: level and area stay (see the header). Then land beside
/// them that a cubic pulled below their level, although bilinear interpolation keeps it above, is
/// lifted: no puddles along the shore. Land that is really lower (a polder, the river below a dam)
/// is lower in both.
/// @return 1 where a surface was laid
Grid<std::uint8_t> keep_flats(Grid<float>& z, const Target& target,
                              const std::vector<std::unique_ptr<FlatLayer>>& layers, bool cubic,
                              const Progress& progress) {
    progress.report(0.5, "keeping lakes flat");
    const int block_cols = (target.size.cols + block_side - 1) / block_side;
    const int block_rows = (target.size.rows + block_side - 1) / block_side;
    const auto each_near_block = [&](auto visit) {
        for (int br = 0; br < block_rows; ++br)
            for (int bc = 0; bc < block_cols; ++bc)
                if (std::any_of(layers.begin(), layers.end(),
                                [&](const auto& layer) { return layer->near(bc, br); }))
                    visit(bc, br);
    };
    enum : std::uint8_t { land, water, tried };
    Grid<std::uint8_t> kind(z.size, land);
    PixelMap::Row places;
    std::vector<int> surface(block_side), owner(block_side);
    each_near_block([&](int bc, int br) {
        each_block_row(target, bc, br, [&](Node first, int count) {
            std::fill(surface.begin(), surface.end(), -1);
            const std::size_t start = z.index(first);
            for (std::size_t k = 0; k < layers.size(); ++k) { // the last that covers a place counts
                FlatLayer& layer = *layers[k];
                const bool near = layer.near(bc, br);
                if (!near &&
                    std::all_of(surface.begin(), surface.end(), [](int s) { return s < 0; }))
                    continue;
                layer.map().row(first.row, first.col, count, places);
                for (std::size_t i = 0; i < std::size_t(count); ++i) {
                    const double x = places.x[i], y = places.y[i];
                    const int here = near ? layer.at(start + i, x, y) : -1;
                    if (here >= 0) {
                        surface[i] = here;
                        owner[i] = int(k);
                    } else if (surface[i] >= 0 && !std::isnan(x) &&
                               layer.covers(int(std::floor(x)), int(std::floor(y)))) {
                        surface[i] = -1;
                    }
                }
            }
            for (std::size_t i = 0; i < std::size_t(count); ++i)
                if (surface[i] >= 0) {
                    const FlatLayer& layer = *layers[std::size_t(owner[i])];
                    z.values[start + i] = layer.flats()[std::size_t(surface[i])].level_m;
                    kind.values[start + i] = water;
                }
        });
    });
    const auto only_water = [&] {
        for (std::uint8_t& k : kind.values)
            k = k == water;
        return std::move(kind);
    };
    if (!cubic)
        return only_water();
    constexpr float puddle_m = 0.01f; // pits shallower than this beside a lake are noise
    const auto lift = [&](Node n, float level) {
        kind[n] = tried;
        // The last layer with a height here made this node.
        for (std::size_t k = layers.size(); k-- > 0;) {
            layers[k]->map().row(n.row, n.col, 1, places);
            const float linear =
                std::isnan(places.x[0]) ? void_m : layers[k]->linear(places.x[0], places.y[0]);
            if (std::isnan(linear))
                continue;
            if (linear >= level - puddle_m)
                z[n] = std::max(linear, std::nextafter(level, std::numeric_limits<float>::max()));
            return;
        }
    };
    each_near_block([&](int bc, int br) {
        each_block_row(target, bc, br, [&](Node first, int count) {
            for (int i = 0; i < count; ++i) {
                const Node at{first.col + i, first.row};
                if (kind[at] != water)
                    continue;
                const float level = z[at];
                bool rim = false;
                for (const Node n : {Node{at.col - 1, at.row}, Node{at.col + 1, at.row},
                                     Node{at.col, at.row - 1}, Node{at.col, at.row + 1}})
                    rim |= z.contains(n) && kind[n] != water;
                if (!rim)
                    continue;
                for (int row = std::max(at.row - cubic_reach, 0);
                     row <= std::min(at.row + cubic_reach, z.size.rows - 1); ++row)
                    for (int col = std::max(at.col - cubic_reach, 0);
                         col <= std::min(at.col + cubic_reach, z.size.cols - 1); ++col)
                        if (kind[{col, row}] == land && z[{col, row}] <= level)
                            lift({col, row}, level);
            }
        });
    });
    return only_water();
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
    bool voids = false;
    const auto layers = find_layers(target, inputs, crs, voids, out.stepped, progress);
    for (std::size_t i = 0; i < groups.size(); ++i)
        for (GDALDataset* input : {inputs[i], groups[i].front()->raster.get()})
            declare_voids(*input, voids);
    out.elevation_m = warp(inputs, target, resampling, progress, "warping", 0.15, 0.5);
    out.resampling = text(resampling, " from ", fixed(native, 2), " m to ", fixed(spacing, 2),
                          " m; flat water surfaces by nearest neighbour");
    if (groups.size() > 1)
        out.notes.push_back(text(groups.size(),
                                 " grids out of phase with each other were resampled "
                                 "onto one; where they overlap the last one counts"));

    out.laid = keep_flats(out.elevation_m, target, layers, !coarser, progress);
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
