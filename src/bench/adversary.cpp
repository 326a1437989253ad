#include "bench/adversary.hpp"

#include "core/parallel.hpp"
#include "reference/heightfield.hpp"
#include "scene/samples.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <mutex>
#include <random>

namespace tarn::bench {

scene::Scene field_scene(GridSize size, double spacing_m,
                         const std::function<double(int, int)>& height_m, double level_m) {
    std::vector<float> z;
    for (int r = 0; r < size.rows; ++r)
        for (int c = 0; c < size.cols; ++c)
            z.push_back(float(height_m(c, r)));
    scene::Scene scene = scene::bowl(9);
    scene.ground = quantise(z, size, spacing_m, 4);
    scene.ground.north_m = (size.rows - 1) * spacing_m;
    scene.water = scene.ground;
    scene.water.scale_m = 0.001;
    scene.water.offset_m = level_m - 0.001;
    std::fill(scene.water.codes.values.begin(), scene.water.codes.values.end(), no_water_code);
    for (int r = 0; r < size.rows; ++r)
        for (int c = 0; c < size.cols; ++c)
            if (scene.ground.elevation_m(Node{c, r}) < level_m)
                for (int k = 0; k < 9; ++k) {
                    const Node n{c + k % 3 - 1, r + k / 3 - 1};
                    if (scene.water.codes.contains(n))
                        scene.water.codes[n] = 1;
                }
    scene.lakes[0].level_m = level_m > -1e8 ? level_m : scene.ground.min_elevation_m();
    return scene;
}

std::vector<AdversarialField> adversarial_fields() {
    std::mt19937 random(20261125);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<AdversarialField> out;
    out.push_back({"mountains", scene::mountain_lake(257)});
    out.push_back({"spikes", field_scene({100, 77}, 1.0, [&](int, int) {
                       return unit(random) < 0.02 ? 60.0 : 0.0;
                   })});
    out.push_back({"needles", field_scene({120, 120}, 2.0, [&](int c, int r) {
                       return c % 12 == 5 && r % 12 == 7 ? 900.0 : 0.05 * unit(random);
                   })});
    out.push_back({"cliffs", field_scene({70, 131}, 5.0, [](int c, int r) {
                       return ((c / 9 + r / 7) % 2) * 300.0;
                   })});
    out.push_back({"thin ridge", field_scene({90, 90}, 1.0, [](int c, int r) {
                       return (c == 45 ? 20.0 : 0.0) + 0.05 * r;
                   })});
    out.push_back(
        {"rough", field_scene({64, 64}, 1.0, [&](int, int) { return 10.0 * unit(random); })});
    // A third of the ground lies exactly at the water's level.
    out.push_back({"plateaus at water level", field_scene(
                                                  {96, 80}, 3.0,
                                                  [&](int c, int r) {
                                                      const int k = (c / 8 + r / 10) % 3;
                                                      return k == 0   ? 12.0
                                                             : k == 1 ? 20.0 + unit(random)
                                                                      : 4.0 * unit(random);
                                                  },
                                                  12.0)});
    out.push_back({"bowl", scene::bowl(129)});
    return out;
}

std::vector<TestRay> make_rays(const scene::Scene& scene, RayClass kind, int count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const Heightfield& g = scene.ground;
    const double w = g.east_m() - g.west_m, h = g.north_m - g.south_m();
    const double low = g.min_elevation_m(), relief = g.max_elevation_m() - low + g.spacing_m;
    const auto place = [&](double margin) {
        return glm::dvec2(g.west_m + w * (unit(random) * (1 + 2 * margin) - margin),
                          g.south_m() + h * (unit(random) * (1 + 2 * margin) - margin));
    };
    const auto node_near = [&](glm::dvec2 p) {
        return glm::dvec2(std::floor(g.col(p.x)), std::floor(g.row(p.y)));
    };
    std::vector<TestRay> rays;
    rays.reserve(std::size_t(count));
    while (rays.size() < std::size_t(count)) {
        const glm::dvec2 a = place(0.3), b = place(0.0);
        glm::dvec3 from(a, low + relief * (0.2 + 1.3 * unit(random)));
        glm::dvec3 to(b, low + relief * unit(random));
        switch (kind) {
        case RayClass::any:
            break;
        case RayClass::straight_down:
            from = {b, low + 2 * relief};
            to = {b, low - 1};
            break;
        case RayClass::grazing: {
            const double angle = std::pow(10.0, -2.0 - 3.0 * unit(random));
            const double length = glm::length(b - a);
            from.z = low + relief * unit(random);
            to.z = from.z + (unit(random) < 0.7 ? -1 : 1) * angle * length;
            break;
        }
        case RayClass::along_row:
            to.y = from.y;
            break;
        case RayClass::along_line:
            if (unit(random) < 0.5)
                from.y = to.y = g.y_m(std::round(g.row(b.y))); // the borders, too
            else
                from.x = to.x = g.x_m(std::round(g.col(b.x)));
            break;
        case RayClass::diagonal: {
            const glm::dvec2 n = node_near(b);
            const double side = unit(random) < 0.5 ? -1 : 1,
                         steps = 5 + std::floor(40 * unit(random));
            to = {g.x_m(n.x), g.y_m(n.y), to.z};
            from = {g.x_m(n.x - steps), g.y_m(n.y - side * steps), from.z};
            break;
        }
        case RayClass::through_node: {
            const glm::dvec2 n = node_near(b);
            to = {g.x_m(n.x), g.y_m(n.y), g.elevation_m(Node{int(n.x), int(n.y)})};
            break;
        }
        case RayClass::from_surface:
            from = {b, scene.water_level_m(b.x, b.y).value_or(g.elevation_m(b.x, b.y))};
            to = from + glm::dvec3(a - b, relief * unit(random));
            break;
        case RayClass::from_outside: {
            const bool west = unit(random) < 0.5;
            from.x = west ? g.west_m - w * unit(random) : g.east_m() + w * unit(random);
            from.z = low + relief * (unit(random) - 0.1);
            break;
        }
        case RayClass::from_below:
            from = {b, g.elevation_m(b.x, b.y) + relief * 0.3 * (unit(random) - 0.5)};
            to = from + glm::dvec3(0.2 * (a - b), relief * unit(random));
            break;
        }
        if (glm::length(to - from) > 1e-9)
            rays.push_back({from, glm::normalize(to - from)});
    }
    return rays;
}

std::vector<render::FieldRay> round_rays(const scene::Scene& scene, std::vector<TestRay>& rays) {
    const Heightfield& g = scene.ground;
    std::vector<render::FieldRay> out;
    out.reserve(rays.size());
    for (TestRay& ray : rays) {
        const glm::dvec2 node(std::floor(g.col(ray.origin.x)), std::floor(g.row(ray.origin.y)));
        const glm::vec2 base(node);
        const glm::vec3 rest(float(g.col(ray.origin.x) - double(base.x)),
                             float(g.row(ray.origin.y) - double(base.y)),
                             float(ray.origin.z - g.offset_m));
        out.push_back({base, rest, glm::vec3(ray.direction)});
        ray.origin = {g.x_m(double(base.x) + double(rest.x)),
                      g.y_m(double(base.y) + double(rest.y)), g.offset_m + double(rest.z)};
        ray.direction = glm::dvec3(out.back().direction);
    }
    return out;
}

Verdict judge_hits(const scene::Scene& scene, const std::vector<TestRay>& rays,
                   const std::vector<render::FieldHit>& hits, bool with_water) {
    const double quantum = scene.ground.scale_m, bottom = scene::block_bottom_m(scene.ground);
    const Heightfield* water = with_water ? &scene.water : nullptr;
    Verdict total;
    std::mutex mutex;
    share_out(int(rays.size()), 0, [&](int first_ray, int last_ray) {
        Verdict v;
        for (int i = first_ray; i < last_ray; ++i) {
            const TestRay& ray = rays[std::size_t(i)];
            const render::FieldHit& got = hits[std::size_t(i)];
            const bool found = got.kind > 0.5f;
            ++v.rays;
            const double length = glm::length(ray.direction);
            const auto hit =
                reference::trace_field(scene.ground, water, ray.origin, ray.direction, 1e9, bottom);
            v.hits += hit.has_value();
            const auto shifted = [&](double dz, double dx = 0.0, double dy = 0.0) {
                return reference::trace_field(scene.ground, water,
                                              ray.origin + glm::dvec3(dx, dy, dz), ray.direction,
                                              1e9, bottom);
            };
            const double aside = 1e-4 * scene.ground.spacing_m;
            if (hit && !found) {
                v.missed += shifted(quantum) && shifted(0, aside) && shifted(0, -aside) &&
                            shifted(0, 0, aside) && shifted(0, 0, -aside);
                continue;
            }
            if (!hit) {
                v.invented += found && !shifted(-quantum) && !shifted(0, aside) &&
                              !shifted(0, -aside) && !shifted(0, 0, aside) &&
                              !shifted(0, 0, -aside);
                continue;
            }
            const double allowed = std::max(quantum, 1e-5 * hit->t * length);
            const double error = std::abs(double(got.t) - hit->t) * length;
            if (error > allowed) {
                const auto low = shifted(-quantum), high = shifted(quantum);
                double nearest = low ? low->t : 0.0, farthest = high ? high->t : 1e300;
                // At a needle or a cliff's edge a hair aside decides between near and far.
                for (const auto& beside : {shifted(0, aside), shifted(0, -aside),
                                           shifted(0, 0, aside), shifted(0, 0, -aside)}) {
                    nearest = std::min(nearest, beside ? beside->t : 1e300);
                    farthest = std::max(farthest, beside ? beside->t : 1e300);
                }
                if (got.t < nearest - allowed || got.t > farthest + allowed) {
                    ++v.off;
                    v.far_off += error > 0.5 * scene.ground.spacing_m;
                    if (error > v.worst_m) {
                        v.worst_m = error;
                        v.worst_ray = ray;
                    }
                }
            } else if (with_water && (got.kind > 1.5f) != hit->water) {
                // Where a quantum or a hair aside decides which is met, either may be named.
                const glm::dvec3 p = hit->point;
                bool named = std::abs(scene.ground.elevation_m(p.x, p.y) -
                                      scene.water.elevation_m(p.x, p.y)) < 2 * quantum;
                for (const auto& beside :
                     {shifted(quantum), shifted(-quantum), shifted(0, aside), shifted(0, -aside),
                      shifted(0, 0, aside), shifted(0, 0, -aside)})
                    named |= beside && beside->water != hit->water;
                v.other_surface += !named;
            }
        }
        const std::lock_guard lock(mutex);
        total.rays += v.rays;
        total.hits += v.hits;
        total.missed += v.missed;
        total.invented += v.invented;
        total.off += v.off;
        total.far_off += v.far_off;
        total.other_surface += v.other_surface;
        if (v.worst_m > total.worst_m) {
            total.worst_m = v.worst_m;
            total.worst_ray = v.worst_ray;
        }
    });
    return total;
}

} // namespace tarn::bench
