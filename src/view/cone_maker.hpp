#pragma once
/// @file cone_maker.hpp  Cone maps made on other threads while the scene is shown by means of
/// others.
#include "core/cone_map.hpp"
#include "render/renderer.hpp"
#include "scene/scene.hpp"

#include <chrono>
#include <future>

namespace tarn::view {

/// Cone maps of a scene, made while it is shown by means of others.
class ConeMaker {
public:
    /// Begins for the scene as it is now; what was under way is for nothing.
    void start(const scene::Scene& scene, double lift_m) {
        if (busy())
            pending_ = true;
        else
            launch(scene, lift_m);
    }
    bool busy() const { return making_.valid(); }
    /// Gives the maps to the renderer when they are ready and still right.
    /// @return whether it did
    bool deliver(render::Renderer& renderer, const scene::Scene& scene) {
        if (!making_.valid() ||
            making_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
            return false;
        const Made made = making_.get();
        if (pending_ || made.lift_m != renderer.water_lift_m()) {
            pending_ = false;
            launch(scene, renderer.water_lift_m());
            return false;
        }
        renderer.give_cone_maps(made.ground, made.surface);
        return true;
    }
    ~ConeMaker() {
        if (making_.valid())
            making_.wait();
    }

private:
    struct Made {
        ConeMap ground, surface;
        double lift_m = 0.0;
    };
    void launch(const scene::Scene& scene, double lift_m) {
        making_ = std::async(
            std::launch::async, [ground = scene.ground, water = scene.water, lift_m]() mutable {
                water.offset_m += lift_m;
                Made made;
                made.ground = cone_map(ground, nullptr, render::FieldBounds::cone_shift);
                made.surface = cone_map(ground, &water, render::FieldBounds::cone_shift);
                made.lift_m = lift_m;
                return made;
            });
    }
    std::future<Made> making_;
    bool pending_ = false;
};

} // namespace tarn::view
