#pragma once
/// @file matrix.hpp  Ways of drawing x views x scenes: how long, how much memory, how far from
/// right.
#include "bench/effects.hpp"
#include "bench/timing.hpp"
#include "core/image.hpp"
#include "core/progress.hpp"
#include "image/compare.hpp"
#include "render/planner.hpp"

#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace tarn::bench {

struct MatrixOptions {
    int width_px = 320, height_px = 240;
    int samples = 4;                  ///< a pixel, of the pictures that are judged
    int runs = 5;                     ///< timed; the median counts
    std::vector<std::string> effects; ///< empty: all
    /// What the planner keeps to in a row of its own; nothing asked: no such row.
    render::Budget budget;
    /// What the picture at its best should be; nothing: not judged. Slow ones may be kept.
    std::function<std::optional<Image>(const scene::Scene&, const scene::View&)> reference;
    /// Share of pixels where a person would see a difference; empty: not asked.
    std::function<double(const Image& got, const Image& expected)> perceptual;
};

/// One way of drawing one view.
struct MatrixResult {
    std::string scene, view, state; ///< state: "calm" or the wind
    std::string effect, variant;
    int nodes = 0; ///< columns of the field
    int width_px = 0, height_px = 0;
    Times time;                  ///< of one picture with one sample, moving water included
    std::vector<PartTime> parts; ///< passes
    double set_up_ms = 0.0;      ///< the first prepare(), programs included
    double field_mb = 0.0;
    /// Against the picture at its best, which shares sample positions and draws: pixel by pixel.
    image::Difference error;
    std::size_t hits_off = 0;         ///< pixels whose first hit differs, edges left out
    std::optional<double> perceptual; ///< share of pixels
    /// Against the double-precision reference. Where water moves, both draw at random which of the
    /// waves too small for a pixel it shows: there in the mean over blocks of 8 x 8 pixels.
    std::optional<image::Difference> from_reference;
    std::optional<double> flux_error; ///< of caustics: greatest of |mean - 1| over depths
};

/// What is measured of one scene in one state of its water.
struct MatrixScene {
    std::string name, state;
    std::vector<scene::NamedCamera> views;
    scene::View view; ///< light, waves; its camera and settings are not looked at
};

/// Needs a current context.
std::vector<MatrixResult> run_matrix(const scene::Scene& scene, const MatrixScene& what,
                                     const MatrixOptions& options, const Progress& progress);

/// {"device", "commit", "results": [...], "seed_table": ...}
/// @param seed_table  of seed_table.hpp, as JSON; empty: none
void write_json(std::ostream& out, const std::string& device, const std::string& commit,
                const std::vector<MatrixResult>& results, const std::string& seed_table);

/// A JSON string: names of folders and cameras may hold anything.
std::string quoted(const std::string& words);

/// Means over blocks of side x side pixels; a rest at the rims is left out.
Image in_blocks(const Image& image, int side);

} // namespace tarn::bench
