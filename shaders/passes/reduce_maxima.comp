#version 450 core
// passes/reduce_maxima.comp — one mip level of the maxima from the one below it.
// Reads `source_level` of the maxima, writes the next. One invocation per texel.
#include "shared/view_block.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_BOUNDS) uniform sampler2D finer;
layout(binding = TARN_IMAGE_MAXIMA, rg32f) uniform writeonly image2D coarser;
layout(location = 0) uniform int source_level;

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, imageSize(coarser))))
        return;
    ivec2 last = textureSize(finer, source_level) - 1;
    vec2 highest = vec2(-1e30);
    for (int k = 0; k < 4; ++k)
        highest = max(highest,
                      texelFetch(finer, min(texel * 2 + ivec2(k & 1, k >> 1), last), source_level).rg);
    imageStore(coarser, texel, vec4(highest, 0.0, 0.0));
}
