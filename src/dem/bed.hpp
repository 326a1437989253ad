#pragma once
/// @file bed.hpp  What lies under the water: a bathymetry raster, soundings, an estimate, or room
///                for water of unknown depth.
#include "core/heightfield.hpp"
#include "dem/marks.hpp"
#include "dem/statistics.hpp"

#include <span>
#include <string>
#include <vector>

namespace tarn::dem {

/// What the values of a bathymetry mean.
enum class BathymetryKind { automatic, elevation, depth };

/// Depths and elevations are told apart by the shallowest values, which lie by the shore: near 0
/// for depths, near the surface's height for elevations.
BathymetryKind judge_kind(const std::vector<float>& inside, double surface_m);

/// One lake whose bed is to be made.
struct BedPlace {
    const LakeOf& lake_of;
    const Marks& marks;
    int id = 1;
    Box box;                    ///< of the lake's nodes
    double surface_m = 0.0;     ///< the water's height from which depths count
    bool surface_known = false; ///< the DEM holds the water's surface: only its nodes are replaced

    bool wet(Node n) const { return lake_of.contains(n) && lake_of[n] == id; }
    /// A node whose ground the DEM does not know.
    bool surface(Node n) const {
        return wet(n) && (!surface_known || (marks[n] & (mark::flat | mark::filled)) != 0);
    }
    Box widened() const;   ///< the box and one node around it, within the grid
    GridSize size() const; ///< of the widened box
};

struct Merged {
    std::vector<std::string> notes; ///< how the values were read, how many nodes they changed
    double coverage = 0.0;          ///< part of the nodes of unknown ground that the survey reached
};

/// Merges a bathymetry into the ground inside the lake.
///
/// Nodes of the lake's surface that the survey does not cover (the rim between survey and shore,
/// mostly) are interpolated between the survey and the shoreline, where the depth is 0: no cliff.
/// @param survey  on the widened box, NaN where not surveyed; depths of either sign
/// @throws tarn::Error  if no value lies inside the lake, or most lie above its surface
Merged merge_bathymetry(Grid<float>& elevation_m, const BedPlace& place, const Grid<float>& survey,
                        BathymetryKind kind);

/// A place where the depth was measured, in scene metres from node (0, 0), in nodes.
struct Sounding {
    double col = 0.0, row = 0.0; ///< may lie between nodes
    double value = 0.0;          ///< depth of either sign, or elevation
};

/// Turns soundings (or the vertices of contours) into a survey on the widened box: linear
/// interpolation over their Delaunay triangles, with depth 0 half way between each wet node and a
/// dry neighbour (GDAL's gridding, "linear").
/// @param value_at_shore  0 for depths, the surface's height for elevations
Grid<float> grid_soundings(const BedPlace& place, std::span<const Sounding> soundings,
                           double value_at_shore);

/// Depths from the distance to the shore: 0 there, `max_depth_m` where that is greatest.
///
/// Source  d = max (1 - (1 - x)^1.75), x = share of the greatest distance: a basin whose mean depth
///         is .47 of its greatest if it is round, which is what Neumann (1959, J. Fish. Res. Board
///         Can. 16) found for a hundred lakes. An estimate, not a survey.
void estimate_depths(Grid<float>& elevation_m, const BedPlace& place, double max_depth_m);

/// Where the DEM holds the water's surface itself, lowers the lakes' ground codes so that water has
/// room. At the rim by as much as the dry neighbours stand above the level, so that the drawn
/// shore runs midway between the last wet and the first dry node, as cell sums assume; inside by
/// a nominal 5 m. NOT a depth: the lake's bed is reported as unknown and drawn as unseen.
/// @param levels_m  of lakes 1, 2, ...; NaN for those whose bed is known
/// @return the number of nodes lowered
std::size_t make_room(Heightfield& ground, const LakeOf& lake_of, const Marks& marks,
                      std::span<const double> levels_m);

/// The greatest depth that make_room() gives a node.
inline constexpr double greatest_room_m = 30.0;

} // namespace tarn::dem
