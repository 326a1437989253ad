// shared/sunlight_block.h — what the passes are told about the light that waves focus; compiled by C++ AND by GLSL.
// Rules as in view_block.h.
#ifdef __cplusplus
#pragma once
#include <cstddef>
#include <glm/vec4.hpp>
namespace tarn::shared {
using vec4 = glm::vec4;
#endif

#define TARN_BLOCK_SUNLIGHT 2        // uniform block SunlightBlock
#define TARN_BUFFER_SUNLIGHT 3       // uint: flux of each texel, [cascade][slice][row][column]
#define TARN_TEXTURE_SUNLIGHT 13     // RG16F array: sunlight at a slice and at the next deeper one
#define TARN_IMAGE_SUNLIGHT 0        // 0-3: rg16f arrays, levels being written

#define TARN_SUNLIGHT_UNIT 262144.0  // flux of a texel below flat water; 16384 times that fit

struct SunlightBlock {
    vec4 beam;        // xy: metres east and north that flat water's beam comes to a metre deeper, z: slices of a
                      // cascade, w: variance of that lean that comes from the sun's own disc, on one axis
    vec4 rough;       // x: variance of the lean by waves that are not drawn, yzw: -
    vec4 last;        // last slice of each cascade that is made
    vec4 cascades[4]; // x: depth of the first slice [m], y: slices a doubling of depth, z: variance of the lean by
                      // this cascade's waves, on one axis, w: side of a texel [m]
};

#ifdef __cplusplus
static_assert(sizeof(SunlightBlock) == 112, "std140 layout");
} // namespace tarn::shared
#endif
