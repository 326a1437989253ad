#include "view/probe.hpp"

#include "core/angles.hpp"
#include "core/text.hpp"
#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tarn::view {

std::optional<glm::dvec3> first_ground(const scene::Scene& scene, const glm::dvec3& origin,
                                       const glm::dvec3& direction, double most_m,
                                       double bend_per_m) {
    const Heightfield& g = scene.ground;
    const glm::dvec3 d = glm::normalize(direction);
    const double step = 0.5 * g.spacing_m;
    const double bend = bend_per_m * (d.x * d.x + d.y * d.y);
    const auto at = [&](double t) { return origin + d * t + glm::dvec3(0, 0, bend * t * t); };
    const auto above = [&](double t) {
        const glm::dvec3 p = at(t);
        return p.z - g.elevation_m(p.x, p.y);
    };
    double before = 0.0;
    if (above(0.0) < 0.0)
        return origin;
    for (double t = step; before < most_m; t += step) {
        const double here = std::min(t, most_m);
        if (above(here) < 0.0) {
            double low = before, high = here;
            for (int i = 0; i < 40; ++i) {
                const double middle = 0.5 * (low + high);
                (above(middle) < 0.0 ? high : low) = middle;
            }
            return at(high);
        }
        before = here;
    }
    return std::nullopt;
}

std::optional<glm::dvec3> first_met(const scene::Scene& scene, const glm::dvec3& eye,
                                    const glm::dvec3& direction, double bend_per_m) {
    const Heightfield& g = scene.ground;
    const glm::dvec3 d = glm::normalize(direction);
    const double bend = bend_per_m * (d.x * d.x + d.y * d.y);
    // Where the ray is over the field and, as far as straight lines tell, not above all of it.
    double from = 0.0, to = 1e9;
    const glm::dvec3 low(g.west_m, g.south_m(), g.lower_bound_m() - 1.0),
        high(g.east_m(), g.north_m, g.upper_bound_m() + 1.0);
    for (int k = 0; k < 3; ++k) {
        if (d[k] == 0.0) {
            if (eye[k] < low[k] || eye[k] > high[k])
                return std::nullopt;
            continue;
        }
        const double a = (low[k] - eye[k]) / d[k], b = (high[k] - eye[k]) / d[k];
        from = std::max(from, std::min(a, b));
        if (k < 2 || d.z > 0.0) // it falls less far than a straight one
            to = std::min(to, std::max(a, b));
    }
    if (from >= to)
        return std::nullopt;
    std::optional<glm::dvec3> met =
        first_ground(scene, eye + d * from + glm::dvec3(0, 0, bend * from * from),
                     d + glm::dvec3(0, 0, 2.0 * bend * from), to - from, bend_per_m);
    double nearest = met ? glm::length(*met - eye) : 1e9;
    for (const LakeRecord& lake : scene.lakes) {
        // bend t^2 + d.z t + above = 0, the first t > 0, in a form that holds for bend -> 0.
        const double above = eye.z - lake.level_m, root2 = d.z * d.z - 4.0 * bend * above;
        if (root2 < 0.0)
            continue;
        const double root = std::sqrt(root2);
        const double t = above > 0.0 ? (d.z < 0.0 ? 2.0 * above / (root - d.z) : -1.0)
                                     : (d.z > 0.0 ? -2.0 * above / (root + d.z) : -1.0);
        const glm::dvec3 p = eye + d * t + glm::dvec3(0, 0, bend * t * t);
        const auto water = t > 0.0 && t < nearest ? scene.water_level_m(p.x, p.y) : std::nullopt;
        if (water && std::abs(*water - lake.level_m) < 0.01) {
            met = p;
            nearest = t;
        }
    }
    return met;
}

std::optional<Reading> read_place(const scene::Scene& scene, const glm::dvec3& eye,
                                  const glm::dvec3& direction, double distance, double bend_per_m) {
    if (!(distance > 0.0 && distance < 0.99e9))
        return std::nullopt;
    const glm::dvec3 d = glm::normalize(direction);
    Reading out;
    out.distance_m = distance;
    out.point = eye + d * out.distance_m;
    out.point.z += bend_per_m * (d.x * d.x + d.y * d.y) * distance * distance;
    const Heightfield& g = scene.ground;
    const double x = out.point.x, y = out.point.y;
    out.place = geo::to_geo(scene.frame, {x, y});
    out.ground_m = g.elevation_m(x, y);
    const double h = 0.5 * g.spacing_m;
    out.slope_deg = std::atan(std::hypot(g.elevation_m(x + h, y) - g.elevation_m(x - h, y),
                                         g.elevation_m(x, y + h) - g.elevation_m(x, y - h)) /
                              (2.0 * h)) /
                    degree;
    out.level_m = scene.water_level_m(x, y);
    if (!out.level_m)
        return out;
    if (scene.lake_at_level(*out.level_m).bed == Bed::unknown)
        return out;
    out.depth_m = std::max(0.0, *out.level_m - out.ground_m);
    if (!(eye.z > *out.level_m && d.z < 0.0)) // from above, what is met over a bed is the surface
        return out;
    const double sine = std::hypot(d.x, d.y) / scene.optics.index;
    const double cosine = std::sqrt(1.0 - sine * sine);
    glm::dvec3 below(0, 0, -1);
    if (const double flat = std::hypot(d.x, d.y); flat > 1e-9)
        below = {d.x / flat * sine, d.y / flat * sine, -cosine};
    const double most = (*out.level_m - g.lower_bound_m() + 1.0) / cosine;
    if (const auto bed = first_ground(scene, out.point, below, most)) {
        const double depth = std::max(0.0, *out.level_m - bed->z);
        out.seen_depth_m = depth;
        const double tan_water = sine / cosine, tan_air = std::hypot(d.x, d.y) / -d.z;
        out.apparent_depth_m =
            tan_air > 1e-6 ? depth * tan_water / tan_air : depth / scene.optics.index;
    }
    return out;
}

std::string describe(const Reading& r) {
    std::string out = fixed(r.place.lat_deg, 5) + ", " + fixed(r.place.lon_deg, 5) + "   ground " +
                      fixed(r.ground_m, 2) + " m   slope " + fixed(r.slope_deg, 1) + " deg";
    if (r.level_m)
        out += "   water " + fixed(*r.level_m, 2) + " m";
    if (r.depth_m)
        out += "   depth " + fixed(*r.depth_m, 2) + " m";
    else if (r.level_m)
        out += "   bed unknown";
    if (r.seen_depth_m)
        out += "   bed seen at " + fixed(*r.seen_depth_m, 2) + " m, looks " +
               fixed(*r.apparent_depth_m, 2) + " m deep";
    out += "   " +
           (r.distance_m >= 1000.0 ? fixed(r.distance_m / 1000.0, 2) + " km"
                                   : fixed(r.distance_m, 1) + " m") +
           " away";
    return out;
}

double length_m(const scene::Scene& scene, const std::vector<glm::dvec3>& places) {
    double sum = 0.0;
    for (std::size_t i = 1; i < places.size(); ++i)
        sum +=
            geo::geodesic_distance_m(geo::to_geo(scene.frame, {places[i - 1].x, places[i - 1].y}),
                                     geo::to_geo(scene.frame, {places[i].x, places[i].y}));
    return sum;
}

double area_m2(const scene::Scene& scene, const std::vector<glm::dvec3>& places) {
    std::vector<GeoPoint> polygon;
    for (const glm::dvec3& p : places)
        polygon.push_back(geo::to_geo(scene.frame, {p.x, p.y}));
    return polygon.size() < 3 ? 0.0 : geo::geodesic_area_m2(polygon);
}

} // namespace tarn::view
