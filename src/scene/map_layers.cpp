#include "scene/map_layers.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "scene/drape.hpp"

#include <algorithm>

namespace tarn::scene {

bool drape_layers(Scene& scene, const std::vector<MapLayer>& layers) {
    std::vector<std::vector<glm::dvec2>> lines;
    std::vector<glm::dvec2> points;
    for (const MapLayer& layer : layers) {
        if (layer.heights)
            continue;
        for (const auto& line : layer.shapes.lines)
            lines.emplace_back(line.begin(), line.end());
        points.insert(points.end(), layer.shapes.points.begin(), layer.shapes.points.end());
    }
    scene.drape.reset();
    if (lines.empty() && points.empty())
        return true;
    scene.drape = make_drape(scene.ground, lines, points);
    return scene.drape.has_value();
}

void hang_layers(Scene& scene, const std::vector<MapLayer>& layers) {
    std::vector<SpaceStroke> strokes;
    std::vector<PlaceLabel> labels;
    const Heightfield& g = scene.ground;
    for (const MapLayer& layer : layers)
        try {
            if (layer.heights) {
                const auto made = make_strokes(scene, layer.shapes, *layer.heights);
                strokes.insert(strokes.end(), made.begin(), made.end());
                if (strokes.size() > most_strokes)
                    throw Error(
                        text("with it lines in space have more than ", most_strokes, " pieces"),
                        "cut or simplify them first, with ogr2ogr -clipsrc say");
            }
            for (std::size_t i = 0; i < layer.labels.size(); ++i) {
                const glm::dvec3& p = layer.shapes.points[i];
                if (layer.labels[i].empty())
                    continue;
                if (layer.heights)
                    labels.push_back({place_in_space(scene, p, *layer.heights), layer.labels[i]});
                else if (p.x >= g.west_m && p.x <= g.east_m() && p.y >= g.south_m() &&
                         p.y <= g.north_m) // at the water's surface, where there is some over it
                    labels.push_back({{p.x, p.y,
                                       std::max(scene.water_level_m(p.x, p.y).value_or(-1e9),
                                                g.elevation_m(p.x, p.y))},
                                      layer.labels[i]});
            }
        } catch (Error& error) {
            error.during(layer.name);
            throw;
        }
    scene.space_strokes = std::move(strokes);
    scene.labels = std::move(labels);
}

} // namespace tarn::scene
