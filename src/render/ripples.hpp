#pragma once
/// @file ripples.hpp  Ripples on a square of water: a wave equation on the GPU, with rain and
/// pokes.
#include "gpu/objects.hpp"
#include "gpu/shader.hpp"

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <vector>

namespace tarn::render {

struct RipplePond {
    enum class Edge { wraps, reflects, absorbs };
    int texels = 256;            ///< a side, a multiple of 16
    double texel_m = 1.0 / 64.0; ///< > 0
    double speed_m_per_s = 0.3;  ///< > 0
    double damping_per_s = 1.5;  ///< >= 0
    Edge edge = Edge::wraps;
    double drops_per_m2_s = 0.0; ///< rain; no denser than a drop a step in 16 x 16 texels
    double drop_height_m = 0.004;
    double drop_radius_m = 2.5 / 64.0;
    std::uint32_t seed = 1;
    struct Dent {
        glm::dvec2 place_m{0.0}; ///< from the corner of texel (0, 0)
        double height_m = 0.0, radius_m = 0.0, time_s = 0.0;
    };
    std::vector<Dent> dents; ///< known beforehand: any time shows what they have become
    /// texels^2: 0 water, 1 land that reflects, 2 land that absorbs; empty: all water.
    std::vector<std::uint8_t> mask;
};

/// Time moves in steps of a fixed length, whatever is asked for: nothing can grow beyond bounds.
/// The context must stay current.
class Ripples {
public:
    explicit Ripples(const RipplePond& pond);

    /// Shows the water at a time. Onwards by as many steps as it takes; backwards, or over more
    /// than what damping lets live, from rest that long before: with rain the same time always
    /// shows the same water, to a thousandth of its height.
    void move_to(double time_s);
    /// At the next step, a dent as a drop leaves it.
    /// @param place_m  from the corner of texel (0, 0), east and north
    void poke(glm::dvec2 place_m, double height_m, double radius_m);

    /// Writes height and slopes to a layer of textures of the same size.
    void write_layer(const gpu::TextureLayers& heights, const gpu::TextureLayers& slopes, int layer,
                     double bound_m);

    /// texels^2 heights at the last step [m]. Waits for the GPU.
    std::vector<float> read(bool before = false) const;
    double step_s() const { return step_s_; }
    long long steps() const { return steps_; } ///< taken in all, for tests of what time costs

private:
    long long step_of(const RipplePond::Dent& dent) const;
    void step();
    void rest(long long number);

    RipplePond pond_;
    double step_s_, since_ = 1.0;
    long long number_ = 0, steps_ = 0, memory_steps_;
    bool moved_ = false;
    gpu::ComputeProgram step_pass_, surface_pass_;
    gpu::Texture2D states_[3]; ///< now, before, and the one to be written
    gpu::Texture2D mask_;
    std::optional<glm::vec4> poke_, last_poke_;
    bool at_rest_ = true; ///< no step since
};

} // namespace tarn::render
