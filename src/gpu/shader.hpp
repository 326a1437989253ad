#pragma once
/// @file shader.hpp  GLSL with `#include "room/file"`, and linked compute programs.
#include "gpu/objects.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace tarn::gpu {

struct ShaderSource {
    std::string code;               ///< one translation unit, with #line directives
    std::vector<std::string> files; ///< file N of "#line L N" is files[N]
};

/// Where the shaders are: $TARN_SHADERS, beside the installed program, or the source tree.
/// @throws tarn::Error  naming the places looked at
std::filesystem::path shader_root();

/// Pastes each included file once, so libraries need no include guards.
/// @param entry     relative to root, e.g. "passes/trace.comp"
/// @param replaced  includes of the first file get the second instead
/// @param defined   lines put behind #version, "#define NAME VALUE\n" each
/// @throws tarn::Error  if a file is missing; names the file and line that asked for it
ShaderSource load_shader(const std::filesystem::path& root, const std::string& entry,
                         const std::map<std::string, std::string>& replaced = {},
                         const std::string& defined = {});

/// As load_shader(), for code written in memory (used by the GPU function tests).
ShaderSource expand_shader(const std::filesystem::path& root, const std::string& code,
                           const std::string& name,
                           const std::map<std::string, std::string>& replaced = {});

/// Rewrites driver messages "N(L)" / "N:L(" to "lib/fresnel.glsl:L", so that editors can jump
/// there.
std::string name_files(const std::string& driver_log, const ShaderSource& source);

/// Workgroups that cover so many items, that many in each.
constexpr GLuint groups(int items, int of = 8) { return GLuint((items + of - 1) / of); }

class ComputeProgram {
public:
    ComputeProgram() = default;
    /// @throws tarn::Error  with the driver's log, file names filled in
    explicit ComputeProgram(const ShaderSource& source);
    void use() const { glUseProgram(name_.get()); }
    GLuint id() const { return name_.get(); }

private:
    Name<delete_program> name_;
};

/// A vertex and a fragment shader.
class DrawProgram {
public:
    DrawProgram() = default;
    /// @throws tarn::Error  with the driver's log, file names filled in
    DrawProgram(const ShaderSource& vertex, const ShaderSource& fragment);
    void use() const { glUseProgram(name_.get()); }
    GLuint id() const { return name_.get(); }

private:
    Name<delete_program> name_;
};

} // namespace tarn::gpu
