#pragma once
/// @file flat.hpp  Water surfaces in an elevation model: connected nodes of one and the same
///                 height, found row by row, so that a raster of any size can be searched.
///
/// Most DEMs hold a lake as a flat surface. Equal heights alone do not make one: whole-metre models
/// have runs of equal height along every gentle slope, and plains of them. Water has an interior
/// (nodes whose eight neighbours are equal too), and where equal heights come about by chance it
/// must also lie lower than the land around it.
#include "core/grid.hpp"

#include <span>
#include <vector>

namespace tarn::dem {

/// Columns first..last of one row.
struct Run {
    int row = 0, first = 0, last = 0;
};

struct FlatSurface {
    float level_m = 0.0f;
    std::size_t nodes = 0, interior = 0;
    std::size_t lower = 0, higher = 0; ///< neighbours around it that lie lower and higher
    bool touches_edge = false;         ///< of the grid, or of the data
    Node middle;                       ///< a node well inside
    std::vector<Run> runs;             ///< all its nodes, row by row

    /// Part of the land around it that is lower, [0, 1].
    double lower_share() const {
        return lower + higher == 0 ? 0.0 : double(lower) / double(lower + higher);
    }
};

/// Takes the rows of a grid one after another and keeps what may be water; memory grows with the
/// surfaces found, not with the grid.
class FlatFinder {
public:
    explicit FlatFinder(int cols);
    /// @param heights  `cols` of them, NaN where there is no data; rows from north to south
    void add_row(std::span<const float> heights);
    /// Surfaces that pass for water, largest first. Call once, after the last row.
    std::vector<FlatSurface> finish();
    /// Whether heights come in steps, so that neighbours are equal by chance. After finish().
    bool stepped() const { return stepped_; }

private:
    struct Open : FlatSurface {
        int last_row = -1;
    };
    struct Piece {
        int first, last, surface; ///< columns of a run, and which surface it belongs to
    };
    void close_row();
    void offer(Open&& surface);
    int root(int surface);

    int cols_, row_ = -1;
    std::vector<float> above_, here_, below_; ///< rows row_ - 1, row_, row_ + 1
    std::vector<unsigned char> candidate_;
    std::vector<Open> open_;
    std::vector<int> parent_;
    std::vector<Piece> pieces_above_, pieces_;
    std::vector<FlatSurface> kept_;
    std::size_t pairs_ = 0, chance_pairs_ = 0; ///< neighbours compared; equal ones outside water
    bool any_ = false, stepped_ = false;
};

/// The surfaces of a whole grid.
std::vector<FlatSurface> find_flats(const Grid<float>& elevation_m, bool* stepped = nullptr);

} // namespace tarn::dem
