#include "dem/voids.hpp"

#include "core/error.hpp"
#include "dem/gdal_door.hpp"

#include <algorithm>
#include <cmath>
#include <gdal_alg.h>
#include <limits>
#include <vector>

namespace tarn::dem {

namespace {

constexpr unsigned char no_data = mark::outside | mark::filled;

/// Gives each enclosed void that is left the lowest height around it: a lake without returns is
/// flat.
void fill_middles(Grid<float>& z, Marks& marks) {
    const auto left = [&](Node n) { return std::isnan(z[n]) && !(marks[n] & mark::outside); };
    for (int row = 0; row < z.size.rows; ++row)
        for (int col = 0; col < z.size.cols; ++col) {
            const Node start{col, row};
            if (!left(start))
                continue;
            float lowest = std::numeric_limits<float>::infinity();
            marks[start] |= mark::seen;
            search<4>(
                z.size, {start},
                [&](Node n) {
                    if (!std::isnan(z[n]) && !(marks[n] & mark::outside))
                        lowest = std::min(lowest, z[n]);
                    if (!left(n) || (marks[n] & mark::seen))
                        return false;
                    marks[n] |= mark::seen;
                    return true;
                },
                [](Node) {});
            z[start] = lowest;
            search<4>(
                z.size, {start},
                [&](Node n) {
                    if (!left(n))
                        return false;
                    z[n] = lowest;
                    return true;
                },
                [](Node) {});
        }
    clear(marks, mark::seen);
}

/// The interpolation tile by tile: no node's value depends on any farther than `reach` away.
void interpolate_marked(Grid<float>& z, const Marks& marks, int reach) {
    constexpr int side = 1024;
    for (int r0 = 0; r0 < z.size.rows; r0 += side)
        for (int c0 = 0; c0 < z.size.cols; c0 += side) {
            const int r1 = std::min(r0 + side, z.size.rows), c1 = std::min(c0 + side, z.size.cols);
            bool any = false;
            for (int row = r0; row < r1 && !any; ++row)
                for (int col = c0; col < c1 && !any; ++col)
                    any = marks[{col, row}] & no_data;
            if (!any)
                continue;
            const int halo = reach + 2;
            const int wr = std::max(r0 - halo, 0), wc = std::max(c0 - halo, 0);
            Grid<float> part(
                {std::min(c1 + halo, z.size.cols) - wc, std::min(r1 + halo, z.size.rows) - wr});
            for (int row = 0; row < part.size.rows; ++row)
                for (int col = 0; col < part.size.cols; ++col)
                    part[{col, row}] = marks[{wc + col, wr + row}] & no_data
                                           ? std::numeric_limits<float>::quiet_NaN()
                                           : z[{wc + col, wr + row}];
            interpolate_voids(part, reach);
            for (int row = r0; row < r1; ++row)
                for (int col = c0; col < c1; ++col)
                    if (marks[{col, row}] & no_data)
                        z[{col, row}] = part[{col - wc, row - wr}];
        }
}

} // namespace

void interpolate_voids(Grid<float>& values, int reach) {
    Grid<unsigned char> valid(values.size);
    bool any = false, all = true;
    for (std::size_t i = 0; i < values.values.size(); ++i) {
        valid.values[i] = std::isnan(values.values[i]) ? 0 : 255;
        any |= valid.values[i] != 0;
        all &= valid.values[i] != 0;
        if (!valid.values[i])
            values.values[i] = 0.0f; // GDAL reads the mask, but must not meet NaN in its sums
    }
    const Grid<unsigned char> had = valid;
    if (any && !all) {
        GdalMessages messages;
        Dataset data = wrap_memory(values.values.data(), values.size, GDT_Float32);
        Dataset mask = wrap_memory(valid.values.data(), values.size, GDT_Byte);
        GdalMessages inner;
        CPLStringList options;
        options.SetNameValue("TEMP_FILE_DRIVER", "MEM");
        // A filled node gets a real value; the others keep this marker.
        constexpr float untouched = -1e30f;
        for (std::size_t i = 0; i < values.values.size(); ++i)
            if (!had.values[i])
                values.values[i] = untouched;
        if (GDALFillNodata(GDALRasterBand::ToHandle(data->GetRasterBand(1)),
                           GDALRasterBand::ToHandle(mask->GetRasterBand(1)), double(reach), 0, 0,
                           options.List(), nullptr, nullptr) != CE_None)
            throw Error("voids cannot be filled (" + inner.last() + ")");
        data->FlushCache();
        for (std::size_t i = 0; i < values.values.size(); ++i)
            if (values.values[i] == untouched)
                values.values[i] = std::numeric_limits<float>::quiet_NaN();
    } else if (!any) {
        std::fill(values.values.begin(), values.values.end(),
                  std::numeric_limits<float>::quiet_NaN());
    }
}

VoidCount fill_voids(Grid<float>& z, Marks& marks) {
    VoidCount count;
    float lowest = std::numeric_limits<float>::infinity();
    for (const float value : z.values) {
        count.all += std::isnan(value);
        if (!std::isnan(value))
            lowest = std::min(lowest, value);
    }
    if (count.all == z.size.count())
        throw Error("there is no elevation data in this region",
                    "check --nodata, --bounds and the tiles' coverage");
    if (count.all == 0)
        return count;

    // Voids reachable from the edge over voids lie outside the data.
    std::vector<Node> rim;
    std::uint64_t outside = 0;
    const auto enter = [&](Node n) {
        if (!std::isnan(z[n]) || (marks[n] & mark::outside))
            return false;
        marks[n] |= mark::outside;
        ++outside;
        return true;
    };
    const auto start = [&](Node n) {
        if (enter(n))
            rim.push_back(n);
    };
    for (int col = 0; col < z.size.cols; ++col) {
        start({col, 0});
        start({col, z.size.rows - 1});
    }
    for (int row = 0; row < z.size.rows; ++row) {
        start({0, row});
        start({z.size.cols - 1, row});
    }
    search<4>(z.size, std::move(rim), enter, [](Node) {});
    count.inside = count.all - outside;
    for (std::size_t i = 0; i < z.values.size(); ++i)
        if (std::isnan(z.values[i]) && !(marks.values[i] & mark::outside))
            marks.values[i] |= mark::filled;
    interpolate_marked(z, marks, 100);
    fill_middles(z, marks);
    for (float& value : z.values)
        if (std::isnan(value))
            value = lowest;
    return count;
}

} // namespace tarn::dem
