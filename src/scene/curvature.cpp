#include "scene/curvature.hpp"

#include <algorithm>
#include <cmath>

namespace tarn::scene {

CurvatureDrop curvature_drop(const Scene& scene, const Camera& camera, int height_px) {
    const Heightfield& g = scene.ground;
    const glm::dvec3& p = camera.position;
    CurvatureDrop out;
    out.distance_m = std::hypot(std::max(std::abs(g.west_m - p.x), std::abs(g.east_m() - p.x)),
                                std::max(std::abs(g.south_m() - p.y), std::abs(g.north_m - p.y)));
    out.drop_m = bend_per_m * out.distance_m * out.distance_m;
    out.pixels = bend_per_m * out.distance_m / pixel_rad(camera, height_px);
    return out;
}

bool is_curved(const Scene& scene, const View& view) {
    if (view.settings.earth_curvature)
        return *view.settings.earth_curvature;
    return curvature_drop(scene, view.camera, view.settings.height_px).pixels > 1.0;
}

} // namespace tarn::scene
