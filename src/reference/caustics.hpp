#pragma once
/// @file caustics.hpp  Double-precision twin of shaders/lib/caustics.glsl, and the sunlight below
/// waves by many photons: what the GPU's tiles are measured against.
#include "reference/fresnel.hpp"
#include "reference/waves.hpp"

#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

namespace tarn::reference {

/// What comes through one facet of the surface.
struct Photon {
    glm::dvec2 lean{0.0}; ///< metres east and north for each metre of depth
    double share = 0.0;   ///< flux through a horizontal metre, against that of flat water
};

/// Same contract as the GLSL function of the same name.
Photon photon_below(glm::dvec3 sun, glm::dvec2 slope, double index, bool schlick);

/// Height [m] and slope of the surface over a place.
struct SurfacePoint {
    double height_m = 0.0;
    glm::dvec2 slope{0.0};
};
using SurfaceFunction = std::function<SurfacePoint(glm::dvec2)>;

/// The same from a table of nodes x nodes places over a square that repeats itself, by cubics: many
/// photons soon cost less so.
SurfaceFunction tabulated(const SurfaceFunction& surface, glm::dvec2 corner_m, double side_m,
                          int nodes);

/// A square of a horizontal plane, moved along the beam of flat water to the surface.
struct SunlitSquare {
    glm::dvec2 corner_m{0.0}; ///< south-western
    double side_m = 1.0;
    int texels = 64;      ///< a side; row = y
    bool periodic = true; ///< the surface repeats itself with it
};

/// Where light comes from and how many photons carry it.
struct PhotonLight {
    glm::dvec3 sun{0, 0, 1}; ///< towards it, unit, z > 0
    double index = 1.333;
    bool schlick = false;
    double disc_rad = 0.0;  ///< radius of the sun's disc, each photon comes from a place of it
    int photons_a_side = 4; ///< of a texel; evenly strewn, jittered
    unsigned seed = 0;      ///< another one, other places of the photons
    double steepest = 1.0;  ///< slope of the surface, where the square is not periodic
};

/// Mean sunlight on each texel of a square at a depth, against that below flat water.
std::vector<double> sunlight_by_photons(const SurfaceFunction& surface, const PhotonLight& light,
                                        const SunlitSquare& square, double depth_m);

/// The same at several depths, by the same photons: one plane for each.
std::vector<std::vector<double>> sunlight_by_photons(const SurfaceFunction& surface,
                                                     const PhotonLight& light,
                                                     const SunlitSquare& square,
                                                     const std::vector<double>& depths_m);

/// The model that a picture uses, from photons in double precision: a product of what each cascade
/// casts, blurred by the finer ones by chance (see shaders/lib/caustics.glsl). What it leaves out
/// against all waves together is measured in docs/physics/caustics.md.
class SunTiles {
public:
    /// @param time_s  of the waves
    SunTiles(const waves::Sea& sea, double time_s, const PhotonLight& light, double deepest_m);

    /// Sunlight on a horizontal plane against that below flat water, by one draw of the blur.
    /// @param at_m       scene place
    /// @param amplitude  share of each cascade's waves that is left where the light comes in
    /// @param random     even in [0, 1)
    double focus(glm::dvec2 at_m, double depth_m, const std::vector<double>& amplitude,
                 const std::function<double()>& random) const;
    /// Metres east and north that flat water's beam comes to a metre deeper.
    glm::dvec2 beam() const { return beam_; }

private:
    struct Cascade {
        double patch_m, first_m, slices_a_doubling, lean_variance;
        bool window = false;
        glm::dvec2 corner_m{0.0};
        std::vector<std::vector<double>> slices;
    };
    glm::dvec2 beam_;
    double disc_variance_, rough_variance_;
    int side_ = 64;
    std::size_t finest_ = 0;
    std::vector<Cascade> cascades_;
};

/// The same, kept for the next who asks: views of one moment share their sunlight, and its photons
/// take most of a small picture's time. One set is kept; any thread may ask.
std::shared_ptr<const SunTiles> shared_sun_tiles(const waves::Sea& sea, double time_s,
                                                 const PhotonLight& light, double deepest_m);

} // namespace tarn::reference
