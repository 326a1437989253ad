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

fs::path partial_name(const fs::path& path) {
    static std::atomic<int> counter{0};
    fs::path partial = path;
    partial.replace_filename("." + path.stem().string() + ".partial-" + std::to_string(::getpid()) +
                             "-" + std::to_string(counter++) + path.extension().string());
    return partial;
}

/// Where encoders write to. They do not notice a full disk; this does.
class WatchedFile : public OIIO::Filesystem::IOProxy {
public:
    explicit WatchedFile(const fs::path& path)
        : IOProxy(path.string(), Write), file_(path, std::ios::binary | std::ios::trunc) {}
    const char* proxytype() const override { return "watched file"; }
    std::size_t write(const void* data, std::size_t bytes) override {
        file_.write(static_cast<const char*>(data), std::streamsize(bytes));
        m_pos += std::int64_t(bytes);
        return file_ ? bytes : 0;
    }
    std::size_t pwrite(const void* data, std::size_t bytes, std::int64_t at) override {
        file_.seekp(at);
        file_.write(static_cast<const char*>(data), std::streamsize(bytes));
        file_.seekp(m_pos);
        return file_ ? bytes : 0;
    }
    bool seek(std::int64_t at) override {
        m_pos = at;
        file_.seekp(at);
        return bool(file_);
    }
    void flush() const override {}
    /// @return whether all of it is on the disk
    bool close_file() {
        file_.close();
        return bool(file_);
    }
    bool good() const { return bool(file_); }

private:
    std::ofstream file_;
};

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

struct RowWriter::File {
    fs::path path, partial;
    OIIO::ImageSpec spec;
    WatchedFile disk;
    std::unique_ptr<OIIO::ImageOutput> out;
    int rows = 0; ///< written
    bool finished = false;

    File(const fs::path& p, const OIIO::ImageSpec& s, const Metadata& metadata)
        : path(p), partial(partial_name(p)), spec(s), disk(partial) {
        for (const auto& [key, value] : metadata)
            spec.attribute(key, value);
        try {
            out = OIIO::ImageOutput::create(partial.string());
            if (!disk.good() || !out || !out->set_ioproxy(&disk) ||
                !out->open(partial.string(), spec))
                fail();
        } catch (...) {
            remove_partial();
            throw;
        }
    }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    ~File() {
        if (!finished)
            remove_partial();
    }

    void remove_partial() {
        out.reset(); // it may still write
        std::error_code ignored;
        fs::remove(partial, ignored);
    }

    [[noreturn]] void fail() {
        if (!disk.good()) {
            const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
            throw Error("cannot write into " + folder.string(),
                        "check the folder, its permissions and the free space");
        }
        throw Error("the picture cannot be encoded (" + (out ? out->geterror() : OIIO::geterror()) +
                        ")",
                    "choose a smaller picture");
    }

    void add(int count, OIIO::TypeDesc type, const void* data) {
        if (!out->write_scanlines(rows, rows + count, 0, type, data) || !disk.good())
            fail();
        rows += count;
    }
};

RowWriter::RowWriter(std::unique_ptr<File> file) : file_(std::move(file)) {}
RowWriter::RowWriter(RowWriter&&) noexcept = default;
RowWriter::~RowWriter() = default;

RowWriter RowWriter::png(const fs::path& path, int width_px, int height_px, int channels,
                         const Metadata& metadata) {
    OIIO::ImageSpec spec(width_px, height_px, channels, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("png:compressionLevel", 6);
    return RowWriter(std::make_unique<File>(path, spec, metadata));
}

RowWriter RowWriter::exr(const fs::path& path, int width_px, int height_px,
                         const Metadata& metadata) {
    OIIO::ImageSpec spec(width_px, height_px, 4, OIIO::TypeDesc::FLOAT);
    spec.channelnames = {"R", "G", "B", "Z"};
    spec.z_channel = 3;
    spec.attribute("compression", "zip");
    spec.attribute("oiio:ColorSpace", "Linear");
    return RowWriter(std::make_unique<File>(path, spec, metadata));
}

void RowWriter::add(const Picture& rows) {
    file_->add(rows.height_px, OIIO::TypeDesc::UINT8, rows.bytes.data());
}

void RowWriter::add(const Image& rows) {
    std::vector<float> values(4 * rows.radiance.size());
    for (std::size_t i = 0; i < rows.radiance.size(); ++i) {
        for (int k = 0; k < 3; ++k)
            values[4 * i + std::size_t(k)] = rows.radiance[i][k];
        values[4 * i + 3] = rows.distance_m[i];
    }
    file_->add(rows.height_px, OIIO::TypeDesc::FLOAT, values.data());
}

void RowWriter::finish() {
    File& f = *file_;
    if (f.rows != f.spec.height)
        throw Error(text(f.path.string(), ": ", f.rows, " of ", f.spec.height, " rows were drawn"));
    if (!f.out->close() || !f.disk.close_file())
        f.fail();
    std::error_code failed;
    fs::rename(f.partial, f.path, failed);
    if (failed)
        throw Error(f.path.string() + ": cannot be written (" + failed.message() + ")",
                    "check the folder and its permissions");
    f.finished = true;
}

void write_png(const fs::path& path, const Picture& picture, const Metadata& metadata) {
    RowWriter file =
        RowWriter::png(path, picture.width_px, picture.height_px, picture.channels, metadata);
    file.add(picture);
    file.finish();
}

void write_exr(const fs::path& path, const Image& image, const Metadata& metadata) {
    RowWriter file = RowWriter::exr(path, image.width_px, image.height_px, metadata);
    file.add(image);
    file.finish();
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
