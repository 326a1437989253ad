#include "reference/fft.hpp"
#include "support/gpu_function.hpp"

#include <cmath>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;

// Lines of every length and number of lanes that are used, against FFTW.
TEST(FftGpu, AgreesWithFftwForEveryLength) {
    test_support::context();
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    for (const int n : {16, 32, 128, 256, 512, 1024, 2048})
        for (const int lanes : {1, n > 1024 ? 1 : 2}) {
            const std::string code = text(
                "#version 450 core\n#define TARN_FFT_N ", n, "\n#define TARN_FFT_LANES ", lanes,
                "\nlayout(local_size_x = ", lanes, ", local_size_y = ", n / 4,
                ") in;\nlayout(binding = 5, std430) buffer Lines { vec4 line[]; };\n"
                "layout(binding = 6, std430) readonly buffer T { vec2 twiddles[]; };\n"
                "#define TWIDDLE(n) twiddles[n]\n#include \"lib/fft.glsl\"\n"
                "void main() {\n uint lane = gl_LocalInvocationID.x, i = gl_LocalInvocationID.y;\n"
                " for (uint k = 0u; k < 4u; ++k)\n  fft_line[(i + k * TARN_FFT_N / 4) * "
                "TARN_FFT_LANES + lane] = line[lane * TARN_FFT_N + i + k * TARN_FFT_N / 4];\n"
                " fft_inverse(i, lane);\n for (uint k = 0u; k < 4u; ++k)\n  line[lane * TARN_FFT_N "
                "+ i + k * TARN_FFT_N / 4] = fft_line[(i + k * TARN_FFT_N / 4) * TARN_FFT_LANES + "
                "lane];\n}\n");
            const gpu::ComputeProgram program(gpu::expand_shader(TARN_SHADER_ROOT, code, "<fft>"));
            std::vector<glm::vec4> line;
            std::vector<glm::vec2> twiddles;
            for (int i = 0; i < n * lanes; ++i)
                line.emplace_back(normal(random), normal(random), normal(random), normal(random));
            for (int i = 0; i < n; ++i)
                twiddles.emplace_back(std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n));
            const gpu::Buffer lines(line.size() * sizeof line[0], line.data());
            const gpu::Buffer table(twiddles.size() * sizeof twiddles[0], twiddles.data());
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, lines.id());
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 6, table.id());
            program.use();
            glDispatchCompute(1, 1, 1);
            glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
            std::vector<glm::vec4> got(line.size());
            glGetNamedBufferSubData(lines.id(), 0, GLsizeiptr(got.size() * sizeof got[0]),
                                    got.data());
            gpu::check_gl("transforming");
            for (int k = 0; k < 2 * lanes; ++k) { // the k % 2-th number of each pair
                const int lane = k / 2;
                const auto number = [k](const glm::vec4& v) {
                    return k % 2 ? reference::Complex(v.z, v.w) : reference::Complex(v.x, v.y);
                };
                std::vector<reference::Complex> in;
                for (int i = 0; i < n; ++i)
                    in.push_back(number(line[std::size_t(lane * n + i)]));
                const auto expected = reference::fft_inverse(in);
                double error = 0.0, size = 0.0;
                for (int i = 0; i < n; ++i) {
                    error += std::norm(number(got[std::size_t(lane * n + i)]) -
                                       expected[std::size_t(i)]);
                    size += std::norm(expected[std::size_t(i)]);
                }
                // float32 rounding grows with the root of the number of passes: 1e-7 each.
                EXPECT_LT(std::sqrt(error / size), 5e-7) << n << " lanes " << lanes;
            }
        }
}
