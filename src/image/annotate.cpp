#include "image/annotate.hpp"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <algorithm>

namespace tarn::image {

bool draw_text(Picture& picture, int x_px, int y_px, int height_px, const std::string& text) {
    OIIO::ImageSpec spec(picture.width_px, picture.height_px, picture.channels,
                         OIIO::TypeDesc::UINT8);
    OIIO::ImageBuf buffer(spec, picture.bytes.data());
    const float white[4] = {1, 1, 1, 1};
    const bool done = OIIO::ImageBufAlgo::render_text(
        buffer, x_px, y_px, text, height_px, "DejaVuSans",
        OIIO::cspan<float>(white, std::size_t(picture.channels)),
        OIIO::ImageBufAlgo::TextAlignX::Left, OIIO::ImageBufAlgo::TextAlignY::Baseline, 2, {}, 1);
    if (!done)
        (void)buffer.geterror(); // a picture without its caption is still a picture
    return done;
}

void fill_box(Picture& p, int x0, int y0, int x1, int y1, std::uint8_t grey) {
    for (int y = std::max(0, y0); y < std::min(p.height_px, y1); ++y)
        for (int x = std::max(0, x0); x < std::min(p.width_px, x1); ++x)
            for (int k = 0; k < std::min(3, p.channels); ++k)
                p.bytes[(std::size_t(y) * std::size_t(p.width_px) + std::size_t(x)) *
                            std::size_t(p.channels) +
                        std::size_t(k)] = grey;
}

} // namespace tarn::image
