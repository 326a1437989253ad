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
void coat(glm::dvec3& colour, glm::dvec3 paint, double share) { colour += (paint - colour) * share; }

} // namespace

glm::dvec3 ground_albedo(glm::dvec2 place_m, double height_m, double tree_m, double snow_m, double slope,
                         double footprint_m) {
    const double broad = faded_noise(place_m, 900.0, footprint_m, 1);
    const double fine = faded_noise(place_m, 60.0, footprint_m, 11);
    const auto mottled = [fine](double r, double g, double b, double contrast) {
        return glm::dvec3(r, g, b) * (1.0 + contrast * (2.0 * fine - 1.0));
    };
    glm::dvec3 colour;
    if (height_m < 0.0) {
        colour = mottled(0.34, 0.30, 0.21, 0.15);
        coat(colour, mottled(0.125, 0.115, 0.085, 0.2), step(1.5, 16.0, 8.0 * (broad - 0.5) - height_m));
        coat(colour, mottled(0.17, 0.165, 0.145, 0.3), step(0.45, 0.8, slope + 0.4 * (fine - 0.5)));
        return colour;
    }
    const double jitter = broad - 0.5;
    const double above_trees = step(tree_m - 120.0, tree_m + 120.0, height_m + 300.0 * jitter);
    glm::dvec3 heights = mottled(0.170, 0.155, 0.085, 0.2);
    coat(heights, mottled(0.30, 0.285, 0.26, 0.2), step(0.4, 0.6, fine));

    colour = mottled(0.115, 0.145, 0.045, 0.2);
    coat(colour, mottled(0.030, 0.052, 0.020, 0.35),
         step(0.42, 0.58, 0.5 * (broad + fine) + 0.12 * std::clamp(slope, 0.0, 1.0)));
    coat(colour, heights, above_trees);
    coat(colour, mottled(0.215, 0.205, 0.190, 0.3),
         step(0.62, 0.95, slope + 0.35 * (fine - 0.5) + 0.1 * above_trees));
    coat(colour, {0.82, 0.84, 0.87},
         step(snow_m - 90.0, snow_m + 90.0, height_m + 260.0 * jitter) *
             (1.0 - step(0.9, 1.35, slope + 0.3 * (fine - 0.5))));
    coat(colour, mottled(0.36, 0.315, 0.225, 0.15),
         (1.0 - step(0.5, 2.2, height_m + 1.2 * (fine - 0.5))) * (1.0 - step(0.5, 0.9, slope)));
    return colour;
}

} // namespace tarn::reference
