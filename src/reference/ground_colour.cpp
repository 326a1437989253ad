#include "reference/ground_colour.hpp"

#include "reference/noise.hpp"

namespace tarn::reference {

namespace {

/// 0 below `low`, 1 above `high`, a cubic between.
double step(double low, double high, double x) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/// One coat of paint over another.
void coat(glm::dvec3& colour, glm::dvec3 paint, double share) {
    colour += (paint - colour) * share;
}

} // namespace

glm::dvec3 ground_albedo(glm::dvec2 place_m, double height_m, bool bed, double near_water,
                         double tree_m, double snow_m, double slope, double footprint_m) {
    const double broad = faded_noise(place_m, 1100.0, footprint_m, 1);
    const double fine = faded_noise(place_m, 90.0, footprint_m, 11);
    const double grain = faded_noise(place_m, 5.0, footprint_m, 21);
    const auto mottled = [fine](double r, double g, double b, double contrast) {
        return glm::dvec3(r, g, b) * (1.0 + contrast * (2.0 * fine - 1.0));
    };
    glm::dvec3 colour;
    if (bed) {
        colour = mottled(0.34, 0.30, 0.21, 0.15);
        coat(colour, mottled(0.125, 0.115, 0.085, 0.2),
             step(1.5, 18.0, 10.0 * (broad - 0.5) + std::max(-height_m, 0.0)));
        coat(colour, mottled(0.17, 0.165, 0.145, 0.3),
             step(0.40, 0.75, slope + 0.5 * (fine - 0.5) + 0.3 * (grain - 0.5)));
        const double pebbles = faded_noise(place_m, 1.3, footprint_m, 31);
        return colour * (0.3 + 0.7 * step(0.30, 0.60, grain)) * (0.6 + 0.8 * pebbles);
    }
    const double jitter = broad - 0.5, tone = 0.75 + 0.5 * grain;
    const double above_trees = step(tree_m - 160.0, tree_m + 160.0, height_m + 500.0 * jitter);
    glm::dvec3 heights = mottled(0.125, 0.115, 0.062, 0.2);
    coat(heights, mottled(0.19, 0.178, 0.155, 0.2),
         step(0.25, 0.75, 0.5 * (broad + fine) + 0.5 * (std::clamp(slope, 0.0, 1.0) - 0.35)));

    colour = mottled(0.082, 0.104, 0.036, 0.25);
    coat(colour, mottled(0.026, 0.043, 0.018, 0.35),
         step(0.30, 0.62, 0.6 * broad + 0.4 * fine + 0.15 * std::clamp(slope, 0.0, 1.0)));
    coat(colour, heights, above_trees);
    coat(colour, mottled(0.185, 0.175, 0.160, 0.3),
         step(0.60, 0.95, slope + 0.35 * (fine - 0.5) + 0.1 * above_trees));
    colour *= tone;
    coat(colour, {0.82, 0.84, 0.87},
         step(snow_m - 110.0, snow_m + 110.0, height_m + 400.0 * jitter) *
             (1.0 - step(0.9, 1.35, slope + 0.3 * (fine - 0.5))));
    coat(colour, mottled(0.31, 0.27, 0.19, 0.15) * tone,
         near_water * (1.0 - step(0.5, 2.2, height_m + 1.2 * (fine - 0.5))) *
             (1.0 - step(0.4, 0.8, slope)));
    return colour;
}

} // namespace tarn::reference
