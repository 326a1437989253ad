#pragma once
/// @file remote_source.hpp  A collection of elevation tiles on the network, by its URL pattern.
#include <string>
#include <vector>

namespace tarn {

struct RemoteSource {
    std::string name; ///< as --source takes it
    std::string url;  ///< pattern with {NS} {ns} {EW} {ew} {lat} {lon}, see docs/commands/import.md
    double tile_deg = 1.0;       ///< side of a tile
    bool named_by_north = false; ///< {lat} is the tile's northern edge (else its southern)
    std::vector<int> missing_status = {404, 410}; ///< answers that mean: no such tile (sea, abroad)
    std::string about;                            ///< what it holds, and whom to credit
};

} // namespace tarn
