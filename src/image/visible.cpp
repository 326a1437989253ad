// What a person sees, by OpenImageIO's measure.
#include "core/error.hpp"
#include "image/compare.hpp"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <algorithm>
#include <vector>

namespace tarn::image {

double visible_share(const Image& got, const Image& expected) {
    if (got.width_px != expected.width_px || got.height_px != expected.height_px)
        throw Error("pictures of different sizes cannot be compared");
    if (got.radiance.empty())
        return 0.0;
    std::vector<float> bright;
    for (const glm::vec3& c : expected.radiance)
        bright.push_back((c.r + c.g + c.b) / 3.0f);
    const auto at = bright.begin() + std::ptrdiff_t(bright.size() * 99 / 100);
    std::nth_element(bright.begin(), at, bright.end());
    const float white = std::max(*at, 1e-6f);
    const auto shown = [&](const Image& image) {
        OIIO::ImageBuf out(OIIO::ImageSpec(image.width_px, image.height_px, 3, OIIO::TypeFloat));
        for (int y = 0; y < image.height_px; ++y)
            for (int x = 0; x < image.width_px; ++x) {
                const glm::vec3 c =
                    image.radiance[std::size_t(y) * std::size_t(image.width_px) + std::size_t(x)];
                float pixel[3];
                for (int k = 0; k < 3; ++k)
                    pixel[k] = std::clamp(c[k] / white, 0.0f, 1.0f);
                out.setpixel(x, y, pixel);
            }
        return out;
    };
    OIIO::ImageBufAlgo::CompareResults seen;
    const int failing = OIIO::ImageBufAlgo::compare_Yee(shown(got), shown(expected), seen);
    return double(failing) / double(got.radiance.size());
}

} // namespace tarn::image
