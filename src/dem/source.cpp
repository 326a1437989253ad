#include "dem/source.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <cstdio>
#include <gdal_utils.h>

namespace tarn::dem {

namespace fs = std::filesystem;

Source::Source() = default;
Source::Source(Source&&) noexcept = default;
Source& Source::operator=(Source&&) noexcept = default;
Source::~Source() { // views before what they read from
    raster.reset();
    while (!steps.empty())
        steps.pop_back();
}

std::string describe(const OGRSpatialReference& crs) {
    if (crs.IsEmpty())
        return "not declared";
    const char* authority = crs.GetAuthorityName(nullptr);
    const char* code = crs.GetAuthorityCode(nullptr);
    const char* name = crs.GetName();
    std::string out = name && *name ? name : "unnamed";
    if (authority && code)
        out += text(" (", authority, ":", code, ")");
    return out;
}

namespace {

/// CRC-32 (polynomial EDB88320, as zip and PNG use it) of a file's bytes.
std::string checksum(const std::string& path) {
    VSILFILE* file = VSIFOpenL(path.c_str(), "rb");
    if (!file)
        return "unreadable";
    static const auto table = [] {
        std::vector<std::uint32_t> t(256);
        for (std::uint32_t i = 0; i < 256; ++i) {
            std::uint32_t c = i;
            for (int k = 0; k < 8; ++k)
                c = (c & 1u) ? 0xEDB88320u ^ (c >> 1) : c >> 1;
            t[i] = c;
        }
        return t;
    }();
    std::uint32_t crc = 0xFFFFFFFFu;
    std::vector<unsigned char> buffer(1 << 20);
    std::size_t got = 0;
    while ((got = VSIFReadL(buffer.data(), 1, buffer.size(), file)) > 0)
        for (std::size_t i = 0; i < got; ++i)
            crc = table[(crc ^ buffer[i]) & 0xFFu] ^ (crc >> 8);
    VSIFCloseL(file);
    char out[16];
    std::snprintf(out, sizeof out, "%08x", crc ^ 0xFFFFFFFFu);
    return out;
}

/// The rasters inside a zip archive, as GDAL paths; the file itself if it is no archive.
std::vector<std::string> expand(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    if (extension != ".zip" || path.string().starts_with("/vsizip/"))
        return {path.string()};
    const std::string inside = "/vsizip/" + path.string();
    std::vector<std::string> out;
    const CPLStringList names(VSIReadDirRecursive(inside.c_str()));
    for (int i = 0; i < names.size(); ++i) {
        const std::string member = inside + "/" + names[i];
        if (member.ends_with("/") ||
            !GDALIdentifyDriverEx(member.c_str(), GDAL_OF_RASTER, nullptr, nullptr))
            continue;
        out.push_back(member);
    }
    if (out.empty())
        throw Error(path.filename().string() + ": holds no raster that GDAL can read",
                    "unpack it and name the files, or check the archive");
    std::sort(out.begin(), out.end());
    // Archives often hold a picture to look at beside the data.
    const auto is_look = [](const std::string& name) {
        return name.ends_with(".png") || name.ends_with(".jpg") || name.ends_with(".jpeg");
    };
    if (!std::all_of(out.begin(), out.end(), is_look))
        std::erase_if(out, is_look);
    return out;
}

Source open_one(const std::string& path, const std::string& crs, const std::string& crs_hint) {
    register_drivers();
    Source source;
    source.name = fs::path(path).filename().string();
    GdalMessages messages;
    VSIStatBufL stat;
    if (!path.starts_with("/vsi") && path.find(':') == std::string::npos &&
        VSIStatL(path.c_str(), &stat) != 0)
        throw Error(path + ": no such file", "check the path");
    source.original.reset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
    if (!source.original)
        throw Error(source.name + ": GDAL cannot read it (" + messages.last() + ")",
                    "try gdalinfo on it");
    GDALDataset& ds = *source.original;
    source.cols = ds.GetRasterXSize();
    source.rows = ds.GetRasterYSize();
    if (ds.GetRasterCount() < 1 || source.cols < 2 || source.rows < 2)
        throw Error(text(source.name, ": ", source.cols, " x ", source.rows, " with ",
                         ds.GetRasterCount(), " bands is no elevation grid"),
                    "need one band of at least 2 x 2");
    if (!crs.empty()) {
        if (source.crs.SetFromUserInput(crs.c_str()) != OGRERR_NONE)
            throw Error("--crs '" + crs + "' is not understood (" + messages.last() + ")",
                        "give EPSG:code, a PROJ string or WKT");
    } else if (const auto* declared = ds.GetSpatialRef()) {
        source.crs = *declared;
    }
    source.crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    if (source.crs.IsEmpty())
        throw Error(source.name + ": no CRS", crs_hint);
    if (source.crs.IsLocal() || (!source.crs.IsProjected() && !source.crs.IsGeographic()))
        throw Error(source.name + ": its CRS '" + describe(source.crs) +
                        "' does not say where on Earth it is",
                    crs_hint);
    if (ds.GetGeoTransform(source.transform.v) != CE_None)
        throw Error(source.name + ": no georeference (no geotransform)",
                    "georeference it, for example with gdal_translate -a_ullr");
    for (double v : source.transform.v)
        if (!std::isfinite(v))
            throw Error(source.name + ": its geotransform is not finite", "georeference it again");
    if (source.transform.v[1] * source.transform.v[5] -
            source.transform.v[2] * source.transform.v[4] ==
        0.0)
        throw Error(source.name + ": its geotransform has no area", "georeference it again");
    if (source.crs.IsGeographic() && !source.crs.IsProjected()) {
        const double* g = source.transform.v;
        const double lon1 = g[0] + g[1] * source.cols + g[2] * source.rows;
        const double lat0 = g[3], lat1 = g[3] + g[4] * source.cols + g[5] * source.rows;
        if (std::max(std::abs(lat0), std::abs(lat1)) > 90.1 ||
            std::max(std::abs(g[0]), std::abs(lon1)) > 540.0)
            throw Error(text(source.name, ": declared as degrees, but reaches ", g[0], "..", lon1,
                             ", ", lat1, "..", lat0),
                        "its coordinates look like metres: give their CRS with --crs EPSG:...");
    }
    if (source.crs.IsProjected()) {
        const double* g = source.transform.v;
        const double reach =
            std::max({std::abs(g[0]), std::abs(g[3]), std::abs(g[0] + g[1] * source.cols),
                      std::abs(g[3] + g[5] * source.rows)});
        if (reach <= 540.0 && std::abs(g[1]) < 0.05 && std::abs(g[5]) < 0.05)
            throw Error(text(source.name, ": declared as metres, but lies at ", g[0], ", ", g[3],
                             " with pixels of ", g[1]),
                        "its coordinates look like degrees: give --crs EPSG:4326");
    }
    source.input.name = source.name;
    source.input.format = ds.GetDriverName();
    source.input.crs = describe(source.crs);
    if (source.crs.IsCompound()) {
        const char* vertical = source.crs.GetAttrValue("COMPD_CS|VERT_CS");
        source.input.vertical = vertical ? vertical : "not declared";
    } else {
        source.input.vertical = "not declared";
    }
    source.input.size = text(source.cols, " x ", source.rows);
    source.input.checksum = checksum(path);
    return source;
}

Dataset translate(GDALDataset& from, Arguments& arguments, const std::string& name,
                  const GdalMessages& messages) {
    GDALTranslateOptions* options = GDALTranslateOptionsNew(arguments.get(), nullptr);
    Dataset out(
        GDALDataset::FromHandle(GDALTranslate("", GDALDataset::ToHandle(&from), options, nullptr)));
    GDALTranslateOptionsFree(options);
    if (!out)
        throw Error(name + ": cannot be read (" + messages.last() + ")",
                    "try gdalinfo -checksum on it");
    return out;
}

/// A view of band 1 as stored, in which every kind of void is the one declared nodata value: what
/// the file declares, a mask of its own, --nodata, and for floating point NaN and -9999, which
/// writers forget to declare and which no place on land reaches.
Dataset with_voids_declared(Source& source, const std::optional<double>& nodata,
                            const GdalMessages& messages) {
    GDALDataset& ds = *source.original;
    GDALRasterBand& band = *ds.GetRasterBand(1);
    int declared = 0;
    double value = band.GetNoDataValue(&declared);
    const bool masked = (band.GetMaskFlags() & (GMF_PER_DATASET | GMF_ALPHA)) != 0;
    const bool floating = GDALDataTypeIsFloating(band.GetRasterDataType()) != 0;
    const bool second = nodata && declared && *nodata != value;
    if (!masked && !second && (declared || !floating)) {
        Arguments view{"-of", "VRT", "-b", "1"};
        if (nodata && !declared) {
            view.add("-a_nodata");
            view.add(text(*nodata));
        }
        return translate(ds, view, source.name, messages);
    }
    Arguments copy{"-of", "MEM", "-ot", "Float32", "-b", "1"};
    Dataset out = translate(ds, copy, source.name, messages);
    GDALRasterBand& values = *out->GetRasterBand(1);
    const float mark = -32768.0f;
    std::vector<float> line(std::size_t(source.cols));
    std::vector<unsigned char> mask(std::size_t(source.cols), 255);
    std::size_t odd = 0;
    for (int row = 0; row < source.rows; ++row) {
        if (values.RasterIO(GF_Read, 0, row, source.cols, 1, line.data(), source.cols, 1,
                            GDT_Float32, 0, 0) != CE_None ||
            (masked && band.GetMaskBand()->RasterIO(GF_Read, 0, row, source.cols, 1, mask.data(),
                                                    source.cols, 1, GDT_Byte, 0, 0) != CE_None))
            throw Error(source.name + ": cannot be read (" + messages.last() + ")",
                        "try gdalinfo -checksum on it");
        for (std::size_t i = 0; i < line.size(); ++i) {
            const float z = line[i];
            const bool forgotten =
                !declared && (z == -9999.0f || z == -32768.0f || !std::isfinite(z));
            odd += forgotten;
            if (mask[i] == 0 || forgotten || !std::isfinite(z) ||
                (declared && z == static_cast<float>(value)) ||
                (nodata && z == static_cast<float>(*nodata)))
                line[i] = mark;
        }
        if (values.RasterIO(GF_Write, 0, row, source.cols, 1, line.data(), source.cols, 1,
                            GDT_Float32, 0, 0) != CE_None)
            throw Error(source.name + ": cannot be read (" + messages.last() + ")");
    }
    values.SetNoDataValue(mark);
    values.SetScale(band.GetScale());
    values.SetOffset(band.GetOffset());
    if (odd > 0)
        source.notes.push_back(
            text(source.name, ": ", odd, " undeclared voids (NaN, -9999) taken as no data"));
    if (second)
        source.notes.push_back(text(source.name, ": declares nodata ", value, "; --nodata ",
                                    *nodata, " is taken as void too"));
    return out;
}

/// Replaces the raster by a view of band 1 as Float32 metres with its nodata declared.
void to_metres(Source& source, const std::optional<double>& nodata) {
    GdalMessages messages;
    GDALDataset& ds = *source.original;
    GDALRasterBand& band = *ds.GetRasterBand(1);
    if (band.GetColorInterpretation() == GCI_RedBand ||
        band.GetColorInterpretation() == GCI_PaletteIndex ||
        (ds.GetRasterCount() >= 3 && band.GetRasterDataType() == GDT_Byte))
        throw Error(source.name + ": is a picture, not elevations", "give it with --ortho");
    if (GDALDataTypeIsComplex(band.GetRasterDataType()))
        throw Error(source.name + ": holds complex numbers, not elevations");
    double factor = 1.0;
    std::string unit = band.GetUnitType();
    if (unit.empty() && source.crs.IsCompound()) { // formats that carry the unit in the CRS only
        const char* name = nullptr;
        factor = source.crs.GetTargetLinearUnits("COMPD_CS|VERT_CS", &name);
        if (!(factor > 1e-4 && factor < 1e4))
            factor = 1.0;
        if (factor != 1.0)
            unit = name ? name : "the CRS's unit";
    } else if (unit == "ft" || unit == "foot" || unit == "feet" || unit == "international foot") {
        factor = 0.3048;
    } else if (unit == "US survey foot" || unit == "us-ft" || unit == "ftUS") {
        factor = 1200.0 / 3937.0;
    } else if (unit == "cm" || unit == "centimetre") {
        factor = 0.01;
    } else if (!unit.empty() && unit != "m" && unit != "metre" && unit != "meter" &&
               unit != "metres" && unit != "meters") {
        source.notes.push_back(source.name + ": vertical unit '" + unit +
                               "' is not known; taken as metres");
    }
    if (factor != 1.0)
        source.notes.push_back(text(source.name, ": heights in ", unit, ", turned into metres"));

    Dataset view = with_voids_declared(source, nodata, messages);
    const bool scaled = band.GetScale() != 1.0 || band.GetOffset() != 0.0;
    Arguments unscale{"-of", "VRT", "-ot", "Float32", "-b", "1", "-unscale"};
    Dataset metres = translate(*view, unscale, source.name, messages);
    source.steps.push_back(std::move(view));
    if (factor != 1.0) {
        // GDAL's -scale maps [0, 1] to [0, factor] linearly and leaves nodata alone.
        Arguments feet{"-of", "MEM", "-ot", "Float32", "-scale", "0", "1", "0", text(factor)};
        Dataset turned = translate(*metres, feet, source.name, messages);
        source.steps.push_back(std::move(metres));
        metres = std::move(turned);
    }
    if (scaled)
        source.notes.push_back(text(source.name, ": band scale ", band.GetScale(), " and offset ",
                                    band.GetOffset(), " applied"));
    metres->SetSpatialRef(&source.crs);
    source.raster = std::move(metres);
}

} // namespace

std::vector<Source> open_sources(const fs::path& path, const SourceOptions& options) {
    register_drivers();
    std::vector<Source> out;
    for (const std::string& member : expand(path)) {
        out.push_back(open_one(member, options.crs, options.crs_hint));
        out.back().input.role = "dem";
        to_metres(out.back(), options.nodata);
    }
    return out;
}

Source open_picture(const fs::path& path, const std::string& crs) {
    Source source = open_one(expand(path).front(), crs,
                             "set it in the file, for example with gdal_edit.py -a_srs EPSG:...");
    source.input.role = "ortho";
    return source;
}

} // namespace tarn::dem
