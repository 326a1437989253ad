// `tarn info` — what is in a scene folder.
#include "app/command.hpp"
#include "app/report.hpp"
#include "scene_files/scene_folder.hpp"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

namespace tarn::app {

void add_info(CLI::App& app, Run& run) {
    struct Words {
        std::string scene;
        bool json = false;
    };
    auto words = std::make_shared<Words>();
    CLI::App* c =
        app.add_subcommand("info", "what is in a scene: lakes, georeference, import report");
    c->add_option("SCENE", words->scene, "scene folder")->required();
    c->add_flag("--json", words->json, "the same for programs (as scene.json holds it)");
    c->footer("Examples:\n  tarn info rotoma\n  tarn info rotoma --json | jq .lakes[0].area_m2");
    c->callback([words, &run] {
        run = [words] {
            const scene::Scene scene = scene_files::load(words->scene);
            if (words->json) // checked by load(), printed as it is
                std::cout
                    << std::ifstream(std::filesystem::path(words->scene) / "scene.json").rdbuf();
            else
                std::cout << full_report(scene);
            return 0;
        };
    });
}

} // namespace tarn::app
