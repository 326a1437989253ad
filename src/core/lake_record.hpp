#pragma once
/// @file lake_record.hpp  What is known of one lake: the row of `tarn info`.
#include "core/geo.hpp"
#include "core/grid.hpp"

#include <optional>
#include <string>
#include <vector>

namespace tarn {

/// Where the heights under the water come from.
enum class Bed {
    measured,     ///< the DEM or a bathymetry raster holds the bed
    interpolated, ///< between soundings or contours
    estimated,    ///< from distance to shore and a given greatest depth
    unknown       ///< the DEM holds the water's surface; nothing is known below it
};

std::string to_string(Bed bed);

/// @throws tarn::Error  on a word that to_string() never gives
Bed bed_from_string(const std::string& word);

/// Where rising water would leave a lake.
struct LakeSpill {
    double level_m = 0.0;    ///< the lake may rise to this
    GeoPoint pass;           ///< the highest ground on the water's way out
    bool at_surface = false; ///< the edge of the data cuts the lake: it is open as it stands
};

struct LakeRecord {
    int id = 0;           ///< 1, 2, ... within the scene
    std::string name;     ///< free text, may be empty
    bool sea = false;     ///< open at the edge of the data, at about 0 m
    double level_m = 0.0; ///< in the DEM's vertical datum
    Bed bed = Bed::measured;
    double area_m2 = 0.0;      ///< wet nodes times spacing squared, in the grid's projection
    double true_area_m2 = 0.0; ///< the same on the ellipsoid: divided by the scale factor squared
    // Depth figures are absent where the bed is unknown: no number is better than a false one.
    std::optional<double> volume_m3;      ///< sum over wet nodes of depth times spacing squared
    std::optional<double> true_volume_m3; ///< the same on the ellipsoid
    std::optional<double> max_depth_m;    ///< greatest depth of a wet node
    std::optional<double> mean_depth_m;   ///< volume over area
    double shoreline_m = 0.0;  ///< length of the curve where ground and level cross, islands too
    int islands = 0;           ///< dry parts (4-connected) that the lake surrounds
    bool open_at_edge = false; ///< touches the edge of the data: may go on outside
    std::optional<LakeSpill> spill; ///< nothing if it was not asked for
    double flat_share = 0.0; ///< part of its nodes that lie in a flat surface of the DEM, [0, 1]
    GeoPoint position;       ///< a wet node deep inside the lake
    Node seed;               ///< the node that position came from
    std::vector<Node> parts; ///< a node of each part that it has: bays behind causeways
    Node west_north, east_south; ///< bounding box of its wet nodes, inclusive
};

} // namespace tarn
