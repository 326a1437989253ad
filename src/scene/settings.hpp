#pragma once
/// @file settings.hpp  How a picture is computed; every default gives a good picture of any lake.
#include "scene/camera.hpp"
#include "scene/lighting.hpp"
#include "scene/scene.hpp"
#include "waves/settings.hpp"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <vector>

namespace tarn::scene {

enum class Fresnel { exact, schlick };

/// How a ray's first hit with the field is found. docs/intersection.md compares them; each is
/// described at the head of its file in shaders/lib/walks.
enum class Walk {
    cone_map,        ///< exact
    maximum_mipmap,  ///< exact
    grid,            ///< exact, every cell
    safety_exact,    ///< exact
    safety_radius,   ///< Baboud & Decoret 2006
    uniform_steps,   ///< Policarpo et al. 2005
    direction_steps, ///< Tatarchuk 2006
    cone_steps,      ///< Dummer 2006
};

struct WalkMethod {
    Walk walk;
    const char* name;       ///< as typed and shown
    const char* source;     ///< who described it
    bool exact;             ///< misses nothing, invents nothing
    double default_setting; ///< steps of the methods that have a number of them, else 0
    const char* setting;    ///< what the setting means; empty: there is none
};

/// All methods, the default one first.
const std::vector<WalkMethod>& walk_methods();
const WalkMethod& walk_method(Walk walk);

/// How sunlight below waves is gathered (passes/sunlight_photons.comp).
enum class Caustics {
    off,        ///< as below flat water; costs nothing
    splat,      ///< a photon from each texel of the waves, shared out where it lands
    photon_map, ///< Baboud & Decoret 2006
    mesh,       ///< Wallace 2016
    back        ///< after Guardado & Sanchez-Crespo 2004
};

/// How shafts of light in the water are drawn.
enum class Shafts {
    march, ///< places along each view are looked up in the tiles of sunlight (passes/sunlit.comp)
    prisms ///< prisms of light below a grid about the sun's image, after Lanza (2007); only for a
           ///< camera in the water (passes/prisms.vert)
};

struct CausticsMethod {
    Caustics caustics;
    const char* name;   ///< as typed and shown
    const char* source; ///< who described it
};

/// All methods, off first.
const std::vector<CausticsMethod>& caustics_methods();

/// Lighting's unit of irradiance a lux: the sun outside the atmosphere gives 133.3 klx (Stair &
/// Ellis 1968: 133.1; ASTM E490 with the CIE observer 133.3) and has irradiance pi.
inline constexpr double irradiance_per_lux = 3.14159265358979323846 / 133300.0;
/// A lamp stands so far beside the lens.
inline constexpr double lamp_beside_m = 0.25;

/// Where draped lines show, by the water's level.
enum class DrapeOn { all, dry, flooded };

struct RenderSettings {
    int width_px = 1280; ///< [1, 16384]
    int height_px = 720; ///< [1, 16384]
    int samples = 4;     ///< per pixel, [1, 1024]; sub-pixel positions by sample_offset()
    Fresnel fresnel = Fresnel::exact;
    bool shadows = true;
    bool reflection = true;
    bool mirrored_land = true; ///< false: seen from above, water mirrors the sky alone
    bool refraction = true;
    bool spectral = true;     ///< integrate over the water's bands; false: three narrow channels
    bool thrown_back = true;  ///< light that the surface sends back to the bed
    bool forward_glow = true; ///< seen from below, light that water scatters forwards glows around
                              ///< sun and window; false: it counts as not scattered
    Caustics caustics = Caustics::splat;
    int caustic_texels =
        0; ///< a side of a tile of them; 0: half the waves', else a power of two, [16, 2048]
    int caustic_photons = 1; ///< of `splat`, on a side of a texel of the waves: 1, 2 or 4
    int shaft_steps = 2; ///< places along a view in the water where each of sixteen pixels side by
                         ///< side looks for shafts of light, [0, 256]; 0: none
    Shafts shafts = Shafts::march;
    int shaft_prisms = 64;              ///< of `prisms`, on a side of the grid, [4, 512]
    double least_transmittance = 0.002; ///< underwater paths end where less is left, [1e-6, .5]
    double dive_light_cd = 0.0; ///< a diver's lamp by the lens, [0, 1e6] candela along the view in
                                ///< a cone of 15 degrees that fades to nothing at 25; in water only
    double port_m = 0.0; ///< radius of the dome before the lens where rays begin, [0, 2]: at the
                         ///< water's surface a picture is half in, half out of it
    std::optional<bool> earth_curvature; ///< nothing: where it shows (scene/curvature.hpp)
    std::optional<double> ground_albedo; ///< lab: one grey for all ground, [0, 1]
    /// Rows that are drawn in place of the whole picture, which is as without: for pictures too
    /// large to be held whole. Only the GPU's renderer knows of it.
    struct Strip {
        int first_row = 0, rows = 1; ///< the first one a multiple of 8
    };
    std::optional<Strip> strip;
    int rows_drawn() const { return strip ? strip->rows : height_px; }
    // What maps draw; nothing costs nothing. The reference leaves contours and colours out.
    std::optional<double> contours_m;       ///< interval on land, heights of the datum, [.01, 1e4]
    std::optional<double> depth_contours_m; ///< interval on beds, depths, [.01, 1e4]
    std::optional<double> depth_colours_m;  ///< water is a sheet in the colours of its depth, the
                                            ///< darkest at this one, [.01, 1e5]
    DrapeOn drape_on = DrapeOn::all;        ///< of layers
    bool space_lines_lit = false; ///< lines in space are things that light falls on and water
                                  ///< hides; else signs, as bright wherever they are
    int reference_splits = 1; ///< how often the reference splits a path at the water, [1, 8]; the
                              ///< GPU does once
    Walk walk = Walk::cone_map;
    bool coarse_far_land = false; ///< land's blocks narrower than a pixel are met at their tops; of
                                  ///< cone_map only, whose file says how far that is off
    double walk_setting = 0.0;    ///< 0: the method's default; else [1, 65536]

    /// @throws tarn::Error  naming the field, its value and the legal range
    void validate() const;
};

/// Rasterised things (markers, lines, models) to be mixed with the traced picture: a pixel of
/// theirs shows where it is nearer than ground and water, through as much water as lies before it.
/// What is seen through or mirrored in the surface is not theirs to show.
struct Overlay {
    int width_px = 0, height_px = 0; ///< the picture's
    std::vector<glm::vec4>
        pixels; ///< rgb radiance, a distance along the pixel's ray [m]; 0: nothing
};

/// Everything a tracer needs to know, besides the scene.
struct View {
    Camera camera;
    Lighting lighting;
    RenderSettings settings;
    waves::Settings waves;          ///< calm unless said
    std::optional<Overlay> overlay; ///< only the GPU's renderer looks at it
};

/// The same view with every part that it shows at its best, however long that takes: what cheaper
/// ways are held against. Parts that are off stay off.
View at_its_best(View view);

/// Position of sample `index` of `count` inside the pixel, in [0, 1)^2: the centre for one sample,
/// else Roberts' R2 low-discrepancy sequence (plastic number), the same on every device.
glm::dvec2 sample_offset(int index, int count);

/// Rays for shadows start this much above the surface they come from [m]: a hundredth of the
/// spacing and two height quanta, or the surface would shade itself by rounding.
double shadow_lift_m(const Heightfield& ground);

/// Bottom of the block of earth that a scene is cut out of [m]: a thirtieth of its longer side
/// below its lowest node. Rays that come in from the side meet the cut; below it there is sky.
double block_bottom_m(const Heightfield& ground);

/// Length of an underwater path after which less than settings.least_transmittance is left in
/// every channel [m]; 1e9 in water that does not attenuate.
double greatest_path_m(const WaterOptics& optics, const RenderSettings& settings);

} // namespace tarn::scene
