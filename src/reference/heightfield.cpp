#include "reference/heightfield.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tarn::reference {

namespace {

/// Heights of a cell's corners: north-west, north-east, south-west, south-east.
struct Patch {
    double nw, ne, sw, se;
    double at(double u, double v) const {
        return (1 - u) * (1 - v) * nw + u * (1 - v) * ne + (1 - u) * v * sw + u * v * se;
    }
    double highest() const { return std::max(std::max(nw, ne), std::max(sw, se)); }
};

/// Smallest t in [a, b] with gap(t) <= 0, where gap is a quadratic; nothing if there is none.
template <class Gap>
std::optional<double> first_below(Gap gap, double a, double b) {
    const double at_a = gap(a);
    if (at_a <= 0.0)
        return a;
    double low = b;
    if (gap(b) > 0.0) {
        // A parabola through three points; its lowest place, if that lies inside.
        const double m = 0.5 * (a + b), at_m = gap(m), at_b = gap(b);
        const double curve = at_a - 2.0 * at_m + at_b;
        if (!(curve > 0.0))
            return {};
        const double place = m + 0.25 * (b - a) * (at_a - at_b) / curve;
        if (!(place > a && place < b) || gap(place) > 0.0)
            return {};
        low = place;
    }
    for (int i = 0; i < 100 && low - a > 0.0; ++i) {
        const double m = 0.5 * (a + low);
        if (m == a || m == low)
            break;
        (gap(m) <= 0.0 ? low : a) = m;
    }
    return low;
}

} // namespace

std::optional<Hit> trace_field(const Heightfield& ground, const Heightfield* water,
                               glm::dvec3 origin, glm::dvec3 direction, double t_max,
                               double bottom_m, double bend) {
    const GridSize size = ground.size();
    const double s = ground.spacing_m;
    const double oc = ground.col(origin.x), orow = ground.row(origin.y);
    const double dc = direction.x / s, dr = -direction.y / s;
    const double infinity = std::numeric_limits<double>::infinity();

    // The part of the ray over the field.
    double t0 = 0.0, t1 = t_max;
    const auto clip = [&](double o, double d, double high) {
        if (d == 0.0) {
            if (o < 0.0 || o > high)
                t1 = -1.0;
            return;
        }
        const double a = (0.0 - o) / d, b = (high - o) / d;
        t0 = std::max(t0, std::min(a, b));
        t1 = std::min(t1, std::max(a, b));
    };
    // The slab from the block's bottom up; a curved ray rises, falls and rises again.
    const auto height = [&](double t) { return origin.z + t * (direction.z + t * bend); };
    if (bend > 0.0) {
        const double lowest_at = -0.5 * direction.z / bend;
        const auto pass = [&](double a, double b) { // heights at a and b lie on both sides
            const bool falls = height(a) > bottom_m;
            for (int i = 0; i < 200; ++i) {
                const double m = 0.5 * (a + b);
                ((height(m) > bottom_m) == falls ? a : b) = m;
            }
            return b;
        };
        if (origin.z < bottom_m) {
            double high = std::max(lowest_at, 1.0);
            while (height(high) < bottom_m)
                high *= 2.0;
            t0 = std::max(t0, pass(std::max(lowest_at, 0.0), high));
        } else if (lowest_at > 0.0 && height(lowest_at) < bottom_m)
            t1 = std::min(t1, pass(0.0, lowest_at));
    } else if (direction.z > 0.0)
        t0 = std::max(t0, (bottom_m - origin.z) / direction.z);
    else if (direction.z < 0.0)
        t1 = std::min(t1, (bottom_m - origin.z) / direction.z);
    else if (origin.z < bottom_m)
        return {};
    // A ray that rises has met all it can where it comes above the highest code of both fields.
    const auto ceiling_of = [](const Heightfield& f) { return f.offset_m + f.scale_m * 65535.0; };
    const double ceiling =
        water ? std::max(ceiling_of(ground), ceiling_of(*water)) : ceiling_of(ground);
    const double to_ceiling = ceiling - origin.z;
    if (direction.z > 0.0 && to_ceiling > 0.0) {
        // Of both forms of the quadratic's root the one that does not cancel.
        const double root = std::sqrt(direction.z * direction.z + 4.0 * bend * to_ceiling);
        t1 = std::min(t1, 2.0 * to_ceiling / (direction.z + root) * (1.0 + 1e-9));
    } else if (direction.z > 0.0 && to_ceiling < 0.0)
        return {};
    clip(oc, dc, size.cols - 1);
    clip(orow, dr, size.rows - 1);
    if (!(t0 < t1))
        return {};

    const auto cell_of = [](double at, double step, int cells) {
        // On a grid line the ray belongs to the cell that it enters.
        const double f = std::floor(at);
        const int cell = (at == f && step < 0.0) ? int(f) - 1 : int(f);
        return std::clamp(cell, 0, cells - 1);
    };
    int c = cell_of(oc + t0 * dc, dc, size.cols - 1),
        r = cell_of(orow + t0 * dr, dr, size.rows - 1);
    double t = t0;
    while (true) {
        const double t_c = dc == 0.0 ? infinity : ((dc > 0.0 ? c + 1 : c) - oc) / dc;
        const double t_r = dr == 0.0 ? infinity : ((dr > 0.0 ? r + 1 : r) - orow) / dr;
        const double out = std::max(t, std::min({t_c, t_r, t1}));
        // Nowhere below its tangent.
        const double climb = direction.z + 2.0 * bend * t;
        const double lowest = height(t) + std::min(climb, 0.0) * (out - t);
        const auto corners = [&](const Heightfield& field) {
            return Patch{field.elevation_m(Node{c, r}), field.elevation_m(Node{c + 1, r}),
                         field.elevation_m(Node{c, r + 1}), field.elevation_m(Node{c + 1, r + 1})};
        };
        const auto meet = [&](const Patch& patch) {
            return first_below(
                [&](double at) {
                    return height(at) - patch.at(std::clamp(oc + at * dc - c, 0.0, 1.0),
                                                 std::clamp(orow + at * dr - r, 0.0, 1.0));
                },
                t, out);
        };
        std::optional<double> best;
        bool is_water = false;
        const Patch land = corners(ground);
        if (lowest <= land.highest())
            best = meet(land);
        if (water) {
            const auto& codes = water->codes;
            if (codes[{c, r}] != no_water_code && codes[{c + 1, r}] != no_water_code &&
                codes[{c, r + 1}] != no_water_code && codes[{c + 1, r + 1}] != no_water_code) {
                const Patch surface = corners(*water);
                if (lowest <= surface.highest()) {
                    const auto at = meet(surface);
                    if (at && (!best || *at < *best)) {
                        best = at;
                        is_water = true;
                    }
                }
            }
        }
        if (best)
            return Hit{*best, is_water, oc + *best * dc, orow + *best * dr,
                       origin + *best * direction + glm::dvec3(0, 0, *best * *best * bend)};
        if (out >= t1)
            return {};
        t = out;
        if (t_c <= t_r)
            c += dc > 0.0 ? 1 : -1;
        else
            r += dr > 0.0 ? 1 : -1;
        if (c < 0 || r < 0 || c > size.cols - 2 || r > size.rows - 2)
            return {};
    }
}

} // namespace tarn::reference
