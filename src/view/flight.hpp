#pragma once
/// @file flight.hpp  How the camera moves: no window and no GL, so that tests can fly.
#include "scene/camera.hpp"
#include "scene/scene.hpp"

#include <deque>
#include <glm/vec3.hpp>
#include <optional>

namespace tarn::view {

/// A camera that is always upright.
struct Pose {
    glm::dvec3 position{0};
    double heading_deg = 0.0; ///< clockwise from grid north
    double pitch_deg = 0.0;   ///< up positive, [-89.5, 89.5]
    double fov_deg = 50.0;    ///< vertical
    friend bool operator==(const Pose&, const Pose&) = default;
};

Pose pose_of(const scene::Camera& camera);
scene::Camera camera_of(const Pose& pose);

/// Which way somebody pushes, each in [-1, 1].
struct Push {
    double forward = 0.0, right = 0.0, up = 0.0;
    double boost = 1.0; ///< factor on the speed
    bool any() const { return forward != 0.0 || right != 0.0 || up != 0.0; }
};

/// What a gamepad asks for, by its axes in GLFW's standard order: left x and y, right x and y, left
/// and right trigger. Triggers rest at -1. Small values are a stick's play.
struct PadInput {
    Push push;
    double turn_right = 0.0, turn_up = 0.0; ///< of full speed
};
PadInput read_pad(const float* axes);

/// The camera over one scene. Collides with the ground; goes through water as if it were air.
class Flight {
public:
    /// @param scene  must outlive this; its ground may change
    Flight(const scene::Scene& scene, const Pose& start);

    const Pose& pose() const { return pose_; }
    bool under_way() const { return target_.has_value(); } ///< on the way of fly_to()

    /// Metres a second at full push: as fast as suits the height above ground and water.
    double speed_m_per_s() const;

    /// @return whether the pose has changed
    bool advance(const Push& push, double seconds);
    void turn(double right_deg, double up_deg);
    /// Around a point, which stays where it is in the picture; the camera keeps looking as it did.
    void orbit(const glm::dvec3& pivot, double right_deg, double up_deg);
    /// Towards a point (or along the view), by a share of the way: positive nearer.
    void zoom(const std::optional<glm::dvec3>& pivot, double steps);
    /// On a smooth way, some 1.2 s long.
    void fly_to(const Pose& target);
    /// So that a point is well in view, from nearer.
    void fly_to_point(const glm::dvec3& point);
    /// At once; what was before can be undone.
    void jump(const Pose& target);

    /// Call when a movement begins: it can then be undone.
    void remember();
    bool undo();
    bool redo();

    /// Lowest that the camera may be above a place.
    double lowest_m(double x, double y) const;

private:
    void settle();

    const scene::Scene& scene_;
    double bottom_m_; ///< of the block of earth
    Pose pose_, from_;
    std::optional<Pose> target_;
    double way_ = 0.0; ///< share of it, [0, 1]
    std::deque<Pose> before_, after_;
};

} // namespace tarn::view
