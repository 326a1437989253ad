// lib/parts.glsl — the up to three parts of a pixel's path, and how a part's end is stored between passes.
// Pure functions. C++ twin of the split: src/reference/parts.hpp
//
// Part 0 runs from the camera to the first surface. If that is water, part 1 is the mirrored and part 2
// the refracted ray. Ends are found by lean passes that only walk (few registers, so that many rays are
// in flight) and coloured by another that does not walk at all.
#include "shared/view_block.h"
#include "lib/camera.glsl"
#include "lib/fresnel.glsl"
#include "lib/heightfield.glsl"

const float far_m = 1e9;

// What a part ended at; bits of End.flags.
const uint end_ground = 1u;    // land or bed
const uint end_surface = 2u;   // the water's surface: parts 1 and 2 go on from here
const uint end_lit = 4u;       // the sun reaches that ground
const uint end_bed_known = 8u; // the lake met, or dived in, has a bed
const uint end_overlay = 16u;  // something rasterised, before ground and surface

struct End {
    float t;      // path length [m]; where nothing was met, the reach of the part
    ivec2 cell;   // node and ...
    vec2 inside;  // ... place in its cell, to a 65535th
    uint flags;
};

uvec4 pack_end(End end) {
    return uvec4(floatBitsToUint(end.t), uint(end.cell.x) | uint(end.cell.y) << 16, packUnorm2x16(end.inside),
                 end.flags);
}

End unpack_end(uvec4 packed_end) {
    return End(uintBitsToFloat(packed_end.x), ivec2(packed_end.y & 0xffffu, packed_end.y >> 16),
               unpackUnorm2x16(packed_end.z), packed_end.w);
}

struct Split {
    vec3 reflected, refracted; // unit; refracted is reflected beyond the critical angle
    float mirror, through;     // factors on radiance that comes from there
};

// split_at_surface — where a view ray goes on at the water, and what each branch counts.
//
//   direction   unit, of the view ray
//   normal      unit, of the surface, upwards. A mirrored ray that a steep wave would send into the water from
//               above, or out of it from below, is turned back: a stand-in for its second bounce.
//   index       of refraction of the water
//   from_water  the ray comes from below
//   schlick     approximate reflectance
// Source  Snell and Fresnel; what is conserved along a ray is radiance over index squared.
Split split_at_surface(vec3 direction, vec3 normal, float index, bool from_water, bool schlick) {
    float eta = from_water ? index : 1.0 / index, side = from_water ? -1.0 : 1.0;
    vec3 facing = side * normal;
    float cosine = clamp(-dot(direction, facing), 0.0, 1.0);
    float mirror = schlick ? fresnel_schlick(cosine, eta) : fresnel_dielectric(cosine, eta);
    vec3 reflected = direction + 2.0 * cosine * facing;
    reflected.z = side * abs(reflected.z);
    vec3 through = reflected;
    if (mirror < 1.0) {
        through = refracted(direction, facing, eta);
        through.z = -side * abs(through.z);
    }
    return Split(reflected, through, mirror, (1.0 - mirror) * eta * eta);
}

struct Part {
    vec2 base;      // node that origin.xy counts from
    vec3 origin;    // columns, rows, height
    vec3 direction; // unit, scene axes
    float weight;   // factor of the split
    bool in_water;
    float level;    // of that water, or of the water that the path was split at
    bool bed_known; // in that lake
};

// pixel_of — the picture's pixel that an invocation of the tile draws.
ivec2 pixel_of(ViewBlock view, ivec2 local) { return local + view.tile.xy + (local >> 3) * view.walk.zw; }

// lot_of — the pixel that chances are drawn for: those of a strip are the whole picture's.
ivec2 lot_of(ViewBlock view, ivec2 pixel) { return pixel + ivec2(0, int(view.offset.y)); }

#ifdef TARN_PORT
// A camera at the surface looks through the dome of a port, half of which may be under water: rays begin on it, each
// in what is there. Such a picture is drawn twice, once for each medium.
layout(binding = TARN_TEXTURE_PORT) uniform sampler2D port_heights;
#endif

// camera_part — part 0 of a pixel's path.
Part camera_part(ViewBlock view, ivec2 pixel) {
    vec2 place = (vec2(pixel) + view.offset.xy) * view.inverse_size.zw;
    vec3 direction =
        pixel_direction(view.forward.xyz, view.right.xyz, view.up.xyz, vec2(view.right.w, view.up.w), place);
    Part part = Part(view.base.xy, view.camera.xyz, direction, 1.0, (view.counts.z & TARN_FLAG_UNDER_WATER) != 0u,
                     view.options.y, view.options.z > 0.5);
#ifdef TARN_PORT
    part.origin += view.diver.x * vec3(direction.x * view.base.z, -direction.y * view.base.z, direction.z);
    vec2 at = 0.5 + 0.5 * vec2(direction.x, -direction.y);
    part.in_water = part.origin.z < textureLod(port_heights, at, 0.0).r;
#endif
    return part;
}

// left_out — whether a pixel's ray begins in the other medium than the one being drawn.
bool left_out(ViewBlock view, Part part) {
#ifdef TARN_PORT
    return part.in_water != ((view.counts.z & TARN_FLAG_UNDER_WATER) != 0u);
#else
    return false;
#endif
}

// height_after, direction_after — of a part after t metres: in air, by how far level ground has fallen away below it
//                                 (air_ray in lib/heightfield.glsl).
float height_after(ViewBlock view, Part part, float t) {
    float height = part.origin.z + t * part.direction.z;
#ifdef TARN_CURVED
    if (!part.in_water)
        height += view.base.w * dot(part.direction.xy, part.direction.xy) * t * t;
#endif
    return height;
}

vec3 direction_after(ViewBlock view, Part part, float t) {
#ifdef TARN_CURVED
    if (!part.in_water)
        return normalize(part.direction + vec3(0.0, 0.0, 2.0 * view.base.w * dot(part.direction.xy, part.direction.xy) * t));
#endif
    return part.direction;
}

// The water's surface where part 0 met it.
struct Surface {
    vec2 slope;     // rise per metre east and north
    float level;    // mean
};

// surface_level — mean level of the water that a part met; `offset.w` is how far the walk's water is raised.
float surface_level(sampler2D heights, ViewBlock view, Part first, End end) {
    return first.in_water ? first.level
                          : texelFetch(heights, end.cell, 0).g * view.heights.w + view.heights.z - view.offset.w;
}

// calm_surface — where there are no waves.
Surface calm_surface(sampler2D heights, ViewBlock view, Part first, End end) {
#ifdef TARN_CUT_WATER
    return Surface(vec2(0.0), surface_level(heights, view, first, end));
#else
    return Surface(vec2(0.0), first.in_water ? first.level : height_after(view, first, end.t));
#endif
}

// So far below its surface, water that is met from the air is met at a side of the scene's block [m].
const float cut_tolerance_m = 0.01;

// at_cut — whether a path has come from outside through the side of the block that the scene is cut out of, and met the
//          water of a lake that is cut, too: as the pane of an aquarium shows it, but for the glass.
bool at_cut(ViewBlock view, Part first, End end, float level) {
#ifdef TARN_CUT_WATER
    return !first.in_water && height_after(view, first, end.t) < level - cut_tolerance_m - 2.0 * view.offset.w;
#else
    return false;
#endif
}

// cut_normal — unit, outward, of the side of the block that is nearest to where a part ended.
vec3 cut_normal(ViewBlock view, End end) {
    vec2 low = vec2(end.cell) + end.inside, high = view.grid.xy - 1.0 - low; // nodes from the sides
    float nearest = min(min(low.x, low.y), min(high.x, high.y));
    return nearest == low.x    ? vec3(-1.0, 0.0, 0.0)
           : nearest == high.x ? vec3(1.0, 0.0, 0.0)
           : nearest == low.y  ? vec3(0.0, 1.0, 0.0) // rows run southwards
                               : vec3(0.0, -1.0, 0.0);
}

// split_at_cut — as split_at_surface, at the side of cut water from outside.
Split split_at_cut(vec3 direction, vec3 normal, float index, bool schlick) {
    float cosine = clamp(-dot(direction, normal), 0.0, 1.0), eta = 1.0 / index;
    float mirror = schlick ? fresnel_schlick(cosine, eta) : fresnel_dielectric(cosine, eta);
    return Split(direction + 2.0 * cosine * normal, refracted(direction, normal, eta), mirror, (1.0 - mirror) * eta * eta);
}

// split_part — part 1 or 2 from where part 0 met the surface.
Part split_part(ViewBlock view, Part first, End end, Surface surface, int number) {
    vec3 direction = direction_after(view, first, end.t);
    bool schlick = (view.counts.z & TARN_FLAG_SCHLICK) != 0u;
    Split split;
    if (at_cut(view, first, end, surface.level))
        split = split_at_cut(direction, cut_normal(view, end), view.optics.x, schlick);
    else
        split = split_at_surface(direction, normalize(vec3(-surface.slope, 1.0)), view.optics.x, first.in_water, schlick);
    bool mirrored = number == 1;
    return Part(vec2(end.cell), vec3(end.inside, height_after(view, first, end.t)),
                mirrored ? split.reflected : split.refracted, mirrored ? split.mirror : split.through,
                mirrored == first.in_water, surface.level, (end.flags & end_bed_known) != 0u);
}

// wanted — whether a part of that number is drawn at all.
bool wanted(ViewBlock view, Part part, int number) {
    uint flag = number == 1 ? TARN_FLAG_REFLECTION : TARN_FLAG_REFRACTION;
    return (view.counts.z & flag) != 0u && part.weight > 0.0;
}

float depth_of(Part part) { return part.in_water ? max(part.level - part.origin.z, 0.0) : 0.0; }

// to_surface — path to the water's surface from below; far if the part does not rise to it.
float to_surface(Part part) {
    return part.in_water && part.direction.z > 1e-6 ? depth_of(part) / part.direction.z : far_m;
}

// reach — path after which the part ends whatever it met.
float reach(ViewBlock view, Part part) {
    return part.in_water ? min(to_surface(part), view.optics.y) : far_m;
}

Ray ray_of(ViewBlock view, Part part) {
    Field field = field_of(view);
    return part.in_water ? ray_from(field, part.base, part.origin, part.direction)
                         : air_ray(field, part.base, part.origin, part.direction);
}

// place_at — node and place in its cell that the part has come to after t metres.
void place_at(ViewBlock view, Part part, float t, out ivec2 cell, out vec2 inside) {
    vec2 at = part.origin.xy + t * vec2(part.direction.x, -part.direction.y) / view.grid.z;
    vec2 node = clamp(floor(at), -part.base, view.grid.xy - 2.0 - part.base);
    cell = ivec2(node + part.base);
    inside = clamp(at - node, 0.0, 1.0);
}

// lit_share — whether the sun's light comes to a place in the water of a part: 0 in the shadow of land, by where the
//             light enters, or of the bed, 1 beside it.
//
//   land_shadow  x: height below which land hides the sun, y: below which the bed does (src/scene/land_shadow.hpp)
//   t            metres of the part
//   below        towards the sun, in the water
float lit_share(sampler2D land_shadow, ViewBlock view, Part part, float t, vec3 below) {
    float depth = max(depth_of(part) - part.direction.z * t, 0.0);
    vec2 east_north = t * part.direction.xy + depth / below.z * below.xy;
    vec2 nodes = part.base + part.origin.xy + east_north * vec2(1.0, -1.0) / view.grid.z;
    float shadow = textureLod(land_shadow, nodes / (view.grid.xy - 1.0), 0.0).x;
    float lit = clamp((part.level - shadow) / view.sun_irradiance.w + 0.5, 0.0, 1.0);
#ifdef TARN_BED_SHADOW
    vec2 here = part.base + part.origin.xy + t * vec2(part.direction.x, -part.direction.y) / view.grid.z;
    float bed = textureLod(land_shadow, here / (view.grid.xy - 1.0), 0.0).y;
    if (part.bed_known) // else there is none
        lit *= clamp((part.origin.z + t * part.direction.z - bed) / view.sky_irradiance.w + 0.5, 0.0, 1.0);
#endif
    return lit;
}
