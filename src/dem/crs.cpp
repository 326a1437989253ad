#include "dem/crs.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/source.hpp"
#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>
#include <cpl_conv.h>

namespace tarn::dem {

std::string wkt_of(const OGRSpatialReference& crs) {
    char* out = nullptr;
    const char* options[] = {"FORMAT=WKT2_2019", nullptr};
    crs.exportToWkt(&out, options);
    std::string wkt = out ? out : "";
    CPLFree(out);
    return wkt;
}

std::string proj_of(const OGRSpatialReference& crs) {
    char* out = nullptr;
    GdalMessages quiet;
    crs.exportToProj4(&out);
    std::string proj = out ? out : "";
    CPLFree(out);
    return proj;
}

OGRSpatialReference horizontal(const OGRSpatialReference& crs) {
    OGRSpatialReference out(crs);
    if (out.IsCompound())
        out.StripVertical();
    out.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return out;
}

OGRSpatialReference wgs84() {
    OGRSpatialReference out;
    out.SetFromUserInput("EPSG:4326");
    out.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return out;
}

Transformation between(const OGRSpatialReference& from, const OGRSpatialReference& to) {
    GdalMessages messages;
    const OGRSpatialReference a = horizontal(from), b = horizontal(to);
    Transformation out(OGRCreateCoordinateTransformation(&a, &b));
    if (!out)
        throw Error("no way from " + describe(from) + " to " + describe(to) + " (" +
                        messages.last() + ")",
                    "give the DEM's CRS with --crs");
    return out;
}

bool same_crs(const OGRSpatialReference& a, const OGRSpatialReference& b) {
    const OGRSpatialReference x = horizontal(a), y = horizontal(b);
    const char* options[] = {"CRITERION=EQUIVALENT", nullptr};
    return x.IsSame(&y, options);
}

GeoTransform geo_transform(const geo::Frame& frame, double west_m, double north_m,
                           double spacing_m) {
    return {{frame.origin_easting_m + west_m - 0.5 * spacing_m, spacing_m, 0.0,
             frame.origin_northing_m + north_m + 0.5 * spacing_m, 0.0, -spacing_m}};
}

std::optional<geo::Frame> transverse_mercator(const OGRSpatialReference& crs) {
    OGRSpatialReference plane = horizontal(crs);
    if (!plane.IsProjected())
        return {};
    const char* method = plane.GetAttrValue("PROJECTION");
    if (!method || !EQUAL(method, SRS_PT_TRANSVERSE_MERCATOR))
        return {};
    if (std::abs(plane.GetLinearUnits() - 1.0) > 1e-9)
        return {};
    geo::Frame frame;
    frame.semi_major_m = plane.GetSemiMajor();
    frame.inverse_flattening = plane.GetInvFlattening();
    // GDAL gives angles in the CRS's own unit, counted from its prime meridian.
    const double to_deg = plane.GetAngularUnits() * 180.0 / M_PI;
    frame.lat0_deg = plane.GetProjParm(SRS_PP_LATITUDE_OF_ORIGIN, 0.0) * to_deg;
    frame.lon0_deg =
        plane.GetProjParm(SRS_PP_CENTRAL_MERIDIAN, 0.0) * to_deg + plane.GetPrimeMeridian();
    frame.scale0 = plane.GetProjParm(SRS_PP_SCALE_FACTOR, 1.0);
    frame.false_easting_m = plane.GetProjParm(SRS_PP_FALSE_EASTING, 0.0);
    frame.false_northing_m = plane.GetProjParm(SRS_PP_FALSE_NORTHING, 0.0);
    frame.proj = proj_of(plane);
    frame.wkt = wkt_of(plane);
    return frame;
}

double sample_datum_shift(geo::Frame& frame, const OGRSpatialReference& crs, double reach_m) {
    frame.datum_shift = {};
    auto to = between(crs, wgs84());
    // Where PROJ puts a scene position, against a plain projection of that place.
    const auto difference = [&](double x, double y) -> ScenePoint {
        double lon = frame.origin_easting_m + x, lat = frame.origin_northing_m + y;
        GdalMessages quiet;
        if (!to->Transform(1, &lon, &lat))
            throw Error("the DEM's CRS cannot be turned into latitude and longitude here",
                        "check that CRS and coordinates belong together, or give --crs");
        const ScenePoint plain = geo::to_scene(frame, {lat, lon});
        return {x - plain.x_m, y - plain.y_m};
    };
    geo::DatumShift datum{.side = 33, .reach_m = reach_m, .east_m = {}, .north_m = {}};
    double greatest = 0.0;
    const auto place = [&](double i) { return reach_m * (2.0 * i / (datum.side - 1) - 1.0); };
    for (int r = 0; r < datum.side; ++r)
        for (int c = 0; c < datum.side; ++c) {
            const ScenePoint d = difference(place(c), place(r));
            datum.east_m.push_back(d.x_m);
            datum.north_m.push_back(d.y_m);
            greatest = std::max(greatest, std::hypot(d.x_m, d.y_m));
        }
    if (greatest > 5'000.0)
        throw Error(
            text("PROJ and the CRS's own parameters disagree by ", fixed(greatest, 1), " m"),
            "the CRS text may be damaged: give it again with --crs EPSG:...");
    if (greatest < 0.0005)
        return greatest; // the same datum as far as anyone can tell
    double error = 0.0;
    for (int r = 0; r + 1 < datum.side; ++r)
        for (int c = 0; c + 1 < datum.side; ++c) {
            const ScenePoint d = difference(place(c + 0.5), place(r + 0.5));
            const auto i = std::size_t(r * datum.side + c), n = std::size_t(datum.side);
            const auto mean = [&](const std::vector<double>& v) {
                return 0.25 * (v[i] + v[i + 1] + v[i + n] + v[i + n + 1]);
            };
            error = std::max(error,
                             std::hypot(mean(datum.east_m) - d.x_m, mean(datum.north_m) - d.y_m));
        }
    frame.datum_shift = std::move(datum);
    return error;
}

} // namespace tarn::dem
