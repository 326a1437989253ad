#include "scene_files/sidecar.hpp"

#include "core/error.hpp"

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

namespace tarn::scene_files {

using json = nlohmann::ordered_json;

std::string sidecar_json(const std::string& picture, const std::string& scene,
                         const OptionList& options,
                         const std::map<std::string, std::string>& about) {
    json out = {{"picture", picture},
                {"scene", scene},
                {"options", json::object()},
                {"about", json::object()}};
    for (const auto& [name, value] : options)
        out["options"][name] = value;
    for (const auto& [name, value] : about)
        out["about"][name] = value;
    return out.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

OptionList read_sidecar(const std::filesystem::path& path) {
    std::ifstream in(path);
    const json read = json::parse(in, nullptr, false);
    if (!in || read.is_discarded() || !read.is_object() || !read.contains("options") ||
        !read["options"].is_object())
        throw Error(path.string() + ": is no picture's sidecar",
                    "give the .json that tarn wrote beside a picture, or a file with one name = "
                    "value a line");
    OptionList out;
    for (const auto& [name, value] : read["options"].items()) {
        if (!value.is_string())
            throw Error(path.string() + ": options." + name + " must be a string");
        out.emplace_back(name, value.get<std::string>());
    }
    return out;
}

bool same_text(const std::filesystem::path& path, const std::string& text) {
    std::ifstream in(path, std::ios::binary);
    const std::string found{std::istreambuf_iterator<char>(in), {}};
    return found == text;
}

std::optional<std::string> sidecar_value(const std::filesystem::path& path,
                                         const std::string& name) {
    std::ifstream in(path);
    const json read = json::parse(in, nullptr, false);
    if (read.is_discarded() || !read.is_object() || !read.contains("about") ||
        !read["about"].is_object() || !read["about"].contains(name) ||
        !read["about"][name].is_string())
        return std::nullopt;
    return read["about"][name].get<std::string>();
}

bool sidecar_says(const std::filesystem::path& path, const std::string& name,
                  const std::string& value) {
    return sidecar_value(path, name) == value;
}

} // namespace tarn::scene_files
