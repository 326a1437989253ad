#pragma once
/// @file sun.hpp  Where the sun stands, by libnova, and the times people write.
#include "core/geo.hpp"

#include <string>

namespace tarn::geo {

struct SunPosition {
    double azimuth_deg = 0.0;   ///< clockwise from TRUE north, [0, 360)
    double elevation_deg = 0.0; ///< above the horizon, without atmospheric refraction
};

/// @param julian_date_utc  days, e.g. 2451545.0 = 2000-01-01 12:00
/// Source  libnova (Meeus, Astronomical Algorithms); good to some arc seconds, against the sun's
///         own half degree. Refraction (.5 degree at the horizon, .02 at 45) is left out.
SunPosition sun_position(GeoPoint place, double julian_date_utc);

/// Reads "2026-06-21T15:00Z", "2026-06-21 15:00:30+02:00"; without a zone the time is the
/// place's mean solar time (longitude / 15 hours from UTC).
/// @throws tarn::Error  if the text is no such time
double parse_time(const std::string& iso8601, GeoPoint place);

/// 09:30 mean solar time at the place on its own midsummer day: a sun that shows relief.
double default_time(GeoPoint place);

/// "2026-06-21T15:00:00Z"
std::string format_time(double julian_date_utc);

} // namespace tarn::geo
