#pragma once
/// @file lakes.hpp  Finds the lakes in a grid: flat surfaces, surfaces with centimetre ramps or
///                  tile seams, the sea, and voids where the sensor saw water.
#include "core/grid.hpp"
#include "dem/flat.hpp"
#include "dem/marks.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace tarn::dem {

struct FoundLake {
    int id = 0;
    double level_m = 0.0;
    bool sea = false;
    bool open_at_edge = false;
    std::size_t nodes = 0;   ///< wet
    std::vector<Node> seeds; ///< the middles of its surfaces, largest first
};

/// What the search works on.
struct LakeSearch {
    Grid<float>& elevation_m; ///< voids already filled; surfaces of void water and ramps are laid
                              ///< flat in it
    Marks& marks;             ///< mark::flat is set on all surfaces
    LakeOf& lake_of;
    bool stepped = false;            ///< heights come in steps: whole metres, feet, decimetres
    std::size_t least_nodes = 20;    ///< smaller lakes are dropped
    std::size_t most_lakes = 60'000; ///< ids have 16 bits
};

/// Adds, to the exactly flat surfaces, those that are flat but for some centimetres, and voids that
/// water made (an even rim); joins surfaces that step by up to half a metre at a seam: lays them
/// flat and marks them. Call once, before filling.
/// @param stepped  the sources' heights come in steps: then only voids are added
/// @return all surfaces, largest first; sentences for the report go to `notes`
std::vector<FlatSurface> complete_surfaces(Grid<float>& elevation_m, Marks& marks,
                                           std::vector<FlatSurface> flats, bool stepped,
                                           std::vector<std::string>& notes);

/// Fills one lake from surfaces of one level. If its water would run out of the data over ground
/// below the surface (a dam that the grid is too coarse to show), only the surface itself is taken,
/// and hollows of up to a metre that it shuts in.
/// @return nodes = 0 if that is no lake: hardly any surface, and all of it open
FoundLake fill_surface(const LakeSearch& search, const FlatSurface& surface, int id);

/// Fills every surface that no lake holds yet, the largest first, with ids from `first_id` on.
/// Patches of one level beside a lake are its own cut-off bays and join it.
std::vector<FoundLake> find_lakes(const LakeSearch& search,
                                  const std::vector<FlatSurface>& surfaces, int first_id);

/// Adds further surfaces of a lake's own level that lie within a few nodes of it.
void join_bays(const LakeSearch& search, const std::vector<FlatSurface>& surfaces, FoundLake& lake);

/// Is the exact height `level_m` that of a flat surface?
bool has_surface(const std::vector<FlatSurface>& surfaces, double level_m);

} // namespace tarn::dem
