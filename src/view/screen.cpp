#include "view/screen.hpp"

#include "image/tone.hpp"
#include "scene/exposure.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace tarn::view {

namespace {

// A person notices that it hangs from a tenth of a second on; 60 pictures a second are smooth.
constexpr double software_ms = 110.0, gpu_ms = 12.0;

double now_ms() {
    return 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
                     .count();
}

} // namespace

Screen::Screen(render::Renderer& renderer)
    : renderer_(renderer),
      pacing_(gpu::is_software() ? software_ms : gpu_ms, gpu::is_software() ? 0.375 : 1.0),
      software_(gpu::is_software()) {}

bool Screen::update(scene::View view, const scene::Scene& scene, int width_px, int height_px,
                    bool moving, std::optional<double> exposure, double seconds) {
    if (width_px != width_px_ || height_px != height_px_) {
        width_px_ = width_px;
        height_px_ = height_px;
        stale_ = true;
    }
    const double start = now_ms();
    if (stale_) {
        const double scale = pacing_.scale();
        view.settings.width_px = std::max(8, int(std::lround(width_px * scale)));
        view.settings.height_px = std::max(8, int(std::lround(height_px * scale)));
        view.settings.samples = 1;
        renderer_.prepare(view);
        renderer_.draw_rows(0, 1, 0, view.settings.height_px);
        glFinish();
        pacing_.took(now_ms() - start);
        meter(scene, view, 1.0, exposure, seconds);
        display(1.0);
        stale_ = fine_ = false;
        sample_ = 0;
        samples_ = std::max(1, view.settings.samples);
        shown_scale_ = scale;
        shown_samples_ = 1;
        return true;
    }
    if (moving)
        return false;
    const int samples = std::max(1, view.settings.samples);
    if (!fine_) {
        view.settings.width_px = width_px;
        view.settings.height_px = height_px;
        renderer_.prepare(view);
        fine_ = true;
        sample_ = next_row_ = 0;
        samples_ = samples;
    }
    if (sample_ >= samples_) { // only the exposure still has to settle
        if (settled_)
            return false;
        meter(scene, view, 1.0, exposure, seconds);
        display(1.0);
        return true;
    }
    // Whole samples on a GPU; on software GL as many rows as there is time for.
    const int least = 16;
    while (sample_ < samples_ && now_ms() - start < 0.6 * pacing_.target_ms()) {
        int rows = height_px - next_row_;
        if (software_) {
            const double left = 0.6 * pacing_.target_ms() - (now_ms() - start);
            const int able = row_ms_ > 0.0 ? int(left / row_ms_) : least;
            rows = std::min(rows, std::max(least, able / 8 * 8));
        }
        const double before = now_ms();
        renderer_.draw_rows(sample_, samples_, next_row_, rows);
        glFinish();
        row_ms_ = (now_ms() - before) / rows;
        next_row_ += rows;
        if (next_row_ < height_px)
            continue;
        next_row_ = 0;
        ++sample_;
        meter(scene, view, double(samples_) / sample_, exposure, seconds);
        display(double(samples_) / sample_);
        shown_scale_ = 1.0;
        shown_samples_ = sample_;
        if (software_)
            break;
    }
    return true;
}

void Screen::meter(const scene::Scene& scene, const scene::View& view, double share,
                   std::optional<double> fixed, double seconds) {
    if (fixed) {
        exposure_ = wanted_exposure_ = *fixed;
        settled_ = true;
        first_ = false;
        return;
    }
    Image small;
    small.width_px = render::Display::across;
    small.height_px = render::Display::down;
    for (const glm::vec3& radiance : display_.meter(renderer_.radiance()))
        small.radiance.push_back(radiance * float(share));
    const scene::ExposureRange range = scene::exposure_range(scene, view);
    wanted_exposure_ =
        image::auto_exposure(small, range.key, range.least, range.greatest, range.dark_share);
    // The eye takes its time: half a second for a factor of e.
    const double left = std::exp(-seconds / 0.5);
    const double ratio = std::log(wanted_exposure_ / exposure_);
    exposure_ = first_ ? wanted_exposure_ : wanted_exposure_ * std::exp(-ratio * left);
    settled_ = std::abs(std::log(wanted_exposure_ / exposure_)) < 0.01;
    if (settled_)
        exposure_ = wanted_exposure_;
    first_ = false;
}

void Screen::display(double share) { display_.show(renderer_.radiance(), exposure_, share); }

float Screen::distance_at(double x, double y) const {
    const gpu::Texture2D& d = renderer_.distance();
    if (d.id() == 0 || !(x >= 0.0 && x < 1.0 && y >= 0.0 && y < 1.0))
        return 1e9f;
    if (fine_ && sample_ == 0 && int(y * d.height_px()) >= next_row_)
        return std::numeric_limits<float>::quiet_NaN();
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    float out = 1e9f;
    glGetTextureSubImage(d.id(), 0, int(x * d.width_px()), int(y * d.height_px()), 0, 1, 1, 1,
                         GL_RED, GL_FLOAT, sizeof out, &out);
    return out;
}

std::vector<std::pair<std::string, double>> Screen::time_passes(const scene::View& view) {
    std::vector<std::pair<std::string, double>> out;
    std::string current;
    double since = 0.0;
    const auto done = [&](const char* next) {
        glFinish();
        const double now = now_ms();
        if (!current.empty() && current != "end") {
            const auto known = std::find_if(out.begin(), out.end(),
                                            [&](const auto& p) { return p.first == current; });
            if (known == out.end())
                out.emplace_back(current, now - since);
            else
                known->second += now - since;
        }
        current = next;
        since = now;
    };
    renderer_.prepare(view);
    renderer_.on_pass = done;
    renderer_.move_waves(view.waves.time_s);
    renderer_.draw_rows(0, std::max(1, view.settings.samples), 0, view.settings.height_px);
    done("end");
    renderer_.on_pass = {};
    stale_ = true;
    return out;
}

} // namespace tarn::view
