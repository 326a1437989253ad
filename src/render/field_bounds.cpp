#include "render/field_bounds.hpp"

#include "core/safety_radius.hpp"

#include "shared/view_block.h"

#include <algorithm>

namespace tarn::render {

namespace {

int next_power_of_two(int n) {
    int p = 1;
    while (p < n)
        p *= 2;
    return p;
}

} // namespace

int FieldBounds::root_level(GridSize nodes) {
    const int cells = std::max(nodes.cols, nodes.rows) - 1;
    int level = 1;
    while ((1 << (2 * level)) < cells)
        ++level;
    return level;
}

void FieldBounds::set_water_lift(double lift_m) {
    if (lift_m == lift_m_)
        return;
    lift_m_ = lift_m;
    maxima_ = {};
    surface_cones_ = {};
}

void FieldBounds::prepare(scene::Walk walk, bool with_water) {
    switch (walk) {
    case scene::Walk::maximum_mipmap:
        if (maxima_.id() == 0)
            build_maxima();
        break;
    case scene::Walk::cone_map:
    case scene::Walk::cone_steps:
        if (with_water && surface_cones_.id() == 0)
            surface_cones_ = build_cones(true, surface_scale_);
        if (!with_water && ground_cones_.id() == 0)
            ground_cones_ = build_cones(false, ground_scale_);
        break;
    case scene::Walk::safety_exact:
    case scene::Walk::safety_radius:
        if (radii_.id() == 0)
            build_radii();
        break;
    case scene::Walk::grid:
    case scene::Walk::uniform_steps:
    case scene::Walk::direction_steps:
        break; // need nothing but the heights
    }
}

void FieldBounds::bind(scene::Walk walk, bool with_water) const {
    gpu::Sampler::unbind(TARN_TEXTURE_BOUNDS);
    gpu::Sampler::unbind(TARN_TEXTURE_HEIGHTS);
    switch (walk) {
    case scene::Walk::maximum_mipmap:
        maxima_.bind(TARN_TEXTURE_BOUNDS);
        break;
    case scene::Walk::cone_map:
    case scene::Walk::cone_steps:
        (with_water ? surface_cones_ : ground_cones_).bind(TARN_TEXTURE_BOUNDS);
        break;
    case scene::Walk::safety_radius:
        smooth_.bind(TARN_TEXTURE_HEIGHTS);
        [[fallthrough]];
    case scene::Walk::safety_exact:
        radii_.bind(TARN_TEXTURE_BOUNDS);
        break;
    case scene::Walk::uniform_steps:
    case scene::Walk::direction_steps:
        smooth_.bind(TARN_TEXTURE_BOUNDS);
        [[fallthrough]];
    case scene::Walk::grid:
        heights_.bind(TARN_TEXTURE_BOUNDS);
        break;
    }
}

void FieldBounds::build_radii() {
    const Grid<std::uint8_t> radii =
        scene_.safety_radii ? *scene_.safety_radii : safety_radii(scene_.ground);
    radii_ = gpu::Texture2D(GL_R8, radii.size.cols, radii.size.rows, 1, gpu::Filter::nearest,
                            "safety radii");
    radii_.upload(GL_RED, GL_UNSIGNED_BYTE, radii.values.data());
    bytes_ += radii.values.size();
    gpu::check_gl("uploading the safety radii");
}

void FieldBounds::build_maxima() {
    if (block_maxima_.id() == 0) {
        const auto root = gpu::shader_root();
        block_maxima_ = gpu::ComputeProgram(gpu::load_shader(root, "passes/block_maxima.comp"));
        reduce_maxima_ = gpu::ComputeProgram(gpu::load_shader(root, "passes/reduce_maxima.comp"));
    }
    const GridSize size = scene_.ground.size();
    const int root_of_field = root_level(size);
    const int wide = next_power_of_two((size.cols - 1 + 3) / 4);
    const int high = next_power_of_two((size.rows - 1 + 3) / 4);
    const int levels = 2 * (root_of_field - 1) + 1;
    // The root's one texel must exist: pad the longer side up to a power of four blocks.
    const int side = 1 << (2 * (root_of_field - 1));
    const int w = wide >= high ? std::max(wide, side) : wide;
    const int h = high > wide ? std::max(high, side) : high;
    maxima_ = gpu::Texture2D(GL_RG32F, w, h, levels, gpu::Filter::nearest, "block maxima");
    bytes_ += std::size_t(w) * std::size_t(h) * 8 * 4 / 3;
    heights_.bind(TARN_TEXTURE_HEIGHTS);
    maxima_.bind(TARN_TEXTURE_BOUNDS);
    block_maxima_.use();
    maxima_.bind_image(TARN_IMAGE_MAXIMA, GL_WRITE_ONLY, 0);
    glDispatchCompute(gpu::groups(w), gpu::groups(h), 1);
    reduce_maxima_.use();
    for (int level = 0; level + 1 < levels; ++level) {
        glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
        maxima_.bind_image(TARN_IMAGE_MAXIMA, GL_WRITE_ONLY, level + 1);
        glUniform1i(0, level);
        glDispatchCompute(gpu::groups(std::max(1, w >> (level + 1))),
                          gpu::groups(std::max(1, h >> (level + 1))), 1);
    }
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    gpu::check_gl("building the block maxima");
}

gpu::Texture2D FieldBounds::build_cones(bool with_water, ConeScale& scale) {
    Heightfield raised;
    if (with_water && lift_m_ != 0.0) {
        raised = scene_.water;
        raised.offset_m += lift_m_;
    }
    const Heightfield& water = raised.codes.size.cols > 0 ? raised : scene_.water;
    return upload_cones(cone_map(scene_.ground, with_water ? &water : nullptr, shift), scale);
}

void FieldBounds::scene_changed() {
    maxima_ = {};
    ground_cones_ = {};
    surface_cones_ = {};
    radii_ = {};
    bytes_ = 0;
}

void FieldBounds::give_cones(const ConeMap& ground, const ConeMap& surface) {
    ground_cones_ = upload_cones(ground, ground_scale_);
    surface_cones_ = upload_cones(surface, surface_scale_);
}

gpu::Texture2D FieldBounds::upload_cones(const ConeMap& map, ConeScale& scale) {
    gpu::Texture2D texture(GL_RG16, map.blocks.cols, map.blocks.rows, 1, gpu::Filter::nearest,
                           "cone map");
    texture.upload(GL_RG, GL_UNSIGNED_SHORT, map.texels.data());
    scale = {map.scale_m * 65535.0, map.slope_m};
    bytes_ += map.texels.size() * sizeof map.texels[0];
    gpu::check_gl("uploading the cone map");
    return texture;
}

} // namespace tarn::render
