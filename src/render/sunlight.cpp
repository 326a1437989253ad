#include "render/sunlight.hpp"

#include "core/angles.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace tarn::render {

namespace {

/// Slices lie from a part of the depth where waves focus, by their curvature, to so many times it.
constexpr double shallowest_of_focus = 1.0 / 8.0, deepest_of_focus = 16.0;

/// Metres east and north that the beam comes to a metre deeper, behind a facet.
glm::dvec2 lean(glm::dvec3 sun, glm::dvec2 slope, double index) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(-slope.x, -slope.y, 1.0));
    const double cosine = glm::dot(sun, normal);
    const glm::dvec3 along = (cosine * normal - sun) / index;
    const glm::dvec3 down = along - std::sqrt(1.0 - glm::dot(along, along)) * normal;
    return glm::dvec2(down.x, down.y) / -down.z;
}

} // namespace

double curvature_variance(const waves::Cascade& c) {
    const int n = c.texels;
    const double dk = 2.0 * pi / c.patch_m;
    if (c.h0.empty()) { // ripples: rings some eight texels from crest to crest
        const double k = 2.0 * pi / (8.0 * c.texel_m());
        return k * k * c.moments.slope();
    }
    double sum = 0.0;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const glm::vec4& h = c.h0[std::size_t(y) * std::size_t(n) + std::size_t(x)];
            const double kx = dk * (x < n / 2 ? x : x - n), ky = dk * (y < n / 2 ? y : y - n);
            const double k2 = kx * kx + ky * ky;
            sum += k2 * k2 *
                   (double(h.x) * h.x + double(h.y) * h.y + double(h.z) * h.z + double(h.w) * h.w);
        }
    return sum;
}

void SunlightVolume::set(const waves::Sea& sea, const SunlightSettings& settings) {
    settings_ = settings;
    cascades_ = int(sea.cascades.size());
    if (cascades_ == 0)
        return;
    wave_texels_ = sea.cascades.front().texels;
    const int side = settings.texels > 0 ? settings.texels : wave_texels_ / 2;
    if (side > wave_texels_ || (side & (side - 1)) != 0 || side < 16)
        throw Error(text("tiles of sunlight of ", side, " texels"),
                    "a power of two from 16 to the side of the waves' patches");
    if (side != side_ || tiles_.layers() != cascades_ * settings.slices) {
        side_ = side;
        const int layers = cascades_ * settings.slices;
        tiles_ = gpu::TextureLayers(GL_RG16F, side, layers, "sunlight");
        const std::size_t texels = std::size_t(side) * std::size_t(side) * std::size_t(layers);
        flux_texels_ = texels;
        flux_ = gpu::Buffer(texels * sizeof(GLuint), nullptr);
    }
    // How far a facet's slope throws the light off, on the mean of both axes.
    const glm::dvec2 middle = lean(settings.sun, {0, 0}, settings.index);
    constexpr double step = 0.01;
    const glm::dvec2 by_x = (lean(settings.sun, {step, 0}, settings.index) - middle) / step;
    const glm::dvec2 by_y = (lean(settings.sun, {0, step}, settings.index) - middle) / step;
    const auto variance_of = [&](const waves::SlopeCovariance& s) {
        return 0.5 * (s.xx * glm::dot(by_x, by_x) + 2.0 * s.xy * glm::dot(by_x, by_y) +
                      s.yy * glm::dot(by_y, by_y));
    };
    const double bend = std::sqrt(0.5 * (glm::dot(by_x, by_x) + glm::dot(by_y, by_y)));
    block_ = {};
    const double disc = scene::sun_radius_rad / settings.index;
    block_.beam = {float(middle.x), float(middle.y), float(settings.slices),
                   float(0.25 * disc * disc * (1.0 + glm::dot(middle, middle)))};
    block_.rough.x = float(variance_of(sea.roughness));
    needed_ = glm::ivec4(0);
    for (int j = 0; j < cascades_; ++j) {
        const waves::Cascade& c = sea.cascades[std::size_t(j)];
        const double focus = 1.0 / std::max(bend * std::sqrt(curvature_variance(c)), 1e-3);
        const double first = shallowest_of_focus * focus;
        const double doublings = std::log2(deepest_of_focus / shallowest_of_focus);
        block_.cascades[j] = {float(first), float((settings.slices - 1) / doublings),
                              float(0.5 * bend * bend * c.moments.slope()),
                              float(c.patch_m / side_)};
        // One slice more than the deepest water needs.
        const double last =
            std::log2(std::max(settings.deepest_m / first, 1e-9)) * block_.cascades[j].y;
        needed_[j] = int(std::clamp(std::ceil(last) + 2.0, 2.0, double(settings.slices)));
    }
    for (int j = 0; j < cascades_; ++j)
        block_.last[j] = float(needed_[j] - 1);
    block_buffer_ = gpu::Buffer(sizeof block_, &block_);
    gpu::check_gl("laying out the sunlight");
}

const SunlightVolume::Passes& SunlightVolume::passes() {
    const auto key = std::pair(settings_.method, settings_.photons);
    if (const auto known = passes_.find(key); known != passes_.end())
        return known->second;
    const auto root = gpu::shader_root();
    const int number = int(settings_.method) - int(scene::Caustics::splat);
    const std::string defined =
        text("#define TARN_SUNLIGHT_METHOD ", number, "\n#define TARN_SUNLIGHT_PHOTONS ",
             settings_.method == scene::Caustics::splat ? settings_.photons : 1, "\n",
             gpu::is_software() ? "#define TARN_SUNLIGHT_DIRECT 1\n" : "");
    const std::string from_flux =
        std::string("#define TARN_SUNLIGHT_FROM_FLUX 1\n") +
        (settings_.method == scene::Caustics::photon_map ? "#define TARN_SUNLIGHT_BILATERAL 1\n"
                                                         : "");
    const auto pass = [&](const char* name, const std::string& words) {
        return gpu::ComputeProgram(gpu::load_shader(root, name, {}, words));
    };
    return passes_
        .emplace(key, Passes{pass("passes/sunlight_clear.comp", ""),
                             pass("passes/sunlight_photons.comp", defined),
                             pass("passes/sunlight_tiles.comp", from_flux),
                             pass("passes/sunlight_tiles.comp", "")})
        .first->second;
}

void SunlightVolume::update(const WaveField& waves) {
    if (cascades_ == 0)
        return;
    const auto begins = [this](const char* name) {
        if (on_pass)
            on_pass(name);
    };
    const Passes& pass = passes();
    begins("sunlight");
    glBindBufferBase(GL_UNIFORM_BUFFER, TARN_BLOCK_SUNLIGHT, block_buffer_.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_SUNLIGHT, flux_.id());
    pass.clear.use();
    const GLuint groups_of_1024 = GLuint((flux_texels_ + 1023) / 1024);
    glDispatchCompute(std::min<GLuint>(groups_of_1024, 1024), (groups_of_1024 + 1023) / 1024, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    waves.bind_textures();
    pass.photons.use();
    const glm::dvec3& s = settings_.sun;
    glUniform4f(0, float(s.x), float(s.y), float(s.z), float(settings_.index));
    glUniform1i(1, side_);
    glUniform1i(2, settings_.schlick);
    glUniform4i(3, needed_.x, needed_.y, needed_.z, needed_.w);
    const GLuint groups = settings_.method == scene::Caustics::splat
                              ? GLuint(wave_texels_ * settings_.photons / 32)
                              : gpu::groups(wave_texels_);
    glDispatchCompute(groups, groups, GLuint(cascades_));
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    begins("sunlight tiles");
    int source = -1; // level
    while (source + 1 < tiles_.levels()) {
        const bool first = source < 0;
        const int made = std::min(4, tiles_.levels() - 1 - source);
        for (int k = 0; k < 4; ++k)
            tiles_.bind_image(GLuint(TARN_IMAGE_SUNLIGHT + k), GL_WRITE_ONLY,
                              source + 1 + std::min(k, made - 1));
        (first ? pass.tiles : pass.levels).use();
        tiles_.bind(TARN_TEXTURE_SUNLIGHT);
        const int side = side_ >> (source + 1);
        glUniform1i(0, std::max(source, 0));
        glUniform1i(1, made);
        glUniform1i(2, side);
        glUniform1i(3, settings_.slices);
        glUniform4i(4, needed_.x, needed_.y, needed_.z, needed_.w);
        glDispatchCompute(gpu::groups(side), gpu::groups(side), GLuint(tiles_.layers()));
        glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
        source += made;
    }
    begins("end");
}

void SunlightVolume::bind() const {
    if (cascades_ == 0)
        return;
    glBindBufferBase(GL_UNIFORM_BUFFER, TARN_BLOCK_SUNLIGHT, block_buffer_.id());
    tiles_.bind(TARN_TEXTURE_SUNLIGHT);
}

double SunlightVolume::slice_depth_m(int cascade, int slice) const {
    return block_.cascades[cascade].x *
           std::exp2(double(slice) / double(block_.cascades[cascade].y));
}

std::vector<float> SunlightVolume::read(int cascade, int slice) const {
    const std::size_t texels = std::size_t(side_) * std::size_t(side_);
    std::vector<float> both(2 * texels), out(texels);
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    glGetTextureSubImage(tiles_.id(), 0, 0, 0, cascade * settings_.slices + slice, side_, side_, 1,
                         GL_RG, GL_FLOAT, GLsizei(both.size() * sizeof(float)), both.data());
    gpu::check_gl("reading the sunlight");
    for (std::size_t i = 0; i < texels; ++i)
        out[i] = both[2 * i];
    return out;
}

} // namespace tarn::render
