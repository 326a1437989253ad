#version 450 core
// passes/prism_rays.comp — of one pixel in each square of TARN_PRISM_PIXELS: how far it looks in the water, and how the
// light from there falls off. Reads hits and water; writes prism rays. One invocation a texel.
#include "lib/medium.glsl"
#include "lib/parts.glsl"
#include "lib/sunlight.glsl"
#include "shared/prisms.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_WATER) uniform sampler2D water;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_IMAGE_HITS, rgba32ui) uniform readonly uimage2D hits;
layout(binding = TARN_IMAGE_PRISM_RAYS, rgba32f) uniform writeonly image2D rays;

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 local = min(texel * TARN_PRISM_PIXELS + TARN_PRISM_PIXELS / 2, view.tile.zw - 1);
    Part part = camera_part(view, pixel_of(view, local));
    float length_m = max(unpack_end(imageLoad(hits, local)).t, 1e-4), sink = -part.direction.z;
    WayLight way = way_light(water, view.water, 1.0 / sun_below(view.sun.xyz, view.optics.x).z, depth_of(part), sink, 0.0,
                             length_m);
    float all = abs(way.fall * length_m) < 1e-3 ? length_m : (1.0 - exp(-way.fall * length_m)) / way.fall;
    imageStore(rays, texel, vec4(length_m, way.fall + way.blur * way.rate, exp(-way.blur * way.start) / max(all, 1e-9), 0.0));
}
