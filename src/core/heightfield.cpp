#include "core/heightfield.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>

namespace tarn {

double Heightfield::elevation_m(double x, double y) const {
    const double c = std::clamp(col(x), 0.0, double(codes.size.cols - 1));
    const double r = std::clamp(row(y), 0.0, double(codes.size.rows - 1));
    const int c0 = std::min(int(c), codes.size.cols - 2),
              r0 = std::min(int(r), codes.size.rows - 2);
    const double u = c - c0, v = r - r0;
    const double north = (1 - u) * elevation_m(Node{c0, r0}) + u * elevation_m(Node{c0 + 1, r0});
    const double south =
        (1 - u) * elevation_m(Node{c0, r0 + 1}) + u * elevation_m(Node{c0 + 1, r0 + 1});
    return (1 - v) * north + v * south;
}

double Heightfield::min_elevation_m() const {
    return offset_m + scale_m * *std::min_element(codes.values.begin(), codes.values.end());
}

double Heightfield::max_elevation_m() const {
    return offset_m + scale_m * *std::max_element(codes.values.begin(), codes.values.end());
}

Heightfield quantise(std::span<const float> elevations_m, GridSize size, double spacing_m,
                     int spare_codes, std::span<const double> include_m) {
    if (size.cols < 2 || size.rows < 2)
        throw Error(text("grid is ", size.cols, " x ", size.rows, ", need at least 2 x 2"));
    if (!(spacing_m > 0.0)) // also rejects NaN
        throw Error(text("spacing is ", spacing_m, " m, must be positive"));
    if (elevations_m.size() != size.count())
        throw Error(text("got ", elevations_m.size(), " elevations for a ", size.cols, " x ",
                         size.rows, " grid"));
    for (std::size_t i = 0; i < elevations_m.size(); ++i)
        if (!std::isfinite(elevations_m[i]))
            throw Error(text("elevation at column ", i % std::size_t(size.cols), ", row ",
                             i / std::size_t(size.cols), " is not finite"),
                        "fill or mask no-data cells before quantising");

    const auto [least, greatest] = std::minmax_element(elevations_m.begin(), elevations_m.end());
    double low = *least, high = *greatest;
    for (const double height : include_m) {
        low = std::min(low, height);
        high = std::max(high, height);
    }
    Heightfield field;
    field.codes = Grid<std::uint16_t>(size);
    field.spacing_m = spacing_m;
    const double range_m = high - low;
    field.scale_m = range_m > 0.0 ? range_m / (65535.0 - 2.0 * spare_codes) : 1.0;
    field.offset_m = low - spare_codes * field.scale_m;
    const double per_m = 1.0 / field.scale_m;
    for (std::size_t i = 0; i < elevations_m.size(); ++i)
        field.codes.values[i] = static_cast<std::uint16_t>( // rounds: the quotient is >= 0
            (double(elevations_m[i]) - field.offset_m) * per_m + 0.5);
    return field;
}

} // namespace tarn
