#pragma once
/// @file sunlight.hpp  Sunlight that waves focus, at some depths below them: caustics, and what
/// light shafts are made of. Model: shaders/lib/caustics.glsl, docs/physics/caustics.md.
#include "gpu/objects.hpp"
#include "gpu/shader.hpp"
#include "render/waves.hpp"
#include "scene/settings.hpp"

#include "shared/sunlight_block.h"

#include <functional>
#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <vector>

namespace tarn::render {

/// What the tiles are made for.
struct SunlightSettings {
    glm::dvec3 sun{0, 0, 1}; ///< towards it, unit, z > 0
    double index = 1.333;    ///< of refraction of the water
    bool schlick = false;
    scene::Caustics method = scene::Caustics::splat; ///< not `off`
    int texels = 0;  ///< a side of a tile: a power of two, at most the waves'; 0: half of theirs
    int photons = 1; ///< of `splat`, on a side of a texel of the waves: 1, 2 or 4
    int slices = 14; ///< depths of each cascade, [2, 64]
    double deepest_m = 1e9; ///< no light is looked for below
    friend bool operator==(const SunlightSettings&, const SunlightSettings&) = default;
};

/// The context must stay current.
class SunlightVolume {
public:
    /// Lays the slices out for a sea. Nothing is drawn before update().
    void set(const waves::Sea& sea, const SunlightSettings& settings);

    /// Makes the tiles for the waves of the moment.
    void update(const WaveField& waves);

    /// Called before each pass with its name, and with "end" after the last: for timing. May be
    /// empty.
    std::function<void(const char*)> on_pass;

    /// Binds block and textures.
    void bind() const;

    double slice_depth_m(int cascade, int slice) const;
    int slices_of(int cascade) const { return needed_[cascade]; }
    int side() const { return side_; }
    /// Sunlight on a slice against that below flat water; side()^2, row = y. Waits for the GPU.
    std::vector<float> read(int cascade, int slice) const;

private:
    struct Passes {
        gpu::ComputeProgram clear, photons, tiles, levels;
    };
    const Passes& passes();

    SunlightSettings settings_;
    shared::SunlightBlock block_{};
    glm::ivec4 needed_{0};
    int cascades_ = 0, side_ = 0, wave_texels_ = 0;
    gpu::Buffer flux_, block_buffer_;
    gpu::TextureLayers tiles_;
    std::map<std::pair<scene::Caustics, int>, Passes> passes_;
    std::size_t flux_texels_ = 0;
};

/// How strongly waves bend the sun's light: variance of the curvature of a cascade's surface
/// [1/m^2], by its spectrum.
double curvature_variance(const waves::Cascade& cascade);

} // namespace tarn::render
