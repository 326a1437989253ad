// shared/view_block.h — everything the passes are told about scene, camera and light; compiled by
// C++ AND by GLSL.
// Rules: only vec4 / uvec4 members (std140 and C++ then agree); one unit per component; no functions
// and no constants of nature here, those arrive as values from src/scene.
// Frame: "grid metres". x = columns, y = rows (southwards), both in nodes; z = height above
// `heights.x` metres of the scene's datum. Directions without a note are scene axes (x east, y
// north, z up, unit length).
#ifdef __cplusplus
#pragma once
#include <cstddef>
#include <glm/vec4.hpp>
namespace tarn::shared {
using vec4 = glm::vec4;
using uvec4 = glm::uvec4;
using ivec4 = glm::ivec4;
#endif

#define TARN_BLOCK_VIEW 0     // uniform block ViewBlock
#define TARN_BUFFER_LAKES 0   // storage buffer of vec4: x level [m, block heights], y 1 = bed known
#define TARN_BUFFER_RAYS 1    // passes/trace_rays.comp
#define TARN_BUFFER_ANSWERS 2 // passes/trace_rays.comp
#define TARN_BUFFER_SPACE_LINES 2 // lib/space_lines.glsl
#define TARN_TEXTURE_HEIGHTS 0 // RG16: ground and water codes, one texel a node
#define TARN_TEXTURE_BOUNDS 1  // what the walk skips by: see its file in lib/walks
#define TARN_TEXTURE_SKY 2     // RGBA32F: sky radiance
#define TARN_TEXTURE_ORTHO 3   // SRGB8_ALPHA8: orthophoto
#define TARN_TEXTURE_OVERLAY 5 // RGBA32F: rasterised things: radiance, and distance [m] in alpha, 0 = none
#define TARN_TEXTURE_SKY_SOFT 11 // RGBA16F (RGB32F on software GL): the same, quicker to look up, for sums
#define TARN_TEXTURE_WATER 12  // RGBA32F: what water does to light by colour (lib/medium.glsl)
#define TARN_TEXTURE_LAND_SHADOW 14 // RG32F: below these heights [m above heights.x] land, and the bed, hide the sun
#define TARN_TEXTURE_BEAMS 4   // R32F: free path of each tile of 8 x 8 pixels [m]
#define TARN_TEXTURE_PORT 15 // R32F: height of the water around a camera at its surface: passes/port.comp
#define TARN_PORT_SIDE 64    // texels
#define TARN_TEXTURE_EXPOSED 16 // R8: share of bed that has fallen dry, a texel a node
#define TARN_TEXTURE_DRAPE 17  // R8: nearness of draped lines over the ground (lib/markings.glsl)
#define TARN_TEXTURE_GLOW 18   // RGBA32F: light around the sun's beam in the water (lib/medium.glsl)
#define TARN_TEXTURE_SKY_GLOW 21 // RGBA32F: the same of skylight, around the vertical
#define TARN_TEXTURE_PICTURE 20 // the picture so far: passes/display.comp, passes/meter.comp
#define TARN_BUFFER_METER 1    // passes/meter.comp
#define TARN_IMAGE_SCREEN 6    // rgba8: passes/display.comp; beams and port heights are written before a picture, this after it
#define TARN_IMAGE_RADIANCE 0  // rgba32f
#define TARN_IMAGE_DISTANCE 1  // r32f
#define TARN_IMAGE_MAXIMA 2    // rg32f, written level of the maxima
#define TARN_IMAGE_SUNLIT 2    // r32ui: how waves focus the light on a bed, and on the way there
#define TARN_IMAGE_BEAMS 6     // r32f
#define TARN_IMAGE_HITS 3      // 3, 4, 5: rgba32ui, one image for each part of a path (lib/parts.glsl)

#define TARN_FLAG_SHADOWS 1u
#define TARN_FLAG_REFLECTION 2u
#define TARN_FLAG_REFRACTION 4u
#define TARN_FLAG_SCHLICK 8u
#define TARN_FLAG_SUN_DISC 16u
#define TARN_FLAG_ORTHO 32u
#define TARN_FLAG_UNDER_WATER 64u
#define TARN_FLAG_OVERLAY 128u
#define TARN_FLAG_THROWN_BACK 256u
#define TARN_FLAG_MIRRORED_LAND 512u

struct ViewBlock {
    vec4 camera;          // xyz: position from the node `base` (grid), w: angle of a pixel [rad]
    vec4 forward;         // xyz: unit, w: bottom of the block of earth [m]
    vec4 right;           // xyz: unit, w: tangent of half the horizontal field of view
    vec4 up;              // xyz: unit, w: tangent of half the vertical field of view
    vec4 grid;            // x: columns, y: rows of nodes, z: spacing [m], w: greatest height [m]
    vec4 heights;         // x: scene height of z = 0 [m], y: ground [m per unit texel],
                          // z: water offset [m], w: water [m per unit texel]
    vec4 sun;             // xyz: towards the sun, w: angular radius of its disc [rad]
    vec4 sun_irradiance;  // rgb: on a plane facing the sun, w: height over which the edge of land's shadow is spread [m]
    vec4 sky_irradiance;  // rgb: on a horizontal plane, w: the same of the bed's shadow [m]
    vec4 air;             // rgb: extinction at the lake's level [1/m], w: 1 / height over which it falls by e [1/m]
    vec4 optics;          // x: index of refraction of the water, y: greatest path in it [m], z: share of an even
                          // sky's light that flat water lets in, w: how fast light falls in it, about [1/m]
    vec4 water;           // of the water's table: lib/medium.glsl, water_row()
    vec4 look;            // x: tree line [m], y: snow line [m], z: lake level [m] (all above z = 0),
                          // w: uniform ground albedo, < 0 = the colour scheme
    vec4 ortho;           // xy: grid position of its north-west corner, zw: nodes per picture side
    vec4 ortho_lod;       // x: metres per pixel, yzw: -
    vec4 diver;           // of the camera: x: radius of its port [m]; its lamp's y: intensity along the view
                          // [irradiance at 1 m], z: distance from the lens [m]
                          // w: irradiance on lines in space, to be signs; 0: they are lit as things
    vec4 options;         // x: lift of shadow rays [m], y: level of the water the camera is in [m],
                          // z: 1 if that lake's bed is known, w: weight of this sample
    vec4 offset;          // xy: position inside the pixel, and rows of the picture above those that are drawn, z: index of the sample, w: how far the walk's water is
                          // raised above its level, for waves [m]
    uvec4 counts;         // x: width, y: height [px], z: flags, w: lakes
    ivec4 tile;           // xy: first pixel, zw: size of the tile being drawn
    vec4 base;            // xy: node by the camera, z: 1 / spacing [1/m], w: what the Earth's curvature bends
                          // lines of sight by [1/m], 0: not at all
    vec4 inverse_size;    // xy: 1 / nodes, zw: 1 / pixels
    // For the walks, whose unit of height is that of a texel (lib/heightfield.glsl):
    vec4 units;           // x: units a metre, yz: of water: offset and factor on the texel, w: the top
    vec4 bounds;          // cone map, units a texel: x: of the ground, y: of the surface;
                          // z: setting of the walk, w: the bottom
    vec4 slab;            // x: lowest ground, y: highest water,
                          // zw: steepest slope of the ground's and the surface's cone map, units a cell
    // For what maps draw, with TARN_MAP:
    vec4 map;             // x: interval of contours on land [m], y: in water, z: depth of the darkest colour of
                          // depth [m]; 0: none of them; w: what is added to z for heights that contours count from
    vec4 drape;           // xy: grid position of its north-west corner, z: nodes a texel, w: reach of nearness [m], 0: none
    vec4 exposed;         // x: level that the bed was exposed from [m], y: 1 if there is such, z: draped lines
                          // show everywhere (0), on dry ground (1), on beds (2), w: -
    ivec4 walk;           // x: level of the root block, y: cone map's blocks are 2^y cells a side,
                          // zw: pixels left out after each 8 across and down, for samples of a picture
};

#ifdef __cplusplus
static_assert(sizeof(ViewBlock) == 464 && offsetof(ViewBlock, walk) == 448, "std140 layout");
} // namespace tarn::shared
#endif
