#include "render/display.hpp"

#include "shared/view_block.h"

#include <glm/vec4.hpp>

namespace tarn::render {

namespace {

gpu::ComputeProgram pass(const char* name) {
    return gpu::ComputeProgram(gpu::load_shader(gpu::shader_root(), name));
}

} // namespace

Display::Display()
    : display_(pass("passes/display.comp")), meter_(pass("passes/meter.comp")),
      metered_(std::size_t(across * down) * sizeof(glm::vec4), nullptr) {}

std::vector<glm::vec3> Display::meter(const gpu::Texture2D& radiance) const {
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    radiance.bind(TARN_TEXTURE_PICTURE);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_METER, metered_.id());
    meter_.use();
    glUniform2i(0, across, down);
    glDispatchCompute(gpu::groups(across), gpu::groups(down), 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    std::vector<glm::vec4> places(std::size_t(across * down));
    glGetNamedBufferSubData(metered_.id(), 0, GLsizeiptr(places.size() * sizeof places[0]),
                            places.data());
    return {places.begin(), places.end()};
}

void Display::show(const gpu::Texture2D& radiance, double exposure, double share) {
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    radiance.bind(TARN_TEXTURE_PICTURE);
    if (screen_.width_px() != radiance.width_px() || screen_.height_px() != radiance.height_px())
        screen_ = gpu::Texture2D(GL_RGBA8, radiance.width_px(), radiance.height_px(), 1,
                                 gpu::Filter::linear, "screen");
    screen_.bind_image(TARN_IMAGE_SCREEN, GL_WRITE_ONLY);
    display_.use();
    glUniform2f(0, float(exposure), float(share));
    glDispatchCompute(gpu::groups(screen_.width_px()), gpu::groups(screen_.height_px()), 1);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
    gpu::check_gl("showing the picture");
}

} // namespace tarn::render
