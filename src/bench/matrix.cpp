#include "bench/matrix.hpp"

#include "core/text.hpp"
#include "gpu/objects.hpp"
#include "render/renderer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ostream>

namespace tarn::bench {

namespace {

/// Greatest departure of the mean over a tile from 1, over the depths of all cascades.
double flux_error(const render::SunlightVolume& sunlight, int cascades) {
    double worst = 0.0;
    for (int cascade = 0; cascade < cascades; ++cascade)
        for (int slice = 0; slice < sunlight.slices_of(cascade); ++slice) {
            double mean = 0.0;
            const std::vector<float> light = sunlight.read(cascade, slice);
            for (const float v : light)
                mean += double(v) / double(light.size());
            worst = std::max(worst, std::abs(mean - 1.0));
        }
    return worst;
}

void write_difference(std::ostream& out, const char* name, const image::Difference& d) {
    out << ", \"" << name << "\": {\"mean\": " << d.mean_relative << ", \"p95\": " << d.p95_relative
        << ", \"p99\": " << d.p99_relative << "}";
}

} // namespace

std::string quoted(const std::string& words) {
    std::string out = "\"";
    for (const char c : words) {
        if (c == '"' || c == '\\')
            out += '\\';
        out += static_cast<unsigned char>(c) < 32    ? ' '
               : static_cast<unsigned char>(c) < 127 ? c
                                                     : '?';
    }
    return out + "\"";
}

Image in_blocks(const Image& image, int side) {
    Image out;
    out.width_px = image.width_px / side;
    out.height_px = image.height_px / side;
    for (int y = 0; y < out.height_px; ++y)
        for (int x = 0; x < out.width_px; ++x) {
            glm::dvec3 sum(0.0);
            for (int j = 0; j < side; ++j)
                for (int i = 0; i < side; ++i)
                    sum += glm::dvec3(
                        image.radiance[std::size_t(y * side + j) * std::size_t(image.width_px) +
                                       std::size_t(x * side + i)]);
            out.radiance.emplace_back(sum / double(side * side));
            out.distance_m.push_back(0.0f);
        }
    return out;
}

std::vector<MatrixResult> run_matrix(const scene::Scene& scene, const MatrixScene& what,
                                     const MatrixOptions& options, const Progress& progress) {
    const bool wavy = !what.view.waves.calm();
    std::vector<Variant> rows;
    for (Variant& v : variants())
        if ((wavy || !v.needs_waves) && (v.name == "best" || options.effects.empty() ||
                                         std::find(options.effects.begin(), options.effects.end(),
                                                   v.effect) != options.effects.end()))
            rows.push_back(std::move(v));
    std::vector<MatrixResult> results;
    render::Renderer renderer(scene);
    if (options.budget.asked()) {
        options.budget.validate();
        std::string name = "planned";
        if (options.budget.max_error)
            name += text(" to ", 100.0 * *options.budget.max_error, " %");
        if (options.budget.frame_time_ms)
            name += text(" to ", *options.budget.frame_time_ms, " ms");
        rows.push_back({"all", name, false, [&](scene::View& v) {
                            v = render::make_plan(renderer, scene, v, options.budget, {}).view;
                        }});
    }
    const double quantum_m = scene.ground.scale_m;
    for (const scene::NamedCamera& named : what.views) {
        scene::View view = what.view;
        view.camera = named.camera;
        view.settings = {};
        view.settings.width_px = options.width_px;
        view.settings.height_px = options.height_px;
        view.settings.samples = options.samples;
        view = scene::at_its_best(view);
        const std::optional<Image> reference =
            options.reference ? options.reference(scene, view) : std::nullopt;
        Image best;
        for (const Variant& variant : rows) {
            progress.report(double(results.size()) / double(rows.size() * what.views.size()),
                            text(what.name, ", ", what.state, ", ", named.name, ", ",
                                 variant.effect, " ", variant.name));
            scene::View drawn = view;
            variant.apply(drawn);
            MatrixResult r;
            r.scene = what.name;
            r.view = named.name;
            r.state = what.state;
            r.effect = variant.effect;
            r.variant = variant.name;
            r.nodes = scene.ground.size().cols;
            r.width_px = options.width_px;
            r.height_px = options.height_px;
            const auto begin = std::chrono::steady_clock::now();
            renderer.prepare(drawn);
            renderer.draw_once(); // programs are made when they first run
            glFinish();
            r.set_up_ms =
                std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
                    .count();
            r.field_mb = double(renderer.field_bytes()) * 1e-6;
            const Image picture = renderer.draw_again();
            if (variant.name == "best")
                best = picture;
            r.error = image::compare(picture, best);
            r.hits_off = image::compare_distances(picture, best, quantum_m, 1e-5).different;
            if (options.perceptual)
                r.perceptual = options.perceptual(picture, best);
            if (reference && wavy)
                r.from_reference = image::compare(in_blocks(picture, 8), in_blocks(*reference, 8));
            else if (reference)
                r.from_reference = image::compare(picture, *reference);
            if (variant.effect == "caustics" && renderer.caustics())
                r.flux_error =
                    flux_error(renderer.sunlight(), int(renderer.waves()->sea().cascades.size()));
            double time_s = drawn.waves.time_s;
            const auto frame = [&] {
                renderer.move_waves(time_s += 1.0 / 60.0); // nothing where it is calm
                renderer.draw_once();
            };
            r.time = time_on_gpu(frame, options.runs);
            r.parts = time_parts(
                [&](const std::function<void(const char*)>& begins) {
                    renderer.on_pass = begins;
                    frame();
                    renderer.on_pass = {};
                },
                std::max(1, options.runs / 2));
            results.push_back(std::move(r));
        }
    }
    return results;
}

void write_json(std::ostream& out, const std::string& device, const std::string& commit,
                const std::vector<MatrixResult>& results, const std::string& seed_table) {
    out << "{\"device\": " << quoted(device) << ", \"commit\": " << quoted(commit)
        << ", \"results\": [";
    const char* comma = "\n";
    for (const MatrixResult& r : results) {
        out << comma << "{\"scene\": " << quoted(r.scene) << ", \"view\": " << quoted(r.view)
            << ", \"state\": " << quoted(r.state) << ", \"method\": " << quoted(r.effect)
            << ", \"settings\": {\"variant\": " << quoted(r.variant)
            << "}, \"exact\": " << (r.error.max_relative == 0.0 ? "true" : "false")
            << ", \"nodes\": " << r.nodes << ", \"width\": " << r.width_px
            << ", \"height\": " << r.height_px << ", \"time_ms\": " << r.time.median_ms
            << ", \"time_q1_ms\": " << r.time.low_ms << ", \"time_q3_ms\": " << r.time.high_ms
            << ", \"clock\": \"" << r.time.clock << "\", \"set_up_ms\": " << r.set_up_ms
            << ", \"field_mb\": " << r.field_mb
            << ", \"wrong_rate\": " << double(r.hits_off) / (double(r.width_px) * r.height_px);
        write_difference(out, "error", r.error);
        if (r.from_reference)
            write_difference(out, "error_from_reference", *r.from_reference);
        if (r.perceptual)
            out << ", \"perceptual_share\": " << *r.perceptual;
        if (r.flux_error)
            out << ", \"flux_error\": " << *r.flux_error;
        out << ", \"passes_ms\": {";
        const char* between = "";
        std::vector<std::string> seen; // a pass for each cascade counts as one
        for (const PartTime& p : r.parts) {
            if (std::find(seen.begin(), seen.end(), p.name) != seen.end())
                continue;
            seen.push_back(p.name);
            double sum = 0.0;
            for (const PartTime& other : r.parts)
                sum += other.name == p.name ? other.median_ms : 0.0;
            out << between << quoted(p.name) << ": " << sum;
            between = ", ";
        }
        out << "}}";
        comma = ",\n";
    }
    out << "\n]";
    if (!seed_table.empty())
        out << ", \"seed_table\": " << seed_table;
    out << "}\n";
}

} // namespace tarn::bench
