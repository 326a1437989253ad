#pragma once
/// @file pacing.hpp  How finely to draw while things move, so that input stays quick.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace tarn::view {

/// Picks the share of the window's resolution from how long pictures took.
class Pacing {
public:
    /// @param target_ms  a picture may take this long
    /// @param start      share to begin with
    Pacing(double target_ms, double start) : target_ms_(target_ms) {
        while (step_ + 1 < steps.size() && steps[step_] > start)
            ++step_;
    }

    double scale() const { return steps[step_]; }
    double target_ms() const { return target_ms_; }

    /// A picture of scale() took this long.
    void took(double ms) {
        if (ms > 1.15 * target_ms_) {
            // As far down as needed at once: a part of the time does not depend on pixels.
            const double share = std::sqrt(target_ms_ / ms);
            const double wanted = std::min(steps[step_] * std::max(share, 0.3), steps[step_]);
            while (step_ + 1 < steps.size() && steps[step_] > wanted)
                ++step_;
            patience_ = 0;
        } else if (step_ > 0) {
            const double ratio = steps[step_ - 1] / steps[step_];
            if (ms * ratio * ratio < 0.85 * target_ms_ && ++patience_ >= 4) {
                --step_;
                patience_ = 0;
            }
        }
    }

private:
    static constexpr std::array<double, 7> steps{1.0, 0.75, 0.5, 0.375, 0.25, 0.1875, 0.125};
    double target_ms_;
    std::size_t step_ = 0;
    int patience_ = 0; ///< pictures that would have had time for more
};

} // namespace tarn::view
