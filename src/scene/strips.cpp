#include "scene/strips.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tarn::scene {

int strip_rows(const RenderSettings& settings) {
    constexpr std::int64_t whole_px = std::int64_t(1) << 25;
    if (std::int64_t(settings.width_px) * settings.height_px <= whole_px)
        return settings.height_px;
    return std::max(8, int(whole_px / 2 / settings.width_px) / 8 * 8);
}

View overview_of(View view) {
    constexpr int longest_px = 1280, most_samples = 4;
    RenderSettings& s = view.settings;
    const double share = double(longest_px) / std::max(s.width_px, s.height_px);
    if (share < 1.0) {
        s.width_px = std::max(1, int(std::lround(s.width_px * share)));
        s.height_px = std::max(1, int(std::lround(s.height_px * share)));
    }
    s.samples = std::min(s.samples, most_samples);
    return view;
}

} // namespace tarn::scene
