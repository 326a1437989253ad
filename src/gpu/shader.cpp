#include "gpu/shader.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

namespace tarn::gpu {

namespace fs = std::filesystem;

namespace {

std::string read_text(const fs::path& path, const std::string& asked_by) {
    std::ifstream in(path);
    if (!in)
        throw Error("cannot read shader file '" + path.string() + "', asked for by " + asked_by,
                    "set TARN_SHADERS to the folder that holds lib and passes");
    return {std::istreambuf_iterator<char>(in), {}};
}

void paste(const fs::path& root, const std::string& file, const std::string& body,
           const std::map<std::string, std::string>& replaced, ShaderSource& out) {
    static const std::regex include(R"re(^\s*#include\s+"([^"]+)"\s*$)re");
    const auto index = out.files.size();
    out.files.push_back(file);
    if (index > 0)
        out.code += text("#line 1 ", index, "\n");
    std::istringstream lines(body);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        std::smatch match;
        if (!std::regex_match(line, match, include)) {
            out.code += line + "\n";
            continue;
        }
        const auto other = replaced.find(match[1]);
        const std::string wanted = other == replaced.end() ? match[1].str() : other->second;
        if (std::find(out.files.begin(), out.files.end(), wanted) == out.files.end())
            paste(root, wanted, read_text(root / wanted, text(file, ":", number)), replaced, out);
        out.code += text("#line ", number + 1, " ", index, "\n");
    }
}

} // namespace

fs::path shader_root() {
    std::vector<fs::path> places;
    if (const char* chosen = std::getenv("TARN_SHADERS")) {
        places.emplace_back(chosen); // an explicit choice is never second-guessed
    } else {
        std::error_code ignored;
        const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
        if (!program.empty())
            places.push_back((program.parent_path() / TARN_INSTALLED_SHADERS).lexically_normal());
        places.emplace_back(TARN_BUILD_TREE_SHADERS);
    }
    std::string tried;
    for (const fs::path& place : places) {
        std::error_code ignored;
        if (fs::is_directory(place / "passes", ignored))
            return place;
        tried += (tried.empty() ? "" : ", ") + place.string();
    }
    throw Error("shaders not found in " + tried,
                "set TARN_SHADERS to the folder that holds lib and passes");
}

ShaderSource expand_shader(const fs::path& root, const std::string& code, const std::string& name,
                           const std::map<std::string, std::string>& replaced) {
    ShaderSource out;
    paste(root, name, code, replaced, out);
    return out;
}

ShaderSource load_shader(const fs::path& root, const std::string& entry,
                         const std::map<std::string, std::string>& replaced,
                         const std::string& defined) {
    std::string code = read_text(root / entry, "the program");
    if (!defined.empty()) // the next line keeps its number
        code.insert(code.find('\n') + 1, defined + "#line 2 0\n");
    return expand_shader(root, code, entry, replaced);
}

std::string name_files(const std::string& driver_log, const ShaderSource& source) {
    // Mesa and Intel write "2:14(5): error", NVIDIA writes "2(14) : error".
    static const std::regex mesa(R"(^(\d+):(\d+)\()"), nvidia(R"(^(\d+)\((\d+)\))");
    std::istringstream lines(driver_log);
    std::string line, out;
    while (std::getline(lines, line)) {
        std::smatch match;
        if (std::regex_search(line, match, mesa) || std::regex_search(line, match, nvidia)) {
            const auto index = std::stoul(match[1]);
            if (index < source.files.size())
                line = text(source.files[index], ":", match[2].str(), ": ", line);
        }
        out += line + "\n";
    }
    return out;
}

namespace {

[[noreturn]] void refuse(const ShaderSource& source, const std::string& log) {
    throw Error(
        "shader " + source.files.front() + " does not compile: " + name_files(log, source),
        "this is a fault of tarn or of the GL driver: please report it with tarn doctor's output");
}

std::string program_log(GLuint program) {
    std::string log(8192, '\0');
    GLsizei length = 0;
    glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    return log;
}

bool is_linked(GLuint program) {
    GLint linked = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    return linked != GL_FALSE;
}

} // namespace

ComputeProgram::ComputeProgram(const ShaderSource& source) {
    const char* code = source.code.c_str();
    name_ = Name<delete_program>(glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &code));
    if (!is_linked(id()))
        refuse(source, program_log(id()));
}

DrawProgram::DrawProgram(const ShaderSource& vertex, const ShaderSource& fragment)
    : name_(glCreateProgram()) {
    const auto attach = [&](GLenum kind, const ShaderSource& source) {
        const GLuint shader = glCreateShader(kind);
        const char* code = source.code.c_str();
        glShaderSource(shader, 1, &code, nullptr);
        glCompileShader(shader);
        GLint compiled = GL_FALSE;
        glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
        std::string log(8192, '\0');
        GLsizei length = 0;
        glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
        log.resize(static_cast<std::size_t>(length));
        glAttachShader(id(), shader);
        glDeleteShader(shader); // when the program goes
        if (!compiled)
            refuse(source, log);
    };
    attach(GL_VERTEX_SHADER, vertex);
    attach(GL_FRAGMENT_SHADER, fragment);
    glLinkProgram(id());
    if (!is_linked(id()))
        refuse(vertex, program_log(id()));
}

} // namespace tarn::gpu
