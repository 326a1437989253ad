#pragma once
/// @file waves.hpp  A sea on the GPU: transforms its spectra, keeps the textures that the tracer
/// reads.
#include "gpu/objects.hpp"
#include "gpu/shader.hpp"
#include "render/ripples.hpp"
#include "waves/sea.hpp"

#include "shared/wave_block.h"

#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>

namespace tarn::render {

/// The context must stay current.
class WaveField {
public:
    /// Uploads a sea; where there is one already, it is replaced.
    void set(waves::Sea sea);
    const waves::Sea& sea() const { return sea_; }

    /// Makes height and slope of every cascade for a time. Costs nothing for sines.
    void move_to(double time_s);

    /// Called before each pass with its name, and with "end" after the last: for timing. May be
    /// empty.
    std::function<void(const char*)> on_pass;

    /// Binds block and textures.
    /// @param base      where positions count from: a node of the ground [scene metres]
    /// @param lift_m    how much the walk's water is raised, >= sea().bound_m
    void bind(glm::dvec2 base, double lift_m);

    /// Heights and slopes alone, for passes that read whole patches.
    void bind_textures() const {
        heights_.bind(TARN_TEXTURE_WAVES);
        slopes_.bind(TARN_TEXTURE_SLOPES);
    }

    /// Height above the level at a place of the scene, unfiltered, at the time of move_to(). Waits
    /// for the GPU.
    double height_at(glm::dvec2 place_m, double depth_m) const;

    /// What a program that draws this sea must define.
    std::string defines() const;

    /// A cascade's height [m], slope east, slope north; texels^2, row = y. Waits for the GPU.
    std::vector<glm::vec3> read(int cascade) const;
    /// What the walk trusts of a cascade: greatest |height| of each mip level [m] (0 where there is
    /// no such level), then the steepest slope between texels. Waits for the GPU.
    std::vector<double> limits(int cascade) const;
    /// Least eigenvalue of the Jacobian of a cascade's displacement: folded where it is negative.
    /// Makes the surface once more, measuring; waits for the GPU.
    double least_eigenvalue(int cascade);
    /// GPU memory of spectra, transforms and textures.
    std::size_t bytes() const { return bytes_; }

private:
    struct Passes {
        int texels = 0, fields = 0;
        gpu::ComputeProgram rows, columns, surface, levels;
    };

    void build_passes();
    void upload_spectra();
    void make_ripples();
    void transform_spectra(const std::function<void(const char*)>& begins);
    void make_levels(int source, int first_layer, int layers);
    int spectral() const; ///< cascades that come from a spectrum: the first ones

    waves::Sea sea_;
    std::vector<Ripples> ripples_; ///< of the cascades after the spectral ones
    Passes passes_;
    gpu::Buffer h0_, turns_, fields_, twiddles_, block_, limits_;
    gpu::BufferTexture limits_texture_;
    gpu::TextureLayers heights_, slopes_;
    gpu::Texture2D amplitude_, table_;
    std::vector<glm::vec4> table_texels_;
    shared::WaveBlock last_block_{};
    double time_s_ = 0.0;
    std::size_t bytes_ = 0;
};

} // namespace tarn::render
