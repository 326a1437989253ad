#include "dem/vectors.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/crs.hpp"
#include "geo/frame.hpp"

#include <algorithm>
#include <cmath>
#include <ogrsf_frmts.h>

namespace tarn::dem {

namespace {

constexpr std::size_t most_vertices = 5'000'000;

struct Reader {
    const geo::Frame& frame;
    OGRCoordinateTransformation& to_wgs84;
    bool declared = true;
    std::string name;
    std::size_t vertices = 0;

    bool place(const OGRPoint& point, VectorPlace& out) {
        const double x = point.getX(), y = point.getY();
        if (!std::isfinite(x) || !std::isfinite(y))
            return false;
        if (!declared && (std::abs(x) > 360.0 || std::abs(y) > 90.0))
            throw Error(
                text(name, ": has no CRS, and ", x, ", ", y, " is no longitude and latitude"),
                "give it one, with ogr2ogr -a_srs EPSG:... say");
        if (++vertices > most_vertices)
            throw Error(text(name, ": has more than ", most_vertices, " vertices"),
                        "cut it to the lake first, with ogr2ogr -clipsrc say");
        double lon = x, lat = y;
        if (!to_wgs84.Transform(1, &lon, &lat) || !(std::abs(lat) <= 90.0))
            return false;
        static_cast<ScenePoint&>(out) = geo::to_scene(frame, {lat, lon});
        if (point.Is3D() && std::isfinite(point.getZ()))
            out.z_m = point.getZ();
        return std::isfinite(out.x_m) && std::isfinite(out.y_m);
    }

    void collect(const OGRGeometry& shape, VectorFeature& out) {
        const auto flat = wkbFlatten(shape.getGeometryType());
        if (flat == wkbPoint) {
            VectorPlace p;
            if (!shape.IsEmpty() && place(*shape.toPoint(), p))
                out.points.push_back(p);
        } else if (flat == wkbLineString || flat == wkbLinearRing) {
            const auto& line = *static_cast<const OGRSimpleCurve*>(&shape);
            std::vector<VectorPlace> places;
            for (int i = 0; i < line.getNumPoints(); ++i) {
                OGRPoint point;
                line.getPoint(i, &point);
                if (VectorPlace p; place(point, p))
                    places.push_back(p);
            }
            if (places.size() > 1)
                out.lines.push_back(std::move(places));
        } else if (flat == wkbPolygon) {
            for (const auto* ring : *shape.toPolygon())
                collect(*ring, out);
        } else if (OGR_GT_IsSubClassOf(flat, wkbGeometryCollection)) {
            for (const auto* part : *shape.toGeometryCollection())
                collect(*part, out);
        } else if (const std::unique_ptr<OGRGeometry> straight(shape.getLinearGeometry());
                   straight && wkbFlatten(straight->getGeometryType()) != flat) {
            collect(*straight, out); // arcs
        }
    }
};

std::string label_of(const OGRFeature& feature) {
    for (const char* name : {"name", "label", "title", "Name", "NAME", "id", "ID"}) {
        const int field = feature.GetFieldIndex(name);
        if (field >= 0 && feature.IsFieldSetAndNotNull(field))
            return feature.GetFieldAsString(field);
    }
    return {};
}

} // namespace

std::vector<VectorFeature> read_vectors(const std::filesystem::path& path,
                                        const geo::Frame& frame) {
    register_drivers();
    GdalMessages messages;
    const ThreadOptions options({{"GPX_ELE_AS_25D", "YES"}}); // else <ele> is no height
    std::error_code failed;
    if (!std::filesystem::exists(path, failed))
        throw Error(path.string() + ": no such file", "check the path");
    Dataset ds(
        GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr));
    if (!ds || ds->GetLayerCount() < 1)
        throw Error(path.filename().string() + ": holds no points or lines that GDAL can read (" +
                        messages.last() + ")",
                    "give a GeoPackage, GeoJSON, GPX or shapefile (try ogrinfo on it)");
    std::vector<VectorFeature> out;
    for (auto* layer : ds->GetLayers()) {
        const std::string layer_name = layer->GetName();
        if (ds->GetDriver() && std::string(ds->GetDriver()->GetDescription()) == "GPX" &&
            (layer_name == "route_points" || layer_name == "track_points"))
            continue;
        OGRSpatialReference from;
        if (const auto* declared = layer->GetSpatialRef())
            from = *declared;
        const bool declared = !from.IsEmpty();
        if (!declared)
            from = wgs84();
        from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        auto to = between(from, wgs84());
        Reader reader{frame, *to, declared, path.filename().string()};
        for (const auto& feature : layer) {
            VectorFeature one;
            one.label = label_of(*feature);
            if (const OGRGeometry* shape = feature->GetGeometryRef())
                reader.collect(*shape, one);
            if (!one.lines.empty() || !one.points.empty())
                out.push_back(std::move(one));
        }
    }
    if (out.empty())
        throw Error(path.filename().string() + ": none of its features has a place",
                    "check its geometry with ogrinfo");
    return out;
}

} // namespace tarn::dem
