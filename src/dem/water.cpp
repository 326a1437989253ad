#include "dem/water.hpp"

#include "core/parallel.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::dem {

namespace {

std::uint16_t code_of(const Heightfield& water, double level_m) {
    const double code = std::round((level_m - water.offset_m) / water.scale_m);
    return static_cast<std::uint16_t>(std::clamp(code, 1.0, 65535.0));
}

} // namespace

Heightfield empty_water(const Heightfield& ground, std::span<const double> levels) {
    Heightfield water = {.codes = Grid<std::uint16_t>(ground.size(), no_water_code),
                         .spacing_m = ground.spacing_m,
                         .west_m = ground.west_m,
                         .north_m = ground.north_m,
                         .offset_m = ground.offset_m,
                         .scale_m = ground.scale_m};
    if (levels.empty())
        return water;
    const auto [low, high] = std::minmax_element(levels.begin(), levels.end());
    const double range = *high - *low;
    const double first = levels.front();
    // Codes are counted from the first level, so that it is met whatever the step.
    const auto worst = [&](double step) {
        double error = 0.0;
        for (const double level : levels) {
            const double f = (level - first) / step;
            error = std::max(error, std::abs(f - std::round(f)) * step);
        }
        return error;
    };
    // 16 bits over `range` may be coarser than a millimetre: then a step is searched on which
    // all levels nearly fall, beginning with those that people write (whole millimetres ...).
    const double finest = std::max(range / 65532.0, 1e-6);
    double best_step = range == 0.0 ? 0.001 : finest;
    double best = worst(best_step);
    for (const double step : {0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1})
        if (step >= finest && worst(step) < best) {
            best = worst(step);
            best_step = step;
        }
    for (int i = 0; i < 20'000 && best > 0.0005; ++i) {
        const double step = finest * (1.0 + 0.5 * i / 20'000.0);
        if (worst(step) < best) {
            best = worst(step);
            best_step = step;
        }
    }
    water.scale_m = best_step;
    water.offset_m = first - best_step * (std::round((first - *low) / best_step) + 1.0);
    return water;
}

double drawn_level_m(const Heightfield& water, double level_m) {
    return water.offset_m + water.scale_m * code_of(water, level_m);
}

std::size_t part_lakes(LakeOf& lake_of, std::span<const double> levels) {
    if (levels.size() < 2)
        return 0;
    std::size_t dried = 0;
    each_shore_node(lake_of, [&](Node at) {
        const double level = levels[lake_of[at] - 1u];
        bool higher = false;
        each_neighbour(lake_of.size, at, [&](Node n) {
            higher |= lake_of[n] != 0 && levels[lake_of[n] - 1u] < level;
        });
        if (higher) {
            lake_of[at] = 0;
            ++dried;
        }
    });
    return dried;
}

std::size_t pour(const Heightfield& original, const LakeOf& lake_of, std::span<const double> levels,
                 Heightfield& ground, Heightfield& water) {
    struct Codes {
        std::uint16_t water, below, above;
    };
    std::vector<Codes> codes{{no_water_code, 0, 0}};
    for (const double level : levels) {
        const double exact = (level - original.offset_m) / original.scale_m;
        const auto clamped = [](double code) {
            return static_cast<std::uint16_t>(std::clamp(code, 0.0, 65535.0));
        };
        codes.push_back({code_of(water, level), clamped(std::ceil(exact) - 1.0),
                         clamped(std::floor(exact) + 1.0)});
    }
    const int cols = lake_of.size.cols, rows = lake_of.size.rows;
    std::vector<std::size_t> raised(std::size_t(rows), 0);
    share_out(rows, 0, [&](int first, int last) {
        for (int row = first; row < last; ++row) {
            const std::size_t start = lake_of.index({0, row});
            const std::uint16_t* here = &lake_of.values[start];
            const std::uint16_t* above = row > 0 ? here - cols : here;
            const std::uint16_t* below = row + 1 < rows ? here + cols : here;
            const std::uint16_t* from = &original.codes.values[start];
            std::uint16_t* to = &ground.codes.values[start];
            std::uint16_t* wet = &water.codes.values[start];
            for (int col = 0; col < cols; ++col) {
                if (const unsigned id = here[col]; id != 0) {
                    wet[col] = codes[id].water;
                    to[col] = std::min(from[col], codes[id].below);
                    continue;
                }
                to[col] = from[col];
                const int l = col > 0 ? col - 1 : col, r = col + 1 < cols ? col + 1 : col;
                if ((above[l] | above[col] | above[r] | here[l] | here[r] | below[l] | below[col] |
                     below[r]) == 0)
                    continue;
                const std::uint16_t was = from[col];
                for (const std::uint16_t* line : {above, here, below})
                    for (const int c : {l, col, r})
                        if (const unsigned id = line[c]; id != 0) {
                            to[col] = std::max(to[col], codes[id].above);
                            if (wet[col] == no_water_code || codes[id].water < wet[col])
                                wet[col] = codes[id].water;
                        }
                raised[std::size_t(row)] += to[col] - was > 1;
            }
        }
    });
    std::size_t sum = 0;
    for (const std::size_t count : raised)
        sum += count;
    return sum;
}

} // namespace tarn::dem
