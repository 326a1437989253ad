#include "view/flight.hpp"

#include "core/angles.hpp"
#include "scene/settings.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tarn::view {

namespace {

constexpr double clearance_m = 0.3;
constexpr std::size_t most_remembered = 200;

glm::dvec3 direction_of(const Pose& pose) {
    const double h = pose.heading_deg * degree, p = pose.pitch_deg * degree;
    return {std::sin(h) * std::cos(p), std::cos(h) * std::cos(p), std::sin(p)};
}

double wrap_deg(double a) { return a - 360.0 * std::floor((a + 180.0) / 360.0); }

double smooth(double t) { return t * t * (3.0 - 2.0 * t); }

} // namespace

PadInput read_pad(const float* axes) {
    const auto stick = [&](int a) { return std::abs(axes[a]) < 0.15f ? 0.0 : double(axes[a]); };
    const auto trigger = [&](int a) {
        const double pulled = 0.5 * (double(axes[a]) + 1.0);
        return pulled < 0.075 ? 0.0 : pulled;
    };
    PadInput out;
    out.push.right = stick(0);
    out.push.forward = -stick(1);
    out.push.up = trigger(5) - trigger(4);
    out.turn_right = stick(2);
    out.turn_up = -stick(3);
    return out;
}

Pose pose_of(const scene::Camera& camera) {
    Pose out{.position = camera.position, .fov_deg = camera.fov_deg};
    const glm::dvec3& f = camera.forward;
    // Straight down, what is up in the picture says where north is.
    const bool steep = std::hypot(f.x, f.y) < 1e-6;
    const glm::dvec3 level = steep ? (f.z < 0.0 ? camera.up : -camera.up) : f;
    out.heading_deg = wrap_deg(std::atan2(level.x, level.y) / degree);
    out.pitch_deg = std::clamp(std::asin(std::clamp(f.z, -1.0, 1.0)) / degree, -89.5, 89.5);
    return out;
}

scene::Camera camera_of(const Pose& pose) {
    return scene::look(pose.position, pose.heading_deg, pose.pitch_deg, pose.fov_deg);
}

Flight::Flight(const scene::Scene& scene, const Pose& start)
    : scene_(scene), bottom_m_(scene::block_bottom_m(scene.ground)), pose_(start) {
    settle();
}

double Flight::lowest_m(double x, double y) const {
    const Heightfield& g = scene_.ground;
    if (x < g.west_m || x > g.east_m() || y > g.north_m || y < g.south_m())
        return bottom_m_; // beside the block of earth
    return g.elevation_m(x, y) + clearance_m;
}

// Above the ground, and not farther off than one can see the scene from.
void Flight::settle() {
    const Heightfield& g = scene_.ground;
    const double width = g.east_m() - g.west_m, height = g.north_m - g.south_m();
    const double reach = 3.0 * std::max(width, height);
    glm::dvec3& p = pose_.position;
    p.x = std::clamp(p.x, g.west_m - reach, g.east_m() + reach);
    p.y = std::clamp(p.y, g.south_m() - reach, g.north_m + reach);
    p.z = std::clamp(p.z, lowest_m(p.x, p.y), g.upper_bound_m() + reach);
    pose_.pitch_deg = std::clamp(pose_.pitch_deg, -89.5, 89.5);
    pose_.heading_deg = wrap_deg(pose_.heading_deg);
}

double Flight::speed_m_per_s() const {
    const glm::dvec3& p = pose_.position;
    const Heightfield& g = scene_.ground;
    double free = std::abs(p.z - g.elevation_m(p.x, p.y));
    if (const auto water = scene_.water_level_m(p.x, p.y))
        free = std::min(free, std::abs(p.z - *water) + 2.0);
    const double extent = std::max(g.east_m() - g.west_m, g.north_m - g.south_m());
    return std::clamp(0.7 * free, 1.5, std::max(3.0, 0.2 * extent));
}

bool Flight::advance(const Push& push, double seconds) {
    const Pose before = pose_;
    if (target_) {
        if (push.any()) {
            target_.reset();
        } else {
            way_ = std::min(1.0, way_ + seconds / 1.2);
            const double t = smooth(way_);
            pose_.position = from_.position + (target_->position - from_.position) * t;
            pose_.heading_deg =
                from_.heading_deg + wrap_deg(target_->heading_deg - from_.heading_deg) * t;
            pose_.pitch_deg = from_.pitch_deg + (target_->pitch_deg - from_.pitch_deg) * t;
            pose_.fov_deg = from_.fov_deg + (target_->fov_deg - from_.fov_deg) * t;
            if (way_ >= 1.0)
                target_.reset();
            settle();
            return pose_ != before;
        }
    }
    if (!push.any())
        return false;
    const double h = pose_.heading_deg * degree;
    const glm::dvec3 forward = direction_of(pose_), right(std::cos(h), -std::sin(h), 0.0);
    glm::dvec3 way = forward * push.forward + right * push.right + glm::dvec3(0, 0, push.up);
    if (const double length = glm::length(way); length > 1.0)
        way /= length;
    // In pieces, so that speed follows height on the way and no ridge is jumped over.
    const int pieces = 8;
    for (int i = 0; i < pieces; ++i) {
        pose_.position += way * (speed_m_per_s() * push.boost * seconds / pieces);
        settle();
    }
    return pose_ != before;
}

void Flight::turn(double right_deg, double up_deg) {
    target_.reset();
    pose_.heading_deg += right_deg;
    pose_.pitch_deg += up_deg;
    settle();
}

void Flight::orbit(const glm::dvec3& pivot, double right_deg, double up_deg) {
    target_.reset();
    const glm::dvec3 offset = pose_.position - pivot;
    const double distance = glm::length(offset);
    if (!(distance > 0.0))
        return turn(-right_deg, up_deg);
    const double elevation = std::asin(std::clamp(offset.z / distance, -1.0, 1.0)) / degree;
    const double risen = std::clamp(elevation + up_deg, -85.0, 89.0);
    // What the camera sees of the pivot must not change: it turns as much as it goes round.
    const double azimuth = std::atan2(offset.x, offset.y) / degree - right_deg;
    const double e = risen * degree, a = azimuth * degree;
    const glm::dvec3 wanted = pivot + distance * glm::dvec3(std::sin(a) * std::cos(e),
                                                            std::cos(a) * std::cos(e), std::sin(e));
    if (wanted.z < lowest_m(wanted.x, wanted.y)) { // into the ground: only round it
        const double flat = elevation * degree;
        pose_.position =
            pivot + distance * glm::dvec3(std::sin(a) * std::cos(flat),
                                          std::cos(a) * std::cos(flat), std::sin(flat));
    } else {
        pose_.position = wanted;
        pose_.pitch_deg -= risen - elevation;
    }
    pose_.heading_deg -= right_deg;
    settle();
}

void Flight::zoom(const std::optional<glm::dvec3>& pivot, double steps) {
    target_.reset();
    const double share = 1.0 - std::pow(0.85, steps);
    if (pivot)
        pose_.position += (*pivot - pose_.position) * std::clamp(share, -1.0, 0.95);
    else
        pose_.position += direction_of(pose_) * (share * speed_m_per_s());
    settle();
}

void Flight::fly_to(const Pose& target) {
    remember();
    from_ = pose_;
    target_ = target;
    way_ = 0.0;
}

void Flight::fly_to_point(const glm::dvec3& point) {
    const glm::dvec3 away = pose_.position - point;
    const double distance = glm::length(away);
    if (!(distance > 0.0))
        return;
    const double wanted = std::clamp(0.3 * distance, std::min(distance, 4.0), 2000.0);
    Pose target = pose_;
    target.position = point + away * (wanted / distance);
    // A little above the line, so that it is looked down upon.
    target.position.z = std::max(target.position.z, point.z + 0.25 * wanted);
    target.position.z = std::max(target.position.z, lowest_m(target.position.x, target.position.y));
    const glm::dvec3 to = glm::normalize(point - target.position);
    target.heading_deg = std::atan2(to.x, to.y) / degree;
    target.pitch_deg = std::asin(std::clamp(to.z, -1.0, 1.0)) / degree;
    fly_to(target);
}

void Flight::jump(const Pose& target) {
    remember();
    target_.reset();
    pose_ = target;
    settle();
}

void Flight::remember() {
    if (!before_.empty() && before_.back() == pose_)
        return;
    before_.push_back(pose_);
    if (before_.size() > most_remembered)
        before_.pop_front();
    after_.clear();
}

bool Flight::undo() {
    while (!before_.empty() && before_.back() == pose_)
        before_.pop_back();
    if (before_.empty())
        return false;
    after_.push_back(pose_);
    target_.reset();
    pose_ = before_.back();
    before_.pop_back();
    settle();
    return true;
}

bool Flight::redo() {
    if (after_.empty())
        return false;
    before_.push_back(pose_);
    target_.reset();
    pose_ = after_.back();
    after_.pop_back();
    settle();
    return true;
}

} // namespace tarn::view
