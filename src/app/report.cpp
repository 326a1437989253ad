#include "app/report.hpp"

#include "app/console.hpp"
#include "core/text.hpp"
#include "geo/frame.hpp"
#include "scene/water_types.hpp"

#include <algorithm>
#include <ctime>

namespace tarn::app {

namespace {

std::string bed_words(const LakeRecord& lake) {
    return lake.bed == Bed::estimated ? "ESTIMATED, no survey" : to_string(lake.bed);
}

std::string lake_lines(const LakeRecord& lake) {
    std::string out = text("lake ", lake.id, lake.name.empty() ? "" : " " + lake.name, " at ",
                           fixed(lake.position.lat_deg, 4), ",", fixed(lake.position.lon_deg, 4),
                           ", level ", fixed(lake.level_m, 2), " m\n");
    out += text("  area        ", format_area(lake.area_m2), " in the grid's projection, ",
                format_area(lake.true_area_m2), " on the ellipsoid\n");
    if (!lake.volume_m3 || !lake.max_depth_m || !lake.mean_depth_m)
        out += "  bed         unknown: no volume, no depth\n";
    else
        out +=
            text("  volume      ", format_volume(*lake.volume_m3), " in the grid's projection, ",
                 format_volume(lake.true_volume_m3.value_or(*lake.volume_m3)),
                 " on the ellipsoid\n  depth       ", fixed(*lake.max_depth_m, 2), " m greatest, ",
                 fixed(*lake.mean_depth_m, 2), " m mean (bed ", bed_words(lake), ")\n");
    out += text("  shoreline   ", fixed(lake.shoreline_m / 1000.0, 2), " km, ", lake.islands,
                lake.islands == 1 ? " island" : " islands",
                lake.open_at_edge ? "; open at the edge of the data" : "", "\n");
    if (lake.spill && !lake.spill->at_surface)
        out +=
            text("  may rise    to ", fixed(lake.spill->level_m, 2), " m; then it spills over ",
                 fixed(lake.spill->pass.lat_deg, 5), ",", fixed(lake.spill->pass.lon_deg, 5), "\n");
    return out;
}

/// The lakes after the main one, a line each.
std::string other_lakes(const std::vector<LakeRecord>& lakes, std::size_t most) {
    if (lakes.size() < 2)
        return {};
    std::string out =
        text("other water: ", lakes.size() - 1,
             lakes.size() == 2 ? " surface at its own level\n" : " surfaces at their own levels\n");
    for (std::size_t i = 1; i < std::min(lakes.size(), most + 1); ++i) {
        const LakeRecord& lake = lakes[i];
        out += text("  ", lake.id, lake.name.empty() ? "" : " " + lake.name, ": ",
                    fixed(lake.level_m, 2), " m, ", format_area(lake.area_m2), " at ",
                    fixed(lake.position.lat_deg, 4), ",", fixed(lake.position.lon_deg, 4),
                    lake.bed == Bed::unknown ? "" : text(", bed ", bed_words(lake)),
                    lake.open_at_edge ? ", open at the edge of the data" : "", "\n");
    }
    if (lakes.size() > most + 1)
        out += text("  ... and ", lakes.size() - 1 - most, " more: tarn info lists them\n");
    return out;
}

} // namespace

std::string summary(const scene::Scene& scene) {
    std::string out = lake_lines(scene.lakes.front()) + other_lakes(scene.lakes, 8);
    for (const std::string& note : scene.report.notes)
        out += "  note: " + note + "\n";
    return out;
}

std::string full_report(const scene::Scene& scene) {
    const Heightfield& g = scene.ground;
    const GeoPoint origin = geo::to_geo(scene.frame, {0.0, 0.0});
    std::string out = lake_lines(scene.lakes.front()) + other_lakes(scene.lakes, 100'000);
    out += text("grid        ", g.size().cols, " x ", g.size().rows, " nodes, ", g.spacing_m,
                " m apart: ", fixed((g.size().cols - 1) * g.spacing_m / 1000, 2), " x ",
                fixed((g.size().rows - 1) * g.spacing_m / 1000, 2), " km\n");
    out +=
        text("heights     ", fixed(g.min_elevation_m(), 2), " to ", fixed(g.max_elevation_m(), 2),
             " m, in steps of ", fixed(1000.0 * g.scale_m, 2), " mm\n");
    out += text("frame       scene (0, 0) at ", fixed(origin.lat_deg, 6), ",",
                fixed(origin.lon_deg, 6), "; ", scene.frame.proj, "\n");
    out += text("heights in  vertical datum: ", scene.frame.vertical_datum, "\n");
    out += text("water       ", scene.optics.name, ", index ", scene.optics.index);
    if (!scene.optics.bands.empty())
        out += text(", a white disc disappears at ", fixed(scene::secchi_depth_m(scene.optics), 1),
                    " m");
    out += "\n";
    if (scene.ortho)
        out += text("picture     orthophoto ", scene.ortho->picture.width_px, " x ",
                    scene.ortho->picture.height_px, ", ", fixed(scene.ortho->spacing_m, 2),
                    " m a pixel\n");
    const ImportReport& r = scene.report;
    out += text("import      ", r.created, " by tarn ", r.tarn_version, "\n  ", r.command, "\n");
    for (const ImportInput& in : r.inputs)
        out += text("  ", in.role, " ", in.name, " (", in.format, ", ", in.size, ", crc32 ",
                    in.checksum, ")\n    CRS ", in.crs, "; vertical datum ", in.vertical, "\n");
    out += text("  resampling  ", r.resampling, "\n");
    out += text("  voids       ", r.void_nodes, " of ", r.nodes, " nodes; ", r.filled_nodes,
                " inside the data interpolated, ", r.outside_nodes,
                " open to the edge filled for the eye and never flooded\n");
    out += text("  flat        ", fixed(100.0 * r.flat_share, 1),
                " % of all nodes lie in flat surfaces (water without a bed)\n");
    for (const std::string& note : r.notes)
        out += "  note: " + note + "\n";
    return out;
}

std::string utc_now() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    gmtime_r(&now, &parts);
    char out[32];
    std::strftime(out, sizeof out, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return out;
}

} // namespace tarn::app
