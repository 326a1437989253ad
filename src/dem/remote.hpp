#pragma once
/// @file remote.hpp  Cloud-optimised elevation tiles on the network: only the blocks that a region
///                   needs are fetched, and kept in a cache.
#include "core/progress.hpp"
#include "core/remote_source.hpp"
#include "dem/mosaic.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace tarn::dem {

/// The collections that tarn knows without a configuration file.
const std::vector<RemoteSource>& known_sources();

/// URL of the tile with that south-west corner [whole multiples of tile_deg].
/// @throws tarn::Error  if the pattern has an unknown placeholder
std::string tile_url(const RemoteSource& source, int south_deg, int west_deg);

struct FetchOptions {
    std::filesystem::path cache; ///< folder; made if it is not there
    double timeout_s = 60.0;     ///< for each answer, [1, 3600]
};

struct Fetched {
    std::vector<std::filesystem::path> tiles; ///< local copies; blocks not asked for are no data
    std::vector<std::string> notes;
    std::size_t blocks_fetched = 0, blocks_cached = 0;
};

/// Brings the blocks of all tiles that `bounds` touches into the cache.
/// @throws tarn::Error  if the server fails or does not answer in time (what is cached stays), or
///                      no tile exists there
/// @throws tarn::Cancelled
Fetched fetch_tiles(const RemoteSource& source, const Bounds& bounds, const FetchOptions& options,
                    const Progress& progress);

} // namespace tarn::dem
