// Any words after `tarn render`, a line each: a view that keeps to its own ranges, or one Error of
// one line. Words that would open what never ends are left out.
#include "app/command.hpp"
#include "app/view_options.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "scene/samples.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>

namespace tarn::app {

// main.cpp has them, which is not linked.
const std::string& command_line() {
    static const std::string none;
    return none;
}

} // namespace tarn::app

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tarn;
    const std::string all(reinterpret_cast<const char*>(data), size);
    if (all.find("/dev") != std::string::npos || all.find("/proc") != std::string::npos)
        return 0;
    std::vector<std::string> words = split(all, '\n');
    std::reverse(words.begin(), words.end()); // as CLI11 takes them
    static const scene::Scene bowl = scene::bowl(33);
    CLI::App command("render");
    app::ViewWords view_words;
    app::add_view_options(command, view_words);
    try {
        command.parse(words);
    } catch (const CLI::Error&) {
        return 0;
    }
    try {
        app::apply_settings_file(command, view_words);
        scene::Scene scene = bowl;
        const scene::View view = app::make_view(view_words, scene);
        view.settings.validate();
        view.waves.validate();
        scene.optics.validate();
    } catch (const Error& error) {
        if (std::string(error.what()).find('\n') != std::string::npos)
            std::abort();
    }
    return 0;
}
