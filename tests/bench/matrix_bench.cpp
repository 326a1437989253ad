// tarn_matrix_bench - the matrix of `tarn bench` over lakes made of formulas, without the
// reference: made of what draws alone, so it runs on a bare GPU machine. `tarn bench --from FILE
// --report FOLDER` draws what it wrote.
//
//   tarn_matrix_bench [--scenes bowl,mountain:4096] [--scaling mountain:1024] [--size WxH,WxH]
//                     [--wind M/S] [--samples N] [--runs N] [--views NAME,NAME] [--effects
//                     NAME,NAME]
//                     [--seed-table 1] [--json FILE]
#include "bench/matrix.hpp"
#include "bench/program.hpp"
#include "bench/seed_table.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "scene/samples.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <glm/geometric.hpp>
#include <iostream>
#include <sstream>

namespace {

using namespace tarn;

int run(const bench::Words& words) {
    const std::string scenes = words.text("--scenes", "bowl,mountain:4096"),
                      scaling = words.text("--scaling"), json = words.text("--json"),
                      sizes = words.text("--size", "1920x1080"), views = words.text("--views");
    bench::MatrixOptions options;
    options.samples = words.count("--samples", options.samples);
    options.runs = words.count("--runs", 31);
    const std::vector<std::string> effects = split(words.text("--effects"), ',');
    const bool seed_table = words.text("--seed-table") == "1";
    const double wind = words.number("--wind", 6.0);
    const gpu::Context context;
    std::vector<bench::MatrixResult> results;
    const auto write = [&](const std::string& table) { // as far as it has come
        if (json.empty())
            return;
        std::ofstream out(json);
        bench::write_json(out, context.renderer(), TARN_COMMIT, results, table);
    };
    std::ostringstream table;
    if (seed_table)
        bench::write_seed_table(
            table, 1024, wind,
            bench::measure_seed_table(scene::mountain_lake(1024), wind, options.runs, {}));
    write(table.str());
    const std::size_t whole = split(scenes, ',').size(); // those after are drawn as a whole only
    const std::vector<std::string> names =
        split(scaling.empty() ? scenes : scenes + "," + scaling, ',');
    for (std::size_t at = 0; at < names.size(); ++at) {
        const std::string& name = names[at];
        if (name == "none") // the seed's table alone
            continue;
        const std::vector<std::string> parts = split(name, ':');
        const scene::Scene scene = parts.size() == 2
                                       ? scene::mountain_lake(std::atoi(parts[1].c_str()))
                                       : scene::bowl(513);
        const glm::dvec3 sun = glm::normalize(glm::dvec3(0.5, -0.4, 0.75));
        bool first = at < whole;
        for (const std::string& size : split(sizes, ',')) {
            const auto [width, height] = bench::parse_size(size);
            options.width_px = width;
            options.height_px = height;
            options.effects = first ? effects : std::vector<std::string>{"all"};
            first = false;
            for (const double speed :
                 wind > 0.0 ? std::vector<double>{0.0, wind} : std::vector<double>{0.0}) {
                bench::MatrixScene what;
                what.name = name;
                what.state = speed > 0.0 ? text("wind ", speed, " m/s") : "calm";
                for (const scene::NamedCamera& view : bench::standard_views(
                         scene, sun, double(options.width_px) / options.height_px))
                    if (views.empty() ||
                        ("," + views + ",").find("," + view.name + ",") != std::string::npos)
                        what.views.push_back(view);
                what.view.lighting = scene::clear_sky(sun);
                if (speed > 0.0) {
                    what.view.waves.model = waves::Model::jonswap;
                    what.view.waves.wind_m_per_s = speed;
                    if (gpu::is_software()) // as `tarn bench`
                        what.view.waves.texels = 256;
                }
                for (bench::MatrixResult& r : bench::run_matrix(scene, what, options, {}))
                    results.push_back(std::move(r));
                write(table.str());
                std::cout << name << ", " << what.state << ", " << size << ": " << results.size()
                          << " rows so far" << std::endl;
            }
        }
    }
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    return tarn::bench::program(argc, argv,
                                {"--scenes", "--scaling", "--size", "--seed-table", "--wind",
                                 "--samples", "--runs", "--views", "--effects", "--json"},
                                run);
}
