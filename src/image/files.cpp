#include "image/files.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <atomic>
#include <fstream>
#include <limits>
#include <unistd.h>

namespace tarn::image {

namespace fs = std::filesystem;

namespace {

/// Writes through a temporary name in the same folder; the last step is one rename.
template <class Write>
void write_beside(const fs::path& path, Write write) {
    static std::atomic<int> counter{0};
    fs::path partial = path;
    partial.replace_filename("." + path.stem().string() + ".partial-" + std::to_string(::getpid()) +
                             "-" + std::to_string(counter++) + path.extension().string());
    try {
        write(partial);
        std::error_code failed;
        fs::rename(partial, path, failed);
        if (failed)
            throw Error(path.string() + ": cannot be written (" + failed.message() + ")",
                        "check the folder and its permissions");
    } catch (...) {
        std::error_code ignored;
        fs::remove(partial, ignored);
        throw;
    }
}

/// Encodes in memory and writes the bytes itself: the PNG writer does not notice a full disk.
void write_image(const fs::path& path, OIIO::ImageSpec spec, OIIO::TypeDesc type, const void* data,
                 const Metadata& metadata) {
    for (const auto& [key, value] : metadata)
        spec.attribute(key, value);
    auto out = OIIO::ImageOutput::create(path.string());
    OIIO::Filesystem::IOVecOutput encoded;
    if (!out || !out->set_ioproxy(&encoded) || !out->open(path.string(), spec) ||
        !out->write_image(type, data) || !out->close())
        throw Error("the picture cannot be encoded (" + (out ? out->geterror() : OIIO::geterror()) +
                        ")",
                    "choose a smaller picture");
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(encoded.buffer().data()),
               static_cast<std::streamsize>(encoded.buffer().size()));
    file.close();
    if (!file) {
        const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
        throw Error("cannot write into " + folder.string(),
                    "check the folder, its permissions and the free space");
    }
}

std::unique_ptr<OIIO::ImageInput> open(const fs::path& path) {
    auto in = OIIO::ImageInput::open(path.string());
    if (!in) {
        const std::string why = OIIO::geterror();
        throw Error(path.string() + ": cannot be read (" + why + ")",
                    "check that it exists and is whole");
    }
    const OIIO::ImageSpec& spec = in->spec();
    if (spec.width < 1 || spec.height < 1 || spec.width > 65536 || spec.height > 65536 ||
        spec.depth > 1)
        throw Error(
            text(path.string(), ": is ", spec.width, " x ", spec.height, ", not a usable size"));
    // A header may lie. What deflate packs best shrinks to a thousandth; little files are let be.
    std::error_code failed;
    const double claimed = double(spec.image_bytes(true)),
                 held = double(fs::file_size(path, failed));
    if (!failed && claimed > 64e6 && claimed > 2000.0 * held)
        throw Error(text(path.string(), ": says that it is ", spec.width, " x ", spec.height,
                         " but has ", held, " bytes"),
                    "the file is damaged");
    return in;
}

} // namespace

void write_png(const fs::path& path, const Picture& picture, const Metadata& metadata) {
    OIIO::ImageSpec spec(picture.width_px, picture.height_px, picture.channels,
                         OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("png:compressionLevel", 6);
    write_beside(path, [&](const fs::path& partial) {
        write_image(partial, spec, OIIO::TypeDesc::UINT8, picture.bytes.data(), metadata);
    });
}

void write_exr(const fs::path& path, const Image& image, const Metadata& metadata) {
    OIIO::ImageSpec spec(image.width_px, image.height_px, 4, OIIO::TypeDesc::FLOAT);
    spec.channelnames = {"R", "G", "B", "Z"};
    spec.z_channel = 3;
    spec.attribute("compression", "zip");
    spec.attribute("oiio:ColorSpace", "Linear");
    std::vector<float> values(4 * image.radiance.size());
    for (std::size_t i = 0; i < image.radiance.size(); ++i) {
        for (int k = 0; k < 3; ++k)
            values[4 * i + std::size_t(k)] = image.radiance[i][k];
        values[4 * i + 3] = image.distance_m[i];
    }
    write_beside(path, [&](const fs::path& partial) {
        write_image(partial, spec, OIIO::TypeDesc::FLOAT, values.data(), metadata);
    });
}

Image read_exr(const fs::path& path) {
    auto in = open(path);
    const OIIO::ImageSpec spec = in->spec();
    int rgb[3] = {spec.channelindex("R"), spec.channelindex("G"), spec.channelindex("B")};
    const int z = spec.channelindex("Z");
    if (rgb[0] < 0 || rgb[1] < 0 || rgb[2] < 0)
        throw Error(path.string() + ": has no R, G and B channels");
    std::vector<float> values(std::size_t(spec.nchannels) * std::size_t(spec.image_pixels()));
    if (!in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()))
        throw Error(path.string() + ": cannot be read (" + in->geterror() + ")");
    Image image{.width_px = spec.width, .height_px = spec.height, .radiance = {}, .distance_m = {}};
    const auto pixels = std::size_t(spec.image_pixels()), channels = std::size_t(spec.nchannels);
    image.radiance.resize(pixels);
    image.distance_m.assign(pixels, std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < pixels; ++i) {
        for (int k = 0; k < 3; ++k)
            image.radiance[i][k] = values[i * channels + std::size_t(rgb[k])];
        if (z >= 0)
            image.distance_m[i] = values[i * channels + std::size_t(z)];
    }
    return image;
}

Grid<std::uint16_t> read_codes(const fs::path& path) {
    auto in = open(path);
    const OIIO::ImageSpec spec = in->spec();
    if (spec.nchannels != 1 || spec.format != OIIO::TypeDesc::UINT16)
        throw Error(path.string() + ": is not a 16-bit, one-channel TIFF",
                    "import the scene again");
    Grid<std::uint16_t> out(GridSize{spec.width, spec.height});
    if (!in->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT16, out.values.data()))
        throw Error(path.string() + ": is damaged (" + in->geterror() + ")",
                    "import the scene again");
    return out;
}

Grid<std::uint8_t> read_bytes(const fs::path& path) {
    auto in = open(path);
    const OIIO::ImageSpec spec = in->spec();
    if (spec.nchannels != 1 || spec.format != OIIO::TypeDesc::UINT8)
        throw Error(path.string() + ": is not an 8-bit, one-channel TIFF",
                    "import the scene again");
    Grid<std::uint8_t> out(GridSize{spec.width, spec.height});
    if (!in->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT8, out.values.data()))
        throw Error(path.string() + ": is damaged (" + in->geterror() + ")",
                    "import the scene again");
    return out;
}

Image read_light(const fs::path& path) {
    auto in = open(path);
    const OIIO::ImageSpec spec = in->spec();
    const int channels = spec.nchannels >= 3 ? 3 : 1;
    const auto pixels = std::size_t(spec.image_pixels());
    std::vector<float> values(pixels * std::size_t(channels));
    if (!in->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, values.data()))
        throw Error(path.string() + ": is damaged (" + in->geterror() + ")", "save it again");
    Image out{.width_px = spec.width, .height_px = spec.height, .radiance = {}, .distance_m = {}};
    out.radiance.reserve(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        const float* v = &values[i * std::size_t(channels)];
        out.radiance.emplace_back(v[0], v[channels == 3 ? 1 : 0], v[channels == 3 ? 2 : 0]);
    }
    return out;
}

Grid<float> read_heights(const fs::path& path) {
    auto in = open(path);
    const OIIO::ImageSpec spec = in->spec();
    if (spec.nchannels != 1 || spec.format != OIIO::TypeDesc::FLOAT)
        throw Error(path.string() + ": is not a float, one-channel TIFF", "import the scene again");
    Grid<float> out(GridSize{spec.width, spec.height});
    if (!in->read_image(0, 0, 0, 1, OIIO::TypeDesc::FLOAT, out.values.data()))
        throw Error(path.string() + ": is damaged (" + in->geterror() + ")",
                    "import the scene again");
    return out;
}

Picture read_rgba(const fs::path& path) {
    auto in = open(path);
    const OIIO::ImageSpec spec = in->spec();
    const int channels = std::min(spec.nchannels, 4);
    const auto pixels = std::size_t(spec.image_pixels());
    std::vector<std::uint8_t> values(std::size_t(channels) * pixels);
    if (!in->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, values.data()))
        throw Error(path.string() + ": is damaged (" + in->geterror() + ")",
                    "import the scene again");
    Picture out{.width_px = spec.width, .height_px = spec.height, .channels = 4, .bytes = {}};
    out.bytes.resize(4 * pixels);
    for (std::size_t i = 0; i < pixels; ++i)
        for (int k = 0; k < 4; ++k) {
            const int from = k == 3 ? (channels == 2 || channels == 4 ? channels - 1 : -1)
                                    : (channels >= 3 ? k : 0);
            out.bytes[4 * i + std::size_t(k)] =
                from < 0 ? 255 : values[std::size_t(channels) * i + std::size_t(from)];
        }
    return out;
}

Metadata read_metadata(const fs::path& path) {
    auto in = open(path);
    Metadata out;
    for (const auto& attribute : in->spec().extra_attribs)
        if (attribute.type() == OIIO::TypeString)
            out[attribute.name().string()] = attribute.get_string();
    return out;
}

void read_without_threads() {
    OIIO::attribute("exr_threads", -1);
    OIIO::attribute("threads", 1);
}

std::string library_version() { return std::string("OpenImageIO ") + OIIO_VERSION_STRING; }

} // namespace tarn::image
