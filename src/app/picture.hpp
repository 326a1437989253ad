#pragma once
/// @file picture.hpp  From radiance to the file that people keep: exposure, caption, what is
///                    written beside it.
#include "app/view_options.hpp"
#include "image/files.hpp"
#include "scene/labels.hpp"
#include "scene/strips.hpp"
#include "scene_files/sidecar.hpp"

#include <CLI/App.hpp>
#include <string>

namespace tarn::app {

struct PictureWords {
    std::string exposure = "auto", tone = "eye";
    bool caption = false, labels = false, sidecar = false;
    int strip_rows = 0; ///< 0: chosen
};

/// Adds the options of PictureWords to a command.
void add_picture_options(CLI::App& command, PictureWords& words);

/// What was given on the command line or in a settings file, of the options that make the picture:
/// enough to make it again.
scene_files::OptionList given_options(const CLI::App& command);

/// As a shell takes it.
std::string command_of(const std::string& command, const std::string& scene,
                       const scene_files::OptionList& options);

/// @throws tarn::Error  unless `words` is "auto" or a positive number
double choose_exposure(const std::string& words, const Image& picture, const scene::Scene& scene,
                       const scene::View& view);

/// What a picture's file says about it.
/// @param command  that made it
image::Metadata describe(const scene::Scene& scene, const scene::View& view,
                         const std::string& device, const std::string& command);

/// When the sun stands as the words say: "2026-06-21T15:00:00Z", or its place.
std::string describe_time(const ViewWords& words, const scene::Scene& scene);

/// Picture for the eye.
/// @param exposure  factor on radiance
Picture develop(const PictureWords& words, const Image& picture, double exposure);

/// Are these names of pictures that can be written? For asking before long work.
/// @throws tarn::Error
void check_outputs(const std::vector<std::string>& outputs);

struct Record {
    std::string scene;               ///< folder, as typed
    scene_files::OptionList options; ///< that make the picture
    std::string
        command; ///< the same in one line; empty: made of the options and what is chosen here
    std::string device;             ///< what drew it
    std::string time;               ///< describe_time()
    std::optional<double> exposure; ///< instead of what the words say; goes into the options
    image::Metadata more;           ///< to be said besides
};

/// As --camera takes it, to the last digit that matters.
std::string camera_words(const scene::Camera& camera);

/// With another value for one name.
scene_files::OptionList with_option(scene_files::OptionList options, const std::string& name,
                                    const std::string& value);

/// A word that changes with every letter of the text, and with the release.
std::string short_sum(const std::string& text);

/// Changes when a file that an option names changes: sizes and times of them.
std::string files_mark(const scene_files::OptionList& options);

/// A picture, .png or .exr, that is written from its first row down, with what the words ask for
/// beside it. Without finish() nothing is left of it.
class PictureFile {
public:
    /// @param view      of the whole picture
    /// @param overview  the picture itself, or a smaller one of the same view: what exposure, scale
    ///                  and labels go by
    /// @throws tarn::Error  if the file cannot be begun
    PictureFile(const std::string& output, const PictureWords& words, const scene::Scene& scene,
                const scene::View& view, const Record& record, const Image& overview);

    /// The next rows. @throws tarn::Error
    void add(const Image& rows);
    /// @throws tarn::Error
    void finish();

private:
    std::string output_;
    PictureWords words_;
    std::string scene_folder_;
    scene_files::OptionList options_;
    image::Metadata metadata_;
    std::optional<image::RowWriter> file_;
    double exposure_ = 1.0;
    int height_px_ = 0, rows_ = 0; ///< of the picture, and those that are there
    std::vector<scene::ShownLabel> labels_;
    Picture caption_; ///< the bar below the picture; may be empty
};

/// Rows of the strips that a picture is drawn in: all of them, where it is held whole.
/// @throws tarn::Error  if the words ask for what is no multiple of 8
int strip_rows(const PictureWords& words, const scene::RenderSettings& settings);

/// Writes a whole picture. @throws tarn::Error  if a file cannot be written
void write_picture(const std::string& output, const PictureWords& words, const Image& picture,
                   const scene::Scene& scene, const scene::View& view, const Record& record);

} // namespace tarn::app
