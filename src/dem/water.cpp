#include "dem/water.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::dem {

namespace {

template <class Visit>
void each_neighbour(const Grid<unsigned char>& grid, Node at, Visit visit) {
    for (int dr = -1; dr <= 1; ++dr)
        for (int dc = -1; dc <= 1; ++dc) {
            const Node n{at.col + dc, at.row + dr};
            if ((dr != 0 || dc != 0) && grid.contains(n))
                visit(n);
        }
}

/// Offset and step so that each level is met best; see the header for what that serves.
void choose_codes(std::span<const double> levels, Heightfield& water) {
    const auto [low, high] = std::minmax_element(levels.begin(), levels.end());
    const double range = *high - *low;
    if (range == 0.0) {
        water.scale_m = 0.001;
        water.offset_m = *low - 0.001; // code 1 is the level
        return;
    }
    const auto worst = [&](double step) {
        double error = 0.0;
        for (const double level : levels) {
            const double f = (level - *low) / step;
            error = std::max(error, std::abs(f - std::round(f)) * step);
        }
        return error;
    };
    // 16 bits over `range` may be coarser than a millimetre: then a step is searched on which
    // all levels nearly fall, beginning with those that people write (whole millimetres ...).
    double best_step = std::max(range / 65534.0, 1e-6);
    double best = worst(best_step);
    for (const double step : {0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1})
        if (range / step <= 65534.0 && worst(step) < best) {
            best = worst(step);
            best_step = step;
        }
    for (int i = 0; i < 20'000 && best > 0.0005; ++i) {
        const double step = std::max(range / 65534.0, 1e-6) * (1.0 + 0.5 * i / 20'000.0);
        if (worst(step) < best) {
            best = worst(step);
            best_step = step;
        }
    }
    water.scale_m = best_step;
    water.offset_m = *low - best_step;
}

} // namespace

std::size_t separate(Heightfield& ground, const WetLake& lake) {
    std::size_t raised = 0;
    const double exact = (lake.level_m - ground.offset_m) / ground.scale_m;
    const auto below = static_cast<std::uint16_t>(std::clamp(std::ceil(exact) - 1.0, 0.0, 65535.0));
    const auto above =
        static_cast<std::uint16_t>(std::clamp(std::floor(exact) + 1.0, 0.0, 65535.0));
    for (int row = 0; row < ground.size().rows; ++row)
        for (int col = 0; col < ground.size().cols; ++col) {
            const Node at{col, row};
            if (!lake.wet[at])
                continue;
            ground.codes[at] = std::min(ground.codes[at], below);
            each_neighbour(lake.wet, at, [&](Node n) {
                if (!lake.wet[n] && ground.codes[n] < above) {
                    raised += above - ground.codes[n] > 1;
                    ground.codes[n] = above;
                }
            });
        }
    return raised;
}

Heightfield water_surface(const Heightfield& ground, std::span<const WetLake> lakes) {
    Heightfield water = ground;
    std::fill(water.codes.values.begin(), water.codes.values.end(), no_water_code);
    std::vector<double> levels;
    for (const WetLake& lake : lakes)
        levels.push_back(lake.level_m);
    if (levels.empty())
        return water;
    choose_codes(levels, water);
    // Dry margins first, wet nodes last: where two lakes are one node apart, neither loses water.
    for (const bool wet_pass : {false, true})
        for (const WetLake& lake : lakes) {
            const auto code = static_cast<std::uint16_t>(
                std::lround((lake.level_m - water.offset_m) / water.scale_m));
            for (int row = 0; row < water.size().rows; ++row)
                for (int col = 0; col < water.size().cols; ++col) {
                    const Node at{col, row};
                    if (!lake.wet[at])
                        continue;
                    if (wet_pass)
                        water.codes[at] = code;
                    else
                        each_neighbour(lake.wet, at, [&](Node n) { water.codes[n] = code; });
                }
        }
    return water;
}

} // namespace tarn::dem
