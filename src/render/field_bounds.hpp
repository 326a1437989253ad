#pragma once
/// @file field_bounds.hpp  What walks skip by, on the GPU: made when a walk first asks for it.
#include "gpu/objects.hpp"
#include "gpu/shader.hpp"
#include "scene/settings.hpp"

#include <optional>

namespace tarn::render {

/// Reads the textures of lib/walks/ for one scene. The context must stay current.
class FieldBounds {
public:
    /// Levels of the maximum mipmap until one block covers the field, >= 1.
    static int root_level(GridSize nodes);
    /// Cone map's blocks are 2^shift cells a side.
    static constexpr int cone_shift = 1;

    FieldBounds(const scene::Scene& scene, const gpu::Texture2D& heights)
        : scene_(scene), heights_(heights) {}

    /// Makes what that walk needs, if it is not there yet.
    /// @param with_water  for rays that stop at the water, too
    void prepare(scene::Walk walk, bool with_water);
    /// Binds it at TARN_TEXTURE_BOUNDS. prepare() first.
    void bind(scene::Walk walk, bool with_water) const;
    /// Metres per unit texel of the cone maps, or 0 where there is none yet.
    double ground_cone_m() const { return ground_cone_m_; }
    double surface_cone_m() const { return surface_cone_m_; }
    /// Of all that has been made.
    std::size_t bytes() const { return bytes_; }

    int shift = cone_shift; ///< for experiments; set before the first prepare()

private:
    void build_maxima();
    void build_radii();
    gpu::Texture2D build_cones(bool with_water, double& cone_m);

    const scene::Scene& scene_;
    const gpu::Texture2D& heights_;
    gpu::Texture2D maxima_, ground_cones_, surface_cones_, radii_;
    gpu::Sampler smooth_;
    double ground_cone_m_ = 0.0, surface_cone_m_ = 0.0;
    std::size_t bytes_ = 0;
};

} // namespace tarn::render
