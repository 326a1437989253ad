#include "dem/lakes.hpp"

#include "core/text.hpp"
#include "dem/fill.hpp"
#include "dem/median.hpp"
#include "dem/parallel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>

namespace tarn::dem {

namespace {

// What lies this much below a surface that runs out is the valley below its dam, not its bed.
constexpr float dam_m = 1.0f;
constexpr float seam_m = 0.5f; // parts of one lake's surface differ by no more
constexpr int bay_reach = 6;   // nodes between a lake and a patch of its level that is its bay

std::vector<Run> runs_of(std::vector<Node> nodes) {
    std::sort(nodes.begin(), nodes.end(),
              [](Node a, Node b) { return a.row != b.row ? a.row < b.row : a.col < b.col; });
    std::vector<Run> out;
    for (const Node n : nodes)
        if (!out.empty() && out.back().row == n.row && out.back().last + 1 == n.col)
            ++out.back().last;
        else
            out.push_back({n.row, n.col, n.col});
    return out;
}

FlatSurface surface_of(const std::vector<Node>& nodes, float level_m) {
    FlatSurface out;
    out.level_m = level_m;
    out.nodes = nodes.size();
    out.runs = runs_of(nodes);
    const Run& run =
        *std::max_element(out.runs.begin(), out.runs.end(), [](const Run& a, const Run& b) {
            return a.last - a.first < b.last - b.first;
        });
    out.middle = {(run.first + run.last) / 2, run.row};
    return out;
}

template <class Visit>
void each_node(const FlatSurface& surface, Visit visit) {
    for (const Run& run : surface.runs)
        for (int col = run.first; col <= run.last; ++col)
            visit(Node{col, run.row});
}

/// Water without returns leaves voids; then their rim is the shore, all at one height. (Voids of
/// radar shadow lie in steep ground: hardly any two of their neighbours agree.)
void void_water(Grid<float>& z, Marks& marks, std::vector<FlatSurface>& surfaces,
                std::vector<std::string>& notes) {
    constexpr float even_m = 0.5f;
    constexpr std::size_t least = 40;
    std::size_t lakes = 0, nodes_all = 0;
    std::vector<FlatSurface> found;
    for (int row = 0; row < z.size.rows; ++row)
        for (int col = 0; col < z.size.cols; ++col) {
            const Node start{col, row};
            if (!(marks[start] & mark::filled) || (marks[start] & mark::seen))
                continue;
            std::vector<Node> nodes{start};
            std::vector<float> rim;
            bool at_edge = false;
            marks[start] |= mark::seen;
            search<4>(
                z.size, {start},
                [&](Node n) {
                    if (marks[n] & mark::outside)
                        at_edge = true;
                    else if (!(marks[n] & mark::filled))
                        rim.push_back(z[n]);
                    if (!(marks[n] & mark::filled) || (marks[n] & mark::seen))
                        return false;
                    marks[n] |= mark::seen;
                    nodes.push_back(n);
                    return true;
                },
                [&](Node) { at_edge = true; });
            if (nodes.size() < least || rim.empty() || at_edge)
                continue;
            std::sort(rim.begin(), rim.end());
            const float low = rim[rim.size() / 20];
            const auto even = std::count_if(rim.begin(), rim.end(),
                                            [&](float v) { return std::abs(v - low) <= even_m; });
            if (double(even) < 0.6 * double(rim.size()))
                continue;
            // The water stands at the lowest of its banks, but for a stray low one.
            found.push_back(surface_of(nodes, low - rim.front() > even_m ? low : rim.front()));
            ++lakes;
            nodes_all += nodes.size();
        }
    clear(marks, mark::seen);
    for (FlatSurface& surface : found) {
        each_node(surface, [&](Node n) {
            z[n] = surface.level_m;
            marks[n] |= mark::flat;
        });
        surfaces.push_back(std::move(surface));
    }
    if (lakes > 0)
        notes.push_back(text(lakes, " voids with an even rim (", nodes_all,
                             " nodes) taken for water at the height of that rim"));
}

/// Surfaces flattened tile by tile or along a river are not exactly flat: they step at seams and
/// slope by centimetres. Nodes whose neighbourhood is level within `even_m` are gathered.
void ramps(Grid<float>& z, Marks& marks, std::vector<FlatSurface>& surfaces,
           std::vector<std::string>& notes) {
    constexpr float even_m = 0.06f;
    constexpr std::size_t least = 64;
    constexpr unsigned char known = mark::flat | mark::filled | mark::outside;
    const auto is_even = [&](Node n) {
        if (marks[n] & known)
            return false;
        float low = z[n], high = z[n];
        bool inside = true;
        each_neighbour(z.size, n, [&](Node m) {
            inside &= !(marks[m] & known);
            low = std::min(low, z[m]);
            high = std::max(high, z[m]);
        });
        return inside && high - low <= even_m;
    };
    // All nodes are looked at first, in bands of rows on all cores; then the even ones are marked.
    constexpr int band = 64;
    std::vector<std::vector<Node>> found_even(std::size_t((z.size.rows + band - 1) / band));
    each_in_parallel(int(found_even.size()), [&](int k) {
        for (int row = std::max(k * band, 1); row < std::min((k + 1) * band, z.size.rows - 1);
             ++row)
            for (int col = 1; col + 1 < z.size.cols; ++col) {
                const float* here = &z.values[z.index({col, row})];
                if (std::abs(here[0] - here[1]) <= even_m && // most land ends here
                    std::abs(here[0] - here[-1]) <= even_m && is_even({col, row}))
                    found_even[std::size_t(k)].push_back({col, row});
            }
    });
    for (auto& nodes : found_even) {
        for (const Node n : nodes)
            marks[n] |= mark::even;
        nodes = {};
    }
    const auto even = [&](Node n) { return (marks[n] & mark::even) != 0; };
    // What makes it water rather than level ground (the flat bottom of a lake's own bed, say): it
    // goes on from a flat surface, or the land breaks up from it at the shore. Looked at three
    // nodes away from all of it: the nearer ones are its own shore.
    const auto near_piece = [&](Node m) {
        for (int dr = -2; dr <= 2; ++dr)
            for (int dc = -2; dc <= 2; ++dc) {
                const Node n{m.col + dc, m.row + dr};
                if (z.contains(n) && (marks[n] & mark::seen))
                    return true;
            }
        return false;
    };
    const auto around = [&](const std::vector<Node>& nodes, auto visit) {
        for (const Node n : nodes) {
            bool rim = false;
            each_neighbour(z.size, n, [&](Node m) { rim |= !(marks[m] & mark::seen); });
            for (int k = 0; rim && k < 49; ++k) {
                const Node m{n.col + k % 7 - 3, n.row + k / 7 - 3};
                if (std::max(std::abs(m.col - n.col), std::abs(m.row - n.row)) == 3 &&
                    z.contains(m) && !near_piece(m))
                    visit(m);
            }
        }
    };
    const auto beside_flat = [&](const std::vector<Node>& nodes) {
        bool found = false;
        const float level = z[nodes.front()];
        around(nodes, [&](Node m) {
            found |= (marks[m] & mark::flat) && std::abs(z[m] - level) <= 2.0f * seam_m;
        });
        return found;
    };
    const auto shore = [&](const std::vector<Node>& nodes, float level) {
        constexpr float break_m = 0.3f;
        std::vector<float> rise;
        around(nodes, [&](Node m) { rise.push_back(z[m] - level); });
        return !rise.empty() && median(std::move(rise)) >= break_m;
    };
    std::vector<FlatSurface> found;
    for (int row = 1; row + 1 < z.size.rows; ++row)
        for (int col = 1; col + 1 < z.size.cols; ++col) {
            const Node start{col, row};
            if ((marks[start] & mark::seen) || !even(start))
                continue;
            std::vector<Node> nodes{start};
            marks[start] |= mark::seen;
            search<8>(
                z.size, {start},
                [&](Node n) {
                    if ((marks[n] & mark::seen) || !even(n))
                        return false;
                    marks[n] |= mark::seen;
                    nodes.push_back(n);
                    return true;
                },
                [](Node) {});
            if (nodes.size() < least)
                continue;
            std::vector<float> heights;
            for (const Node n : nodes)
                heights.push_back(z[n]);
            const float level = median(std::move(heights));
            std::size_t lower = 0, higher = 0, off = 0, uneven = 0;
            for (const Node n : nodes) {
                off += std::abs(z[n] - level) > seam_m;
                uneven += std::abs(z[n] - level) > 2.0f * even_m;
                each_neighbour(z.size, n, [&](Node m) {
                    if (marks[m] & mark::seen)
                        return;
                    lower += z[m] < level - even_m;
                    higher += z[m] > level + even_m;
                });
            }
            // Its shore's own nodes belong to it too: they are even with the nodes inside.
            const std::size_t inner = nodes.size();
            for (std::size_t i = 0; i < inner; ++i)
                each_neighbour(z.size, nodes[i], [&](Node m) {
                    if (!(marks[m] & (mark::seen | mark::flat | mark::filled | mark::outside)) &&
                        std::abs(z[m] - level) <= even_m) {
                        marks[m] |= mark::seen;
                        nodes.push_back(m);
                    }
                });
            if (off == 0 && 4 * lower <= lower + higher &&
                (beside_flat(nodes) || (20 * uneven <= nodes.size() && shore(nodes, level))))
                found.push_back(surface_of(nodes, level));
        }
    clear(marks, mark::seen | mark::even);
    std::size_t nodes_all = 0;
    float most = 0.0f;
    for (FlatSurface& surface : found) {
        // A ramp beside a flat surface of nearly its height is that lake's (a seam, a slope).
        for (const FlatSurface& flat : surfaces)
            if (std::abs(flat.level_m - surface.level_m) <= seam_m) {
                bool beside = false;
                each_node(surface, [&](Node n) {
                    for (int dr = -2; dr <= 2; ++dr)
                        for (int dc = -2; dc <= 2; ++dc) {
                            const Node m{n.col + dc, n.row + dr};
                            beside |=
                                z.contains(m) && (marks[m] & mark::flat) && z[m] == flat.level_m;
                        }
                });
                if (beside) {
                    surface.level_m = flat.level_m;
                    break;
                }
            }
        each_node(surface, [&](Node n) {
            most = std::max(most, std::abs(z[n] - surface.level_m));
            z[n] = surface.level_m;
            ++nodes_all;
        });
    }
    for (FlatSurface& surface : found) { // marks only now: surfaces do not see each other
        each_node(surface, [&](Node n) { marks[n] |= mark::flat; });
        surfaces.push_back(std::move(surface));
    }
    if (!found.empty())
        notes.push_back(text(found.size(), " water surfaces that slope or step by centimetres (",
                             nodes_all, " nodes) were laid level, by at most ", fixed(most, 2),
                             " m"));
}

/// Lakes flattened tile by tile step at the seam between two exactly flat parts: the smaller part
/// takes the larger one's height.
void seams(Grid<float>& z, std::vector<FlatSurface>& surfaces, const Marks& marks,
           std::vector<std::string>& notes) {
    constexpr std::size_t least_contact = 8;
    std::size_t parts = 0, nodes_all = 0;
    float most = 0.0f;
    for (std::size_t i = surfaces.size(); i-- > 0;) { // the smallest first
        FlatSurface& surface = surfaces[i];
        std::map<float, std::size_t> contact;
        each_node(surface, [&](Node n) {
            for (const Node m : {Node{n.col - 1, n.row}, Node{n.col + 1, n.row},
                                 Node{n.col, n.row - 1}, Node{n.col, n.row + 1}})
                if (z.contains(m) && z[m] != surface.level_m && (marks[m] & mark::flat) &&
                    std::abs(z[m] - surface.level_m) <= seam_m)
                    ++contact[z[m]];
        });
        const auto best =
            std::max_element(contact.begin(), contact.end(),
                             [](const auto& a, const auto& b) { return a.second < b.second; });
        if (best == contact.end() || best->second < least_contact ||
            std::none_of(surfaces.begin(), surfaces.begin() + std::ptrdiff_t(i),
                         [&](const FlatSurface& s) { return s.level_m == best->first; }))
            continue;
        most = std::max(most, std::abs(best->first - surface.level_m));
        nodes_all += surface.nodes;
        ++parts;
        surface.level_m = best->first;
        each_node(surface, [&](Node n) { z[n] = surface.level_m; });
    }
    if (parts > 0)
        notes.push_back(text(parts,
                             parts == 1 ? " flat surface that steps" : " flat surfaces that step",
                             " at a seam against a larger one (", nodes_all,
                             " nodes) took its height, ", fixed(most, 2), " m away at most"));
}

/// Do heights come in steps (whole metres, feet, decimetres)? Then neighbours are equal by chance.
bool comes_in_steps(const Grid<float>& z, const Marks& marks) {
    std::size_t equal = 0, pairs = 0;
    for (int row = 0; row < z.size.rows; row += 7)
        for (int col = 0; col + 1 < z.size.cols; ++col)
            if (!(marks[{col, row}] & (mark::flat | mark::filled | mark::outside))) {
                ++pairs;
                equal += z[{col, row}] == z[{col + 1, row}];
            }
    return pairs == 0 || double(equal) > 0.02 * double(pairs);
}

bool near_lake(const LakeOf& lake_of, const FlatSurface& surface, int id) {
    for (const Run& run : surface.runs)
        for (int row = std::max(run.row - bay_reach, 0);
             row <= std::min(run.row + bay_reach, lake_of.size.rows - 1); ++row)
            for (int col = std::max(run.first - bay_reach, 0);
                 col <= std::min(run.last + bay_reach, lake_of.size.cols - 1); ++col)
                if (lake_of[{col, row}] == id)
                    return true;
    return false;
}

/// The surface alone, and what lies within a metre below it (noise of whole-metre models) where
/// lake and higher land shut it in. What is open to lower ground is the valley below a dam.
Filled fill_flat(const LakeSearch& s, float level, Node seed, int id) {
    const auto& z = s.elevation_m;
    Filled out = fill_from(z, s.marks, level, std::span(&seed, 1), id, s.lake_of, level);
    std::vector<Node> shore, touched;
    // Breadth first over the lake again, for the hollows at its shore.
    std::vector<Node> lake{seed};
    s.marks[seed] |= mark::seen;
    for (std::size_t i = 0; i < lake.size(); ++i)
        each_neighbour(z.size, lake[i], [&](Node n) {
            if (s.marks[n] & mark::seen)
                return;
            if (s.lake_of[n] == id) {
                s.marks[n] |= mark::seen;
                lake.push_back(n);
            } else if (z[n] < level && z[n] >= level - dam_m && s.lake_of[n] == 0) {
                shore.push_back(n);
            }
        });
    touched = lake;
    for (const Node start : shore) {
        if (s.marks[start] & mark::seen)
            continue;
        std::vector<Node> hollow{start};
        s.marks[start] |= mark::seen;
        bool shut = true;
        for (std::size_t i = 0; i < hollow.size(); ++i) {
            const Node at = hollow[i];
            shut &=
                at.col > 0 && at.row > 0 && at.col + 1 < z.size.cols && at.row + 1 < z.size.rows;
            each_neighbour(z.size, at, [&](Node n) {
                shut &= !(s.marks[n] & mark::outside) && (s.lake_of[n] == 0 || s.lake_of[n] == id);
                if (s.lake_of[n] != 0 || !(z[n] < level) || (s.marks[n] & mark::seen))
                    return;
                if (z[n] < level - dam_m) {
                    shut = false;
                } else {
                    s.marks[n] |= mark::seen;
                    hollow.push_back(n);
                }
            });
        }
        if (shut)
            for (const Node n : hollow) {
                s.lake_of[n] = static_cast<std::uint16_t>(id);
                ++out.nodes;
            }
        touched.insert(touched.end(), hollow.begin(), hollow.end());
    }
    for (const Node n : touched)
        s.marks[n] &= static_cast<unsigned char>(~mark::seen);
    return out;
}

} // namespace

std::vector<FlatSurface> complete_surfaces(Grid<float>& z, Marks& marks,
                                           std::vector<FlatSurface> surfaces, bool stepped,
                                           std::vector<std::string>& notes) {
    for (const FlatSurface& surface : surfaces)
        each_node(surface, [&](Node n) { marks[n] |= mark::flat; });
    void_water(z, marks, surfaces, notes);
    std::stable_sort(surfaces.begin(), surfaces.end(),
                     [](const FlatSurface& a, const FlatSurface& b) { return a.nodes > b.nodes; });
    if (!stepped && !comes_in_steps(z, marks)) { // in steps exact equality says all there is
        seams(z, surfaces, marks, notes);
        ramps(z, marks, surfaces, notes);
    }
    std::stable_sort(surfaces.begin(), surfaces.end(),
                     [](const FlatSurface& a, const FlatSurface& b) { return a.nodes > b.nodes; });
    return surfaces;
}

bool has_surface(const std::vector<FlatSurface>& surfaces, double level_m) {
    return std::any_of(surfaces.begin(), surfaces.end(), [&](const FlatSurface& s) {
        return s.level_m == static_cast<float>(level_m);
    });
}

FoundLake fill_surface(const LakeSearch& s, const FlatSurface& surface, int id) {
    FoundLake lake{.id = id, .level_m = surface.level_m, .seeds = {surface.middle}};
    const float level = surface.level_m;
    lake.sea = surface.touches_edge && std::abs(level) <= 2.0f;
    // Water that leaves the data without rising found a hole in a dam or an outlet, or the edge
    // cuts the lake.
    const auto closed =
        lake.sea ? std::nullopt
                 : fill_closed(s.elevation_m, s.marks, level, surface.middle, id, s.lake_of);
    const bool runs_out = !lake.sea && !closed;
    Filled filled;
    if (closed)
        filled = *closed;
    else if (lake.sea)
        filled = fill_from(s.elevation_m, s.marks, level, lake.seeds, id, s.lake_of);
    else
        filled = fill_flat(s, level, surface.middle, id);
    lake.nodes = filled.nodes;
    lake.open_at_edge = filled.open_at_edge;
    // Mostly surface: the lake ends where the flat ends. Else the surface is only the rim of a lake
    // whose bed the data hold and cut, or a terrace on a slope and no lake at all.
    // In steps no bed is so flat at its rim that a surface there means a lake: it is a terrace.
    if ((runs_out && 2 * surface.nodes < filled.at_level) ||
        (s.stepped && 2 * filled.at_level < filled.nodes)) {
        drain(s.lake_of, lake.seeds);
        lake.nodes = 0;
    }
    return lake;
}

void join_bays(const LakeSearch& s, const std::vector<FlatSurface>& surfaces, FoundLake& lake) {
    for (const FlatSurface& surface : surfaces) {
        if (surface.level_m != static_cast<float>(lake.level_m) || s.lake_of[surface.middle] != 0 ||
            !near_lake(s.lake_of, surface, lake.id))
            continue;
        const Filled bay = fill_flat(s, surface.level_m, surface.middle, lake.id);
        lake.nodes += bay.nodes;
        lake.open_at_edge |= bay.open_at_edge;
        lake.seeds.push_back(surface.middle);
    }
}

std::vector<FoundLake> find_lakes(const LakeSearch& s, const std::vector<FlatSurface>& surfaces,
                                  int first_id) {
    std::vector<FoundLake> out;
    int id = first_id;
    for (const FlatSurface& surface : surfaces) {
        if (out.size() >= s.most_lakes)
            break;
        if (s.lake_of[surface.middle] != 0)
            continue;
        FoundLake lake = fill_surface(s, surface, id);
        if (lake.nodes == 0)
            continue;
        join_bays(s, surfaces, lake);
        if (lake.nodes < s.least_nodes) {
            drain(s.lake_of, lake.seeds);
            continue;
        }
        out.push_back(std::move(lake));
        ++id;
    }
    return out;
}

} // namespace tarn::dem
