#include "core/error.hpp"
#include "render/renderer.hpp"
#include "scene/samples.hpp"
#include "support/gpu_function.hpp"

#include <cstdlib>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>

using namespace tarn;

TEST(Context, IsOpenGl45AndSaysWhatItIs) {
    gpu::Context& context = test_support::context();
    EXPECT_NE(context.version().find("4."), std::string::npos);
    EXPECT_FALSE(context.renderer().empty());
    EXPECT_GE(context.max_texture_side_px(), 16384);
    bool some = false;
    for (const auto& attempt : gpu::probe_displays())
        some |= attempt.ok;
    EXPECT_TRUE(some);
}

TEST(Shaders, EveryPassCompiles) {
    test_support::context();
    int passes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(TARN_SHADER_ROOT "/passes")) {
        const auto load = [](const std::string& file) {
            return gpu::load_shader(TARN_SHADER_ROOT, "passes/" + file);
        };
        const std::string name = entry.path().filename().string(),
                          stem = entry.path().stem().string();
        if (entry.path().extension() == ".vert")
            EXPECT_NO_THROW(gpu::DrawProgram(load(name), load(stem + ".frag"))) << name;
        else if (entry.path().extension() == ".comp")
            EXPECT_NO_THROW(gpu::ComputeProgram(load(name))) << name;
        else
            EXPECT_TRUE(std::filesystem::exists(entry.path().parent_path() / (stem + ".vert")))
                << name;
        ++passes;
    }
    EXPECT_GE(passes, 3);
    for (const char* pass : {"primary", "surface", "secondary", "shadow", "shade"})
        for (const char* cascades : {"0", "1", "4"})
            EXPECT_NO_THROW(gpu::ComputeProgram(gpu::load_shader(
                TARN_SHADER_ROOT, text("passes/", pass, ".comp"), {},
                text("#define TARN_WAVES 1\n#define TARN_CASCADES ", cascades, "\n"))))
                << pass;
    for (const char* pass : {"sunlit", "shade"})
        for (const char* shafts : {"0", "2", "0\n#define TARN_PRISMS 1", "2\n#define TARN_GLOW 1"})
            for (const char* more : {"", "#define TARN_LAND_SHADOW 1\n#define TARN_HAZE 1\n",
                                     "#define TARN_LAND_SHADOW 1\n#define TARN_WHOLE_SKY 1\n"})
                EXPECT_NO_THROW(gpu::ComputeProgram(gpu::load_shader(
                    TARN_SHADER_ROOT, text("passes/", pass, ".comp"), {},
                    text("#define TARN_WAVES 1\n#define TARN_CASCADES 3\n#define TARN_CAUSTICS 1\n",
                         "#define TARN_SHAFTS ", shafts, "\n", more))))
                    << pass << shafts << more;
    for (const char* method : {"0", "1", "2", "3"})
        for (const char* direct : {"", "#define TARN_SUNLIGHT_DIRECT 1\n"})
            EXPECT_NO_THROW(gpu::ComputeProgram(gpu::load_shader(
                TARN_SHADER_ROOT, "passes/sunlight_photons.comp", {},
                text("#define TARN_SUNLIGHT_METHOD ", method, "\n#define TARN_SUNLIGHT_PHOTONS ",
                     method[0] == '0' ? "2" : "1", "\n", direct))))
                << method << direct;
}

TEST(Shaders, ErrorsNameTheFileAndTheAsker) {
    test_support::context();
    try {
        gpu::expand_shader(TARN_SHADER_ROOT, "#version 450\n\n#include \"lib/nope.glsl\"\n", "<t>");
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("asked for by <t>:3"), std::string::npos)
            << error.what();
    }
    try {
        test_support::GpuFunction("lib/fresnel.glsl", "result.x = fresnel_dielektrik(x.x, x.y);");
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("fresnel_dielektrik(x.x, x.y);>:"),
                  std::string::npos)
            << error.what();
    }
}

TEST(Shaders, AreFoundWhereTheVariableSaysAndNowhereElse) {
    ::setenv("TARN_SHADERS", "/nonexistent/shaders", 1);
    EXPECT_THROW(gpu::shader_root(), Error);
    ::setenv("TARN_SHADERS", TARN_SHADER_ROOT, 1);
    EXPECT_EQ(gpu::shader_root(), std::filesystem::path(TARN_SHADER_ROOT));
    ::unsetenv("TARN_SHADERS");
    EXPECT_TRUE(std::filesystem::exists(gpu::shader_root() / "lib"));
}

TEST(Textures, RefuseWhatTheDeviceCannotHold) {
    test_support::context();
    EXPECT_THROW(gpu::Texture2D(GL_R16, 0, 2, 1, gpu::Filter::nearest, "bad"), Error);
    try {
        const int side = test_support::context().max_texture_side_px() + 1;
        gpu::Texture2D(GL_R16, side, 1, 1, gpu::Filter::nearest, "height field");
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("height field is"), std::string::npos);
    }
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST(Renderer, DrawsTheSamePictureTwice) {
    test_support::context();
    const scene::Scene scene = scene::bowl(65);
    render::Renderer renderer(scene);
    scene::View view;
    view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(1, 1, 1)));
    view.camera = scene::look({0, -700, 300}, 0, -25, 50);
    view.settings = {.width_px = 64, .height_px = 48, .samples = 3};
    const Image a = renderer.draw(view), b = renderer.draw(view);
    EXPECT_EQ(a.radiance, b.radiance);
    EXPECT_EQ(a.distance_m, b.distance_m);
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}
