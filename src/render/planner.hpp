#pragma once
/// @file planner.hpp  No more than a scene needs: the quickest way of drawing a view within a
/// budget of error, or the truest within one of time.
///
/// Nothing here is a matter of taste: every way that could be left out is tried on a sample of this
/// very picture (each nth block of 8 x 8 pixels), against the same blocks with everything at its
/// best, and timed. Which ways are worth trying, and in which order, comes from the matrix of
/// `tarn bench` (docs/planner.md).
#include "core/progress.hpp"
#include "render/renderer.hpp"

#include <optional>
#include <string>
#include <vector>

namespace tarn::render {

struct Budget {
    std::optional<double> max_error;     ///< mean relative radiance error, [1e-4, 10]
    std::optional<double> frame_time_ms; ///< of one picture, all samples and waves, [.01, 1e7]
    bool asked() const { return max_error || frame_time_ms; }
    /// @throws tarn::Error  naming the field, its value and the legal range
    void validate() const;
};

/// One part of the picture and what was found about it.
struct Decision {
    std::string part;   ///< "caustics"
    std::string choice; ///< "off"
    std::string why;    ///< in words; by geometry where it needed no trial
    bool taken = false; ///< else it was tried, and left
    double error = 0.0; ///< predicted, at most (mean and two standard errors over blocks)
    double saved_ms = 0.0;
};

struct Plan {
    scene::View view;                ///< as it was asked for, with what was chosen
    std::vector<Decision> decisions; ///< by part
    bool kept = true;                ///< false: the budget cannot be kept; this comes nearest
    double predicted_error = 0.0;    ///< at most, against everything at its best
    double predicted_ms = 0.0, everything_ms = 0.0; ///< of one picture, all samples
    int blocks = 0, trials = 0;
    double planning_s = 0.0;
};

/// Chooses. Leaves the renderer prepared for nothing in particular.
/// @param view  what is asked for; parts that are off stay off
/// @throws tarn::Error  if the budget or the view is out of range
Plan make_plan(Renderer& renderer, const scene::Scene& scene, const scene::View& view,
               const Budget& budget, const Progress& progress);

/// Mean relative radiance error of blocks of 8 x 8 pixels side by side, as image/compare.hpp has
/// it, and its standard error by how they differ.
struct BlockError {
    double mean = 0.0, standard_error = 0.0;
    double at_most() const;
    int blocks = 0;
};
BlockError block_error(const Image& got, const Image& expected);

/// The steepest that the bilinear ground is anywhere: rise over run.
double steepest_slope(const Heightfield& ground);

} // namespace tarn::render
