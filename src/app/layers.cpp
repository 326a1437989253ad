#include "app/layers.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/vectors.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>

namespace tarn::app {

scene::MapLayer read_layer(const std::string& path, const geo::Frame& frame) {
    scene::MapLayer out;
    out.name = std::filesystem::path(path).filename().string();
    const auto place = [](const dem::VectorPlace& p) { return glm::dvec3(p.x_m, p.y_m, p.z_m); };
    for (const dem::VectorFeature& f : dem::read_vectors(path, frame)) {
        for (const auto& line : f.lines)
            std::transform(line.begin(), line.end(),
                           std::back_inserter(out.shapes.lines.emplace_back()), place);
        for (const dem::VectorPlace& p : f.points) {
            out.shapes.points.push_back(place(p));
            out.labels.push_back(f.label);
        }
    }
    return out;
}

std::vector<scene::MapLayer> read_layers(const ViewWords& words, const geo::Frame& frame) {
    std::vector<scene::MapLayer> out;
    for (const std::string& path : split(words.layers, ':'))
        out.push_back(read_layer(path, frame));
    for (const std::string& path : split(words.layers_3d, ':')) {
        out.push_back(read_layer(path, frame));
        out.back().heights = scene::heights_from(words.layers_3d_heights);
    }
    return out;
}

void lay_layers(const std::vector<scene::MapLayer>& layers, scene::Scene& scene) {
    if (!scene::drape_layers(scene, layers))
        throw Error("--layers: nothing of them lies on the scene", "check their places and CRS");
    scene::hang_layers(scene, layers);
}

} // namespace tarn::app
