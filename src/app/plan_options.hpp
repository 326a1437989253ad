#pragma once
/// @file plan_options.hpp  --max-error and --frame-time: no more than a scene needs.
#include "render/planner.hpp"
#include "scene_files/sidecar.hpp"

#include <CLI/App.hpp>

namespace tarn::app {

struct PlanWords {
    render::Budget budget;
    bool explain = false;
};

/// Adds --max-error, --frame-time and --explain.
void add_plan_options(CLI::App& command, PlanWords& words);

/// The options of `tarn render` that draw as a plan says.
scene_files::OptionList options_of(const render::Plan& plan);

/// Options of a picture with what a plan chose in place of the budget.
scene_files::OptionList planned_options(const scene_files::OptionList& options,
                                        const render::Plan& plan);

/// In lines for people: each decision, then what the whole is predicted to be.
std::string explained(const render::Plan& plan);

} // namespace tarn::app
