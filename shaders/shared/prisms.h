// shared/prisms.h — names that the passes of the light's prisms (passes/prism*.comp, prisms.vert) and C++ share.
#ifdef __cplusplus
#pragma once
#endif

#define TARN_BUFFER_PRISMS 4   // vec4 for each corner: xy: its place [m east and north of the waves' base], zw: metres that
                               // its light comes east and north a metre deeper
#define TARN_BUFFER_SHARES 5   // float: flux through a corner's facet against that of flat water
#define TARN_TEXTURE_PRISMS 19 // R32F: light that they add, against that of flat water; a texel for some pixels
#define TARN_IMAGE_PRISM_RAYS 6 // rgba32f: x: length of the way [m], y: fall of what it shows [1/m], z: share of what is
                                // left of patterns over the sum of all light, w: -
#define TARN_PRISM_PIXELS 4    // pixels of the picture a texel, across and down
