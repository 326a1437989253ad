// Any text as a scene.json: a scene, or one Error of one line. What is a scene can be written and
// read again.
#include "core/error.hpp"
#include "scene_files/scene_json.hpp"

#include <cstdint>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tarn;
    try {
        scene_files::FileNames files;
        const scene::Scene scene =
            scene_files::from_json(std::string(reinterpret_cast<const char*>(data), size), files);
        scene_files::FileNames again;
        scene_files::from_json(scene_files::to_json(scene, files), again);
    } catch (const Error& error) {
        if (std::string(error.what()).find('\n') != std::string::npos)
            std::abort();
    }
    return 0;
}
