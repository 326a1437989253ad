// Many pictures in one process: nothing grows, nothing is left over from the one before.
#include "render/renderer.hpp"
#include "scene/samples.hpp"
#include "support/gpu_function.hpp"

#include <fstream>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

using namespace tarn;

namespace {

double resident_mb() {
    std::ifstream in("/proc/self/statm");
    double pages = 0.0, resident = 0.0;
    in >> pages >> resident;
    return resident * double(::sysconf(_SC_PAGESIZE)) * 1e-6;
}

} // namespace

TEST(Reliability, AThousandPicturesInOneProcessDoNotGrow) {
    test_support::context(); // another, and its end would take the tests' own away
    const scene::Scene scene = scene::bowl(65);
    render::Renderer renderer(scene);
    scene::View view;
    view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(0.5, -0.4, 0.75)));
    view.settings = {.width_px = 48, .height_px = 40, .samples = 1};
    view.camera = scene::look({0, -220, 12}, 0.0, -5.0, 60.0);
    const Image first = renderer.draw(view);
    double before_mb = 0.0;
    for (int i = 1; i <= 1000; ++i) {
        scene::View other = view;
        other.settings.width_px = 48 + i % 7; // images are made anew
        other.camera.position.x = i % 50;
        if (i % 40 == 0) {
            other.waves.model = waves::Model::jonswap;
            other.waves.wind_m_per_s = 3.0 + i / 40 % 3;
            other.waves.texels = 128;
            other.waves.cascades = 2;
        }
        renderer.draw(other);
        if (i == 250) // by then every size and program has been seen
            before_mb = resident_mb();
    }
    const double grown_mb = resident_mb() - before_mb;
    std::printf("750 more pictures: %.1f MB more\n", grown_mb);
    // A leak of one picture of 48 x 40 with its hits (150 KB) each would be 110 MB.
    EXPECT_LT(grown_mb, 20.0);
    EXPECT_EQ(renderer.draw(view).radiance, first.radiance);
}
