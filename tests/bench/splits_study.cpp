// What pictures lose by splitting paths at the water only once: the reference with one split and
// with more, in standard views and winds. Prints the table of docs/waves.md.
#include "bench/effects.hpp"
#include "bench/program.hpp"
#include "reference/tracer.hpp"
#include "scene/samples.hpp"

#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>

using namespace tarn;

namespace {

constexpr int width_px = 48, height_px = 32, block_px = 8;

double luminance(const glm::vec3& c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

struct Loss {
    double mean = 0.0, blocks = 0.0, worst = 0.0; ///< of luminance, relative
};

Loss loss_of(const Image& once, const Image& often) {
    Loss out;
    double sums[2] = {0.0, 0.0};
    for (int top = 0; top < height_px; top += block_px)
        for (int left = 0; left < width_px; left += block_px) {
            double block[2] = {0.0, 0.0};
            for (int y = top; y < top + block_px; ++y)
                for (int x = left; x < left + block_px; ++x) {
                    const auto i = std::size_t(y * width_px + x);
                    block[0] += luminance(once.radiance[i]);
                    block[1] += luminance(often.radiance[i]);
                }
            sums[0] += block[0];
            sums[1] += block[1];
            const double off = std::abs(block[0] / block[1] - 1.0);
            out.blocks += off * block_px * block_px / (width_px * height_px);
            out.worst = std::max(out.worst, off);
        }
    out.mean = sums[0] / sums[1] - 1.0;
    return out;
}

int run(const bench::Words& words) {
    const int splits = words.count("--splits", 4), samples = words.count("--samples", 9);
    const scene::Scene scene = scene::bowl(257);
    const glm::dvec3 sun = glm::normalize(glm::dvec3(0.5, -0.4, 0.6));
    std::printf("| view | wind [m/s] | picture by one split against %d | blocks of 8 x 8 pixels | "
                "the worst block |\n| --- | --- | --- | --- | --- |\n",
                splits);
    for (const scene::NamedCamera& c :
         bench::standard_views(scene, sun, double(width_px) / height_px))
        for (const double wind : {0.0, 3.0, 8.0}) {
            scene::View view;
            view.camera = c.camera;
            view.lighting = scene::clear_sky(sun);
            view.lighting.sun_disc = false; // found by chance alone
            view.settings.width_px = width_px;
            view.settings.height_px = height_px;
            view.settings.samples = samples;
            view.settings.caustics = scene::Caustics::off;
            if (wind > 0.0) {
                view.waves.model = waves::Model::jonswap;
                view.waves.wind_m_per_s = wind;
            }
            const Image once = reference::trace(scene, view, {});
            view.settings.reference_splits = splits;
            const Loss l = loss_of(once, reference::trace(scene, view, {}));
            std::printf("| %s | %.0f | %+.3f %% | %.3f %% | %.2f %% |\n", c.name.c_str(), wind,
                        100 * l.mean, 100 * l.blocks, 100 * l.worst);
            std::fflush(stdout);
        }
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    return bench::program(argc, argv, {"--splits", "--samples"}, run);
}
