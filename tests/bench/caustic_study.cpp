// How near the ways to gather sunlight below waves come to many photons, and what each costs:
// figures and plots of docs/physics/caustics.md. Writes data files and pictures for
// scripts/caustic-study.
//
//   tarn_caustic_study FOLDER [methods|disc]    with a word, nothing but those tables
#include "bench/timing.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "reference/caustics.hpp"
#include "render/sunlight.hpp"
#include "scene/samples.hpp"
#include "support/sunlit_sea.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <iostream>
#include <memory>

using namespace tarn;
using test_support::sun_at, test_support::surface_of;

namespace {

waves::Sea sea_of(double wind_m_per_s, int texels = 512) {
    static const scene::Scene tank = scene::tank();
    waves::Settings s;
    s.model = waves::Model::jonswap;
    s.wind_m_per_s = wind_m_per_s;
    s.fetch_m = 3000.0;
    s.depth_m = 20.0;
    s.texels = texels;
    waves::Sea sea = waves::make_sea(tank.ground, tank.water, tank.lakes, s);
    std::fill(sea.amplitude.values.begin(), sea.amplitude.values.end(),
              std::array<std::uint8_t, 4>{255, 255, 255, 255});
    return sea;
}

struct Likeness {
    double l1, contrast, expected_contrast, mean;
};

Likeness compare(const std::vector<float>& got, const std::vector<double>& expected) {
    double off = 0.0, mean = 0.0, m2 = 0.0, g = 0.0, g2 = 0.0;
    for (std::size_t i = 0; i < got.size(); ++i) {
        off += std::abs(got[i] - expected[i]);
        mean += expected[i];
        m2 += expected[i] * expected[i];
        g += got[i];
        g2 += double(got[i]) * got[i];
    }
    const double n = double(got.size());
    mean /= n;
    g /= n;
    return {off / n / mean, std::sqrt(std::max(g2 / n - g * g, 0.0)) / g,
            std::sqrt(std::max(m2 / n - mean * mean, 0.0)) / mean, g};
}

/// Sunlight as a picture looks it up, on a square whose corner the beam through the origin meets.
class LookUp {
public:
    explicit LookUp(const render::WaveField& field)
        : program_(gpu::expand_shader(
              gpu::shader_root(),
              "#version 450 core\n" + field.defines() +
                  "#include \"lib/waves.glsl\"\n#include \"lib/caustics.glsl\"\n"
                  "layout(local_size_x = 8, local_size_y = 8) in;\n"
                  "layout(binding = TARN_TEXTURE_SUNLIGHT) uniform sampler2DArray tiles;\n"
                  "layout(binding = TARN_BLOCK_SUNLIGHT, std140) uniform Sunlight { SunlightBlock "
                  "light; };\n"
                  "layout(binding = TARN_BLOCK_WAVES, std140) uniform Waves { WaveBlock waves; };\n"
                  "layout(binding = 0, std430) writeonly buffer Out { float result[]; };\n"
                  "layout(location = 0) uniform vec4 square;\n" // side, depth, texels, corner
                  "void main() { ivec2 at = ivec2(gl_GlobalInvocationID.xy);\n"
                  "vec2 place = square.w + (vec2(at) + 0.5) * square.x / square.z + "
                  "square.y * light.beam.xy;\n"
                  "result[at.y * int(square.z) + at.x] = sun_focus(tiles, light, waves, place, "
                  "square.y, vec4(1.0), square.x / square.z); }\n",
              "<look>")) {}

    /// texels x texels, row = y. Tiles, waves and their block are bound.
    std::vector<float> operator()(double side_m, double depth_m, int texels,
                                  double corner_m = 0.0) const {
        std::vector<float> out(std::size_t(texels) * std::size_t(texels));
        const gpu::Buffer buffer(out.size() * sizeof(float), nullptr);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer.id());
        program_.use();
        glUniform4f(0, float(side_m), float(depth_m), float(texels), float(corner_m));
        glDispatchCompute(gpu::groups(texels), gpu::groups(texels), 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glGetNamedBufferSubData(buffer.id(), 0, GLsizeiptr(out.size() * sizeof(float)), out.data());
        return out;
    }

private:
    gpu::ComputeProgram program_;
};

void write_pfm(const std::filesystem::path& path, const std::vector<double>& values, int side) {
    std::ofstream out(path, std::ios::binary);
    out << "Pf\n" << side << " " << side << "\n-1.0\n";
    for (const double v : values) {
        const float f = float(v);
        out.write(reinterpret_cast<const char*>(&f), 4);
    }
}

/// A way to fill a tile, and how many photons a side of a wave's texel it takes.
struct Way {
    scene::CausticsMethod method;
    int photons;
    std::string photons_said() const {
        return method.caustics == scene::Caustics::splat ? text(photons) : "";
    }
};

std::vector<Way> all_ways() {
    std::vector<Way> out;
    for (const scene::CausticsMethod& method : scene::caustics_methods())
        for (const int photons : {1, 2, 4})
            if (method.caustics != scene::Caustics::off &&
                (photons == 1 || method.caustics == scene::Caustics::splat))
                out.push_back({method, photons});
    return out;
}

using Depths = std::map<int, std::vector<double>>; ///< sunlight by slice

/// "1.5, 1.9, 2.2": how far photons are from others of them [%].
std::string photons_against_photons(const Depths& photons, const Depths& others) {
    std::string out;
    for (const auto& [slice, light] : others)
        out += (out.empty() ? "" : ", ") +
               fixed(100.0 * compare({light.begin(), light.end()}, photons.at(slice)).l1, 1);
    return out;
}

/// Each method's tiles of one cascade against photons by the hundred, and the time that a step of
/// all takes.
void methods(const std::filesystem::path& folder) {
    std::ofstream data(folder / "methods.dat");
    std::cout << "| method | photons a side of a wave's texel | texels a side | ms | off at ";
    const int cascade = 1;
    const glm::dvec3 sun = sun_at(50.0);
    const waves::Sea sea = sea_of(4.0);
    waves::Sea one = sea;
    one.cascades = {sea.cascades[cascade]};
    const waves::Cascade& own = one.cascades[0];
    const auto surface = reference::tabulated(surface_of(one), {0, 0}, own.patch_m, 1024);
    render::WaveField field;
    field.set(sea);
    field.move_to(0.0);
    const std::vector<int> slices = {2, 6, 8, 11};
    render::SunlightVolume tiles;
    tiles.set(sea, {.sun = sun});
    for (const int slice : slices)
        std::cout << fixed(tiles.slice_depth_m(cascade, slice), 1)
                  << (slice == slices.back() ? " m | flux |\n" : ", ");
    std::cout << "| --- | --- | --- | --- | --- | --- |\n";
    for (const int side : {128, 256}) {
        Depths photons, others;
        for (const int slice : slices)
            for (const bool other : {false, true})
                (other ? others : photons)[slice] = reference::sunlight_by_photons(
                    surface, {.sun = sun, .photons_a_side = 3072 / side, .seed = other},
                    {.corner_m = glm::dvec2(-0.5 * own.texel_m()),
                     .side_m = own.patch_m,
                     .texels = side},
                    tiles.slice_depth_m(cascade, slice));
        for (const Way& way : all_ways()) {
            tiles.set(sea, {.sun = sun,
                            .method = way.method.caustics,
                            .texels = side,
                            .photons = way.photons});
            const bench::Times t =
                bench::time_on_gpu([&] { tiles.update(field); }, gpu::is_software() ? 3 : 31);
            std::cout << "| " << way.method.name << " | " << way.photons_said() << " | " << side
                      << " | " << fixed(t.median_ms, 3) << " | ";
            double worst = 0.0, low = 1e9, high = 0.0;
            for (const int slice : slices) {
                const Likeness l = compare(tiles.read(cascade, slice), photons[slice]);
                std::cout << fixed(100.0 * l.l1, 1) << (slice == slices.back() ? " % | " : ", ");
                worst = std::max(worst, l.l1);
                low = std::min(low, l.mean);
                high = std::max(high, l.mean);
                if (slice == 8)
                    data << way.method.name << (way.photons > 1 ? text("-", way.photons) : "")
                         << " " << side << " " << t.median_ms << " " << 100.0 * l.l1 << "\n";
            }
            std::cout << fixed(low, 3) << " to " << fixed(high, 3) << " |" << std::endl;
        }
        std::cout << "| photons against others of them | | " << side << " | | "
                  << photons_against_photons(photons, others) << " % | |\n";
    }
}

/// The same as pictures see it: the sun is no point, and its own width blurs what its light draws.
/// Each method's tiles as they are looked up, against photons from all of the disc.
void under_the_disc() {
    const int cascade = 1, side = 256;
    const glm::dvec3 sun = sun_at(50.0);
    waves::Sea one = sea_of(4.0);
    one.cascades = {one.cascades[cascade]};
    one.roughness = {};
    const waves::Cascade& own = one.cascades[0];
    const auto surface = reference::tabulated(surface_of(one), {0, 0}, own.patch_m, 1024);
    render::WaveField field;
    field.set(one);
    field.move_to(0.0);
    field.bind({0.0, 0.0}, 0.5);
    const LookUp look(field);
    const double corner = -0.5 * own.texel_m(); // middles of texels, where nothing is interpolated
    render::SunlightVolume tiles;
    tiles.set(one, {.sun = sun});
    const std::vector<int> slices = {2, 5, 6, 8, 11};
    Depths photons, others;
    std::cout << "\n| with the sun's width | photons on a side | off at ";
    for (const int slice : slices) {
        std::cout << fixed(tiles.slice_depth_m(0, slice), 1)
                  << (slice == slices.back() ? " m |\n| --- | --- | --- |\n" : ", ");
        for (const bool other : {false, true})
            (other ? others : photons)[slice] = reference::sunlight_by_photons(
                surface,
                {.sun = sun,
                 .disc_rad = scene::sun_radius_rad,
                 .photons_a_side = 16,
                 .seed = other},
                {.corner_m = glm::dvec2(corner), .side_m = own.patch_m, .texels = side},
                tiles.slice_depth_m(0, slice));
    }
    for (const Way& way : all_ways()) {
        tiles.set(one, {.sun = sun, .method = way.method.caustics, .photons = way.photons});
        tiles.update(field);
        tiles.bind();
        field.bind({0.0, 0.0}, 0.5);
        std::cout << "| " << way.method.name << " | " << way.photons_said() << " | ";
        for (const int slice : slices)
            std::cout << fixed(100.0 * compare(look(own.patch_m, tiles.slice_depth_m(0, slice),
                                                    side, corner),
                                               photons[slice])
                                           .l1,
                               1)
                      << (slice == slices.back() ? " % |" : ", ");
        std::cout << std::endl;
    }
    std::cout << "| photons against others of them | | " << photons_against_photons(photons, others)
              << " % |\n";
}

/// How often sunlight is how strong below all the waves: after Dera, as in Tessendorf's figure 29.
void distributions(const std::filesystem::path& folder) {
    std::ofstream data(folder / "distribution.dat");
    const waves::Sea sea = sea_of(4.0);
    for (const double depth : {2.0, 10.0}) {
        const double side = 4.0, around = side + depth + 1.0;
        const auto surface =
            reference::tabulated(surface_of(sea), glm::dvec2(-0.5 * (around - side)), around,
                                 std::min(1536, int(around / 0.004)));
        const int texels = 256;
        const auto light = reference::sunlight_by_photons(
            surface,
            {.sun = sun_at(80.0),
             .disc_rad = scene::sun_radius_rad,
             .photons_a_side = 8,
             .steepest = 0.6},
            {.corner_m = {0, 0}, .side_m = side, .texels = texels, .periodic = false}, depth);
        std::vector<int> count(60);
        double mean = 0.0, m2 = 0.0, m3 = 0.0;
        for (const double v : light) {
            ++count[std::size_t(std::clamp(v * 10.0, 0.0, 59.0))];
            mean += v / double(light.size());
        }
        for (const double v : light) {
            m2 += std::pow(v - mean, 2) / double(light.size());
            m3 += std::pow(v - mean, 3) / double(light.size());
        }
        std::cout << "depth " << depth << " m: contrast " << fixed(std::sqrt(m2) / mean, 2)
                  << ", skewness " << fixed(m3 / std::pow(m2, 1.5), 2) << "\n";
        for (std::size_t i = 0; i < count.size(); ++i)
            data << 0.1 * (double(i) + 0.5) << " " << 10.0 * count[i] / double(light.size())
                 << "\n";
        data << "\n\n";
    }
}

/// The product of the cascades' tiles as a picture looks it up, against photons through all the
/// waves together.
void whole_sea(const std::filesystem::path& folder) {
    std::cout << "\n| wind [m/s] | depth [m] | contrast | of photons | off (relative L1) | mean |\n"
                 "| --- | --- | --- | --- | --- | --- |\n";
    const glm::dvec3 sun = sun_at(50.0);
    for (const double wind : {2.0, 4.0, 8.0}) {
        const waves::Sea sea = sea_of(wind);
        render::WaveField field;
        field.set(sea);
        field.move_to(0.0);
        field.bind({0.0, 0.0}, 0.5);
        render::SunlightVolume tiles;
        tiles.set(sea, {.sun = sun, .slices = 20});
        tiles.update(field);
        tiles.bind();
        const LookUp look(field);
        for (const double depth : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0}) {
            const int texels = 128;
            const double side = std::clamp(depth, 1.0, 8.0);
            const std::vector<float> got = look(side, depth, texels);
            // Photons come from beside the square, too: the surface is tabulated around it.
            const double around = side + depth * 0.5 + 1.0;
            const glm::dvec2 corner(-0.5 * (around - side));
            const auto surface = reference::tabulated(surface_of(sea), corner, around,
                                                      std::min(1024, int(around / 0.004)));
            const auto expected = reference::sunlight_by_photons(
                surface,
                {.sun = sun,
                 .disc_rad = scene::sun_radius_rad,
                 .photons_a_side = 10,
                 .steepest = 0.6},
                {.corner_m = {0, 0}, .side_m = side, .texels = texels, .periodic = false}, depth);
            const Likeness l = compare(got, expected);
            std::cout << "| " << fixed(wind, 0) << " | " << fixed(depth, 1) << " | "
                      << fixed(l.contrast, 3) << " | " << fixed(l.expected_contrast, 3) << " | "
                      << fixed(l.l1, 3) << " | " << fixed(l.mean, 3) << " |" << std::endl;
            write_pfm(folder / text("sea_", wind, "_", depth, "_photons.pfm"), expected, texels);
            write_pfm(folder / text("sea_", wind, "_", depth, "_tiles.pfm"),
                      std::vector<double>(got.begin(), got.end()), texels);
        }
    }
}

} // namespace

int main(int argc, char** argv) try {
    if (argc < 2) {
        std::cerr << "usage: tarn_caustic_study FOLDER\n";
        return 2;
    }
    const gpu::Context context;
    const std::string only = argc > 2 ? argv[2] : "";
    if (only == "disc") {
        under_the_disc();
        return 0;
    }
    methods(argv[1]);
    if (only == "methods")
        return 0;
    under_the_disc();
    distributions(argv[1]);
    whole_sea(argv[1]);
    return 0;
} catch (const std::exception& e) {
    std::cerr << e.what() << "\n";
    return 1;
}
