#pragma once
/// @file tone.hpp  Linear radiance -> a picture for the eye: exposure, tone curve, sRGB.
#include "core/image.hpp"

namespace tarn::image {

/// Exposure that suits a picture: the middle of its brightness (the logarithmic mean of luminances
/// between the 2nd and the 98th percentile) becomes `key` of white, within [least, greatest].
/// @param dark_share  what is darker than this share of the 98th percentile does not count
double auto_exposure(const Image& image, double key, double least, double greatest,
                     double dark_share = 0.0);

/// A colour outside sRGB, as deep water may have, moved towards the grey of its luminance until no
/// channel is negative; others are left as they are.
glm::vec3 into_gamut(glm::vec3 colour);

/// The eye's own response curve x^n / (x^n + s^n) (Naka & Rushton 1966) with n = 1.3, per channel,
/// leaving mid grey where it is; then the sRGB transfer function (IEC 61966-2-1) and 8 bits with a
/// half-step ordered dither against banding.
/// @param exposure  factor on radiance, > 0
Picture tone_map(const Image& image, double exposure);

/// No curve, colours brought into gamut: radiance 1 is white, more is clipped; sRGB encoded.
Picture encode_linear(const Image& image);

/// sRGB transfer function of a linear value in [0, 1].
double srgb_encode(double linear);

} // namespace tarn::image
