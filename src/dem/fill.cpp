#include "dem/fill.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::dem {

namespace {

/// Collects the region of `from`, marking it in `mark`; returns whether it touches an edge.
bool flood(const Grid<float>& z, const Grid<unsigned char>& outside, double level_m, double floor_m,
           Node from, Grid<unsigned char>& mark, std::vector<Node>& members) {
    bool open = false;
    members.assign(1, from);
    mark[from] = 1;
    for (std::size_t i = 0; i < members.size(); ++i) {
        const Node at = members[i];
        for (int dr = -1; dr <= 1; ++dr)
            for (int dc = -1; dc <= 1; ++dc) {
                const Node n{at.col + dc, at.row + dr};
                if (!z.contains(n) || outside[n]) {
                    open = true;
                } else if (!mark[n] && at_or_below(z[n], level_m) && double(z[n]) >= floor_m) {
                    mark[n] = 1;
                    members.push_back(n);
                }
            }
    }
    return open;
}

} // namespace

Grid<unsigned char> fill_from(const Grid<float>& z, const Grid<unsigned char>& outside,
                              double level_m, Node seed, bool* open_at_edge, double floor_m) {
    if (!z.contains(seed) || outside[seed])
        throw Error("the seed lies outside the elevation data", "move it with --at LAT,LON");
    if (!at_or_below(z[seed], level_m))
        throw Error(text("the seed lies at ", fixed(z[seed], 2), " m, above the level of ",
                         fixed(level_m, 2), " m"),
                    "move it into the lake with --at LAT,LON, or raise --level");
    Grid<unsigned char> wet(z.size);
    std::vector<Node> members;
    const bool open = flood(z, outside, level_m, floor_m, seed, wet, members);
    if (open_at_edge)
        *open_at_edge = open;
    return wet;
}

std::vector<Basin> find_basins(const Grid<float>& z, const Grid<unsigned char>& outside,
                               double level_m) {
    std::vector<Basin> out;
    Grid<unsigned char> mark(z.size);
    std::vector<Node> members;
    for (int row = 0; row < z.size.rows; ++row)
        for (int col = 0; col < z.size.cols; ++col) {
            const Node start{col, row};
            if (mark[start] || outside[start] || !at_or_below(z[start], level_m))
                continue;
            Basin basin;
            basin.open_at_edge = flood(z, outside, level_m, -1e30, start, mark, members);
            basin.nodes = members.size();
            basin.seed = start;
            for (const Node n : members) {
                basin.at_level += std::abs(double(z[n]) - level_m) <= 0.5;
                if (z[n] < z[basin.seed])
                    basin.seed = n;
            }
            out.push_back(basin);
        }
    std::sort(out.begin(), out.end(),
              [](const Basin& a, const Basin& b) { return a.nodes > b.nodes; });
    return out;
}

std::optional<Basin> largest_lake(const std::vector<Basin>& basins) {
    for (const Basin& basin : basins) // largest first
        if (!basin.open_at_edge || 2 * basin.at_level > basin.nodes)
            return basin;
    if (!basins.empty())
        return basins.front();
    return {};
}

std::optional<Node> nearest_wet(const Grid<float>& z, const Grid<unsigned char>& outside,
                                double level_m, Node from, int reach) {
    std::optional<Node> best;
    long best_squared = long(reach) * reach + 1;
    for (int dr = -reach; dr <= reach; ++dr)
        for (int dc = -reach; dc <= reach; ++dc) {
            const Node n{from.col + dc, from.row + dr};
            const long squared = long(dc) * dc + long(dr) * dr;
            if (squared < best_squared && z.contains(n) && !outside[n] &&
                at_or_below(z[n], level_m)) {
                best_squared = squared;
                best = n;
            }
        }
    return best;
}

} // namespace tarn::dem
