#pragma once
/// @file grid.hpp  A rectangle of values and the words for its size and places.
///
/// Shape  row-major; row 0 is the NORTH edge, column 0 the WEST edge.
#include <cassert>
#include <cstddef>
#include <vector>

namespace tarn {

struct GridSize {
    int cols = 0, rows = 0;
    std::size_t count() const {
        return static_cast<std::size_t>(cols) * static_cast<std::size_t>(rows);
    }
    friend bool operator==(const GridSize&, const GridSize&) = default;
};

/// One named pair, so that column and row cannot be swapped.
struct Node {
    int col = 0, row = 0;
    friend bool operator==(const Node&, const Node&) = default;
};

template <class T>
struct Grid {
    GridSize size;
    std::vector<T> values; ///< size.count() of them

    Grid() = default;
    explicit Grid(GridSize s, T fill = T{}) : size(s), values(s.count(), fill) {}

    bool contains(Node n) const {
        return n.col >= 0 && n.row >= 0 && n.col < size.cols && n.row < size.rows;
    }
    std::size_t index(Node n) const {
        assert(contains(n));
        return static_cast<std::size_t>(n.row) * static_cast<std::size_t>(size.cols) +
               static_cast<std::size_t>(n.col);
    }
    T& operator[](Node n) { return values[index(n)]; }
    const T& operator[](Node n) const { return values[index(n)]; }
};

} // namespace tarn
