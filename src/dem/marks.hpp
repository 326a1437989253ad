#pragma once
/// @file marks.hpp  What is known of each node besides its height: one byte, one bit a fact.
#include "core/grid.hpp"

#include <cstdint>
#include <utility>
#include <vector>

namespace tarn::dem {

namespace mark {
inline constexpr unsigned char outside = 1; ///< no data, open to the grid's edge: never wet
inline constexpr unsigned char filled = 2;  ///< no data, but enclosed: interpolated
inline constexpr unsigned char flat = 4;    ///< in a flat surface: the water's, not the ground's
inline constexpr unsigned char even = 16;   ///< scratch of the search for ramps
inline constexpr unsigned char seen = 8;    ///< scratch for searches, cleared after use
} // namespace mark

using Marks = Grid<unsigned char>;

/// Which lake a node belongs to: LakeRecord::id, 0 where it is dry.
using LakeOf = Grid<std::uint16_t>;

inline void clear(Marks& marks, unsigned char bit) {
    for (unsigned char& m : marks.values)
        m = static_cast<unsigned char>(m & ~bit);
}

/// Breadth-first search whose memory is its front, not its area. `enter(node)` says whether a node
/// belongs and marks it so that it is not entered twice; `leave(node)` hears of neighbours off the
/// grid.
template <int neighbours, class Enter, class Leave>
void search(GridSize size, std::vector<Node> front, Enter enter, Leave leave) {
    static_assert(neighbours == 4 || neighbours == 8);
    std::vector<Node> next;
    while (!front.empty()) {
        next.clear();
        for (const Node at : front)
            for (int dr = -1; dr <= 1; ++dr)
                for (int dc = -1; dc <= 1; ++dc) {
                    if ((dr == 0 && dc == 0) || (neighbours == 4 && dr != 0 && dc != 0))
                        continue;
                    const Node n{at.col + dc, at.row + dr};
                    if (n.col < 0 || n.row < 0 || n.col >= size.cols || n.row >= size.rows)
                        leave(at);
                    else if (enter(n))
                        next.push_back(n);
                }
        std::swap(front, next);
    }
}

template <class Visit>
void each_neighbour(GridSize size, Node at, Visit visit) {
    for (int dr = -1; dr <= 1; ++dr)
        for (int dc = -1; dc <= 1; ++dc) {
            const Node n{at.col + dc, at.row + dr};
            if ((dr != 0 || dc != 0) && n.col >= 0 && n.row >= 0 && n.col < size.cols &&
                n.row < size.rows)
                visit(n);
        }
}

/// Calls visit(node) for every wet node that has a neighbour (of 8) which is not of its lake.
template <class Visit>
void each_shore_node(const LakeOf& lake_of, Visit visit) {
    const int cols = lake_of.size.cols, rows = lake_of.size.rows;
    for (int row = 0; row < rows; ++row) {
        const std::uint16_t* here = &lake_of.values[lake_of.index({0, row})];
        const std::uint16_t* above = row > 0 ? here - cols : here;
        const std::uint16_t* below = row + 1 < rows ? here + cols : here;
        for (int col = 0; col < cols; ++col) {
            const unsigned id = here[col];
            if (id == 0)
                continue;
            const int l = col > 0 ? col - 1 : col, r = col + 1 < cols ? col + 1 : col;
            const unsigned differ = (above[l] ^ id) | (above[col] ^ id) | (above[r] ^ id) |
                                    (here[l] ^ id) | (here[r] ^ id) | (below[l] ^ id) |
                                    (below[col] ^ id) | (below[r] ^ id);
            if (differ != 0)
                visit(Node{col, row});
        }
    }
}

} // namespace tarn::dem
