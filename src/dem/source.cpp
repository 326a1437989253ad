#include "dem/source.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <cstdio>
#include <span>

namespace tarn::dem {

namespace fs = std::filesystem;

Source::Source() = default;
Source::Source(Source&&) noexcept = default;
Source& Source::operator=(Source&&) noexcept = default;
Source::~Source() { // the view before what it reads from
    raster.reset();
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

double metres_per_unit(const std::string& unit) {
    if (unit.empty() || unit == "m" || unit == "metre" || unit == "meter" || unit == "metres" ||
        unit == "meters")
        return 1.0;
    if (unit == "ft" || unit == "foot" || unit == "feet" || unit == "international foot")
        return 0.3048;
    if (unit == "US survey foot" || unit == "us-ft" || unit == "ftUS" || unit == "sft")
        return 1200.0 / 3937.0;
    if (unit == "dm" || unit == "decimetre")
        return 0.1;
    if (unit == "cm" || unit == "centimetre")
        return 0.01;
    if (unit == "mm" || unit == "millimetre")
        return 0.001;
    return 0.0;
}

namespace {

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
        throw Error(source.name + ": GDAL cannot read it (" +
                        (messages.warned() ? messages.last() : "no format that it knows") + ")",
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
    source.path = path;
    return source;
}

double height_factor(Source& source, const std::string& asked) {
    if (!asked.empty()) {
        source.notes.push_back(source.name + ": heights taken as " + asked + " (--unit)");
        return metres_per_unit(asked);
    }
    std::string unit = source.original->GetRasterBand(source.band)->GetUnitType();
    double factor = 1.0;
    if (unit.empty() && source.crs.IsCompound()) { // formats that carry the unit in the CRS only
        const char* name = nullptr;
        factor = source.crs.GetTargetLinearUnits("COMPD_CS|VERT_CS", &name);
        unit = name ? name : "the CRS's unit";
        if (!(factor > 1e-4 && factor < 1e4))
            factor = 0.0;
    } else if (unit.empty()) {
        source.unit_declared = false;
    } else {
        factor = metres_per_unit(unit);
    }
    if (factor == 0.0) {
        source.notes.push_back(source.name + ": vertical unit '" + unit +
                               "' is not known; taken as metres (--unit says otherwise)");
        return 1.0;
    }
    if (factor != 1.0)
        source.notes.push_back(text(source.name, ": heights in ", unit, ", turned into metres"));
    return factor;
}

/// Cut-outs of whole-metre models often come with a rim of 0 that nobody declared. Zeros are taken
/// for such a collar when they reach the raster's edge and nothing else lies within 3 m of 0: a
/// real coast has ground at 1, 2 and 3 m.
/// @return the number of zeros, or 0 if they are heights
std::size_t collar_nodes(GDALDataset& heights, const std::string& name) {
    GDALRasterBand& band = *heights.GetRasterBand(1);
    const int cols = heights.GetRasterXSize(), rows = heights.GetRasterYSize();
    if (std::max(cols, rows) > 100'000) // no cut-out, but the mosaic of a country
        return 0;
    GdalMessages messages;
    std::vector<float> line(std::size_t(std::max(cols, rows)));
    const auto read = [&](int x, int y, int w, int h) {
        if (band.RasterIO(GF_Read, x, y, w, h, line.data(), w, h, GDT_Float32, 0, 0) != CE_None)
            throw Error(name + ": cannot be read (" + messages.last() + ")",
                        "the file may be cut off: check it with gdalinfo -checksum");
        return std::span<const float>(line.data(), std::size_t(w) * std::size_t(h));
    };
    const auto zeros = [](std::span<const float> values) {
        return std::size_t(std::count(values.begin(), values.end(), 0.0f));
    };
    // Slanted collars touch the first or last row; upright ones fill the corners.
    if (zeros(read(0, 0, cols, 1)) + zeros(read(0, rows - 1, cols, 1)) < 2)
        return 0;
    std::size_t found = 0, others = 0;
    for (int row = 0; row < rows; ++row)
        for (const float z : read(0, row, cols, 1)) {
            found += z == 0.0f;
            others += z != 0.0f && !std::isnan(z);
            if (z != 0.0f && std::abs(z) <= 3.0f)
                return 0;
        }
    return others > 0 ? found : 0;
}

/// Replaces the raster by a view of it as Float32 metres, NaN where there is no data.
void to_metres(Source& source, const SourceOptions& options) {
    GdalMessages messages;
    GDALDataset& ds = *source.original;
    GDALRasterBand& band = *ds.GetRasterBand(source.band);
    if (source.band == 1 && (band.GetColorInterpretation() == GCI_RedBand ||
                             band.GetColorInterpretation() == GCI_PaletteIndex ||
                             (ds.GetRasterCount() >= 3 && band.GetRasterDataType() == GDT_Byte)))
        throw Error(source.name + ": is a picture, not elevations", "give it with --ortho");
    if (GDALDataTypeIsComplex(band.GetRasterDataType()))
        throw Error(source.name + ": holds complex numbers, not elevations",
                    "give a raster of heights");
    if (ds.GetRasterCount() > 1)
        source.notes.push_back(
            text(source.name, ": has ", ds.GetRasterCount(), " bands; the first is taken"));
    HeightRule rule;
    rule.scale = band.GetScale();
    rule.offset = band.GetOffset();
    if (rule.scale == 0.0 || !std::isfinite(rule.scale) || !std::isfinite(rule.offset))
        throw Error(text(source.name, ": band scale ", rule.scale, " and offset ", rule.offset,
                         " make no heights"),
                    "set them right with gdal_edit.py -scale -offset");
    rule.factor = height_factor(source, options.unit);
    int declared = 0;
    const double value = band.GetNoDataValue(&declared);
    if (declared)
        rule.void_values.push_back(value);
    if (options.nodata) {
        rule.void_values.push_back(*options.nodata);
        if (declared && *options.nodata != value && !std::isnan(*options.nodata))
            source.notes.push_back(text(source.name, ": declares nodata ", value, "; --nodata ",
                                        *options.nodata, " is taken as void too"));
    }
    rule.use_mask = (band.GetMaskFlags() & (GMF_PER_DATASET | GMF_ALPHA)) != 0;
    rule.find_forgotten = !declared && GDALDataTypeIsFloating(band.GetRasterDataType());
    source.findings = std::make_shared<HeightFindings>();
    if (options.depths_below_m) {
        double least = 0.0, greatest = 0.0, mean = 0.0, deviation = 0.0;
        const Dataset plain = view_heights(ds, source.band, rule, source.findings);
        if (plain->GetRasterBand(1)->ComputeStatistics(TRUE, &least, &greatest, &mean, &deviation,
                                                       nullptr, nullptr) != CE_None)
            throw Error(source.name + ": holds no depths (" + messages.last() + ")");
        rule.base = *options.depths_below_m;
        rule.factor = mean < 0.0 ? rule.factor : -rule.factor;
        source.notes.push_back(text(source.name, ": its values are depths, ",
                                    mean < 0.0 ? "negative" : "positive", " down, below ",
                                    *options.depths_below_m, " m (--depths)"));
    } else if (!declared && !rule.use_mask && !options.nodata) {
        const Dataset plain = view_heights(ds, source.band, rule, source.findings);
        if (const std::size_t zeros = collar_nodes(*plain, source.name)) {
            rule.void_values.push_back(-rule.offset / rule.scale);
            source.notes.push_back(text(source.name, ": ", zeros,
                                        " nodes of exactly 0 reach the raster's edge and "
                                        "nothing else lies within 3 m of 0: taken as no "
                                        "data (--nodata none keeps them)"));
        }
    }
    if (rule.scale != 1.0 || rule.offset != 0.0)
        source.notes.push_back(text(source.name, ": band scale ", rule.scale, " and offset ",
                                    rule.offset, " applied"));
    source.raster = view_heights(ds, source.band, rule, source.findings);
    source.raster->SetSpatialRef(&source.crs);
}

} // namespace

std::vector<Source> open_sources(const fs::path& path, const SourceOptions& options) {
    register_drivers();
    std::vector<Source> out;
    for (const std::string& member : expand(path)) {
        out.push_back(open_one(member, options.crs, options.crs_hint));
        out.back().input.role = "dem";
        to_metres(out.back(), options);
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
