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

/// A MEM dataset over our own memory, nothing copied.
Dataset wrap(void* data, GridSize size, GDALDataType type) {
    register_drivers();
    auto* driver = GetGDALDriverManager()->GetDriverByName("MEM");
    Dataset out(driver->Create("", size.cols, size.rows, 0, type, nullptr));
    char pointer[64] = {};
    CPLPrintPointer(pointer, data, sizeof pointer - 1);
    CPLStringList options;
    options.SetNameValue("DATAPOINTER", pointer);
    if (!out || out->AddBand(type, options.List()) != CE_None)
        throw Error("out of memory");
    return out;
}

/// Gives each enclosed void that is left the lowest height around it: a lake without returns is
/// flat.
void fill_middles(Grid<float>& z, const Grid<unsigned char>& outside) {
    Grid<unsigned char> seen(z.size);
    std::vector<Node> members;
    for (int row = 0; row < z.size.rows; ++row)
        for (int col = 0; col < z.size.cols; ++col) {
            const Node start{col, row};
            if (!std::isnan(z[start]) || outside[start] || seen[start])
                continue;
            float lowest = std::numeric_limits<float>::infinity();
            members.assign(1, start);
            seen[start] = 1;
            for (std::size_t i = 0; i < members.size(); ++i) {
                const Node at = members[i];
                for (const Node n : {Node{at.col - 1, at.row}, Node{at.col + 1, at.row},
                                     Node{at.col, at.row - 1}, Node{at.col, at.row + 1}}) {
                    if (!z.contains(n) || outside[n])
                        continue;
                    if (!std::isnan(z[n])) {
                        lowest = std::min(lowest, z[n]);
                    } else if (!seen[n]) {
                        seen[n] = 1;
                        members.push_back(n);
                    }
                }
            }
            for (const Node n : members)
                z[n] = lowest;
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
        Dataset data = wrap(values.values.data(), values.size, GDT_Float32);
        Dataset mask = wrap(valid.values.data(), values.size, GDT_Byte);
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

Voids fill_voids(Grid<float>& z) {
    Voids out{.outside = Grid<unsigned char>(z.size), .filled = Grid<unsigned char>(z.size)};
    float lowest = std::numeric_limits<float>::infinity();
    for (const float value : z.values) {
        out.count += std::isnan(value);
        if (!std::isnan(value))
            lowest = std::min(lowest, value);
    }
    if (out.count == z.size.count())
        throw Error("there is no elevation data in this region",
                    "check --nodata, --bounds and the tiles' coverage");
    if (out.count == 0)
        return out;

    // Voids reachable from the edge over voids lie outside the data.
    std::vector<Node> queue;
    const auto push = [&](Node n) {
        if (std::isnan(z[n]) && !out.outside[n]) {
            out.outside[n] = 1;
            queue.push_back(n);
        }
    };
    for (int col = 0; col < z.size.cols; ++col) {
        push({col, 0});
        push({col, z.size.rows - 1});
    }
    for (int row = 0; row < z.size.rows; ++row) {
        push({0, row});
        push({z.size.cols - 1, row});
    }
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const Node at = queue[i];
        const Node next[4] = {
            {at.col - 1, at.row}, {at.col + 1, at.row}, {at.col, at.row - 1}, {at.col, at.row + 1}};
        for (const Node n : next)
            if (z.contains(n))
                push(n);
    }
    out.inside = out.count - queue.size();
    for (std::size_t i = 0; i < z.values.size(); ++i)
        out.filled.values[i] = std::isnan(z.values[i]) && !out.outside.values[i];
    interpolate_voids(z, 100);
    fill_middles(z, out.outside);
    for (float& value : z.values)
        if (std::isnan(value))
            value = lowest;
    return out;
}

} // namespace tarn::dem
