#include "reference/tracer.hpp"

#include "core/angles.hpp"
#include "core/error.hpp"
#include "reference/air.hpp"
#include "reference/camera.hpp"
#include "reference/caustics.hpp"
#include "reference/fresnel.hpp"
#include "reference/ground_colour.hpp"
#include "reference/heightfield.hpp"
#include "reference/medium.hpp"
#include "reference/parts.hpp"
#include "reference/photo.hpp"
#include "reference/sky.hpp"
#include "reference/space_lines.hpp"
#include "reference/sunlight.hpp"
#include "reference/surface.hpp"
#include "reference/waves.hpp"
#include "scene/curvature.hpp"
#include "scene/space_lines.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <tbb/parallel_for.h>

namespace tarn::reference {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Skylight in the water, as in docs/physics/water.md: mean slant after refraction of an even sky.
constexpr double sky_slant = 1.19;

// So far below its surface, water that is met from the air is met at a side of the scene's block.
constexpr double cut_tolerance_m = 0.01;

/// The water that a ray is in.
struct Lake {
    double level_m;
    bool bed_known;
};

/// Where a ray met water or ground.
struct Meeting {
    Hit hit;
    double level_m = 0.0;       ///< of the water
    glm::dvec2 slope{0.0, 0.0}; ///< of its surface there
    double rough = 1.0;         ///< share of the roughness that is left there
};

/// Where the random numbers of a pixel's sample begin: for slopes of waves too short to be drawn.
using Lot = std::uint64_t;

Lot lot_of(int x, int y, int sample) {
    Lot v = Lot(std::uint32_t(x)) << 40 ^ Lot(std::uint32_t(y)) << 20 ^ Lot(std::uint32_t(sample));
    v = (v ^ (v >> 31)) * 0x7fb5d329728ea185ull;
    v = (v ^ (v >> 27)) * 0x81dadef4bc2dd44dull;
    return v ^ (v >> 33);
}

/// What a ray may still do at the water: which of its slopes it meets, and how often it may be
/// split.
struct Chances {
    Lot lot;
    int splits = 1;
};

class Tracer {
public:
    Tracer(const scene::Scene& scene, const scene::View& view)
        : scene_(scene), light_(view.lighting), settings_(view.settings), camera_(view.camera),
          index_(scene.optics.index), medium_(scene.optics, view.settings.spectral),
          longest_path_m_(scene::greatest_path_m(scene.optics, view.settings)),
          lift_m_(scene::shadow_lift_m(scene.ground)),
          bottom_m_(scene::block_bottom_m(scene.ground)),
          bend_per_m_(scene::is_curved(scene, view) ? scene::bend_per_m : 0.0),
          sign_irradiance_(settings_.space_lines_lit ? 0.0 : scene::sign_irradiance(scene, view)) {
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
        if (!view.waves.calm()) {
            waves::Settings settings = view.waves;
            settings.time_s = 0.0;
            sea_ = waves::make_sea(scene.ground, scene.water, scene.lakes, settings);
            // Rain is no sum of waves: here it is roughness.
            for (const waves::Cascade& c : sea_.cascades)
                if (c.ripples && !c.window) {
                    sea_.roughness.xx += c.moments.slope_along;
                    sea_.roughness.yy += c.moments.slope_across;
                }
            if (!sea_.still()) {
                waves_.emplace(sea_, view.waves.time_s);
                raised_ = scene.water;
                raised_.offset_m += waves_->bound_m();
                const bool bent = settings_.caustics != scene::Caustics::off && sun.z > 0.0;
                if (bent && !sea_.cascades.empty())
                    tiles_ = shared_sun_tiles(
                        sea_, view.waves.time_s,
                        PhotonLight{.sun = sun,
                                    .index = index_,
                                    .schlick = settings_.fresnel == scene::Fresnel::schlick,
                                    .disc_rad = scene::sun_radius_rad},
                        deepest_m(scene));
                for (int i = 0; tiles_ && i <= beam_steps; ++i)
                    beam_shares_.push_back(medium_.pattern_share(
                        beam_reach_m * std::pow(double(i) / beam_steps, 2.0)));
            }
        }
        const glm::dvec3& p = camera_.position;
        const auto water = scene.water_level_m(p.x, p.y);
        const double eta =
            waves_ && water
                ? waves_->height_m({p.x, p.y}, *water - scene.ground.elevation_m(p.x, p.y))
                : 0.0;
        if (water && settings_.port_m > 0.0 &&
            std::abs(p.z - *water) < settings_.port_m + (waves_ ? waves_->bound_m() : 0.0))
            port_water_ = Lake{*water, scene.lake_at_level(*water).bed != Bed::unknown};
        if (water && p.z < *water + eta)
            camera_lake_ = Lake{*water, scene.lake_at_level(*water).bed != Bed::unknown};
    }

    /// Radiance towards the camera through one place of the picture, and the first distance.
    /// @param lot  which of the slopes too small to be drawn
    glm::dvec3 look(glm::dvec2 place, double& distance, Lot lot) const {
        const glm::dvec3 direction =
            pixel_direction(camera_.forward, camera_.right, camera_.up, half_tangent_, place);
        const Chances chances{lot, settings_.reference_splits};
        if (port_water_) { // rays begin on a dome, each in what is there
            const glm::dvec3 from = camera_.position + settings_.port_m * direction;
            const double level = port_water_->level_m;
            const double eta =
                waves_ ? waves_->height_m({from.x, from.y},
                                          level - scene_.ground.elevation_m(from.x, from.y))
                       : 0.0;
            return from.z < level + eta
                       ? in_water(from, direction, *port_water_, 0.0, 0.0, &distance, chances)
                       : in_air(from, direction, 0.0, &distance, chances);
        }
        if (camera_lake_)
            return in_water(camera_.position, direction, *camera_lake_, 0.0, 0.0, &distance,
                            chances);
        return in_air(camera_.position, direction, 0.0, &distance, chances);
    }

private:
    static double deepest_m(const scene::Scene& scene) {
        double deepest = 0.0;
        const GridSize size = scene.water.size();
        for (int r = 0; r < size.rows; ++r)
            for (int c = 0; c < size.cols; ++c)
                if (scene.water.codes[{c, r}] != no_water_code)
                    deepest = std::max(deepest, scene.water.elevation_m(Node{c, r}) -
                                                    scene.ground.elevation_m(Node{c, r}));
        return deepest;
    }

    /// Sunlight at a place in the water against that below flat water, by some draws.
    double focus_at(glm::dvec3 p, double depth, int draws) const {
        std::uint64_t lot = lot_of(int(std::llround(p.x * 4096.0)), int(std::llround(p.y * 4096.0)),
                                   int(std::llround(depth * 4096.0)));
        std::minstd_rand random(std::uint32_t(lot % 2147483646u) + 1u);
        std::uniform_real_distribution<double> even;
        const std::vector<double> shares =
            waves_->shares(glm::dvec2(p.x, p.y) - depth * tiles_->beam(), depth);
        double sum = 0.0;
        for (int k = 0; k < draws; ++k)
            sum += tiles_->focus({p.x, p.y}, depth, shares, [&] { return even(random); });
        return sum / draws;
    }

    /// Share of the sun's light that still draws patterns: shafts ask for it a hundred times a ray.
    double beam_share(double way_m) const {
        const double at = std::sqrt(way_m / beam_reach_m) * beam_steps;
        if (!(at < beam_steps))
            return medium_.pattern_share(way_m);
        const std::size_t low = std::size_t(at);
        return std::lerp(beam_shares_[low], beam_shares_[low + 1], at - double(low));
    }

    /// How a ray in the air rises over its direction, heights counted from level ground [1/m].
    double bend_of(glm::dvec3 direction) const {
        return bend_per_m_ * (direction.x * direction.x + direction.y * direction.y);
    }

    static glm::dvec3 along(glm::dvec3 origin, glm::dvec3 direction, double bend, double t) {
        return origin + t * direction + glm::dvec3(0, 0, bend * t * t);
    }

    /// Of a ray that goes on behind the surface; none where it may not be split again.
    static std::optional<Chances> further(const Chances& chances, int branch) {
        if (chances.splits <= 1)
            return {};
        const auto low = int(chances.lot & 0xfffff), high = int((chances.lot >> 20) & 0xfffff);
        return Chances{lot_of(low, high, chances.splits * 2 + branch), chances.splits - 1};
    }

    /// Rays that may meet the water again begin beside it.
    static glm::dvec3 clear_of_surface(const Chances& chances) {
        return {0.0, 0.0, chances.splits > 1 ? 1e-4 : 0.0};
    }

    Split split(glm::dvec3 direction, const Meeting& at, bool from_water, Lot lot) const {
        glm::dvec2 slope = at.slope;
        if (waves_ && sea_.roughness.trace() > 0.0) {
            // Facets count by the size that they turn to the viewer: drawn, and taken with that
            // chance.
            waves::SlopeCovariance r = sea_.roughness;
            r.xx *= at.rough * at.rough;
            r.xy *= at.rough * at.rough;
            r.yy *= at.rough * at.rough;
            const double a = std::sqrt(r.xx), b = a > 0.0 ? r.xy / a : 0.0;
            const double c = std::sqrt(std::max(r.yy - b * b, 0.0));
            const double side = from_water ? 1.0 : -1.0;
            const auto facing = [&](glm::dvec2 s) {
                return side * glm::dot(direction, glm::dvec3(-s, 1.0));
            };
            const double most = facing(at.slope) + 5.0 * std::sqrt(r.trace());
            std::minstd_rand random(std::uint32_t(lot % 2147483646u) + 1u);
            std::uniform_real_distribution<double> even;
            for (int tries = 0; tries < 1000; ++tries) {
                const double radius = std::sqrt(-2.0 * std::log(1.0 - even(random))),
                             turn = 2.0 * pi * even(random);
                const double u = radius * std::cos(turn), v = radius * std::sin(turn);
                slope = at.slope + glm::dvec2(a * u, b * u + c * v);
                if (even(random) * most < facing(slope))
                    break;
            }
        }
        return split_at_surface(direction, glm::normalize(glm::dvec3(-slope, 1.0)), index_,
                                from_water, settings_.fresnel == scene::Fresnel::schlick);
    }

    /// Level of the water that is over or under a place, also beside the shore where the surface
    /// would go on in the ground.
    std::optional<double> level_at(glm::dvec3 p) const {
        const Heightfield& w = scene_.water;
        constexpr double slack = 1e-6; // places on the border may lie a rounding outside
        const double last_col = w.size().cols - 1, last_row = w.size().rows - 1;
        double col = w.col(p.x), row = w.row(p.y);
        if (!(col >= -slack && row >= -slack && col <= last_col + slack && row <= last_row + slack))
            return {};
        col = std::clamp(col, 0.0, last_col);
        row = std::clamp(row, 0.0, last_row);
        const int c = std::min(int(col), w.size().cols - 2),
                  r = std::min(int(row), w.size().rows - 2);
        for (int k = 0; k < 4; ++k)
            if (w.codes[{c + k % 2, r + k / 2}] == no_water_code)
                return {};
        return w.elevation_m(std::clamp(p.x, w.west_m, w.east_m()),
                             std::clamp(p.y, w.south_m(), w.north_m));
    }

    /// The first of ground and moving water along a ray that has come near the water, by small
    /// steps and halving. `t` on return without a hit: where the ray has left the slab.
    std::optional<Meeting> through_slab(glm::dvec3 origin, glm::dvec3 direction, double& t,
                                        double t_end, bool from_air) const {
        const double bound = waves_->bound_m(), side = from_air ? 1.0 : -1.0;
        const double bend = from_air ? bend_of(direction) : 0.0;
        const auto at = [&](double s) { return along(origin, direction, bend, s); };
        // > 0 while the ray is in the medium that it came from.
        const auto over_water = [&](double s, std::optional<double>& level) {
            const glm::dvec3 p = at(s);
            level = level_at(p);
            if (!level)
                return 1e9;
            const double depth = *level - scene_.ground.elevation_m(p.x, p.y);
            return side * (p.z - *level - waves_->height_m({p.x, p.y}, depth));
        };
        const auto over_ground = [&](double s) {
            const glm::dvec3 p = at(s);
            return p.z - scene_.ground.elevation_m(p.x, p.y);
        };
        const double pace = std::max(std::hypot(direction.x, direction.y), 1e-9);
        // Neither the waves nor their fading by the shore can close a gap faster than this; the
        // shortest step is a twentieth of a texel.
        const double shortest = waves_->step_m() / pace;
        const auto climb = [&](double s) { return direction.z + 2.0 * bend * s; };
        const double waves_close = pace * (waves_->steepest() + 2.0 * bound / sea_.full_depth_m);
        std::optional<double> level, next_level;
        double water = over_water(t, level);
        if (water <= 0.0)
            return finish(at(t), t, *level);
        while (t < t_end) {
            // The ray climbs a little more by the end of a step.
            const double closing =
                std::abs(climb(t)) + 2.0 * bend * scene_.ground.spacing_m / pace + waves_close;
            const double step = std::max(
                shortest, std::min(water / closing, 0.25 * scene_.ground.spacing_m / pace));
            const double next = std::min(t + step, t_end);
            const double next_water = over_water(next, next_level), next_ground = over_ground(next);
            if (next_water <= 0.0 || next_ground <= 0.0) {
                const auto bisect = [&](auto&& f) {
                    double low = t, high = next;
                    for (int i = 0; i < 60; ++i) {
                        const double middle = 0.5 * (low + high);
                        (f(middle) > 0.0 ? low : high) = middle;
                    }
                    return high;
                };
                std::optional<double> ignored;
                const double s_water =
                    next_water <= 0.0 ? bisect([&](double s) { return over_water(s, ignored); })
                                      : 1e30;
                const double s_ground = next_ground <= 0.0 ? bisect(over_ground) : 1e30;
                if (s_water < s_ground) {
                    over_water(s_water, next_level);
                    return finish(at(s_water), s_water, next_level.value_or(level.value_or(0.0)));
                }
                return Meeting{hit_at(at(s_ground), s_ground, false), 0.0, {0.0, 0.0}};
            }
            t = next;
            water = next_water;
            level = next_level;
            if (side * climb(t) > 0.0 && (!level || side * (at(t).z - *level) > bound))
                return {};
            const double col = scene_.ground.col(at(t).x), row = scene_.ground.row(at(t).y);
            if (col < 0.0 || row < 0.0 || col > scene_.ground.size().cols - 1 ||
                row > scene_.ground.size().rows - 1)
                return {};
        }
        return {};
    }

    Hit hit_at(glm::dvec3 p, double t, bool water) const {
        return {t, water, scene_.ground.col(p.x), scene_.ground.row(p.y), p};
    }

    Meeting finish(glm::dvec3 p, double t, double level) const {
        const double depth = level - scene_.ground.elevation_m(p.x, p.y);
        return {hit_at(p, t, true), level, waves_->slope({p.x, p.y}, depth),
                waves_->finest_share({p.x, p.y}, depth)};
    }

    /// The first of ground and water in the air.
    std::optional<Meeting> meet_in_air(glm::dvec3 origin, glm::dvec3 direction,
                                       bool with_water) const {
        const double bend = bend_of(direction);
        if (!with_water || !waves_) {
            const auto hit = trace_field(scene_.ground, with_water ? &scene_.water : nullptr,
                                         origin, direction, infinity, bottom_m_, bend);
            if (!hit)
                return {};
            return Meeting{*hit, hit->point.z, {0.0, 0.0}};
        }
        double t = 0.0;
        while (true) {
            const auto hit = trace_field(scene_.ground, &raised_, along(origin, direction, bend, t),
                                         direction + glm::dvec3(0, 0, 2.0 * bend * t), infinity,
                                         bottom_m_, bend);
            if (!hit)
                return {};
            if (!hit->water)
                return Meeting{hit_at(hit->point, t + hit->t, false), 0.0, {0.0, 0.0}};
            t += hit->t;
            const double before = t;
            if (const auto met = through_slab(origin, direction, t, 1e7, true))
                return met;
            if (!(t > before) || t >= 1e7)
                return {};
        }
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

    /// What is left in its place of light from above the water: what was scattered forwards glows
    /// around it.
    glm::dvec3 seen_through(double water_m) const {
        return settings_.forward_glow ? medium_.image_transmittance(water_m)
                                      : medium_.transmittance(water_m);
    }

    /// The sky's light that the water scatters into a part of the view.
    glm::dvec3 sky_scattered(glm::dvec3 direction, double depth, double before_m,
                             double length) const {
        glm::dvec3 sum = medium_.path_radiance(sky_slant, depth, -direction.z, before_m, length);
        if (settings_.forward_glow)
            sum += medium_.sky_glow_radiance(depth, -direction.z, before_m, length,
                                             std::acos(std::clamp(direction.z, -1.0, 1.0)));
        return light_.sky_irradiance * medium_.sky_entering() * sky_slant * sum;
    }

    /// Light from that far away through the haze, and the haze's own.
    glm::dvec3 through_air(glm::dvec3 origin, glm::dvec3 direction, double length,
                           glm::dvec3 radiance) const {
        if (!light_.visibility_m)
            return radiance;
        const glm::dvec3 left =
            air_transmittance(scene::air_extinction_per_m(light_), 1.0 / scene::haze_scale_height_m,
                              origin.z - scene_.lakes.front().level_m, direction.z, length);
        return radiance * left +
               (1.0 - left) * sky_radiance(light_.sky, horizon_of(direction), light_.sun_direction);
    }

    bool blocked(glm::dvec3 from, glm::dvec3 towards, double reach) const {
        return trace_field(scene_.ground, nullptr, from, towards, reach, bottom_m_,
                           std::isinf(reach) ? bend_of(towards) : 0.0)
            .has_value();
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

    /// Share of bed that has fallen dry, bilinear between nodes.
    double bare_share(const Hit& hit) const {
        const Grid<std::uint8_t>& share = scene_.exposed_bed->share;
        const int c = std::clamp(int(hit.col), 0, share.size.cols - 2);
        const int r = std::clamp(int(hit.row), 0, share.size.rows - 2);
        const double u = hit.col - c, v = hit.row - r;
        double sum = 0.0;
        for (int k = 0; k < 4; ++k)
            sum +=
                share[{c + k % 2, r + k / 2}] / 255.0 * (k % 2 ? u : 1 - u) * (k / 2 ? v : 1 - v);
        return sum;
    }

    /// Of the lake whose shore this is; away from all, the first one's.
    double shore_level(const Hit& hit) const {
        const Heightfield& water = scene_.water;
        const int c = std::clamp(int(hit.col), 0, water.codes.size.cols - 2);
        const int r = std::clamp(int(hit.row), 0, water.codes.size.rows - 2);
        std::uint16_t code = no_water_code;
        for (int k = 0; k < 4; ++k)
            code = std::max(code, water.codes[{c + k % 2, r + k / 2}]);
        return code == no_water_code ? scene_.lakes.front().level_m
                                     : water.offset_m + water.scale_m * code;
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
        if (hit.point.z < scene_.ground.elevation_m(hit.point.x, hit.point.y) - lift_m_)
            return true;
        const auto level = level_at(hit.point); // the rim of a bed that is cut is no dry land
        return level && hit.point.z < *level - cut_tolerance_m;
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
        const double level = shore_level(hit);
        glm::dvec3 colour = albedo(hit, false, level, slope, footprint);
        if (scene_.exposed_bed && !settings_.ground_albedo) // was bed: nothing has grown there
            colour = glm::mix(
                colour, 1.25 * albedo(hit, true, scene_.exposed_bed->level_m, slope, footprint),
                bare_share(hit));
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

    /// Of the diver's lamp in a direction [irradiance at 1 m].
    double lamp_intensity(glm::dvec3 direction) const {
        const double outer = std::cos(25.0 * pi / 180.0), inner = std::cos(15.0 * pi / 180.0);
        const double t =
            std::clamp((glm::dot(direction, camera_.forward) - outer) / (inner - outer), 0.0, 1.0);
        return settings_.dive_light_cd * scene::irradiance_per_lux * t * t * (3.0 - 2.0 * t);
    }

    glm::dvec3 lamp_on(const Hit& hit, glm::dvec3 direction, double t) const {
        double slope = 0.0;
        const double facing = std::max(-glm::dot(normal_at(hit, slope), direction), 0.0);
        return lamp_intensity(direction) * facing /
               (t * t + scene::lamp_beside_m * scene::lamp_beside_m) *
               medium_.transmittance(2.0 * t);
    }

    /// By pieces that are thinner near the lamp: what a metre scatters back, by a path of none.
    glm::dvec3 lamp_scattered(glm::dvec3 direction, double length) const {
        const int pieces = 400;
        glm::dvec3 sum(0.0);
        if (lamp_intensity(direction) == 0.0)
            return sum;
        for (int k = 0; k < pieces; ++k) {
            const double from = length * std::pow(double(k) / pieces, 3.0),
                         to = length * std::pow((k + 1.0) / pieces, 3.0), t = 0.5 * (from + to);
            // A level path at the surface: light of no slant, the way back before it.
            sum += medium_.path_radiance(1.0, 0.0, 0.0, 2.0 * t - 0.5 * (to - from), to - from) /
                   (t * t + scene::lamp_beside_m * scene::lamp_beside_m);
        }
        return lamp_intensity(direction) * sum;
    }

    /// What is left of the bed's radiance after `water_m` of water.
    /// @param lamp  irradiance by the camera's lamp, as it is left at the eye
    glm::dvec3 bed(const Hit& hit, double level, double footprint, double water_m,
                   glm::dvec3 lamp) const {
        double slope = 0.0;
        const glm::dvec3 normal = normal_at(hit, slope);
        glm::dvec3 colour = albedo(hit, true, level, slope, footprint);
        const double drawn = medium_.pattern_share(water_m);
        // What was scattered wide on the way to the eye comes from some 12 degrees around.
        colour += (1.0 - drawn) *
                  (albedo(hit, true, level, slope, std::max(footprint, 0.2 * water_m)) - colour);
        const double depth = std::max(level - hit.point.z, 0.0);
        glm::dvec3 irradiance = light_.sky_irradiance * medium_.sky_entering() *
                                medium_.transmittance(sky_slant * depth + water_m) *
                                (1.0 + normal.z) / 2.0;
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
            if (lit) {
                const double way = depth / sun_below_.z + water_m;
                glm::dvec3 left = medium_.transmittance(way);
                if (tiles_)
                    left +=
                        (focus_at(hit.point, depth, 16) - 1.0) * medium_.pattern_transmittance(way);
                irradiance += sun_irradiance_below_ * facing * left;
            }
        }
        irradiance += lamp;
        if (settings_.thrown_back)
            irradiance /= 1.0 - colour * medium_.thrown_back(depth);
        return colour * irradiance / pi;
    }

    /// Lays the first of lines in space over what a part brings to the eye.
    /// @param lake  none: the part is in the air
    glm::dvec3 behind_lines(glm::dvec3 radiance, glm::dvec3 origin, glm::dvec3 direction,
                            double end_m, double before_m, double water_before_m,
                            const Lake* lake) const {
        if (scene_.space_strokes.empty() ||
            settings_.drape_on == (lake ? scene::DrapeOn::dry : scene::DrapeOn::flooded))
            return radiance;
        const glm::dvec3 eye = origin - before_m * direction;
        const double bend = lake ? 0.0 : bend_per_m_;
        double at = infinity, cover = 0.0;
        for (const scene::SpaceStroke& s : scene_.space_strokes) {
            const auto from_eye = [&](glm::dvec3 p) {
                const glm::dvec2 away(p - origin);
                p.z -= bend * glm::dot(away, away);
                return p - eye;
            };
            const StrokeSeen seen = near_stroke(direction, from_eye(s.from), from_eye(s.to));
            const double t = seen.t - before_m;
            if (!(t > 0.0 && t < end_m))
                continue;
            const double here = stroke_cover(seen.apart_rad / pixel_rad_, double(s.width_px));
            if (here > cover || (here == cover && cover > 0.0 && t < at)) {
                cover = here;
                at = t;
            }
        }
        if (cover == 0.0)
            return radiance;
        const glm::dvec3 albedo(0.85, 0.18, 0.05), luminance(0.2126, 0.7152, 0.0722);
        const double up = std::max(light_.sun_direction.z, 0.0);
        if (sign_irradiance_ > 0.0)
            return glm::mix(radiance, albedo / pi * sign_irradiance_, cover);
        if (!lake) {
            const glm::dvec3 mark =
                albedo / pi * 0.5 * (light_.sky_irradiance + up * light_.sun_irradiance);
            return glm::mix(radiance, through_air(origin, direction, at, mark), cover);
        }
        const double start_depth = std::max(lake->level_m - origin.z, 0.0),
                     depth = std::max(start_depth - direction.z * at, 0.0),
                     way = water_before_m + at;
        glm::dvec3 irradiance = 0.5 * light_.sky_irradiance * medium_.sky_entering() *
                                medium_.transmittance(sky_slant * depth + way);
        if (up > 0.0)
            irradiance += 0.5 * sun_below_.z * sun_irradiance_below_ *
                          medium_.transmittance(depth / sun_below_.z + way);
        if (settings_.dive_light_cd > 0.0 && before_m == 0.0)
            irradiance += 0.5 * lamp_intensity(direction) /
                          (at * at + scene::lamp_beside_m * scene::lamp_beside_m) *
                          medium_.transmittance(2.0 * at);
        cover *= std::clamp(glm::dot(luminance, medium_.image_transmittance(way)) /
                                std::max(glm::dot(luminance, medium_.transmittance(way)), 1e-9),
                            0.0, 1.0);
        const glm::dvec3 mark =
            albedo / pi * irradiance + sky_scattered(direction, start_depth, water_before_m, at) +
            (up > 0.0 ? sun_irradiance_below_ * sun_scattered(origin, direction, start_depth,
                                                              water_before_m, at, lake->bed_known)
                      : glm::dvec3(0.0));
        return glm::mix(radiance, mark, cover);
    }

    /// Radiance arriving at `origin` from `direction`, both in the air.
    /// @param chances  none: no water surface is looked for
    glm::dvec3 in_air(glm::dvec3 origin, glm::dvec3 direction, double before_m, double* distance,
                      std::optional<Chances> chances) const {
        double end_m = infinity;
        const glm::dvec3 radiance = in_clear_air(origin, direction, before_m, end_m, chances);
        if (distance)
            *distance = end_m;
        return behind_lines(radiance, origin, direction, end_m, before_m, 0.0, nullptr);
    }

    /// The same without lines in space.
    /// @param end_m  on return: to what was met
    glm::dvec3 in_clear_air(glm::dvec3 origin, glm::dvec3 direction, double before_m, double& end_m,
                            std::optional<Chances> chances) const {
        const auto met = meet_in_air(origin, direction, chances.has_value());
        end_m = met ? met->hit.t : infinity;
        if (!met)
            return sky(direction);
        const Hit& hit = met->hit;
        if (!hit.water)
            return through_air(origin, direction, hit.t,
                               land(hit, direction, pixel_rad_ * (before_m + hit.t)));
        const double level = level_at(hit.point).value_or(met->level_m);
        if (hit.point.z < level - cut_tolerance_m - 2.0 * (waves_ ? waves_->bound_m() : 0.0))
            return through_air(origin, direction, hit.t,
                               through_side(hit, direction, level, before_m, *chances));
        const Lake lake{met->level_m, scene_.lake_at_level(met->level_m).bed != Bed::unknown};
        const Split at =
            split(glm::normalize(direction + glm::dvec3(0, 0, 2.0 * hit.t * bend_of(direction))),
                  *met, false, chances->lot);
        const glm::dvec3 above = clear_of_surface(*chances);
        glm::dvec3 out(0.0);
        if (settings_.reflection && settings_.mirrored_land)
            out += at.mirror * in_air(hit.point + above, at.reflected, before_m + hit.t, nullptr,
                                      further(*chances, 0));
        else if (settings_.reflection)
            out += at.mirror * sky(at.reflected);
        if (settings_.refraction && at.mirror < 1.0)
            out += at.through * in_water(hit.point - above, at.refracted, lake, before_m + hit.t,
                                         0.0, nullptr, further(*chances, 1));
        return through_air(origin, direction, hit.t, out);
    }

    /// A ray from outside that has met cut water at the side of the scene's block: a pane without
    /// its glass.
    glm::dvec3 through_side(const Hit& hit, glm::dvec3 direction, double level, double before_m,
                            const Chances& chances) const {
        const Heightfield& g = scene_.ground;
        const double away[4] = {hit.point.x - g.west_m, g.east_m() - hit.point.x,
                                hit.point.y - g.south_m(), g.north_m - hit.point.y};
        const glm::dvec3 normals[4] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}};
        const glm::dvec3 normal = normals[std::min_element(away, away + 4) - away];
        const double cosine = std::clamp(-glm::dot(direction, normal), 0.0, 1.0);
        const double mirror = settings_.fresnel == scene::Fresnel::schlick
                                  ? fresnel_schlick(cosine, 1.0 / index_)
                                  : fresnel_dielectric(cosine, 1.0 / index_);
        // Snell's law for the tangents; what is left of the unit vector goes inwards.
        const glm::dvec3 tangent = (direction + cosine * normal) / index_;
        const glm::dvec3 inside =
            tangent - std::sqrt(std::max(1.0 - glm::dot(tangent, tangent), 0.0)) * normal;
        glm::dvec3 out(0.0);
        if (settings_.reflection)
            out += mirror * sky(direction + 2.0 * cosine * normal);
        if (settings_.refraction) {
            const Lake lake{level, scene_.lake_at_level(level).bed != Bed::unknown};
            out += (1.0 - mirror) / (index_ * index_) *
                   in_water(hit.point, inside, lake, before_m + hit.t, 0.0, nullptr,
                            further(chances, 1));
        }
        return out;
    }

    /// The first of bed and moving surface for a ray that starts in the water.
    std::optional<Meeting> meet_in_water(glm::dvec3 origin, glm::dvec3 direction, const Lake& lake,
                                         double reach) const {
        const double below = lake.level_m - waves_->bound_m() - origin.z;
        double t = 0.0;
        if (below > 0.0) {
            const double to_slab = direction.z > 1e-6 ? below / direction.z : infinity;
            const auto hit = trace_field(scene_.ground, nullptr, origin, direction,
                                         std::min(to_slab, reach), bottom_m_);
            if (hit)
                return Meeting{*hit, 0.0, {0.0, 0.0}};
            if (to_slab >= reach)
                return {};
            t = to_slab;
        }
        if (auto met = through_slab(origin, direction, t, reach, false))
            return met;
        if (t >= reach || direction.z >= 0.0)
            return {};
        const auto hit = trace_field(scene_.ground, nullptr, origin + t * direction, direction,
                                     reach - t, bottom_m_);
        if (!hit)
            return {};
        return Meeting{hit_at(hit->point, t + hit->t, false), 0.0, {0.0, 0.0}};
    }

    /// The same under water, but as it arrives at the eye after `water_before_m` more of the water.
    glm::dvec3 in_water(glm::dvec3 origin, glm::dvec3 direction, const Lake& lake, double before_m,
                        double water_before_m, double* distance,
                        std::optional<Chances> chances) const {
        double end_m = infinity;
        const glm::dvec3 radiance = in_clear_water(origin, direction, lake, before_m,
                                                   water_before_m, distance, end_m, chances);
        return behind_lines(radiance, origin, direction, end_m, before_m, water_before_m, &lake);
    }

    /// The same without lines in space.
    /// @param end_m  on return: to where the part ended, also in the midst of the water
    glm::dvec3 in_clear_water(glm::dvec3 origin, glm::dvec3 direction, const Lake& lake,
                              double before_m, double water_before_m, double* distance,
                              double& end_m, std::optional<Chances> chances) const {
        const double depth = std::max(lake.level_m - origin.z, 0.0);
        double to_surface = direction.z > 1e-6 ? depth / direction.z : infinity;
        std::optional<Hit> hit;
        Meeting surface{{}, lake.level_m, {0.0, 0.0}};
        if (waves_ && chances) {
            to_surface = infinity;
            const auto met = meet_in_water(origin, direction, lake, longest_path_m_);
            if (met && met->hit.water) {
                to_surface = met->hit.t;
                surface = *met;
            } else if (met && lake.bed_known) {
                hit = met->hit;
            }
        } else if (lake.bed_known) {
            hit = trace_field(scene_.ground, nullptr, origin, direction,
                              std::min(to_surface, longest_path_m_), bottom_m_);
        }
        const double reach = std::min(to_surface, longest_path_m_);
        const double length = hit ? hit->t : reach;
        end_m = length;
        const bool at_surface = !hit && to_surface <= longest_path_m_;
        if (distance)
            *distance = hit || at_surface ? length : infinity;

        glm::dvec3 out = sky_scattered(direction, depth, water_before_m, length);
        if (light_.sun_direction.z > 0.0)
            out += sun_irradiance_below_ *
                   sun_scattered(origin, direction, depth, water_before_m, length, lake.bed_known);
        const double water_m = water_before_m + length;
        const bool lit = settings_.dive_light_cd > 0.0 && before_m == 0.0;
        if (lit)
            out += lamp_scattered(direction, length);
        if (hit)
            return out + bed(*hit, lake.level_m, pixel_rad_ * (before_m + length), water_m,
                             lit ? lamp_on(*hit, direction, length) : glm::dvec3(0.0));
        if (!at_surface || !chances)
            return out;
        glm::dvec3 top = origin + length * direction;
        if (!waves_)
            top.z = lake.level_m;
        const Split at = split(direction, surface, true, chances->lot);
        const glm::dvec3 above = clear_of_surface(*chances);
        if (settings_.reflection)
            out += at.mirror * in_water(top - above, at.reflected, lake, before_m + length, water_m,
                                        nullptr, further(*chances, 0));
        if (settings_.refraction && at.mirror < 1.0)
            out +=
                seen_through(water_m) * at.through *
                in_air(top + above, at.refracted, before_m + length, nullptr, further(*chances, 1));
        return out;
    }

    /// The sun's light that the water scatters into a part of the view: what lies in the sun,
    /// shafts and all.
    glm::dvec3 sun_scattered(glm::dvec3 origin, glm::dvec3 direction, double depth, double before_m,
                             double length, bool bed_known) const {
        const double slant = 1.0 / sun_below_.z, sink = -direction.z;
        const bool shafts = tiles_ && settings_.shaft_steps > 0;
        const double off_beam = std::atan2(glm::length(glm::cross(direction, sun_below_)),
                                           glm::dot(direction, sun_below_));
        const auto deep_at = [&](double t) { return std::max(depth + sink * t, 0.0); };
        const auto even = [&](double from, double to) {
            return medium_.path_radiance(slant, deep_at(from), sink, before_m + from, to - from);
        };
        const auto glow = [&](double from, double to) {
            return settings_.forward_glow
                       ? medium_.glow_radiance(slant, deep_at(from), sink, before_m + from,
                                               to - from, off_beam)
                       : glm::dvec3(0.0);
        };
        const auto between = [&](double from, double to) {
            return even(from, to) + glow(from, to);
        };
        if (!(shafts || settings_.shadows) || !(length > 0.0))
            return between(0.0, length);
        const int pieces = shafts ? 96 : 24; // each longer than the one before it
        glm::dvec3 sum(0.0);
        double lit_from = 0.0; // pieces in the sun, side by side, are one
        // Of thin pieces side by side each end is summed once, where the light's path grows along
        // the way.
        const double rate = 1.0 + slant * sink;
        const bool by_ends = shafts && std::abs(rate) > 1e-3 && depth + sink * length >= 0.0;
        const auto beyond = [&](double t) {
            return medium_.scattered_beyond(slant * deep_at(t) + before_m + t);
        };
        glm::dvec3 beyond_from = by_ends ? beyond(0.0) : glm::dvec3(0.0);
        for (int k = 0; k < pieces; ++k) {
            const double from = length * std::pow(double(k) / pieces, 2.0),
                         to = length * std::pow((k + 1.0) / pieces, 2.0), t = 0.5 * (from + to);
            const double deep = deep_at(t), way = slant * deep + before_m + t;
            const glm::dvec3 beyond_to = by_ends ? beyond(to) : glm::dvec3(0.0),
                             piece = (beyond_from - beyond_to) / rate;
            beyond_from = beyond_to;
            const glm::dvec3 enters = origin + t * direction + deep / sun_below_.z * sun_below_;
            if (settings_.shadows &&
                (blocked(enters + glm::dvec3(0, 0, lift_m_), light_.sun_direction, infinity) ||
                 (bed_known && blocked(origin + t * direction, sun_below_, deep / sun_below_.z)))) {
                if (!shafts && from > lit_from)
                    sum += between(lit_from, from);
                lit_from = to;
                continue;
            }
            if (!shafts)
                continue;
            sum += ((by_ends ? piece : even(from, to)) + glow(from, to)) *
                   (1.0 + (focus_at(origin + t * direction, deep, 1) - 1.0) * beam_share(way));
        }
        if (!shafts && length > lit_from)
            sum += between(lit_from, length);
        return sum;
    }

    const scene::Scene& scene_;
    const scene::Lighting& light_;
    const scene::RenderSettings& settings_;
    const scene::Camera& camera_;
    double index_;
    Medium medium_;
    double longest_path_m_, lift_m_, bottom_m_, bend_per_m_, sign_irradiance_;
    glm::dvec2 half_tangent_{0.0};
    double pixel_rad_ = 0.0;
    glm::dvec3 sun_below_{0, 0, 1}, sun_irradiance_below_{0.0};
    Photo photo_;
    std::optional<Lake> camera_lake_, port_water_;
    waves::Sea sea_;
    std::optional<WaveSurface> waves_;
    std::shared_ptr<const SunTiles> tiles_; ///< of light that the waves focus
    /// By the root of the way: linear between them, off by less than 1e-4 also where c = 20/m.
    static constexpr double beam_reach_m = 200.0;
    static constexpr int beam_steps = 10000;
    std::vector<double> beam_shares_;
    Heightfield raised_; ///< the water, as high as its waves may come
};

} // namespace

Image trace(const scene::Scene& scene, const scene::View& view, const Progress& progress) {
    const scene::RenderSettings& settings = view.settings;
    settings.validate();
    if (settings.strip)
        throw Error("the reference draws whole pictures, no strips of them");
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
                    sum += tracer.look({(x + offset.x) / w, (y + offset.y) / h}, distance,
                                       lot_of(x, y, s));
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
