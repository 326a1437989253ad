// GeographicLib's frame against PROJ's, and the sun against a formula of its own.
#include "core/error.hpp"
#include "dem/mosaic.hpp"
#include "geo/frame.hpp"
#include "geo/sun.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <memory>

using namespace tarn;

namespace {

OGRSpatialReference crs(const std::string& words) {
    OGRSpatialReference out;
    EXPECT_EQ(out.SetFromUserInput(words.c_str()), OGRERR_NONE) << words;
    out.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return out;
}

/// Greatest distance [m] between where PROJ and where our frame puts a lattice of positions, both
/// ways, over a square of half side `reach` around scene (0, 0).
double disagreement(const geo::Frame& frame, const OGRSpatialReference& projected, double reach) {
    const OGRSpatialReference degrees = crs("EPSG:4326");
    std::unique_ptr<OGRCoordinateTransformation> to_degrees(
        OGRCreateCoordinateTransformation(&projected, &degrees));
    double worst = 0.0;
    for (int i = -10; i <= 10; ++i)
        for (int k = -10; k <= 10; ++k) {
            const double x = reach * i / 10, y = reach * k / 10;
            double lon = frame.origin_easting_m + x, lat = frame.origin_northing_m + y;
            EXPECT_TRUE(to_degrees->Transform(1, &lon, &lat));
            const ScenePoint there = geo::to_scene(frame, {lat, lon});
            const GeoPoint back = geo::to_geo(frame, {x, y});
            worst = std::max(worst, std::hypot(there.x_m - x, there.y_m - y));
            worst = std::max(worst, std::hypot((back.lat_deg - lat) * 110'600.0,
                                               std::remainder(back.lon_deg - lon, 360.0) *
                                                   111'300.0 * std::cos(lat * M_PI / 180)));
        }
    return worst;
}

} // namespace

TEST(Frame, LocalFrameAndGdalAgreeToAMillimetre) {
    for (const GeoPoint centre :
         {GeoPoint{42.94, -122.11}, GeoPoint{-38.05, 176.58}, GeoPoint{0.0, 0.0},
          GeoPoint{67.9, 13.1}, GeoPoint{-34.0, 179.99}, GeoPoint{82.5, -40.0}}) {
        const geo::Frame frame = geo::local_frame(centre);
        EXPECT_LT(disagreement(frame, crs(frame.proj), 150'000.0), 1e-3)
            << centre.lat_deg << "," << centre.lon_deg;
    }
}

TEST(Frame, GridsThatAreKeptRoundTripToACentimetre) {
    struct Place {
        const char* crs;
        double easting, northing;
    };
    // The last ones have datums some hundred metres from WGS 84: Airy, Bessel, Clarke ellipsoids.
    for (const Place place :
         {Place{"EPSG:2193", 1914605, 5783222}, Place{"EPSG:32615", 520000, 4230000},
          Place{"EPSG:26920", 450000, 4930000}, Place{"EPSG:3071", 550000, 420000},
          Place{"EPSG:27700", 325000, 215000}, Place{"EPSG:31467", 3500000, 5300000},
          Place{"EPSG:32733", 300000, 6230000}, Place{"EPSG:2056", 0, 0}}) {
        const OGRSpatialReference projected = crs(place.crs);
        auto frame = dem::transverse_mercator(projected);
        if (std::string(place.crs) == "EPSG:2056") { // Swiss oblique Mercator: not for keeping
            EXPECT_FALSE(frame.has_value());
            continue;
        }
        ASSERT_TRUE(frame.has_value()) << place.crs;
        frame->origin_easting_m = place.easting;
        frame->origin_northing_m = place.northing;
        const double residual = dem::sample_datum_shift(*frame, projected, 30'000.0);
        EXPECT_LT(residual, 0.01) << place.crs;
        EXPECT_LT(disagreement(*frame, projected, 30'000.0), 0.01) << place.crs;
    }
}

TEST(Frame, ScaleAndConvergenceMatchTheirDefinitions) {
    geo::Frame utm = *dem::transverse_mercator(crs("EPSG:32615"));
    utm.origin_easting_m = 620'000;
    utm.origin_northing_m = 4'200'000;
    const GeoPoint a = geo::to_geo(utm, {-50, 0}), b = geo::to_geo(utm, {50, 0});
    EXPECT_NEAR(100.0 / geo::geodesic_distance_m(a, b), geo::scale_factor(utm, {0, 0}), 1e-7);
    // A step to true north moves west of grid north by the convergence.
    const GeoPoint here = geo::to_geo(utm, {0, 0});
    const ScenePoint north = geo::to_scene(utm, {here.lat_deg + 1e-3, here.lon_deg});
    EXPECT_NEAR(std::atan2(-north.x_m, north.y_m) * 180 / M_PI, geo::convergence_deg(utm, {0, 0}),
                1e-4);
}

TEST(Frame, RefusesWhatIsNotOnEarth) {
    const geo::Frame frame = geo::local_frame({10, 20});
    EXPECT_THROW(geo::to_scene(frame, {95, 0}), Error);
    EXPECT_THROW(geo::to_scene(frame, {NAN, 0}), Error);
    geo::Frame broken = frame;
    broken.semi_major_m = -1;
    EXPECT_THROW(geo::to_scene(broken, {10, 20}), Error);
}

TEST(Geodesic, AreaOfASquareDegreeAtTheEquator) {
    // Independent: integral of the authalic strip on WGS 84, 12 308.778 km2 (computed from
    // b^2/2 (sin/(1-e2 sin^2) + atanh(e sin)/e) between 0 and 1 degree, times one degree).
    const double e2 = 0.00669437999014, e = std::sqrt(e2), b = 6356752.314245;
    const double s = std::sin(M_PI / 180);
    const double strip = b * b / 2 * (s / (1 - e2 * s * s) + std::atanh(e * s) / e) * M_PI / 180;
    // The polygon's northern edge is a geodesic, which lies outside the parallel by a little.
    const double area = geo::geodesic_area_m2({{0, 0}, {0, 1}, {1, 1}, {1, 0}});
    EXPECT_NEAR(area / strip, 1.0, 1e-4);
    EXPECT_DOUBLE_EQ(area,
                     geo::geodesic_area_m2({{1, 0}, {1, 1}, {0, 1}, {0, 0}})); // either way round
}

TEST(Sun, AgreesWithTheLowPrecisionAlmanac) {
    // Astronomical Almanac, "low precision formulas for the Sun" (good to .01 degree 1950-2050).
    for (const GeoPoint place :
         {GeoPoint{42.94, -122.11}, GeoPoint{-38.05, 176.58}, GeoPoint{0, 0}, GeoPoint{69, 20}})
        for (double jd = 2461000.5; jd < 2461365.5; jd += 13.37) {
            const double n = jd - 2451545.0, rad = M_PI / 180;
            const double g = (357.528 + 0.9856003 * n) * rad, L = 280.460 + 0.9856474 * n;
            const double lambda = (L + 1.915 * std::sin(g) + 0.020 * std::sin(2 * g)) * rad;
            const double epsilon = (23.439 - 4e-7 * n) * rad;
            const double ra = std::atan2(std::cos(epsilon) * std::sin(lambda), std::cos(lambda));
            const double dec = std::asin(std::sin(epsilon) * std::sin(lambda));
            const double gmst = 280.46061837 + 360.98564736629 * n;
            const double hour = (gmst + place.lon_deg) * rad - ra, lat = place.lat_deg * rad;
            const double elevation = std::asin(std::sin(lat) * std::sin(dec) +
                                               std::cos(lat) * std::cos(dec) * std::cos(hour));
            const double azimuth = std::atan2(-std::sin(hour) * std::cos(dec),
                                              std::sin(dec) * std::cos(lat) -
                                                  std::cos(dec) * std::sin(lat) * std::cos(hour));
            const geo::SunPosition sun = geo::sun_position(place, jd);
            EXPECT_NEAR(sun.elevation_deg, elevation / rad, 0.03) << jd;
            EXPECT_NEAR(std::remainder(sun.azimuth_deg - azimuth / rad, 360.0) *
                            std::cos(elevation),
                        0.0, 0.05)
                << jd;
        }
}

TEST(Time, ReadsWhatPeopleWrite) {
    const GeoPoint greenwich{51.5, 0.0}, east{0.0, 90.0};
    EXPECT_NEAR(geo::parse_time("2000-01-01T12:00Z", greenwich), 2451545.0, 1e-8);
    EXPECT_NEAR(geo::parse_time("2000-01-01 14:00:00+02:00", greenwich), 2451545.0, 1e-8);
    EXPECT_NEAR(geo::parse_time("2000-01-01T06:30-0530", greenwich), 2451545.0, 1e-8);
    EXPECT_NEAR(geo::parse_time("2000-01-01T18:00", east), 2451545.0,
                1e-8); // solar time: 6 h ahead
    EXPECT_EQ(geo::format_time(2451545.0), "2000-01-01T12:00:00Z");
    for (const char* wrong : {"", "noon", "2000-13-01T12:00Z", "2000-01-32T12:00Z",
                              "2000-01-01T25:00Z", "2000-01-01T12:60Z", "2000-01-01T12:00X",
                              "2000-01-01T12:00+99:00", "2000-01-01T12:00+02:75"})
        EXPECT_THROW(geo::parse_time(wrong, greenwich), Error) << wrong;
}
