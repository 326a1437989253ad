#include "dem/flat.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace tarn::dem {

namespace {

// The least that is taken for water: some twenty nodes of which a few have only equal neighbours.
// A lake of 15 ha in a 3" model just passes.
constexpr std::size_t least_nodes = 20, least_interior = 4;
// Where neighbours are equal by chance more often than this, equal heights prove nothing: heights
// are stored in steps. (Survey data in millimetres: below one in a thousand.)
constexpr double stepped_share = 0.02;
// Real lakes in whole-metre models: up to 26 % of their surroundings lie lower (outlets, dams,
// noise). Terraces on a slope: 53 % and more (all stepped models of the test data).
constexpr double most_lower_share = 0.35;

// Plateaus that noise made are threads and holes: 1 to 5 % of their nodes lie inside. Lakes of a
// hundred nodes have 31 % or more, of sixty some 12 %.
constexpr double least_interior_share = 0.1;

constexpr float no_height = std::numeric_limits<float>::quiet_NaN();

} // namespace

FlatFinder::FlatFinder(int cols)
    : cols_(cols), above_(std::size_t(cols), no_height), here_(std::size_t(cols), no_height),
      below_(std::size_t(cols), no_height), candidate_(std::size_t(cols)) {}

int FlatFinder::root(int surface) {
    while (parent_[std::size_t(surface)] != surface) {
        parent_[std::size_t(surface)] = parent_[std::size_t(parent_[std::size_t(surface)])];
        surface = parent_[std::size_t(surface)];
    }
    return surface;
}

void FlatFinder::add_row(std::span<const float> heights) {
    assert(int(heights.size()) == cols_);
    above_.swap(here_);
    here_.swap(below_);
    std::copy(heights.begin(), heights.end(), below_.begin());
    if (row_ >= 0)
        close_row();
    ++row_;
    any_ = true;
}

/// Works on `here_` (row row_), whose neighbours are all known now.
void FlatFinder::close_row() {
    const auto n = std::size_t(cols_);
    const float* a = above_.data();
    const float* h = here_.data();
    const float* b = below_.data();
    std::size_t equal = 0;
    for (std::size_t c = 0; c < n; ++c) {
        const std::size_t l = c > 0 ? c - 1 : c, r = c + 1 < n ? c + 1 : c;
        candidate_[c] = (h[c] == a[c]) | (h[c] == b[c]) | (h[c] == a[l]) | (h[c] == a[r]) |
                        (h[c] == b[l]) | (h[c] == b[r]);
    }
    for (std::size_t c = 0; c + 1 < n; ++c) {
        const unsigned char same = h[c] == h[c + 1];
        candidate_[c] |= same;
        candidate_[c + 1] |= same;
        equal += same;
    }
    pairs_ += n - 1;
    chance_pairs_ += equal; // those inside water are taken off again in offer()

    pieces_.clear();
    std::size_t next_above = 0;
    for (int c = 0; c < cols_;) {
        if (!candidate_[std::size_t(c)]) {
            ++c;
            continue;
        }
        const float level = h[c];
        int last = c;
        while (last + 1 < cols_ && h[last + 1] == level)
            ++last;
        // Joined with every equal run above that touches it, be it by a corner (8 neighbours, as
        // water spreads).
        int surface = -1;
        while (next_above < pieces_above_.size() && pieces_above_[next_above].last + 1 < c)
            ++next_above;
        for (std::size_t k = next_above;
             k < pieces_above_.size() && pieces_above_[k].first <= last + 1; ++k) {
            int other = root(pieces_above_[k].surface);
            if (open_[std::size_t(other)].level_m != level || other == surface)
                continue;
            if (surface < 0) {
                surface = other;
                continue;
            }
            if (open_[std::size_t(surface)].runs.size() < open_[std::size_t(other)].runs.size())
                std::swap(surface, other);
            Open& to = open_[std::size_t(surface)];
            Open& from = open_[std::size_t(other)];
            to.nodes += from.nodes;
            to.interior += from.interior;
            to.lower += from.lower;
            to.higher += from.higher;
            to.touches_edge |= from.touches_edge;
            to.runs.insert(to.runs.end(), from.runs.begin(), from.runs.end());
            from.runs = {};
            parent_[std::size_t(other)] = surface;
        }
        if (surface < 0) {
            surface = int(open_.size());
            open_.emplace_back().level_m = level;
            parent_.push_back(surface);
        }
        Open& s = open_[std::size_t(surface)];
        s.last_row = row_;
        s.nodes += std::size_t(last - c + 1);
        s.runs.push_back({row_, c, last});
        const auto meet = [&](float z) {
            s.touches_edge |= std::isnan(z);
            s.lower += z < level;
            s.higher += z > level;
        };
        meet(c > 0 ? h[c - 1] : no_height);
        meet(last + 1 < cols_ ? h[last + 1] : no_height);
        for (int k = c; k <= last; ++k) {
            meet(a[k]);
            meet(b[k]);
            s.interior += k > c && k < last && a[k - 1] == level && a[k] == level &&
                          a[k + 1] == level && b[k - 1] == level && b[k] == level &&
                          b[k + 1] == level;
        }
        pieces_.push_back({c, last, surface});
        c = last + 1;
    }

    // Surfaces that this row did not continue are complete; the others move up to the front.
    std::vector<Open> alive;
    std::vector<int> moved(open_.size(), -1);
    for (std::size_t i = 0; i < open_.size(); ++i) {
        if (parent_[i] != int(i))
            continue;
        if (open_[i].last_row == row_) {
            moved[i] = int(alive.size());
            alive.push_back(std::move(open_[i]));
        } else {
            offer(std::move(open_[i]));
        }
    }
    for (Piece& piece : pieces_)
        piece.surface = moved[std::size_t(root(piece.surface))];
    open_ = std::move(alive);
    parent_.resize(open_.size());
    for (std::size_t i = 0; i < parent_.size(); ++i)
        parent_[i] = int(i);
    pieces_above_.swap(pieces_);
}

void FlatFinder::offer(Open&& surface) {
    if (surface.nodes < least_nodes || surface.interior < least_interior)
        return;
    chance_pairs_ -= std::min(chance_pairs_, surface.nodes - surface.runs.size());
    std::sort(surface.runs.begin(), surface.runs.end(), [](const Run& a, const Run& b) {
        return a.row != b.row ? a.row < b.row : a.first < b.first;
    });
    // The middle of a long run near the middle row: inside, for lakes of any shape.
    const int centre = (surface.runs.front().row + surface.runs.back().row) / 2;
    const int height = surface.runs.back().row - surface.runs.front().row + 1;
    double best = -1.0;
    for (const Run& run : surface.runs) {
        const double off = 2.0 * std::abs(run.row - centre) / height;
        const double score = (run.last - run.first + 1) * (1.5 - off);
        if (score > best) {
            best = score;
            surface.middle = {(run.first + run.last) / 2, run.row};
        }
    }
    kept_.push_back(std::move(surface));
}

std::vector<FlatSurface> FlatFinder::finish() {
    if (any_) {
        add_row(
            std::vector<float>(std::size_t(cols_), no_height)); // the last row has no land below it
        for (std::size_t i = 0; i < open_.size(); ++i)
            offer(std::move(open_[i]));
    }
    open_.clear();
    pieces_above_.clear();
    stepped_ = pairs_ > 0 && double(chance_pairs_) > stepped_share * double(pairs_);
    std::erase_if(kept_, [&](const FlatSurface& s) {
        return stepped_ && (s.lower_share() > most_lower_share ||
                            double(s.interior) < least_interior_share * double(s.nodes));
    });
    std::stable_sort(kept_.begin(), kept_.end(),
                     [](const FlatSurface& a, const FlatSurface& b) { return a.nodes > b.nodes; });
    return std::move(kept_);
}

std::vector<FlatSurface> find_flats(const Grid<float>& z, bool* stepped) {
    FlatFinder finder(z.size.cols);
    for (int row = 0; row < z.size.rows; ++row)
        finder.add_row(std::span(z.values).subspan(z.index({0, row}), std::size_t(z.size.cols)));
    auto flats = finder.finish();
    if (stepped)
        *stepped = finder.stepped();
    return flats;
}

} // namespace tarn::dem
