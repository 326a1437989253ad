#version 450 core
// passes/sunlight_clear.comp — no flux yet. (One driver's own clearing of a buffer took three times as long as all
// that follows.) One invocation four texels.
#include "shared/sunlight_block.h"
layout(local_size_x = 256) in;
layout(binding = TARN_BUFFER_SUNLIGHT, std430) writeonly buffer Flux { uvec4 flux[]; };

void main() {
    uint first = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 256u + gl_LocalInvocationIndex;
    if (first < uint(flux.length()))
        flux[first] = uvec4(0u);
}
