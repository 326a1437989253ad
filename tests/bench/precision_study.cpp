// tarn_precision_study — the figures of docs/precision.md: what 16-bit heights and single precision
// cost.
//
//   tarn_precision_study [FOLDER]   prints tables; writes pictures to FOLDER
#include "bench/adversary.hpp"
#include "gpu/context.hpp"
#include "image/files.hpp"
#include "image/tone.hpp"
#include "reference/heightfield.hpp"
#include "scene/samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <random>
#include <string>

namespace {

using namespace tarn;

double smooth_hills(double x, double y) {
    return 60 * std::sin(x / 170) * std::cos(y / 210) + 25 * std::sin(x / 41 + y / 57) +
           4 * std::sin(x / 11 - y / 17);
}

/// Hits on hills of 1 m spacing from afar: error against double precision for the same ray, as
/// built and with coordinates that count from the field's corner.
void distances() {
    const scene::Scene scene =
        bench::field_scene({2049, 2049}, 1.0, [](int c, int r) { return smooth_hills(c, r); });
    render::Renderer renderer(scene);
    const Heightfield& g = scene.ground;
    std::printf("| distance | slope of the ray | rays | as built: median, 99.9 %% [m] | from the "
                "corner: median, 99.9 %% [m] | allowed (1e-5) [m] |\n"
                "| --- | --- | --- | --- | --- | --- |\n");
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (const double distance : {100.0, 1e3, 1e4, 5e4, 2e5})
        for (const double slope_deg : {30.0, 3.0}) {
            std::vector<render::FieldRay> near_base, corner_base;
            std::vector<double> truth;
            for (int i = 0; i < 20'000; ++i) {
                const double a = 6.283185307 * unit(random), s = slope_deg * M_PI / 180;
                const glm::dvec3 d(std::cos(a) * std::cos(s), std::sin(a) * std::cos(s),
                                   -std::sin(s));
                const glm::dvec3 aim(200 + 1600 * unit(random), 200 + 1600 * unit(random), 0);
                const glm::dvec3 from = aim - d * distance;
                const glm::vec3 direction(d);
                const glm::vec2 node(float(std::floor(g.col(from.x))),
                                     float(std::floor(g.row(from.y))));
                const float z = float(from.z - g.offset_m);
                near_base.push_back({node,
                                     {float(g.col(from.x) - double(node.x)),
                                      float(g.row(from.y) - double(node.y)), z},
                                     direction});
                corner_base.push_back(
                    {{0, 0}, {float(g.col(from.x)), float(g.row(from.y)), z}, direction});
                const auto hit =
                    reference::trace_field(g, nullptr, from, glm::dvec3(direction), 1e9);
                truth.push_back(hit ? hit->t : -1.0);
            }
            const auto errors = [&](const std::vector<render::FieldRay>& rays) {
                const auto got = renderer.trace_rays(rays, scene::Walk::cone_map, 0.0, false);
                std::vector<double> out;
                for (std::size_t i = 0; i < rays.size(); ++i)
                    if (truth[i] > 0 && got[i].kind > 0)
                        out.push_back(std::abs(double(got[i].t) - truth[i]));
                std::sort(out.begin(), out.end());
                return out;
            };
            const auto a = errors(near_base), b = errors(corner_base);
            std::printf("| %g km | %g° | %zu | %.2g, %.2g | %.2g, %.2g | %.2g |\n", distance * 1e-3,
                        slope_deg, a.size(), a[a.size() / 2], a[a.size() * 999 / 1000],
                        b[b.size() / 2], b[b.size() * 999 / 1000], 1e-5 * distance);
        }
}

/// What 16 bits leave of gentle slopes when the scene's relief is large.
void ranges(const std::string& folder) {
    std::printf("\n| relief of the scene [m] | quantum [mm] | error of slope at 1 m spacing, rms | "
                "at 10 m | at 30 m |\n| --- | --- | --- | --- | --- |\n");
    for (const double relief : {100.0, 500.0, 1000.0, 2000.0, 4000.0, 8849.0}) {
        const double quantum = relief / 65527;
        // Central differences of two rounded heights: each is off by quantum / sqrt(12) rms.
        const auto rms = [&](double spacing) {
            return quantum / std::sqrt(12.0) * std::sqrt(2.0) / (2 * spacing);
        };
        std::printf("| %g | %.1f | %.1e | %.1e | %.1e |\n", relief, 1e3 * quantum, rms(1), rms(10),
                    rms(30));
    }
    for (const double relief : {200.0, 8849.0}) {
        // One far corner node makes the relief; the hills are the same.
        const scene::Scene scene = bench::field_scene({513, 513}, 1.0, [&](int c, int r) {
            return c == 0 && r == 0 ? relief : 0.15 * smooth_hills(c, r);
        });
        render::Renderer renderer(scene);
        scene::View view;
        view.camera = scene::look({256, 120, 60}, 0, -35, 40);
        view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(0.9, 0.1, 0.35)));
        view.settings = {.width_px = 480, .height_px = 300, .samples = 1, .ground_albedo = 0.4};
        const Image image = renderer.draw(view);
        Picture picture{.width_px = 480, .height_px = 300, .channels = 3, .bytes = {}};
        for (const glm::vec3& c : image.radiance)
            for (int k = 0; k < 3; ++k)
                picture.bytes.push_back(std::uint8_t(
                    std::clamp(255 * std::pow(1.3 * double(c[k]), 1 / 2.2), 0.0, 255.0)));
        const std::string path =
            folder + "/precision_relief_" + std::to_string(int(relief)) + ".png";
        image::write_png(path, picture, {});
        std::printf("wrote %s\n", path.c_str());
    }
}

} // namespace

int main(int argc, char** argv) {
    const gpu::Context context;
    std::printf("device: %s\n\n", context.renderer().c_str());
    distances();
    ranges(argc > 1 ? argv[1] : ".");
}
