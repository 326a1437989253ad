#pragma once
/// @file field_bounds.hpp  What walks skip by, on the GPU: made when a walk first asks for it.
#include "core/cone_map.hpp"
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
    /// Of a cone map; zeros where there is none yet.
    struct ConeScale {
        double top_m = 0.0;   ///< metres per unit texel, of tops
        double slope_m = 0.0; ///< steepest slope, metres per cell
    };
    const ConeScale& ground_cones() const { return ground_scale_; }
    const ConeScale& surface_cones() const { return surface_scale_; }
    /// Bounds that know of the water are made for water that is that much higher [m]; those made
    /// for another height are dropped.
    void set_water_lift(double lift_m);

    /// The scene has other heights now: everything is dropped.
    void scene_changed();
    bool needs_cones() const { return ground_cones_.id() == 0 || surface_cones_.id() == 0; }
    /// See Renderer::give_cone_maps().
    void give_cones(const ConeMap& ground, const ConeMap& surface);

    /// Of all that has been made.
    std::size_t bytes() const { return bytes_; }

    int shift = cone_shift; ///< for experiments; set before the first prepare()

private:
    void build_maxima();
    void build_radii();
    gpu::Texture2D build_cones(bool with_water, ConeScale& scale);
    gpu::Texture2D upload_cones(const ConeMap& map, ConeScale& scale);

    const scene::Scene& scene_;
    const gpu::Texture2D& heights_;
    gpu::Texture2D maxima_, ground_cones_, surface_cones_, radii_;
    gpu::ComputeProgram block_maxima_, reduce_maxima_;
    gpu::Sampler smooth_;
    ConeScale ground_scale_, surface_scale_;
    double lift_m_ = 0.0;
    std::size_t bytes_ = 0;
};

} // namespace tarn::render
