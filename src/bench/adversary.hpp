#pragma once
/// @file adversary.hpp  Fields and rays made to break ways of finding a first hit, and the verdict
/// on them.
#include "render/renderer.hpp"

#include <array>
#include <string>
#include <vector>

namespace tarn::bench {

/// A ray as the reference gets it, in double precision.
struct TestRay {
    glm::dvec3 origin;    ///< scene metres
    glm::dvec3 direction; ///< unit, scene axes
};

/// Where rays come from and go to; each is a family that some method fails on.
enum class RayClass {
    any, ///< from above or beside to any place
    straight_down,
    grazing,      ///< 1e-2 to 1e-5 rad from the horizontal
    along_row,    ///< parallel to grid rows, between them
    along_line,   ///< within a grid line, exactly
    diagonal,     ///< through nodes, along a diagonal of the cells, exactly
    through_node, ///< at a node from anywhere
    from_surface, ///< starting on the ground or the water, upwards
    from_outside, ///< from beyond the sides, low
    from_below,   ///< starting in the water or in the ground, upwards
};
inline constexpr std::array<const char*, 10> ray_class_names = {
    "any",      "straight down", "grazing",          "along a row",  "along a grid line",
    "diagonal", "through nodes", "from the surface", "from outside", "from below"};

std::vector<TestRay> make_rays(const scene::Scene& scene, RayClass kind, int count, unsigned seed);

struct AdversarialField {
    std::string name;
    scene::Scene scene;
};

/// Spikes, cliffs, needles, a thin ridge, rough ground, plateaus at the water's level, a bowl,
/// mountains.
std::vector<AdversarialField> adversarial_fields();

/// A scene of given heights; all of it below `level_m` carries water (with the nodes around).
scene::Scene field_scene(GridSize size, double spacing_m,
                         const std::function<double(int col, int row)>& height_m,
                         double level_m = -1e9);

/// What float32 makes of rays on their way to the GPU; `rays` become that, so that both tracers are
/// asked the same question.
std::vector<render::FieldRay> round_rays(const scene::Scene& scene, std::vector<TestRay>& rays);

struct Verdict {
    int rays = 0, hits = 0;
    int missed = 0;        ///< passes what it should have met and meets nothing
    int invented = 0;      ///< meets what is not there
    int off = 0;           ///< farther off than max(1 quantum, 1e-5 of the distance)
    int far_off = 0;       ///< of those: by more than half a cell
    int other_surface = 0; ///< water for ground or ground for water
    double worst_m = 0.0;  ///< greatest distance error of those that are off
    TestRay worst_ray{};
    int failures() const { return missed + invented + off + other_surface; }
};

/// Judges answers against the double-precision walk over every cell.
///
/// Allowed: max(1 quantum, 1e-5 of the distance), seen along the ray. Where a ray skims a surface,
/// the place of the hit is as uncertain as its height over the sine between the two: an answer
/// between those for the ray a quantum lower and a quantum higher is right. So is a miss or a hit,
/// or one surface for the other, by less than a quantum or by a ten-thousandth of a cell sideways.
Verdict judge_hits(const scene::Scene& scene, const std::vector<TestRay>& rays,
                   const std::vector<render::FieldHit>& hits, bool with_water);

} // namespace tarn::bench
