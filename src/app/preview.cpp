#include "app/preview.hpp"

#include "core/text.hpp"
#include "image/annotate.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace tarn::app {

namespace {

/// Hypsometric tints, low to high; display values.
glm::dvec3 tint(double share) {
    static const glm::dvec3 stops[] = {{0.55, 0.66, 0.45}, {0.72, 0.75, 0.52}, {0.82, 0.76, 0.58},
                                       {0.74, 0.64, 0.53}, {0.80, 0.77, 0.75}, {0.96, 0.96, 0.97}};
    const double p = std::clamp(share, 0.0, 1.0) * 5.0;
    const int i = std::min(int(p), 4);
    return glm::mix(stops[i], stops[i + 1], p - i);
}

} // namespace

Picture draw_map(const scene::Scene& scene, int side_px) {
    const Heightfield& g = scene.ground;
    const double longest = std::max(g.size().cols, g.size().rows);
    const double step =
        std::max(longest / side_px, 0.25); // nodes per pixel; small grids are enlarged
    Picture out;
    out.width_px = std::max(1, int(g.size().cols / step));
    out.height_px = std::max(1, int(g.size().rows / step));
    out.bytes.resize(std::size_t(out.width_px) * std::size_t(out.height_px) * 3);
    const double low = g.min_elevation_m(), high = g.max_elevation_m();
    const double reach = step * g.spacing_m;
    for (int y = 0; y < out.height_px; ++y)
        for (int x = 0; x < out.width_px; ++x) {
            const double px = g.x_m((x + 0.5) * step), py = g.y_m((y + 0.5) * step);
            const double z = g.elevation_m(px, py);
            const double dzdx =
                (g.elevation_m(px + reach, py) - g.elevation_m(px - reach, py)) / (2 * reach);
            const double dzdy =
                (g.elevation_m(px, py + reach) - g.elevation_m(px, py - reach)) / (2 * reach);
            const glm::dvec3 normal = glm::normalize(glm::dvec3(-2.0 * dzdx, -2.0 * dzdy, 1.0));
            const double shade =
                0.35 +
                0.75 * std::max(0.0, glm::dot(normal, glm::normalize(glm::dvec3(-1, 1, 1.2))));
            glm::dvec3 colour = tint((z - low) / std::max(high - low, 1.0)) * shade;
            if (const auto level = scene.water_level_m(px, py)) {
                const LakeRecord& lake = scene.lake_at_level(*level);
                const double depth =
                    lake.max_depth_m ? (*level - z) / std::max(*lake.max_depth_m, 1.0) : 0.4;
                colour = glm::mix(glm::dvec3(0.55, 0.78, 0.88), glm::dvec3(0.05, 0.22, 0.45),
                                  std::sqrt(std::clamp(depth, 0.0, 1.0)));
            }
            for (int k = 0; k < 3; ++k)
                out.bytes[(std::size_t(y) * std::size_t(out.width_px) + std::size_t(x)) * 3 +
                          std::size_t(k)] =
                    static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(colour[k], 0.0, 1.0)));
        }

    // A bar of a round length, about a quarter of the width.
    const double length = round_length(0.25 * out.width_px * reach);
    const int bar = int(length / reach), size = std::max(11, out.width_px / 45), margin = size;
    const int base = out.height_px - margin;
    image::fill_box(out, margin - 1, base - 5, margin + bar + 1, base + 1, 20);
    image::fill_box(out, margin, base - 4, margin + bar, base, 245);
    image::draw_text(out, margin, base - size / 2 - 4, size, length_words(length));
    return out;
}

Picture draw_preview(const scene::Scene& scene, int side_px) {
    Picture out = draw_map(scene, side_px);
    const int size = std::max(11, out.width_px / 45), margin = size;
    const LakeRecord& lake = scene.lakes.front();
    const std::string title = (lake.name.empty() ? "" : lake.name + ", ") + "level " +
                              fixed(lake.level_m, 2) + " m, " + fixed(lake.area_m2 / 1e6, 2) +
                              " km2" +
                              (lake.bed == Bed::unknown     ? ", bed unknown"
                               : lake.bed == Bed::estimated ? ", bed ESTIMATED"
                                                            : "");
    image::draw_text(out, margin, margin + size, size, title);
    return out;
}

} // namespace tarn::app
