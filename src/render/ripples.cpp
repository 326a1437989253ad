#include "render/ripples.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include "shared/wave_block.h"
#include "waves/ripples.hpp"

#include <algorithm>
#include <cmath>
#include <glm/vec4.hpp>
#include <utility>

namespace tarn::render {

Ripples::Ripples(const RipplePond& pond)
    : pond_(pond), step_s_(waves::ripple_courant * pond.texel_m / pond.speed_m_per_s) {
    if (pond.texels < waves::drop_cell_texels || pond.texels % waves::drop_cell_texels != 0 ||
        !(pond.texel_m > 0.0) || !(pond.speed_m_per_s > 0.0) || !(pond.damping_per_s >= 0.0))
        throw Error(text("ripples: ", pond.texels, " texels of ", pond.texel_m, " m, speed ",
                         pond.speed_m_per_s, " m/s and damping ", pond.damping_per_s,
                         " /s make no pond"));
    const std::size_t count = std::size_t(pond.texels) * std::size_t(pond.texels);
    if (!pond.mask.empty() && pond.mask.size() != count)
        throw Error("ripples: the mask is not of the pond's size");
    // What has lived longer than this is less than a thousandth.
    memory_steps_ =
        pond.damping_per_s > 0.0
            ? std::min<long long>(4096, std::llround(7.0 / (pond.damping_per_s * step_s_)) + 1)
            : 4096;
    const auto root = gpu::shader_root();
    step_pass_ = gpu::ComputeProgram(gpu::load_shader(root, "passes/ripple_step.comp"));
    surface_pass_ = gpu::ComputeProgram(gpu::load_shader(root, "passes/ripple_surface.comp"));
    for (gpu::Texture2D& state : states_)
        state =
            gpu::Texture2D(GL_R32F, pond.texels, pond.texels, 1, gpu::Filter::nearest, "ripples");
    mask_ = gpu::Texture2D(GL_R8UI, pond.texels, pond.texels, 1, gpu::Filter::nearest,
                           "shore of ripples");
    const std::vector<std::uint8_t> water(count, 0);
    mask_.upload(GL_RED_INTEGER, GL_UNSIGNED_BYTE, (pond.mask.empty() ? water : pond.mask).data());
    rest(0);
}

void Ripples::rest(long long number) {
    const float zero = 0.0f;
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    for (const gpu::Texture2D& state : states_)
        glClearTexImage(state.id(), 0, GL_RED, GL_FLOAT, &zero);
    number_ = number;
    last_poke_.reset();
    at_rest_ = true;
}

void Ripples::poke(glm::dvec2 place, double height_m, double radius_m) {
    poke_ = glm::vec4(float(place.x / pond_.texel_m), float(place.y / pond_.texel_m),
                      float(height_m), float(std::max(radius_m / pond_.texel_m, 1.5)));
}

long long Ripples::step_of(const RipplePond::Dent& dent) const {
    return static_cast<long long>(std::floor(std::clamp(dent.time_s / step_s_, -9e17, 9e17)));
}

void Ripples::step() {
    for (const RipplePond::Dent& dent : pond_.dents)
        if (step_of(dent) == number_)
            poke(dent.place_m, dent.height_m, dent.radius_m);
    step_pass_.use();
    for (GLuint k = 0; k < 3; ++k)
        states_[k].bind_image(k, k < 2 ? GL_READ_ONLY : GL_WRITE_ONLY);
    mask_.bind_image(3, GL_READ_ONLY);
    glUniform1i(0, pond_.edge == RipplePond::Edge::wraps      ? 0
                   : pond_.edge == RipplePond::Edge::reflects ? 1
                                                              : 2);
    glUniform1f(1, float(waves::ripple_courant));
    glUniform1f(2, float(pond_.damping_per_s * step_s_));
    glUniform1ui(3, static_cast<GLuint>(static_cast<std::uint64_t>(number_)));
    glUniform1ui(4, pond_.seed);
    const double cell_m = waves::drop_cell_texels * pond_.texel_m;
    glUniform3f(5, float(std::min(1.0, pond_.drops_per_m2_s * cell_m * cell_m * step_s_)),
                float(pond_.drop_height_m), float(pond_.drop_radius_m / pond_.texel_m));
    const glm::vec4 poke = poke_.value_or(glm::vec4(0.0f));
    glUniform4f(6, poke.x, poke.y, poke.z, poke.w);
    const glm::vec4 last = last_poke_.value_or(glm::vec4(0.0f));
    glUniform4f(7, last.x, last.y, last.z, last.w);
    glUniform1i(8, pond_.drops_per_m2_s > 0.0 && !at_rest_);
    last_poke_ = poke_;
    poke_.reset();
    at_rest_ = false;
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    glDispatchCompute(gpu::groups(pond_.texels, 16), gpu::groups(pond_.texels, 8), 1);
    // The state that was written is now; now was before.
    std::swap(states_[1], states_[2]);
    std::swap(states_[0], states_[1]);
    ++number_;
    ++steps_;
}

void Ripples::move_to(double time_s) {
    const double at = time_s / step_s_;
    const long long wanted = static_cast<long long>(std::clamp(std::ceil(at), -9e17, 9e17));
    since_ = std::clamp(1.0 - (double(wanted) - at), 0.0, 1.0);
    if (!moved_ || wanted < number_ || wanted - number_ > memory_steps_) {
        long long start = wanted;
        if (pond_.drops_per_m2_s > 0.0)
            start = wanted - memory_steps_;
        else if (poke_)
            start = wanted - 1;
        for (const RipplePond::Dent& dent : pond_.dents) // from before the first that still matters
            if (step_of(dent) < wanted)
                start = std::min(start, std::max(step_of(dent), wanted - memory_steps_));
        rest(start);
    }
    moved_ = true;
    while (number_ < wanted)
        step();
    gpu::check_gl("moving ripples");
}

void Ripples::write_layer(const gpu::TextureLayers& heights, const gpu::TextureLayers& slopes,
                          int layer, double bound_m) {
    surface_pass_.use();
    states_[0].bind_image(2, GL_READ_ONLY);
    states_[1].bind_image(3, GL_READ_ONLY);
    heights.bind_image(TARN_IMAGE_WAVE_HEIGHTS, GL_WRITE_ONLY, 0);
    slopes.bind_image(TARN_IMAGE_WAVE_SLOPES, GL_WRITE_ONLY, 0);
    glUniform1i(0, layer);
    glUniform1f(1, float(since_));
    glUniform1f(2, float(1.0 / pond_.texel_m));
    glUniform1f(3, float(bound_m));
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    glDispatchCompute(gpu::groups(pond_.texels, 16), gpu::groups(pond_.texels, 8), 1);
}

std::vector<float> Ripples::read(bool before) const {
    std::vector<float> out(std::size_t(pond_.texels) * std::size_t(pond_.texels));
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    states_[before ? 1 : 0].download(GL_RED, GL_FLOAT, out.data(), out.size() * sizeof out[0]);
    gpu::check_gl("reading ripples");
    return out;
}

} // namespace tarn::render
