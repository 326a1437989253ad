// The failure atlas: every way of drawing, where it fails, by how much. Each figure has to stay
// within a band: a change for the worse breaks the test, and one for the better, too, so that the
// page is brought up to date. With TARN_ATLAS=FOLDER it writes the page and its pictures:
// scripts/failure-atlas.
#include "bench/adversary.hpp"
#include "bench/effects.hpp"
#include "core/error.hpp"
#include "gpu/context.hpp"
#include "image/compare.hpp"
#include "image/files.hpp"
#include "image/tone.hpp"
#include "reference/tracer.hpp"
#include "render/renderer.hpp"
#include "scene/samples.hpp"
#include "scene/water_types.hpp"
#include "support/gpu_function.hpp"
#include "waves/sea.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <optional>

using namespace tarn;

namespace {

using test_support::context;

struct Pair {
    Image wrong, right;
};

struct Finding {
    double value = 0.0;
    std::optional<Pair> pictures;
};

struct Entry {
    const char* name;    ///< of the test, and of the picture
    const char* what;    ///< method or effect, and where it fails
    const char* provoke; ///< a command that shows it
    const char* guard;   ///< or the limit
    const char* measure; ///< what the figure is
    double low, high;    ///< band of the figure
    std::function<Finding()> find;
};

constexpr int width = 160, height = 120;

// --- first hits ------------------------------------------------------------------------------

/// Share of rays of a class that miss, invent, or hit off by more than half a cell.
Finding rays(const char* method, const char* field, bench::RayClass kind) {
    context();
    static const auto fields = bench::adversarial_fields();
    const auto at =
        std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return f.name == field; });
    const auto& methods = scene::walk_methods();
    const auto walk = std::find_if(methods.begin(), methods.end(), [&](const auto& m) {
                          return m.name == std::string(method);
                      })->walk;
    render::Renderer renderer(at->scene);
    auto made = bench::make_rays(at->scene, kind, 4000, 7);
    const auto rounded = bench::round_rays(at->scene, made);
    const bench::Verdict v =
        bench::judge_hits(at->scene, made, renderer.trace_rays(rounded, walk, 0.0, false), false);
    return {double(v.missed + v.invented + v.far_off) / std::max(1, v.hits), {}};
}

// --- pictures --------------------------------------------------------------------------------

struct Shot {
    scene::Scene scene;
    scene::View view;
};

Shot shot(scene::Scene scene, const std::string& camera, double wind_m_per_s,
          glm::dvec3 sun = {0.5, -0.4, 0.75}) {
    Shot out{std::move(scene), {}};
    out.view.lighting = scene::clear_sky(glm::normalize(sun));
    out.view.settings = {.width_px = width, .height_px = height, .samples = 2};
    for (const scene::NamedCamera& c :
         bench::standard_views(out.scene, out.view.lighting.sun_direction, double(width) / height))
        if (c.name == camera)
            out.view.camera = c.camera;
    if (wind_m_per_s > 0.0) {
        out.view.waves.model = waves::Model::jonswap;
        out.view.waves.wind_m_per_s = wind_m_per_s;
        out.view.waves.texels = 128;
    }
    out.view = scene::at_its_best(out.view);
    return out;
}

scene::Scene with_water(scene::Scene scene, const char* water) {
    scene.optics = scene::water_type(water);
    return scene;
}

/// Mean relative error of a cheaper way against everything at its best.
Finding against_best(const Shot& s, const std::function<void(scene::View&)>& cheaper) {
    context();
    render::Renderer renderer(s.scene);
    Finding out;
    scene::View view = s.view;
    cheaper(view);
    out.pictures = Pair{renderer.draw(view), renderer.draw(s.view)};
    out.value = image::compare(out.pictures->wrong, out.pictures->right).mean_relative;
    return out;
}

/// Mean relative error of the GPU's picture against the double-precision tracer: guards hold.
Finding against_reference(Shot s) {
    context();
    s.view.settings.width_px = width / 2;
    s.view.settings.height_px = height / 2;
    render::Renderer renderer(s.scene);
    Finding out;
    out.pictures = Pair{renderer.draw(s.view), reference::trace(s.scene, s.view, {})};
    out.value = image::compare(out.pictures->wrong, out.pictures->right).mean_relative;
    return out;
}

/// One way, a few samples against many.
Finding few_samples(Shot s, int samples) {
    context();
    render::Renderer renderer(s.scene);
    s.view.settings.samples = 64;
    Finding out;
    const Image right = renderer.draw(s.view);
    s.view.settings.samples = samples;
    out.pictures = Pair{renderer.draw(s.view), right};
    out.value = image::compare(out.pictures->wrong, right).mean_relative;
    return out;
}

/// A camera so high above the surface (below: negative) where the bowl is deepest.
Shot at_surface(double above_m) {
    Shot s = shot(scene::bowl(257), "shore", 0.0);
    s.view.camera = scene::look({0, 0, 10.0 + above_m}, 30.0, 0.0, 60.0);
    return s;
}

const std::vector<Entry>& entries() {
    using bench::RayClass;
    using scene::View;
    static const std::vector<Entry> all = {
#include "image/atlas_entries.inc"
    };
    return all;
}

class Atlas : public testing::TestWithParam<std::size_t> {};

} // namespace

TEST_P(Atlas, FailsByAsMuchAsThePageSays) {
    const Entry& e = entries()[GetParam()];
    const Finding found = e.find();
    std::printf("%s: %.3g (%g to %g)\n", e.name, found.value, e.low, e.high);
    EXPECT_GE(found.value, e.low) << e.what << ": better than the page says; bring it up to date";
    EXPECT_LE(found.value, e.high) << e.what << ": worse than the page says";
}

INSTANTIATE_TEST_SUITE_P(All, Atlas, testing::Range(std::size_t(0), entries().size()),
                         [](const auto& one) { return entries()[one.param].name; });

TEST(AtlasPage, IsWrittenWhenAskedFor) {
    const char* folder = std::getenv("TARN_ATLAS");
    if (!folder)
        GTEST_SKIP() << "TARN_ATLAS names no folder";
    std::ofstream md(std::string(folder) + ".md");
    md << "# Failure atlas\n\nEvery way of drawing fails somewhere. Where, by how much, what "
          "guards against it or what the limit is: "
       << entries().size()
       << " entries,\neach measured by a test of its name that holds the figure in a band "
          "(`ctest -R Atlas`): a change for the worse breaks it, one for the\nbetter, too. Written "
          "by `scripts/failure-atlas` on "
       << context().renderer()
       << ".\n\nErrors of pictures: mean relative radiance error at the same sample positions, 160 "
          "x 120, against everything at its best unless\nsaid. Left the failure, right what "
          "should be there.\n\n| | what fails, where | figure | band | seen with | guard or limit "
          "| picture |\n| --: | --- | --- | --- | --- | --- | --- |\n";
    int number = 0;
    for (const Entry& e : entries()) {
        const Finding found = e.find();
        char figures[200];
        std::snprintf(figures, sizeof figures, "%.3g %% of %s | %g to %g %%", 100.0 * found.value,
                      e.measure, 100.0 * e.low, 100.0 * e.high);
        md << "| " << ++number << " | " << e.what << " (`" << e.name << "`) | " << figures << " | `"
           << e.provoke << "` | " << e.guard << " | ";
        if (found.pictures) {
            const Image& right = found.pictures->right;
            const double exposure = image::auto_exposure(right, 0.18, 0.05, 50.0);
            const Picture a = image::tone_map(found.pictures->wrong, exposure),
                          b = image::tone_map(right, exposure);
            Picture both{.width_px = 2 * a.width_px + 4,
                         .height_px = a.height_px,
                         .channels = 3,
                         .bytes = std::vector<std::uint8_t>(
                             std::size_t((2 * a.width_px + 4) * a.height_px * 3), 255)};
            for (int y = 0; y < a.height_px; ++y)
                for (int x = 0; x < a.width_px; ++x)
                    for (int k = 0; k < 3; ++k) {
                        both.bytes[std::size_t((y * both.width_px + x) * 3 + k)] =
                            a.bytes[std::size_t((y * a.width_px + x) * a.channels + k)];
                        both.bytes[std::size_t((y * both.width_px + x + a.width_px + 4) * 3 + k)] =
                            b.bytes[std::size_t((y * a.width_px + x) * b.channels + k)];
                    }
            image::write_png(std::string(folder) + "/" + e.name + ".png", both, {});
            md << "![" << e.name << "](atlas/" << e.name << ".png)";
        }
        md << " |\n";
    }
}
