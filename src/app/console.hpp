#pragma once
/// @file console.hpp  The terminal: progress bar, Ctrl-C, and words that people type.
#include "core/geo.hpp"
#include "core/progress.hpp"

#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace tarn::app {

/// From here on Ctrl-C and SIGTERM ask running work to stop; again two seconds later, they end the
/// program.
void catch_interrupts();

/// Has Ctrl-C or SIGTERM come?
bool interrupted();

/// A bar on stderr if that is a terminal, silence in a pipe; stops work after Ctrl-C.
Progress console_progress();

/// Clears the bar, so that a message starts on a line of its own.
void end_progress();

/// "1,2.5,-3" as numbers.
/// @throws tarn::Error  naming `option`, unless there are exactly `count`
std::vector<double> parse_numbers(const std::string& option, const std::string& words,
                                  std::size_t count);

/// One number for all three, or three.
glm::dvec3 parse_triple(const std::string& option, const std::string& words);

GeoPoint parse_place(const std::string& option, const std::string& words);

/// 11140092.1 -> "11.140 km2"; 552830.5 -> "552 830 m2".
std::string format_area(double m2);
std::string format_volume(double m3);

/// As a shell takes it, quoted if need be.
std::string shell_word(const std::string& word);

/// Writes a text file beside its name and renames it, so that no half file is left.
/// @throws tarn::Error  if it cannot be written
void write_beside(const std::string& path, const std::string& content);

} // namespace tarn::app
