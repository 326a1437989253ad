// Lines and points that hang in air and water: hidden, refracted, mirrored, against the reference.
#include "image/compare.hpp"
#include "reference/tracer.hpp"
#include "render/renderer.hpp"
#include "scene/labels.hpp"
#include "scene/samples.hpp"
#include "scene/space_lines.hpp"
#include "support/gpu_function.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;

namespace {

/// A tank of water that one sees far in: bed at -8 m, level 0.
scene::Scene clear_tank() {
    scene::Scene scene = scene::tank();
    scene.optics.absorption_per_m = {0.06, 0.03, 0.02};
    scene.optics.backscattering_per_m = glm::dvec3(0.002);
    scene.optics.bands.clear();
    return scene;
}

scene::View from(double z, double pitch_deg) {
    scene::View view;
    view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(0.5, -0.4, 0.6)));
    view.lighting.sun_disc = false;
    view.camera = scene::look({3.0, -20.0, z}, 5, pitch_deg, 60);
    view.settings = {.width_px = 72, .height_px = 54, .samples = 1};
    return view;
}

void expect_reference(const scene::Scene& scene, const scene::View& view, const char* what) {
    render::Renderer renderer(scene);
    const Image got = renderer.draw(view), expected = reference::trace(scene, view, {});
    const image::Difference d = image::compare(got, expected);
    std::printf("%s: mean %.4f %%, 99th %.4f %%\n", what, 100 * d.mean_relative,
                100 * d.p99_relative);
    EXPECT_LT(d.mean_relative, 1e-4) << what;
    EXPECT_LT(d.p99_relative, 1e-3) << what;
}

/// Middle of what a stroke changes in a picture, by how much it does; nothing: it does not show.
std::optional<glm::dvec2> middle_of_change(const Image& with, const Image& without) {
    glm::dvec2 sum(0.0);
    double weights = 0.0;
    for (int y = 0; y < with.height_px; ++y)
        for (int x = 0; x < with.width_px; ++x) {
            const std::size_t i = std::size_t(y * with.width_px + x);
            const double change = glm::length(glm::dvec3(with.radiance[i] - without.radiance[i]));
            sum += change * glm::dvec2(x + 0.5, y + 0.5);
            weights += change;
        }
    if (weights < 1e-3)
        return {};
    return sum / (weights * glm::dvec2(with.width_px, with.height_px));
}

} // namespace

// Forty strokes anywhere: through the surface, in the bed, over the rim, each by the walk through
// the tree and by trying all.
TEST(SpaceLines, AreTheReferencesFromAboveAndFromBelow) {
    test_support::context();
    scene::Scene scene = clear_tank();
    std::mt19937 random(5);
    std::uniform_real_distribution<double> even(-1.0, 1.0);
    const auto place = [&] {
        return glm::dvec3(12.0 * even(random), 12.0 * even(random), 9.0 * even(random));
    };
    for (int i = 0; i < 40; ++i) {
        const glm::dvec3 a = place(), b = i % 4 ? place() : a;
        scene.space_strokes.push_back({a, b, float(2.0 + even(random) + (i % 4 ? 0.0 : 6.0))});
    }
    expect_reference(scene, from(5.0, -15.0), "signs, from above");
    expect_reference(scene, from(-4.0, 15.0), "signs, from below");
    scene::View view = from(-4.0, 5.0);
    view.settings.space_lines_lit = true;
    expect_reference(scene, view, "from below");
    view.settings.dive_light_cd = 3000.0;
    view.settings.drape_on = scene::DrapeOn::flooded;
    expect_reference(scene, view, "by lamp, those in the water alone");
    view = from(5.0, -15.0);
    view.settings.space_lines_lit = true;
    expect_reference(scene, view, "from above");
    view.settings.earth_curvature = true;
    view.lighting.visibility_m = 200.0;
    view.settings.drape_on = scene::DrapeOn::dry;
    expect_reference(scene, view, "in haze, those in the air alone");
    // Kilometres away the Earth's curvature lowers them, by more than their width.
    scene.space_strokes = {{{-300.0, 9000.0, 40.0}, {900.0, 9000.0, 40.0}, 3.0f}};
    view.settings.drape_on = scene::DrapeOn::all;
    view.lighting.visibility_m.reset();
    view.camera = scene::look({3.0, -20.0, 20.0}, 0, 0, 2);
    expect_reference(scene, view, "9 km away");
    const Image bent = render::Renderer(scene).draw(view);
    view.settings.earth_curvature = false;
    const Image flat = render::Renderer(scene).draw(view);
    EXPECT_GT(image::compare(bent, flat).mean_relative, 0.005);
}

// In waves samples differ; means over blocks do not.
TEST(SpaceLines, InWavesAreTheReferencesInBlocks) {
    test_support::context();
    scene::Scene scene = clear_tank();
    scene.space_strokes = {{{0, -8, 3}, {0, -8, -6}, 9.0f}, {{-6, -6, -1}, {6, -6, -1}, 9.0f}};
    scene::View view = from(4.0, -20.0);
    view.waves.model = waves::Model::sines;
    view.waves.list = {{.amplitude_m = 0.04, .length_m = 3.0, .towards_deg = 40.0}};
    view.settings.samples = 9;
    render::Renderer renderer(scene);
    const Image got = renderer.draw(view), expected = reference::trace(scene, view, {});
    double mean = 0.0;
    for (int y = 0; y < 48; y += 8)
        for (int x = 0; x < 72; x += 8) {
            glm::dvec3 sums[2] = {glm::dvec3(0.0), glm::dvec3(0.0)};
            for (int k = 0; k < 64; ++k) {
                const std::size_t i = std::size_t((y + k / 8) * 72 + x + k % 8);
                sums[0] += glm::dvec3(got.radiance[i]);
                sums[1] += glm::dvec3(expected.radiance[i]);
            }
            mean += std::abs(sums[0].r - sums[1].r) / sums[1].r / 54.0;
        }
    std::printf("in a wave: blocks are %.3f %% off in the mean\n", 100 * mean);
    EXPECT_LT(mean, 0.02);
    // And they do show.
    scene.space_strokes.clear();
    renderer.map_changed();
    EXPECT_GT(image::compare(got, renderer.draw(view)).mean_relative, 0.02);
}

// Labels stand where the points appear, from above into water, from water into air, past corners.
TEST(SpaceLines, LabelsStandWherePointsAppear) {
    test_support::context();
    scene::Scene scene = clear_tank();
    render::Renderer renderer(scene);
    for (const auto& [camera_z, pitch, place] :
         {std::tuple(5.0, -20.0, glm::dvec3(2, -6, -4)),
          std::tuple(5.0, -10.0, glm::dvec3(2, 0, 2)),
          std::tuple(-5.0, 40.0, glm::dvec3(4, -16, 3)),
          std::tuple(-5.0, 0.0, glm::dvec3(5, -6, -4)),
          std::tuple(5.0, -10.0, glm::dvec3(2, 0, -20)),    // in the bed
          std::tuple(5.0, -5.0, glm::dvec3(2, 130, -6))}) { // behind the rim
        scene::View view = from(camera_z, pitch);
        view.settings.reflection = false;
        view.settings.width_px = 360;
        view.settings.height_px = 270;
        scene.space_strokes.clear();
        scene.labels = {{place, "here"}};
        renderer.map_changed();
        const Image without = renderer.draw(view);
        scene.space_strokes = {{place, place, 9.0f}};
        renderer.map_changed();
        const Image with = renderer.draw(view);
        const auto shown = scene::shown_labels(
            scene, view.camera, 360.0 / 270.0, scene::DrapeOn::all, [&](double x, double y) {
                return std::abs(
                    double(with.distance_m[std::size_t(y * 270) * 360 + std::size_t(x * 360)]));
            });
        const auto middle = middle_of_change(with, without);
        ASSERT_EQ(shown.size(), middle ? 1u : 0u) << place.x << " " << place.y << " " << place.z;
        if (middle) {
            EXPECT_NEAR(shown[0].x * 360, middle->x * 360, 1.0) << place.z;
            EXPECT_NEAR(shown[0].y * 270, middle->y * 270, 1.0) << place.z;
        }
    }
    EXPECT_TRUE(scene::shown_labels(scene, from(5.0, -20.0).camera, 1.0, scene::DrapeOn::all,
                                    [](double, double) { return 1.0; })
                    .empty()); // something stands before all of it
}
