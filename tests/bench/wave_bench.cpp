// tarn_wave_bench — GPU time of one step of the waves by size and number of patches, beside FFTW on
// one core of this machine and the time that the memory traffic alone must take, and how far the
// GPU's single precision is from FFTW's double.
//
//   tarn_wave_bench [--texels N,N,...] [--cascades N,N,...] [--frames N] [--json FILE]
#include "bench/timing.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "reference/fft.hpp"
#include "reference/waves.hpp"
#include "render/waves.hpp"
#include "scene/samples.hpp"
#include "support/words.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

namespace {

using namespace tarn;

/// Bytes that one step reads and writes at least, if nothing stays in a cache: spectrum (20 a
/// texel), transforms (8 a field: rows write, columns read and write, the surface reads), heights
/// and slopes with their mip levels (16 written, 16 read, a third more for the levels).
double traffic_bytes(int texels, int cascades, int fields) {
    return double(texels) * texels * cascades *
           (20.0 + fields * 8.0 * 4.0 + 16.0 * (2.0 + 1.0 / 3.0));
}

/// Copying by a shader as simple as can be: read plus written, bytes a second.
double bandwidth(int frames) {
    const std::size_t bytes = std::size_t(gpu::is_software() ? 64 : 512) << 20;
    const gpu::Buffer a(bytes, nullptr), b(bytes, nullptr);
    const gpu::ComputeProgram copy(
        gpu::expand_shader(gpu::shader_root(),
                           "#version 450 core\nlayout(local_size_x = 256) in;\n"
                           "layout(binding = 0, std430) readonly buffer A { vec4 a[]; };\n"
                           "layout(binding = 1, std430) writeonly buffer B { vec4 b[]; };\n"
                           "void main() { uint i = gl_GlobalInvocationID.x; b[i] = a[i]; }\n",
                           "<copy>"));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, a.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, b.id());
    const bench::Times t = bench::time_on_gpu(
        [&] {
            copy.use();
            for (int i = 0; i < 8; ++i) // 65535 groups at most
                glDispatchCompute(GLuint(bytes / 16 / 256 / 16), 1, 1);
        },
        frames);
    return 2.0 * double(bytes) / 16.0 * 8.0 / (t.median_ms * 1e-3);
}

/// One transform of every field by FFTW, on one core [ms].
double fftw_ms(int texels, int cascades, int fields) {
    std::vector<reference::Complex> grid(std::size_t(texels) * std::size_t(texels), {1.0, 0.5});
    double best = 1e9;
    for (int i = 0; i < 3; ++i) {
        const auto start = std::chrono::steady_clock::now();
        grid = reference::fft_inverse_2d(std::move(grid), texels);
        best = std::min(best, std::chrono::duration<double, std::milli>(
                                  std::chrono::steady_clock::now() - start)
                                  .count());
    }
    return best * cascades * fields;
}

int run(int argc, char** argv) {
    std::string sizes = "128,256,512,1024,2048", counts = "1,3", json_path;
    int frames = 41;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (i + 1 >= argc)
            throw Error(word + " needs a value");
        const std::string value = argv[++i];
        if (word == "--texels")
            sizes = value;
        else if (word == "--cascades")
            counts = value;
        else if (word == "--frames")
            frames = std::max(1, std::atoi(value.c_str()));
        else if (word == "--json")
            json_path = value;
        else
            throw Error("unknown option " + word);
    }
    const gpu::Context context;
    std::cout << "device: " << context.renderer() << ", OpenGL " << context.version() << "\n";
    const double rate = bandwidth(frames);
    std::printf("copying: %.0f GB/s\n", rate * 1e-9);
    std::string json = text("{\"device\": \"", context.renderer(),
                            "\", \"copy_gb_per_s\": ", rate * 1e-9, ", \"results\": [");
    bool first = true;
    const scene::Scene scene = scene::tank();
    for (const std::string& size : test_support::split(sizes))
        for (const std::string& count : test_support::split(counts))
            for (const double choppiness : {0.0, 1.0}) {
                waves::Settings s;
                s.model = waves::Model::jonswap;
                s.wind_m_per_s = 6.0;
                s.fetch_m = 3000.0;
                s.texels = std::atoi(size.c_str());
                s.cascades = std::atoi(count.c_str());
                s.choppiness = choppiness;
                render::WaveField field;
                field.set(waves::make_sea(scene.ground, scene.water, scene.lakes, s));
                const int fields = choppiness > 0.0 ? 4 : 2, // complex ones

                    cascades = int(field.sea().cascades.size());
                double time_s = 0.0;
                const bench::Times t =
                    bench::time_on_gpu([&] { field.move_to(time_s += 0.1); }, frames);
                double error = 0.0;
                if (choppiness == 0.0) {
                    field.move_to(12.3);
                    const auto got = field.read(0);
                    const auto want =
                        reference::wave_fields(field.sea().cascades[0], 12.3, s.loop_s);
                    double off = 0.0, all = 0.0;
                    for (std::size_t i = 0; i < got.size(); ++i) {
                        off += std::pow(got[i].x - want.height[i], 2);
                        all += want.height[i] * want.height[i];
                    }
                    error = std::sqrt(off / all);
                }
                const double limit = traffic_bytes(s.texels, cascades, fields) / rate * 1e3;
                const double fftw = fftw_ms(s.texels, cascades, fields);
                std::printf("%d x %4d^2, %s  %8.4f ms (quartiles %.4f to %.4f, %s), traffic alone "
                            "%.4f ms, FFTW %8.2f ms",
                            cascades, s.texels, choppiness > 0.0 ? "choppy" : "round ", t.median_ms,
                            t.low_ms, t.high_ms, t.clock, limit, fftw);
                if (choppiness == 0.0)
                    std::printf(", off by %.1e of the rms height", error);
                std::printf("\n         ");
                for (const bench::PartTime& part : bench::time_parts(
                         [&](const std::function<void(const char*)>& begins) {
                             field.on_pass = begins;
                             field.move_to(time_s += 0.1);
                             field.on_pass = {};
                         },
                         frames))
                    std::printf(" %s %.4f", part.name.c_str(), part.median_ms);
                std::printf("\n");
                json += text(first ? "\n" : ",\n", "{\"texels\": ", s.texels,
                             ", \"cascades\": ", cascades, ", \"choppiness\": ", choppiness,
                             ", \"median_ms\": ", t.median_ms, ", \"q1_ms\": ", t.low_ms,
                             ", \"q3_ms\": ", t.high_ms, ", \"clock\": \"", t.clock,
                             "\", \"traffic_ms\": ", limit, ", \"fftw_one_core_ms\": ", fftw,
                             ", \"relative_error\": ", error, "}");
                first = false;
            }
    json += "\n]}\n";
    if (!json_path.empty())
        std::ofstream(json_path) << json;
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::cerr << "tarn_wave_bench: " << error.what() << "\n";
        return 1;
    }
}
