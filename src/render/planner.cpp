#include "render/planner.hpp"

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/text.hpp"
#include "scene/curvature.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>

namespace tarn::render {

namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// A way of drawing one part.
struct Level {
    std::string choice, why;
    std::function<void(scene::View&)> apply;
    bool exact = false; ///< geometry says that nothing of it can be seen
    bool tried = false;
    double error = 0.0, saved_ms = 0.0;
    BlockError found = {};
};

/// Ways of drawing one part, from the best, which stands for nothing, to the cheapest.
struct Part {
    std::string name;
    std::vector<Level> levels;
};

/// One picture's blocks: how they look, and how long the whole picture takes by them.
struct Trial {
    Image blocks;
    double ms = 0.0;
};

class Planner {
public:
    Planner(Renderer& renderer, const scene::Scene& scene, const scene::View& view)
        : renderer_(renderer), scene_(scene), everything_(scene::at_its_best(view)) {
        const scene::RenderSettings& s = view.settings;
        // Software GL draws a sample of blocks, and its time grows with the pixels. A GPU is idle
        // over so few: there the whole picture is timed, which takes a millisecond or so.
        const double blocks = double(s.width_px / 8) * (s.height_px / 8);
        const double wanted = gpu::is_software() ? 240.0 : 4000.0;
        every_ = std::max(1, int(std::floor(std::sqrt(blocks / wanted))));
    }

    Plan plan(const Budget& budget, const Progress& progress) {
        budget.validate();
        const auto start = Clock::now();
        progress.report(0.0, "planning");
        best_ = draw(everything_);
        Plan plan;
        plan.everything_ms = best_.ms;
        plan.blocks = int(best_.blocks.radiance.size() / 64);
        list_parts();
        // Errors of parts add up at most (the triangle inequality: each is a mean of absolute
        // differences), so whatever is above the whole budget alone need not be looked at twice.
        const double ceiling = budget.max_error.value_or(std::numeric_limits<double>::infinity());
        for (std::size_t k = 0; k < parts_.size(); ++k) {
            progress.report(double(k + 1) / double(parts_.size() + 2), "planning");
            try_levels(parts_[k], ceiling);
        }
        choose(budget, ceiling, plan);
        plan.trials = trials_;
        plan.planning_s = 1e-3 * ms_since(start);
        return plan;
    }

private:
    Trial draw(const scene::View& view) {
        ++trials_;
        Trial trial;
        renderer_.prepare(view);
        renderer_.draw_blocks(every_); // programs are made when they first run
        glFinish();
        const bool software = gpu::is_software();
        const int runs = software ? 2 : 5;
        double pixels_ms = std::numeric_limits<double>::infinity();
        for (int i = 0; i < runs; ++i) {
            const auto start = Clock::now();
            if (software) // beams are a whole picture's, which is no time of the blocks
                renderer_.draw_blocks(every_, false);
            else
                renderer_.draw_once();
            glFinish();
            pixels_ms = std::min(pixels_ms, ms_since(start));
        }
        if (!software)
            renderer_.draw_blocks(every_, false);
        trial.blocks = renderer_.read_blocks(every_);
        const scene::RenderSettings& s = view.settings;
        const double share =
            software ? double(trial.blocks.radiance.size()) / (double(s.width_px) * s.height_px)
                     : 1.0 / s.samples;
        trial.ms = waves_ms(view, runs) + (share > 0.0 ? pixels_ms / share : 0.0);
        return trial;
    }

    /// Time of the waves and their sunlight of a prepared view, measured once for all that share
    /// them.
    double waves_ms(const scene::View& view, int runs) {
        if (view.waves.calm())
            return 0.0;
        const scene::RenderSettings& s = view.settings;
        const std::string key =
            text(view.waves.cascades, " ", view.waves.texels, " ", int(s.caustics), " ",
                 s.caustics == scene::Caustics::off ? 0 : s.caustic_texels, " ", s.caustic_photons);
        const auto [known, fresh] = waves_ms_.try_emplace(key, 1e300);
        if (fresh)
            for (int i = 0; i < (gpu::is_software() ? 1 : runs); ++i) {
                const auto start = Clock::now();
                renderer_.move_waves(view.waves.time_s); // with sunlight
                glFinish();
                known->second = std::min(known->second, ms_since(start));
            }
        return known->second;
    }

    void list_parts() {
        const scene::RenderSettings& s = everything_.settings;
        const bool wavy = !everything_.waves.calm();
        const glm::dvec3 sun = everything_.lighting.sun_direction;
        using scene::View;
        const scene::CurvatureDrop drop =
            scene::curvature_drop(scene_, everything_.camera, s.height_px);
        const std::string falls = text("level ground falls ", fixed(drop.drop_m, 1), " m in ",
                                       fixed(1e-3 * drop.distance_m, 1), " km: ");
        if (!scene::is_curved(scene_, everything_))
            proved_.push_back(
                {"curvature", "off", text(falls, fixed(drop.pixels, 2), " pixels at most"), true});
        else if (!s.earth_curvature) // else it was asked for
            add("curvature", {{"off", falls + "as little of it is seen",
                               [](View& v) { v.settings.earth_curvature = false; }}});
        if (s.walk == scene::Walk::cone_map && !s.coarse_far_land) {
            const double from_m = 2.0 * scene_.ground.spacing_m / // a block of two cells
                                  scene::pixel_rad(everything_.camera, s.height_px);
            if (from_m < drop.distance_m)
                add("far land", {{"coarse",
                                  text("from ", fixed(1e-3 * from_m, 1),
                                       " km on two cells are narrower than a pixel"),
                                  [](View& v) { v.settings.coarse_far_land = true; }}});
        }
        if (s.spectral)
            proved_.push_back({"colour", "three channels",
                               "a frame looks colours up in one table either way: no time is saved",
                               false});
        if (s.shadows && sun.z > 0.0) {
            const double rise = sun.z / std::max(std::hypot(sun.x, sun.y), 1e-9);
            const bool none = steepest_slope(scene_.ground) < rise;
            add("shadows", {{"off",
                             none ? "no slope is as steep as the sun stands high: nothing hides it"
                                  : "as little of the picture lies in shadow as is seen",
                             [](View& v) { v.settings.shadows = false; }, none}});
        }
        if (s.reflection) {
            std::vector<Level> levels;
            if (s.mirrored_land)
                levels.push_back({"of the sky alone", "what land the water mirrors makes no more",
                                  [](View& v) { v.settings.mirrored_land = false; }});
            levels.push_back({"off", "what the water mirrors makes no more",
                              [](View& v) { v.settings.reflection = false; }});
            add("reflection", std::move(levels));
        }
        if (s.refraction) {
            std::vector<Level> levels;
            for (const double left : {0.002, 0.01, 0.05, 0.2})
                if (left > s.least_transmittance)
                    levels.push_back({text("paths end where ", 100.0 * left, " % is left"),
                                      text("d_max ", fixed(path_m(left), 1), " m instead of ",
                                           fixed(path_m(s.least_transmittance), 1), " m"),
                                      [left](View& v) { v.settings.least_transmittance = left; }});
            levels.push_back({"off", "what is seen through the surface makes no more",
                              [](View& v) { v.settings.refraction = false; }});
            add("refraction", std::move(levels));
        }
        if (wavy) {
            std::vector<Level> levels;
            if (everything_.waves.cascades > 1)
                levels.push_back({text(everything_.waves.cascades - 1, " cascades"),
                                  "smaller waves are roughness",
                                  [](View& v) { v.waves.cascades -= 1; }});
            levels.push_back(
                {"a plane", "far or low waves show no more", [](View& v) { v.waves = {}; }});
            add("waves", std::move(levels));
        }
        if (wavy && s.caustics != scene::Caustics::off && renderer_.caustics()) {
            std::vector<Level> levels;
            for (const int texels : {512, 256, 128, 64})
                if (texels <= s.caustic_texels)
                    levels.push_back({text("tiles of ", texels),
                                      "their finer pattern shows no more", [texels](View& v) {
                                          v.settings.caustic_texels =
                                              std::min(texels, v.waves.texels);
                                          v.settings.caustic_photons = 1;
                                      }});
            levels.push_back({"off", "no pattern is seen: too deep, too far or too faint",
                              [](View& v) { v.settings.caustics = scene::Caustics::off; }});
            add("caustics", std::move(levels));
            if (s.shaft_steps > 0) {
                std::vector<Level> steps;
                for (const int n : {8, 4, 2, 0})
                    if (n < s.shaft_steps)
                        steps.push_back({n ? text(n, " looks a view") : std::string("off"),
                                         "shafts of light show no more",
                                         [n](View& v) { v.settings.shaft_steps = n; }});
                add("shafts", std::move(steps));
            }
        }
    }

    void add(std::string name, std::vector<Level> levels) {
        parts_.push_back({std::move(name), std::move(levels)});
    }

    double path_m(double left) const {
        scene::RenderSettings s = everything_.settings;
        s.least_transmittance = left;
        return scene::greatest_path_m(scene_.optics, s);
    }

    /// From the cheapest way on, until one is so near to the best that better ones are not worth
    /// it.
    void try_levels(Part& part, double ceiling) {
        for (std::size_t k = part.levels.size(); k-- > 0;) {
            Level& level = part.levels[k];
            scene::View view = everything_;
            level.apply(view);
            const Trial trial = draw(view);
            level.tried = true;
            level.saved_ms = best_.ms - trial.ms;
            level.found = block_error(trial.blocks, best_.blocks);
            if (!level.exact)
                level.error = level.found.at_most();
            if (level.error <= 0.2 * ceiling || (std::isinf(ceiling) && level.error < 1e-4))
                return;
        }
    }

    /// Which level of each part: 0 the best, else that level + 1.
    using Choice = std::vector<std::size_t>;

    scene::View view_of(const Choice& choice) const {
        scene::View view = everything_;
        for (std::size_t k = 0; k < parts_.size(); ++k)
            if (choice[k] > 0)
                parts_[k].levels[choice[k] - 1].apply(view);
        return view;
    }

    /// Of a choice by its parts alone: errors add up at most; of the time each part leaves its
    /// share (sums of what is saved might be more than there is).
    void estimate(const Choice& choice, double& error, double& ms) const {
        error = 0.0;
        ms = best_.ms;
        for (std::size_t k = 0; k < parts_.size(); ++k)
            if (choice[k] > 0) {
                const Level& level = parts_[k].levels[choice[k] - 1];
                error += level.error;
                ms *= std::max(1.0 - level.saved_ms / best_.ms, 1e-3);
            }
    }

    std::size_t level_of(const Choice& choice, const std::string& part) const {
        for (std::size_t k = 0; k < parts_.size(); ++k)
            if (parts_[k].name == part)
                return choice[k];
        return 0;
    }

    bool is(const Choice& choice, const std::string& part, const std::string& level) const {
        for (std::size_t k = 0; k < parts_.size(); ++k)
            if (parts_[k].name == part)
                return choice[k] > 0 && parts_[k].levels[choice[k] - 1].choice == level;
        return false;
    }

    /// Calls `act` for every choice of levels that were tried.
    void each_choice(const std::function<void(const Choice&)>& act) const {
        Choice choice(parts_.size(), 0);
        for (;;) {
            act(choice);
            std::size_t k = 0;
            for (; k < parts_.size(); ++k) {
                do
                    ++choice[k];
                while (choice[k] <= parts_[k].levels.size() &&
                       !parts_[k].levels[choice[k] - 1].tried);
                if (choice[k] <= parts_[k].levels.size())
                    break;
                choice[k] = 0;
            }
            if (k == parts_.size())
                return;
        }
    }

    /// The choice that looks best under limits of estimated error and time, of those not looked at
    /// yet; nothing: there is none.
    std::optional<Choice> best_choice(double error_limit, double ms_limit, bool quickest,
                                      const std::set<Choice>& seen) const {
        std::optional<Choice> found;
        double found_error = std::numeric_limits<double>::infinity(), found_ms = found_error;
        each_choice([&](const Choice& choice) {
            // Without waves there are neither, and without caustics no shafts.
            if ((is(choice, "waves", "a plane") &&
                 (level_of(choice, "caustics") > 0 || level_of(choice, "shafts") > 0)) ||
                (is(choice, "caustics", "off") && level_of(choice, "shafts") > 0) ||
                seen.count(choice))
                return;
            double error, ms;
            estimate(choice, error, ms);
            if (error > error_limit || ms > ms_limit)
                return;
            if (quickest ? ms < found_ms : error < found_error) {
                found = choice;
                found_error = error;
                found_ms = ms;
            }
        });
        return found;
    }

    void choose(const Budget& budget, double ceiling, Plan& plan) {
        const bool quickest = budget.max_error.has_value();
        const double within_ms =
            budget.frame_time_ms.value_or(std::numeric_limits<double>::infinity());
        double error_limit = ceiling, ms_limit = quickest ? 1e300 : within_ms;
        Choice chosen(parts_.size(), 0);
        std::set<Choice> seen;
        Trial drawn = best_;
        BlockError error;
        bool settled = false;
        // What one part alone may give is measured already.
        for (std::size_t k = 0; quickest && k < parts_.size(); ++k)
            for (std::size_t j = 0; j < parts_[k].levels.size(); ++j) {
                const Level& level = parts_[k].levels[j];
                if (level.tried && level.error <= ceiling && best_.ms - level.saved_ms < drawn.ms) {
                    chosen.assign(parts_.size(), 0);
                    chosen[k] = j + 1;
                    drawn.ms = best_.ms - level.saved_ms;
                    error = level.found;
                    settled = true;
                }
            }
        if (settled) { // and what geometry proves goes with it
            for (std::size_t k = 0; k < parts_.size(); ++k)
                for (std::size_t j = 0; j < parts_[k].levels.size(); ++j)
                    if (chosen[k] == 0 && parts_[k].levels[j].exact)
                        chosen[k] = j + 1;
            drawn = draw(view_of(chosen));
        }
        // Together parts may err less than in sum, or time may not add up: look, and try again.
        for (int round = 0; round < 7; ++round) {
            const auto best = best_choice(error_limit, ms_limit, quickest, seen);
            if (!best)
                break;
            const Choice choice = *best;
            seen.insert(choice);
            const Trial trial = draw(view_of(choice));
            const BlockError found = block_error(trial.blocks, best_.blocks);
            const bool fits = quickest ? at_most(choice, found) <= ceiling : trial.ms <= within_ms;
            const bool better =
                quickest ? trial.ms < drawn.ms || !settled : found.mean < error.mean || !settled;
            if (fits && better) {
                chosen = choice;
                drawn = trial;
                error = found;
                settled = true;
            }
            // What looks no quicker than what is known need not be drawn.
            if (quickest)
                ms_limit = 0.98 * drawn.ms;
            if (quickest && fits)
                error_limit *=
                    std::clamp(0.95 * ceiling / std::max(at_most(choice, found), 1e-9), 1.0, 1.5);
            else if (quickest) { // this one no more, nor what is hardly better
                double error_sum, ms;
                estimate(choice, error_sum, ms);
                error_limit = 0.98 * std::min(error_limit, error_sum);
            } else if (!fits)
                ms_limit *= 0.95 * within_ms / trial.ms;
            else
                break;
        }
        if (!settled && !quickest) { // the quickest there is
            chosen = best_choice(1e300, 1e300, true, {}).value_or(chosen);
            drawn = draw(view_of(chosen));
            error = block_error(drawn.blocks, best_.blocks);
        }
        plan.view = view_of(chosen);
        plan.predicted_error = at_most(chosen, error);
        plan.predicted_ms = drawn.ms;
        plan.kept = (!budget.max_error || plan.predicted_error <= *budget.max_error) &&
                    (!budget.frame_time_ms || plan.predicted_ms <= *budget.frame_time_ms);
        plan.decisions = proved_;
        for (std::size_t k = 0; k < parts_.size(); ++k)
            for (std::size_t j = 0; j < parts_[k].levels.size(); ++j) {
                const Level& l = parts_[k].levels[j];
                if (l.tried)
                    plan.decisions.push_back(
                        {parts_[k].name, l.choice, l.why, chosen[k] == j + 1, l.error, l.saved_ms});
            }
    }

    /// Nothing but what geometry has proved: no error. Else what blocks show, at most.
    double at_most(const Choice& choice, const BlockError& found) const {
        bool all_exact = true;
        for (std::size_t k = 0; k < parts_.size(); ++k)
            all_exact = all_exact && (choice[k] == 0 || parts_[k].levels[choice[k] - 1].exact);
        return all_exact ? 0.0 : found.at_most();
    }

    Renderer& renderer_;
    const scene::Scene& scene_;
    scene::View everything_;
    int every_ = 1, trials_ = 0;
    std::map<std::string, double> waves_ms_; ///< see waves_ms()
    Trial best_;
    std::vector<Part> parts_;
    std::vector<Decision> proved_; ///< that need no trial
};

} // namespace

void Budget::validate() const {
    if (max_error && !(*max_error >= 1e-4 && *max_error <= 10.0))
        throw Error(text("the greatest error is ", *max_error, ", must be in [0.0001, 10]"));
    if (frame_time_ms && !(*frame_time_ms >= 0.01 && *frame_time_ms <= 1e7))
        throw Error(
            text("the time of a picture is ", *frame_time_ms, " ms, must be in [0.01, 1e7]"));
}

double BlockError::at_most() const {
    // One more block of a tenth stands for what the others did not show.
    return blocks > 0 ? mean + 0.1 / blocks + 2.0 * standard_error : 1.0;
}

BlockError block_error(const Image& got, const Image& expected) {
    BlockError out;
    const int across = expected.width_px / 8, down = expected.height_px / 8;
    out.blocks = across * down;
    if (out.blocks == 0)
        return out;
    const double floor = relative_floor(expected);
    std::vector<double> errors(std::size_t(out.blocks), 0.0);
    for (int y = 0; y < 8 * down; ++y)
        for (int x = 0; x < 8 * across; ++x) {
            const std::size_t i = std::size_t(y) * std::size_t(expected.width_px) + std::size_t(x);
            errors[std::size_t(y / 8 * across + x / 8)] +=
                relative_error(got.radiance[i], expected.radiance[i], floor) / 64.0;
        }
    for (const double e : errors)
        out.mean += e / out.blocks;
    double squares = 0.0;
    for (const double e : errors)
        squares += (e - out.mean) * (e - out.mean);
    if (out.blocks > 1)
        out.standard_error = std::sqrt(squares / (double(out.blocks) * (out.blocks - 1)));
    return out;
}

double steepest_slope(const Heightfield& ground) {
    const GridSize size = ground.size();
    std::vector<double> rows(std::size_t(std::max(1, size.rows - 1)), 0.0);
    share_out(size.rows - 1, 0, [&](int first, int last) {
        for (int row = first; row < last; ++row) {
            long steepest = 0; // squared, in codes: a patch's gradient is greatest in its corners
            for (int col = 0; col + 1 < size.cols; ++col) {
                const auto z = [&](int c, int r) { return long(ground.codes[{c, r}]); };
                const long a = z(col, row), b = z(col + 1, row), c = z(col, row + 1),
                           d = z(col + 1, row + 1);
                const long x = std::max(std::abs(b - a), std::abs(d - c)),
                           y = std::max(std::abs(c - a), std::abs(d - b));
                steepest = std::max(steepest, x * x + y * y);
            }
            rows[std::size_t(row)] = std::sqrt(double(steepest));
        }
    });
    return *std::max_element(rows.begin(), rows.end()) * ground.scale_m / ground.spacing_m;
}

Plan make_plan(Renderer& renderer, const scene::Scene& scene, const scene::View& view,
               const Budget& budget, const Progress& progress) {
    return Planner(renderer, scene, view).plan(budget, progress);
}

} // namespace tarn::render
