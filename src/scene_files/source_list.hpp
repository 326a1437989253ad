#pragma once
/// @file source_list.hpp  Tile collections of one's own, from a small JSON file.
#include "core/remote_source.hpp"

#include <filesystem>
#include <vector>

namespace tarn::scene_files {

/// {"sources": [{"name", "url", "tile_deg", "named_by_north", "missing_status", "about"}]}; all but
/// name and url may be left out.
/// @throws tarn::Error  naming the file and field
std::vector<RemoteSource> read_sources(const std::filesystem::path& path);

} // namespace tarn::scene_files
