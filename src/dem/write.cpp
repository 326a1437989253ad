#include "dem/write.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/gdal_door.hpp"
#include "dem/mosaic.hpp"

#include <cstring>
#include <limits>
#include <ogr_spatialref.h>
#include <ogr_srs_api.h>

namespace tarn::dem {

namespace {

Dataset create(const std::filesystem::path& path, GridSize size, int bands, GDALDataType type,
               const GeoTransform& transform, const std::string& crs, bool alpha,
               const GdalMessages& messages) {
    register_drivers();
    auto* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
    CPLStringList options;
    // Zstandard at its quickest packs as well as deflate in half the time; GDAL knows it since 2.3.
    const char* offered = driver->GetMetadataItem(GDAL_DMD_CREATIONOPTIONLIST);
    const bool zstd = offered && std::strstr(offered, "ZSTD");
    options.SetNameValue("COMPRESS", zstd ? "ZSTD" : "DEFLATE");
    options.SetNameValue(zstd ? "ZSTD_LEVEL" : "ZLEVEL", "1");
    options.SetNameValue("PREDICTOR", type == GDT_Float32 ? "3" : "2");
    options.SetNameValue("TILED", "YES");
    options.SetNameValue("NUM_THREADS", "ALL_CPUS");
    options.SetNameValue("BIGTIFF", "IF_SAFER");
    if (alpha) {
        options.SetNameValue("PHOTOMETRIC", "RGB");
        options.SetNameValue("ALPHA", "UNSPECIFIED");
    }
    Dataset out(driver->Create(path.c_str(), size.cols, size.rows, bands, type, options.List()));
    if (!out)
        throw Error(path.string() + ": cannot be created (" + messages.last() + ")",
                    "check the folder, its permissions and the free space");
    GeoTransform copy = transform;
    OGRSpatialReference srs;
    if (srs.SetFromUserInput(crs.c_str()) != OGRERR_NONE)
        throw Error("CRS '" + crs + "' is not understood (" + messages.last() + ")");
    out->SetGeoTransform(copy.v);
    out->SetSpatialRef(&srs);
    return out;
}

void finish(Dataset out, const std::filesystem::path& path, CPLErr written,
            const GdalMessages& messages) {
    // Errors of a full disk show only when the last block goes out.
    out->FlushCache(true);
    out.reset();
    if (written != CE_None || messages.failed())
        throw Error(path.string() + ": cannot be written (" + messages.last() + ")",
                    "check the free space and permissions");
}

} // namespace

void write_heightfield(const std::filesystem::path& path, const Heightfield& field,
                       const geo::Frame& frame, const std::string& description, bool nodata_zero) {
    GdalMessages messages;
    const ThreadOptions no_side_files{{"GDAL_PAM_ENABLED", "NO"}};
    auto out = create(path, field.size(), 1, GDT_UInt16,
                      geo_transform(frame, field.west_m, field.north_m, field.spacing_m), frame.wkt,
                      false, messages);
    GDALRasterBand& band = *out->GetRasterBand(1);
    band.SetScale(field.scale_m);
    band.SetOffset(field.offset_m);
    band.SetUnitType("m");
    band.SetDescription(description.c_str());
    if (nodata_zero)
        band.SetNoDataValue(no_water_code);
    const CPLErr written = band.RasterIO(GF_Write, 0, 0, field.size().cols, field.size().rows,
                                         const_cast<std::uint16_t*>(field.codes.values.data()),
                                         field.size().cols, field.size().rows, GDT_UInt16, 0, 0);
    finish(std::move(out), path, written, messages);
}

void write_heights(const std::filesystem::path& path, const Grid<float>& z,
                   const Heightfield& place, const geo::Frame& frame) {
    GdalMessages messages;
    const ThreadOptions no_side_files{{"GDAL_PAM_ENABLED", "NO"}};
    auto out = create(path, z.size, 1, GDT_Float32,
                      geo_transform(frame, place.west_m, place.north_m, place.spacing_m), frame.wkt,
                      false, messages);
    GDALRasterBand& band = *out->GetRasterBand(1);
    band.SetUnitType("m");
    band.SetDescription("heights");
    band.SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
    const CPLErr written =
        band.RasterIO(GF_Write, 0, 0, z.size.cols, z.size.rows, const_cast<float*>(z.values.data()),
                      z.size.cols, z.size.rows, GDT_Float32, 0, 0);
    finish(std::move(out), path, written, messages);
}

void write_safety_radii(const std::filesystem::path& path, const Grid<std::uint8_t>& radii,
                        const Heightfield& place, const geo::Frame& frame) {
    GdalMessages messages;
    const ThreadOptions no_side_files{{"GDAL_PAM_ENABLED", "NO"}};
    const double s = place.spacing_m;
    auto out = create(path, radii.size, 1, GDT_Byte,
                      geo_transform(frame, place.west_m + s / 2, place.north_m - s / 2, s),
                      frame.wkt, false, messages);
    out->GetRasterBand(1)->SetDescription("safety radii of the ground [cells + 1]");
    const CPLErr written =
        out->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, radii.size.cols, radii.size.rows,
                                        const_cast<std::uint8_t*>(radii.values.data()),
                                        radii.size.cols, radii.size.rows, GDT_Byte, 0, 0);
    finish(std::move(out), path, written, messages);
}

void write_classes(const std::filesystem::path& path, const Grid<std::uint8_t>& classes,
                   const std::vector<MapClass>& meanings, const Heightfield& place,
                   const geo::Frame& frame, bool nodata) {
    GdalMessages messages;
    const ThreadOptions no_side_files{{"GDAL_PAM_ENABLED", "NO"}};
    auto out = create(path, classes.size, 1, GDT_Byte,
                      geo_transform(frame, place.west_m, place.north_m, place.spacing_m), frame.wkt,
                      false, messages);
    GDALRasterBand& band = *out->GetRasterBand(1);
    GDALColorTable colours;
    std::string legend;
    for (std::size_t i = 0; i < meanings.size(); ++i) {
        const MapClass& m = meanings[i];
        const GDALColorEntry entry{m.red, m.green, m.blue, 255};
        colours.SetColorEntry(int(i), &entry);
        legend += (i ? "; " : "") + std::to_string(i) + " = " + m.name;
    }
    band.SetColorTable(&colours);
    // GeoTIFF itself has no names of categories, so they stand in its description.
    band.SetDescription(legend.c_str());
    out->SetMetadataItem("TIFFTAG_IMAGEDESCRIPTION", legend.c_str());
    if (nodata)
        band.SetNoDataValue(0);
    const CPLErr written = band.RasterIO(GF_Write, 0, 0, classes.size.cols, classes.size.rows,
                                         const_cast<std::uint8_t*>(classes.values.data()),
                                         classes.size.cols, classes.size.rows, GDT_Byte, 0, 0);
    finish(std::move(out), path, written, messages);
}

void write_ortho(const std::filesystem::path& path, const Ortho& ortho, const geo::Frame& frame) {
    GdalMessages messages;
    const ThreadOptions no_side_files{{"GDAL_PAM_ENABLED", "NO"}};
    const Picture& p = ortho.picture;
    const double s = ortho.spacing_m;
    auto out = create(path, {p.width_px, p.height_px}, 4, GDT_Byte,
                      geo_transform(frame, ortho.west_m + s / 2, ortho.north_m - s / 2, s),
                      frame.wkt, true, messages);
    const CPLErr written = out->RasterIO(
        GF_Write, 0, 0, p.width_px, p.height_px, const_cast<std::uint8_t*>(p.bytes.data()),
        p.width_px, p.height_px, GDT_Byte, 4, nullptr, 4, GSpacing(p.width_px) * 4, 1, nullptr);
    finish(std::move(out), path, written, messages);
}

void write_elevations(const std::filesystem::path& path, const Grid<float>& z,
                      const std::string& crs, const double transform[6],
                      const std::string& description) {
    GdalMessages messages;
    const ThreadOptions no_side_files{{"GDAL_PAM_ENABLED", "NO"}};
    GeoTransform g;
    std::copy(transform, transform + 6, g.v);
    auto out = create(path, z.size, 1, GDT_Float32, g, crs, false, messages);
    out->GetRasterBand(1)->SetUnitType("m");
    out->GetRasterBand(1)->SetDescription(description.c_str());
    out->SetMetadataItem("TIFFTAG_IMAGEDESCRIPTION", description.c_str());
    const CPLErr written = out->GetRasterBand(1)->RasterIO(
        GF_Write, 0, 0, z.size.cols, z.size.rows, const_cast<float*>(z.values.data()), z.size.cols,
        z.size.rows, GDT_Float32, 0, 0);
    finish(std::move(out), path, written, messages);
}

std::string library_versions() {
    int major = 0, minor = 0, patch = 0;
    OSRGetPROJVersion(&major, &minor, &patch);
    return text("GDAL ", GDALVersionInfo("RELEASE_NAME"), ", PROJ ", major, ".", minor, ".", patch);
}

} // namespace tarn::dem
