#include "dem/warp.hpp"

#include "core/error.hpp"

#include <algorithm>
#include <cmath>
#include <gdal_utils.h>

namespace tarn::dem {

Extent image_of(const Extent& box, OGRCoordinateTransformation& to, const std::string& name) {
    Extent out;
    constexpr int steps = 32;
    for (int i = 0; i <= steps; ++i) {
        const double f = double(i) / steps;
        const double xs[4] = {box.west + f * (box.east - box.west),
                              box.west + f * (box.east - box.west), box.west, box.east};
        const double ys[4] = {box.south, box.north, box.south + f * (box.north - box.south),
                              box.south + f * (box.north - box.south)};
        for (int k = 0; k < 4; ++k) {
            double x = xs[k], y = ys[k];
            GdalMessages quiet;
            if (to.Transform(1, &x, &y) && std::isfinite(x) && std::isfinite(y))
                out.add(x, y);
        }
    }
    if (out.empty())
        throw Error(name + ": its corners cannot be placed on Earth",
                    "check its CRS and georeference, or give --crs");
    return out;
}

Grid<float> read_window(GDALDataset& ds, int col, int row, GridSize size) {
    Grid<float> out(size, void_m);
    const int c0 = std::max(col, 0), r0 = std::max(row, 0);
    const int c1 = std::min(col + size.cols, ds.GetRasterXSize());
    const int r1 = std::min(row + size.rows, ds.GetRasterYSize());
    if (c0 >= c1 || r0 >= r1)
        return out;
    GdalMessages messages;
    GDALRasterBand& band = *ds.GetRasterBand(1);
    float* first = out.values.data() + out.index({c0 - col, r0 - row});
    if (band.RasterIO(GF_Read, c0, r0, c1 - c0, r1 - r0, first, c1 - c0, r1 - r0, GDT_Float32, 4,
                      GSpacing(size.cols) * 4) != CE_None)
        throw Error("heights cannot be read (" + messages.last() + ")",
                    "the file may be cut off: check it with gdalinfo -checksum");
    return out; // views hold NaN where there is no data
}

Grid<float> warp(const std::vector<GDALDataset*>& inputs, const Target& target,
                 const std::string& resampling, const Progress& progress, const std::string& what,
                 double from, double to) {
    GdalMessages messages;
    std::vector<GDALDatasetH> handles;
    for (GDALDataset* input : inputs)
        handles.push_back(GDALDataset::ToHandle(input));
    Grid<float> out(target.size, void_m);
    Dataset onto = wrap_memory(out.values.data(), target.size, GDT_Float32);
    OGRSpatialReference crs;
    crs.SetFromUserInput(target.wkt.c_str());
    GeoTransform transform = target.transform();
    onto->SetGeoTransform(transform.v);
    onto->SetSpatialRef(&crs);
    // No nodata is declared for the target: it begins as NaN and stays so where nothing is written,
    // and GDAL keeps to its quick kernels if the sources have no voids either.
    Arguments arguments{"-r",           resampling, "-et", "0.02", "-wo", "NUM_THREADS=ALL_CPUS",
                        "-novshiftgrid"};
    GDALWarpAppOptions* options = GDALWarpAppOptionsNew(arguments.get(), nullptr);
    GdalProgress watcher(progress, what, from, to);
    GDALWarpAppOptionsSetProgress(options, &GdalProgress::callback, &watcher);
    const bool done = GDALWarp(nullptr, GDALDataset::ToHandle(onto.get()), int(handles.size()),
                               handles.data(), options, nullptr) != nullptr;
    GDALWarpAppOptionsFree(options);
    watcher.check();
    if (!done || messages.failed())
        throw Error("the rasters cannot be warped (" + messages.last() + ")",
                    "check that the files are whole (gdalinfo -checksum) and their CRS is right");
    onto->FlushCache(false);
    return out;
}

} // namespace tarn::dem
