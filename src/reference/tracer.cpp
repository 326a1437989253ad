#include "reference/tracer.hpp"

#include "reference/camera.hpp"
#include "reference/fresnel.hpp"
#include "reference/ground_colour.hpp"
#include "reference/heightfield.hpp"
#include "reference/medium.hpp"
#include "reference/parts.hpp"
#include "reference/photo.hpp"
#include "reference/sky.hpp"
#include "reference/sunlight.hpp"
#include "reference/surface.hpp"

#include <cmath>
#include <limits>
#include <tbb/parallel_for.h>

namespace tarn::reference {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double infinity = std::numeric_limits<double>::infinity();

// Skylight in the water, as in docs/physics/water.md: mean slant after refraction of an even sky,
// and one minus the diffuse reflectance of the surface from above.
constexpr double sky_slant = 1.19, sky_entering = 0.934;

/// The water that a ray is in.
struct Lake {
    double level_m;
    bool bed_known;
};

class Tracer {
public:
    Tracer(const scene::Scene& scene, const scene::View& view)
        : scene_(scene), light_(view.lighting), settings_(view.settings), camera_(view.camera),
          index_(scene.optics.index), attenuation_(scene.optics.attenuation_per_m()),
          longest_path_m_(scene::greatest_path_m(scene.optics, view.settings)),
          lift_m_(scene::shadow_lift_m(scene.ground)),
          bottom_m_(scene::block_bottom_m(scene.ground)) {
        half_tangent_.y = std::tan(camera_.fov_deg * pi / 360.0);
        half_tangent_.x = half_tangent_.y * settings_.width_px / settings_.height_px;
        pixel_rad_ = 2.0 * half_tangent_.y / settings_.height_px;
        const glm::dvec3 sun = light_.sun_direction;
        sun_below_ = sun_below(sun, index_);
        sun_irradiance_below_ =
            light_.sun_irradiance *
            sun_share_below(sun, sun_below_, index_, settings_.fresnel == scene::Fresnel::schlick);
        if (scene.ortho)
            photo_ = Photo(*scene.ortho);
        const glm::dvec3& p = camera_.position;
        const auto water = scene.water_level_m(p.x, p.y);
        if (water && p.z < *water)
            camera_lake_ = Lake{*water, scene.lake_at_level(*water).bed != Bed::unknown};
    }

    /// Radiance towards the camera through one place of the picture, and the first distance.
    glm::dvec3 look(glm::dvec2 place, double& distance) const {
        const glm::dvec3 direction =
            pixel_direction(camera_.forward, camera_.right, camera_.up, half_tangent_, place);
        if (camera_lake_)
            return in_water(camera_.position, direction, *camera_lake_, 0.0, true, &distance);
        return in_air(camera_.position, direction, 0.0, true, &distance);
    }

private:
    Split split(glm::dvec3 direction, bool from_water) const {
        return split_at_surface(direction, {0, 0, 1}, index_, from_water,
                                settings_.fresnel == scene::Fresnel::schlick);
    }

    glm::dvec3 sky(glm::dvec3 direction) const {
        glm::dvec3 out = sky_radiance(light_.sky, direction, light_.sun_direction);
        if (light_.sun_disc) {
            const double solid_angle = pi * scene::sun_radius_rad * scene::sun_radius_rad;
            out += light_.sun_irradiance / solid_angle *
                   disc_share(direction, light_.sun_direction, scene::sun_radius_rad, pixel_rad_);
        }
        return out;
    }

    bool blocked(glm::dvec3 from, glm::dvec3 towards, double reach) const {
        return trace_field(scene_.ground, nullptr, from, towards, reach, bottom_m_).has_value();
    }

    glm::dvec3 normal_at(const Hit& hit, double& slope) const {
        const glm::dvec2 g = ground_gradient(scene_.ground, hit.col, hit.row);
        slope = std::hypot(g.x, g.y) / scene_.ground.spacing_m;
        return normal_of(g, scene_.ground.spacing_m);
    }

    /// 1 where the nodes around carry a lake's level, falling to 0 over one cell.
    double shore_share(const Hit& hit) const {
        const Grid<std::uint16_t>& codes = scene_.water.codes;
        const int c = std::clamp(int(hit.col), 0, codes.size.cols - 2);
        const int r = std::clamp(int(hit.row), 0, codes.size.rows - 2);
        const double u = hit.col - c, v = hit.row - r;
        double share = 0.0;
        for (int k = 0; k < 4; ++k)
            if (codes[{c + k % 2, r + k / 2}] != no_water_code)
                share += (k % 2 ? u : 1 - u) * (k / 2 ? v : 1 - v);
        return share;
    }

    glm::dvec3 albedo(const Hit& hit, bool bed, double level_m, double slope,
                      double footprint) const {
        if (settings_.ground_albedo)
            return glm::dvec3(*settings_.ground_albedo);
        const double s = scene_.ground.spacing_m;
        return ground_albedo({hit.col * s, hit.row * s}, hit.point.z - level_m, bed,
                             shore_share(hit), scene_.look.tree_line_m - level_m,
                             scene_.look.snow_line_m - level_m, slope, footprint);
    }

    /// The side of the block that the scene is cut out of: a hit below the surface.
    bool is_cut(const Hit& hit) const {
        return hit.point.z < scene_.ground.elevation_m(hit.point.x, hit.point.y) - lift_m_;
    }

    glm::dvec3 land(const Hit& hit, glm::dvec3 direction, double footprint) const {
        if (is_cut(hit)) {
            const glm::dvec3 facing_us =
                glm::normalize(glm::dvec3(-direction.x, -direction.y, 0.5));
            const glm::dvec3 earth = settings_.ground_albedo ? glm::dvec3(*settings_.ground_albedo)
                                                             : glm::dvec3(0.19, 0.155, 0.115);
            return earth / pi * light_.sky_irradiance * (1.0 + facing_us.z) / 2.0;
        }
        double slope = 0.0;
        const glm::dvec3 normal = normal_at(hit, slope);
        const double level = scene_.lakes.front().level_m;
        glm::dvec3 colour = albedo(hit, false, level, slope, footprint);
        if (!settings_.ground_albedo && !photo_.empty()) {
            const glm::dvec4 photo = photo_.at(hit.point.x, hit.point.y, footprint);
            colour =
                colour * (1.0 - photo.a) + 0.7 * glm::dvec3(photo) * photo.a; // as in shade.comp
        }
        glm::dvec3 irradiance = light_.sky_irradiance * (1.0 + normal.z) / 2.0;
        const double facing = glm::dot(normal, light_.sun_direction);
        if (light_.sun_direction.z > 0.0 && facing > 0.0 &&
            !(settings_.shadows &&
              blocked(hit.point + glm::dvec3(0, 0, lift_m_), light_.sun_direction, infinity)))
            irradiance += light_.sun_irradiance * facing;
        return colour * irradiance / pi;
    }

    glm::dvec3 bed(const Hit& hit, double level, double footprint) const {
        double slope = 0.0;
        const glm::dvec3 normal = normal_at(hit, slope);
        const glm::dvec3 colour = albedo(hit, true, level, slope, footprint);
        const double depth = std::max(level - hit.point.z, 0.0);
        glm::dvec3 irradiance = light_.sky_irradiance * sky_entering *
                                transmittance(attenuation_, sky_slant * depth) * (1.0 + normal.z) /
                                2.0;
        const double facing = glm::dot(normal, sun_below_);
        if (light_.sun_direction.z > 0.0 && facing > 0.0) {
            bool lit = true;
            if (settings_.shadows) {
                const glm::dvec3 from = hit.point + glm::dvec3(0, 0, lift_m_);
                const double up = std::max(level - from.z, 0.0) / sun_below_.z;
                glm::dvec3 top = from + up * sun_below_;
                top.z = std::max(level, from.z);
                lit =
                    !blocked(from, sun_below_, up) && !blocked(top, light_.sun_direction, infinity);
            }
            if (lit)
                irradiance += sun_irradiance_below_ * facing *
                              transmittance(attenuation_, depth / sun_below_.z);
        }
        return colour * irradiance / pi;
    }

    /// Radiance arriving at `origin` from `direction`, both in the air.
    /// @param may_split  whether a water surface is looked for
    glm::dvec3 in_air(glm::dvec3 origin, glm::dvec3 direction, double before_m, bool may_split,
                      double* distance) const {
        const auto hit = trace_field(scene_.ground, may_split ? &scene_.water : nullptr, origin,
                                     direction, infinity);
        if (distance)
            *distance = hit ? hit->t : infinity;
        if (!hit)
            return sky(direction);
        if (!hit->water)
            return land(*hit, direction, pixel_rad_ * (before_m + hit->t));
        const Lake lake{hit->point.z, scene_.lake_at_level(hit->point.z).bed != Bed::unknown};
        const Split at = split(direction, false);
        glm::dvec3 out(0.0);
        if (settings_.reflection)
            out += at.mirror * in_air(hit->point, at.reflected, before_m + hit->t, false, nullptr);
        if (settings_.refraction)
            out += at.through *
                   in_water(hit->point, at.refracted, lake, before_m + hit->t, false, nullptr);
        return out;
    }

    /// The same under water.
    glm::dvec3 in_water(glm::dvec3 origin, glm::dvec3 direction, const Lake& lake, double before_m,
                        bool may_split, double* distance) const {
        const double depth = std::max(lake.level_m - origin.z, 0.0);
        const double to_surface = direction.z > 1e-6 ? depth / direction.z : infinity;
        const double reach = std::min(to_surface, longest_path_m_);
        std::optional<Hit> hit;
        if (lake.bed_known)
            hit = trace_field(scene_.ground, nullptr, origin, direction, reach, bottom_m_);
        const double length = hit ? hit->t : reach;
        const bool at_surface = !hit && to_surface <= longest_path_m_;
        if (distance)
            *distance = hit || at_surface ? length : infinity;

        const glm::dvec3 bb = scene_.optics.backscattering_per_m;
        glm::dvec3 out =
            path_radiance(bb, attenuation_, light_.sky_irradiance * sky_entering * sky_slant,
                          sky_slant, depth, -direction.z, length);
        if (light_.sun_direction.z > 0.0)
            out += path_radiance(bb, attenuation_, sun_irradiance_below_, 1.0 / sun_below_.z, depth,
                                 -direction.z, length);
        const glm::dvec3 left = transmittance(attenuation_, length);
        if (hit)
            return out + left * bed(*hit, lake.level_m, pixel_rad_ * (before_m + length));
        if (!at_surface || !may_split)
            return out;
        glm::dvec3 top = origin + length * direction;
        top.z = lake.level_m;
        const Split at = split(direction, true);
        if (settings_.reflection)
            out += left * at.mirror *
                   in_water(top, at.reflected, lake, before_m + length, false, nullptr);
        if (settings_.refraction && at.mirror < 1.0)
            out += left * at.through * in_air(top, at.refracted, before_m + length, false, nullptr);
        return out;
    }

    const scene::Scene& scene_;
    const scene::Lighting& light_;
    const scene::RenderSettings& settings_;
    const scene::Camera& camera_;
    double index_;
    glm::dvec3 attenuation_;
    double longest_path_m_, lift_m_, bottom_m_;
    glm::dvec2 half_tangent_{0.0};
    double pixel_rad_ = 0.0;
    glm::dvec3 sun_below_{0, 0, 1}, sun_irradiance_below_{0.0};
    Photo photo_;
    std::optional<Lake> camera_lake_;
};

} // namespace

Image trace(const scene::Scene& scene, const scene::View& view, const Progress& progress) {
    const scene::RenderSettings& settings = view.settings;
    settings.validate();
    const Tracer tracer(scene, view);
    const int w = settings.width_px, h = settings.height_px;
    Image out{.width_px = w, .height_px = h, .radiance = {}, .distance_m = {}};
    out.radiance.resize(std::size_t(w) * std::size_t(h));
    out.distance_m.resize(out.radiance.size());
    constexpr int band = 16; // rows between two looks at Ctrl-C
    for (int top = 0; top < h; top += band) {
        progress.report(double(top) / h, "tracing the reference");
        tbb::parallel_for(top, std::min(top + band, h), [&](int y) {
            for (int x = 0; x < w; ++x) {
                const std::size_t i = std::size_t(y) * std::size_t(w) + std::size_t(x);
                glm::dvec3 sum(0.0);
                for (int s = 0; s < settings.samples; ++s) {
                    const glm::dvec2 offset = scene::sample_offset(s, settings.samples);
                    double distance = 0.0;
                    sum += tracer.look({(x + offset.x) / w, (y + offset.y) / h}, distance);
                    if (s == 0)
                        out.distance_m[i] = static_cast<float>(distance);
                }
                out.radiance[i] = glm::vec3(sum / double(settings.samples));
            }
        });
    }
    return out;
}

} // namespace tarn::reference
