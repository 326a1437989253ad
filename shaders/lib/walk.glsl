// lib/walk.glsl — the place of the method by which rays meet the field: the program puts one of
// lib/walks/ here when it builds a pass (src/render/walks.hpp). Without that, the default one.
// C++ twin: src/reference/walk.hpp
#include "lib/walks/cone_map.glsl"
