#include "dem/fill.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace tarn::dem {

namespace {

struct Step {
    float elevation_m;
    Node at;
    float pass_m = 0.0f; ///< the highest ground on its way, and where that is
    Node pass = {};
    bool operator<(const Step& other) const { return elevation_m > other.elevation_m; }
};

} // namespace

Filled fill_from(const Grid<float>& z, const Marks& marks, float highest_wet_m,
                 std::span<const Node> seeds, int id, LakeOf& lake_of, double floor_m) {
    Filled out;
    std::vector<Node> front;
    for (const Node seed : seeds) {
        if (!z.contains(seed) || (marks[seed] & mark::outside))
            throw Error("the seed lies outside the elevation data", "move it with --at LAT,LON");
        if (!(z[seed] <= highest_wet_m))
            throw Error(text("the seed lies at ", fixed(z[seed], 2), " m, above the level of ",
                             fixed(double(highest_wet_m), 2), " m"),
                        "move it into the lake with --at LAT,LON, or raise --level");
        if (lake_of[seed] == 0) {
            lake_of[seed] = static_cast<std::uint16_t>(id);
            front.push_back(seed);
            ++out.nodes;
            out.at_level += z[seed] == highest_wet_m;
            out.flat_at_level += z[seed] == highest_wet_m && (marks[seed] & mark::flat);
        }
    }
    search<8>(
        z.size, std::move(front),
        [&](Node n) {
            if (marks[n] & mark::outside) {
                out.open_at_edge = true;
                return false;
            }
            if (lake_of[n] != 0 || !(z[n] <= highest_wet_m) || double(z[n]) < floor_m)
                return false;
            lake_of[n] = static_cast<std::uint16_t>(id);
            ++out.nodes;
            out.at_level += z[n] == highest_wet_m;
            out.flat_at_level += z[n] == highest_wet_m && (marks[n] & mark::flat);
            return true;
        },
        [&](Node) { out.open_at_edge = true; });
    return out;
}

std::optional<Filled> fill_closed(const Grid<float>& z, const Marks& marks, float highest_wet_m,
                                  Node seed, int id, LakeOf& lake_of) {
    Filled out;
    std::priority_queue<Step> downhill; // nodes below the surface, the lowest first
    std::vector<Node> surface, next;    // nodes at it, in any order
    bool open = false;
    const auto enter = [&](Node n) {
        lake_of[n] = static_cast<std::uint16_t>(id);
        ++out.nodes;
        if (z[n] == highest_wet_m) {
            ++out.at_level;
            next.push_back(n);
        } else {
            downhill.push({z[n], n});
        }
    };
    const auto spread = [&](Node at) {
        for (int dr = -1; dr <= 1; ++dr)
            for (int dc = -1; dc <= 1; ++dc) {
                const Node n{at.col + dc, at.row + dr};
                if (!z.contains(n) || (marks[n] & mark::outside))
                    open = true;
                else if (lake_of[n] == id || !(z[n] <= highest_wet_m))
                    continue;
                else if (lake_of[n] != 0)
                    open = true; // into another lake
                else
                    enter(n);
            }
    };
    enter(seed);
    while (!open && (!downhill.empty() || !next.empty())) {
        if (!downhill.empty()) {
            const Node at = downhill.top().at;
            downhill.pop();
            spread(at);
            continue;
        }
        surface.swap(next);
        next.clear();
        for (std::size_t i = 0; i < surface.size() && !open; ++i)
            spread(surface[i]);
    }
    if (open) {
        drain(lake_of, std::span(&seed, 1));
        return {};
    }
    return out;
}

void drain(LakeOf& lake_of, std::span<const Node> seeds) {
    for (const Node seed : seeds) {
        const std::uint16_t id = lake_of[seed];
        if (id == 0)
            continue;
        lake_of[seed] = 0;
        search<8>(
            lake_of.size, {seed},
            [&](Node n) {
                if (lake_of[n] != id)
                    return false;
                lake_of[n] = 0;
                return true;
            },
            [](Node) {});
    }
}

std::vector<Basin> find_basins(const Grid<float>& z, Marks& marks, float highest_wet_m) {
    std::vector<Basin> out;
    for (int row = 0; row < z.size.rows; ++row)
        for (int col = 0; col < z.size.cols; ++col) {
            const Node start{col, row};
            if ((marks[start] & (mark::seen | mark::outside)) || !(z[start] <= highest_wet_m))
                continue;
            Basin basin;
            basin.seed = start;
            const auto take = [&](Node n) {
                marks[n] |= mark::seen;
                ++basin.nodes;
                basin.at_level += std::abs(z[n] - highest_wet_m) <= 0.5f;
                if (z[n] < z[basin.seed])
                    basin.seed = n;
            };
            take(start);
            search<8>(
                z.size, {start},
                [&](Node n) {
                    if (marks[n] & mark::outside)
                        basin.open_at_edge = true;
                    if ((marks[n] & (mark::seen | mark::outside)) || !(z[n] <= highest_wet_m))
                        return false;
                    take(n);
                    return true;
                },
                [&](Node) { basin.open_at_edge = true; });
            out.push_back(basin);
        }
    clear(marks, mark::seen);
    std::stable_sort(out.begin(), out.end(),
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

std::optional<Node> nearest_wet(const Grid<float>& z, const Marks& marks, float highest_wet_m,
                                Node from, int reach) {
    std::optional<Node> best;
    long best_squared = long(reach) * reach + 1;
    for (int dr = -reach; dr <= reach; ++dr)
        for (int dc = -reach; dc <= reach; ++dc) {
            const Node n{from.col + dc, from.row + dr};
            const long squared = long(dc) * dc + long(dr) * dr;
            if (squared < best_squared && z.contains(n) && !(marks[n] & mark::outside) &&
                z[n] <= highest_wet_m) {
                best_squared = squared;
                best = n;
            }
        }
    return best;
}

namespace {

/// @param touched  nodes marked as seen so far; all marks are taken off again at the end
std::optional<Spill> rise(const Grid<float>& z, Marks& marks, std::priority_queue<Step> rim,
                          Spill spill, std::vector<Node> touched, double up_to_m) {
    std::optional<Spill> out;
    while (!rim.empty()) {
        const Step step = rim.top();
        rim.pop();
        if (double(step.elevation_m) > up_to_m)
            break;
        const Node at = step.at;
        bool edge =
            at.col == 0 || at.row == 0 || at.col + 1 == z.size.cols || at.row + 1 == z.size.rows;
        each_neighbour(z.size, at, [&](Node n) { edge |= (marks[n] & mark::outside) != 0; });
        if (edge) {
            spill.exit = at;
            spill.pass = step.pass;
            spill.at_surface = !(step.pass_m > static_cast<float>(spill.level_m));
            if (!spill.at_surface)
                spill.level_m = double(step.pass_m);
            out = spill;
            break;
        }
        each_neighbour(z.size, at, [&](Node n) {
            if (!(marks[n] & mark::seen)) {
                marks[n] |= mark::seen;
                touched.push_back(n);
                if (z[n] > step.pass_m)
                    rim.push({z[n], n, z[n], n});
                else
                    rim.push({z[n], n, step.pass_m, step.pass});
            }
        });
    }
    for (const Node n : touched)
        marks[n] &= static_cast<unsigned char>(~mark::seen);
    return out;
}

} // namespace

std::optional<Spill> find_spill(const Grid<float>& z, Marks& marks, const LakeOf& lake_of, int id,
                                double level_m) {
    std::priority_queue<Step> rim;
    std::vector<Node> touched;
    Spill spill{.level_m = level_m, .pass = {}, .exit = {}, .at_surface = true};
    for (int row = 0; row < z.size.rows; ++row)
        for (int col = 0; col < z.size.cols; ++col) {
            const Node at{col, row};
            if (lake_of[at] != id)
                continue;
            marks[at] |= mark::seen;
            touched.push_back(at);
            bool edge = col == 0 || row == 0 || col + 1 == z.size.cols || row + 1 == z.size.rows;
            each_neighbour(z.size, at, [&](Node n) {
                edge |= (marks[n] & mark::outside) != 0;
                // Lower ground beside the lake that was kept dry lies behind a dam that the grid
                // does not show: no way leads there directly.
                if (lake_of[n] != id && !(marks[n] & (mark::seen | mark::outside)) &&
                    z[n] >= static_cast<float>(level_m)) {
                    marks[n] |= mark::seen;
                    touched.push_back(n);
                    rim.push({z[n], n, z[n], n});
                }
            });
            if (edge) { // the edge of the data cuts the lake as it stands
                for (const Node n : touched)
                    marks[n] &= static_cast<unsigned char>(~mark::seen);
                spill.pass = spill.exit = at;
                return spill;
            }
        }
    return rise(z, marks, std::move(rim), spill, std::move(touched),
                std::numeric_limits<double>::infinity());
}

std::optional<Spill> find_spill(const Grid<float>& z, Marks& marks, Node seed, double up_to_m) {
    std::priority_queue<Step> rim;
    marks[seed] |= mark::seen;
    rim.push({z[seed], seed, z[seed], seed});
    return rise(z, marks, std::move(rim),
                {.level_m = double(z[seed]), .pass = seed, .exit = seed, .at_surface = true},
                {seed}, up_to_m);
}

} // namespace tarn::dem
