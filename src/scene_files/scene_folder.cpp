#include "scene_files/scene_folder.hpp"

#include "core/error.hpp"
#include "core/safety_radius.hpp"
#include "core/text.hpp"
#include "image/files.hpp"
#include "scene_files/scene_json.hpp"

#include <algorithm>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <stdio.h>
#include <sys/file.h>
#include <unistd.h>
#include <vector>

namespace tarn::scene_files {

namespace fs = std::filesystem;

namespace {

/// A regular file inside the folder; a link could lead anywhere.
fs::path member(const fs::path& folder, const std::string& name) {
    const fs::path path = folder / name;
    std::error_code failed;
    const auto status = fs::symlink_status(path, failed);
    if (status.type() == fs::file_type::symlink)
        throw Error(path.string() + ": is a link, which a scene folder may not hold",
                    "copy the file itself into the folder");
    if (status.type() != fs::file_type::regular)
        throw Error(path.string() + ": is missing", "import the scene again");
    return path;
}

bool is_scene(const fs::path& folder) {
    std::error_code failed;
    return fs::is_regular_file(folder / "scene.json", failed);
}

/// Why a folder may not be replaced by a new scene; empty if it may. Only what tarn itself wrote is
/// ever thrown away.
std::string reason_to_keep(const fs::path& target) {
    std::error_code failed;
    if (!fs::exists(fs::symlink_status(target, failed)))
        return {};
    if (fs::is_symlink(target, failed) || !fs::is_directory(target, failed))
        return "exists and is no folder";
    if (fs::is_empty(target, failed))
        return {};
    std::ifstream in(target / "scene.json", std::ios::binary);
    const std::string source{std::istreambuf_iterator<char>(in), {}};
    if (source.find("\"format\": \"tarn scene\"") == std::string::npos)
        return "exists and is not a scene folder";
    for (const auto& entry : fs::directory_iterator(target, failed)) {
        const std::string name = entry.path().filename().string();
        static const char* ours[] = {"scene.json", "ground.tif",        "water.tif",  "heights.tif",
                                     "ortho.tif",  "safety_ground.tif", "preview.png"};
        if (std::find(std::begin(ours), std::end(ours), name) == std::end(ours))
            return "holds '" + name + "', which is not tarn's";
    }
    return {};
}

/// A running import holds a lock on its folder; the system drops it however the process ends.
int lock(const fs::path& folder) {
    const int handle = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (handle >= 0 && ::flock(handle, LOCK_EX | LOCK_NB) != 0) {
        ::close(handle);
        return -1;
    }
    return handle;
}

/// Removes what crashed imports of this name left behind.
void sweep(const fs::path& parent, const std::string& prefix) {
    std::error_code failed;
    std::vector<fs::path> remains;
    for (const auto& entry : fs::directory_iterator(parent, failed))
        if (entry.path().filename().string().starts_with(prefix))
            remains.push_back(entry.path());
    for (const fs::path& folder : remains)
        if (const int handle = lock(folder); handle >= 0) {
            fs::remove_all(folder, failed);
            ::close(handle);
        }
}

} // namespace

scene::Scene load(const fs::path& folder) {
    std::error_code failed;
    if (!fs::is_directory(folder, failed))
        throw Error(folder.string() + ": no such scene folder", "make one with tarn import");
    if (!is_scene(folder))
        throw Error(folder.string() + ": holds no scene.json",
                    "name a folder that tarn import made");
    std::ifstream in(member(folder, "scene.json"), std::ios::binary);
    if (!in)
        throw Error((folder / "scene.json").string() + ": cannot be read", "check its permissions");
    const std::string source{std::istreambuf_iterator<char>(in), {}};
    FileNames files;
    try {
        scene::Scene scene = from_json(source, files);
        const auto fill = [&](Heightfield& field, const std::string& name) {
            const GridSize expected = field.codes.size;
            Grid<std::uint16_t> codes = image::read_codes(member(folder, name));
            if (!(codes.size == expected))
                throw Error(text(name, " is ", codes.size.cols, " x ", codes.size.rows,
                                 ", scene.json says ", expected.cols, " x ", expected.rows),
                            "import the scene again");
            field.codes = std::move(codes);
        };
        fill(scene.ground, files.ground);
        fill(scene.water, files.water);
        if (scene.ortho) {
            Picture picture = image::read_rgba(member(folder, files.ortho));
            if (picture.width_px != scene.ortho->picture.width_px ||
                picture.height_px != scene.ortho->picture.height_px)
                throw Error(files.ortho + " has another size than scene.json says",
                            "import the scene again");
            scene.ortho->picture = std::move(picture);
        }
        scene.validate();
        return scene;
    } catch (Error& error) {
        error.during((folder / "scene.json").string());
        throw;
    }
}

Grid<float> load_heights(const fs::path& folder, const scene::Scene& scene) {
    std::ifstream in(member(folder, "scene.json"), std::ios::binary);
    const std::string source{std::istreambuf_iterator<char>(in), {}};
    FileNames files;
    from_json(source, files);
    Grid<float> heights = image::read_heights(member(folder, files.heights));
    if (!(heights.size == scene.ground.size()))
        throw Error(text((folder / files.heights).string(), ": is ", heights.size.cols, " x ",
                         heights.size.rows, ", scene.json says ", scene.ground.size().cols, " x ",
                         scene.ground.size().rows),
                    "import the scene again");
    return heights;
}

std::optional<Grid<std::uint8_t>> load_safety_radii(const fs::path& folder,
                                                    const scene::Scene& scene) {
    std::ifstream in(member(folder, "scene.json"), std::ios::binary);
    const std::string source{std::istreambuf_iterator<char>(in), {}};
    FileNames files;
    from_json(source, files);
    if (files.safety_ground.empty() || files.safety_sum != ground_sum(scene.ground))
        return {}; // of another ground: made anew by whoever needs them
    Grid<std::uint8_t> radii = image::read_bytes(member(folder, files.safety_ground));
    const GridSize cells{scene.ground.size().cols - 1, scene.ground.size().rows - 1};
    if (!(radii.size == cells))
        throw Error(text((folder / files.safety_ground).string(), ": is ", radii.size.cols, " x ",
                         radii.size.rows, ", the ground has ", cells.cols, " x ", cells.rows,
                         " cells"),
                    "import the scene again");
    return radii;
}

namespace {
std::string scene_text(const fs::path& folder) {
    std::ifstream in(folder / "scene.json", std::ios::binary);
    if (!in)
        throw Error((folder / "scene.json").string() + ": cannot be read",
                    "the scene folder may have been moved or deleted");
    return {std::istreambuf_iterator<char>(in), {}};
}
} // namespace

void replace_cameras(const fs::path& folder, const std::vector<scene::NamedCamera>& cameras) {
    const std::string text = with_cameras(scene_text(folder), cameras);
    const fs::path part = folder / "scene.json.part";
    {
        std::ofstream out(part, std::ios::binary);
        out << text;
        out.close();
        if (!out) {
            std::error_code ignored;
            fs::remove(part, ignored);
            throw Error(part.string() + ": cannot be written",
                        "check the folder's permissions and the free space");
        }
    }
    fs::rename(part, folder / "scene.json");
}

std::vector<scene::NamedCamera> load_cameras(const fs::path& folder) {
    FileNames files;
    return from_json(scene_text(folder), files).cameras;
}

std::string identity(const fs::path& folder) { return with_cameras(scene_text(folder), {}); }

StagedFolder::StagedFolder(const fs::path& target) : target_(target.lexically_normal()) {
    if (!target_.has_filename())
        target_ = target_.parent_path(); // "scene/" means "scene"
    if (target_.empty() || target_ == "." || target_ == ".." || target_ == "/")
        throw Error("the scene needs a folder name of its own", "give one with -o NAME");
    std::error_code failed;
    if (const std::string reason = reason_to_keep(target_); !reason.empty())
        throw Error(target_.string() + ": " + reason + "; it is left alone",
                    "choose another name with -o, or move it away");
    const fs::path parent = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
    fs::create_directories(parent, failed);
    const std::string prefix = "." + target_.filename().string() + ".partial-";
    sweep(parent, prefix);
    partial_ = parent / (prefix + std::to_string(::getpid()));
    if (!fs::create_directory(partial_, failed))
        throw Error(parent.string() + ": cannot be written (" + failed.message() + ")",
                    "check the folder and its permissions");
    lock_ = lock(partial_);
}

StagedFolder::~StagedFolder() {
    std::error_code ignored;
    if (!done_)
        fs::remove_all(partial_, ignored);
    if (lock_ >= 0)
        ::close(lock_);
}

void StagedFolder::write_text(const std::string& name, const std::string& content) const {
    std::ofstream out(partial_ / name, std::ios::binary);
    out << content;
    out.close();
    if (!out)
        throw Error((partial_ / name).string() + ": cannot be written",
                    "check the free space and permissions");
}

void StagedFolder::commit() {
    for (const auto& entry : fs::directory_iterator(partial_)) { // on disk before it gets its name
        const int file = ::open(entry.path().c_str(), O_RDONLY);
        if (file >= 0) {
            ::fsync(file);
            ::close(file);
        }
    }
    std::error_code failed;
    if (fs::exists(target_, failed)) {
        // Both names change places in one step; then the old scene goes.
        if (::renameat2(AT_FDCWD, partial_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) ==
            0) {
            done_ = true;
            fs::remove_all(partial_, failed);
            return;
        }
        // Some file systems cannot exchange: the old scene steps aside for a moment.
        const fs::path aside = target_.parent_path() / ("." + target_.filename().string() +
                                                        ".replaced-" + std::to_string(::getpid()));
        fs::rename(target_, aside, failed);
        if (!failed) {
            fs::rename(partial_, target_, failed);
            if (failed) {
                std::error_code ignored;
                fs::rename(aside, target_, ignored);
            } else {
                done_ = true;
                fs::remove_all(aside, failed);
                return;
            }
        }
    } else {
        fs::rename(partial_, target_, failed);
    }
    if (failed)
        throw Error(target_.string() + ": cannot be put in place (" + failed.message() + ")",
                    "check the folder and its permissions");
    done_ = true;
}

} // namespace tarn::scene_files
