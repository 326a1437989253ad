#pragma once
/// @file exposure.hpp  How bright a picture may be made: in keeping with the light that falls.
#include "scene/settings.hpp"

namespace tarn::scene {

/// What image::auto_exposure() is given.
struct ExposureRange {
    double key = 0.25; ///< share of white that the middle of the brightness becomes
    double least = 1.0, greatest = 1.0; ///< factors on radiance
    double dark_share = 0.0; ///< what is darker than this share of the bright does not count
};

/// Bright enough for land in the given light; under water the picture itself decides, up to four
/// hundred times what land takes. By a diver's lamp what it lights decides: the night beside it
/// does not count.
ExposureRange exposure_range(const Scene& scene, const View& view);

} // namespace tarn::scene
