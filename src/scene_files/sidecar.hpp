#pragma once
/// @file sidecar.hpp  The small file beside a picture that says how to make it again.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tarn::scene_files {

/// Names of options without dashes, and what was given for them.
using OptionList = std::vector<std::pair<std::string, std::string>>;

/// @return "picture", "scene", "options" and "about", ending with a newline
std::string sidecar_json(const std::string& picture, const std::string& scene,
                         const OptionList& options,
                         const std::map<std::string, std::string>& about);

/// The options of a sidecar.
/// @throws tarn::Error  naming the file, if it is none
OptionList read_sidecar(const std::filesystem::path& path);

/// What the sidecar says of `name`, among "about".
std::optional<std::string> sidecar_value(const std::filesystem::path& path,
                                         const std::string& name);

/// Does the file hold just this?
bool same_text(const std::filesystem::path& path, const std::string& text);

/// Does the sidecar say `value` of `name`, among "about"? No if it is none.
bool sidecar_says(const std::filesystem::path& path, const std::string& name,
                  const std::string& value);

} // namespace tarn::scene_files
