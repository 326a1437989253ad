#include "dem/ortho.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <gdal_alg.h>
#include <gdal_utils.h>
#include <utility>
#include <vector>

namespace tarn::dem {

namespace {

Dataset translate(GDALDataset& from, Arguments& arguments, const std::string& name) {
    GdalMessages messages;
    GDALTranslateOptions* options = GDALTranslateOptionsNew(arguments.get(), nullptr);
    Dataset out(
        GDALDataset::FromHandle(GDALTranslate("", GDALDataset::ToHandle(&from), options, nullptr)));
    GDALTranslateOptionsFree(options);
    if (!out)
        throw Error(name + ": cannot be read as a picture (" + messages.last() + ")");
    return out;
}

/// The range that the middle 99 % of the valid colours take, over all bands, from a sample.
std::pair<double, double> colour_range(GDALDataset& picture, int colours) {
    const int cols = std::min(picture.GetRasterXSize(), 512),
              rows = std::min(picture.GetRasterYSize(), 512);
    std::vector<double> values, line(std::size_t(cols) * std::size_t(rows));
    std::vector<unsigned char> mask(line.size());
    GdalMessages quiet;
    for (int b = 1; b <= colours; ++b) {
        GDALRasterBand& band = *picture.GetRasterBand(b);
        if (band.RasterIO(GF_Read, 0, 0, band.GetXSize(), band.GetYSize(), line.data(), cols, rows,
                          GDT_Float64, 0, 0) != CE_None ||
            band.GetMaskBand()->RasterIO(GF_Read, 0, 0, band.GetXSize(), band.GetYSize(),
                                         mask.data(), cols, rows, GDT_Byte, 0, 0) != CE_None)
            return {0.0, 255.0}; // reading it in earnest will say what is wrong
        for (std::size_t i = 0; i < line.size(); ++i)
            if (mask[i] != 0 && std::isfinite(line[i]))
                values.push_back(line[i]);
    }
    if (values.empty())
        return {0.0, 255.0};
    const auto at = [&](double share) {
        const auto k = std::ptrdiff_t(share * double(values.size() - 1));
        std::nth_element(values.begin(), values.begin() + k, values.end());
        return values[std::size_t(k)];
    };
    const double low = at(0.005), high = at(0.995);
    return {low, std::max(high, low + 1e-9)};
}

/// The bands that are red, green, blue (and alpha), if they are not simply the first ones.
std::vector<int> band_order(GDALDataset& picture) {
    int red = 0, green = 0, blue = 0, alpha = 0;
    const int bands = picture.GetRasterCount();
    for (int b = 1; b <= bands; ++b)
        switch (picture.GetRasterBand(b)->GetColorInterpretation()) {
        case GCI_RedBand:
            red = b;
            break;
        case GCI_GreenBand:
            green = b;
            break;
        case GCI_BlueBand:
            blue = b;
            break;
        case GCI_AlphaBand:
            alpha = b;
            break;
        default:
            break;
        }
    std::vector<int> out;
    if (red && green && blue)
        out = {red, green, blue};
    else if (bands > 4)
        out = {1, 2, 3};
    else
        return {};
    if (alpha)
        out.push_back(alpha);
    const bool plain = out[0] == 1 && out[1] == 2 && out[2] == 3 && int(out.size()) == bands;
    return plain ? std::vector<int>{} : out;
}

} // namespace

Ortho warp_ortho(Source& source, const geo::Frame& frame, const Heightfield& ground,
                 const Progress& progress) {
    GdalMessages messages;
    Dataset picked, view;
    GDALDataset* input = source.original.get();
    if (const auto order = band_order(*input); !order.empty()) {
        Arguments pick{"-of", "VRT"};
        for (const int band : order) {
            pick.add("-b");
            pick.add(text(band));
        }
        picked = translate(*input, pick, source.name);
        input = picked.get();
        source.notes.push_back(text(source.name, ": has ", source.original->GetRasterCount(),
                                    " bands; ", order[0], ", ", order[1], ", ", order[2],
                                    " are taken as red, green, blue"));
    }
    GDALRasterBand& first = *input->GetRasterBand(1);
    if (first.GetColorInterpretation() == GCI_PaletteIndex) {
        Arguments expand{"-of", "VRT", "-expand", "rgba"};
        view = translate(*input, expand, source.name);
        input = view.get();
    } else if (first.GetRasterDataType() != GDT_Byte) {
        // One stretch for all colours, so that a blue picture stays blue; what has no data or is
        // transparent becomes an alpha band, for after the stretch no value is left to say so.
        const int bands = input->GetRasterCount(), colours = bands >= 3 ? 3 : 1;
        const auto [low, high] = colour_range(*input, colours);
        Arguments scale{"-of", "VRT", "-ot", "Byte", "-a_nodata", "none"};
        for (int b = 1; b <= colours + 1; ++b) {
            scale.add("-b");
            scale.add(b <= colours ? text(b) : "mask");
            scale.add(text("-scale_", b));
            for (const double v :
                 {b <= colours ? low : 0.0, b <= colours ? high : 255.0, 0.0, 255.0})
                scale.add(text(v));
        }
        view = translate(*input, scale, source.name);
        view->GetRasterBand(colours + 1)->SetColorInterpretation(GCI_AlphaBand);
        input = view.get();
    }
    const double half = 0.5 * ground.spacing_m;
    const double oe = frame.origin_easting_m, on = frame.origin_northing_m;
    double west = oe + ground.west_m - half, east = oe + ground.east_m() + half;
    double south = on + ground.south_m() - half, north = on + ground.north_m + half;

    // The picture's own resolution in the frame, from GDAL's suggestion.
    double native = ground.spacing_m;
    {
        CPLStringList options;
        options.SetNameValue("DST_SRS", frame.wkt.c_str());
        void* transformer =
            GDALCreateGenImgProjTransformer2(GDALDataset::ToHandle(input), nullptr, options.List());
        double suggested[6];
        int cols = 0, rows = 0;
        double extent[4];
        if (!transformer ||
            GDALSuggestedWarpOutput2(GDALDataset::ToHandle(input), GDALGenImgProjTransform,
                                     transformer, suggested, &cols, &rows, extent, 0) != CE_None)
            throw Error(source.name + ": cannot be placed in the scene (" + messages.last() + ")",
                        "check its CRS");
        GDALDestroyGenImgProjTransformer(transformer);
        native = suggested[1];
        west = std::max(west, extent[0]);
        south = std::max(south, extent[1]);
        east = std::min(east, extent[2]);
        north = std::min(north, extent[3]);
    }
    if (!(west < east && south < north))
        throw Error(source.name + ": lies outside the scene", "give a picture of this place");
    const double spacing = std::max(native, std::max(east - west, north - south) / 8192.0);
    const int cols = std::max(1, int(std::ceil((east - west) / spacing)));
    const int rows = std::max(1, int(std::ceil((north - south) / spacing)));
    Arguments arguments{"-of",
                        "MEM",
                        "-t_srs",
                        frame.wkt,
                        "-te",
                        text(west),
                        text(north - rows * spacing),
                        text(west + cols * spacing),
                        text(north),
                        "-ts",
                        text(cols),
                        text(rows),
                        "-r",
                        spacing > 1.5 * native ? "average" : "bilinear",
                        "-dstalpha",
                        "-wo",
                        "NUM_THREADS=ALL_CPUS"};
    GDALWarpAppOptions* options = GDALWarpAppOptionsNew(arguments.get(), nullptr);
    GdalProgress watcher(progress, "draping the picture", 0.85, 0.95);
    GDALWarpAppOptionsSetProgress(options, &GdalProgress::callback, &watcher);
    GDALDatasetH handle = GDALDataset::ToHandle(input);
    Dataset out(GDALDataset::FromHandle(GDALWarp("", nullptr, 1, &handle, options, nullptr)));
    GDALWarpAppOptionsFree(options);
    watcher.check();
    if (!out)
        throw Error(source.name + ": cannot be warped (" + messages.last() + ")");

    Ortho ortho{.picture = {.width_px = cols, .height_px = rows, .channels = 4, .bytes = {}},
                .west_m = west - oe,
                .north_m = north - on,
                .spacing_m = spacing};
    auto& bytes = ortho.picture.bytes;
    bytes.resize(std::size_t(cols) * std::size_t(rows) * 4);
    const int bands = out->GetRasterCount(); // the last one is alpha
    for (int channel = 0; channel < 4; ++channel) {
        const int band = channel == 3 ? bands : bands >= 4 ? channel + 1 : 1;
        if (out->GetRasterBand(band)->RasterIO(GF_Read, 0, 0, cols, rows, bytes.data() + channel,
                                               cols, rows, GDT_Byte, 4,
                                               GSpacing(cols) * 4) != CE_None)
            throw Error(source.name + ": cannot be read (" + messages.last() + ")");
    }
    return ortho;
}

} // namespace tarn::dem
