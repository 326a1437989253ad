#include "scene_files/source_list.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

namespace tarn::scene_files {

std::vector<RemoteSource> read_sources(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in)
        throw Error(path.string() + ": cannot be read", "check the path given with --sources");
    std::vector<RemoteSource> out;
    const std::string hint = "see docs/commands/import.md for an example";
    try {
        const auto parsed = nlohmann::json::parse(in);
        const auto& list = parsed.at("sources");
        if (!list.is_array())
            throw Error(path.string() + ": 'sources' must be a list", hint);
        for (std::size_t i = 0; i < list.size(); ++i) {
            const auto& entry = list[i];
            static const std::array known = {"name",           "url",  "tile_deg", "named_by_north",
                                             "missing_status", "about"};
            for (const auto& [key, value] : entry.items())
                if (std::find(known.begin(), known.end(), key) == known.end())
                    throw Error(text(path.string(), ": sources[", i, "] has '", key,
                                     "', which is no field"),
                                hint);
            RemoteSource source;
            source.name = entry.at("name").get<std::string>();
            source.url = entry.at("url").get<std::string>();
            source.tile_deg = entry.value("tile_deg", source.tile_deg);
            source.named_by_north = entry.value("named_by_north", source.named_by_north);
            source.missing_status = entry.value("missing_status", source.missing_status);
            source.about = entry.value("about", std::string("source of one's own"));
            if (source.name.empty() || source.name[0] == '.' ||
                source.name.find_first_of("/\\") != std::string::npos)
                throw Error(text(path.string(), ": sources[", i, "].name is '", source.name,
                                 "', which is no plain word"),
                            hint);
            if (!source.url.starts_with("http://") && !source.url.starts_with("https://"))
                throw Error(text(path.string(), ": sources[", i, "].url is '", source.url,
                                 "', must begin with http:// or https://"),
                            hint);
            if (source.url.find("{lat}") == std::string::npos ||
                source.url.find("{lon}") == std::string::npos)
                throw Error(text(path.string(), ": sources[", i, "].url has no {lat} or no {lon}"),
                            hint);
            out.push_back(source);
        }
    } catch (const nlohmann::json::exception& error) {
        throw Error(path.string() + ": " + error.what(), hint);
    }
    return out;
}

} // namespace tarn::scene_files
