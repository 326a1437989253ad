#pragma once
/// @file report.hpp  What is known of a scene, in words.
#include "scene/scene.hpp"

#include <string>

namespace tarn::app {

/// The lakes and what the import assumed; ends with a newline.
std::string summary(const scene::Scene& scene);

/// Everything `tarn info` shows.
std::string full_report(const scene::Scene& scene);

/// Now, UTC, "2026-06-21T15:00:00Z".
std::string utc_now();

} // namespace tarn::app
