#include "app/plan_options.hpp"

#include "app/picture.hpp"
#include "core/text.hpp"

#include <cstdio>

namespace tarn::app {

namespace {

std::string milliseconds(double ms) {
    char out[40];
    std::snprintf(out, sizeof out, "%.3g ms", ms);
    return out;
}

} // namespace

void add_plan_options(CLI::App& c, PlanWords& w) {
    c.add_option("--max-error", w.budget.max_error,
                 "draw as quickly as keeps to this mean relative radiance error against everything "
                 "at its best, 0.01 for 1 %");
    c.add_option("--frame-time", w.budget.frame_time_ms,
                 "draw as truly as a picture's time allows [ms]; with --max-error only warns");
    c.add_flag("--explain", w.explain, "print what was left out for that, and why");
}

scene_files::OptionList options_of(const render::Plan& plan) {
    const scene::RenderSettings& s = plan.view.settings;
    scene_files::OptionList out;
    if (s.coarse_far_land)
        out.push_back({"coarse-far-land", "true"});
    if (!s.shadows)
        out.push_back({"no-shadows", "true"});
    if (!s.reflection)
        out.push_back({"no-reflection", "true"});
    if (!s.mirrored_land)
        out.push_back({"no-mirrored-land", "true"});
    if (!s.refraction)
        out.push_back({"no-refraction", "true"});
    if (s.earth_curvature)
        out.push_back({"curvature", *s.earth_curvature ? "on" : "off"});
    out.push_back({"least-transmittance", text(s.least_transmittance)});
    if (plan.view.waves.calm()) {
        out.push_back({"waves", "calm"});
        return out;
    }
    out.push_back({"wave-cascades", text(plan.view.waves.cascades)});
    for (const scene::CausticsMethod& m : scene::caustics_methods())
        if (m.caustics == s.caustics)
            out.push_back({"caustics", m.name});
    if (s.caustics != scene::Caustics::off) {
        out.push_back({"caustic-texels", text(s.caustic_texels)});
        out.push_back({"caustic-photons", text(s.caustic_photons)});
        out.push_back({"shaft-steps", text(s.shaft_steps)});
    }
    return out;
}

scene_files::OptionList planned_options(const scene_files::OptionList& options,
                                        const render::Plan& plan) {
    scene_files::OptionList out;
    for (const auto& option : options)
        if (option.first != "max-error" && option.first != "frame-time")
            out.push_back(option);
    for (const auto& [name, value] : options_of(plan))
        out = with_option(out, name, value);
    return out;
}

std::string explained(const render::Plan& plan) {
    std::string out;
    for (const render::Decision& d : plan.decisions) {
        char line[160];
        std::snprintf(line, sizeof line, "  %-5s %-10s %-30s error %8s, saves %9s", //
                      d.taken ? "takes" : "not", d.part.c_str(), d.choice.c_str(),
                      percent(d.error, 2).c_str(), milliseconds(d.saved_ms).c_str());
        out += line + std::string("  ") + d.why + "\n";
    }
    out += text("  planned in ", fixed(plan.planning_s, 2), " s by ", plan.trials, " trials of ",
                plan.blocks, " blocks: at most ", percent(plan.predicted_error, 2), " of error, ",
                milliseconds(plan.predicted_ms), " instead of ", milliseconds(plan.everything_ms),
                plan.kept ? "" : "; THE BUDGET CANNOT BE KEPT, this comes nearest", "\n");
    out += "  the same by hand:";
    for (const auto& [name, value] : options_of(plan))
        out += value == "true" ? " --" + name : " --" + name + " " + value;
    return out + "\n";
}

} // namespace tarn::app
