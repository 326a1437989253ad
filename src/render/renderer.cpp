#include "render/renderer.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "scene/curvature.hpp"
#include "scene/space_lines.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <vector>

namespace tarn::render {

namespace {

/// Pixels of a tile at most: what the passes hand to each other takes 48 bytes a pixel.
constexpr int tile_pixels = 1 << 22;

} // namespace

Renderer::Renderer(const scene::Scene& scene, std::optional<bool> rays_in_step)
    : scene_(scene), view_buffer_(sizeof(shared::ViewBlock), nullptr), bounds_(scene, heights_),
      rays_in_step_(rays_in_step.value_or(!gpu::is_software())) {
    use_shade();
    upload_scene();
    view_buffer_.write(&block_, sizeof block_); // bounds are made from what it says of the field
    glBindBufferBase(GL_UNIFORM_BUFFER, TARN_BLOCK_VIEW, view_buffer_.id());
}

// A picture without haze runs a program that holds none of it.
void Renderer::use_shade() {
    const std::string defined = path_defines() + shade_defines();
    gpu::ComputeProgram& shade = shade_[defined];
    if (shade.id() == 0)
        shade = gpu::ComputeProgram(
            gpu::load_shader(gpu::shader_root(), "passes/shade.comp", {}, defined));
    calm_shade_ = &shade;
}

std::string Renderer::sunlight_defines() const {
    if (!caustics_)
        return {};
    return text("#define TARN_CAUSTICS 1\n#define TARN_SHAFTS ", prisms_asked_ ? 0 : shaft_steps_,
                prisms() ? "\n#define TARN_PRISMS 1\n" : "\n");
}

std::string Renderer::shade_defines() const {
    return std::string(hazy_ ? "#define TARN_HAZE 1\n" : "") +
           (whole_sky_ ? "#define TARN_WHOLE_SKY 1\n" : "") +
           (shadowed_ ? "#define TARN_LAND_SHADOW 1\n" : "") +
           (bed_shadowed_ ? "#define TARN_BED_SHADOW 1\n" : "") +
           (mapped_ ? "#define TARN_MAP 1\n" : "") +
           (space_lines_.id() != 0 ? "#define TARN_SPACE_LINES 1\n" : "") +
           (lamp_ ? "#define TARN_LAMP 1\n" : "") + (glows() ? "#define TARN_GLOW 1\n" : "");
}

// What every pass that follows a path must know: scenes that are small, cameras that are in one
// medium, run programs that hold none of it.
std::string Renderer::path_defines() const {
    return std::string(rays_in_step_ ? "#define TARN_CONES_A_LOOK 8\n"
                                     : "") + // lib/walks/cone_map.glsl
           (curved_ ? "#define TARN_CURVED 1\n" : "") +
           (cut_water_ ? "#define TARN_CUT_WATER 1\n" : "") +
           (port_ ? "#define TARN_PORT 1\n" : "");
}

// Of rays from the camera: only theirs are as wide as a pixel.
std::string Renderer::coarse_define() const {
    return coarse_ && walk_ == scene::Walk::cone_map ? "#define TARN_COARSE 1\n" : "";
}

gpu::ComputeProgram Renderer::walk_pass(const char* name, const std::string& defined) const {
    return gpu::ComputeProgram(gpu::load_shader(
        gpu::shader_root(), text("passes/", name, ".comp"),
        {{"lib/walks/cone_map.glsl", "lib/walks/" + walk_file() + ".glsl"}}, defined));
}

void Renderer::use_walk(scene::Walk walk, double setting) {
    walk_ = walk;
    const scene::WalkMethod& method = scene::walk_method(walk_);
    block_.bounds.z = float(setting > 0.0 ? setting : method.default_setting);
    const std::string defined = path_defines(), from_camera = defined + coarse_define();
    const auto key = std::pair(walk_, from_camera);
    auto known = passes_.find(key);
    if (known == passes_.end())
        known = passes_
                    .emplace(key,
                             WalkPasses{
                                 walk_pass("beams", defined), walk_pass("primary", from_camera),
                                 walk_pass("secondary", defined), walk_pass("shadow", defined),
                                 walk_pass("first_hit", defined), walk_pass("trace_rays", defined)})
                    .first;
    calm_walk_ = &known->second;
}

std::string Renderer::walk_file() const {
    std::string file = scene::walk_method(walk_).name;
    std::replace(file.begin(), file.end(), '-', '_');
    return file;
}

const Renderer::WavyPasses& Renderer::wavy_passes() {
    const std::string defined = path_defines() + waves_->defines() + shade_defines() +
                                sunlight_defines() + (in_slab_ ? "#define TARN_IN_SLAB 1\n" : ""),
                      from_camera = defined + coarse_define();
    // Land is mirrored from above alone.
    constexpr std::uint32_t mirrors = TARN_FLAG_REFLECTION | TARN_FLAG_MIRRORED_LAND;
    const bool shares = !under_water() && (block_.counts.z & mirrors) == mirrors;
    const std::string sharing = shares ? "#define TARN_SHARED_LAND 1\n" : "";
    const auto key = std::pair(walk_, from_camera + sharing);
    if (const auto known = wavy_passes_.find(key); known != wavy_passes_.end())
        return known->second;
    return wavy_passes_
        .emplace(key,
                 WavyPasses{walk_pass("primary", from_camera), walk_pass("surface", from_camera),
                            walk_pass("secondary", defined), walk_pass("shadow", defined),
                            caustics_ ? walk_pass("sunlit", defined) : gpu::ComputeProgram(),
                            walk_pass("shade", defined + sharing)})
        .first->second;
}

void Renderer::prepare_waves(const scene::View& view) {
    caustics_ = false; // until there are waves
    shaft_steps_ = 0;
    waves::Settings asked = view.waves;
    const double time_s = asked.time_s;
    asked.time_s = 0.0;
    if (asked.calm()) {
        waves_.reset();
    } else if (!waves_ || !(waves_->sea().settings == asked)) {
        if (!waves_)
            waves_.emplace();
        waves_->set(waves::make_sea(scene_.ground, scene_.water, scene_.lakes, asked));
        sunlight_settings_.reset();
        wave_time_s_.reset();
    }
    // In steps of a quarter, so that a little more wind needs no new bounds.
    double lift = 0.0;
    if (wavy())
        lift = std::pow(
            1.25, std::ceil(std::log(std::max(waves_->sea().bound_m, 1e-3)) / std::log(1.25)));
    if (lift != lift_m_)
        lift_water(lift);
    if (!wavy())
        return;
    const bool moved = wave_time_s_ != time_s;
    if (moved)
        waves_->move_to(time_s);
    wave_time_s_ = time_s;
    prepare_sunlight(view, moved);
    const Heightfield& ground = scene_.ground;
    waves_->bind({ground.x_m(double(block_.base.x)), ground.y_m(double(block_.base.y))}, lift);
}

// Caustics, where waves move, the sun shines and the light comes to a bed.
void Renderer::prepare_sunlight(const scene::View& view, bool moved) {
    const scene::RenderSettings& settings = view.settings;
    caustics_ = settings.caustics != scene::Caustics::off && view.lighting.sun_direction.z > 0.0 &&
                !waves_->sea().cascades.empty();
    shaft_steps_ = caustics_ ? settings.shaft_steps : 0;
    prisms_asked_ = shaft_steps_ > 0 && settings.shafts == scene::Shafts::prisms;
    prism_cells_ = settings.shaft_prisms;
    if (!caustics_)
        return;
    SunlightSettings asked;
    asked.sun = view.lighting.sun_direction;
    asked.index = scene_.optics.index;
    asked.schlick = settings.fresnel == scene::Fresnel::schlick;
    asked.method = settings.caustics;
    asked.texels = settings.caustic_texels;
    asked.photons = settings.caustic_photons;
    asked.deepest_m = deepest_m_;
    for (const LakeRecord& lake : scene_.lakes)
        if (lake.bed == Bed::unknown) // nothing but water, as deep as light comes back from
            asked.deepest_m =
                std::max(asked.deepest_m, scene::greatest_path_m(scene_.optics, settings));
    // Nor deeper than light that was not scattered wide still draws a pattern of a fiftieth.
    double scattered_per_m = scene_.optics.bands.empty() ? 0.0 : 1e9;
    for (const scene::WaterBand& band : scene_.optics.bands)
        scattered_per_m =
            std::min(scattered_per_m, band.pattern_per_m() - band.attenuation_per_m());
    if (scattered_per_m > 0.0)
        asked.deepest_m = std::min(asked.deepest_m, std::log(50.0) / scattered_per_m);
    if (sunlight_settings_ != asked) {
        sunlight_.set(waves_->sea(), asked);
        sunlight_settings_ = asked;
        moved = true;
    }
    sunlight_.on_pass = on_pass;
    if (moved)
        sunlight_.update(*waves_);
    sunlight_.bind();
}

void Renderer::bind_walk(bool with_water) { bounds_.bind(walk_, with_water); }

void Renderer::bind_field(scene::Walk walk, bool with_water) {
    bounds_.prepare(walk, with_water);
    block_.bounds.x = float(bounds_.ground_cones().top_m / block_.heights.y);
    block_.bounds.y = float(bounds_.surface_cones().top_m / block_.heights.y);
    block_.slab.z = float(bounds_.ground_cones().slope_m / block_.heights.y);
    block_.slab.w = float(bounds_.surface_cones().slope_m / block_.heights.y);
    view_buffer_.write(&block_, sizeof block_);
    glBindBufferBase(GL_UNIFORM_BUFFER, TARN_BLOCK_VIEW, view_buffer_.id());
    heights_.bind(TARN_TEXTURE_HEIGHTS);
    bounds_.bind(walk, with_water);
}

void Renderer::prepare(const scene::View& view) {
    const scene::RenderSettings& settings = view.settings;
    settings.validate();
    samples_ = settings.samples;
    const scene::Camera& camera = view.camera;
    const Heightfield& ground = scene_.ground;
    const double degree = 3.14159265358979323846 / 180.0;
    const double half = std::tan(0.5 * camera.fov_deg * degree);
    const double pixel_rad = 2.0 * half / settings.height_px;
    const int rows = settings.rows_drawn();
    constexpr std::int64_t most_px = std::int64_t(1) << 27; // 2 GiB of radiance
    if (std::int64_t(rows) * settings.width_px > most_px)
        throw Error(text("a picture of ", std::int64_t(rows) * settings.width_px,
                         " pixels cannot be held whole"),
                    "choose a smaller --size; tarn render draws large ones in strips");
    const glm::dvec3& p = camera.position;
    const double col = ground.col(p.x), row = ground.row(p.y);
    // Walks count cells in float from beside the camera: up to 2^22 of them they are whole numbers.
    if (!(std::abs(col) < 4e6 && std::abs(row) < 4e6 && std::abs(p.z) < 4e6 * ground.spacing_m))
        throw Error(text("the camera is more than four million cells (",
                         std::lround(4e3 * ground.spacing_m), " km) away from the scene"),
                    "check its position");
    block_.base.x = float(std::floor(col));
    block_.base.y = float(std::floor(row));
    curved_ = scene::is_curved(scene_, view);
    block_.base.w = curved_ ? float(scene::bend_per_m) : 0.0f;
    // Only from outside one sees the side of water that the data cut.
    cut_water_ = wet_border_ && !(col >= 0.0 && row >= 0.0 && col <= ground.size().cols - 1 &&
                                  row <= ground.size().rows - 1);
    prepare_waves(view);
    block_.camera = {float(col - double(block_.base.x)), float(row - double(block_.base.y)),
                     float(p.z - ground.offset_m), float(pixel_rad)};
    block_.forward = glm::vec4(glm::vec3(camera.forward), block_.forward.w);
    block_.right =
        glm::vec4(glm::vec3(camera.right), float(half * settings.width_px / settings.height_px));
    block_.up = glm::vec4(glm::vec3(camera.up), float(half));

    const scene::Lighting& light = view.lighting;
    block_.sun = glm::vec4(glm::vec3(light.sun_direction), float(scene::sun_radius_rad));
    block_.sun_irradiance = glm::vec4(glm::vec3(light.sun_irradiance), 0.0f);
    block_.sky_irradiance = glm::vec4(glm::vec3(light.sky_irradiance), 0.0f);
    const scene::WaterOptics& optics = scene_.optics;
    block_.air = glm::vec4(glm::vec3(scene::air_extinction_per_m(light)),
                           float(1.0 / scene::haze_scale_height_m));
    block_.optics.x = float(optics.index);
    block_.optics.y = float(scene::greatest_path_m(optics, settings));
    upload_water(settings.spectral);
    forwards_ = scatters_forwards(view);
    const double level = scene_.lakes.front().level_m;
    block_.look = {float(scene_.look.tree_line_m - ground.offset_m),
                   float(scene_.look.snow_line_m - ground.offset_m), float(level - ground.offset_m),
                   float(settings.ground_albedo.value_or(-1.0))};
    block_.options = {float(scene::shadow_lift_m(ground)), 0.0f, 1.0f, 1.0f};

    std::uint32_t flags = 0;
    flags |= settings.shadows ? TARN_FLAG_SHADOWS : 0u;
    flags |= settings.reflection ? TARN_FLAG_REFLECTION : 0u;
    flags |= settings.mirrored_land ? TARN_FLAG_MIRRORED_LAND : 0u;
    flags |= settings.refraction ? TARN_FLAG_REFRACTION : 0u;
    flags |= settings.thrown_back ? TARN_FLAG_THROWN_BACK : 0u;
    flags |= settings.fresnel == scene::Fresnel::schlick ? TARN_FLAG_SCHLICK : 0u;
    flags |= light.sun_disc ? TARN_FLAG_SUN_DISC : 0u;
    flags |= scene_.ortho ? TARN_FLAG_ORTHO : 0u;
    if (view.overlay) {
        const scene::Overlay& o = *view.overlay;
        if (o.width_px != settings.width_px || o.height_px != rows ||
            o.pixels.size() != std::size_t(o.width_px) * std::size_t(o.height_px))
            throw Error(text("the overlay is ", o.width_px, " x ", o.height_px, ", the picture ",
                             settings.width_px, " x ", rows));
        flags |= TARN_FLAG_OVERLAY;
        overlay_ =
            gpu::Texture2D(GL_RGBA32F, o.width_px, o.height_px, 1, gpu::Filter::nearest, "overlay");
        overlay_.upload(GL_RGBA, GL_FLOAT, o.pixels.data());
        overlay_.bind(TARN_TEXTURE_OVERLAY);
    }
    block_.counts.x = static_cast<std::uint32_t>(settings.width_px);
    block_.counts.y = static_cast<std::uint32_t>(rows);
    block_.inverse_size.z = 1.0f / float(settings.width_px);
    block_.inverse_size.w = 1.0f / float(settings.height_px);
    block_.counts.z = flags;
    camera_m_ = p;
    const auto water_here = scene_.water_level_m(p.x, p.y);
    port_ = settings.port_m > 0.0 && water_here &&
            std::abs(p.z - *water_here) < settings.port_m + lift_m_;
    block_.diver = {float(settings.port_m),
                    float(settings.dive_light_cd * scene::irradiance_per_lux),
                    float(scene::lamp_beside_m),
                    settings.space_lines_lit ? 0.0f : float(scene::sign_irradiance(scene_, view))};
    lamp_ = settings.dive_light_cd > 0.0;
    locate_camera();

    if (sky_made_ != light.sky.radiance || sky_.width_px() != light.sky.azimuths) {
        sky_made_ = light.sky.radiance;
        sky_ = gpu::Texture2D(GL_RGB32F, light.sky.azimuths, light.sky.elevations, 1,
                              gpu::Filter::linear, "sky");
        sky_.upload(GL_RGB, GL_FLOAT, sky_made_.data());
        soft_sky_ = gpu::Texture2D(gpu::is_software() ? GL_RGB32F : GL_RGBA16F, light.sky.azimuths,
                                   light.sky.elevations, 1, gpu::Filter::linear, "soft sky");
        soft_sky_.upload(GL_RGB, GL_FLOAT, sky_made_.data());
    }
    if (wavy())
        soft_sky_.bind(TARN_TEXTURE_SKY_SOFT);
    if (radiance_.width_px() != settings.width_px || radiance_.height_px() != rows) {
        radiance_ =
            gpu::Texture2D(GL_RGBA32F, settings.width_px, rows, 1, gpu::Filter::nearest, "picture");
        distance_ =
            gpu::Texture2D(GL_R32F, settings.width_px, rows, 1, gpu::Filter::nearest, "distances");
    }
    const int tiles_across = (settings.width_px + 7) / 8, tiles_down = (rows + 7) / 8;
    if (beams_.width_px() != tiles_across || beams_.height_px() != tiles_down)
        beams_ =
            gpu::Texture2D(GL_R32F, tiles_across, tiles_down, 1, gpu::Filter::nearest, "beams");
    // As wide as the picture, as high as the limit allows.
    const int tile_rows = std::min(rows, std::max(8, tile_pixels / settings.width_px / 8 * 8));
    if (hits_[0].width_px() != settings.width_px || hits_[0].height_px() != tile_rows)
        for (gpu::Texture2D& hits : hits_)
            hits = gpu::Texture2D(GL_RGBA32UI, settings.width_px, tile_rows, 1,
                                  gpu::Filter::nearest, "hits");
    if (wavy() && (surfaces_.width_px() != settings.width_px || surfaces_.height_px() != tile_rows))
        surfaces_ = gpu::Texture2D(GL_RGBA32UI, settings.width_px, tile_rows, 1,
                                   gpu::Filter::nearest, "surfaces");
    if (caustics_ &&
        (sunlit_.width_px() != settings.width_px || sunlit_.height_px() != 2 * tile_rows))
        sunlit_ = gpu::Texture2D(GL_R32UI, settings.width_px, 2 * tile_rows, 1,
                                 gpu::Filter::nearest, "sunlit");
    coarse_ = settings.coarse_far_land;
    use_walk(settings.walk, settings.walk_setting);
    hazy_ = light.visibility_m.has_value();
    whole_sky_ = light.sky.whole_turn;
    const double interval = settings.contours_m.value_or(1.0);
    block_.map = {float(settings.contours_m.value_or(0.0)),
                  float(settings.depth_contours_m.value_or(0.0)),
                  float(settings.depth_colours_m.value_or(0.0)),
                  float(std::fmod(ground.offset_m, 5.0 * interval))};
    block_.exposed.z = float(int(settings.drape_on));
    mapped_ = settings.contours_m || settings.depth_contours_m || settings.depth_colours_m ||
              scene_.exposed_bed || scene_.drape;
    if (mapped_) {
        exposed_.bind(TARN_TEXTURE_EXPOSED);
        drape_.bind(TARN_TEXTURE_DRAPE);
    }
    prepare_land_shadow(view);
    use_shade();
    bounds_.prepare(walk_, false);
    if (port_)
        bounds_.prepare(walk_, true);
    bind_field(walk_, !under_water());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_LAKES, lakes_.id());
    sky_.bind(TARN_TEXTURE_SKY);
    ortho_.bind(TARN_TEXTURE_ORTHO);
    beams_.bind(TARN_TEXTURE_BEAMS);
    bind_images();
    first_row_ = settings.strip ? settings.strip->first_row : 0;
    set_sample(0, 1);
    gpu::check_gl("preparing the picture");
}

// Passes that make waves or bounds use the same few image units.
void Renderer::bind_images() {
    radiance_.bind_image(TARN_IMAGE_RADIANCE, GL_READ_WRITE);
    distance_.bind_image(TARN_IMAGE_DISTANCE, GL_WRITE_ONLY);
    beams_.bind_image(TARN_IMAGE_BEAMS, GL_WRITE_ONLY);
    for (GLuint k = 0; k < 3; ++k)
        hits_[k].bind_image(TARN_IMAGE_HITS + k, GL_READ_WRITE);
    if (wavy())
        surfaces_.bind_image(TARN_IMAGE_SURFACE, GL_READ_WRITE);
    if (caustics_)
        sunlit_.bind_image(TARN_IMAGE_SUNLIT, GL_READ_WRITE);
}

void Renderer::move_waves(double time_s) {
    if (!wavy())
        return;
    if (on_pass)
        on_pass("waves");
    waves_->move_to(time_s);
    wave_time_s_ = time_s;
    if (caustics_) {
        sunlight_.on_pass = on_pass;
        sunlight_.update(*waves_);
        sunlight_.bind();
    }
    const Heightfield& ground = scene_.ground;
    waves_->bind({ground.x_m(double(block_.base.x)), ground.y_m(double(block_.base.y))}, lift_m_);
    const bool was_under = under_water();
    locate_camera(); // a crest may have come over it
    if (under_water() != was_under)
        bind_field(walk_, !under_water());
    bind_images();
}

// In water or above it, by the waves of the moment.
void Renderer::locate_camera() {
    const glm::dvec3& p = camera_m_;
    const auto water = scene_.water_level_m(p.x, p.y);
    double surface_m = water.value_or(0.0);
    const bool between = water && wavy() && std::abs(p.z - *water) <= lift_m_;
    if (between)
        surface_m += waves_->height_at({p.x, p.y}, *water - scene_.ground.elevation_m(p.x, p.y));
    const bool under = water && p.z < surface_m;
    block_.counts.z &= ~static_cast<std::uint32_t>(TARN_FLAG_UNDER_WATER);
    if (under) {
        block_.counts.z |= TARN_FLAG_UNDER_WATER;
        block_.options.y = float(*water - scene_.ground.offset_m);
        block_.options.z = scene_.lake_at_level(*water).bed != Bed::unknown ? 1.0f : 0.0f;
    }
    // Rays that rise can enter a slab from its side, and leave it, from anywhere below its top.
    // On a curved Earth those that skim the horizon rise again.
    in_slab_ = wavy() && (under ? between : curved_ || p.z <= water_top_m_ + lift_m_);
    if (port_) {
        in_slab_ = wavy();
        find_port_heights(*water);
    }
    if (glows())
        upload_glow();
}

// The water around a camera that is half in it.
void Renderer::find_port_heights(double level_m) {
    const float level = float(level_m - scene_.ground.offset_m);
    block_.options.y = level;
    block_.options.z = scene_.lake_at_level(level_m).bed != Bed::unknown ? 1.0f : 0.0f;
    if (port_heights_.id() == 0)
        port_heights_ = gpu::Texture2D(GL_R32F, TARN_PORT_SIDE, TARN_PORT_SIDE, 1,
                                       gpu::Filter::linear, "water at the port");
    if (wavy()) {
        gpu::ComputeProgram& pass = port_passes_[waves_->defines()];
        if (pass.id() == 0)
            pass = gpu::ComputeProgram(
                gpu::load_shader(gpu::shader_root(), "passes/port.comp", {}, waves_->defines()));
        view_buffer_.write(&block_, sizeof block_);
        heights_.bind(TARN_TEXTURE_HEIGHTS);
        port_heights_.bind_image(TARN_IMAGE_BEAMS, GL_WRITE_ONLY);
        pass.use();
        glDispatchCompute(TARN_PORT_SIDE / 8, TARN_PORT_SIDE / 8, 1);
        glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    } else {
        const std::vector<float> flat(TARN_PORT_SIDE * TARN_PORT_SIDE, level);
        port_heights_.upload(GL_RED, GL_FLOAT, flat.data());
    }
    port_heights_.bind(TARN_TEXTURE_PORT);
}

void Renderer::set_sample(int sample, int samples) {
    const glm::dvec2 offset = scene::sample_offset(sample, samples);
    block_.offset = {float(offset.x), float(offset.y + first_row_), float(sample), float(lift_m_)};
    block_.options.w = 1.0f / float(samples);
}

void Renderer::draw_tile() {
    if (!port_) {
        draw_medium();
        return;
    }
    const std::uint32_t flags = block_.counts.z;
    for (const std::uint32_t under : {0u, std::uint32_t(TARN_FLAG_UNDER_WATER)}) {
        block_.counts.z = (flags & ~static_cast<std::uint32_t>(TARN_FLAG_UNDER_WATER)) | under;
        draw_medium();
    }
    block_.counts.z = flags;
}

void Renderer::draw_medium() {
    view_buffer_.write(&block_, sizeof block_);
    const GLuint across = gpu::groups(block_.tile.z), down = gpu::groups(block_.tile.w);
    constexpr GLbitfield images = GL_SHADER_IMAGE_ACCESS_BARRIER_BIT;
    const bool split = (block_.counts.z & (TARN_FLAG_REFLECTION | TARN_FLAG_REFRACTION)) != 0;
    glMemoryBarrier(images);
    const WalkPasses& calm = *calm_walk_;
    const WavyPasses* wavy_ones = wavy() ? &wavy_passes() : nullptr;
    bind_walk(!under_water()); // only from above is water met
    const auto begins = [&](const char* name) {
        if (on_pass)
            on_pass(name);
    };
    begins("primary");
    (wavy_ones ? wavy_ones->primary : calm.primary).use();
    glDispatchCompute(across, down, 1);
    glMemoryBarrier(images);
    if (wavy_ones) {
        begins("surface");
        wavy_ones->surface.use();
        glDispatchCompute(across, down, 1);
        glMemoryBarrier(images);
    }
    bind_walk(false);
    if (split) {
        begins("secondary");
        (wavy_ones ? wavy_ones->secondary : calm.secondary).use();
        glDispatchCompute(across, down, 2);
        glMemoryBarrier(images);
    }
    if ((block_.counts.z & TARN_FLAG_SHADOWS) != 0 && block_.sun.z > 0.0f) {
        begins("shadow");
        (wavy_ones ? wavy_ones->shadow : calm.shadow).use();
        glDispatchCompute(across, down, split ? 3 : 1);
        glMemoryBarrier(images);
    }
    if (caustics_) {
        if (prisms()) {
            begins("prisms");
            draw_prisms();
        }
        begins("sunlit");
        wavy_ones->sunlit.use();
        glDispatchCompute(across, down, under_water() ? 2 : 1);
        glMemoryBarrier(images);
    }
    begins("shade");
    if (space_lines_.id() != 0)
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_SPACE_LINES, space_lines_.id());
    (wavy_ones ? wavy_ones->shade : *calm_shade_).use();
    glDispatchCompute(across, down, 1);
    begins("end");
}

// Shafts for a camera in the water.
void Renderer::draw_prisms() {
    const Heightfield& ground = scene_.ground;
    const glm::dvec2 base_m(ground.x_m(double(block_.base.x)), ground.y_m(double(block_.base.y)));
    const double depth_m = std::max(double(block_.options.y) + ground.offset_m - camera_m_.z, 0.0);
    const glm::dvec3 sun(block_.sun);
    const glm::dvec3 down =
        glm::refract(-sun, glm::dvec3(0.0, 0.0, 1.0), 1.0 / double(block_.optics.x));
    PrismGrid grid = prism_grid({camera_m_.x, camera_m_.y}, base_m, glm::dvec2(down) / -down.z,
                                depth_m, prism_cells_);
    grid.top_m = -1.0 - lift_m_;
    grid.bottom_m = 2.0 * depth_m + 1.0; // below the camera views lead away from the sun
    if (!prisms_)
        prisms_.emplace();
    prisms_->draw(grid, block_.tile.z, block_.tile.w, path_defines() + waves_->defines());
    beams_.bind_image(TARN_IMAGE_BEAMS, GL_WRITE_ONLY); // shares a unit with the prisms
}

void Renderer::find_beams() {
    if (on_pass)
        on_pass("beams");
    if (port_) { // rays do not begin where beams do
        const float none = 0.0f;
        glClearTexImage(beams_.id(), 0, GL_RED, GL_FLOAT, &none);
        return;
    }
    bind_walk(!under_water());
    calm_walk_->beams.use();
    glDispatchCompute(GLuint((beams_.width_px() + 7) / 8), GLuint((beams_.height_px() + 3) / 4), 1);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

void Renderer::find_first_hits() {
    view_buffer_.write(&block_, sizeof block_);
    find_beams();
    const WalkPasses& pass = *calm_walk_;
    pass.first_hit.use();
    glDispatchCompute(gpu::groups(int(block_.counts.x)), gpu::groups(int(block_.counts.y)), 1);
}

std::vector<FieldHit> Renderer::trace_rays(std::span<const FieldRay> rays, scene::Walk walk,
                                           double setting, bool with_water, double t_max) {
    use_walk(walk, setting);
    bind_field(walk, with_water);
    std::vector<FieldHit> hits(rays.size());
    constexpr std::size_t batch = std::size_t(1) << 21; // 96 MB on the GPU
    std::vector<glm::vec4> packed;
    for (std::size_t first = 0; first < rays.size(); first += batch) {
        const std::size_t count = std::min(batch, rays.size() - first);
        packed.clear();
        for (const FieldRay& ray : rays.subspan(first, count)) {
            packed.emplace_back(ray.origin, ray.base.x);
            packed.emplace_back(ray.direction, ray.base.y);
        }
        const gpu::Buffer in(packed.size() * sizeof packed[0], packed.data());
        const gpu::Buffer out(count * sizeof(FieldHit), nullptr);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_RAYS, in.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_ANSWERS, out.id());
        calm_walk_->trace_rays.use();
        glUniform1i(0, with_water);
        glUniform1f(1, float(t_max));
        const GLuint groups_of_64 = GLuint((count + 63) / 64);
        glDispatchCompute(std::min<GLuint>(groups_of_64, 1024), (groups_of_64 + 1023) / 1024, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glGetNamedBufferSubData(out.id(), 0, GLsizeiptr(count * sizeof(FieldHit)), &hits[first]);
        gpu::check_gl("tracing rays");
    }
    return hits;
}

std::vector<float> Renderer::read_first_hits() const {
    std::vector<float> out(std::size_t(distance_.width_px()) * std::size_t(distance_.height_px()));
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    distance_.download(GL_RED, GL_FLOAT, out.data(), out.size() * sizeof(float));
    gpu::check_gl("reading first hits");
    return out;
}

void Renderer::draw_once() {
    const int width = int(block_.counts.x), height = int(block_.counts.y),
              rows = hits_[0].height_px();
    view_buffer_.write(&block_, sizeof block_);
    if (block_.offset.z == 0.0f) // beams hold whole pixels: the first sample's serve all
        find_beams();
    for (int top = 0; top < height; top += rows) {
        block_.tile = {0, top, width, std::min(rows, height - top)};
        draw_tile();
    }
}

void Renderer::draw_rows(int sample, int samples, int first_row, int rows) {
    const int width = int(block_.counts.x), last = std::min(first_row + rows, int(block_.counts.y)),
              most = hits_[0].height_px();
    set_sample(sample, samples);
    view_buffer_.write(&block_, sizeof block_);
    if (sample == 0 && first_row == 0)
        find_beams();
    for (int top = first_row; top < last; top += most) {
        block_.tile = {0, top, width, std::min(most, last - top)};
        draw_tile();
    }
}

Renderer::Blocks Renderer::blocks_of(int every) const {
    const auto count = [&](std::uint32_t pixels) {
        return (int(pixels / 8) + every - 1 - every / 2) / every;
    };
    return {8 * (every / 2), 8 * (every - 1), 8 * count(block_.counts.x),
            8 * count(block_.counts.y)};
}

void Renderer::draw_blocks(int every, bool find_new_beams) {
    if (every < 1)
        throw Error(text("every ", every, "th block is asked for, must be at least 1"));
    const Blocks blocks = blocks_of(every);
    if (blocks.width_px < 8 || blocks.height_px < 8)
        return;
    block_.walk.z = block_.walk.w = blocks.skip_px;
    const int most = std::max(8, hits_[0].height_px() / 8 * 8);
    for (int sample = 0; sample < samples_; ++sample) {
        set_sample(sample, samples_);
        view_buffer_.write(&block_, sizeof block_);
        if (sample == 0 && find_new_beams)
            find_beams();
        for (int top = 0; top < blocks.height_px; top += most) {
            block_.tile = {blocks.first_px, blocks.place(top), blocks.width_px,
                           std::min(most, blocks.height_px - top)};
            draw_tile();
        }
    }
    block_.walk.z = block_.walk.w = 0;
}

Image Renderer::read_blocks(int every) const {
    const Blocks blocks = blocks_of(every);
    const Image whole = read_back();
    Image out;
    out.width_px = blocks.width_px;
    out.height_px = blocks.height_px;
    for (int y = 0; y < out.height_px; ++y)
        for (int x = 0; x < out.width_px; ++x) {
            const std::size_t i = std::size_t(blocks.place(y)) * std::size_t(whole.width_px) +
                                  std::size_t(blocks.place(x));
            out.radiance.push_back(whole.radiance[i]);
            out.distance_m.push_back(whole.distance_m[i]);
        }
    return out;
}

Image Renderer::draw(const scene::View& view, const std::function<void(double)>& progress) {
    prepare(view);
    return draw_again(progress);
}

Image Renderer::draw_again(const std::function<void(double)>& progress) {
    for (int sample = 0; sample < samples_; ++sample) {
        set_sample(sample, samples_);
        draw_once();
        if (progress) {
            glFinish();
            progress(double(sample + 1) / samples_);
        }
    }
    return read_back();
}

Image Renderer::read_back() const {
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    Image image;
    image.width_px = radiance_.width_px();
    image.height_px = radiance_.height_px();
    const std::size_t pixels = std::size_t(image.width_px) * std::size_t(image.height_px);
    image.radiance.resize(pixels);
    image.distance_m.resize(pixels);
    radiance_.download(GL_RGB, GL_FLOAT, image.radiance.data(), pixels * sizeof(glm::vec3));
    distance_.download(GL_RED, GL_FLOAT, image.distance_m.data(), pixels * sizeof(float));
    for (float& d : image.distance_m)
        if (d >= 0.99e9f)
            d = std::numeric_limits<float>::infinity();
    gpu::check_gl("drawing the picture");
    return image;
}

} // namespace tarn::render
