#include "dem/soundings.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/crs.hpp"
#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <ogrsf_frmts.h>

namespace tarn::dem {

namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

std::string lower(std::string word) {
    std::transform(word.begin(), word.end(), word.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return word;
}

/// The attribute with the depths: -1 if there is none of a name that says so.
int find_field(OGRFeatureDefn& layout, const std::string& asked) {
    if (!asked.empty())
        return layout.GetFieldIndex(asked.c_str());
    static const char* names[] = {"depth",  "depth_m", "z",         "elevation", "elev",
                                  "height", "level",   "elev_m",    "sounding",  "contour",
                                  "valdco", "tiefe",   "profondeur"};
    for (const char* name : names)
        for (int i = 0; i < layout.GetFieldCount(); ++i)
            if (lower(layout.GetFieldDefn(i)->GetNameRef()) == name)
                return i;
    for (int i = 0; i < layout.GetFieldCount(); ++i)
        if (lower(layout.GetFieldDefn(i)->GetNameRef()).find("depth") != std::string::npos)
            return i;
    return -1;
}

std::string field_names(OGRFeatureDefn& layout) {
    std::string out;
    for (int i = 0; i < layout.GetFieldCount(); ++i)
        out += (i ? ", " : "") + std::string(layout.GetFieldDefn(i)->GetNameRef());
    return out.empty() ? "none" : out;
}

/// The number in an attribute, NaN if it holds none.
double number(const OGRFeature& feature, int field) {
    if (!feature.IsFieldSetAndNotNull(field))
        return no_value;
    const char* words = feature.GetFieldAsString(field);
    char* end = nullptr;
    const double value = std::strtod(words, &end);
    while (end && (*end == ' ' || *end == '\t'))
        ++end;
    return end != words && end && *end == '\0' && std::isfinite(value) ? value : no_value;
}

struct Reading {
    double x, y, value;
};

/// Vertices of points and lines of any nesting; lines also between vertices farther apart than
/// `step`.
void collect(const OGRGeometry& shape, double value, double step, std::vector<Reading>& out) {
    const auto flat = wkbFlatten(shape.getGeometryType());
    const auto add = [&](const OGRPoint& p) {
        const double v = std::isnan(value) && p.Is3D() ? p.getZ() : value;
        if (std::isfinite(p.getX()) && std::isfinite(p.getY()) && std::isfinite(v))
            out.push_back({p.getX(), p.getY(), v});
    };
    if (flat == wkbPoint) {
        if (!shape.IsEmpty())
            add(*shape.toPoint());
    } else if (flat == wkbLineString || flat == wkbLinearRing) {
        const auto& line = *static_cast<const OGRSimpleCurve*>(&shape);
        for (int i = 0; i < line.getNumPoints(); ++i) {
            OGRPoint a, b;
            line.getPoint(i, &a);
            add(a);
            if (i + 1 == line.getNumPoints() || !(step > 0.0))
                continue;
            line.getPoint(i + 1, &b);
            const double length = std::hypot(b.getX() - a.getX(), b.getY() - a.getY());
            const int pieces = int(std::clamp(std::ceil(length / step), 1.0, 10'000.0));
            for (int k = 1; k < pieces; ++k) {
                const double f = double(k) / pieces;
                OGRPoint between(a.getX() + f * (b.getX() - a.getX()),
                                 a.getY() + f * (b.getY() - a.getY()));
                if (a.Is3D() && b.Is3D())
                    between.setZ(a.getZ() + f * (b.getZ() - a.getZ()));
                add(between);
            }
        }
    } else if (flat == wkbPolygon) {
        for (const auto* ring : *shape.toPolygon())
            collect(*ring, value, step, out);
    } else if (OGR_GT_IsSubClassOf(flat, wkbGeometryCollection)) {
        for (const auto* part : *shape.toGeometryCollection())
            collect(*part, value, step, out);
    }
}

} // namespace

SoundingFile read_soundings(const std::filesystem::path& path, const SoundingOptions& asked,
                            const Mosaic& mosaic) {
    const std::string &field = asked.field, &crs = asked.crs;
    register_drivers();
    SoundingFile out;
    const std::string name = path.filename().string();
    GdalMessages messages;
    std::error_code failed;
    if (!path.string().starts_with("/vsi") && !std::filesystem::exists(path, failed))
        throw Error(path.string() + ": no such file", "check the path");
    const char* options[] = {"AUTODETECT_TYPE=NO",
                             "X_POSSIBLE_NAMES=lon,long,longitude,x,lon_deg,easting,e,lng,laenge",
                             "Y_POSSIBLE_NAMES=lat,latitude,y,lat_deg,northing,n,breite",
                             "KEEP_GEOM_COLUMNS=YES", nullptr};
    Dataset ds(
        GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, options));
    if (!ds || ds->GetLayerCount() < 1)
        throw Error(name + ": holds no points or lines that GDAL can read (" + messages.last() +
                        ")",
                    "give a CSV with lon,lat,depth columns or a vector file (try ogrinfo on it)");
    OGRLayer& layer = *ds->GetLayer(0);
    if (ds->GetLayerCount() > 1)
        out.notes.push_back(name + ": holds several layers; '" + layer.GetName() + "' is taken");
    OGRFeatureDefn& layout = *layer.GetLayerDefn();
    const int depth_field = find_field(layout, field);
    if (!field.empty() && depth_field < 0)
        throw Error(name + ": has no field '" + field + "' (it has: " + field_names(layout) + ")",
                    "name one of them with --depth-field");
    const bool csv = std::string(ds->GetDriverName()) == "CSV";

    OGRSpatialReference from;
    if (!crs.empty()) {
        if (from.SetFromUserInput(crs.c_str()) != OGRERR_NONE)
            throw Error("--soundings-crs '" + crs + "' is not understood (" + messages.last() + ")",
                        "give EPSG:code, a PROJ string or WKT");
    } else if (const auto* declared = layer.GetSpatialRef()) {
        from = *declared;
    }
    const bool declared = !from.IsEmpty();
    if (!declared)
        from = wgs84();
    from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);

    // Lines are filled in at half a node's distance, in their own units.
    double step = 0.5 * mosaic.spacing_m;
    if (from.IsGeographic())
        step /= 111'000.0;
    else if (from.GetLinearUnits() > 0.0)
        step /= from.GetLinearUnits();

    std::vector<Reading> readings;
    std::size_t features = 0, without = 0;
    for (const auto& feature : layer) {
        ++features;
        const OGRGeometry* shape = feature->GetGeometryRef();
        const double value = depth_field >= 0 ? number(*feature, depth_field) : no_value;
        const std::size_t before = readings.size();
        if (shape && (depth_field < 0 || !std::isnan(value)))
            collect(*shape, value, step, readings);
        without += readings.size() == before;
    }
    if (readings.empty())
        throw Error(text(name, ": none of its ", features,
                         " features has a position and a depth (fields: ", field_names(layout),
                         ")"),
                    csv ? "the first line must name the columns, as in lon,lat,depth; "
                          "numbers have decimal points; --depth-field names the depth"
                        : "name the attribute with --depth-field");
    // What writers put where there is no depth.
    const auto placeholder = [](const Reading& r) {
        return r.value == -9999.0 || r.value == -32768.0 || r.value == 9999.0 ||
               !(std::abs(r.value) < 12'000.0);
    };
    if (const auto gone = std::erase_if(readings, placeholder); gone > 0)
        out.notes.push_back(
            text(name, ": ", gone, " values like -9999 or beyond 12 km taken as none"));
    if (readings.empty())
        throw Error(name + ": holds no depth that can be one", "check its unit and --depth-field");
    std::string unit = asked.unit;
    const std::string said =
        depth_field >= 0 ? lower(layout.GetFieldDefn(depth_field)->GetNameRef()) : "";
    if (unit.empty() && (said.ends_with("_ft") || said.ends_with("_feet"))) {
        unit = "ft";
        out.notes.push_back(name + ": field '" + said + "' taken as feet (--bathymetry-unit)");
    }
    if (const double factor = metres_per_unit(unit); factor != 1.0)
        for (Reading& r : readings)
            r.value *= factor;
    if (without > 0)
        out.notes.push_back(text(name, ": ", without, " of ", features,
                                 " features have no position or no number for the depth"));
    if (!declared)
        for (const Reading& r : readings)
            if (std::abs(r.x) > 360.0 || std::abs(r.y) > 90.0)
                throw Error(text(name, ": has no CRS, and ", r.x, ", ", r.y,
                                 " is no longitude and latitude"),
                            "give its CRS with --soundings-crs EPSG:...");
    auto to = between(from, wgs84());
    for (const Reading& r : readings) {
        double lon = r.x, lat = r.y;
        if (!to->Transform(1, &lon, &lat))
            continue;
        const ScenePoint p = geo::to_scene(mosaic.frame, {lat, lon});
        const double col = (p.x_m - mosaic.west_m) / mosaic.spacing_m;
        const double row = (mosaic.north_m - p.y_m) / mosaic.spacing_m;
        if (std::abs(col) < 1e7 && std::abs(row) < 1e7)
            out.soundings.push_back({col, row, r.value});
    }
    out.input = {.name = name,
                 .role = "soundings",
                 .format = ds->GetDriverName(),
                 .crs = declared ? describe(from) : "not declared; read as longitude, latitude",
                 .vertical = "not declared",
                 .size = text(features, " features"),
                 .checksum = {}};
    if (depth_field >= 0)
        out.notes.push_back(name + ": depths from field '" +
                            layout.GetFieldDefn(depth_field)->GetNameRef() + "'");
    return out;
}

} // namespace tarn::dem
