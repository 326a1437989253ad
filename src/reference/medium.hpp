#pragma once
/// @file medium.hpp  Double-precision twin of shaders/lib/medium.glsl.
///
/// Sums over wavelengths, each by its own exponential, where the shader looks the sum up.
#include "scene/forward_glow.hpp"
#include "scene/water_optics.hpp"

#include <glm/vec3.hpp>
#include <vector>

namespace tarn::reference {

/// Same contract as the GLSL function of the same name.
double sky_glow_slant(double angle_rad);

/// The water's wavelengths, or its three channels, with their shares of white light.
class Medium {
public:
    Medium(const scene::WaterOptics& optics, bool spectral);

    /// Same contracts as the GLSL functions of the same names.
    glm::dvec3 transmittance(double path_m) const;
    glm::dvec3 path_radiance(double slant, double depth_m, double sink, double before_m,
                             double distance_m) const;
    glm::dvec3 glow_radiance(double slant, double depth_m, double sink, double before_m,
                             double distance_m, double angle_rad) const;
    /// The same of skylight: the angle is off the vertical, and says how slant the light comes.
    glm::dvec3 sky_glow_radiance(double depth_m, double sink, double before_m, double distance_m,
                                 double angle_rad) const;
    glm::dvec3 thrown_back(double depth_m) const;
    glm::dvec3 image_transmittance(double path_m) const;
    glm::dvec3 pattern_transmittance(double path_m) const;
    /// What all the water along a path, from path_m on without end, scatters back of light that
    /// falls with the path: differences of it, over a way's rate, are path_radiance() of pieces.
    glm::dvec3 scattered_beyond(double path_m) const;
    /// Share of the light that is left which still draws patterns, by luminance; [0, 1].
    double pattern_share(double path_m) const;
    /// Share of an even sky that a flat surface lets in, by integrating over the angles in air.
    double sky_entering() const { return sky_entering_; }

private:
    glm::dvec3 glow_by(const scene::GlowTable& glow, double slant, double depth_m, double sink,
                       double before_m, double distance_m, double angle_rad) const;

    struct Wave {
        glm::dvec3 weight;
        double attenuation_per_m, backscattering_per_m, beam_per_m, pattern_per_m, forward_per_m;
    };
    std::vector<Wave> waves_, glow_waves_;       ///< fewer: a glow takes more sums
    const scene::GlowTable* sky_glow_ = nullptr; ///< none where no wavelengths are known
    double index_, sky_entering_;
};

} // namespace tarn::reference
