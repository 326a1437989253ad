#pragma once
/// @file waves.hpp  Double-precision twin of shaders/lib/waves.glsl and of the passes wave_*.comp.
///
/// Nothing is filtered here: many samples a pixel take the place of the GPU's covariances. Fields
/// come from FFTW on a lattice twice as fine, looked up by cubic splines through the texels
/// (Catmull & Rom); rain's ripples are left out; the point under a place is found by Newton's
/// method. Waves, amplitudes and fades are those of waves/sea.hpp.
#include "waves/sea.hpp"

#include <array>
#include <functional>
#include <glm/vec2.hpp>
#include <vector>

namespace tarn::reference {

/// Real fields of a cascade on a lattice side x side; row = y.
struct WaveFields {
    int side = 0;
    std::vector<double> height, slope_x, slope_y, dx, dy, dxx, dxy, dyy;
};

/// @param finer  the lattice is that many times finer than the cascade's, 1, 2 or 4
WaveFields wave_fields(const waves::Cascade& cascade, double time_s, double loop_s, int finer = 1);

/// The moving water of a lake at one time.
class WaveSurface {
public:
    WaveSurface(const waves::Sea& sea, double time_s);

    /// Above the level [m].
    /// @param depth_m  of the water there, which fades the waves
    double height_m(glm::dvec2 place_m, double depth_m) const;
    /// Rise per metre east and north; the fade's own slope is left out, as on the GPU.
    glm::dvec2 slope(glm::dvec2 place_m, double depth_m) const;
    /// Share of each cascade's waves that is left there.
    std::vector<double> shares(glm::dvec2 place_m, double depth_m) const;
    double bound_m() const { return bound_m_; }
    /// By which waves too short to be drawn are lower there: the finest cascade's share and the
    /// fade.
    double finest_share(glm::dvec2 place_m, double depth_m) const;
    /// Steepest slope of all waves together.
    double steepest() const { return steepest_; }
    /// No step along the water need be shorter to see each wave [m].
    double step_m() const { return step_m_; }

private:
    struct Sample {
        double height;
        glm::dvec2 slope;
    };
    double share(glm::dvec2 place_m, std::size_t cascade) const;
    Sample at(std::size_t cascade, glm::dvec2 place_m) const;
    Sample sum(glm::dvec2 place_m, double depth_m) const;

    const waves::Sea& sea_;
    double time_s_, bound_m_, step_m_, steepest_ = 0.0;
    /// A cascade's fields side by side, for they are looked up together: height, both slopes, both
    /// displacements, their derivatives xx, xy, yy.
    struct Lattice {
        int side = 0; ///< a power of two
        std::vector<std::array<double, 8>> nodes;
        /// All of them between nodes; x and y in nodes.
        std::array<double, 8> at(double x, double y) const;
    };
    std::vector<Lattice> lattices_;
};

} // namespace tarn::reference
