#pragma once
/// @file files.hpp  Pictures on disk, by OpenImageIO. Everything is written beside its name and
/// then
///                  renamed, so that no half picture is ever left.
#include "core/grid.hpp"
#include "core/image.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <string>

namespace tarn::image {

/// Text entries of a file: PNG tEXt chunks, EXR attributes.
using Metadata = std::map<std::string, std::string>;

/// A picture that is written from its first row down, for those too large to be held whole. Without
/// finish() nothing is left of it.
class RowWriter {
public:
    /// @throws tarn::Error  naming the file, if it cannot be begun; so do the others
    static RowWriter png(const std::filesystem::path& path, int width_px, int height_px,
                         int channels, const Metadata& metadata);
    /// As write_exr() writes it.
    static RowWriter exr(const std::filesystem::path& path, int width_px, int height_px,
                         const Metadata& metadata);
    RowWriter(RowWriter&&) noexcept;
    ~RowWriter();

    /// The next rows of a .png.
    void add(const Picture& rows);
    /// The next rows of an .exr.
    void add(const Image& rows);
    /// @throws tarn::Error  if the disk is full, say
    void finish();

private:
    struct File;
    explicit RowWriter(std::unique_ptr<File> file);
    std::unique_ptr<File> file_;
};

/// @throws tarn::Error  naming the file, if it cannot be written
void write_png(const std::filesystem::path& path, const Picture& picture, const Metadata& metadata);

/// Linear float EXR with channels R, G, B and Z; Z is the distance along the ray in metres,
/// infinite where only sky is seen.
void write_exr(const std::filesystem::path& path, const Image& image, const Metadata& metadata);

/// Reads an EXR that write_exr() wrote, or any with R, G and B; without Z distances are infinite.
Image read_exr(const std::filesystem::path& path);

/// Reads the first three channels of a picture of light, EXR, HDR or any other, as linear floats;
/// one channel counts as grey.
Image read_light(const std::filesystem::path& path);

/// Reads 16-bit codes of a one-channel TIFF. Georeference and scale are GDAL's business.
/// @throws tarn::Error  if the file is missing, damaged, not 16-bit, or larger than 65536 a side
Grid<std::uint16_t> read_codes(const std::filesystem::path& path);

/// Reads bytes of a one-channel 8-bit TIFF.
/// @throws as read_codes()
Grid<std::uint8_t> read_bytes(const std::filesystem::path& path);

/// Reads heights of a one-channel float TIFF; NaN where there are none.
/// @throws as read_codes()
Grid<float> read_heights(const std::filesystem::path& path);

/// Reads an 8-bit picture, expanded to four channels.
Picture read_rgba(const std::filesystem::path& path);

Metadata read_metadata(const std::filesystem::path& path);

/// Keeps OpenImageIO from starting threads: before anything is read in a process that will fork.
void read_without_threads();

/// OpenImageIO's release, for `tarn doctor`.
std::string library_version();

} // namespace tarn::image
