// shared/wave_block.h — what the passes are told about the waves; compiled by C++ AND by GLSL. Rules as in
// view_block.h. "Near" is the node `base` of the view block: positions count from it, so that a float holds
// them to a fraction of the distance.
#ifdef __cplusplus
#pragma once
#include <cstddef>
#include <glm/vec4.hpp>
namespace tarn::shared {
using vec4 = glm::vec4;
#endif

#define TARN_BLOCK_WAVES 1          // uniform block WaveBlock
#define TARN_BUFFER_WAVE_H0 3       // vec4: h0(k), conj(h0(-k))
#define TARN_BUFFER_WAVE_TURNS 4    // uint: omega in turns a loop
#define TARN_BUFFER_WAVE_FIELDS 5   // vec4: transforms, [cascade][field][row][column]
#define TARN_BUFFER_TWIDDLES 6      // vec2: exp(2 pi i n / N)
#define TARN_TEXTURE_WAVES 6        // R32F array: height [m]; a layer a cascade
#define TARN_TEXTURE_SLOPES 10      // RG16F array: rise per metre east and north
#define TARN_TEXTURE_AMPLITUDE 7    // RGBA8: share of each cascade's height at a place
#define TARN_TEXTURE_WAVE_TABLE 8   // RGBA32F: rows 0-3 covariance taken away by filter 2^column texels;
                                    // row 4 the sines: k, amplitude, phase near the base
#define TARN_TEXTURE_WAVE_LIMITS 9  // TARN_BUFFER_WAVE_LIMITS, to be read
#define TARN_BUFFER_WAVE_LIMITS 7   // uint, floats' bits, TARN_WAVE_LIMITS of each cascade: greatest |height| of
                                    // each level; the steepest slope between texels; one minus the least
                                    // eigenvalue of the displacement's Jacobian
#define TARN_IMAGE_SURFACE 7        // rgba32ui: the surface met, packed (lib/waves.glsl)
#define TARN_IMAGE_WAVE_HEIGHTS 0   // 0-3: r32f arrays, levels being written
#define TARN_IMAGE_WAVE_SLOPES 4    // 4-7: rg16f arrays

#define TARN_WAVE_LEVELS 12         // columns of the table
#define TARN_WAVE_LIMITS 14

struct WaveBlock {
    vec4 patches[4]; // xy: place of the base in the patch [sides], z: side [m], w: side of a texel [m]
    vec4 counts;     // x: sines, y: bound on |height| of the sines [m], z: their greatest slope, w: lift of the water [m]
    vec4 shore;      // x: depth of full amplitude [m], y: cascade that is not repeated, -1: none, zw: -
    vec4 map;        // xy: place of the base in the amplitude map [sides], zw: sides a metre east and south
    vec4 rough;      // xyz: covariance xx, xy, yy of slopes of waves that are not drawn, w: cascade whose share counts
};

#ifdef __cplusplus
static_assert(sizeof(WaveBlock) == 128, "std140 layout");
} // namespace tarn::shared
#endif
