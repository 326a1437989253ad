#pragma once
/// @file renderer.hpp  Scene + View -> Image, by compute shaders.
#include "core/image.hpp"
#include "gpu/context.hpp"
#include "gpu/objects.hpp"
#include "gpu/shader.hpp"
#include "scene/settings.hpp"

#include "shared/view_block.h"

#include <functional>

namespace tarn::render {

/// Holds one scene on the GPU and draws views of it. The context must stay current.
class Renderer {
public:
    /// Uploads the scene and builds its block maxima.
    /// @throws tarn::Error  if the field is larger than the device's textures, or memory runs out
    explicit Renderer(const scene::Scene& scene);

    /// Draws all samples and reads the picture back.
    /// @param progress  called after each sample with its share; may throw to stop
    Image draw(const scene::View& view, const std::function<void(double)>& progress = {});

    /// Draws one sample, tile by tile, and leaves it on the GPU. Call prepare() first.
    void draw_once();

    /// Uploads camera, light and settings, and makes the target images.
    void prepare(const scene::View& view);

    /// Binds heights, maxima and the view block, for a program of one's own (tests).
    void bind_field() const;

private:
    void upload_scene();
    void build_maxima();
    void set_sample(int sample, int samples);
    void draw_tile();

    const scene::Scene& scene_;
    shared::ViewBlock block_{};
    int root_level_ = 1;
    gpu::Texture2D heights_, maxima_, sky_, ortho_, radiance_, distance_;
    gpu::Texture2D
        hits_[3]; ///< ends of the parts of the paths of one tile (shaders/lib/parts.glsl)
    gpu::Buffer view_buffer_, lakes_;
    gpu::ComputeProgram block_maxima_, reduce_maxima_, primary_, secondary_, shadow_, shade_;
    int samples_ = 1;
};

} // namespace tarn::render
