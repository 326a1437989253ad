#include "dem/bed.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/voids.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tarn::dem {

namespace {

double median(std::vector<float> values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

bool has_dry_neighbour(const Grid<unsigned char>& wet, Node at) {
    for (int dr = -1; dr <= 1; ++dr)
        for (int dc = -1; dc <= 1; ++dc) {
            const Node n{at.col + dc, at.row + dr};
            if (wet.contains(n) && !wet[n])
                return true;
        }
    return false;
}

} // namespace

std::vector<std::string> merge_bathymetry(Grid<float>& z, const Grid<unsigned char>& wet,
                                          const Grid<unsigned char>& surface, double surface_m,
                                          Grid<float> bathymetry, BathymetryKind kind) {
    std::vector<float> inside;
    for (std::size_t i = 0; i < wet.values.size(); ++i)
        if (wet.values[i] && !std::isnan(bathymetry.values[i]))
            inside.push_back(bathymetry.values[i]);
    if (inside.empty())
        throw Error("the bathymetry has no value inside the lake",
                    "check its CRS, its nodata value and that it shows this lake");
    std::vector<std::string> notes;
    if (kind == BathymetryKind::automatic) {
        // The shallowest values lie by the shore: near 0 for depths, near the level for heights.
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
        kind = tenth(to_zero) < tenth(to_level) ? BathymetryKind::depth : BathymetryKind::elevation;
        notes.push_back(std::string("bathymetry values taken as ") +
                        (kind == BathymetryKind::depth ? "depths" : "elevations") +
                        " (by their values near the shore; --bathymetry-kind says otherwise)");
    }
    // Everything below is depth, positive down.
    const bool negative = kind == BathymetryKind::depth && median(inside) < 0.0;
    Grid<float> depth(z.size, std::numeric_limits<float>::quiet_NaN());
    Grid<unsigned char> survey(z.size);
    std::size_t surveyed = 0, total = 0, above = 0;
    for (std::size_t i = 0; i < wet.values.size(); ++i) {
        if (!wet.values[i])
            continue;
        ++total;
        const float v = bathymetry.values[i];
        if (std::isnan(v))
            continue;
        const float d = kind == BathymetryKind::elevation ? float(surface_m) - v
                        : negative                        ? -v
                                                          : v;
        above += d < 0.0f && surface.values[i];
        // Above the surveyed surface the DEM knows the ground; only the surface itself is replaced.
        if (d < 0.0f && !surface.values[i])
            continue;
        depth.values[i] = std::max(d, 0.0f);
        survey.values[i] = 1;
        ++surveyed;
    }
    // The shoreline holds the interpolation: depth 0 on dry nodes beside the lake.
    for (int row = 0; row < wet.size.rows; ++row)
        for (int col = 0; col < wet.size.cols; ++col) {
            const Node at{col, row};
            if (!surface[at])
                continue;
            for (int dr = -1; dr <= 1; ++dr)
                for (int dc = -1; dc <= 1; ++dc) {
                    const Node n{col + dc, row + dr};
                    if (wet.contains(n) && !surface[n] && std::isnan(depth[n]))
                        depth[n] = 0.0f;
                }
        }
    if (surveyed < total)
        interpolate_voids(depth, 1000);
    for (std::size_t i = 0; i < wet.values.size(); ++i)
        if (wet.values[i] && !std::isnan(depth.values[i]) &&
            (surface.values[i] || survey.values[i]))
            z.values[i] = float(surface_m) - depth.values[i];
    notes.push_back(text("bathymetry covers ", surveyed, " of the lake's ", total,
                         " nodes; what lies between survey and shore is interpolated"));
    if (above > 0)
        notes.push_back(text(above, " bathymetry values lay above the surface; taken as depth 0"));
    return notes;
}

std::size_t make_room(Grid<float>& z, const Grid<unsigned char>& wet,
                      const Grid<unsigned char>& flat, double level_m) {
    constexpr double nominal_m = 5.0, greatest_m = 30.0;
    const Grid<float> before = z;
    std::size_t lowered = 0;
    for (int row = 0; row < z.size.rows; ++row)
        for (int col = 0; col < z.size.cols; ++col) {
            const Node at{col, row};
            if (!wet[at] || !flat[at])
                continue;
            double depth = nominal_m;
            if (has_dry_neighbour(wet, at)) {
                double sum = 0.0, weight = 0.0;
                for (int dr = -1; dr <= 1; ++dr)
                    for (int dc = -1; dc <= 1; ++dc) {
                        const Node n{col + dc, row + dr};
                        if (!wet.contains(n) || wet[n])
                            continue;
                        const double w = (dr == 0 || dc == 0) ? 1.0 : 0.25;
                        sum += w * std::max(double(before[n]) - level_m, 0.0);
                        weight += w;
                    }
                depth = std::clamp(sum / weight, 0.05, greatest_m);
            }
            const auto floor_m = static_cast<float>(level_m - depth);
            if (z[at] > floor_m) {
                z[at] = floor_m;
                ++lowered;
            }
        }
    return lowered;
}

} // namespace tarn::dem
