#version 450 core
// passes/sunlit.comp — how waves focus the sun's light on the bed where a part of a path ends, and in the mean over
// what the water on its way scatters to the eye: caustics, and shafts of light. Run before passes/shade.comp.
// Reads hits, surfaces and the tiles of sunlight; writes sunlit. One invocation a pixel of the tile and slot (z): from
// above the refracted part; from below the first one, and in slot 1 the mirrored one.
#include "lib/medium.glsl"
#include "lib/parts.glsl"
#include "lib/sunlight.glsl"
#include "lib/waves.glsl"
#include "lib/caustics.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_TEXTURE_WATER) uniform sampler2D water;
layout(binding = TARN_TEXTURE_SUNLIGHT) uniform sampler2DArray sunlight_tiles;
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
// Mean of the waves' focus over what the sun's light scatters into a part of the view, 1 in still water: shafts of
// light. Places along the way are drawn by what they bring to the eye, one from each of some equal shares of that.
//
//   slant   path of sunlight per metre of depth
float shaft_focus(Part part, float depth_m, float sink, float slant, float before_m, float length_m, float path_m) {
    const vec3 luminance = vec3(0.2126, 0.7152, 0.0722);
    // All light has come a path that grows evenly: how fast what it brings falls, by its fall over the first mean path.
    float rate = 1.0 + slant * sink, start = slant * depth_m + before_m;
    float typical = min(length_m, 1.0 / max(view.water.z, 1e-3));
    float here = dot(luminance, water_row(water, view.water, 2, start));
    float there = dot(luminance, water_row(water, view.water, 2, start + rate * typical));
    float fall = log(max(here, 1e-12) / max(there, 1e-12)) / typical; // 1/m of the part; < 0 for a steep view upwards
    float whole = max(start + 0.5 * rate * typical, 1e-3);
    float beam = scattered_wide / whole *
                 log(max(dot(luminance, transmittance(water, view.water, whole)), 1e-12) /
                     max(dot(luminance, image_transmittance(water, view.water, whole)), 1e-12)); // 1/m of path
    float last = exp(-fall * length_m);
    // Interleaved gradient noise (Jimenez 2014), turned from sample to sample by the golden ratio.
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + view.tile.xy;
    float lot = fract(52.9829189 * fract(dot(vec2(pixel), vec2(0.06711056, 0.00583715))) + 0.61803399 * view.offset.z);
    float sum = 0.0;
    for (int i = 0; i < TARN_SHAFTS; ++i) {
        float share = (float(i) + lot) / float(TARN_SHAFTS);
        float t = abs(fall * length_m) < 1e-3 ? share * length_m : -log(1.0 - share * (1.0 - last)) / fall;
        float depth = max(depth_m + sink * t, 0.0);
        float focus = focus_at(place_of(part, t), depth, view.camera.w * (path_m + t));
        sum += (focus - 1.0) * exp(-beam * max(start + rate * t, 0.0));
    }
    return 1.0 + sum / float(TARN_SHAFTS);
}
#endif

void main() {
    ivec2 local = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(local, view.tile.zw)))
        return;
    int slot = int(gl_GlobalInvocationID.z);
    Part first = camera_part(view, local + view.tile.xy);
    End end = unpack_end(imageLoad(hits[0], local));
    int number = slot == 1 ? 1 : first.in_water ? 0 : 2;
    if (slot == 1 && !first.in_water)
        return;
    Part part = first;
    float before_m = 0.0, water_m = 0.0;
    if (number > 0) {
        if ((end.flags & end_surface) == 0u)
            return;
        WaveSurface met = unpack_surface(imageLoad(surfaces, local));
        Surface surface = Surface(slope_of_part(met, number, first.in_water, local + view.tile.xy, view.offset.z,
                                                first.direction, view.optics.x),
                                  surface_level(heights, view, first, end));
        before_m = end.t;
        water_m = first.in_water ? end.t : 0.0;
        part = split_part(view, first, end, surface, number);
        if (!wanted(view, part, number))
            return;
        end = unpack_end(number == 1 ? imageLoad(hits[1], local) : imageLoad(hits[2], local));
    }
    vec2 both = vec2(1.0);
    float depth = depth_of(part), sink = -part.direction.z;
    if ((end.flags & end_ground) != 0u)
        both.x = focus_at(place_of(part, end.t), max(depth + sink * end.t, 0.0), view.camera.w * (before_m + end.t));
#if TARN_SHAFTS > 0
    both.y = shaft_focus(part, depth, sink, 1.0 / sun_below(view.sun.xyz, view.optics.x).z, water_m, end.t, before_m);
#endif
    imageStore(sunlit_image, local + ivec2(0, slot * view.tile.w), uvec4(packHalf2x16(both)));
}
