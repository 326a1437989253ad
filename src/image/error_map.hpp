#pragma once
/// @file error_map.hpp  Where two pictures are how far apart, in colours with a legend below.
#include "core/image.hpp"

namespace tarn::image {

/// Relative error of each pixel (core/image.hpp) on a logarithmic scale: black up to .01 %, then
/// blue, green at 1 %, yellow at 10 %, white from 100 % on; a bar below says so.
/// @throws tarn::Error  if the sizes differ
Picture error_map(const Image& got, const Image& expected);

} // namespace tarn::image
