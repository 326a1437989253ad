// `tarn doctor` — what this machine offers.
#include "app/command.hpp"
#include "core/error.hpp"
#include "dem/write.hpp"
#include "gpu/context.hpp"
#include "gpu/shader.hpp"
#include "image/files.hpp"

#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

namespace tarn::app {

namespace {

struct Findings {
    nlohmann::ordered_json json;
    bool can_render = false;
};

Findings examine() {
    Findings out;
    auto& j = out.json;
    j["tarn"] = TARN_VERSION;
    j["libraries"] = {dem::library_versions(), image::library_version()};
    j["cpu_threads"] = std::thread::hardware_concurrency();
    j["displays"] = nlohmann::ordered_json::array();
    for (const auto& attempt : gpu::probe_displays())
        j["displays"].push_back(
            {{"way", attempt.way}, {"ok", attempt.ok}, {"result", attempt.result}});
    try {
        j["shaders"] = gpu::shader_root().string();
        const gpu::Context context;
        j["opengl"] = {{"way", context.way()},
                       {"renderer", context.renderer()},
                       {"version", context.version()},
                       {"max_texture_side_px", context.max_texture_side_px()}};
        for (const char* pass :
             {"passes/block_maxima.comp", "passes/reduce_maxima.comp", "passes/primary.comp",
              "passes/secondary.comp", "passes/shadow.comp", "passes/shade.comp"})
            gpu::ComputeProgram(gpu::load_shader(gpu::shader_root(), pass));
        j["can_render"] = out.can_render = true;
    } catch (const Error& error) {
        j["can_render"] = false;
        j["problem"] = error.what();
    }
    return out;
}

} // namespace

void add_doctor(CLI::App& app, Run& run) {
    auto as_json = std::make_shared<bool>(false);
    CLI::App* c =
        app.add_subcommand("doctor", "what this machine offers: OpenGL, EGL, limits, shaders");
    c->add_flag("--json", *as_json, "the same for programs");
    c->footer(
        "Exit code 0 if tarn can render here, else 1 (tarn render --reference needs no GPU).");
    c->callback([as_json, &run] {
        run = [as_json] {
            const Findings found = examine();
            const auto& j = found.json;
            if (*as_json) {
                std::cout << j.dump(2) << "\n";
                return found.can_render ? 0 : 1;
            }
            std::cout << "tarn " << j["tarn"].get<std::string>() << ", "
                      << j["libraries"][0].get<std::string>() << ", "
                      << j["libraries"][1].get<std::string>() << ", " << j["cpu_threads"]
                      << " CPU threads\n";
            for (const auto& d : j["displays"])
                std::cout << "EGL " << d["way"].get<std::string>() << ": "
                          << (d["ok"].get<bool>() ? "" : "not available, ")
                          << d["result"].get<std::string>() << "\n";
            if (j.contains("shaders"))
                std::cout << "shaders in " << j["shaders"].get<std::string>() << "\n";
            if (j.contains("opengl"))
                std::cout << "OpenGL " << j["opengl"]["version"].get<std::string>() << " by "
                          << j["opengl"]["renderer"].get<std::string>() << " (EGL "
                          << j["opengl"]["way"].get<std::string>() << "), textures up to "
                          << j["opengl"]["max_texture_side_px"] << " a side\n";
            std::cout << (found.can_render
                              ? "tarn can render here\n"
                              : "tarn can NOT render here: " + j["problem"].get<std::string>() +
                                    "\n(tarn render --reference works without a GPU)\n");
            return found.can_render ? 0 : 1;
        };
    });
}

} // namespace tarn::app
