#include "geo/frame.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/PolygonArea.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <algorithm>
#include <cmath>

namespace tarn::geo {

namespace {

GeographicLib::TransverseMercator projection(const Frame& frame) {
    const double flattening =
        frame.inverse_flattening == 0.0 ? 0.0 : 1.0 / frame.inverse_flattening;
    try {
        return {frame.semi_major_m, flattening, frame.scale0};
    } catch (const std::exception& error) {
        throw Error(text("frame cannot be used: ", error.what()),
                    "check semi_major_m, inverse_flattening and scale0");
    }
}

/// Northing of the natural origin: GeographicLib counts northings from the equator.
double origin_arc_m(const GeographicLib::TransverseMercator& tm, const Frame& frame) {
    double x = 0.0, y = 0.0;
    tm.Forward(frame.lon0_deg, frame.lat0_deg, frame.lon0_deg, x, y);
    return y;
}

/// Bilinear on the lattice; beyond it the outermost cells go on.
ScenePoint shift(const DatumShift& datum, double x, double y) {
    if (datum.side < 2)
        return {};
    const double cells = datum.side - 1;
    const double c = (x / datum.reach_m + 1.0) * 0.5 * cells,
                 r = (y / datum.reach_m + 1.0) * 0.5 * cells;
    const double c0 = std::clamp(std::floor(c), 0.0, cells - 1.0),
                 r0 = std::clamp(std::floor(r), 0.0, cells - 1.0);
    const double u = c - c0, v = r - r0;
    const auto at = [&](const std::vector<double>& values) {
        const auto i = std::size_t(r0) * std::size_t(datum.side) + std::size_t(c0);
        const auto n = std::size_t(datum.side);
        return (1 - v) * ((1 - u) * values[i] + u * values[i + 1]) +
               v * ((1 - u) * values[i + n] + u * values[i + n + 1]);
    };
    return {at(datum.east_m), at(datum.north_m)};
}

} // namespace

Frame local_frame(GeoPoint centre) {
    Frame frame;
    // Rounded so that the PROJ string below says exactly the same in few digits.
    frame.lat0_deg = std::round(centre.lat_deg * 1e6) / 1e6;
    frame.lon0_deg = std::round(centre.lon_deg * 1e6) / 1e6;
    frame.proj = text("+proj=tmerc +lat_0=", frame.lat0_deg, " +lon_0=", frame.lon0_deg,
                      " +k=1 +x_0=0 +y_0=0 +datum=WGS84 +units=m +no_defs");
    return frame;
}

ScenePoint to_scene(const Frame& frame, GeoPoint point) {
    if (!std::isfinite(point.lat_deg) || !std::isfinite(point.lon_deg) ||
        std::abs(point.lat_deg) > 90.0)
        throw Error(text("position ", point.lat_deg, ",", point.lon_deg, " is not on Earth"),
                    "give latitude [-90, 90] and longitude in degrees");
    const auto tm = projection(frame);
    double e = 0.0, n = 0.0;
    tm.Forward(frame.lon0_deg, point.lat_deg, point.lon_deg, e, n);
    const double plain_x = e + frame.false_easting_m - frame.origin_easting_m;
    const double plain_y =
        n - origin_arc_m(tm, frame) + frame.false_northing_m - frame.origin_northing_m;
    double x = plain_x, y = plain_y;
    for (int i = 0; i < 4; ++i) { // the shift varies by millimetres per metre at most: contracts
        const ScenePoint by = shift(frame.datum_shift, x, y);
        x = plain_x + by.x_m;
        y = plain_y + by.y_m;
    }
    return {x, y};
}

GeoPoint to_geo(const Frame& frame, ScenePoint point) {
    const auto tm = projection(frame);
    const ScenePoint by = shift(frame.datum_shift, point.x_m, point.y_m);
    const double e = point.x_m - by.x_m + frame.origin_easting_m - frame.false_easting_m;
    const double n = point.y_m - by.y_m + frame.origin_northing_m - frame.false_northing_m +
                     origin_arc_m(tm, frame);
    GeoPoint out;
    tm.Reverse(frame.lon0_deg, e, n, out.lat_deg, out.lon_deg);
    return out;
}

double scale_factor(const Frame& frame, ScenePoint point) {
    const GeoPoint at = to_geo(frame, point);
    double x = 0.0, y = 0.0, convergence = 0.0, scale = 1.0;
    projection(frame).Forward(frame.lon0_deg, at.lat_deg, at.lon_deg, x, y, convergence, scale);
    return scale;
}

double convergence_deg(const Frame& frame, ScenePoint point) {
    const GeoPoint at = to_geo(frame, point);
    double x = 0.0, y = 0.0, convergence = 0.0, scale = 1.0;
    projection(frame).Forward(frame.lon0_deg, at.lat_deg, at.lon_deg, x, y, convergence, scale);
    return convergence;
}

double geodesic_area_m2(const std::vector<GeoPoint>& polygon) {
    GeographicLib::PolygonArea area(GeographicLib::Geodesic::WGS84());
    for (const GeoPoint& p : polygon)
        area.AddPoint(p.lat_deg, p.lon_deg);
    double perimeter = 0.0, m2 = 0.0;
    area.Compute(false, true, perimeter, m2);
    return std::abs(m2);
}

double geodesic_distance_m(GeoPoint a, GeoPoint b) {
    double m = 0.0;
    GeographicLib::Geodesic::WGS84().Inverse(a.lat_deg, a.lon_deg, b.lat_deg, b.lon_deg, m);
    return m;
}

} // namespace tarn::geo
