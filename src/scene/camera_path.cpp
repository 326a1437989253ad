#include "scene/camera_path.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tarn::scene {

namespace {

constexpr double clearance_m = 0.5;

/// A camera as numbers that can be mixed.
struct Key {
    glm::dvec3 position, forward, up;
    double fov_deg = 50.0;
};

Key mix(const Key& a, const Key& b, double t) {
    return {a.position + (b.position - a.position) * t, a.forward + (b.forward - a.forward) * t,
            a.up + (b.up - a.up) * t, a.fov_deg + (b.fov_deg - a.fov_deg) * t};
}

/// Barry & Goldman's pyramid for four keys at times t[0..3], within t[1]..t[2].
Key spline(const Key k[4], const double t[4], double at) {
    const auto between = [&](const Key& a, const Key& b, double ta, double tb) {
        return mix(a, b, tb > ta ? (at - ta) / (tb - ta) : 0.0);
    };
    const Key a1 = between(k[0], k[1], t[0], t[1]), a2 = between(k[1], k[2], t[1], t[2]),
              a3 = between(k[2], k[3], t[2], t[3]);
    const Key b1 = between(a1, a2, t[0], t[2]), b2 = between(a2, a3, t[1], t[3]);
    return between(b1, b2, t[1], t[2]);
}

Camera camera_from(const Key& key, const Heightfield& ground) {
    glm::dvec3 p = key.position;
    if (p.x >= ground.west_m && p.x <= ground.east_m() && p.y <= ground.north_m &&
        p.y >= ground.south_m())
        p.z = std::max(p.z, ground.elevation_m(p.x, p.y) + clearance_m);
    glm::dvec3 forward = key.forward;
    if (!(glm::length(forward) > 1e-6)) // between opposite views
        forward = {0, 1, -0.1};
    glm::dvec3 up = key.up;
    if (!(glm::length(glm::cross(forward, up)) > 1e-6))
        up = std::abs(forward.z) < 0.9 * glm::length(forward) ? glm::dvec3(0, 0, 1)
                                                              : glm::dvec3(0, 1, 0);
    return look_along(p, forward, up, std::clamp(key.fov_deg, 1.0, 170.0));
}

/// How far two cameras are apart, for an even pace: metres, and turning as if of things `scale_m`
/// away.
double pace(const Key& a, const Key& b, double scale_m) {
    return glm::length(b.position - a.position) +
           0.5 * scale_m * glm::length(glm::normalize(b.forward) - glm::normalize(a.forward));
}

/// Gently at both ends: a tenth of the time to come to speed, a tenth to stop.
double eased(double t) {
    constexpr double ramp = 0.1, speed = 1.0 / (1.0 - ramp);
    if (t < ramp)
        return 0.5 * speed * t * t / ramp;
    if (t > 1.0 - ramp)
        return 1.0 - 0.5 * speed * (1.0 - t) * (1.0 - t) / ramp;
    return speed * (t - 0.5 * ramp);
}

} // namespace

std::vector<Camera> path_through(const std::vector<Camera>& cameras, int frames,
                                 const Heightfield& ground) {
    std::vector<Key> keys;
    for (const Camera& c : cameras)
        keys.push_back({c.position, c.forward, c.up, c.fov_deg});
    std::vector<Camera> out;
    if (keys.size() == 1 || frames == 1) {
        out.assign(std::size_t(frames), cameras.front());
        return out;
    }
    double scale_m = 0.0;
    for (std::size_t i = 1; i < keys.size(); ++i)
        scale_m = std::max(scale_m, glm::length(keys[i].position - keys[i - 1].position));
    scale_m = std::max(scale_m, 1.0);
    // Densely, then at an even pace.
    constexpr int dense = 200;
    std::vector<Key> points;
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
        const Key k[4] = {i > 0 ? keys[i - 1] : mix(keys[i], keys[i + 1], -1.0), keys[i],
                          keys[i + 1],
                          i + 2 < keys.size() ? keys[i + 2] : mix(keys[i + 1], keys[i], -1.0)};
        double t[4] = {0, 0, 0, 0};
        for (int j = 1; j < 4; ++j)
            t[j] = t[j - 1] + std::max(std::sqrt(pace(k[j - 1], k[j], scale_m)), 1e-3);
        for (int j = 0; j < dense; ++j)
            points.push_back(spline(k, t, t[1] + (t[2] - t[1]) * j / dense));
    }
    points.push_back(keys.back());
    std::vector<double> way(points.size(), 0.0);
    for (std::size_t i = 1; i < points.size(); ++i)
        way[i] = way[i - 1] + pace(points[i - 1], points[i], scale_m);
    for (int f = 0; f < frames; ++f) {
        const double wanted = way.back() * eased(double(f) / (frames - 1));
        const auto next =
            std::min(std::size_t(std::lower_bound(way.begin(), way.end(), wanted) - way.begin()),
                     points.size() - 1);
        const std::size_t before = next > 0 ? next - 1 : 0;
        const double span = way[next] - way[before];
        out.push_back(camera_from(
            mix(points[before], points[next], span > 0.0 ? (wanted - way[before]) / span : 0.0),
            ground));
    }
    return out;
}

std::vector<Camera> path_along(const std::vector<glm::dvec2>& track, double above_m, double level_m,
                               double fov_deg, int frames, const Heightfield& ground) {
    std::vector<double> way(track.size(), 0.0);
    for (std::size_t i = 1; i < track.size(); ++i)
        way[i] = way[i - 1] + glm::length(track[i] - track[i - 1]);
    const auto place = [&](double wanted) {
        const double at = std::clamp(wanted, 0.0, way.back());
        const auto next = std::clamp<std::size_t>(
            std::size_t(std::lower_bound(way.begin(), way.end(), at) - way.begin()), 1,
            track.size() - 1);
        const double span = way[next] - way[next - 1];
        return track[next - 1] +
               (track[next] - track[next - 1]) * (span > 0.0 ? (at - way[next - 1]) / span : 0.0);
    };
    // Averages over some way round off corners and small hills.
    const double smooth_m = std::max(3.0 * above_m, way.back() / 50.0);
    const auto height = [&](double at) {
        double sum = 0.0;
        for (int i = -8; i <= 8; ++i) {
            const glm::dvec2 p = place(at + smooth_m * i / 8.0);
            sum += std::max(ground.elevation_m(p.x, p.y), level_m);
        }
        return sum / 17.0;
    };
    const auto mean_place = [&](double at) {
        glm::dvec2 sum(0.0);
        for (int i = -8; i <= 8; ++i)
            sum += place(at + 0.5 * smooth_m * i / 8.0);
        return sum / 17.0;
    };
    std::vector<Camera> out;
    for (int f = 0; f < frames; ++f) {
        const double at = way.back() * (frames > 1 ? eased(double(f) / (frames - 1)) : 0.0);
        const glm::dvec2 here = mean_place(at);
        glm::dvec2 ahead = mean_place(std::min(at + smooth_m, way.back())) -
                           mean_place(std::min(at, way.back() - smooth_m));
        if (!(glm::length(ahead) > 1e-6))
            ahead = track.back() - track.front();
        const glm::dvec3 eye(here, height(at) + above_m);
        const glm::dvec3 forward(glm::normalize(ahead + glm::dvec2(0.0, 1e-12)), -0.15);
        out.push_back(camera_from({eye, forward, {0, 0, 1}, fov_deg}, ground));
    }
    return out;
}

} // namespace tarn::scene
