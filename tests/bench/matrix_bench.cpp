// tarn_matrix_bench - the matrix of `tarn bench` over lakes made of formulas, without the
// reference: made of what draws alone, so it runs on a bare GPU machine. `tarn bench --from FILE
// --report FOLDER` draws what it wrote.
//
//   tarn_matrix_bench [--scenes bowl,mountain:4096] [--scaling mountain:1024] [--size WxH,WxH]
//                     [--wind M/S] [--samples N] [--runs N] [--views NAME,NAME] [--effects
//                     NAME,NAME]
//                     [--seed-table 1] [--json FILE]
#include "bench/matrix.hpp"
#include "bench/seed_table.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "gpu/context.hpp"
#include "scene/samples.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <glm/geometric.hpp>
#include <iostream>
#include <sstream>

namespace {

using namespace tarn;

int run(int argc, char** argv) {
    std::string scenes = "bowl,mountain:4096", scaling, sizes = "1920x1080", json, views;
    bench::MatrixOptions options{.runs = 31};
    std::vector<std::string> effects;
    bool seed_table = false;
    double wind = 6.0;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (i + 1 >= argc)
            throw Error(word + " needs a value");
        const std::string value = argv[++i];
        if (word == "--scenes")
            scenes = value;
        else if (word == "--scaling")
            scaling = value;
        else if (word == "--size")
            sizes = value;
        else if (word == "--seed-table")
            seed_table = value == "1";
        else if (word == "--wind")
            wind = std::atof(value.c_str());
        else if (word == "--samples")
            options.samples = std::max(1, std::atoi(value.c_str()));
        else if (word == "--runs")
            options.runs = std::max(1, std::atoi(value.c_str()));
        else if (word == "--views")
            views = value;
        else if (word == "--effects")
            effects = split(value, ',');
        else if (word == "--json")
            json = value;
        else
            throw Error("unknown option " + word);
    }
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
            if (std::sscanf(size.c_str(), "%dx%d", &options.width_px, &options.height_px) != 2)
                throw Error("--size '" + size + "' is not understood");
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
    try {
        return run(argc, argv);
    } catch (const std::exception& e) {
        std::cerr << e.what() << "\n";
        return 1;
    }
}
