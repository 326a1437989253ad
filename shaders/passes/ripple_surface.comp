#version 450 core
// passes/ripple_surface.comp — ripples as one more layer of the waves: height and slopes.
// Reads two states; writes level 0 of a layer of the waves' textures. One invocation a texel.
#include "shared/wave_block.h"
layout(local_size_x = 16, local_size_y = 8) in;
layout(binding = 2, r32f) uniform readonly image2D now;
layout(binding = 3, r32f) uniform readonly image2D before;
layout(binding = TARN_IMAGE_WAVE_HEIGHTS, r32f) uniform writeonly image2DArray heights;
layout(binding = TARN_IMAGE_WAVE_SLOPES, rg16f) uniform writeonly image2DArray slopes;
layout(location = 0) uniform int layer;
layout(location = 1) uniform float since;  // share of a step since the state before
layout(location = 2) uniform float per_m;  // texels a metre
layout(location = 3) uniform float bound;  // on |height| [m]

float height_at(ivec2 texel) {
    texel = (texel + imageSize(now)) % imageSize(now);
    return clamp(mix(imageLoad(before, texel).r, imageLoad(now, texel).r, since), -bound, bound);
}

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, imageSize(now))))
        return;
    vec2 slope = 0.5 * per_m * vec2(height_at(texel + ivec2(1, 0)) - height_at(texel - ivec2(1, 0)),
                                    height_at(texel + ivec2(0, 1)) - height_at(texel - ivec2(0, 1)));
    imageStore(heights, ivec3(texel, layer), vec4(height_at(texel)));
    imageStore(slopes, ivec3(texel, layer), vec4(slope, 0.0, 0.0));
}
