#pragma once
/// @file gpu_function.hpp  Calls functions of shaders/lib on the GPU, for many inputs at once.
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "gpu/shader.hpp"

#include <glm/vec4.hpp>
#include <string>
#include <vector>

namespace tarn::test_support {

/// One context per test process; throws tarn::Error where no GL 4.5 is available.
inline gpu::Context& context() {
    static gpu::Context shared;
    return shared;
}

/// out = expression(x, y) for pairs of vec4.
class GpuFunction {
public:
    /// @param library  e.g. "lib/fresnel.glsl"
    /// @param body     GLSL statements that read `vec4 x, y` and set `vec4 result`
    /// @param head     further declarations, before main()
    /// @param defined  lines before the library, "#define NAME VALUE\n" each
    GpuFunction(const std::string& library, const std::string& body, const std::string& head = "",
                const std::string& defined = "")
        : program_((context(), source(library, body, head, defined))) {}

    std::vector<glm::vec4> operator()(const std::vector<glm::vec4>& x,
                                      const std::vector<glm::vec4>& y = {}) const {
        const std::size_t bytes = x.size() * sizeof(glm::vec4);
        std::vector<glm::vec4> second = y;
        second.resize(x.size());
        const gpu::Buffer in(bytes, x.data()), in2(bytes, second.data()), out(bytes, nullptr);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, in.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 6, in2.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 7, out.id());
        program_.use();
        glDispatchCompute(GLuint((x.size() + 63) / 64), 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        std::vector<glm::vec4> results(x.size());
        glGetNamedBufferSubData(out.id(), 0, GLsizeiptr(bytes), results.data());
        gpu::check_gl("calling a GPU function");
        return results;
    }

private:
    static gpu::ShaderSource source(const std::string& library, const std::string& body,
                                    const std::string& head, const std::string& defined) {
        return gpu::expand_shader(
            TARN_SHADER_ROOT,
            text("#version 450 core\n", defined, "#include \"", library, "\"\n",
                 "layout(local_size_x = 64) in;\n"
                 "layout(binding = 5, std430) readonly buffer In { vec4 xs[]; };\n"
                 "layout(binding = 6, std430) readonly buffer In2 { vec4 ys[]; };\n"
                 "layout(binding = 7, std430) writeonly buffer Out { vec4 zs[]; };\n",
                 head,
                 "\nvoid main() {\n    uint i = gl_GlobalInvocationID.x;\n"
                 "    if (i >= xs.length()) return;\n"
                 "    vec4 x = xs[i], y = ys[i], result = vec4(0.0);\n    ",
                 body, "\n    zs[i] = result;\n}\n"),
            "<" + body + ">");
    }
    gpu::ComputeProgram program_;
};

} // namespace tarn::test_support
