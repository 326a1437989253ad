#include "render/waves.hpp"

#include "core/angles.hpp"
#include "core/text.hpp"
#include "waves/ripples.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tarn::render {

namespace {

/// Mip levels that passes/wave_surface.comp makes beside level 0.
constexpr int surface_levels = 3;
constexpr int table_rows = waves::most_cascades + 1;

/// Columns transformed side by side, so that memory is read in whole sectors; large ones must fit
/// in shared memory (32 KB are guaranteed).
int lanes_for(int texels) { return std::min(4, 2048 / texels); }

double fraction(double v) { return v - std::floor(v); }

glm::vec4 per_cascade(const std::vector<waves::Cascade>& cascades,
                      double (*value)(const waves::Cascade&)) {
    glm::vec4 out(0.0f);
    for (std::size_t j = 0; j < cascades.size(); ++j)
        out[int(j)] = float(value(cascades[j]));
    return out;
}

void set_uniform(GLint location, const glm::vec4& v) { glUniform4f(location, v.x, v.y, v.z, v.w); }

} // namespace

std::string WaveField::defines() const {
    return sea_.still()
               ? std::string()
               : text("#define TARN_WAVES 1\n#define TARN_CASCADES ", sea_.cascades.size(), "\n");
}

int WaveField::spectral() const {
    int count = 0;
    for (const waves::Cascade& c : sea_.cascades)
        count += !c.ripples;
    return count;
}

void WaveField::build_passes() {
    const int texels = sea_.cascades.front().texels;
    bool choppy = false;
    for (const waves::Cascade& c : sea_.cascades)
        choppy |= c.choppiness > 0.0;
    const int fields = choppy ? 2 : 1;
    if (passes_.texels == texels && passes_.fields == fields)
        return;
    const auto root = gpu::shader_root();
    const std::string defined =
        text("#define TARN_FFT_N ", texels, "\n#define TARN_WAVE_FIELDS ", fields, "\n");
    const std::string lanes = text("#define TARN_FFT_LANES ", lanes_for(texels), "\n");
    const auto pass = [&](const char* name, const std::string& words) {
        return gpu::ComputeProgram(gpu::load_shader(root, name, {}, words));
    };
    passes_ = {texels,
               fields,
               pass("passes/wave_rows.comp", defined),
               pass("passes/wave_columns.comp", defined + lanes),
               pass("passes/wave_surface.comp", defined),
               pass("passes/wave_levels.comp", "")};
    std::vector<glm::vec2> twiddles;
    for (int n = 0; n < texels; ++n)
        twiddles.emplace_back(std::cos(2.0 * pi * n / texels), std::sin(2.0 * pi * n / texels));
    twiddles_ = gpu::Buffer(twiddles.size() * sizeof twiddles[0], twiddles.data());
}

void WaveField::upload_spectra() {
    const std::size_t count = std::size_t(spectral());
    if (count == 0)
        return;
    const std::size_t n = std::size_t(passes_.texels), texels = n * n;
    h0_ = gpu::Buffer(texels * count * sizeof(glm::vec4), nullptr);
    turns_ = gpu::Buffer(texels * count * sizeof(std::uint32_t), nullptr);
    fields_ =
        gpu::Buffer(texels * count * std::size_t(passes_.fields) * sizeof(glm::vec4), nullptr);
    for (std::size_t j = 0; j < count; ++j) {
        const waves::Cascade& c = sea_.cascades[j];
        glNamedBufferSubData(h0_.id(), GLintptr(texels * j * sizeof(glm::vec4)),
                             GLsizeiptr(texels * sizeof(glm::vec4)), c.h0.data());
        glNamedBufferSubData(turns_.id(), GLintptr(texels * j * sizeof(std::uint32_t)),
                             GLsizeiptr(texels * sizeof(std::uint32_t)), c.turns.data());
    }
    bytes_ += texels * count * (20 + std::size_t(passes_.fields) * 16);
}

void WaveField::make_ripples() {
    ripples_.clear();
    for (const waves::Cascade& c : sea_.cascades) {
        if (!c.ripples)
            continue;
        RipplePond pond;
        pond.texels = c.texels;
        pond.texel_m = c.texel_m();
        pond.seed = sea_.settings.seed;
        if (c.window) {
            const std::vector<waves::Poke>& pokes = sea_.settings.ripples.pokes;
            double radius = pokes.front().radius_m;
            for (const waves::Poke& p : pokes) {
                pond.dents.push_back(
                    {glm::dvec2(p.x_m, p.y_m) - c.corner_m, p.height_m, p.radius_m, p.time_s});
                radius = std::min(radius, p.radius_m);
            }
            // Rings are some four radii long and run as such waves do in deep water.
            pond.speed_m_per_s = std::sqrt(waves::gravity_m_per_s2 * 4.0 * radius / (2.0 * pi));
            pond.damping_per_s = 0.3;
            pond.edge = RipplePond::Edge::absorbs;
            pond.mask = c.mask;
        } else {
            pond.speed_m_per_s = waves::ripple_speed_m_per_s;
            pond.damping_per_s = waves::ripple_damping_per_s;
            pond.drops_per_m2_s = sea_.settings.ripples.rain_drops_per_m2_s;
            pond.drop_height_m = sea_.settings.ripples.drop_height_m;
            pond.drop_radius_m = waves::drop_radius_m;
        }
        ripples_.emplace_back(pond);
    }
}

void WaveField::set(waves::Sea sea) {
    sea_ = std::move(sea);
    if (sea_.still())
        return;
    bytes_ = 0;
    const std::vector<std::uint32_t> zeros(waves::most_cascades * TARN_WAVE_LIMITS, 0u);
    limits_ = gpu::Buffer(zeros.size() * sizeof zeros[0], zeros.data());
    limits_texture_ = gpu::BufferTexture(GL_R32UI, limits_);
    if (sea_.cascades.empty()) {
        heights_ = gpu::TextureLayers(GL_R32F, 1, 1, "no waves");
        slopes_ = gpu::TextureLayers(GL_RG16F, 1, 1, "no waves");
    } else {
        build_passes();
        const int n = sea_.cascades.front().texels, layers = int(sea_.cascades.size());
        heights_ = gpu::TextureLayers(GL_R32F, n, layers, "waves");
        slopes_ = gpu::TextureLayers(GL_RG16F, n, layers, "slopes of waves");
        bytes_ = std::size_t(n) * std::size_t(n) * std::size_t(layers) * 8 * 4 / 3;
        upload_spectra();
        make_ripples();
    }
    const GridSize map = sea_.amplitude.size;
    amplitude_ =
        gpu::Texture2D(GL_RGBA8, map.cols, map.rows, 1, gpu::Filter::linear, "wave amplitudes");
    amplitude_.upload(GL_RGBA, GL_UNSIGNED_BYTE, sea_.amplitude.values.data());
    const int columns = std::max(TARN_WAVE_LEVELS, int(sea_.sines.size()));
    table_ = gpu::Texture2D(GL_RGBA32F, columns, table_rows, 1, gpu::Filter::nearest, "wave table");
    table_texels_.assign(std::size_t(columns * table_rows), glm::vec4(0.0f));
    for (std::size_t j = 0; j < sea_.cascades.size(); ++j)
        for (int level = 0; level < TARN_WAVE_LEVELS; ++level) {
            const waves::SlopeCovariance& s = sea_.cascades[j].unresolved[std::size_t(level)];
            table_texels_[j * std::size_t(columns) + std::size_t(level)] = {
                float(s.xx), float(s.xy), float(s.yy), 0.0f};
        }
    table_.upload(GL_RGBA, GL_FLOAT, table_texels_.data());
    last_block_ = {};
    block_ = gpu::Buffer(sizeof(shared::WaveBlock), &last_block_);
    gpu::check_gl("uploading the waves");
}

void WaveField::transform_spectra(const std::function<void(const char*)>& begins) {
    const int n = passes_.texels, count = spectral();
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_WAVE_H0, h0_.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_WAVE_TURNS, turns_.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_WAVE_FIELDS, fields_.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_TWIDDLES, twiddles_.id());
    begins("rows");
    passes_.rows.use();
    glUniform1ui(0, waves::loop_fraction(time_s_, sea_.settings.loop_s));
    set_uniform(1, per_cascade(sea_.cascades,
                               [](const waves::Cascade& c) { return 2.0 * pi / c.patch_m; }));
    glDispatchCompute(GLuint(n), GLuint(count), 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    begins("columns");
    passes_.columns.use();
    glDispatchCompute(GLuint(n / lanes_for(n)), GLuint(count * passes_.fields), 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    begins("surface");
    passes_.surface.use();
    set_uniform(0,
                per_cascade(sea_.cascades, [](const waves::Cascade& c) { return c.choppiness; }));
    set_uniform(1, per_cascade(sea_.cascades, [](const waves::Cascade& c) { return c.bound_m; }));
    set_uniform(
        2, per_cascade(sea_.cascades, [](const waves::Cascade& c) { return 1.0 / c.texel_m(); }));
    for (int level = 0; level <= surface_levels; ++level) {
        heights_.bind_image(GLuint(TARN_IMAGE_WAVE_HEIGHTS + level), GL_WRITE_ONLY, level);
        slopes_.bind_image(GLuint(TARN_IMAGE_WAVE_SLOPES + level), GL_WRITE_ONLY, level);
    }
    glDispatchCompute(gpu::groups(n, 16), gpu::groups(n, 16), GLuint(count));
}

void WaveField::make_levels(int source, int first_layer, int layers) {
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    const int made = std::min(4, heights_.levels() - 1 - source);
    for (int k = 0; k < 4; ++k) {
        const int level = source + 1 + std::min(k, made - 1);
        heights_.bind_image(GLuint(TARN_IMAGE_WAVE_HEIGHTS + k), GL_WRITE_ONLY, level);
        slopes_.bind_image(GLuint(TARN_IMAGE_WAVE_SLOPES + k), GL_WRITE_ONLY, level);
    }
    glUniform1i(0, source);
    glUniform1i(1, made);
    glUniform1i(3, first_layer);
    const GLuint across = gpu::groups(std::max(heights_.side_px() >> source, 1), 16);
    glDispatchCompute(across, across, GLuint(layers));
}

void WaveField::move_to(double time_s) {
    time_s_ = time_s;
    if (sea_.cascades.empty())
        return;
    const std::function<void(const char*)> begins = [this](const char* name) {
        if (on_pass)
            on_pass(name);
    };
    const int count = spectral();
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TARN_BUFFER_WAVE_LIMITS, limits_.id());
    if (count > 0)
        transform_spectra(begins);
    if (!ripples_.empty()) {
        begins("ripples");
        const GLintptr own = GLintptr(count) * TARN_WAVE_LIMITS * GLintptr(sizeof(GLuint));
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glClearNamedBufferSubData(limits_.id(), GL_R32UI, own,
                                  GLsizeiptr(ripples_.size() * TARN_WAVE_LIMITS * sizeof(GLuint)),
                                  GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
        int layer = count;
        for (Ripples& ripples : ripples_) {
            ripples.move_to(time_s);
            ripples.write_layer(heights_, slopes_, layer,
                                sea_.cascades[std::size_t(layer)].bound_m);
            ++layer;
        }
    }
    begins("levels");
    passes_.levels.use();
    heights_.bind(TARN_TEXTURE_WAVES);
    slopes_.bind(TARN_TEXTURE_SLOPES);
    set_uniform(
        2, per_cascade(sea_.cascades, [](const waves::Cascade& c) { return 1.0 / c.texel_m(); }));
    // Those of a spectrum have their first levels already.
    if (!ripples_.empty())
        make_levels(0, count, int(ripples_.size()));
    for (int source = surface_levels; source + 1 < heights_.levels(); source += 4)
        make_levels(source, 0, int(sea_.cascades.size()));
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    begins("end");
}

void WaveField::bind(glm::dvec2 base, double lift_m) {
    shared::WaveBlock block{};
    double window = -1.0;
    for (std::size_t j = 0; j < sea_.cascades.size(); ++j) {
        const waves::Cascade& c = sea_.cascades[j];
        const double half = 0.5 / c.texels; // a texel's value belongs to its middle
        const glm::dvec2 place = (base - c.corner_m) / c.patch_m;
        block.patches[j] = {float((c.window ? place.x : fraction(place.x)) + half),
                            float((c.window ? place.y : fraction(place.y)) + half),
                            float(c.patch_m), float(c.texel_m())};
        if (c.window)
            window = double(j);
    }
    double height = 0.0, slope = 0.0;
    const std::size_t columns = table_texels_.size() / table_rows;
    for (std::size_t i = 0; i < sea_.sines.size(); ++i) {
        const waves::SineWave& w = sea_.sines[i];
        const double phase = w.k_per_m.x * base.x + w.k_per_m.y * base.y + w.phase_rad -
                             std::fmod(w.omega_per_s * time_s_, 2.0 * pi);
        table_texels_[waves::most_cascades * columns + i] = {float(w.k_per_m.x), float(w.k_per_m.y),
                                                             float(w.amplitude_m),
                                                             float(std::fmod(phase, 2.0 * pi))};
        height += w.amplitude_m;
        slope += w.amplitude_m * std::hypot(w.k_per_m.x, w.k_per_m.y);
    }
    if (!sea_.sines.empty())
        table_.upload(GL_RGBA, GL_FLOAT, table_texels_.data());
    block.counts = {float(sea_.sines.size()), float(height), float(slope), float(lift_m)};
    block.shore = {float(std::max(sea_.full_depth_m, 1e-6)), float(window), 0, 0};
    const GridSize map = sea_.amplitude.size;
    const double wide = map.cols * sea_.amplitude_side_m, high = map.rows * sea_.amplitude_side_m;
    block.map = {float((base.x - sea_.amplitude_west_m) / wide),
                 float((sea_.amplitude_north_m - base.y) / high), float(1.0 / wide),
                 float(-1.0 / high)};
    block.rough = {float(sea_.roughness.xx), float(sea_.roughness.xy), float(sea_.roughness.yy),
                   float(std::max(spectral() - 1, 0))};
    if (std::memcmp(&block, &last_block_, sizeof block) != 0) {
        block_.write(&block, sizeof block);
        last_block_ = block;
    }
    glBindBufferBase(GL_UNIFORM_BUFFER, TARN_BLOCK_WAVES, block_.id());
    heights_.bind(TARN_TEXTURE_WAVES);
    slopes_.bind(TARN_TEXTURE_SLOPES);
    amplitude_.bind(TARN_TEXTURE_AMPLITUDE);
    table_.bind(TARN_TEXTURE_WAVE_TABLE);
    limits_texture_.bind(TARN_TEXTURE_WAVE_LIMITS);
}

double WaveField::height_at(glm::dvec2 place, double depth_m) const {
    const double fade = std::clamp(depth_m / std::max(sea_.full_depth_m, 1e-6), 0.0, 1.0);
    const auto share = [&](std::size_t j) {
        const GridSize size = sea_.amplitude.size;
        const double col = (place.x - sea_.amplitude_west_m) / sea_.amplitude_side_m - 0.5;
        const double row = (sea_.amplitude_north_m - place.y) / sea_.amplitude_side_m - 0.5;
        const auto at = [&](int c, int r) {
            return sea_.amplitude[{std::clamp(c, 0, size.cols - 1),
                                   std::clamp(r, 0, size.rows - 1)}][j] /
                   255.0;
        };
        const int c = int(std::floor(col)), r = int(std::floor(row));
        const double u = col - c, v = row - r;
        return (at(c, r) * (1 - u) + at(c + 1, r) * u) * (1 - v) +
               (at(c, r + 1) * (1 - u) + at(c + 1, r + 1) * u) * v;
    };
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    double sum = 0.0;
    for (std::size_t j = 0; j < sea_.cascades.size(); ++j) {
        const waves::Cascade& c = sea_.cascades[j];
        const int n = c.texels;
        const glm::dvec2 in = (place - c.corner_m) / c.patch_m;
        if (c.window && (in.x < 0.0 || in.y < 0.0 || in.x >= 1.0 || in.y >= 1.0))
            continue;
        const double x = fraction(in.x) * n, y = fraction(in.y) * n;
        const int i = int(x) % n, k = int(y) % n;
        const double u = x - std::floor(x), v = y - std::floor(y);
        float corner[4];
        for (int q = 0; q < 4; ++q) // one texel each: the corners may lie on opposite edges
            glGetTextureSubImage(heights_.id(), 0, (i + q % 2) % n, (k + q / 2) % n, GLint(j), 1, 1,
                                 1, GL_RED, GL_FLOAT, sizeof corner[q], &corner[q]);
        sum += share(j) * ((corner[0] * (1 - u) + corner[1] * u) * (1 - v) +
                           (corner[2] * (1 - u) + corner[3] * u) * v);
    }
    for (const waves::SineWave& w : sea_.sines)
        sum += share(0) * w.amplitude_m *
               std::cos(w.k_per_m.x * place.x + w.k_per_m.y * place.y + w.phase_rad -
                        std::fmod(w.omega_per_s * time_s_, 2.0 * pi));
    return fade * sum;
}

std::vector<glm::vec3> WaveField::read(int cascade) const {
    const std::size_t texels = std::size_t(heights_.side_px()) * std::size_t(heights_.side_px());
    const std::size_t all = texels * std::size_t(heights_.layers());
    std::vector<float> heights(all), slopes(2 * all);
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    heights_.download(0, GL_RED, GL_FLOAT, heights.data(), heights.size() * sizeof heights[0]);
    slopes_.download(0, GL_RG, GL_FLOAT, slopes.data(), slopes.size() * sizeof slopes[0]);
    gpu::check_gl("reading the waves");
    std::vector<glm::vec3> out;
    for (std::size_t i = texels * std::size_t(cascade); i < texels * std::size_t(cascade + 1); ++i)
        out.emplace_back(heights[i], slopes[2 * i], slopes[2 * i + 1]);
    return out;
}

double WaveField::least_eigenvalue(int cascade) {
    const std::string defined =
        text("#define TARN_FFT_N ", passes_.texels, "\n#define TARN_WAVE_FIELDS ", passes_.fields,
             "\n#define TARN_MEASURE_FOLDS 1\n");
    gpu::ComputeProgram other(
        gpu::load_shader(gpu::shader_root(), "passes/wave_surface.comp", {}, defined));
    std::swap(other, passes_.surface);
    move_to(time_s_);
    std::swap(other, passes_.surface);
    return 1.0 - limits(cascade)[TARN_WAVE_LEVELS + 1];
}

std::vector<double> WaveField::limits(int cascade) const {
    float values[waves::most_cascades * TARN_WAVE_LIMITS];
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(limits_.id(), 0, sizeof values, values);
    const float* first = values + cascade * TARN_WAVE_LIMITS;
    return {first, first + TARN_WAVE_LIMITS};
}

} // namespace tarn::render
