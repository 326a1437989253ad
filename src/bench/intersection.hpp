#pragma once
/// @file intersection.hpp  Methods x settings x fields x views: how long, and how far from right.
#include "bench/timing.hpp"
#include "core/progress.hpp"
#include "scene/settings.hpp"

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace tarn::bench {

/// A viewpoint of the comparison.
struct NamedView {
    std::string name;
    scene::Camera camera;
};

/// The four views of the synthetic mountain lake: high, grazing, shore, below.
std::vector<NamedView> mountain_views();

struct PictureSize {
    int width_px = 0, height_px = 0;
};

struct IntersectionOptions {
    std::vector<std::string> methods; ///< empty: all of scene::walk_methods()
    bool all_settings = true; ///< of methods with a number of steps: a series, else the default
    std::vector<PictureSize> sizes;   ///< at least one
    int runs = 21;                    ///< timed, after warming up
    int judged_rays = 40'000;         ///< of each picture against the double-precision grid walk
    std::optional<bool> rays_in_step; ///< experiments: as the device is by default
    int cone_shift = -1;              ///< experiments: >= 0 sets the cone map's blocks
};

/// One method with one setting, in one view.
struct IntersectionResult {
    std::string scene, view, method, source;
    double setting = 0.0; ///< 0: has none
    bool exact = false;
    int nodes = 0; ///< columns of the field
    int width_px = 0, height_px = 0;
    Times time;
    double set_up_ms = 0.0;   ///< making the bounds, shaders included; 0 if already there
    double field_mb = 0.0;    ///< heights and bounds
    int judged = 0, hits = 0; ///< rays, and those that meet something
    double missed_rate = 0.0; ///< of hits: passes what it should have met, and meets nothing
    double wrong_rate = 0.0;  ///< of hits: farther off than half a pixel's footprint
    double mean_error = 0.0, p95_error = 0.0, p99_error = 0.0; ///< |distance error| / distance
};

/// Renders distances of one scene with each method and judges them. Needs a current context.
std::vector<IntersectionResult> compare_methods(const scene::Scene& scene, const std::string& name,
                                                const std::vector<NamedView>& views,
                                                const IntersectionOptions& options,
                                                const Progress& progress);

/// {"device", "commit", "results": [...]}
void write_json(std::ostream& out, const std::string& device, const std::string& commit,
                const std::vector<IntersectionResult>& results);

} // namespace tarn::bench
