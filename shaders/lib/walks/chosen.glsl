// lib/walks/chosen.glsl — the place of the method by which rays meet the field: when the program builds a
// pass it puts the one asked for here (src/render/renderer.cpp). Without that, the default one.
//
// Each file of this folder that names a source defines
//     bool trace_field(sampler2D heights, sampler2D bounds, Field field, Ray ray, float t_max,
//                      bool with_water, out Hit hit)
//   heights     RG16, ground and water codes; water code 0 = none
//   bounds      what the method skips by: see its file
//   t_max       [m]; the walk ends there without a hit: the value of a depth buffer, say
//   with_water  stop at the water's surface, too (only from above)
//   returns     true with `hit` filled in
// C++ twin of them all: src/reference/heightfield.hpp; tests: tests/gpu/walks_gpu_test.cpp.
#include "lib/walks/cone_map.glsl"
