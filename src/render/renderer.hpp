#pragma once
/// @file renderer.hpp  Scene + View -> Image, by compute shaders.
#include "core/cone_map.hpp"
#include "core/image.hpp"
#include "gpu/context.hpp"
#include "gpu/objects.hpp"
#include "gpu/shader.hpp"
#include "render/field_bounds.hpp"
#include "render/light_prisms.hpp"
#include "render/sunlight.hpp"
#include "render/waves.hpp"
#include "scene/settings.hpp"

#include "shared/view_block.h"

#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace tarn::render {

/// A ray as the GPU gets it, in single precision.
struct FieldRay {
    glm::vec2 base;      ///< a whole node near the origin, column and row
    glm::vec3 origin;    ///< columns and rows from there, metres above the ground's offset_m
    glm::vec3 direction; ///< unit, scene axes
};

struct FieldHit {
    float t = 0;    ///< metres
    float kind = 0; ///< 0 nothing, 1 ground, 2 water
    float col = 0, row = 0;
};

/// Holds one scene on the GPU and draws views of it. The context must stay current.
class Renderer {
public:
    /// Uploads the scene.
    /// @throws tarn::Error  if the field is larger than the device's textures, or memory runs out
    /// @param rays_in_step  whether the device runs many rays in step, as GPUs do; by default asked
    explicit Renderer(const scene::Scene& scene, std::optional<bool> rays_in_step = {});

    /// Draws all samples and reads the picture back.
    /// @param progress  called after each sample with its share; may throw to stop
    Image draw(const scene::View& view, const std::function<void(double)>& progress = {});

    /// The picture of the last prepare(), or of a later move_waves(), all its samples.
    Image draw_again(const std::function<void(double)>& progress = {});

    /// Draws one sample, tile by tile, and leaves it on the GPU. Call prepare() first.
    void draw_once();

    /// Uploads camera, light and settings, and makes the target images.
    void prepare(const scene::View& view);

    /// The picture as it is on the GPU. Waits for it.
    Image read_back() const;

    /// Draws a part of one sample of a prepared picture, for who must not wait for all of it: the
    /// samples in turn, each from its first row down, without gaps.
    /// @param samples  that the picture will have; what is there after k of them is k / samples of
    /// it
    void draw_rows(int sample, int samples, int first_row, int rows);

    /// Draws a sample of a prepared picture, all its samples: each `every`th block of 8 x 8 pixels
    /// across and down. What stands in them is what the whole picture shows there.
    /// @param every           at least 1
    /// @param find_new_beams  false: those of the last call serve, the view is the same
    void draw_blocks(int every, bool find_new_beams = true);
    /// What the last draw_blocks() drew, the blocks side by side; empty if the picture holds none.
    Image read_blocks(int every) const;

    /// Reads heights, lakes and optics of the scene again, which somebody has changed; sizes and
    /// the photograph must be the same. Then prepare().
    /// @param settled  false while somebody drags a level: waves and land's shadow stay as they
    /// were
    void scene_changed(bool settled = true);

    /// The same for what is draped, or hangs in space, alone. Then prepare().
    void map_changed() {
        upload_map();
        upload_space_lines();
    }

    /// Cone maps made elsewhere, on a thread of their own say, in place of those that the next
    /// prepare() would wait for.
    /// @param ground   of the scene's ground alone
    /// @param surface  of ground and water, the water raised by water_lift_m()
    void give_cone_maps(const ConeMap& ground, const ConeMap& surface);
    /// Would prepare() of a walk by cone maps have to make one?
    bool needs_cone_maps() const { return bounds_.needs_cones(); }
    /// How much the walk's water is raised for the waves of the last prepare() [m].
    double water_lift_m() const { return lift_m_; }

    /// The picture so far, on the GPU: radiance, and distances as find_first_hits() gives them.
    const gpu::Texture2D& radiance() const { return radiance_; }
    const gpu::Texture2D& distance() const { return distance_; }

    /// Shows the sea of the last prepare() at another time: all that an animation with a still
    /// camera needs between two pictures. Costs nothing where it is calm.
    void move_waves(double time_s);

    /// Distance to what each pixel's ray meets first, > 0 ground, < 0 water, 0 nothing, left on the
    /// GPU. Call prepare() first.
    void find_first_hits();
    std::vector<float> read_first_hits() const;

    /// First hits of any rays.
    /// @param with_water  stop at the water, too
    std::vector<FieldHit> trace_rays(std::span<const FieldRay> rays, scene::Walk walk,
                                     double setting, bool with_water, double t_max = 1e9);

    /// Binds heights, the bounds of a walk and the view block, for a program of one's own (tests).
    void bind_field(scene::Walk walk, bool with_water);

    /// What had to be changed about the waves asked for in the last prepare(), and why.
    std::vector<std::string> wave_notes() const {
        return waves_ ? waves_->sea().report.notes : std::vector<std::string>();
    }
    /// The sea of the last prepare(), where it was not calm.
    const WaveField* waves() const { return wavy() ? &*waves_ : nullptr; }
    WaveField* waves() { return wavy() ? &*waves_ : nullptr; }

    /// Do waves focus the sun's light in the picture of the last prepare()? What it is like, then.
    bool caustics() const { return caustics_; }
    const SunlightVolume& sunlight() const { return sunlight_; }

    /// Called before each pass with its name, and with "end" after the last: for timing. May be
    /// empty.
    std::function<void(const char*)> on_pass;

    /// Memory of the heights and of all bounds made so far.
    std::size_t field_bytes() const { return heights_bytes_ + bounds_.bytes(); }
    /// For experiments: cells a side of the cone map's blocks, 2^shift. Before the first prepare().
    void set_cone_shift(int shift) {
        bounds_.shift = shift;
        block_.walk.y = shift;
    }

private:
    /// The passes that walk, with one method in them.
    struct WalkPasses {
        gpu::ComputeProgram beams, primary, secondary, shadow, first_hit, trace_rays;
    };
    /// Those that know of waves, and the one that shades: a calm scene's programs hold none of it.
    struct WavyPasses {
        gpu::ComputeProgram primary, surface, secondary, shadow, sunlit, shade;
    };

    /// Where the blocks of a sample lie: whole ones of the picture alone, the first in the middle
    /// of those that it stands for.
    struct Blocks {
        int first_px, skip_px;   ///< before the first, and after each
        int width_px, height_px; ///< of all, side by side
        int place(int px) const { return first_px + px + (px >> 3) * skip_px; } ///< in the picture
    };
    Blocks blocks_of(int every) const;
    void upload_scene();
    void use_shade();
    std::string path_defines() const;
    std::string shade_defines() const;
    std::string coarse_define() const;
    gpu::ComputeProgram walk_pass(const char* name, const std::string& defined) const;
    std::string sunlight_defines() const;
    void upload_heights();
    void upload_map();
    void upload_space_lines();
    void prepare_sunlight(const scene::View& view, bool moved);
    void prepare_land_shadow(const scene::View& view);
    void use_walk(scene::Walk walk, double setting);
    std::string walk_file() const;
    void prepare_waves(const scene::View& view);
    void upload_water(bool spectral);
    bool scatters_forwards(const scene::View& view) const;
    void upload_glow();
    void bind_images();
    void locate_camera();
    void find_port_heights(double level_m);
    void draw_medium();
    bool under_water() const { return (block_.counts.z & TARN_FLAG_UNDER_WATER) != 0; }
    void lift_water(double lift_m);
    bool wavy() const { return waves_ && !waves_->sea().still(); }
    const WavyPasses& wavy_passes();
    void bind_walk(bool with_water);
    void find_beams();
    void set_sample(int sample, int samples);
    void draw_tile();
    bool glows() const { return forwards_ && (under_water() || port_); }
    bool prisms() const { return prisms_asked_ && caustics_ && under_water() && !port_; }
    void draw_prisms();

    const scene::Scene& scene_;
    shared::ViewBlock block_{};
    gpu::Texture2D heights_, sky_, soft_sky_, ortho_, radiance_, distance_, beams_, overlay_;
    gpu::Texture2D
        hits_[3]; ///< ends of the parts of the paths of one tile (shaders/lib/parts.glsl)
    gpu::Buffer view_buffer_, lakes_, space_lines_;
    std::map<std::string, gpu::ComputeProgram> shade_; ///< by what is defined
    const gpu::ComputeProgram* calm_shade_ = nullptr;  ///< of them, for this picture
    std::vector<glm::vec3> sky_made_;                  ///< as it is on the GPU
    bool hazy_ = false, whole_sky_ = false, mapped_ = false, curved_ = false, coarse_ = false,
         port_ = false, lamp_ = false, cut_water_ = false;
    bool forwards_ = false;          ///< the water scatters light forwards, as a camera in it sees
    gpu::Texture2D glow_, sky_glow_; ///< scene::make_glow_colours() ...
    std::optional<scene::WaterOptics> glow_made_; ///< ... of that water
    gpu::Texture2D port_heights_;
    std::map<std::string, gpu::ComputeProgram> port_passes_; ///< by the waves' defines
    gpu::Texture2D exposed_, drape_;
    gpu::Texture2D land_shadow_;
    double shadow_softness_m_ = 1.0, bed_softness_m_ = 1.0;
    bool shadowed_ = false;     ///< land's shadow, or the bed's, lies on some of the water
    bool bed_shadowed_ = false; ///< the bed's does
    std::optional<std::pair<glm::dvec3, double>>
        shadow_sun_; ///< and index of the water, as the shadow was worked out last
    FieldBounds bounds_;
    std::map<std::pair<scene::Walk, std::string>, WalkPasses> passes_; ///< and what is defined
    const WalkPasses* calm_walk_ = nullptr; ///< of them, for this picture
    std::map<std::pair<scene::Walk, std::string>, WavyPasses> wavy_passes_;
    std::optional<WaveField> waves_;
    std::optional<double> wave_time_s_; ///< that they show
    SunlightVolume sunlight_;
    std::optional<SunlightSettings> sunlight_settings_; ///< as laid out last for this sea
    bool caustics_ = false; ///< waves focus the sun's light in this picture
    int shaft_steps_ = 0;   ///< places along a view that shafts of light are looked up at; 0: none
    gpu::Texture2D water_;  ///< the water's table (scene/water_colour.hpp) ...
    std::optional<std::pair<bool, scene::WaterOptics>> water_made_; ///< ... as it was made last
    double water_longest_m_ = 1.0;                                  ///< its last path
    bool prisms_asked_ = false; ///< of light, in place of places along each view
    int prism_cells_ = 64;
    std::optional<LightPrisms> prisms_;
    gpu::Texture2D sunlit_;   ///< how waves focus the light of each part, with caustics only
    gpu::Texture2D surfaces_; ///< of the water met, for the passes after the first; with waves only
    double top_m_ = 0.0, water_top_m_ = 0.0; ///< highest node, above z = 0; highest level
    bool wet_border_ = false;                ///< water lies at the scene's border
    double deepest_m_ = 0.0;                 ///< water of the scene
    glm::dvec3 camera_m_{0.0};
    bool in_slab_ =
        false;            ///< rays may enter the slab of a lake's waves from its side, and leave it
    double lift_m_ = 0.0; ///< how far the walk's water is raised above its level
    scene::Walk walk_ = scene::Walk::cone_map;
    std::vector<std::uint16_t>
        packed_; ///< heights as they go up; empty but while a level is dragged
    std::size_t heights_bytes_ = 0;
    int samples_ = 1;
    int first_row_ = 0; ///< of the picture that the targets hold
    bool rays_in_step_;
};

} // namespace tarn::render
