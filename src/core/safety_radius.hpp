#pragma once
/// @file safety_radius.hpp
/// How far a ray may step over a height field at once and still meet it at most once on the way.
///
/// Meaning  safety(C) = n > 0: a straight ray that starts anywhere above cell C, no lower than C's
///          highest node, meets the bilinear surface at most once before it leaves the square of
///          (2n - 1) x (2n - 1) cells around C. So if it is below the surface where it leaves the
///          square, there is exactly one hit on the way and bisection finds it; if it is above,
///          there is none. 0: not even within C itself. 255 is the greatest value.
/// Why      A ray is met at most once if the slope at which the surface is seen from its start,
///          (f(q) - z) / distance, never falls on the way, that is if every tangent of the surface,
///          followed back to the start, arrives no higher than the start. In a bilinear cell
///          D the tangent plane at (u, v) comes to F(p) - k (x - u)(y - v) over p = (x, y), where F
///          is D's own formula and k its twist: linear in u and in v, so the worst tangent plane is
///          that of one of D's corners; and the worst p of C is one of C's corners. Four planes and
///          four corners decide about a pair of cells, in whole numbers.
/// Source   Baboud & Decoret 2006 (Rendering Geometry with Relief Textures; Realistic Water
/// Volumes,
///          sec. 3.2), who define it for texels; the condition for the bilinear surface is our own.
#include "core/heightfield.hpp"

#include <cstdint>
#include <string>

namespace tarn {

/// One value for each cell, (cols - 1) x (rows - 1) of them. Exact up to 4; beyond, the greatest
/// power of two, or less, that can be certified by bounds over blocks: never too much.
/// @param heights  at least 2 x 2 nodes; only its codes count
/// @param threads  0: all cores
Grid<std::uint8_t> safety_radii(const Heightfield& heights, int threads = 0);

/// Tells one ground from another, sixteen hexadecimal digits: stored radii are used for the ground
/// they were made for only. (FNV-1a over size and codes; no defence against intent.)
std::string ground_sum(const Heightfield& heights);

/// For water that moves: the value that holds for every cell whatever the waves' phase.
///
/// Calm water is a plane: 255. Any wave has a crest that a flat enough ray cuts off however
/// close it starts, so no larger constant than 1 is safe - and that only together with a look at
/// the cell itself - unless the waves are too small for the height's quantum to show them.
/// @param amplitude_m       of the whole surface above and below its mean, >= 0
/// @param shortest_wave_m   > 0
/// @param spacing_m         of the grid, > 0
/// @param quantum_m         of heights, > 0: cuts less deep than this do not count
int water_safety_radius(double amplitude_m, double shortest_wave_m, double spacing_m,
                        double quantum_m);

} // namespace tarn
