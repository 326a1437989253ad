#pragma once
/// @file annotate.hpp  Words and bars on pictures.
#include "core/image.hpp"

#include <array>
#include <string>

namespace tarn::image {

/// Writes one line of text (UTF-8), white with a dark rim; (x, y) is the left end of its base line.
/// Latin letters lose their marks, others become question marks: OpenImageIO 2.4 knows only ASCII.
/// @return false if OpenImageIO has no font to write with; the picture is then unchanged
bool draw_text(Picture& picture, int x_px, int y_px, int height_px, const std::string& text);

/// Fills a rectangle, clipped to the picture.
void fill_box(Picture& picture, int x0_px, int y0_px, int x1_px, int y1_px, std::uint8_t grey);
void fill_box(Picture& picture, int x0_px, int y0_px, int x1_px, int y1_px,
              const std::array<std::uint8_t, 3>& colour);

/// @throws tarn::Error  if OpenImageIO cannot
Picture resized(const Picture& picture, int width_px, int height_px);

/// Lays one picture onto another, clipped to it; one channel counts as grey.
void paste(Picture& onto, const Picture& picture, int x_px, int y_px);

} // namespace tarn::image
