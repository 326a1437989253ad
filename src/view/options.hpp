#pragma once
/// @file options.hpp  What a picture is made with, in the words of the command line: panels change
/// these and nothing else, so that whatever they do can be typed.
#include <map>
#include <string>

namespace tarn::view {

/// Option names without dashes ("wind", "secchi", "time", "no-shadows") and their values; flags
/// have "true". What is not in it is as the scene says, or the default.
using Options = std::map<std::string, std::string>;

} // namespace tarn::view
