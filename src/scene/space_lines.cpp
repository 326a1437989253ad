#include "scene/space_lines.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "scene/curvature.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tarn::scene {

namespace {

constexpr float line_px = 2.4f, point_px = 9.0f;

/// Height of the ground, of its border outside.
double ground_m(const Heightfield& g, double x, double y) {
    return g.elevation_m(std::clamp(x, g.west_m, g.east_m()),
                         std::clamp(y, g.south_m(), g.north_m));
}

/// Is there ground over a straight way? Both ends may lie on it.
bool ground_between(const Scene& scene, const glm::dvec3& a, const glm::dvec3& b, bool bent) {
    const Heightfield& g = scene.ground;
    const double across = std::hypot(b.x - a.x, b.y - a.y);
    const int looks = std::clamp(int(std::ceil(4.0 * across / g.spacing_m)), 8, 65536);
    for (int i = 1; i < looks; ++i) {
        const double f = double(i) / looks;
        const glm::dvec3 p = a + f * (b - a);
        // Between its ends a line of sight hangs below the chord of the bent one.
        const double sag = bent ? bend_per_m * across * across * f * (1.0 - f) : 0.0;
        const double clear = 0.02 * g.spacing_m * std::min(1.0, across * (1.0 - f) / g.spacing_m);
        if (p.x > g.west_m && p.x < g.east_m() && p.y > g.south_m() && p.y < g.north_m &&
            g.elevation_m(p.x, p.y) > p.z - sag + clear)
            return true;
    }
    return false;
}

} // namespace

HeightsFrom heights_from(std::string_view words) {
    return words == "level"    ? HeightsFrom::level
           : words == "ground" ? HeightsFrom::ground
                               : HeightsFrom::datum;
}

glm::dvec3 place_in_space(const Scene& scene, const glm::dvec3& vertex, HeightsFrom from) {
    if (from == HeightsFrom::datum) {
        if (std::isnan(vertex.z))
            throw Error("a vertex has no height",
                        "count heights from the level or the ground, or drape the layer");
        return vertex;
    }
    double zero_m = ground_m(scene.ground, vertex.x, vertex.y);
    if (from == HeightsFrom::level)
        zero_m = scene.water_level_m(vertex.x, vertex.y).value_or(scene.lakes.front().level_m);
    return {vertex.x, vertex.y, zero_m + (std::isnan(vertex.z) ? 0.0 : vertex.z)};
}

std::vector<SpaceStroke> make_strokes(const Scene& scene, const SpaceShapes& shapes,
                                      HeightsFrom from) {
    std::vector<SpaceStroke> out;
    const auto add = [&](const glm::dvec3& a, const glm::dvec3& b, float width_px) {
        if (out.size() >= most_strokes)
            throw Error(text("lines in space of more than ", most_strokes, " pieces"),
                        "cut or simplify them first, with ogr2ogr -clipsrc or -simplify say");
        out.push_back({a, b, width_px});
    };
    for (const auto& line : shapes.lines)
        for (std::size_t i = 1; i < line.size(); ++i) {
            const glm::dvec3 a = line[i - 1], b = line[i];
            const double pieces_wanted =
                from == HeightsFrom::ground
                    ? std::ceil(glm::length(glm::dvec2(b - a)) / scene.ground.spacing_m)
                    : 1.0;
            const int pieces = int(std::clamp(pieces_wanted, 1.0, double(most_strokes)));
            for (int k = 0; k < pieces; ++k)
                add(place_in_space(scene, a + (b - a) * (double(k) / pieces), from),
                    place_in_space(scene, a + (b - a) * ((k + 1.0) / pieces), from), line_px);
        }
    for (const glm::dvec3& point : shapes.points) {
        const glm::dvec3 place = place_in_space(scene, point, from);
        add(place, place, point_px);
    }
    return out;
}

double sign_irradiance(const Scene& scene, const View& view) {
    const Lighting& light = view.lighting;
    const double open = 0.5 * (light.sky_irradiance.y +
                               std::max(light.sun_direction.z, 0.0) * light.sun_irradiance.y);
    const glm::dvec3& p = view.camera.position;
    if (!scene.under_water(p))
        return open;
    constexpr double slant = 1.19, lamp_reach_m = 3.0; // of skylight in water; of a look by lamp
    const double attenuation =
        scene.optics.absorption_per_m.y + scene.optics.backscattering_per_m.y;
    constexpr double water_share = 0.3; // so much darker than matte things it looks around them
    return water_share * open *
               std::exp(-slant * attenuation * (*scene.water_level_m(p.x, p.y) - p.z)) +
           0.5 * water_share * view.settings.dive_light_cd * irradiance_per_lux /
               (lamp_reach_m * lamp_reach_m);
}

std::optional<Sighting> sighting_of(const Scene& scene, const glm::dvec3& camera,
                                    const glm::dvec3& place, bool look_for_ground) {
    const glm::dvec2 across(place - camera);
    const double away_m = glm::length(across);
    const Heightfield& g = scene.ground;
    if (place.x > g.west_m && place.x < g.east_m() && place.y > g.south_m() &&
        place.y < g.north_m && place.z < g.elevation_m(place.x, place.y) - 0.5 * g.scale_m - 1e-3)
        return std::nullopt; // in the ground
    const bool camera_wet = scene.under_water(camera), place_wet = scene.under_water(place);
    if (camera_wet == place_wet) {
        glm::dvec3 seen = place;
        if (!camera_wet)
            seen.z -= bend_per_m * away_m * away_m;
        if (look_for_ground && ground_between(scene, camera, place, !camera_wet))
            return std::nullopt;
        const double distance = glm::length(seen - camera);
        if (!(distance > 0.0))
            return std::nullopt;
        return Sighting{(seen - camera) / distance, distance, false};
    }
    const glm::dvec3& wet = camera_wet ? camera : place;
    const double level = *scene.water_level_m(wet.x, wet.y);
    if ((camera_wet ? place : camera).z < level)
        return std::nullopt; // a dry hollow beside the water
    // Where the way crosses the surface: Snell's law by halving, metres from the camera's foot.
    const double from_m = std::abs(camera.z - level), to_m = std::abs(place.z - level);
    const double index_here = camera_wet ? scene.optics.index : 1.0,
                 index_there = camera_wet ? 1.0 : scene.optics.index;
    double low = 0.0, high = away_m;
    for (int i = 0; i < 60; ++i) {
        const double at = 0.5 * (low + high);
        const double here = index_here * at / std::max(std::hypot(at, from_m), 1e-12),
                     there = index_there * (away_m - at) /
                             std::max(std::hypot(away_m - at, to_m), 1e-12);
        (here < there ? low : high) = at;
    }
    const glm::dvec2 unit = away_m > 0.0 ? across / away_m : glm::dvec2(0.0);
    const glm::dvec2 foot = glm::dvec2(camera) + low * unit;
    const glm::dvec3 surface(foot, level);
    const auto water = scene.water_level_m(surface.x, surface.y);
    if (!water || std::abs(*water - level) > 0.01 ||
        (look_for_ground && (ground_between(scene, camera, surface, !camera_wet) ||
                             ground_between(scene, surface, place, camera_wet))))
        return std::nullopt;
    glm::dvec3 seen = surface;
    if (!camera_wet)
        seen.z -= bend_per_m * low * low;
    const double distance = glm::length(seen - camera);
    if (!(distance > 0.0))
        return std::nullopt;
    return Sighting{(seen - camera) / distance, distance, true};
}

} // namespace tarn::scene
