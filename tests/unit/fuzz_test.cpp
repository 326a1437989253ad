// Damaged files at random: whatever a few changed bytes do, the importer gives an Error or a
// result, never a crash (run under the sanitizers too: docs/testing.md). TARN_FUZZ sets how many.
#include "core/error.hpp"
#include "dem/import.hpp"
#include "dem/soundings.hpp"
#include "dem/write.hpp"
#include "scene_files/source_list.hpp"
#include "support/files.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;
using test_support::TempFolder;

namespace {

int rounds() {
    const char* asked = std::getenv("TARN_FUZZ");
    return asked ? std::atoi(asked) : 150;
}

/// Changes, cuts or repeats some bytes, most of them near the beginning, where headers are.
std::string damaged(std::string bytes, std::mt19937& random) {
    const int changes = 1 + int(random() % 6u);
    for (int k = 0; k < changes && !bytes.empty(); ++k) {
        const std::size_t reach =
            random() % 3u ? std::min<std::size_t>(bytes.size(), 600) : bytes.size();
        const std::size_t at = random() % reach;
        switch (random() % 5u) {
        case 0:
            bytes[at] = char(random());
            break;
        case 1:
            bytes[at] = char(bytes[at] ^ (1 << (random() % 8u)));
            break;
        case 2:
            bytes[at] = random() % 2u ? char(0xff) : char(0);
            break;
        case 3:
            bytes.erase(at, 1 + random() % 8u);
            break;
        default:
            bytes.insert(at, bytes.substr(at, 1 + random() % 8u));
        }
    }
    if (random() % 10u == 0)
        bytes.resize(random() % (bytes.size() + 1));
    return bytes;
}

template <class Act>
void survive(const std::string& original, const std::filesystem::path& path, unsigned seed,
             Act act) {
    std::mt19937 random(seed);
    int refused = 0, taken = 0;
    for (int i = 0; i < rounds(); ++i) {
        std::ofstream(path, std::ios::binary) << damaged(original, random);
        try {
            act();
            ++taken;
        } catch (const Error& error) {
            ++refused;
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        }
    }
    EXPECT_EQ(refused + taken, rounds());
    EXPECT_GT(refused, 0) << path;
}

} // namespace

TEST(Fuzz, DamagedRastersNeverCrashTheImport) {
    const TempFolder folder;
    Grid<float> z({40, 40});
    for (int r = 0; r < 40; ++r)
        for (int c = 0; c < 40; ++c)
            z[{c, r}] = float(std::hypot(c - 20, r - 20));
    const double t[6] = {500'000, 10, 0, 5'300'000, 0, -10};
    dem::write_elevations(folder / "good.tif", z, "EPSG:32633", t, "");
    // A region small enough that a header which lies about the size costs nothing.
    const dem::Bounds here{14.999, 47.848, 15.006, 47.853};
    const auto import = [&](const std::filesystem::path& path, const std::string& crs) {
        dem::ImportOptions options{.dems = {path}, .level_m = 9.0, .bounds = here};
        options.crs = crs;
        dem::import_dem(options, {});
    };
    survive(test_support::read_file(folder / "good.tif"), folder / "bad.tif", 1,
            [&] { import(folder / "bad.tif", ""); });
    std::string ascii = "ncols 40\nnrows 40\nxllcorner 500000\nyllcorner 5299600\ncellsize 10\n"
                        "NODATA_value -9999\n";
    for (const float v : z.values)
        ascii += std::to_string(v) + " ";
    survive(ascii, folder / "bad.asc", 2, [&] { import(folder / "bad.asc", "EPSG:32633"); });
}

TEST(Fuzz, DamagedSoundingsAndSourceListsNeverCrash) {
    const TempFolder folder;
    dem::Mosaic mosaic;
    mosaic.frame = geo::Frame{};
    mosaic.frame.lon0_deg = 15.0;
    mosaic.elevation_m = Grid<float>({40, 40});
    mosaic.spacing_m = 10.0;
    std::string csv = "lon,lat,depth\n";
    for (int i = 0; i < 40; ++i)
        csv += "15.00" + std::to_string(i) + ",47.85" + std::to_string(i) + ",-" +
               std::to_string(i) + ".5\n";
    survive(csv.substr(0, 500), folder / "bad.csv", 3, [&] {
        dem::read_soundings(folder / "bad.csv", {.field = "depth", .crs = {}, .unit = {}}, mosaic);
    });
    survive(R"({"sources": [{"name": "mine", "url": "https://h/{NS}{lat}.tif", "tile_deg": 1,
                "missing_status": [403, 404], "named_by_north": true}]})",
            folder / "bad.json", 4, [&] { scene_files::read_sources(folder / "bad.json"); });
}
