#pragma once
/// @file samples.hpp  Lakes made of formulas: for tests with known answers and for benchmarks that
///                    must run where no file can be read.
#include "scene/scene.hpp"

namespace tarn::scene {

/// A paraboloid bowl z = 40 (r/R)^2 [m] of radius R = 500 m around scene (0, 0), level 10 m.
/// Exact: water radius 250 m, area pi 250^2, volume pi 250^2 * 10 / 2, depth 10 m in the middle.
Scene bowl(int side);

/// A mountain lake: fractal relief around a basin, island, side x side nodes over 16 km. The
/// shape does not depend on `side` but for its resolution.
Scene mountain_lake(int side);

/// A flat tank: bed at -8 m, water at 0, walls 1 m high on the rim of a 200 m square. For the
/// closed forms of flat water.
Scene tank();

} // namespace tarn::scene
