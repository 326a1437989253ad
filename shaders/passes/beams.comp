#version 450 core
// passes/beams.comp — for each tile of 8 x 8 pixels how far all its rays fly through free air.
// Reads bounds; writes beams [m]. One invocation a tile. Walks that have no beams write 0.
#include "lib/camera.glsl"
#include "lib/walks/chosen.glsl"

layout(local_size_x = 8, local_size_y = 4) in;
layout(binding = TARN_TEXTURE_BOUNDS) uniform sampler2D bounds;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_IMAGE_BEAMS, r32f) uniform writeonly image2D beams;

void main() {
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(tile, imageSize(beams))))
        return;
    float reach = 0.0;
#ifdef TARN_WALK_HAS_BEAMS
    vec2 middle = vec2(8 * tile) + 4.0 + vec2(0.0, floor(view.offset.y)); // with the rows above a strip
    vec3 direction = pixel_direction(view.forward.xyz, view.right.xyz, view.up.xyz, vec2(view.right.w, view.up.w),
                                     middle * view.inverse_size.zw);
    // Half the tile's diagonal in a picture plane at distance 1: unit vectors are nearer to each other.
    float spread = 5.7 * view.camera.w;
    bool from_above = (view.counts.z & TARN_FLAG_UNDER_WATER) == 0u;
    Ray ray = ray_from(field_of(view), view.base.xy, view.camera.xyz, direction);
    reach = beam_reach(bounds, field_of(view), ray, spread, from_above);
#endif
    imageStore(beams, tile, vec4(reach));
}
