// What the renderer keeps of the scene on the GPU: heights, maps, water's colours, land's shadow.
#include "core/parallel.hpp"
#include "render/renderer.hpp"
#include "render/stroke_tree.hpp"
#include "scene/forward_glow.hpp"
#include "scene/land_shadow.hpp"
#include "scene/water_colour.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

namespace tarn::render {

void Renderer::upload_heights() {
    const Heightfield& ground = scene_.ground;
    const Heightfield& water = scene_.water;
    const GridSize size = ground.size();
    if (heights_.width_px() != size.cols || heights_.height_px() != size.rows)
        heights_ =
            gpu::Texture2D(GL_RG16, size.cols, size.rows, 1, gpu::Filter::nearest, "height field");
    packed_.resize(2 * size.count());
    struct Extremes {
        double water_top = -1e6, deepest = 0.0; // no water: below everything
        std::uint16_t low = 65535, high = 0;
    };
    std::vector<Extremes> rows(std::size_t(size.rows));
    share_out(size.rows, 0, [&](int first, int last) {
        for (int row = first; row < last; ++row) {
            Extremes e;
            std::size_t i = ground.codes.index({0, row});
            for (int col = 0; col < size.cols; ++col, ++i) {
                const std::uint16_t z = ground.codes.values[i], code = water.codes.values[i];
                packed_[2 * i] = z;
                packed_[2 * i + 1] = code;
                e.low = std::min(e.low, z);
                e.high = std::max(e.high, z);
                if (code != no_water_code) {
                    const double level = water.offset_m + water.scale_m * code;
                    e.water_top = std::max(e.water_top, level);
                    e.deepest = std::max(e.deepest, level - ground.offset_m - ground.scale_m * z);
                }
            }
            rows[std::size_t(row)] = e;
        }
    });
    Extremes all;
    for (const Extremes& e : rows)
        all = {std::max(all.water_top, e.water_top), std::max(all.deepest, e.deepest),
               std::min(all.low, e.low), std::max(all.high, e.high)};
    const auto wet = [&](int col, int row) { return water.codes[{col, row}] != no_water_code; };
    wet_border_ = false;
    for (int col = 0; col < size.cols; ++col)
        wet_border_ = wet_border_ || wet(col, 0) || wet(col, size.rows - 1);
    for (int row = 0; row < size.rows; ++row)
        wet_border_ = wet_border_ || wet(0, row) || wet(size.cols - 1, row);
    water_top_m_ = all.water_top;
    deepest_m_ = all.deepest;
    heights_.upload(GL_RG, GL_UNSIGNED_SHORT, packed_.data());
    heights_bytes_ = packed_.size() * sizeof packed_[0];

    // Heights on the GPU count from the ground's offset: float32 then resolves a fraction of a
    // code even for relief at some kilometres of altitude.
    block_.heights = {float(ground.offset_m), float(ground.scale_m * 65535.0),
                      float(water.offset_m - ground.offset_m), float(water.scale_m * 65535.0)};
    double top = ground.offset_m + ground.scale_m * all.high;
    std::vector<glm::vec4> lakes;
    for (const LakeRecord& lake : scene_.lakes) {
        top = std::max(top, lake.level_m);
        lakes.emplace_back(float(lake.level_m - ground.offset_m), lake.bed != Bed::unknown, 0, 0);
    }
    std::sort(lakes.begin(), lakes.end(),
              [](const glm::vec4& a, const glm::vec4& b) { return a.x < b.x; });
    lakes_ = gpu::Buffer(lakes.size() * sizeof lakes[0], lakes.data());
    block_.counts.w = static_cast<std::uint32_t>(lakes.size());
    top_m_ = top - ground.offset_m;
    block_.slab = {float(ground.scale_m * all.low) / block_.heights.y, 0.0f, 0.0f, 0.0f};
}

// What is exposed or draped; one texel stands for nothing.
void Renderer::upload_map() {
    const GridSize size = scene_.ground.size();
    if (scene_.exposed_bed) {
        if (exposed_.width_px() != size.cols || exposed_.height_px() != size.rows)
            exposed_ =
                gpu::Texture2D(GL_R8, size.cols, size.rows, 1, gpu::Filter::linear, "exposed bed");
        exposed_.upload(GL_RED, GL_UNSIGNED_BYTE, scene_.exposed_bed->share.values.data());
        block_.exposed = {float(scene_.exposed_bed->level_m - scene_.ground.offset_m), 1.0f, 0.0f,
                          0.0f};
    } else {
        block_.exposed = {0, 0, 0, 0};
    }
    if (scene_.drape) {
        const scene::Drape& d = *scene_.drape;
        if (drape_.width_px() != d.cols || drape_.height_px() != d.rows)
            drape_ = gpu::Texture2D(GL_R8, d.cols, d.rows, 1, gpu::Filter::linear, "drape");
        drape_.upload(GL_RED, GL_UNSIGNED_BYTE, d.nearness.data());
        const double s = scene_.ground.spacing_m;
        block_.drape = {float((d.west_m - scene_.ground.west_m) / s),
                        float((scene_.ground.north_m - d.north_m) / s), float(d.texel_m / s),
                        float(d.reach_m)};
    } else {
        block_.drape = {0, 0, 0, 0};
    }
    for (gpu::Texture2D* texture : {&exposed_, &drape_})
        if (texture->id() == 0)
            *texture = gpu::Texture2D(GL_R8, 1, 1, 1, gpu::Filter::linear, "no map");
}

// No program asks for lines in space where there are none.
void Renderer::upload_space_lines() {
    space_lines_ = {};
    if (scene_.space_strokes.empty())
        return;
    const std::vector<glm::uvec4> packed = pack_strokes(scene_.ground, scene_.space_strokes);
    space_lines_ = gpu::Buffer(packed.size() * sizeof packed[0], packed.data());
}

void Renderer::scene_changed(bool settled) {
    upload_heights();
    upload_map();
    upload_space_lines();
    bounds_.scene_changed();
    if (settled) {
        packed_ = {}; // kept while somebody drags: fresh memory takes as long as the copy
        shadow_sun_.reset();
        if (waves_)
            waves_->set(
                waves::make_sea(scene_.ground, scene_.water, scene_.lakes, waves_->sea().settings));
        wave_time_s_.reset();
        sunlight_settings_.reset();
    }
    lift_water(lift_m_);
    gpu::check_gl("uploading the scene");
}

void Renderer::give_cone_maps(const ConeMap& ground, const ConeMap& surface) {
    bounds_.give_cones(ground, surface);
}

void Renderer::upload_scene() {
    const Heightfield& ground = scene_.ground;
    const GridSize size = ground.size();
    upload_heights();
    packed_ = {};
    upload_map();
    upload_space_lines();
    block_.walk = {FieldBounds::root_level(size), FieldBounds::cone_shift, 0, 0};
    block_.grid = {float(size.cols), float(size.rows), float(ground.spacing_m), 0.0f};
    block_.forward.w = float(scene::block_bottom_m(ground) - ground.offset_m);

    const float per_m = 1.0f / block_.heights.y;
    block_.base.z = float(1.0 / ground.spacing_m);
    block_.inverse_size = {1.0f / float(size.cols), 1.0f / float(size.rows), 1.0f, 1.0f};
    block_.bounds.w = block_.forward.w * per_m;
    lift_water(0.0);

    if (scene_.ortho) {
        const Ortho& o = *scene_.ortho;
        const int levels = 1 + int(std::log2(std::max(o.picture.width_px, o.picture.height_px)));
        ortho_ = gpu::Texture2D(GL_SRGB8_ALPHA8, o.picture.width_px, o.picture.height_px, levels,
                                gpu::Filter::trilinear, "orthophoto");
        ortho_.upload(GL_RGBA, GL_UNSIGNED_BYTE, o.picture.bytes.data());
        glGenerateTextureMipmap(ortho_.id());
        const double s = ground.spacing_m;
        block_.ortho = {float((o.west_m - ground.west_m) / s),
                        float((ground.north_m - o.north_m) / s),
                        float(o.picture.width_px * o.spacing_m / s),
                        float(o.picture.height_px * o.spacing_m / s)};
        block_.ortho_lod.x = float(o.spacing_m);
    } else {
        ortho_ = gpu::Texture2D(GL_RGBA8, 1, 1, 1, gpu::Filter::linear, "no orthophoto");
    }
    gpu::check_gl("uploading the scene");
}

// Walks meet water that is raised by the waves' bound; what lies in the slab between is met by
// lib/walks/meet_waves.glsl. Bounds that know of the water are made anew.
void Renderer::lift_water(double lift_m) {
    const Heightfield& ground = scene_.ground;
    lift_m_ = lift_m;
    bounds_.set_water_lift(lift_m);
    block_.heights.z = float(scene_.water.offset_m - ground.offset_m + lift_m);
    block_.grid.w = float(top_m_ + lift_m);
    const float per_m = 1.0f / block_.heights.y;
    block_.units = {per_m, block_.heights.z * per_m, block_.heights.w * per_m,
                    block_.grid.w * per_m};
    block_.slab.y = float(water_top_m_ + lift_m - ground.offset_m) * per_m;
    view_buffer_.write(&block_, sizeof block_); // bounds are made from what it says
}

// The frame looks up what was summed over wavelengths here.
void Renderer::upload_water(bool spectral) {
    if (const auto asked = std::pair(spectral, scene_.optics); water_made_ != asked) {
        water_made_ = asked;
        const scene::WaterTable table = scene::make_water_table(scene_.optics, spectral);
        water_ = gpu::Texture2D(GL_RGBA32F, table.texels, int(table.rows.size()), 1,
                                gpu::Filter::nearest, "water");
        water_.upload(GL_RGBA, GL_FLOAT, table.packed().data());
        block_.water = table.scale();
        block_.optics.z = float(table.sky_entering);
        water_longest_m_ = table.longest_m;
        // By the path after which a third of the luminance is left.
        int texel = 1;
        const auto luminance = [&](int i) {
            const glm::vec3& c = table.rows[0][std::size_t(i)];
            return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
        };
        while (texel < scene::WaterTable::texels - 1 && luminance(texel) > 0.3679f)
            ++texel;
        block_.optics.w = float(1.0 / table.path_m(texel));
    }
    water_.bind(TARN_TEXTURE_WATER);
}

// Waters of three channels say nothing of what they scatter forwards.
bool Renderer::scatters_forwards(const scene::View& view) const {
    const auto scatters = [](const scene::WaterBand& band) { return band.forward_per_m() > 0.0; };
    const auto& bands = scene_.optics.bands;
    return view.settings.forward_glow && view.settings.spectral &&
           std::any_of(bands.begin(), bands.end(), scatters);
}

// Only for a camera that sees it.
void Renderer::upload_glow() {
    if (glow_made_ != scene_.optics) {
        glow_made_ = scene_.optics;
        const auto upload = [&](const scene::GlowTable& table, const char* name) {
            const scene::GlowColours colours =
                scene::make_glow_colours(scene_.optics, table, water_longest_m_);
            gpu::Texture2D out(GL_RGBA32F, colours.angles, colours.paths, 1, gpu::Filter::linear,
                               name);
            out.upload(GL_RGBA, GL_FLOAT, colours.rgb.data());
            return out;
        };
        glow_ = upload(scene::glow_table(), "glow");
        sky_glow_ = upload(scene::sky_glow_table(scene_.optics.index), "sky glow");
    }
    glow_.bind(TARN_TEXTURE_GLOW);
    sky_glow_.bind(TARN_TEXTURE_SKY_GLOW);
}

// Which water the sun's light comes into, by where it enters; where neither land nor bed hides
// any of it, no program asks.
void Renderer::prepare_land_shadow(const scene::View& view) {
    const glm::dvec3 sun = view.lighting.sun_direction;
    const glm::dvec3 light = view.lighting.sun_irradiance;
    if (!view.settings.shadows || !(light.x + light.y + light.z > 0.0)) {
        shadowed_ = bed_shadowed_ = false;
        shadow_sun_.reset();
        return;
    }
    if (const auto asked = std::pair(sun, scene_.optics.index); shadow_sun_ != asked) {
        shadow_sun_ = asked;
        const glm::dvec3 flat_normal(0.0, 0.0, 1.0);
        const glm::dvec3 below =
            sun.z > 0.0 ? -glm::refract(-sun, flat_normal, 1.0 / scene_.optics.index) : flat_normal;
        const auto land = scene::land_shadow(scene_, sun), bed = scene::bed_shadow(scene_, below);
        bed_shadowed_ = bed.has_value();
        shadowed_ = land || bed;
        if (shadowed_) { // cells are the same
            const scene::LandShadow& cells = land ? *land : *bed;
            std::vector<glm::vec2> heights(cells.height_m.size(), glm::vec2(-1e9f));
            for (std::size_t i = 0; i < heights.size(); ++i) {
                if (land)
                    heights[i].x = float(double(land->height_m[i]) - scene_.ground.offset_m);
                if (bed)
                    heights[i].y = float(double(bed->height_m[i]) - scene_.ground.offset_m);
            }
            land_shadow_ = gpu::Texture2D(GL_RG32F, cells.cols, cells.rows, 1, gpu::Filter::linear,
                                          "shadow of land and bed");
            land_shadow_.upload(GL_RG, GL_FLOAT, heights.data());
            shadow_softness_m_ = land ? land->softness_m : 1.0;
            bed_softness_m_ = bed ? bed->softness_m : 1.0;
        }
    }
    block_.sun_irradiance.w = float(shadow_softness_m_);
    block_.sky_irradiance.w = float(bed_softness_m_);
    if (shadowed_)
        land_shadow_.bind(TARN_TEXTURE_LAND_SHADOW);
}

} // namespace tarn::render
