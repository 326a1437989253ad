#include "render/renderer.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace tarn::render {

namespace {

GLuint groups(int items) { return static_cast<GLuint>((items + 7) / 8); }

/// Pixels of a tile at most: what the passes hand to each other takes 48 bytes a pixel.
constexpr int tile_pixels = 1 << 22;

int next_power_of_two(int n) {
    int p = 1;
    while (p < n)
        p *= 2;
    return p;
}

} // namespace

Renderer::Renderer(const scene::Scene& scene)
    : scene_(scene), view_buffer_(sizeof(shared::ViewBlock), nullptr) {
    const auto root = gpu::shader_root();
    block_maxima_ = gpu::ComputeProgram(gpu::load_shader(root, "passes/block_maxima.comp"));
    reduce_maxima_ = gpu::ComputeProgram(gpu::load_shader(root, "passes/reduce_maxima.comp"));
    primary_ = gpu::ComputeProgram(gpu::load_shader(root, "passes/primary.comp"));
    secondary_ = gpu::ComputeProgram(gpu::load_shader(root, "passes/secondary.comp"));
    shadow_ = gpu::ComputeProgram(gpu::load_shader(root, "passes/shadow.comp"));
    shade_ = gpu::ComputeProgram(gpu::load_shader(root, "passes/shade.comp"));
    upload_scene();
    build_maxima();
}

void Renderer::upload_scene() {
    const Heightfield& ground = scene_.ground;
    const Heightfield& water = scene_.water;
    const GridSize size = ground.size();
    heights_ =
        gpu::Texture2D(GL_RG16, size.cols, size.rows, 1, gpu::Filter::nearest, "height field");
    std::vector<std::uint16_t> packed(2 * size.count());
    for (std::size_t i = 0; i < size.count(); ++i) {
        packed[2 * i] = ground.codes.values[i];
        packed[2 * i + 1] = water.codes.values[i];
    }
    heights_.upload(GL_RG, GL_UNSIGNED_SHORT, packed.data());

    // Heights on the GPU count from the ground's offset: float32 then resolves a fraction of a
    // code even for relief at some kilometres of altitude.
    block_.heights = {float(ground.offset_m), float(ground.scale_m * 65535.0),
                      float(water.offset_m - ground.offset_m), float(water.scale_m * 65535.0)};
    double top = ground.max_elevation_m();
    std::vector<glm::vec4> lakes;
    for (const LakeRecord& lake : scene_.lakes) {
        top = std::max(top, lake.level_m);
        lakes.emplace_back(float(lake.level_m - ground.offset_m), lake.bed != Bed::unknown, 0, 0);
    }
    std::sort(lakes.begin(), lakes.end(),
              [](const glm::vec4& a, const glm::vec4& b) { return a.x < b.x; });
    lakes_ = gpu::Buffer(lakes.size() * sizeof lakes[0], lakes.data());
    block_.grid = {float(size.cols), float(size.rows), float(ground.spacing_m),
                   float(top - ground.offset_m)};
    block_.counts.w = static_cast<std::uint32_t>(lakes.size());
    block_.forward.w = float(scene::block_bottom_m(ground) - ground.offset_m);

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

void Renderer::build_maxima() {
    const int cells = std::max(int(block_.grid.x), int(block_.grid.y)) - 1;
    root_level_ = 1;
    while ((1 << (2 * root_level_)) < cells)
        ++root_level_;
    const int wide = next_power_of_two((int(block_.grid.x) - 1 + 3) / 4);
    const int high = next_power_of_two((int(block_.grid.y) - 1 + 3) / 4);
    const int levels = 2 * (root_level_ - 1) + 1;
    // The root's one texel must exist: pad the longer side up to a power of four blocks.
    const int side = 1 << (2 * (root_level_ - 1));
    const int w = wide >= high ? std::max(wide, side) : wide;
    const int h = high > wide ? std::max(high, side) : high;
    maxima_ = gpu::Texture2D(GL_RG32F, w, h, levels, gpu::Filter::nearest, "block maxima");
    block_.walk = {root_level_, int(8 * (block_.grid.x + block_.grid.y) + 256), 0, 0};
    view_buffer_.write(&block_, sizeof block_);
    bind_field();
    block_maxima_.use();
    maxima_.bind_image(TARN_IMAGE_MAXIMA, GL_WRITE_ONLY, 0);
    glDispatchCompute(groups(w), groups(h), 1);
    reduce_maxima_.use();
    for (int level = 0; level + 1 < levels; ++level) {
        glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
        maxima_.bind_image(TARN_IMAGE_MAXIMA, GL_WRITE_ONLY, level + 1);
        glUniform1i(0, level);
        glDispatchCompute(groups(std::max(1, w >> (level + 1))),
                          groups(std::max(1, h >> (level + 1))), 1);
    }
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    gpu::check_gl("building the block maxima");
}

void Renderer::bind_field() const {
    glBindBufferBase(GL_UNIFORM_BUFFER, TARN_BLOCK_VIEW, view_buffer_.id());
    heights_.bind(TARN_TEXTURE_HEIGHTS);
    maxima_.bind(TARN_TEXTURE_MAXIMA);
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
    const glm::dvec3& p = camera.position;
    const double col = ground.col(p.x), row = ground.row(p.y);
    if (!(std::abs(col) < 1e9 && std::abs(row) < 1e9 && std::abs(p.z) < 1e9))
        throw Error("the camera is too far away from the scene", "check its position");
    block_.walk.z = int(std::floor(col));
    block_.walk.w = int(std::floor(row));
    block_.camera = {float(col - std::floor(col)), float(row - std::floor(row)),
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
    block_.attenuation = glm::vec4(glm::vec3(optics.attenuation_per_m()), float(optics.index));
    block_.backscattering = glm::vec4(glm::vec3(optics.backscattering_per_m),
                                      float(scene::greatest_path_m(optics, settings)));
    const double level = scene_.lakes.front().level_m;
    block_.look = {float(scene_.look.tree_line_m - ground.offset_m),
                   float(scene_.look.snow_line_m - ground.offset_m), float(level - ground.offset_m),
                   float(settings.ground_albedo.value_or(-1.0))};
    block_.options = {float(scene::shadow_lift_m(ground)), 0.0f, 1.0f, 1.0f};

    std::uint32_t flags = 0;
    flags |= settings.shadows ? TARN_FLAG_SHADOWS : 0u;
    flags |= settings.reflection ? TARN_FLAG_REFLECTION : 0u;
    flags |= settings.refraction ? TARN_FLAG_REFRACTION : 0u;
    flags |= settings.fresnel == scene::Fresnel::schlick ? TARN_FLAG_SCHLICK : 0u;
    flags |= light.sun_disc ? TARN_FLAG_SUN_DISC : 0u;
    flags |= scene_.ortho ? TARN_FLAG_ORTHO : 0u;
    const auto water = scene_.water_level_m(p.x, p.y);
    if (water && p.z < *water) {
        flags |= TARN_FLAG_UNDER_WATER;
        block_.options.y = float(*water - ground.offset_m);
        block_.options.z = scene_.lake_at_level(*water).bed != Bed::unknown ? 1.0f : 0.0f;
    }
    block_.counts.x = static_cast<std::uint32_t>(settings.width_px);
    block_.counts.y = static_cast<std::uint32_t>(settings.height_px);
    block_.counts.z = flags;

    sky_ = gpu::Texture2D(GL_RGB32F, light.sky.azimuths, light.sky.elevations, 1,
                          gpu::Filter::linear, "sky");
    sky_.upload(GL_RGB, GL_FLOAT, light.sky.radiance.data());
    if (radiance_.width_px() != settings.width_px || radiance_.height_px() != settings.height_px) {
        radiance_ = gpu::Texture2D(GL_RGBA32F, settings.width_px, settings.height_px, 1,
                                   gpu::Filter::nearest, "picture");
        distance_ = gpu::Texture2D(GL_R32F, settings.width_px, settings.height_px, 1,
                                   gpu::Filter::nearest, "distances");
    }
    // As wide as the picture, as high as the limit allows.
    const int tile_rows =
        std::min(settings.height_px, std::max(8, tile_pixels / settings.width_px));
    if (hits_[0].width_px() != settings.width_px || hits_[0].height_px() != tile_rows)
        for (gpu::Texture2D& hits : hits_)
            hits = gpu::Texture2D(GL_RGBA32UI, settings.width_px, tile_rows, 1,
                                  gpu::Filter::nearest, "hits");
    for (GLuint k = 0; k < 3; ++k)
        hits_[k].bind_image(TARN_IMAGE_HITS + k, GL_READ_WRITE);
    bind_field();
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_LAKES, lakes_.id());
    sky_.bind(TARN_TEXTURE_SKY);
    ortho_.bind(TARN_TEXTURE_ORTHO);
    radiance_.bind_image(TARN_IMAGE_RADIANCE, GL_READ_WRITE);
    distance_.bind_image(TARN_IMAGE_DISTANCE, GL_WRITE_ONLY);
    set_sample(0, 1);
    gpu::check_gl("preparing the picture");
}

void Renderer::set_sample(int sample, int samples) {
    const glm::dvec2 offset = scene::sample_offset(sample, samples);
    block_.offset = {float(offset.x), float(offset.y), float(sample), 0.0f};
    block_.options.w = 1.0f / float(samples);
}

void Renderer::draw_tile() {
    view_buffer_.write(&block_, sizeof block_);
    const GLuint across = groups(block_.tile.z), down = groups(block_.tile.w);
    constexpr GLbitfield images = GL_SHADER_IMAGE_ACCESS_BARRIER_BIT;
    const bool split = (block_.counts.z & (TARN_FLAG_REFLECTION | TARN_FLAG_REFRACTION)) != 0;
    glMemoryBarrier(images);
    primary_.use();
    glDispatchCompute(across, down, 1);
    glMemoryBarrier(images);
    if (split) {
        secondary_.use();
        glDispatchCompute(across, down, 2);
        glMemoryBarrier(images);
    }
    if ((block_.counts.z & TARN_FLAG_SHADOWS) != 0 && block_.sun.z > 0.0f) {
        shadow_.use();
        glDispatchCompute(across, down, split ? 3 : 1);
        glMemoryBarrier(images);
    }
    shade_.use();
    glDispatchCompute(across, down, 1);
}

void Renderer::draw_once() {
    const int width = int(block_.counts.x), height = int(block_.counts.y),
              rows = hits_[0].height_px();
    for (int top = 0; top < height; top += rows) {
        block_.tile = {0, top, width, std::min(rows, height - top)};
        draw_tile();
    }
}

Image Renderer::draw(const scene::View& view, const std::function<void(double)>& progress) {
    prepare(view);
    for (int sample = 0; sample < samples_; ++sample) {
        set_sample(sample, samples_);
        draw_once();
        if (progress) {
            glFinish();
            progress(double(sample + 1) / samples_);
        }
    }
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
