#include "image/annotate.hpp"

#include "core/error.hpp"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <algorithm>

namespace tarn::image {

namespace {

/// Letters without their marks. OpenImageIO 2.4 loses all but the last byte of a UTF-8 sequence
/// (its utf8_to_unicode() starts every byte with an empty code point), so only ASCII comes out.
std::string plain_letters(const std::string& utf8) {
    static const std::string latin = // U+00C0 to U+017F
        "AAAAAAACEEEEIIIIDNOOOOOxOUUUUYTsaaaaaaaceeeeiiiidnooooo/ouuuuyty"
        "AaAaAaCcCcCcCcDdDdEeEeEeEeEeGgGgGgGgHhHhIiIiIiIiIiIiJjKkkLlLlLlL"
        "lLlNnNnNnnNnOoOoOoOoRrRrRrSsSsSsSsTtTtTtUuUuUuUuUuUuWwYyYZzZzZzs";
    std::string out;
    for (std::size_t i = 0; i < utf8.size();) {
        const auto first = static_cast<unsigned char>(utf8[i]);
        const std::size_t length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
        unsigned code = first < 0x80 ? first : first & (0xFFu >> (length + 1));
        for (std::size_t k = 1; k < length && i + k < utf8.size(); ++k)
            code = code << 6 | (static_cast<unsigned char>(utf8[i + k]) & 0x3Fu);
        if (code < 0x80)
            out += static_cast<char>(code);
        else if (code >= 0x300 && code < 0x370)
            ; // a mark by itself
        else
            out += code >= 0xC0 && code < 0x180 ? latin[code - 0xC0] : '?';
        i += length;
    }
    return out;
}

} // namespace

bool draw_text(Picture& picture, int x_px, int y_px, int height_px, const std::string& text) {
    OIIO::ImageSpec spec(picture.width_px, picture.height_px, picture.channels,
                         OIIO::TypeDesc::UINT8);
    OIIO::ImageBuf buffer(spec, picture.bytes.data());
    const float white[4] = {1, 1, 1, 1};
    const bool done = OIIO::ImageBufAlgo::render_text(
        buffer, x_px, y_px, plain_letters(text), height_px, "DejaVuSans",
        OIIO::cspan<float>(white, std::size_t(picture.channels)),
        OIIO::ImageBufAlgo::TextAlignX::Left, OIIO::ImageBufAlgo::TextAlignY::Baseline, 2, {}, 1);
    if (!done)
        (void)buffer.geterror(); // a picture without its caption is still a picture
    return done;
}

Picture resized(const Picture& picture, int width_px, int height_px) {
    Picture out{.width_px = width_px,
                .height_px = height_px,
                .channels = picture.channels,
                .bytes = std::vector<std::uint8_t>(std::size_t(width_px) * std::size_t(height_px) *
                                                   std::size_t(picture.channels))};
    const OIIO::ImageBuf from(OIIO::ImageSpec(picture.width_px, picture.height_px, picture.channels,
                                              OIIO::TypeDesc::UINT8),
                              const_cast<std::uint8_t*>(picture.bytes.data()));
    OIIO::ImageBuf to(OIIO::ImageSpec(width_px, height_px, picture.channels, OIIO::TypeDesc::UINT8),
                      out.bytes.data());
    if (!OIIO::ImageBufAlgo::resize(to, from))
        throw Error("a picture cannot be made " + std::to_string(width_px) + " x " +
                    std::to_string(height_px) + " (" + to.geterror() + ")");
    return out;
}

void paste(Picture& onto, const Picture& picture, int x_px, int y_px) {
    for (int y = std::max(0, -y_px); y < std::min(picture.height_px, onto.height_px - y_px); ++y)
        for (int x = std::max(0, -x_px); x < std::min(picture.width_px, onto.width_px - x_px); ++x)
            for (int k = 0; k < std::min(3, onto.channels); ++k)
                onto.bytes[(std::size_t(y + y_px) * std::size_t(onto.width_px) +
                            std::size_t(x + x_px)) *
                               std::size_t(onto.channels) +
                           std::size_t(k)] =
                    picture
                        .bytes[(std::size_t(y) * std::size_t(picture.width_px) + std::size_t(x)) *
                                   std::size_t(picture.channels) +
                               std::size_t(std::min(k, picture.channels - 1))];
}

void fill_box(Picture& p, int x0, int y0, int x1, int y1, std::uint8_t grey) {
    fill_box(p, x0, y0, x1, y1, std::array{grey, grey, grey});
}

void fill_box(Picture& p, int x0, int y0, int x1, int y1,
              const std::array<std::uint8_t, 3>& colour) {
    for (int y = std::max(0, y0); y < std::min(p.height_px, y1); ++y)
        for (int x = std::max(0, x0); x < std::min(p.width_px, x1); ++x)
            for (int k = 0; k < std::min(3, p.channels); ++k)
                p.bytes[(std::size_t(y) * std::size_t(p.width_px) + std::size_t(x)) *
                            std::size_t(p.channels) +
                        std::size_t(k)] = colour[std::size_t(k)];
}

} // namespace tarn::image
