#include "dem/source_water.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/crs.hpp"
#include "dem/flat.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <gdal_alg.h>
#include <span>
#include <unordered_map>

namespace tarn::dem {

namespace {

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

/// Visits the nodes of a block, a row at a time: visit(first node, count).
template <class Visit>
void each_block_row(const Target& target, int block_col, int block_row, Visit visit) {
    const int col = block_col * block_side;
    const int cols = std::min(block_side, target.size.cols - col);
    for (int row = block_row * block_side;
         row < std::min((block_row + 1) * block_side, target.size.rows); ++row)
        visit(Node{col, row}, cols);
}

} // namespace

/// The surfaces of one source, and how to find them from the target.
class SourceWater::Layer {
public:
    Layer(GDALDataset& source, const OGRSpatialReference& crs, const Target& target, bool& voids,
          bool& stepped)
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
        if (!changed_.empty())
            if (const auto found = changed_.find(node); found != changed_.end())
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

    /// Nearest neighbour moves a shore by up to half a cell here and there; over a small lake that
    /// is a percent of its area. Nodes at the very rim are given or taken, the nearest to it first,
    /// until the nodes count the source's area. Surfaces that the target's edge cuts stay as they
    /// are.
    void keep_areas(const Target& target);

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
    std::unordered_map<std::size_t, int> changed_; ///< node -> surface (-1: none), not the nearest
    GeoTransform transform_;
    std::unique_ptr<PixelMap> map_;
    FlatRows flats_;
    Grid<unsigned char> blocks_; ///< of the target
    Grid<float> window_;
    int window_col_ = 0, window_row_ = 0;
};

void SourceWater::Layer::keep_areas(const Target& target) {
    struct Near {
        float distance; ///< to the surface's rim, in source pixels
        std::size_t node;
    };
    struct Balance {
        std::size_t inside = 0;
        bool cut = false;
        std::vector<Near> in, out;
    };
    std::vector<Balance> balance(flats().size());
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
        const int here = at(px, py);
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
        } beside[3] = {{at(px + sx, py), dx},
                       {at(px, py + sy), dy},
                       {at(px + sx, py + sy), std::sqrt(dx * dx + dy * dy)}};
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
            if (near(bc, br))
                each_block_row(target, bc, br, [&](Node first, int count) {
                    map().row(first.row, first.col, count, places);
                    for (int i = 0; i < count; ++i)
                        look({first.col + i, first.row}, places.x[std::size_t(i)],
                             places.y[std::size_t(i)]);
                });
    for (std::size_t i = 0; i < balance.size(); ++i) {
        Balance& b = balance[i];
        if (b.cut || b.inside == 0)
            continue;
        const long lacking = std::lround(area(flats()[i])) - long(b.inside);
        std::vector<Near>& from = lacking > 0 ? b.out : b.in;
        const auto count = std::min(std::size_t(std::abs(lacking)), from.size());
        std::partial_sort(from.begin(), from.begin() + std::ptrdiff_t(count), from.end(),
                          [](const Near& l, const Near& r) { return l.distance < r.distance; });
        for (std::size_t k = 0; k < count; ++k)
            changed_[from[k].node] = lacking > 0 ? int(i) : -1;
    }
}

SourceWater::SourceWater(const Target& target, const std::vector<GDALDataset*>& inputs,
                         const std::vector<const OGRSpatialReference*>& crs,
                         const Progress& progress)
    : target_(target) {
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        progress.report(0.02 + 0.13 * double(i) / double(inputs.size()), "finding flat water");
        layers_.push_back(std::make_unique<Layer>(*inputs[i], *crs[i], target, voids_, stepped_));
        layers_.back()->keep_areas(target);
    }
}

SourceWater::~SourceWater() = default;

Grid<std::uint8_t> SourceWater::lay(Grid<float>& z, bool cubic, const Progress& progress) {
    progress.report(0.5, "keeping lakes flat");
    const int block_cols = (target_.size.cols + block_side - 1) / block_side;
    const int block_rows = (target_.size.rows + block_side - 1) / block_side;
    const auto each_near_block = [&](auto visit) {
        for (int br = 0; br < block_rows; ++br)
            for (int bc = 0; bc < block_cols; ++bc)
                if (std::any_of(layers_.begin(), layers_.end(),
                                [&](const auto& layer) { return layer->near(bc, br); }))
                    visit(bc, br);
    };
    enum : std::uint8_t { land, water, tried };
    Grid<std::uint8_t> kind(z.size, land);
    PixelMap::Row places;
    std::vector<int> surface(block_side), owner(block_side);
    each_near_block([&](int bc, int br) {
        each_block_row(target_, bc, br, [&](Node first, int count) {
            std::fill(surface.begin(), surface.end(), -1);
            const std::size_t start = z.index(first);
            for (std::size_t k = 0; k < layers_.size();
                 ++k) { // the last that covers a place counts
                Layer& layer = *layers_[k];
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
                    const Layer& layer = *layers_[std::size_t(owner[i])];
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
        for (std::size_t k = layers_.size(); k-- > 0;) {
            layers_[k]->map().row(n.row, n.col, 1, places);
            const float linear =
                std::isnan(places.x[0]) ? void_m : layers_[k]->linear(places.x[0], places.y[0]);
            if (std::isnan(linear))
                continue;
            if (linear >= level - puddle_m)
                z[n] = std::max(linear, std::nextafter(level, std::numeric_limits<float>::max()));
            return;
        }
    };
    each_near_block([&](int bc, int br) {
        each_block_row(target_, bc, br, [&](Node first, int count) {
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

} // namespace tarn::dem
