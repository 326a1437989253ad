// tarn: the command line. Subcommands are in cmd_<name>.cpp; nothing else prints or exits.
#include "app/command.hpp"
#include "app/console.hpp"
#include "core/error.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <new>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace tarn::app {

namespace {
std::string typed;
}

const std::string& command_line() { return typed; }

void remember_command_line(int argc, char** argv) {
    typed = "tarn";
    for (int i = 1; i < argc; ++i)
        typed += " " + shell_word(argv[i]);
}

} // namespace tarn::app

int main(int argc, char** argv) {
    using namespace tarn;
    spdlog::set_default_logger(spdlog::stderr_color_st("tarn"));
    spdlog::set_pattern("tarn: %^%l%$: %v");
    app::remember_command_line(argc, argv);
    app::catch_interrupts();

    CLI::App cli("tarn shows real lakes as they look, from elevation data and a water level.",
                 "tarn");
    cli.set_version_flag("--version", TARN_VERSION);
    cli.require_subcommand(0, 1);
    cli.footer(
        "Start with:  tarn view DEM.tif                        a look at once\n"
        "             tarn import DEM.tif --level auto -o lake  a scene to keep\n"
        "             tarn view lake                            fly, dive, move the level\n"
        "             tarn render lake -o lake.png              a picture, no display needed");
    app::Run run;
    app::add_import(cli, run);
    app::add_detect(cli, run);
    app::add_info(cli, run);
    app::add_stats(cli, run);
    app::add_waves(cli, run);
    app::add_view(cli, run);
    app::add_render(cli, run);
    app::add_sweep(cli, run);
    app::add_record(cli, run);
    app::add_bench(cli, run);
    app::add_doctor(cli, run);
    app::add_manual(cli, run);
    try {
        cli.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return cli.exit(error, std::cout, std::cerr) == 0 ? 0 : 2;
    }
    if (!run) {
        std::cout << cli.help();
        return 0;
    }
    try {
        const int code = run();
        std::cout.flush();
        if (!std::cout)
            throw Error("the output cannot be written", "check the free space");
        return code;
    } catch (const Cancelled& stop) {
        app::end_progress();
        spdlog::warn(stop.what());
    } catch (const Error& error) {
        app::end_progress();
        spdlog::error(error.what());
    } catch (const std::bad_alloc&) {
        app::end_progress();
        spdlog::error(
            "out of memory; cut the scene with --at and --radius, or choose a coarser --spacing");
    } catch (const std::exception& error) {
        app::end_progress();
        spdlog::error("unexpected: {}", error.what());
    }
    return 1;
}
