#pragma once
/// @file scene_folder.hpp  Reading a scene folder, and replacing one as a whole or not at all.
#include "scene/scene.hpp"

#include <filesystem>

namespace tarn::scene_files {

/// @throws tarn::Error  naming the folder, file and field: missing, damaged, of another size than
///                      scene.json says, or leading outside the folder
scene::Scene load(const std::filesystem::path& folder);

/// The exact heights that the scene's statistics count; NaN outside the data. They are not needed
/// for drawing, so load() leaves them alone.
/// @throws as load()
Grid<float> load_heights(const std::filesystem::path& folder, const scene::Scene& scene);

/// The ground's safety radii, where the folder holds them for this very ground (scenes of older
/// imports do not; edited ones hold those of another). Only some methods of intersection need them,
/// so load() leaves them alone.
/// @throws as load()
std::optional<Grid<std::uint8_t>> load_safety_radii(const std::filesystem::path& folder,
                                                    const scene::Scene& scene);

/// Keeps other cameras in the folder; everything else in scene.json stays as it is.
/// @throws tarn::Error  if the folder is gone, or cannot be written
void replace_cameras(const std::filesystem::path& folder,
                     const std::vector<scene::NamedCamera>& cameras);

/// The cameras that the folder keeps now.
/// @throws as load()
std::vector<scene::NamedCamera> load_cameras(const std::filesystem::path& folder);

/// Text that differs between scenes, whatever cameras they keep.
/// @throws tarn::Error  if scene.json cannot be read
std::string identity(const std::filesystem::path& folder);

/// A folder being written beside its final name. commit() puts it in place in one step; without it
/// the destructor removes everything that was written, and an older scene of that name stays.
class StagedFolder {
public:
    /// @throws tarn::Error  if `target` exists and is neither a scene nor an empty folder, or its
    ///                      parent cannot be written
    explicit StagedFolder(const std::filesystem::path& target);
    ~StagedFolder();
    StagedFolder(const StagedFolder&) = delete;
    StagedFolder& operator=(const StagedFolder&) = delete;

    const std::filesystem::path& path() const { return partial_; }
    void write_text(const std::string& name, const std::string& content) const;
    void commit();

private:
    std::filesystem::path target_, partial_;
    bool done_ = false;
    int lock_ = -1; ///< tells other imports that this one is alive
};

} // namespace tarn::scene_files
