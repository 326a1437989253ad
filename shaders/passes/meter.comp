#version 450
// passes/meter.comp — radiance at an even raster of places of the picture, for its exposure.
#include "shared/view_block.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_PICTURE) uniform sampler2D picture; // linear radiance
layout(std430, binding = TARN_BUFFER_METER) writeonly buffer Meter { vec4 metered[]; };

layout(location = 0) uniform ivec2 places; // across and down

void main() {
    ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(place, places)))
        return;
    ivec2 size = textureSize(picture, 0);
    metered[place.y * places.x + place.x] = texelFetch(picture, (2 * place + 1) * size / (2 * places), 0);
}
