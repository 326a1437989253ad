#pragma once
/// @file scene.hpp  What is to be drawn, as plain data: both tracers read THIS, so that they cannot
///                  disagree about the input.
#include "core/heightfield.hpp"
#include "core/image.hpp"
#include "core/import_report.hpp"
#include "core/lake_record.hpp"
#include "geo/frame_data.hpp"
#include "scene/camera.hpp"
#include "scene/water_optics.hpp"
#include "waves/settings.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tarn::scene {

/// A viewpoint kept in the scene; import puts the four presets there.
struct NamedCamera {
    std::string name;
    Camera camera;
};

/// Heights at which the ground's colours change, in the scene's vertical datum.
struct GroundLook {
    double tree_line_m = 1900.0;
    double snow_line_m = 2700.0;
};

/// Summer snow and tree lines by latitude: 5400 m - 58 m per degree and 800 m below, a fit by eye
/// to the Alps, Fuji, the Cascades and Scandinavia. For the look only.
GroundLook ground_look(double lat_deg);

/// Bed of a lake whose level was moved down: nothing has grown there.
struct ExposedBed {
    double level_m = 0.0;     ///< that the lake had
    Grid<std::uint8_t> share; ///< 255 where it is, 0 elsewhere; a value a node
};

/// Lines laid over ground and bed.
struct Drape {
    int cols = 0, rows = 0;
    double west_m = 0.0, north_m = 0.0; ///< corner of the first texel
    double texel_m = 1.0;
    double reach_m = 1.0;               ///< nearness falls to 0 over this
    std::vector<std::uint8_t> nearness; ///< 255 on a line
};

/// A piece of a line in space, or a point where both ends are one; a few pixels wide wherever it
/// is.
struct SpaceStroke {
    glm::dvec3 from{0.0}, to{0.0}; ///< scene metres
    float width_px = 2.4f;
};

/// A name beside a place.
struct PlaceLabel {
    glm::dvec3 place{0.0};
    std::string text;
};

struct Scene {
    geo::Frame frame;
    Heightfield ground, water;     ///< same size, spacing and place
    std::vector<LakeRecord> lakes; ///< at least one
    WaterOptics optics;
    waves::Settings waves; ///< what a picture of it shows unless told otherwise
    GroundLook look;
    std::vector<NamedCamera> cameras;
    std::optional<Ortho> ortho;
    ImportReport report;
    std::optional<ExposedBed> exposed_bed;
    std::optional<Drape> drape;
    std::vector<SpaceStroke> space_strokes; ///< lines and points in air and water
    std::vector<PlaceLabel> labels;         ///< of what is draped and what is in space
    /// Of the ground, a value for each cell (core/safety_radius.hpp); made when needed if it is not
    /// here.
    std::optional<Grid<std::uint8_t>> safety_radii;

    /// The lake whose level is nearest to `level_m`.
    const LakeRecord& lake_at_level(double level_m) const;
    /// Water level at a scene position, or nothing where it is dry.
    std::optional<double> water_level_m(double x, double y) const;

    /// Is this place below the level of water that is there?
    bool under_water(const glm::dvec3& place) const;

    /// @throws tarn::Error  if sizes, numbers or lakes do not fit together
    void validate() const;
};

} // namespace tarn::scene
