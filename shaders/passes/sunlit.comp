#version 450 core
// passes/sunlit.comp — how waves focus the sun's light on the bed where a part of a path ends, and in the mean over
// what the water on its way scatters to the eye: caustics, and shafts of light. Run before passes/shade.comp.
// Reads hits, surfaces and the tiles of sunlight; writes sunlit. One invocation a pixel of the tile and slot (z): from
// above the refracted part; from below the first one, and in slot 1 the mirrored one.
#ifndef TARN_WAVES
#define TARN_WAVES 1 // nothing else focuses
#endif
#include "lib/medium.glsl"
#include "lib/parts.glsl"
#include "lib/sunlight.glsl"
#include "lib/waves.glsl"
#include "lib/caustics.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_TEXTURE_WATER) uniform sampler2D water;
layout(binding = TARN_TEXTURE_SUNLIGHT) uniform sampler2DArray sunlight_tiles;
#ifdef TARN_LAND_SHADOW
layout(binding = TARN_TEXTURE_LAND_SHADOW) uniform sampler2D land_shadow;
#endif
#ifdef TARN_PRISMS
#include "shared/prisms.h"
layout(binding = TARN_TEXTURE_PRISMS) uniform sampler2D prisms;
#endif
layout(binding = TARN_TEXTURE_AMPLITUDE) uniform sampler2D amplitudes;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_BLOCK_SUNLIGHT, std140) uniform Sunlight { SunlightBlock sunlight; };
layout(binding = TARN_BLOCK_WAVES, std140) uniform Waves { WaveBlock waves; };
layout(binding = TARN_IMAGE_HITS, rgba32ui) uniform readonly uimage2D hits[3];
layout(binding = TARN_IMAGE_SURFACE, rgba32ui) uniform readonly uimage2D surfaces;
layout(binding = TARN_IMAGE_SUNLIT, r32ui) uniform writeonly uimage2D sunlit_image;

// Metres east and north of the waves' base, after t metres of a part.
vec2 place_of(Part part, float t) {
    return ((part.base - view.base.xy) + part.origin.xy) * vec2(view.grid.z, -view.grid.z) + t * part.direction.xy;
}

// Sunlight at a place in the water against that below flat water.
float focus_at(vec2 at_m, float depth_m, float footprint_m) {
    vec4 amplitude = wave_amplitude(amplitudes, waves, at_m - depth_m * sunlight.beam.xy) * wave_fade(waves, depth_m);
    return sun_focus(sunlight_tiles, sunlight, waves, at_m, depth_m, amplitude, footprint_m);
}

#if TARN_SHAFTS > 0
shared vec2 found[64]; // focus and length of each pixel's way, < 0: none

// Bayer's order of a square of 4 x 4 pixels, in sixteenths.
float order_of(ivec2 pixel) {
    ivec2 low = pixel & 1, high = pixel >> 1 & 1;
    return float(4 * (2 * (low.x ^ low.y) + low.y) + 2 * (high.x ^ high.y) + high.y) / 16.0;
}

// What sixteen pixels around one found, those that look at least a tenth farther or less far left out.
float shared_focus(float length_m) {
    ivec2 local = ivec2(gl_LocalInvocationID.xy), first = clamp(local - 1, ivec2(0), ivec2(4));
    vec2 sum = vec2(0.0);
    for (int i = 0; i < 16; ++i) {
        vec2 other = found[8 * (first.y + (i >> 2)) + first.x + (i & 3)];
        if (abs(other.y - length_m) <= 0.1 * length_m)
            sum += vec2(other.x, 1.0);
    }
    return sum.x / sum.y;
}

// Mean of the waves' focus over what the sun's light scatters into a part of the view, 1 in still water: shafts of
// light. Places along the way are drawn by what they bring to the eye, one from each of some equal shares of that.
//
//   slant   path of sunlight per metre of depth
float shaft_focus(Part part, float depth_m, float sink, float slant, float before_m, float length_m, float path_m) {
    length_m = max(length_m, 1e-4); // a mirrored part may end where it begins
    WayLight way = way_light(water, view.water, slant, depth_m, sink, before_m, length_m);
    // Sixteen pixels side by side look at places of their own, and share what they find.
    float lot = order_of(ivec2(gl_LocalInvocationID.xy)) + fract(0.5 + 0.61803399 * view.offset.z) / 16.0;
    float sum = 0.0;
    for (int i = 0; i < TARN_SHAFTS; ++i) {
        float t = drawn_place(way.fall, length_m, (float(i) + lot) / float(TARN_SHAFTS));
        float depth = max(depth_m + sink * t, 0.0);
        float focus = focus_at(place_of(part, t), depth, view.camera.w * (path_m + t));
        focus = 1.0 + (focus - 1.0) * exp(-way.blur * max(way.start + way.rate * t, 0.0));
#ifdef TARN_LAND_SHADOW
        focus *= lit_share(land_shadow, view, part, t, sun_below(view.sun.xyz, view.optics.x));
#endif
        sum += focus;
    }
    return sum / float(TARN_SHAFTS);
}
#endif

#ifdef TARN_PRISMS
// What the prisms of light add to the mean of 1: four samples of the coarse picture about the pixel.
float prism_light(ivec2 local) {
    vec2 texel = (vec2(local) + 0.5) / float(TARN_PRISM_PIXELS), size = vec2(textureSize(prisms, 0));
    float sum = 0.0;
    for (int k = 0; k < 4; ++k)
        sum += textureLod(prisms, (texel + vec2(k & 1, k >> 1) - 0.5) / size, 0.0).r;
    return 0.25 * sum;
}
#endif

// The part that a slot is for, and where it ends. Returns whether there is one.
bool part_of_slot(ivec2 local, int slot, out Part part, out End end, out float before_m, out float water_m) {
    part = camera_part(view, pixel_of(view, local));
    if (left_out(view, part))
        return false;
    end = unpack_end(imageLoad(hits[0], local));
    before_m = water_m = 0.0;
    bool from_water = part.in_water;
    int number = slot == 1 ? 1 : from_water ? 0 : 2;
    if (number == 0)
        return true;
    if ((end.flags & end_surface) == 0u)
        return false;
    WaveSurface met = unpack_surface(imageLoad(surfaces, local));
    Surface surface = Surface(slope_of_part(met, number, from_water, lot_of(view, pixel_of(view, local)), view.offset.z,
                                            direction_after(view, part, end.t), view.optics.x),
                              surface_level(heights, view, part, end));
    before_m = end.t;
    water_m = from_water ? end.t : 0.0;
    part = split_part(view, part, end, surface, number);
    if (!wanted(view, part, number))
        return false;
    end = unpack_end(number == 1 ? imageLoad(hits[1], local) : imageLoad(hits[2], local));
    return true;
}

void main() {
    ivec2 local = ivec2(gl_GlobalInvocationID.xy);
    int slot = int(gl_GlobalInvocationID.z);
    Part part;
    End end;
    float before_m, water_m;
    bool mine = all(lessThan(local, view.tile.zw)) && part_of_slot(local, slot, part, end, before_m, water_m);
    vec2 both = vec2(1.0);
    float depth = 0.0, sink = 0.0;
    if (mine) {
        depth = depth_of(part);
        sink = -part.direction.z;
        if ((end.flags & end_ground) != 0u)
            both.x = focus_at(place_of(part, end.t), max(depth + sink * end.t, 0.0), view.camera.w * (before_m + end.t));
    }
#ifdef TARN_PRISMS
    if (mine && slot == 0)
        both.y = max(1.0 + prism_light(local), 0.0);
#endif
#if TARN_SHAFTS > 0
    vec2 own = vec2(1.0, -1e9);
    if (mine)
        own = vec2(shaft_focus(part, depth, sink, 1.0 / sun_below(view.sun.xyz, view.optics.x).z, water_m, end.t, before_m),
                   end.t);
    found[gl_LocalInvocationIndex] = own;
    barrier();
    if (mine)
        both.y = shared_focus(own.y);
#endif
    if (mine)
        imageStore(sunlit_image, local + ivec2(0, slot * view.tile.w), uvec4(packHalf2x16(both)));
}
