#version 450 core
// passes/sunlight_tiles.comp — flux gathered on the tiles, as textures with their mip levels.
// Reads flux (TARN_SUNLIGHT_FROM_FLUX) or level `source`; writes level 0 and the next three, or the next four. A
// workgroup 16 x 16 texels, or 8 x 8 of the level made first, and a tile (z).
#include "shared/sunlight_block.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_SUNLIGHT) uniform sampler2DArray tiles;
layout(binding = TARN_IMAGE_SUNLIGHT, rg16f) uniform writeonly image2DArray levels[4];
layout(binding = TARN_BUFFER_SUNLIGHT, std430) readonly buffer Flux { uint flux[]; };
layout(location = 0) uniform int source; // level
layout(location = 1) uniform int made;   // levels
layout(location = 2) uniform int side;   // of the first level made [texels]
layout(location = 3) uniform int slices;
layout(location = 4) uniform ivec4 needed; // slices of each cascade
shared vec2 tile[64];

#ifdef TARN_SUNLIGHT_FROM_FLUX
float flux_at(int layer, ivec2 at) {
    at &= side - 1;
    return float(flux[uint((layer * side + at.y) * side + at.x)]) / TARN_SUNLIGHT_UNIT;
}

// What a texel of one slice holds.
float light_at(int layer, ivec2 at) {
#ifdef TARN_SUNLIGHT_BILATERAL
    // Tomasi & Manduchi 1998: neighbours count by distance, and by how like they are: differences below a photon
    // or two are chance.
    float here = flux_at(layer, at), sum = 0.0, weights = 0.0;
    float like = 0.35 * sqrt(max(here, 0.25)) + 0.1 * here;
    for (int y = -2; y <= 2; ++y)
        for (int x = -2; x <= 2; ++x) {
            float there = flux_at(layer, at + ivec2(x, y)), off = (there - here) / like;
            float weight = exp(-0.35 * float(x * x + y * y) - 0.5 * off * off);
            sum += weight * there;
            weights += weight;
        }
    return sum / weights;
#else
    return flux_at(layer, at);
#endif
}
#endif

void main() {
    int layer = int(gl_GlobalInvocationID.z);
    ivec2 at = ivec2(gl_GlobalInvocationID.xy), local = ivec2(gl_LocalInvocationID.xy);
    uint index = gl_LocalInvocationIndex;
    int last = needed[layer / slices] - 1;
    if (layer % slices > last) // no water is as deep
        return;
    bool mine = all(lessThan(at, ivec2(side)));
    vec2 value = vec2(0.0);
    if (mine) {
#ifdef TARN_SUNLIGHT_FROM_FLUX
        value = vec2(light_at(layer, at), light_at(layer % slices < last ? layer + 1 : layer, at));
#else
        for (int k = 0; k < 4; ++k)
            value += 0.25 * texelFetch(tiles, ivec3(2 * at + ivec2(k & 1, k >> 1), layer), source).xy;
#endif
    }
    for (int level = 0; level < made; ++level) {
        int wide = 8 >> level;
        if (all(lessThan(local, ivec2(wide))) && all(lessThan(at, ivec2(side >> level))))
            imageStore(levels[level], ivec3(at, layer), vec4(value, 0.0, 0.0));
        tile[index] = value;
        barrier();
        at = ivec2(gl_WorkGroupID.xy) * (wide / 2) + local;
        if (all(lessThan(local, ivec2(wide / 2))))
            value = 0.25 * (tile[16 * local.y + 2 * local.x] + tile[16 * local.y + 2 * local.x + 1] +
                            tile[16 * local.y + 8 + 2 * local.x] + tile[16 * local.y + 9 + 2 * local.x]);
        barrier();
    }
}
