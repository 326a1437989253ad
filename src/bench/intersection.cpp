#include "bench/intersection.hpp"

#include "bench/matrix.hpp"
#include "core/angles.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/text.hpp"
#include "reference/camera.hpp"
#include "reference/heightfield.hpp"
#include "render/renderer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <ostream>

namespace tarn::bench {

namespace {

/// A method with one of its settings.
struct Candidate {
    const scene::WalkMethod* method;
    double setting;
};

std::vector<Candidate> candidates(const IntersectionOptions& options) {
    std::vector<Candidate> out;
    for (const scene::WalkMethod& method : scene::walk_methods()) {
        if (!options.methods.empty() && std::find(options.methods.begin(), options.methods.end(),
                                                  method.name) == options.methods.end())
            continue;
        if (method.default_setting == 0.0)
            out.push_back({&method, 0.0});
        else if (options.all_settings)
            for (const double factor : {0.25, 0.5, 1.0, 2.0, 4.0})
                out.push_back({&method, method.default_setting * factor});
        else
            out.push_back({&method, method.default_setting});
    }
    return out;
}

/// What the double-precision walk over every cell finds for some pixels of a picture.
struct Truth {
    std::vector<std::size_t> pixels;
    std::vector<double> t; ///< infinity: nothing
    double pixel_rad = 0.0;
};

Truth truth_of(const scene::Scene& scene, const scene::View& view, int wanted) {
    const int w = view.settings.width_px, h = view.settings.height_px;
    const double half = std::tan(0.5 * view.camera.fov_deg * pi / 180.0);
    Truth truth;
    truth.pixel_rad = 2.0 * half / h;
    // A lattice that shares no factor with the picture's tiles.
    const std::size_t pixels = std::size_t(w) * std::size_t(h);
    const std::size_t stride =
        std::max<std::size_t>(1, pixels / std::size_t(std::max(1, wanted))) | 1;
    for (std::size_t i = stride / 2; i < pixels; i += stride)
        truth.pixels.push_back(i);
    truth.t.resize(truth.pixels.size());
    const auto& p = view.camera.position;
    const auto water = scene.water_level_m(p.x, p.y);
    const bool below = water && p.z < *water;
    const double bottom = scene::block_bottom_m(scene.ground);
    share_out(int(truth.pixels.size()), 0, [&](int first, int last) {
        for (int k = first; k < last; ++k) {
            const std::size_t i = truth.pixels[std::size_t(k)];
            const glm::dvec2 place((double(i % std::size_t(w)) + 0.5) / w,
                                   (double(i / std::size_t(w)) + 0.5) / h);
            const glm::dvec3 direction =
                reference::pixel_direction(view.camera.forward, view.camera.right, view.camera.up,
                                           {half * w / h, half}, place);
            const auto hit = reference::trace_field(scene.ground, below ? nullptr : &scene.water, p,
                                                    direction, 1e9, bottom);
            truth.t[std::size_t(k)] = hit ? hit->t : INFINITY;
        }
    });
    return truth;
}

void judge(const Truth& truth, const std::vector<float>& distances, IntersectionResult& result) {
    std::vector<double> errors;
    int missed = 0, wrong = 0, invented = 0;
    for (std::size_t k = 0; k < truth.pixels.size(); ++k) {
        const double got = std::abs(double(distances[truth.pixels[k]])), right = truth.t[k];
        if (!std::isfinite(right)) {
            invented += got > 0.0;
            continue;
        }
        if (got == 0.0) {
            ++missed;
            continue;
        }
        const double error = std::abs(got - right);
        errors.push_back(error / std::max(right, 1e-9));
        wrong += error > std::max(0.5 * truth.pixel_rad * right, 1e-9);
    }
    std::sort(errors.begin(), errors.end());
    result.judged = int(truth.pixels.size());
    result.hits = missed + int(errors.size());
    const double hits = std::max(1, result.hits);
    result.missed_rate = missed / hits;
    result.wrong_rate = (wrong + invented) / hits;
    if (errors.empty())
        return;
    for (const double e : errors)
        result.mean_error += e / double(errors.size());
    result.p95_error = errors[errors.size() * 95 / 100];
    result.p99_error = errors[errors.size() * 99 / 100];
}

} // namespace

std::vector<NamedView> mountain_views() {
    return {{"high", scene::look({-900, -6500, 3300}, 8.0, -22.0, 45.0)},
            {"grazing", scene::look({-900, -7900, 2150}, 8.0, -4.0, 45.0)},
            {"shore", scene::look({-400, -2300, 952}, 5.0, -4.0, 55.0)},
            {"below", scene::look({600, -1500, 918}, 200.0, 6.0, 75.0)}};
}

std::vector<IntersectionResult> compare_methods(const scene::Scene& scene, const std::string& name,
                                                const std::vector<NamedView>& views,
                                                const IntersectionOptions& options,
                                                const Progress& progress) {
    for (const std::string& method : options.methods)
        if (std::none_of(scene::walk_methods().begin(), scene::walk_methods().end(),
                         [&](const scene::WalkMethod& m) { return method == m.name; })) {
            std::string names;
            for (const scene::WalkMethod& m : scene::walk_methods())
                names += text(names.empty() ? "" : ", ", m.name);
            throw Error("no method is called '" + method + "'", "use " + names);
        }
    const std::vector<Candidate> all = candidates(options);
    std::vector<IntersectionResult> results;
    render::Renderer renderer(scene, options.rays_in_step);
    if (options.cone_shift >= 0)
        renderer.set_cone_shift(options.cone_shift);
    const double total = double(views.size() * options.sizes.size() * all.size());
    for (const NamedView& named : views)
        for (const PictureSize& size : options.sizes) {
            scene::View view;
            view.camera = named.camera;
            view.lighting = scene::uniform_sky({0, 0, 1}, glm::dvec3(1), glm::dvec3(1));
            view.settings = {.width_px = size.width_px,
                             .height_px = size.height_px,
                             .samples = 1,
                             .shadows = false,
                             .reflection = false,
                             .refraction = false,
                             .earth_curvature = false,
                             .ground_albedo = {},
                             .strip = {},
                             .contours_m = {},
                             .depth_contours_m = {},
                             .depth_colours_m = {}};
            const Truth truth = truth_of(scene, view, options.judged_rays);
            for (const Candidate& candidate : all) {
                progress.report(double(results.size()) / total,
                                text(name, ", ", named.name, ", ", candidate.method->name));
                view.settings.walk = candidate.method->walk;
                view.settings.walk_setting = candidate.setting;
                const auto begin = std::chrono::steady_clock::now();
                renderer.prepare(view);
                glFinish();
                IntersectionResult r;
                r.set_up_ms = std::chrono::duration<double, std::milli>(
                                  std::chrono::steady_clock::now() - begin)
                                  .count();
                r.scene = name;
                r.view = named.name;
                r.method = candidate.method->name;
                r.source = candidate.method->source;
                r.exact = candidate.method->exact;
                r.setting = candidate.setting;
                r.nodes = scene.ground.size().cols;
                r.width_px = size.width_px;
                r.height_px = size.height_px;
                r.field_mb = double(renderer.field_bytes()) * 1e-6;
                r.time = time_on_gpu([&] { renderer.find_first_hits(); }, options.runs);
                judge(truth, renderer.read_first_hits(), r);
                results.push_back(r);
            }
        }
    return results;
}

void write_json(std::ostream& out, const std::string& device, const std::string& commit,
                const std::vector<IntersectionResult>& results) {
    out << "{\"device\": " << quoted(device) << ", \"commit\": " << quoted(commit)
        << ", \"results\": [";
    const char* comma = "\n";
    for (const IntersectionResult& r : results) {
        out << comma << "{\"scene\": " << quoted(r.scene) << ", \"view\": " << quoted(r.view)
            << ", \"method\": \"" << r.method << "\", \"source\": \"" << r.source
            << "\", \"settings\": {\"steps\": " << r.setting
            << "}, \"exact\": " << (r.exact ? "true" : "false") << ", \"nodes\": " << r.nodes
            << ", \"width\": " << r.width_px << ", \"height\": " << r.height_px
            << ", \"time_ms\": " << r.time.median_ms << ", \"time_q1_ms\": " << r.time.low_ms
            << ", \"time_q3_ms\": " << r.time.high_ms << ", \"clock\": \"" << r.time.clock
            << "\", \"rays_per_s\": "
            << double(r.width_px) * r.height_px / (r.time.median_ms * 1e-3)
            << ", \"field_mb\": " << r.field_mb << ", \"set_up_ms\": " << r.set_up_ms
            << ", \"judged\": " << r.judged << ", \"hits\": " << r.hits
            << ", \"missed_rate\": " << r.missed_rate << ", \"wrong_rate\": " << r.wrong_rate
            << ", \"mean_error\": " << r.mean_error << ", \"p95_error\": " << r.p95_error
            << ", \"p99_error\": " << r.p99_error << "}";
        comma = ",\n";
    }
    out << "\n]}\n";
}

} // namespace tarn::bench
