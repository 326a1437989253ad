#include "render/light_prisms.hpp"

#include "shared/prisms.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace tarn::render {

PrismGrid prism_grid(glm::dvec2 camera_m, glm::dvec2 base_m, glm::dvec2 lean, double camera_depth_m,
                     int cells) {
    PrismGrid grid;
    grid.cells = cells;
    grid.camera_depth_m = camera_depth_m;
    // To two depths on each side: 60 degrees from the vertical.
    const double least_m = 4.0 * std::max(camera_depth_m, 0.05) / cells;
    grid.spacing_m = std::exp2(std::ceil(std::log2(least_m)));
    // The light that comes to the camera enters where it leans away from.
    const glm::dvec2 image_m = camera_m - camera_depth_m * lean;
    const glm::dvec2 middle = glm::floor(image_m / grid.spacing_m + 0.5) * grid.spacing_m;
    grid.first_m = middle - 0.5 * cells * grid.spacing_m - base_m;
    return grid;
}

void LightPrisms::draw(const PrismGrid& grid, int width_px, int height_px,
                       const std::string& defined) {
    auto known = passes_.find(defined);
    if (known == passes_.end()) {
        const auto load = [&](const char* file) {
            return gpu::load_shader(gpu::shader_root(), file, {}, defined);
        };
        known = passes_
                    .emplace(defined, Passes{gpu::ComputeProgram(load("passes/prism_corners.comp")),
                                             gpu::ComputeProgram(load("passes/prism_rays.comp")),
                                             gpu::DrawProgram(load("passes/prisms.vert"),
                                                              load("passes/prisms.frag"))})
                    .first;
    }
    const Passes& passes = known->second;
    const int side = grid.cells + 1;
    if (cells_ != grid.cells) {
        cells_ = grid.cells;
        corners_ = gpu::Buffer(std::size_t(side) * std::size_t(side) * 16, nullptr);
        shares_ = gpu::Buffer(std::size_t(side) * std::size_t(side) * 4, nullptr);
    }
    const int width = (width_px + TARN_PRISM_PIXELS - 1) / TARN_PRISM_PIXELS,
              height = (height_px + TARN_PRISM_PIXELS - 1) / TARN_PRISM_PIXELS;
    if (rays_.width_px() != width || rays_.height_px() != height) {
        rays_ = gpu::Texture2D(GL_RGBA32F, width, height, 1, gpu::Filter::nearest, "prism rays");
        light_ = gpu::Texture2D(GL_R32F, width, height, 1, gpu::Filter::linear, "prisms");
        target_ = gpu::Target(light_);
    }
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_PRISMS, corners_.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_SHARES, shares_.id());
    rays_.bind_image(TARN_IMAGE_PRISM_RAYS, GL_READ_WRITE);

    const auto set_grid = [&] {
        glUniform4f(0, float(grid.first_m.x), float(grid.first_m.y), float(grid.spacing_m),
                    float(side));
    };
    passes.corners.use();
    set_grid();
    glUniform1f(1, float(grid.camera_depth_m));
    glDispatchCompute(GLuint(side + 7) / 8, GLuint(side + 7) / 8, 1);
    passes.rays.use();
    glDispatchCompute(GLuint(width + 7) / 8, GLuint(height + 7) / 8, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);

    GLint viewport[4];
    glGetIntegerv(GL_VIEWPORT, viewport);
    target_.bind();
    glViewport(0, 0, width, height);
    const float none[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    glClearBufferfv(GL_COLOR, 0, none);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE, GL_ONE);
    passes.faces.use();
    set_grid();
    glUniform3f(1, float(grid.camera_depth_m), float(grid.top_m), float(grid.bottom_m));
    // Eight triangles for each of four lengths of a cell's two prisms; the last two are flat
    // water's.
    vertices_.draw(24, 2 * 4 * (grid.cells * grid.cells + 1));
    glDisable(GL_BLEND);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    light_.bind(TARN_TEXTURE_PRISMS);
}

} // namespace tarn::render
