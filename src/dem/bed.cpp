#include "dem/bed.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/gdal_door.hpp"
#include "dem/median.hpp"
#include "dem/voids.hpp"

#include <algorithm>
#include <cmath>
#include <gdal_alg.h>
#include <limits>

namespace tarn::dem {

namespace {

constexpr float no_depth = std::numeric_limits<float>::quiet_NaN();

template <class Visit>
void each_in(const Box& box, Visit visit) {
    for (int row = box.first.row; row <= box.second.row; ++row)
        for (int col = box.first.col; col <= box.second.col; ++col)
            visit(Node{col, row});
}

Node within(const Box& box, Node n) { return {n.col - box.first.col, n.row - box.first.row}; }

} // namespace

BathymetryKind judge_kind(const std::vector<float>& inside, double surface_m) {
    std::vector<float> to_zero, to_level;
    for (const float v : inside) {
        to_zero.push_back(std::abs(v));
        to_level.push_back(std::abs(v - float(surface_m)));
    }
    const auto tenth = [](std::vector<float>& v) {
        const auto at = v.begin() + std::ptrdiff_t(v.size() / 10);
        std::nth_element(v.begin(), at, v.end());
        return *at;
    };
    return tenth(to_zero) < tenth(to_level) ? BathymetryKind::depth : BathymetryKind::elevation;
}

Box BedPlace::widened() const {
    return {{std::max(box.first.col - 1, 0), std::max(box.first.row - 1, 0)},
            {std::min(box.second.col + 1, lake_of.size.cols - 1),
             std::min(box.second.row + 1, lake_of.size.rows - 1)}};
}

GridSize BedPlace::size() const {
    const Box b = widened();
    return {b.second.col - b.first.col + 1, b.second.row - b.first.row + 1};
}

Merged merge_bathymetry(Grid<float>& z, const BedPlace& place, const Grid<float>& bathymetry,
                        BathymetryKind kind) {
    const Box box = place.widened();
    std::vector<float> inside;
    each_in(box, [&](Node n) {
        if (const float v = bathymetry[within(box, n)]; place.wet(n) && !std::isnan(v))
            inside.push_back(v);
    });
    if (inside.empty())
        throw Error("the bathymetry has no value inside the lake",
                    "check its CRS, its nodata value and that it shows this lake");
    Merged out;
    std::vector<std::string>& notes = out.notes;
    if (kind == BathymetryKind::automatic) {
        kind = judge_kind(inside, place.surface_m);
        notes.push_back(std::string("bathymetry values taken as ") +
                        (kind == BathymetryKind::depth ? "depths" : "elevations") +
                        " (by their values near the shore; --bathymetry-kind says otherwise)");
    }
    // Everything below is depth, positive down.
    const bool negative = kind == BathymetryKind::depth && median(inside) < 0.0;
    const auto surface_m = float(place.surface_m);
    Grid<float> depth(place.size(), no_depth);
    Grid<unsigned char> survey(place.size());
    std::size_t surveyed = 0, total = 0, above = 0;
    each_in(box, [&](Node n) {
        if (!place.wet(n))
            return;
        ++total;
        const float v = bathymetry[within(box, n)];
        if (std::isnan(v))
            return;
        const float d = kind == BathymetryKind::elevation ? surface_m - v : negative ? -v : v;
        above += d < -0.001f && place.surface(n);
        // Above the surveyed surface the DEM knows the ground; only the surface itself is replaced.
        if (d < 0.0f && !place.surface(n))
            return;
        depth[within(box, n)] = std::max(d, 0.0f);
        survey[within(box, n)] = 1;
        ++surveyed;
    });
    std::size_t unknown = 0, told = 0; // of the nodes whose ground the DEM does not know
    each_in(box, [&](Node n) {
        unknown += place.surface(n);
        told += place.surface(n) && survey[within(box, n)];
    });
    if (2 * above > inside.size())
        throw Error(text("the bathymetry lies above the water's surface of ", fixed(surface_m, 2),
                         " m in ", above, " of ", inside.size(), " nodes"),
                    "check its unit (--bathymetry-unit), vertical datum (--bathymetry-offset) and "
                    "kind (--bathymetry-kind)");
    // The shoreline holds the interpolation: depth 0 on dry nodes beside the lake.
    each_in(box, [&](Node n) {
        if (!place.surface(n))
            return;
        each_neighbour(z.size, n, [&](Node m) {
            if (!place.surface(m) && std::isnan(depth[within(box, m)]))
                depth[within(box, m)] = 0.0f;
        });
    });
    if (surveyed < total)
        interpolate_voids(depth, 1000);
    each_in(box, [&](Node n) {
        const float d = depth[within(box, n)];
        if (place.wet(n) && !std::isnan(d) && (place.surface(n) || survey[within(box, n)]))
            z[n] = surface_m - d;
    });
    notes.push_back(text("bathymetry covers ", surveyed, " of the lake's ", total,
                         " nodes; what lies between survey and shore is interpolated"));
    if (above > 0)
        notes.push_back(text(above, " bathymetry values lay above the surface; taken as depth 0",
                             20 * above > inside.size()
                                 ? " (a datum that differs? --bathymetry-offset shifts it)"
                                 : ""));
    out.coverage = unknown == 0 ? 1.0 : double(told) / double(unknown);
    return out;
}

Grid<float> grid_soundings(const BedPlace& place, std::span<const Sounding> soundings,
                           double value_at_shore) {
    const Box box = place.widened();
    const GridSize size = place.size();
    // One point a node is all that the grid can show: their mean, at their mean place.
    struct Sum {
        double col = 0.0, row = 0.0, value = 0.0;
        int count = 0;
    };
    Grid<int> slot(size, -1);
    std::vector<Sum> sums;
    for (const Sounding& s : soundings) {
        const Node n{int(std::lround(s.col)), int(std::lround(s.row))};
        const Node at = within(box, n);
        if (!slot.contains(at))
            continue;
        if (slot[at] < 0) {
            slot[at] = int(sums.size());
            sums.emplace_back();
        }
        Sum& sum = sums[std::size_t(slot[at])];
        sum.col += s.col - box.first.col;
        sum.row += s.row - box.first.row;
        sum.value += s.value;
        ++sum.count;
    }
    std::vector<double> x, y, v;
    for (const Sum& s : sums) {
        x.push_back(s.col / s.count);
        y.push_back(s.row / s.count);
        v.push_back(s.value / s.count);
    }
    each_in(box, [&](Node n) {
        if (!place.wet(n))
            return;
        for (const Node m : {Node{n.col - 1, n.row}, Node{n.col + 1, n.row}, Node{n.col, n.row - 1},
                             Node{n.col, n.row + 1}})
            if (slot.contains(within(box, m)) && !place.wet(m)) {
                x.push_back(0.5 * (n.col + m.col) - box.first.col);
                y.push_back(0.5 * (n.row + m.row) - box.first.row);
                v.push_back(value_at_shore);
            }
    });
    Grid<float> out(size, no_depth);
    if (sums.empty() || x.size() < 3)
        return out;
    GdalMessages messages;
    GDALGridLinearOptions options{};
    options.nSizeOfStructure = sizeof options;
    options.dfRadius = 0.0; // outside the hull: nothing
    options.dfNoDataValue = std::numeric_limits<double>::quiet_NaN();
    // Pixel centres of GDAL's grid are our nodes; its first row has the smallest y, ours is the
    // northernmost: counting rows as y makes them the same.
    if (GDALGridCreate(GGA_Linear, &options, GUInt32(x.size()), x.data(), y.data(), v.data(), -0.5,
                       size.cols - 0.5, -0.5, size.rows - 0.5, GUInt32(size.cols),
                       GUInt32(size.rows), GDT_Float32, out.values.data(), nullptr,
                       nullptr) != CE_None)
        throw Error("the soundings cannot be interpolated (" + messages.last() + ")",
                    "check that they do not all lie on one line");
    return out;
}

void estimate_depths(Grid<float>& z, const BedPlace& place, double max_depth_m) {
    register_drivers();
    const Box box = place.widened();
    const GridSize size = place.size();
    auto* driver = GetGDALDriverManager()->GetDriverByName("MEM");
    Dataset dry(driver->Create("", size.cols, size.rows, 1, GDT_Byte, nullptr));
    Dataset far(driver->Create("", size.cols, size.rows, 1, GDT_Float32, nullptr));
    if (!dry || !far)
        throw Error("out of memory");
    Grid<unsigned char> target(size);
    Grid<float> distance(size);
    each_in(box, [&](Node n) { target[within(box, n)] = !place.wet(n); });
    GdalMessages messages;
    const auto transfer = [&](Dataset& ds, GDALRWFlag way, void* data, GDALDataType type) {
        return ds->GetRasterBand(1)->RasterIO(way, 0, 0, size.cols, size.rows, data, size.cols,
                                              size.rows, type, 0, 0);
    };
    if (transfer(dry, GF_Write, target.values.data(), GDT_Byte) != CE_None ||
        GDALComputeProximity(GDALRasterBand::ToHandle(dry->GetRasterBand(1)),
                             GDALRasterBand::ToHandle(far->GetRasterBand(1)), nullptr, nullptr,
                             nullptr) != CE_None ||
        transfer(far, GF_Read, distance.values.data(), GDT_Float32) != CE_None)
        throw Error("distances to the shore cannot be worked out (" + messages.last() + ")");
    const double greatest = *std::max_element(distance.values.begin(), distance.values.end()) - 0.5;
    each_in(box, [&](Node n) {
        if (!place.surface(n))
            return;
        const double x =
            std::clamp((distance[within(box, n)] - 0.5) / std::max(greatest, 0.5), 0.0, 1.0);
        z[n] = float(place.surface_m - max_depth_m * (1.0 - std::pow(1.0 - x, 1.75)));
    });
}

std::size_t make_room(Heightfield& ground, const LakeOf& lake_of, const Marks& marks,
                      std::span<const double> levels_m) {
    constexpr double nominal_m = 5.0;
    std::size_t lowered = 0;
    const auto known = [&](std::size_t i) {
        return std::isnan(levels_m[lake_of.values[i] - 1u]) ||
               !(marks.values[i] & (mark::flat | mark::filled));
    };
    const auto code_at = [&](double height_m) {
        const double code = std::floor((height_m - ground.offset_m) / ground.scale_m);
        return static_cast<std::uint16_t>(std::clamp(code, 0.0, 65535.0));
    };
    // Rim nodes get their depth from the land beside them, which keeps its heights here; they are
    // put on record first, for inside all the others follow.
    std::vector<std::pair<std::size_t, std::uint16_t>> rim;
    each_shore_node(lake_of, [&](Node at) {
        const std::size_t i = lake_of.index(at);
        if (known(i))
            return;
        const double level_m = levels_m[lake_of.values[i] - 1u];
        double sum = 0.0, weight = 0.0;
        each_neighbour(ground.size(), at, [&](Node n) {
            if (lake_of[n] != 0)
                return;
            const double w = (n.row == at.row || n.col == at.col) ? 1.0 : 0.25;
            sum += w * std::max(ground.elevation_m(n) - level_m, 0.0);
            weight += w;
        });
        if (weight > 0.0)
            rim.emplace_back(
                i, std::min(ground.codes.values[i],
                            code_at(level_m - std::clamp(sum / weight, 0.05, greatest_room_m))));
    });
    std::vector<std::uint16_t> floors;
    for (const double level_m : levels_m)
        floors.push_back(std::isnan(level_m) ? std::uint16_t{0} : code_at(level_m - nominal_m));
    for (std::size_t i = 0; i < lake_of.values.size(); ++i)
        if (lake_of.values[i] != 0 && !known(i) &&
            ground.codes.values[i] > floors[lake_of.values[i] - 1u]) {
            ground.codes.values[i] = floors[lake_of.values[i] - 1u];
            ++lowered;
        }
    for (const auto& [i, code] : rim)
        ground.codes.values[i] = code;
    return lowered;
}

} // namespace tarn::dem
