// Time and memory of `tarn import` against gdalwarp on the same mosaic, region and grid.
//
//   tarn_import_bench --tarn build/release/src/tarn --folder DIR [--side 20000] [--region 10000]
//
// Makes a synthetic float mosaic of 4 x 4 geographic tiles (hills with flat lakes between them),
// imports the middle of it, and lets gdalwarp do the same warp: the import's own projection,
// extent and size, cubic, Float32. Peak memory is what wait4() reports of the whole process.
// Prints one table; --json prints the same for programs.
#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/gdal_door.hpp"
#include "dem/write.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <iostream>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr double west_deg = 8.0, north_deg = 47.0, step_deg = 1.0 / 3600.0; // 1": SRTM's grid
constexpr int tiles_a_side = 4;

/// Hills of several sizes, cut off below by lakes: about a tenth of the area, as in Finland.
float height(double x, double y) {
    const double z = 500.0 + 180.0 * std::sin(x / 910.0) * std::cos(y / 770.0) +
                     60.0 * std::sin(x / 143.0 + 1.0) * std::sin(y / 171.0) +
                     15.0 * std::sin(x / 31.0) * std::cos(y / 27.0 + 0.5) +
                     3.0 * std::sin(x / 7.3 + y / 9.1);
    const double lake = 330.0 + 10.0 * std::floor(x / 4000.0);
    return float(std::max(z, lake));
}

void make_tile(const fs::path& path, int col, int row, int side) {
    tarn::Grid<float> z({side, side});
    for (int r = 0; r < side; ++r)
        for (int c = 0; c < side; ++c)
            z[{c, r}] = height(col * side + c, row * side + r);
    auto* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
    CPLStringList options;
    options.SetNameValue("TILED", "YES");
    tarn::dem::Dataset out(
        driver->Create(path.c_str(), side, side, 1, GDT_Float32, options.List()));
    double transform[6] = {west_deg + col * side * step_deg,  step_deg, 0.0,
                           north_deg - row * side * step_deg, 0.0,      -step_deg};
    OGRSpatialReference crs;
    crs.SetFromUserInput("EPSG:4326");
    if (!out || out->SetGeoTransform(transform) != CE_None || out->SetSpatialRef(&crs) != CE_None ||
        out->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, side, side, z.values.data(), side, side,
                                        GDT_Float32, 0, 0) != CE_None)
        throw tarn::Error(path.string() + ": cannot be written", "check the free space");
}

struct Run {
    double seconds = 0.0, peak_mb = 0.0;
    int code = -1;
};

Run run(const std::vector<std::string>& words, const fs::path& log) {
    std::vector<char*> arguments;
    for (const std::string& word : words)
        arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const auto begin = std::chrono::steady_clock::now();
    const pid_t child = ::fork();
    if (child == 0) {
        const int out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
        ::dup2(out, 1);
        ::dup2(out, 2);
        ::execvp(arguments[0], arguments.data());
        ::_exit(127);
    }
    int status = 0;
    rusage usage{};
    ::wait4(child, &status, 0, &usage);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    return {took.count(), double(usage.ru_maxrss) / 1024.0,
            WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status)};
}

std::string option(int argc, char** argv, const char* name, const std::string& otherwise) {
    for (int i = 1; i + 1 < argc; ++i)
        if (std::strcmp(argv[i], name) == 0)
            return argv[i + 1];
    return otherwise;
}

int bench(int argc, char** argv) {
    using tarn::fixed;
    using tarn::text;
    const std::string tarn_program = option(argc, argv, "--tarn", "build/release/src/tarn");
    const fs::path folder = option(argc, argv, "--folder", "");
    const int side = std::stoi(option(argc, argv, "--side", "20000"));
    const int region = std::stoi(option(argc, argv, "--region", "10000"));
    const int repeats = std::max(1, std::stoi(option(argc, argv, "--repeats", "3")));
    const bool json =
        std::any_of(argv, argv + argc, [](const char* a) { return std::strcmp(a, "--json") == 0; });
    if (folder.empty())
        throw tarn::Error("no --folder given", "name one with room for the mosaic");
    fs::create_directories(folder);
    tarn::dem::register_drivers();
    std::vector<std::string> tiles;
    const int part = side / tiles_a_side;
    for (int row = 0; row < tiles_a_side; ++row)
        for (int col = 0; col < tiles_a_side; ++col) {
            const fs::path path = folder / text("tile_", side, "_", row, col, ".tif");
            tiles.push_back(path.string());
            if (!fs::exists(path))
                make_tile(path, col, row, part);
        }

    // A region that is `region` nodes high at the source's own spacing.
    const double metres = 30.0, half_deg = 0.5 * region * metres / 111'200.0;
    const double lat = north_deg - 0.5 * side * step_deg, lon = west_deg + 0.5 * side * step_deg;
    const double wide = half_deg / std::cos(lat * M_PI / 180.0);
    const fs::path scene = folder / "scene", warped = folder / "warped.tif";
    std::vector<std::string> import = {tarn_program, "import"};
    import.insert(import.end(), tiles.begin(), tiles.end());
    for (const std::string& word :
         {std::string("--bounds"),
          text(lon - wide, ",", lat - half_deg, ",", lon + wide, ",", lat + half_deg),
          std::string("--spacing"), text(metres), std::string("-o"), scene.string()})
        import.push_back(word);
    std::vector<Run> ours, theirs, threaded;
    std::string warp_words;
    int cols = 0, rows = 0;
    for (int i = 0; i < repeats; ++i) {
        ours.push_back(run(import, folder / "import.log"));
        if (ours.back().code != 0)
            throw tarn::Error(text("tarn import failed, see ", (folder / "import.log").string()));
        tarn::dem::Dataset made(
            GDALDataset::Open((scene / "ground.tif").c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
        double g[6];
        if (!made || made->GetGeoTransform(g) != CE_None || !made->GetSpatialRef())
            throw tarn::Error("the imported scene cannot be read");
        cols = made->GetRasterXSize();
        rows = made->GetRasterYSize();
        char* wkt = nullptr;
        made->GetSpatialRef()->exportToWkt(&wkt);
        std::vector<std::string> warp = {"gdalwarp", "-q",      "-overwrite", "-r", "cubic",
                                         "-ot",      "Float32", "-t_srs",     wkt,  "-te"};
        CPLFree(wkt);
        for (const double v : {g[0], g[3] + rows * g[5], g[0] + cols * g[1], g[3]})
            warp.push_back(text(v));
        for (const std::string& word : {std::string("-ts"), text(cols), text(rows)})
            warp.push_back(word);
        warp.insert(warp.end(), tiles.begin(), tiles.end());
        warp.push_back(warped.string());
        theirs.push_back(run(warp, folder / "gdalwarp.log"));
        if (theirs.back().code != 0)
            throw tarn::Error(text("gdalwarp failed, see ", (folder / "gdalwarp.log").string()));
        fs::remove(warped);
        warp.insert(warp.begin() + 1, {"-multi", "-wo", "NUM_THREADS=ALL_CPUS"});
        threaded.push_back(run(warp, folder / "gdalwarp.log"));
        fs::remove(warped);
    }
    const auto median = [](std::vector<Run> runs, double Run::*field) {
        std::sort(runs.begin(), runs.end(),
                  [&](const Run& a, const Run& b) { return a.*field < b.*field; });
        return runs[runs.size() / 2].*field;
    };
    const double nodes = double(cols) * rows;
    const double pair_mb = nodes * 4.0 / 1048576.0, all_mb = nodes * 8.0 / 1048576.0;
    const double t = median(ours, &Run::seconds), w = median(theirs, &Run::seconds);
    const double wt = median(threaded, &Run::seconds);
    const double m = median(ours, &Run::peak_mb), wm = median(theirs, &Run::peak_mb);
    if (json)
        std::cout << text("{\"cols\": ", cols, ", \"rows\": ", rows, ", \"mosaic_side\": ", side,
                          ", \"import_s\": ", t, ", \"gdalwarp_s\": ", w,
                          ", \"time_ratio\": ", t / w, ", \"import_peak_mb\": ", m,
                          ", \"gdalwarp_peak_mb\": ", wm, ", \"ground_and_water_mb\": ", pair_mb,
                          ", \"rasters_mb\": ", all_mb, ", \"memory_ratio\": ", m / all_mb,
                          ", \"memory_ratio_16_bit\": ", m / pair_mb,
                          ", \"cores\": ", std::thread::hardware_concurrency(), "}\n");
    else
        std::cout << text("mosaic ", side, " x ", side, " float (", tiles.size(), " tiles) -> ",
                          cols, " x ", rows, " nodes, ", std::thread::hardware_concurrency(),
                          " cores, median of ", repeats, "\n",
                          "                      time [s]   peak memory [MB]\n",
                          "  gdalwarp            ", fixed(w, 1), "       ", fixed(wm, 0), "\n",
                          "  tarn import         ", fixed(t, 1), "       ", fixed(m, 0), "\n",
                          "  ratio               ", fixed(t / w, 2), " of gdalwarp, ",
                          fixed(t / wt, 2), " of gdalwarp with -multi -wo NUM_THREADS=ALL_CPUS\n",
                          "  peak / (ground + water + heights, ", fixed(all_mb, 0), " MB)   ",
                          fixed(m / all_mb, 2), "\n", "  peak / (ground + water, ",
                          fixed(pair_mb, 0), " MB)             ", fixed(m / pair_mb, 2), "\n");
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    try {
        return bench(argc, argv);
    } catch (const std::exception& error) {
        std::cerr << "tarn_import_bench: " << error.what() << "\n";
        return 1;
    }
}
