#pragma once
/// @file annotate.hpp  Words and bars on pictures.
#include "core/image.hpp"

#include <string>

namespace tarn::image {

/// Writes one line of text, white with a dark rim; (x, y) is the left end of its base line.
/// @return false if OpenImageIO has no font to write with; the picture is then unchanged
bool draw_text(Picture& picture, int x_px, int y_px, int height_px, const std::string& text);

/// Fills a rectangle, clipped to the picture.
void fill_box(Picture& picture, int x0_px, int y0_px, int x1_px, int y1_px, std::uint8_t grey);

} // namespace tarn::image
