#include "render/stroke_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <numeric>

namespace tarn::render {

namespace {

constexpr int leaf_strokes = 4;

glm::uvec4 packed(const glm::vec3& v, std::uint32_t w) {
    return {std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y),
            std::bit_cast<std::uint32_t>(v.z), w};
}

struct Builder {
    const Heightfield& ground;
    const std::vector<scene::SpaceStroke>& strokes;
    std::vector<std::uint32_t> order;
    std::vector<glm::uvec4> nodes;

    /// Metres east and north of the first node, above the ground's offset.
    glm::dvec3 local(const glm::dvec3& p) const {
        return {p.x - ground.west_m, p.y - ground.north_m, p.z - ground.offset_m};
    }

    void build(std::size_t first, std::size_t count) {
        glm::dvec3 low(1e30), high(-1e30), middles_low(1e30), middles_high(-1e30);
        for (std::size_t i = first; i < first + count; ++i) {
            const scene::SpaceStroke& s = strokes[order[i]];
            const glm::dvec3 a = local(s.from), b = local(s.to);
            low = glm::min(low, glm::min(a, b));
            high = glm::max(high, glm::max(a, b));
            middles_low = glm::min(middles_low, a + b);
            middles_high = glm::max(middles_high, a + b);
        }
        // Wider by what float32 rounds off of places that far from the first node.
        const glm::dvec3 far = glm::max(glm::abs(low), glm::abs(high));
        const glm::dvec3 pad = 4e-7 * far + 1e-3;
        const std::size_t here = nodes.size();
        nodes.push_back(packed(low - pad, 0));
        nodes.push_back(packed(high + pad, 0));
        if (count <= leaf_strokes) {
            nodes[here + 1].w = std::uint32_t(count) << 24 | std::uint32_t(first);
        } else {
            const glm::dvec3 extent = middles_high - middles_low;
            const int axis = extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2)
                                                  : (extent.y >= extent.z ? 1 : 2);
            const std::size_t half = count / 2;
            std::nth_element(order.begin() + std::ptrdiff_t(first),
                             order.begin() + std::ptrdiff_t(first + half),
                             order.begin() + std::ptrdiff_t(first + count),
                             [&](std::uint32_t a, std::uint32_t b) {
                                 return strokes[a].from[axis] + strokes[a].to[axis] <
                                        strokes[b].from[axis] + strokes[b].to[axis];
                             });
            build(first, half);
            build(first + half, count - half);
        }
        nodes[here].w = std::uint32_t(nodes.size() / 2);
    }
};

} // namespace

std::vector<glm::uvec4> pack_strokes(const Heightfield& ground,
                                     const std::vector<scene::SpaceStroke>& strokes) {
    Builder builder{ground, strokes, {}, {}};
    builder.order.resize(strokes.size());
    std::iota(builder.order.begin(), builder.order.end(), 0u);
    builder.build(0, strokes.size());
    std::vector<glm::uvec4> out;
    out.reserve(1 + builder.nodes.size() + 2 * strokes.size());
    float widest_px = 0.0f;
    for (const scene::SpaceStroke& s : strokes)
        widest_px = std::max(widest_px, s.width_px);
    out.push_back(
        {std::uint32_t(builder.nodes.size() / 2), std::bit_cast<std::uint32_t>(widest_px), 0, 0});
    out.insert(out.end(), builder.nodes.begin(), builder.nodes.end());
    const GridSize size = ground.size();
    for (const std::uint32_t i : builder.order) {
        const scene::SpaceStroke& s = strokes[i];
        const int col = std::clamp(int(std::floor(ground.col(s.from.x))), 0, size.cols - 1),
                  row = std::clamp(int(std::floor(ground.row(s.from.y))), 0, size.rows - 1);
        const glm::dvec3 from_node(s.from.x - ground.x_m(col), s.from.y - ground.y_m(row),
                                   s.from.z - ground.offset_m);
        out.push_back(packed(from_node, std::uint32_t(col) | std::uint32_t(row) << 16));
        out.push_back(packed(s.to - s.from, std::bit_cast<std::uint32_t>(s.width_px)));
    }
    return out;
}

} // namespace tarn::render
