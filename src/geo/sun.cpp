#include "geo/sun.hpp"

#include "core/error.hpp"

#include <cmath>
#include <cstdio>
#include <libnova/julian_day.h>
#include <libnova/precession.h>
#include <libnova/solar.h>
#include <libnova/transform.h>
#include <regex>

namespace tarn::geo {

SunPosition sun_position(GeoPoint place, double julian_date_utc) {
    // libnova gives the sun in the frame of J2000, but counts hour angles in that of the date:
    // without precession the sun would stand .36 degree off in 2026.
    ln_equ_posn j2000{}, equatorial{};
    ln_get_solar_equ_coords(julian_date_utc, &j2000);
    ln_get_equ_prec(&j2000, julian_date_utc, &equatorial);
    ln_lnlat_posn observer{.lng = place.lon_deg, .lat = place.lat_deg};
    ln_hrz_posn horizontal{};
    ln_get_hrz_from_equ(&equatorial, &observer, julian_date_utc, &horizontal);
    // libnova counts azimuths from the south.
    return {std::fmod(horizontal.az + 180.0, 360.0), horizontal.alt};
}

double parse_time(const std::string& iso8601, GeoPoint place) {
    static const std::regex form(R"((\d{4})-(\d\d)-(\d\d)[T ](\d\d):(\d\d)(?::(\d\d(?:\.\d+)?))?)"
                                 R"((Z|[+-]\d\d:?\d\d)?)");
    std::smatch m;
    const auto refuse = [&]() -> Error {
        return Error("'" + iso8601 + "' is no time",
                     "write 2026-06-21T15:00Z, or with +HH:MM, or without a zone for solar time");
    };
    if (!std::regex_match(iso8601, m, form))
        throw refuse();
    ln_date date{};
    date.years = std::stoi(m[1]);
    date.months = std::stoi(m[2]);
    date.days = std::stoi(m[3]);
    date.hours = std::stoi(m[4]);
    date.minutes = std::stoi(m[5]);
    date.seconds = m[6].matched ? std::stod(m[6]) : 0.0;
    static constexpr int days_in_month[] = {31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    if (date.months < 1 || date.months > 12 || date.days < 1 ||
        date.days > days_in_month[date.months - 1] || date.hours > 24 || date.minutes > 59 ||
        date.seconds >= 61.0)
        throw refuse();
    const double jd = ln_get_julian_day(&date);
    const std::string zone = m[7];
    if (zone.empty())
        return jd - place.lon_deg / 360.0;
    if (zone == "Z")
        return jd;
    const double sign = zone[0] == '-' ? -1.0 : 1.0;
    const double hours =
        std::stod(zone.substr(1, 2)) + std::stod(zone.substr(zone.size() - 2)) / 60;
    if (hours > 15.0 || std::stoi(zone.substr(zone.size() - 2)) > 59)
        throw refuse();
    return jd - sign * hours / 24.0;
}

double default_time(GeoPoint place) {
    return parse_time(place.lat_deg >= 0.0 ? "2026-06-21T09:30" : "2026-12-21T09:30", place);
}

std::string format_time(double julian_date_utc) {
    ln_date date{};
    ln_get_date(julian_date_utc + 0.5 / 86400.0, &date); // rounds to the second below
    char out[64];
    std::snprintf(out, sizeof out, "%04d-%02d-%02dT%02d:%02d:%02dZ", date.years, date.months,
                  date.days, date.hours, date.minutes, int(date.seconds));
    return out;
}

} // namespace tarn::geo
