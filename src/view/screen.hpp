#pragma once
/// @file screen.hpp  Keeps the best picture there is time for on the screen: coarse while things
/// move, at rest sharper sample by sample, row by row where drawing is slow.
#include "render/display.hpp"
#include "render/renderer.hpp"
#include "view/pacing.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tarn::view {

class Screen {
public:
    /// The context must stay current.
    explicit Screen(render::Renderer& renderer);

    /// The view has changed: what is there is of the past.
    void changed() { stale_ = true; }

    /// Does some work, about as long as pacing allows. Call once a frame of the window.
    /// @param view      settings' size and samples are the window's and the finished picture's
    /// @param moving    more changes are to be expected: draw coarsely
    /// @param exposure  fixed factor, or nothing for what suits the picture
    /// @return          whether the screen shows something new
    bool update(scene::View view, const scene::Scene& scene, int width_px, int height_px,
                bool moving, std::optional<double> exposure, double seconds);

    /// Nothing is left to be done for the view of the last update().
    bool finished() const { return !stale_ && sample_ >= samples_ && settled_; }

    GLuint texture() const { return display_.texture().id(); }
    double scale() const { return shown_scale_; }
    int samples_done() const { return shown_samples_; }
    double exposure() const { return exposure_; }
    /// Distance met at a place of the window, both in [0, 1]; 1e9 nothing, NaN where it is not
    /// known yet.
    float distance_at(double x, double y) const;

    /// Time of each pass of one whole sample, finish to finish [ms], in order. Draws it.
    std::vector<std::pair<std::string, double>> time_passes(const scene::View& view);

private:
    void meter(const scene::Scene& scene, const scene::View& view, double share,
               std::optional<double> fixed, double seconds);
    void display(double share);

    render::Renderer& renderer_;
    render::Display display_;
    Pacing pacing_;
    bool software_, stale_ = true, settled_ = false, first_ = true;
    int width_px_ = 0, height_px_ = 0;
    int sample_ = 0, samples_ = 0, next_row_ = 0, shown_samples_ = 0;
    double shown_scale_ = 0.0, exposure_ = 1.0, wanted_exposure_ = 1.0;
    double row_ms_ = 0.0; ///< of a row at full resolution
    bool fine_ = false;   ///< the renderer is prepared for the finished picture
};

} // namespace tarn::view
