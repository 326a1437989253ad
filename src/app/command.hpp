#pragma once
/// @file command.hpp  A subcommand adds itself to the command line and says what to run.
#include <CLI/App.hpp>
#include <functional>
#include <optional>
#include <string>

namespace tarn::app {

/// Set by the subcommand that was named; returns the exit code (0 done, 1 failed).
using Run = std::function<int()>;

/// Each adds one subcommand with its options, help and examples. The options live as long as `run`.
void add_import(CLI::App& app, Run& run);
void add_detect(CLI::App& app, Run& run);
void add_info(CLI::App& app, Run& run);
void add_stats(CLI::App& app, Run& run);
void add_waves(CLI::App& app, Run& run);
void add_render(CLI::App& app, Run& run);
void add_view(CLI::App& app, Run& run);
void add_record(CLI::App& app, Run& run);
void add_sweep(CLI::App& app, Run& run);
void add_bench(CLI::App& app, Run& run);
void add_doctor(CLI::App& app, Run& run);
void add_manual(CLI::App& app, Run& run);

/// A DEM with everything as the defaults of `tarn import` have it.
/// @param level_m  nothing: the water surface that is found
/// @throws tarn::Error
void import_for_viewing(const std::string& dem, const std::string& scene,
                        std::optional<double> level_m);

/// The command line as typed, for provenance.
const std::string& command_line();
void remember_command_line(int argc, char** argv);

} // namespace tarn::app
