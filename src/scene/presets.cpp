#include "scene/presets.hpp"

#include "core/angles.hpp"
#include "core/error.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace tarn::scene {

namespace {

struct Place {
    glm::dvec2 centre;           ///< of the lake's bounding box
    glm::dvec2 half;             ///< half its sides
    double radius;               ///< half its diagonal
    std::vector<glm::dvec2> wet; ///< up to some hundred places on the lake
};

bool is_wet(const Scene& scene, const LakeRecord& lake, Node n) {
    return scene.water.codes.contains(n) && scene.water.codes[n] != no_water_code &&
           std::abs(scene.water.elevation_m(n) - lake.level_m) < 0.01 &&
           scene.ground.elevation_m(n) < lake.level_m;
}

Place survey(const Scene& scene, const LakeRecord& lake) {
    const Heightfield& g = scene.ground;
    const double w = g.x_m(lake.west_north.col), e = g.x_m(lake.east_south.col);
    const double n = g.y_m(lake.west_north.row), s = g.y_m(lake.east_south.row);
    Place place{.centre = {(w + e) / 2, (n + s) / 2},
                .half = {std::max((e - w) / 2, g.spacing_m), std::max((n - s) / 2, g.spacing_m)},
                .radius = std::max(std::hypot(e - w, n - s) / 2, g.spacing_m),
                .wet = {}};
    const int cols = lake.east_south.col - lake.west_north.col + 1;
    const int rows = lake.east_south.row - lake.west_north.row + 1;
    const int step = std::max(1, int(std::sqrt(double(cols) * rows / 400.0)));
    for (int row = lake.west_north.row; row <= lake.east_south.row; row += step)
        for (int col = lake.west_north.col; col <= lake.east_south.col; col += step)
            if (is_wet(scene, lake, {col, row}))
                place.wet.emplace_back(g.x_m(col), g.y_m(row));
    if (place.wet.empty())
        place.wet.emplace_back(g.x_m(lake.seed.col), g.y_m(lake.seed.row));
    return place;
}

bool inside(const Heightfield& g, glm::dvec2 p) {
    return p.x > g.west_m && p.x < g.east_m() && p.y < g.north_m && p.y > g.south_m();
}

/// Is the straight line from `eye` to `target` above the ground? Sampled: a choice, not a proof.
bool sees(const Scene& scene, glm::dvec3 eye, glm::dvec3 target) {
    constexpr int steps = 96;
    for (int i = 1; i < steps; ++i) {
        const glm::dvec3 p = eye + (target - eye) * (double(i) / steps);
        if (scene.ground.elevation_m(p.x, p.y) > p.z + 0.5)
            return false;
    }
    return true;
}

double visible_share(const Scene& scene, const LakeRecord& lake, const Place& place,
                     glm::dvec3 eye) {
    std::size_t seen = 0;
    for (const glm::dvec2 p : place.wet)
        seen += sees(scene, eye, {p, lake.level_m});
    return double(seen) / double(place.wet.size());
}

/// 1 with the sun over the photographer's shoulder, 0 with it in his face.
double sun_bonus(glm::dvec2 view, glm::dvec3 sun) {
    const glm::dvec2 s(sun.x, sun.y);
    if (glm::length(s) < 1e-6)
        return 0.5;
    const double behind = -glm::dot(glm::normalize(view), glm::normalize(s));
    return 1.0 - std::abs(behind - 0.5) / 1.5;
}

Camera overview(const Scene& scene, const LakeRecord& lake, glm::dvec3 sun, double aspect) {
    const Place place = survey(scene, lake);
    constexpr double fov = 45.0;
    Camera best;
    double best_score = -1e9;
    for (const double pitch : {-22.0, -30.0, -40.0})
        for (int k = 0; k < 24; ++k) {
            const double heading = 15.0 * k;
            const glm::dvec2 view(std::sin(heading * degree), std::cos(heading * degree));
            // Wide enough for the lake as seen along this heading.
            const glm::dvec2 across(view.y, -view.x);
            const double half_width =
                std::abs(across.x) * place.half.x + std::abs(across.y) * place.half.y;
            const double half_depth =
                std::abs(view.x) * place.half.x + std::abs(view.y) * place.half.y;
            const double spread = std::tan(0.5 * fov * degree) * aspect;
            const double distance =
                std::max(1.02 * half_width / spread + 0.45 * half_depth, 1.3 * half_depth);
            const glm::dvec2 p = place.centre - view * distance;
            const double level = lake.level_m;
            double z = level + distance * std::tan(-pitch * degree) * 0.9;
            const double ground = scene.ground.elevation_m(p.x, p.y);
            z = std::max(z, ground + 0.04 * place.radius + 2.0);
            const double down = std::atan2(level - z, distance) / degree;
            // Aim a little beyond the middle, so that land and sky close the picture.
            const Camera camera = look({p, z}, heading, down + 2.5, fov);
            double score = 2.0 * visible_share(scene, lake, place, camera.position) +
                           0.5 * sun_bonus(view, sun) + 0.01 * (pitch + 30.0);
            if (!inside(scene.ground, p)) // the cut edge of the land would be in the foreground
                score -= 1.0;
            // High ground beyond the lake makes the picture.
            const glm::dvec2 beyond = place.centre + view * (place.radius * 1.6);
            if (inside(scene.ground, beyond))
                score += 0.4 * std::clamp((scene.ground.elevation_m(beyond.x, beyond.y) - level) /
                                              (0.3 * place.radius),
                                          0.0, 1.0);
            if (score > best_score) {
                best_score = score;
                best = camera;
            }
        }
    return best;
}

Camera shore(const Scene& scene, const LakeRecord& lake, glm::dvec3 sun) {
    const Place place = survey(scene, lake);
    const double height = std::clamp(0.012 * place.radius, 4.0, 40.0);
    const glm::dvec2 middle(scene.ground.x_m(lake.seed.col), scene.ground.y_m(lake.seed.row));
    Camera best = look({middle, lake.level_m + height}, 0.0, -6.0, 55.0);
    double best_score = -1e9;
    for (int k = 0; k < 72; ++k) {
        const double heading = 5.0 * k;
        const glm::dvec2 view(std::sin(heading * degree), std::cos(heading * degree));
        // Walk back from the middle of the lake to the bank, then a few steps up it.
        double back = 0.0;
        const double step = 0.5 * scene.ground.spacing_m;
        while (back < 4.0 * place.radius &&
               scene.water_level_m(middle.x - view.x * back, middle.y - view.y * back))
            back += step;
        const glm::dvec2 p = middle - view * (back + 0.5 * scene.ground.spacing_m);
        if (!inside(scene.ground, p))
            continue;
        double fetch = 0.0;
        while (fetch < 4.0 * place.radius &&
               scene.water_level_m(middle.x + view.x * fetch, middle.y + view.y * fetch))
            fetch += step;
        const double z = std::max(lake.level_m, scene.ground.elevation_m(p.x, p.y)) + height;
        double skyline = 0.0;
        for (int i = 1; i <= 24; ++i) {
            const double d = (fetch + 0.15 * i * place.radius);
            const glm::dvec2 q = middle + view * d;
            if (inside(scene.ground, q))
                skyline =
                    std::max(skyline, (scene.ground.elevation_m(q.x, q.y) - z) / (d + back) / 0.15);
        }
        const double high_bank = (z - lake.level_m) / (6.0 * height);
        const double score = std::min((back + fetch) / place.radius, 1.5) +
                             0.6 * std::min(skyline, 1.5) + 0.7 * sun_bonus(view, sun) -
                             std::max(0.0, high_bank - 1.0);
        if (score > best_score) {
            best_score = score;
            best = look({p, z}, heading, -7.0, 55.0);
        }
    }
    return best;
}

Camera top(const LakeRecord& lake, const Place& place, double aspect) {
    constexpr double fov = 40.0;
    const double half = 1.25 * std::max(place.half.y, place.half.x / aspect);
    const double height = half / std::tan(0.5 * fov * degree);
    return look({place.centre, lake.level_m + height}, 0.0, -90.0, fov);
}

Camera dive(const Scene& scene, const LakeRecord& lake, glm::dvec3 sun) {
    const Heightfield& g = scene.ground;
    // Some metres of water over a sloping bed, in reach of sunlight and of the eye.
    const glm::dvec3 c = scene.optics.attenuation_per_m();
    const double clearest = std::max(1e-3, std::min({c.x, c.y, c.z}));
    const double reach = std::clamp(1.2 / clearest, 2.0, 40.0);
    double deepest = 0.0;
    for (int row = lake.west_north.row; row <= lake.east_south.row; ++row)
        for (int col = lake.west_north.col; col <= lake.east_south.col; ++col)
            if (is_wet(scene, lake, {col, row}))
                deepest = std::max(deepest, lake.level_m - g.elevation_m(Node{col, row}));
    const double wish = std::min(0.35 * reach, 0.5 * deepest);
    Node best = lake.seed;
    glm::dvec2 best_view(0, 1);
    double best_score = -1e9;
    for (int row = lake.west_north.row; row <= lake.east_south.row; ++row)
        for (int col = lake.west_north.col; col <= lake.east_south.col; ++col) {
            const Node n{col, row};
            const Node e{col + 1, row}, w{col - 1, row}, nn{col, row - 1}, s{col, row + 1};
            if (!is_wet(scene, lake, n) || !g.codes.contains(e) || !g.codes.contains(w) ||
                !g.codes.contains(nn) || !g.codes.contains(s))
                continue;
            const double depth = lake.level_m - g.elevation_m(n);
            const glm::dvec2 slope((g.elevation_m(e) - g.elevation_m(w)) / (2 * g.spacing_m),
                                   (g.elevation_m(nn) - g.elevation_m(s)) / (2 * g.spacing_m));
            const double steep = glm::length(slope);
            if (steep < 1e-6)
                continue;
            const glm::dvec2 uphill = slope / steep;
            const double score = -2.0 * std::abs(depth - wish) / wish + 1.5 * std::min(steep, 0.5) +
                                 0.3 * sun_bonus(uphill, sun);
            if (score > best_score) {
                best_score = score;
                best = n;
                best_view = uphill;
            }
        }
    const double bed = g.elevation_m(best), depth = lake.level_m - bed;
    // Along the slope, with the bank on one side: bed below, the mirror of the surface above.
    const double heading = std::atan2(best_view.x, best_view.y) / degree + 35.0;
    const double z = bed + 0.4 * depth;
    return look({g.x_m(best.col), g.y_m(best.row), z}, heading, 8.0, 75.0);
}

} // namespace

const std::vector<std::string>& preset_names() {
    static const std::vector<std::string> names = {"overview", "shore", "top", "dive"};
    return names;
}

Camera preset_camera(const Scene& scene, const LakeRecord& lake, const std::string& name,
                     glm::dvec3 sun_direction, double aspect) {
    if (name == "overview")
        return overview(scene, lake, sun_direction, aspect);
    if (name == "shore")
        return shore(scene, lake, sun_direction);
    if (name == "top")
        return top(lake, survey(scene, lake), aspect);
    if (name == "dive")
        return dive(scene, lake, sun_direction);
    throw Error("no camera is called '" + name + "'", "use overview, shore, top or dive");
}

} // namespace tarn::scene
