#include "app/scenario_map.hpp"

#include "app/console.hpp"
#include "app/preview.hpp"
#include "core/text.hpp"
#include "dem/write.hpp"
#include "image/annotate.hpp"
#include "image/files.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::app {

namespace {

const std::vector<dem::MapClass>& classes() {
    static const std::vector<dem::MapClass> all = {{"as it was", 0, 0, 0},
                                                   {"newly flooded", 38, 120, 214},
                                                   {"newly exposed", 214, 150, 62},
                                                   {"under water at both levels", 150, 190, 214}};
    return all;
}

Grid<std::uint8_t> wet(const dem::Refill& refill) {
    Grid<std::uint8_t> out(refill.lake_of().size);
    for (std::size_t i = 0; i < out.values.size(); ++i)
        out.values[i] = int(refill.lake_of().values[i]) == refill.mark();
    return out;
}

} // namespace

DifferenceAreas write_difference(const scene::Scene& scene, dem::Refill& refill, double from_m,
                                 double to_m, const std::filesystem::path& base) {
    scene::Scene moved = scene;
    refill.fill(from_m, moved.ground, moved.water, moved.lakes, false);
    Grid<std::uint8_t> found = wet(refill);
    refill.fill(to_m, moved.ground, moved.water, moved.lakes, false);
    const Grid<std::uint8_t> now = wet(refill);
    refill.fill(refill.lake().level_m, moved.ground, moved.water, moved.lakes, false);
    const Grid<std::uint8_t> usual = wet(refill);
    DifferenceAreas areas;
    const double cell = scene.ground.spacing_m * scene.ground.spacing_m;
    for (std::size_t i = 0; i < found.values.size(); ++i) {
        const bool before = found.values[i] != 0, after = now.values[i] != 0;
        // Another lake that it takes up was water before.
        const bool other =
            !usual.values[i] && scene.water.codes.values[i] != no_water_code &&
            scene.ground.offset_m + scene.ground.scale_m * scene.ground.codes.values[i] <
                scene.water.offset_m + scene.water.scale_m * scene.water.codes.values[i];
        found.values[i] = (before || other) && after ? 3 : after ? 1 : before ? 2 : 0;
        areas.flooded_m2 += found.values[i] == 1 ? cell : 0.0;
        areas.exposed_m2 += found.values[i] == 2 ? cell : 0.0;
    }
    const std::filesystem::path tif = base.string() + ".tif", part = base.string() + ".part.tif";
    dem::write_classes(part, found, classes(), scene.ground, scene.frame, true);
    std::filesystem::rename(part, tif);

    // The map without any water of this lake, and the classes over it.
    scene::Scene dry = scene;
    for (std::size_t i = 0; i < found.values.size(); ++i)
        if (found.values[i] != 0 || usual.values[i] != 0)
            dry.water.codes.values[i] = no_water_code;
    Picture map = draw_map(dry, 1400);
    const double step = std::max(double(std::max(found.size.cols, found.size.rows)) / 1400.0, 0.25);
    for (int y = 0; y < map.height_px; ++y)
        for (int x = 0; x < map.width_px; ++x) {
            const Node n{std::min(int(std::lround((x + 0.5) * step)), found.size.cols - 1),
                         std::min(int(std::lround((y + 0.5) * step)), found.size.rows - 1)};
            const bool no_data = std::isnan(refill.heights_m()[n]);
            if (found[n] == 0 && !no_data)
                continue;
            const dem::MapClass c =
                no_data ? dem::MapClass{"no data", 200, 200, 200} : classes()[found[n]];
            std::uint8_t* p =
                &map.bytes[(std::size_t(y) * std::size_t(map.width_px) + std::size_t(x)) * 3];
            const std::uint8_t own[3] = {c.red, c.green, c.blue};
            if (no_data)
                std::fill(p, p + 3, c.red);
            for (int k = 0; k < 3; ++k) // some of the relief shows through
                p[k] = static_cast<std::uint8_t>((3 * own[k] + p[k]) / 4);
        }
    const int size = std::max(11, map.width_px / 60), margin = size;
    const LakeRecord& lake = refill.lake();
    image::draw_text(map, margin, margin + size, size,
                     (lake.name.empty() ? text("lake ", lake.id) : lake.name) + " from " +
                         fixed(from_m, 2) + " m to " + fixed(to_m, 2) + " m");
    const std::string lines[] = {"newly flooded: " + format_area(areas.flooded_m2),
                                 "newly exposed: " + format_area(areas.exposed_m2),
                                 "under water at both levels"};
    for (int k = 0; k < 3; ++k) {
        const int y = margin + size + (k + 1) * (size * 3 / 2);
        const dem::MapClass& c = classes()[std::size_t(k) + 1];
        image::fill_box(map, margin, y - size, margin + size, y, {c.red, c.green, c.blue});
        image::draw_text(map, margin + 2 * size, y, size, lines[k]);
    }
    image::write_png(base.string() + ".png", map, {{"Software", text("tarn ", TARN_VERSION)}});
    return areas;
}

} // namespace tarn::app
