#include "app/picture.hpp"

#include "app/command.hpp"
#include "app/console.hpp"
#include "core/checksum.hpp"
#include "core/error.hpp"
#include "core/text.hpp"
#include "geo/frame.hpp"
#include "geo/sun.hpp"
#include "image/annotate.hpp"
#include "image/tone.hpp"
#include "scene/exposure.hpp"
#include "scene/labels.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>

namespace tarn::app {

namespace {

std::string describe_waves(const waves::Settings& s) {
    std::string out = waves::name_of(s.model);
    if (s.calm())
        return out;
    for (const waves::PlaneWave& w : s.list)
        out += text("; ", w.amplitude_m, ",", w.length_m, ",", w.towards_deg, ",", w.phase_rad);
    if (s.model != waves::Model::calm)
        out += text("; wind ", s.wind_m_per_s, " m/s from ", s.wind_from_deg, " (grid)");
    out += text("; time ", s.time_s, " s of ", s.loop_s, "; seed ", s.seed);
    if (s.ripples.rain_drops_per_m2_s > 0.0)
        out += text("; rain ", s.ripples.rain_drops_per_m2_s, " drops/(m^2 s)");
    for (const waves::Poke& p : s.ripples.pokes)
        out += text("; poke ", p.x_m, ",", p.y_m, ",", p.height_m, ",", p.radius_m, ",", p.time_s);
    return out;
}

/// What a picture has met at a place of it, (0, 0) top left to (1, 1) [m].
double distance_at(const Image& image, double x, double y) {
    const auto pixel = [](double place, int pixels) {
        return std::size_t(std::clamp(int(place * pixels), 0, pixels - 1));
    };
    return std::abs(
        double(image.distance_m[pixel(y, image.height_px) * std::size_t(image.width_px) +
                                pixel(x, image.width_px)]));
}

/// A bar with place, level, date and scale, to stand below a picture.
Picture caption_bar(const Image& overview, const scene::Scene& scene, const scene::View& view,
                    const std::string& time) {
    const int width_px = view.settings.width_px, height_px = view.settings.height_px;
    const int size = std::max(12, std::min(width_px / 60, height_px / 24));
    const int bar = 2 * size;
    Picture out{.width_px = width_px, .height_px = bar, .channels = 3, .bytes = {}};
    out.bytes.assign(std::size_t(width_px) * std::size_t(bar) * 3, std::uint8_t(24));
    const LakeRecord& lake =
        scene.lake_at_level(scene.water_level_m(view.camera.position.x, view.camera.position.y)
                                .value_or(scene.lakes.front().level_m));
    std::string words = (lake.name.empty() ? text(fixed(lake.position.lat_deg, 4), ", ",
                                                  fixed(lake.position.lon_deg, 4))
                                           : lake.name) +
                        "   level " + fixed(lake.level_m, 2) + " m";
    if (lake.bed == Bed::unknown)
        words += " (bed unknown)";
    else if (lake.bed == Bed::estimated)
        words += " (bed ESTIMATED)";
    words += "   " + time;
    const int base = bar / 2 + size / 3;
    image::draw_text(out, size, base, size, words);
    // How long a bar is at what the middle of the picture shows: the scale changes over it.
    const double distance = distance_at(overview, 0.5, 0.5);
    if (std::isfinite(distance) && distance > 0.0) {
        const double metre_px = 1.0 / (scene::pixel_rad(view.camera, height_px) * distance);
        const double length = round_length(0.12 * out.width_px / metre_px);
        const int px = int(std::lround(length * metre_px));
        const std::string label =
            length_words(length) + (view.camera.forward.z < -0.999 ? ""
                                    : distance >= 1000
                                        ? ", " + fixed(distance / 1000, 1) + " km away"
                                    : distance >= 10 ? ", " + fixed(distance, 0) + " m away"
                                                     : ", " + fixed(distance, 1) + " m away");
        const int right = out.width_px - size, wide = int(0.55 * size * double(label.size()));
        image::fill_box(out, right - wide - size - px, base - size / 3 - 2, right - wide - size,
                        base - size / 3 + 2, 235);
        image::draw_text(out, right - wide, base, size, label);
    }
    return out;
}

} // namespace

double choose_exposure(const std::string& words, const Image& picture, const scene::Scene& scene,
                       const scene::View& view) {
    if (words != "auto") {
        const double factor = parse_numbers("--exposure", words, 1)[0];
        if (!(factor > 0.0))
            throw Error("--exposure must be a positive factor, or auto");
        return factor;
    }
    const scene::ExposureRange range = scene::exposure_range(scene, view);
    return image::auto_exposure(picture, range.key, range.least, range.greatest, range.dark_share);
}

image::Metadata describe(const scene::Scene& scene, const scene::View& view,
                         const std::string& device, const std::string& command) {
    const LakeRecord& lake =
        scene.lake_at_level(scene.water_level_m(view.camera.position.x, view.camera.position.y)
                                .value_or(scene.lakes.front().level_m));
    const scene::Camera& c = view.camera;
    const GeoPoint eye = geo::to_geo(scene.frame, {c.position.x, c.position.y});
    const glm::dvec3& s = view.lighting.sun_direction;
    const auto triple = [](const glm::dvec3& v) { return text(v.x, ",", v.y, ",", v.z); };
    return {
        {"Software", text("tarn ", TARN_VERSION)},
        {"Title",
         text(lake.name.empty() ? "Lake" : lake.name, " at ", fixed(lake.level_m, 2), " m")},
        {"tarn:place", text(fixed(lake.position.lat_deg, 6), ",", fixed(lake.position.lon_deg, 6))},
        {"tarn:level_m", text(lake.level_m)},
        {"tarn:vertical_datum", scene.frame.vertical_datum},
        {"tarn:bed", to_string(lake.bed)},
        {"tarn:camera", camera_words(c)},
        {"tarn:camera_place", text(fixed(eye.lat_deg, 6), ",", fixed(eye.lon_deg, 6), " at ",
                                   fixed(c.position.z, 2), " m")},
        {"tarn:sun_direction", triple(s)},
        {"tarn:visibility_m",
         view.lighting.visibility_m ? text(*view.lighting.visibility_m) : "clear"},
        {"tarn:water", text(scene.optics.name, "; a ", triple(scene.optics.absorption_per_m),
                            " /m; b_b ", triple(scene.optics.backscattering_per_m),
                            " /m at 620, 545, 450 nm; n ", scene.optics.index,
                            view.settings.spectral && !scene.optics.bands.empty()
                                ? text("; ", scene.optics.bands.size(), " bands")
                                : std::string("; three channels"))},
        {"tarn:waves", describe_waves(view.waves)},
        {"tarn:renderer", device},
        {"tarn:command", command}};
}

Picture develop(const PictureWords& words, const Image& picture, double exposure) {
    if (words.tone == "none") // values as they are, 1 = white
        return image::encode_linear(picture);
    return image::tone_map(picture, exposure);
}

void add_picture_options(CLI::App& c, PictureWords& w) {
    c.add_option("--exposure", w.exposure, "factor on radiance, or auto")->capture_default_str();
    c.add_option("--tone", w.tone, "tone curve of a .png; none: linear radiance, 1 = white")
        ->check(CLI::IsMember({"eye", "none"}))
        ->capture_default_str();
    c.add_flag("--caption", w.caption, "below a .png a bar with place, level, date and scale");
    c.add_flag("--labels", w.labels, "names of the layers' points beside them, in a .png");
    c.add_flag("--sidecar", w.sidecar,
               "beside the picture a .json that --settings makes it again from");
}

scene_files::OptionList given_options(const CLI::App& c) {
    // Where to write, and what is not about the picture, is another question.
    static const std::vector<std::string> others = {"output",  "settings",   "against",
                                                    "help",    "sidecar",    "explain",
                                                    "measure", "strip-rows", "error-map"};
    scene_files::OptionList out;
    for (const CLI::Option* option : c.get_options()) {
        if (option->count() == 0 || option->get_lnames().empty())
            continue;
        const std::string name = option->get_lnames().front();
        if (std::find(others.begin(), others.end(), name) != others.end())
            continue;
        std::string value;
        for (const std::string& one : option->results())
            value += (value.empty() ? "" : ",") + one;
        out.emplace_back(name, value);
    }
    return out;
}

std::string command_of(const std::string& command, const std::string& scene,
                       const scene_files::OptionList& options) {
    std::string out = "tarn " + command + " " + shell_word(scene);
    for (const auto& [name, value] : options)
        out += " --" + name + (value == "true" ? "" : " " + shell_word(value));
    return out;
}

std::string camera_words(const scene::Camera& c) {
    return text("x=", c.position.x, ",y=", c.position.y, ",z=", c.position.z, ",dx=", c.forward.x,
                ",dy=", c.forward.y, ",dz=", c.forward.z, ",ux=", c.up.x, ",uy=", c.up.y,
                ",uz=", c.up.z, ",fov=", c.fov_deg);
}

scene_files::OptionList with_option(scene_files::OptionList options, const std::string& name,
                                    const std::string& value) {
    std::erase_if(options, [&](const auto& option) { return option.first == name; });
    options.emplace_back(name, value);
    return options;
}

std::string short_sum(const std::string& text) {
    Checksum sum;
    sum.add(text.data(), text.size());
    std::ostringstream out;
    out << TARN_VERSION << "-" << std::hex << sum.value();
    return out.str();
}

std::string files_mark(const scene_files::OptionList& options) {
    std::string out;
    for (const auto& [name, value] : options) {
        const bool layers = name == "layers" || name == "layers-3d";
        if (!layers && name != "water-table" && name != "wind-rose" && name != "environment" &&
            name != "track")
            continue;
        for (const std::filesystem::path path :
             layers ? split(value, ':') : std::vector<std::string>{value}) {
            std::error_code failed;
            const auto size = std::filesystem::file_size(path, failed);
            const auto time = std::filesystem::last_write_time(path, failed);
            out += text(" ", path.string(), " ", size, " ", time.time_since_epoch().count());
        }
    }
    return out;
}

std::string describe_time(const ViewWords& words, const scene::Scene& scene) {
    if (!words.environment.empty())
        return "light of " + std::filesystem::path(words.environment).filename().string();
    if (!words.sun.empty())
        return "sun at azimuth, elevation " + words.sun;
    if (!words.sun_direction.empty())
        return "sun towards " + words.sun_direction;
    const GeoPoint place = sun_place(words, scene);
    return (words.sun_place.empty() ? std::string() : "at " + words.sun_place + ", ") +
           geo::format_time(words.time.empty() ? geo::default_time(place)
                                               : geo::parse_time(words.time, place));
}

void check_outputs(const std::vector<std::string>& outputs) {
    for (const std::string& output : outputs) {
        const std::string extension = std::filesystem::path(output).extension().string();
        if (extension != ".png" && extension != ".exr")
            throw Error("-o '" + output + "': pictures are .png or .exr",
                        "choose one of these endings");
        const auto folder = std::filesystem::path(output).parent_path();
        if (!folder.empty() && !std::filesystem::is_directory(folder))
            throw Error(folder.string() + ": no such folder", "create it first");
    }
}

PictureFile::PictureFile(const std::string& output, const PictureWords& words,
                         const scene::Scene& scene, const scene::View& view, const Record& record,
                         const Image& overview)
    : output_(output), words_(words), scene_folder_(record.scene), options_(record.options),
      height_px_(view.settings.height_px) {
    if (record.exposure && words.tone != "none")
        options_ = with_option(options_, "exposure", text(*record.exposure));
    const std::string command = record.command.empty()
                                    ? command_of("render", record.scene, options_) + " -o " + output
                                    : record.command;
    metadata_ = describe(scene, view, record.device, command);
    metadata_.insert(record.more.begin(), record.more.end());
    const int width_px = view.settings.width_px;
    if (std::filesystem::path(output).extension() == ".exr") {
        file_.emplace(image::RowWriter::exr(output, width_px, height_px_, metadata_));
        return;
    }
    exposure_ = record.exposure.value_or(
        words.tone == "none" ? 1.0 : choose_exposure(words.exposure, overview, scene, view));
    if (words.labels)
        labels_ = scene::shown_labels(
            scene, view.camera, double(width_px) / height_px_, view.settings.drape_on,
            [&](double x, double y) { return distance_at(overview, x, y); });
    if (words.caption)
        caption_ = caption_bar(overview, scene, view, record.time);
    file_.emplace(
        image::RowWriter::png(output, width_px, height_px_ + caption_.height_px, 3, metadata_));
}

void PictureFile::add(const Image& rows) {
    if (std::filesystem::path(output_).extension() == ".exr") {
        file_->add(rows);
        return;
    }
    Picture out = develop(words_, rows, exposure_);
    const int size = std::max(11, height_px_ / 45);
    for (const scene::ShownLabel& label : labels_) {
        const int y = int(label.y * height_px_) - size / 3 - rows_;
        if (y > -2 * size && y < out.height_px + 2 * size)
            image::draw_text(out, int(label.x * out.width_px) + size / 2, y, size, label.text);
    }
    file_->add(out);
    rows_ += rows.height_px;
}

void PictureFile::finish() {
    if (caption_.height_px > 0)
        file_->add(caption_);
    file_->finish();
    if (words_.sidecar)
        write_beside(std::filesystem::path(output_).replace_extension(".json").string(),
                     scene_files::sidecar_json(std::filesystem::path(output_).filename().string(),
                                               scene_folder_, options_, metadata_));
}

int strip_rows(const PictureWords& words, const scene::RenderSettings& settings) {
    if (words.strip_rows % 8 != 0 || words.strip_rows < 0)
        throw Error(text("--strip-rows is ", words.strip_rows, ", must be a multiple of 8"));
    return words.strip_rows > 0 ? std::min(words.strip_rows, settings.height_px)
                                : scene::strip_rows(settings);
}

void write_picture(const std::string& output, const PictureWords& words, const Image& picture,
                   const scene::Scene& scene, const scene::View& view, const Record& record) {
    scene::View same = view;
    same.settings.width_px = picture.width_px;
    same.settings.height_px = picture.height_px;
    PictureFile file(output, words, scene, same, record, picture);
    file.add(picture);
    file.finish();
}

} // namespace tarn::app
