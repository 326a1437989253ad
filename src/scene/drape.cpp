#include "scene/drape.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tarn::scene {

namespace {

constexpr double reach_texels = 6.0;

/// The part of a segment inside a rectangle (Liang & Barsky 1984), or nothing.
bool clip(glm::dvec2& a, glm::dvec2& b, glm::dvec2 low, glm::dvec2 high) {
    double from = 0.0, to = 1.0;
    const glm::dvec2 d = b - a;
    for (int k = 0; k < 2; ++k) {
        if (d[k] == 0.0) {
            if (a[k] < low[k] || a[k] > high[k])
                return false;
            continue;
        }
        double t0 = (low[k] - a[k]) / d[k], t1 = (high[k] - a[k]) / d[k];
        if (t0 > t1)
            std::swap(t0, t1);
        from = std::max(from, t0);
        to = std::min(to, t1);
    }
    if (from > to)
        return false;
    const glm::dvec2 start = a;
    a = start + d * from;
    b = start + d * to;
    return true;
}

} // namespace

std::optional<Drape> make_drape(const Heightfield& ground,
                                const std::vector<std::vector<glm::dvec2>>& lines,
                                const std::vector<glm::dvec2>& points, int most) {
    const double width = ground.east_m() - ground.west_m,
                 height = ground.north_m - ground.south_m();
    Drape out;
    out.texel_m = std::max(ground.spacing_m / 4.0, std::max(width, height) / (most - 1));
    out.cols = std::max(1, int(std::ceil(width / out.texel_m)));
    out.rows = std::max(1, int(std::ceil(height / out.texel_m)));
    out.west_m = ground.west_m;
    out.north_m = ground.north_m;
    out.reach_m = reach_texels * out.texel_m;
    out.nearness.assign(std::size_t(out.cols) * std::size_t(out.rows), 0);
    bool any = false;
    // In texels from the north-west corner.
    const auto place = [&](const glm::dvec2& p) {
        return glm::dvec2((p.x - out.west_m) / out.texel_m, (out.north_m - p.y) / out.texel_m);
    };
    const auto stroke = [&](glm::dvec2 a, glm::dvec2 b) {
        if (!clip(a, b, glm::dvec2(-reach_texels),
                  glm::dvec2(out.cols + reach_texels, out.rows + reach_texels)))
            return;
        // In pieces, so that the boxes around them stay small.
        const int pieces = std::max(1, int(std::ceil(glm::length(b - a) / 32.0)));
        for (int i = 0; i < pieces; ++i) {
            const glm::dvec2 p = a + (b - a) * (double(i) / pieces);
            const glm::dvec2 q = a + (b - a) * (double(i + 1) / pieces);
            const glm::dvec2 d = q - p;
            const double length2 = glm::dot(d, d);
            const int c0 = std::max(0, int(std::floor(std::min(p.x, q.x) - reach_texels)));
            const int c1 =
                std::min(out.cols - 1, int(std::ceil(std::max(p.x, q.x) + reach_texels)));
            const int r0 = std::max(0, int(std::floor(std::min(p.y, q.y) - reach_texels)));
            const int r1 =
                std::min(out.rows - 1, int(std::ceil(std::max(p.y, q.y) + reach_texels)));
            for (int r = r0; r <= r1; ++r)
                for (int c = c0; c <= c1; ++c) {
                    const glm::dvec2 t(c + 0.5, r + 0.5);
                    const double f =
                        length2 > 0.0 ? std::clamp(glm::dot(t - p, d) / length2, 0.0, 1.0) : 0.0;
                    const double near = 1.0 - glm::length(t - p - d * f) / reach_texels;
                    if (near <= 0.0)
                        continue;
                    any = true;
                    std::uint8_t& texel =
                        out.nearness[std::size_t(r) * std::size_t(out.cols) + std::size_t(c)];
                    texel = std::max(texel, static_cast<std::uint8_t>(std::lround(255.0 * near)));
                }
        }
    };
    for (const auto& line : lines)
        for (std::size_t i = 1; i < line.size(); ++i)
            stroke(place(line[i - 1]), place(line[i]));
    for (const glm::dvec2& point : points) {
        const glm::dvec2 p = place(point);
        constexpr int corners = 16;
        for (int i = 0; i < corners; ++i) {
            const double a = 6.283185307 * i / corners, b = 6.283185307 * (i + 1) / corners;
            stroke(p + 3.0 * glm::dvec2(std::cos(a), std::sin(a)),
                   p + 3.0 * glm::dvec2(std::cos(b), std::sin(b)));
        }
    }
    if (!any)
        return std::nullopt;
    return out;
}

} // namespace tarn::scene
