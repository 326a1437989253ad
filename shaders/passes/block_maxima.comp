#version 450 core
// passes/block_maxima.comp — level 1 of the maxima: greatest node of each block of 4 x 4 cells.
// Reads heights, writes mip level 0 of the maxima. One invocation per block; blocks beyond the
// field get a height that no ray can miss.
#include "shared/view_block.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_IMAGE_MAXIMA, rg32f) uniform writeonly image2D maxima;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };

void main() {
    ivec2 block = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(block, imageSize(maxima))))
        return;
    ivec2 last = textureSize(heights, 0) - 1;
    vec2 highest = vec2(-1e30);
    for (int j = 0; j <= 4; ++j)
        for (int i = 0; i <= 4; ++i) {
            ivec2 node = block * 4 + ivec2(i, j);
            if (any(greaterThan(node, last)) || any(greaterThanEqual(block * 4, last)))
                continue;
            vec2 code = texelFetch(heights, node, 0).rg;
            float ground = code.r * view.heights.y;
            float water = code.g > 0.0 ? code.g * view.heights.w + view.heights.z : -1e30;
            highest = max(highest, vec2(ground, water));
        }
    imageStore(maxima, block, vec4(highest, 0.0, 0.0));
}
