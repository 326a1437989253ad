#pragma once
/// @file light_prisms.hpp  Shafts of light as prisms below a grid on the moving surface, added up
/// over each view by drawing their faces (shaders/passes/prisms.vert).
///
/// After Lanza (2007), "Animation and Rendering of Underwater God Rays", ShaderX5: a grid about the
/// sun's image, a coarse picture, a blur of four samples. Spacing is a power of two and the grid
/// lies on its multiples, so that shafts stay where they are while the camera moves. Faces that a
/// view enters by are taken from those that it leaves by (Nishita, Miyawaki & Nakamae 1987), so
/// that flat water adds nothing. What the method cannot do: docs/physics/caustics.md.
#include "gpu/objects.hpp"
#include "gpu/shader.hpp"
#include "render/waves.hpp"

#include <glm/vec2.hpp>
#include <map>
#include <string>

namespace tarn::render {

/// Where the prisms stand. Metres east and north count from the base of the waves.
struct PrismGrid {
    glm::dvec2 first_m{0.0}; ///< the south-western corner
    double spacing_m = 1.0;
    int cells = 64;              ///< on a side
    double camera_depth_m = 1.0; ///< >= 0
    double top_m = -1.0;         ///< depth of the prisms' tops, < 0: above the level
    double bottom_m = 100.0;     ///< and of their bottoms
};

/// About where a camera sees the sun through flat water.
/// @param camera_m  scene axes   @param base_m  what metres count from
/// @param lean      metres that the sun's light comes east and north a metre deeper
PrismGrid prism_grid(glm::dvec2 camera_m, glm::dvec2 base_m, glm::dvec2 lean, double camera_depth_m,
                     int cells);

/// The context must stay current.
class LightPrisms {
public:
    /// Draws them for the tile of the view block that is bound; hits of its first parts, water and
    /// waves must be, too. The texture TARN_TEXTURE_PRISMS is bound afterwards, image unit
    /// TARN_IMAGE_PRISM_RAYS is used.
    /// @param defined  of the waves, and of paths
    void draw(const PrismGrid& grid, int width_px, int height_px, const std::string& defined);

private:
    struct Passes {
        gpu::ComputeProgram corners, rays;
        gpu::DrawProgram faces;
    };
    std::map<std::string, Passes> passes_; ///< by what is defined
    gpu::Buffer corners_, shares_;
    int cells_ = 0;
    gpu::Texture2D rays_, light_;
    gpu::Target target_;
    gpu::NoVertices vertices_;
};

} // namespace tarn::render
