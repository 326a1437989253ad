#pragma once
/// @file display.hpp  A picture on the GPU made fit for a screen, and looked at for its exposure.
#include "gpu/objects.hpp"
#include "gpu/shader.hpp"

#include <glm/vec3.hpp>
#include <vector>

namespace tarn::render {

/// passes/display.comp and passes/meter.comp. The context must stay current.
class Display {
public:
    Display();

    static constexpr int across = 64, down = 36; ///< places that meter() looks at

    /// Radiance at an even raster of places, across * down of them, row 0 on top. Waits for the
    /// GPU.
    std::vector<glm::vec3> meter(const gpu::Texture2D& radiance) const;

    /// Tone-maps the picture into texture(), of the same size.
    /// @param exposure  factor, > 0
    /// @param share     factor that makes the samples so far the whole
    void show(const gpu::Texture2D& radiance, double exposure, double share);

    const gpu::Texture2D& texture() const { return screen_; }

private:
    gpu::ComputeProgram display_, meter_;
    gpu::Texture2D screen_;
    gpu::Buffer metered_;
};

} // namespace tarn::render
