#include "bench/seed_table.hpp"

#include "core/text.hpp"
#include "render/renderer.hpp"

#include <glm/geometric.hpp>
#include <ostream>

namespace tarn::bench {

namespace {

/// What each column adds to the one before.
struct Mode {
    bool reflection, caustics;
    int shafts;
    bool shadows;
};
const Mode modes[] = {{false, false, 0, false},
                      {true, false, 0, false},
                      {true, true, 0, false},
                      {true, true, 2, false},
                      {true, true, 2, true}};

/// Share of the picture whose first hit is water.
double coverage(render::Renderer& renderer, const scene::View& view) {
    renderer.prepare(view);
    renderer.find_first_hits();
    double wet = 0.0;
    const std::vector<float> hits = renderer.read_first_hits();
    for (const float d : hits)
        wet += d < 0.0f;
    return wet / double(hits.size());
}

} // namespace

const std::vector<std::string> seed_table_modes = {"refraction", "+ reflection of land and sky",
                                                   "+ caustics", "+ shafts of light", "+ shadows"};

std::vector<SeedRow> measure_seed_table(const scene::Scene& scene, double wind_m_per_s, int runs,
                                        const Progress& progress) {
    render::Renderer renderer(scene);
    const double level = scene.lakes.front().level_m;
    scene::View view;
    view.lighting = scene::clear_sky(glm::normalize(glm::dvec3(0.5, -0.4, 0.75)));
    view.settings.width_px = 800;
    view.settings.height_px = 600;
    view.settings.samples = 1;
    if (wind_m_per_s > 0.0) {
        view.waves.model = waves::Model::jonswap;
        view.waves.wind_m_per_s = wind_m_per_s;
    }
    std::vector<SeedRow> rows;
    for (const double wanted : {1.0, 0.5, 0.25}) {
        SeedRow row;
        double low = -89.0, high = 40.0;
        for (int i = 0; i < (wanted == 1.0 ? 1 : 24); ++i) {
            const double pitch = wanted == 1.0 ? -60.0 : 0.5 * (low + high);
            view.camera = scene::look({-400, -1500, level + 60.0}, 5.0, pitch, 45.0);
            row.water_share = coverage(renderer, view);
            (row.water_share > wanted ? low : high) = pitch;
        }
        for (const Mode& mode : modes) {
            progress.report(double(rows.size() * std::size(modes) + row.times.size()) /
                                double(3 * std::size(modes)),
                            "the seed's Table 1");
            scene::View drawn = view;
            drawn.settings.reflection = mode.reflection;
            drawn.settings.caustics = mode.caustics ? scene::Caustics::splat : scene::Caustics::off;
            drawn.settings.shaft_steps = mode.shafts;
            drawn.settings.shadows = mode.shadows;
            renderer.prepare(drawn);
            double time_s = 0.0;
            const auto frame = [&] {
                renderer.move_waves(time_s += 1.0 / 60.0);
                renderer.draw_once();
            };
            row.times.push_back(time_on_gpu(frame, runs));
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

void write_seed_table(std::ostream& out, int nodes, double wind_m_per_s,
                      const std::vector<SeedRow>& rows) {
    out << "{\"nodes\": " << nodes << ", \"wind_m_per_s\": " << wind_m_per_s << ", \"modes\": [";
    const char* comma = "";
    for (const std::string& mode : seed_table_modes) {
        out << comma << '"' << mode << '"';
        comma = ", ";
    }
    out << "], \"rows\": [";
    comma = "";
    for (const SeedRow& row : rows) {
        out << comma << "{\"water_share\": " << row.water_share << ", \"time_ms\": [";
        const char* between = "";
        for (const Times& t : row.times) {
            out << between << t.median_ms;
            between = ", ";
        }
        out << "]}";
        comma = ", ";
    }
    out << "]}";
}

} // namespace tarn::bench
