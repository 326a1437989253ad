#include "dem/flat.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tarn::dem {

namespace {

constexpr std::size_t least_nodes = 64, least_interior = 9;

bool interior(const Grid<float>& z, int col, int row) {
    if (col < 1 || row < 1 || col + 1 >= z.size.cols || row + 1 >= z.size.rows)
        return false;
    const float here = z[{col, row}];
    for (int dr = -1; dr <= 1; ++dr)
        for (int dc = -1; dc <= 1; ++dc)
            if (z[{col + dc, row + dr}] != here)
                return false;
    return true;
}

/// Calls visit(members) for each 4-connected run of equal height that passes for water.
template <class Visit>
void each_flat(const Grid<float>& z, Visit visit) {
    Grid<unsigned char> seen(z.size);
    std::vector<Node> members;
    for (int row = 1; row + 1 < z.size.rows; ++row)
        for (int col = 1; col + 1 < z.size.cols; ++col) {
            if (seen[{col, row}] || !interior(z, col, row)) // every flat has an interior node
                continue;
            const float level = z[{col, row}];
            members.assign(1, Node{col, row});
            seen[{col, row}] = 1;
            std::size_t interiors = 0;
            for (std::size_t i = 0; i < members.size(); ++i) {
                const Node at = members[i];
                interiors += interior(z, at.col, at.row);
                const Node next[4] = {{at.col - 1, at.row},
                                      {at.col + 1, at.row},
                                      {at.col, at.row - 1},
                                      {at.col, at.row + 1}};
                for (const Node n : next)
                    if (z.contains(n) && !seen[n] && z[n] == level) {
                        seen[n] = 1;
                        members.push_back(n);
                    }
            }
            if (members.size() >= least_nodes && interiors >= least_interior)
                visit(members, level);
        }
}

} // namespace

std::vector<FlatSurface> find_flats(const Grid<float>& z) {
    std::vector<FlatSurface> out;
    Grid<int> distance(z.size, -1);
    each_flat(z, [&](const std::vector<Node>& members, float level) {
        FlatSurface flat{.level_m = level, .nodes = members.size(), .deepest = members[0]};
        // Breadth first from the rim inwards: the last node reached is the deepest.
        std::vector<Node> queue;
        for (const Node n : members) {
            bool rim = false;
            for (int dr = -1; dr <= 1; ++dr)
                for (int dc = -1; dc <= 1; ++dc) {
                    const Node m{n.col + dc, n.row + dr};
                    if (!z.contains(m) || std::isnan(z[m]))
                        flat.touches_edge = rim = true;
                    else if (z[m] != level)
                        rim = true;
                }
            if (rim) {
                distance[n] = 0;
                queue.push_back(n);
            }
        }
        for (std::size_t i = 0; i < queue.size(); ++i) {
            const Node at = queue[i];
            const Node next[4] = {{at.col - 1, at.row},
                                  {at.col + 1, at.row},
                                  {at.col, at.row - 1},
                                  {at.col, at.row + 1}};
            for (const Node n : next)
                if (z.contains(n) && distance[n] < 0 && z[n] == level) {
                    distance[n] = distance[at] + 1;
                    queue.push_back(n);
                }
        }
        if (!queue.empty())
            flat.deepest = queue.back();
        out.push_back(flat);
    });
    std::sort(out.begin(), out.end(),
              [](const FlatSurface& a, const FlatSurface& b) { return a.nodes > b.nodes; });
    return out;
}

Grid<unsigned char> flat_mask(const Grid<float>& z) {
    Grid<unsigned char> out(z.size);
    each_flat(z, [&](const std::vector<Node>& members, float) {
        for (const Node n : members)
            out[n] = 1;
    });
    return out;
}

void keep_only_flats(Grid<float>& z) {
    const Grid<unsigned char> mask = flat_mask(z);
    for (std::size_t i = 0; i < z.values.size(); ++i)
        if (!mask.values[i])
            z.values[i] = std::numeric_limits<float>::quiet_NaN();
}

} // namespace tarn::dem
