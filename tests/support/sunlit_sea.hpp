#pragma once
/// @file sunlit_sea.hpp  A sun and a surface for tests and studies of caustics.
#include "reference/caustics.hpp"

#include <cmath>
#include <memory>

namespace tarn::test_support {

/// Unit, towards a sun in the south-southwest.
inline glm::dvec3 sun_at(double elevation_deg, double azimuth_deg = 200.0) {
    const double e = elevation_deg * M_PI / 180.0, a = azimuth_deg * M_PI / 180.0;
    return {std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e)};
}

/// A sea at time 0 in deep water, far from any shore. The sea must outlive it.
inline reference::SurfaceFunction surface_of(const waves::Sea& sea) {
    const auto fields = std::make_shared<reference::WaveSurface>(sea, 0.0);
    return [fields](glm::dvec2 p) {
        return reference::SurfacePoint{fields->height_m(p, 1e3), fields->slope(p, 1e3)};
    };
}

} // namespace tarn::test_support
