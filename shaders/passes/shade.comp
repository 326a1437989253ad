#version 450 core
// passes/shade.comp — the picture: what light each part of a path brings to the camera.
// Reads hits, heights (for normals), sky and orthophoto; adds to radiance. One invocation a pixel of the
// tile. Walks nowhere.
#ifdef TARN_HAZE
#include "lib/air.glsl"
#endif
#include "lib/ground_colour.glsl"
#ifdef TARN_MAP
#include "lib/markings.glsl"
#endif
#include "lib/medium.glsl"
#include "lib/parts.glsl"
#include "lib/sky.glsl"
#ifdef TARN_SPACE_LINES
#include "lib/space_lines.glsl"
#endif
#include "lib/sunlight.glsl"
#include "lib/surface.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_TEXTURE_SKY) uniform sampler2D sky_table;
layout(binding = TARN_TEXTURE_WATER) uniform sampler2D water;
#ifdef TARN_GLOW
layout(binding = TARN_TEXTURE_GLOW) uniform sampler2D glow;
layout(binding = TARN_TEXTURE_SKY_GLOW) uniform sampler2D sky_glow;
#endif
layout(binding = TARN_TEXTURE_ORTHO) uniform sampler2D ortho;
layout(binding = TARN_TEXTURE_OVERLAY) uniform sampler2D overlay;
#ifdef TARN_MAP
layout(binding = TARN_TEXTURE_EXPOSED) uniform sampler2D exposed;
layout(binding = TARN_TEXTURE_DRAPE) uniform sampler2D drape;
#endif
#ifdef TARN_LAND_SHADOW
layout(binding = TARN_TEXTURE_LAND_SHADOW) uniform sampler2D land_shadow;
#endif
layout(binding = TARN_IMAGE_RADIANCE, rgba32f) uniform image2D radiance_image;
layout(binding = TARN_IMAGE_HITS, rgba32ui) uniform readonly uimage2D hits[3];
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
#ifdef TARN_WAVES
#include "lib/waves.glsl"
#ifdef TARN_CAUSTICS
layout(binding = TARN_IMAGE_SUNLIT, r32ui) uniform readonly uimage2D sunlit_image;
#endif
layout(binding = TARN_TEXTURE_SKY_SOFT) uniform sampler2D soft_sky;
layout(binding = TARN_IMAGE_SURFACE, rgba32ui) uniform readonly uimage2D surfaces;
#endif

const float inverse_pi = 0.318309886184;
// Mean slant of skylight in the water, refracted from an even sky: docs/physics/water.md.
const float sky_slant = 1.19;
// White in an aerial picture is no albedo of 1: pictures are exposed for mid grey.
const float photo_albedo = 0.7;
// Of vector layers, draped or in space.
const vec3 layer_colour = vec3(0.85, 0.18, 0.05);

bool on(uint flag) { return (view.counts.z & flag) != 0u; }

// What sky and sun send from a direction.
vec3 sky(vec3 direction) {
    vec3 radiance = sky_radiance(sky_table, direction, view.sun.xyz);
    if (on(TARN_FLAG_SUN_DISC)) {
        float radius = view.sun.w;
        radiance += view.sun_irradiance.rgb / (3.14159265359 * radius * radius) *
                    disc_share(direction, view.sun.xyz, radius, view.camera.w);
    }
    return radiance;
}

vec3 sun_irradiance_below(vec3 below) {
    return view.sun_irradiance.rgb *
           sun_share_below(view.sun.xyz, below, view.optics.x, on(TARN_FLAG_SCHLICK));
}

// How waves focus the sun's light where a part ends, and in the mean of what its way scatters: passes/sunlit.comp.
struct Sunlit {
    float bed, way;
};

#ifdef TARN_CAUSTICS
Sunlit sunlit_of(ivec2 local, int slot) {
    vec2 both = unpackHalf2x16(imageLoad(sunlit_image, local + ivec2(0, slot * view.tile.w)).x);
    return Sunlit(both.x, both.y);
}
#endif

// What is left of the sun's light on the bed, on the way there and to the eye. What was not scattered wide on the way
// still draws where waves have focused it.
//
//   way_m   of all the light's path in water
vec3 sunlight_left(float way_m, Sunlit sunlit) {
    vec3 left = transmittance(water, view.water, way_m);
#ifdef TARN_CAUSTICS
    left += (sunlit.bed - 1.0) * pattern_transmittance(water, view.water, way_m);
#endif
    return left;
}

// Light that is scattered wide comes from around a place as wide as this share of its path: some 12 degrees.
const float scattered_spread = 0.2;

// Share of the light that comes through so much water, by luminance.
//
//   drawn   as much of the light as has not been scattered ...
//   path_m  ... of what is left after that path
float drawn_share(vec3 drawn, float path_m) {
    const vec3 luminance = vec3(0.2126, 0.7152, 0.0722);
    float left = dot(luminance, transmittance(water, view.water, path_m));
    return clamp(dot(luminance, drawn) / max(left, 1e-9), 0.0, 1.0);
}

// Share of the light from a place in the water that still draws its patterns.
float pattern_left(float path_m) { return drawn_share(pattern_transmittance(water, view.water, path_m), path_m); }

#ifdef TARN_MAP
// Contours and draped lines over an albedo.
//
//   nodes   place on the ground, grid
//   z       its height [m], level: of water over it
vec3 marked(vec3 albedo, vec2 nodes, float z, bool in_water, float level, float slope, float footprint) {
    float interval = in_water ? view.map.y : view.map.x;
    if (interval > 0.0) {
        float height = in_water ? level - z : z + view.map.w;
        albedo = mix(albedo, in_water ? vec3(0.55) : vec3(0.03, 0.02, 0.01),
                     0.75 * contour_cover(height, interval, slope, footprint));
    }
    if (view.drape.w > 0.0 && view.exposed.z != (in_water ? 1.0 : 2.0)) {
        vec2 at = (nodes - view.drape.xy) / (view.drape.z * vec2(textureSize(drape, 0)));
        if (all(greaterThan(at, vec2(0.0))) && all(lessThan(at, vec2(1.0)))) {
            float near = textureLod(drape, at, 0.0).r;
            albedo = mix(albedo, layer_colour, drape_cover(near, view.drape.w, 2.4, footprint));
        }
    }
    return albedo;
}
#endif

#ifdef TARN_LAMP
// A diver's lamp, beside the lens; what it lights is seen by part 0 alone. Even to 15 degrees from the middle of the
// view, gone at 25.
const float lamp_inner_cosine = 0.9659258, lamp_outer_cosine = 0.9063078;

float lamp_intensity(vec3 direction) {
    return view.diver.y * smoothstep(lamp_outer_cosine, lamp_inner_cosine, dot(direction, view.forward.xyz));
}

// What the water scatters back of it along the first metres of a view. With t = a tan(p) the fall by the squared
// distance is even in p.
vec3 lamp_scattered(vec3 direction, float length_m) {
    const int looks = 8;
    float beside = view.diver.z, most = atan(length_m / beside);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < looks; ++i)
        sum += water_row(water, view.water, 2, 2.0 * beside * tan(most * (float(i) + 0.5) / float(looks)));
    return lamp_intensity(direction) * most / (beside * float(looks)) * sum;
}
#endif

// Radiance that leaves the ground where a part ended: land in the air, bed under water.
//
//   path_m   length of the way from the camera, for the footprint of a pixel
//   water_m  as much of it as lies in the water: what is left there of the bed's light, is returned
vec3 ground_radiance(Part part, End end, float path_m, float water_m, Sunlit sunlit) {
    float z = height_after(view, part, end.t);
    vec4 corners = textureGather(heights, (vec2(end.cell) + 1.0) * view.inverse_size.xy, 0) * view.heights.y;
    bool cut = z < bilinear(corners, end.inside) - view.options.x;
#ifdef TARN_CUT_WATER
    cut = cut || z < surface_level(heights, view, part, end) - cut_tolerance_m; // the rim of a bed, not dry land
#endif
    if (!part.in_water && cut) {
        // The side of the block that the scene is cut out of.
        vec3 earth = view.look.w < 0.0 ? vec3(0.19, 0.155, 0.115) : vec3(view.look.w);
        float rise = normalize(vec3(-part.direction.xy, 0.5)).z;
        return earth * inverse_pi * view.sky_irradiance.rgb * (0.5 + 0.5 * rise);
    }
    vec2 gradient = ground_gradient(heights, view.grid.xy, end.cell, end.inside, view.heights.y);
    vec3 normal = normal_of(gradient, view.grid.z);
    vec3 albedo = vec3(view.look.w);
    if (view.look.w < 0.0) {
        float footprint = view.camera.w * path_m;
        float shore = part.in_water ? part.level : view.look.z;
        vec2 nodes = vec2(end.cell) + end.inside;
        float near_water = water_share(heights, view.grid.xy, end.cell, end.inside);
        if (!part.in_water && near_water > 0.0) { // beaches lie at the level of their own lake
            vec4 codes = textureGather(heights, (vec2(end.cell) + 1.0) * view.inverse_size.xy, 1);
            shore = max(max(codes.x, codes.y), max(codes.z, codes.w)) * view.heights.w + view.heights.z - view.offset.w;
        }
        albedo = ground_albedo(nodes * view.grid.z, z - shore, part.in_water, near_water, view.look.x - shore,
                               view.look.y - shore, length(gradient) / view.grid.z, footprint);
        float blurred = part.in_water ? 1.0 - pattern_left(water_m) : 0.0;
        if (blurred > 0.02) // what was scattered wide on the way to the eye comes from all around
            albedo = mix(albedo, ground_albedo(nodes * view.grid.z, z - shore, true, near_water, view.look.x - shore,
                                               view.look.y - shore, length(gradient) / view.grid.z,
                                               max(footprint, scattered_spread * water_m)), blurred);
        if (on(TARN_FLAG_ORTHO) && !part.in_water) {
            vec2 at = (nodes - view.ortho.xy) / view.ortho.zw;
            if (all(greaterThan(at, vec2(0.0))) && all(lessThan(at, vec2(1.0)))) {
                float lod = max(0.0, log2(max(footprint, 1e-6) / view.ortho_lod.x));
                vec4 photo = textureLod(ortho, at, lod);
                albedo = mix(albedo, photo_albedo * photo.rgb, photo.a);
            }
        }
#ifdef TARN_MAP
        if (view.exposed.y > 0.0 && !part.in_water) { // was bed, and nothing has grown there since
            float bare = textureLod(exposed, (nodes + 0.5) * view.inverse_size.xy, 0.0).r;
            if (bare > 0.0)
                albedo = mix(albedo, 1.25 * ground_albedo(nodes * view.grid.z, z - view.exposed.x, true, near_water,
                                                          view.look.x - shore, view.look.y - shore,
                                                          length(gradient) / view.grid.z, footprint), bare);
        }
        albedo = marked(albedo, nodes, z, part.in_water, part.level, length(gradient) / view.grid.z, footprint);
#endif
    }
    vec3 towards = part.in_water ? sun_below(view.sun.xyz, view.optics.x) : view.sun.xyz;
    float depth = part.in_water ? max(part.level - z, 0.0) : 0.0;
    vec3 irradiance = (0.5 + 0.5 * normal.z) *
                      (part.in_water ? view.sky_irradiance.rgb * view.optics.z *
                                           transmittance(water, view.water, sky_slant * depth + water_m)
                                     : view.sky_irradiance.rgb);
    if ((end.flags & end_lit) != 0u || (!on(TARN_FLAG_SHADOWS) && view.sun.z > 0.0))
        irradiance += max(dot(normal, towards), 0.0) *
                      (part.in_water ? sun_irradiance_below(towards) * sunlight_left(depth / towards.z + water_m, sunlit)
                                     : view.sun_irradiance.rgb);
#ifdef TARN_LAMP
    if (part.in_water && path_m == end.t)
        irradiance += lamp_intensity(part.direction) * max(-dot(normal, part.direction), 0.0) *
                      transmittance(water, view.water, 2.0 * end.t) / (end.t * end.t + view.diver.z * view.diver.z);
#endif
    if (part.in_water && on(TARN_FLAG_THROWN_BACK)) // what a bright bed gets back from the surface, again and again
        irradiance /= 1.0 - albedo * thrown_back(water, view.water, depth);
    return albedo * inverse_pi * irradiance;
}

#ifdef TARN_HAZE
// What haze leaves of light that comes along a part from `length_m` away, and what it adds of the horizon's.
vec3 through_air(Part part, float length_m, vec3 radiance) {
    vec3 left = air_transmittance(view.air.rgb, view.air.w, part.origin.z - view.look.z,
                                  part.direction.z, length_m);
    return radiance * left + (1.0 - left) * sky_radiance(sky_table, horizon_of(part.direction), view.sun.xyz);
}
#endif

#ifdef TARN_LAND_SHADOW
// Share of a part's way, by what it brings to the eye, that lies in the sun.
float lit_way(Part part, float from_m, float length_m, vec3 below) {
    const int looks = 4;
    float fall = (1.0 - part.direction.z / below.z) * view.optics.w, sum = 0.0;
    float lot = fract(0.5 + 0.61803399 * view.offset.z);
    for (int i = 0; i < looks; ++i) {
        float t = drawn_place(fall, length_m, (float(i) + lot) / float(looks));
        sum += lit_share(land_shadow, view, part, from_m + t, below);
    }
    return sum / float(looks);
}
#endif

// Radiance that the water itself scatters towards the eye along a part, between two places of it.
//
//   water_m  path in the water before the part
//   focus    of the sun's light, in the mean over the way
vec3 scattered_radiance(Part part, float from_m, float to_m, float water_m, float focus) {
    float sink = -part.direction.z, depth = max(depth_of(part) + sink * from_m, 0.0), length_m = to_m - from_m;
    vec3 below = sun_below(view.sun.xyz, view.optics.x);
#ifdef TARN_LAND_SHADOW
#if defined(TARN_SHAFTS) && TARN_SHAFTS > 0
    if (from_m > 0.0) // what begins at the eye has it from passes/sunlit.comp
#endif
        focus *= lit_way(part, from_m, length_m, below);
#endif
    vec3 scattered = path_radiance(water, view.water, 1.0 / below.z, depth, sink, water_m + from_m, length_m);
    vec3 skylight = path_radiance(water, view.water, sky_slant, depth, sink, water_m + from_m, length_m);
#ifdef TARN_GLOW
    float off_beam = atan(length(cross(part.direction, below)), dot(part.direction, below));
    scattered += glow_radiance(glow, view.water, view.optics.w, 1.0 / below.z, depth, sink, water_m + from_m,
                               length_m, off_beam);
    float off_vertical = acos(clamp(part.direction.z, -1.0, 1.0));
    skylight += glow_radiance(sky_glow, view.water, view.optics.w, sky_glow_slant(off_vertical), depth, sink,
                              water_m + from_m, length_m, off_vertical);
#endif
    return focus * sun_irradiance_below(below) * scattered +
           view.sky_irradiance.rgb * (view.optics.z * sky_slant) * skylight;
}

// Up to where the water's own light is summed. What lies before a rasterised thing and what lies behind it are to be as
// bright together as the water without it, and the glow's sums are not as exact as that: all is taken, and of it what is
// hidden taken off (overlay_radiance).
float scattered_to(Part part, End end) {
#ifdef TARN_GLOW
    return (end.flags & end_overlay) != 0u ? max(reach(view, part), end.t) : end.t;
#else
    return end.t;
#endif
}

// What is seen of something rasterised in the water: it is drawn by the light that was not scattered on the way. What
// was scattered forwards is a blur of all that lies there, and for things that are small that is the water around them.
vec3 overlay_radiance(Part part, End end, vec3 radiance) {
    if (!part.in_water)
        return radiance;
    vec3 drawn = image_transmittance(water, view.water, end.t);
    float blurred = 1.0 - drawn_share(drawn, end.t);
#ifdef TARN_GLOW
    blurred -= 1.0;
#endif
    return drawn * radiance + blurred * scattered_radiance(part, end.t, max(reach(view, part), end.t), 0.0, 1.0);
}

// What is left in its place of light from above the water: what was scattered forwards glows around it.
vec3 seen_through(float water_m) {
#ifdef TARN_GLOW
    return image_transmittance(water, view.water, water_m);
#else
    return transmittance(water, view.water, water_m);
#endif
}

// Radiance that a part brings to the eye, but for the split's factor and, in the air, the water before it.
//
//   before_m  length of the path before the part
//   water_m   as much of it as lay in the water
vec3 part_radiance(Part part, End end, float before_m, float water_m, Sunlit sunlit) {
    vec3 radiance = vec3(0.0);
    if (part.in_water)
        radiance = scattered_radiance(part, 0.0, scattered_to(part, end), water_m, sunlit.way);
#ifdef TARN_LAMP
    if (part.in_water && before_m == 0.0)
        radiance += lamp_scattered(part.direction, end.t);
#endif
    if ((end.flags & end_ground) != 0u) {
        radiance += ground_radiance(part, end, before_m + end.t, water_m + end.t, sunlit);
#ifdef TARN_HAZE
        if (!part.in_water)
            radiance = through_air(part, end.t, radiance);
#endif
    } else if ((end.flags & (end_surface | end_overlay)) == 0u && !part.in_water)
        radiance += sky(part.direction);
    return radiance;
}

#ifdef TARN_SPACE_LINES
// What a line or point in space shows of itself. As a sign it is as bright wherever it is, as a matte thing it is lit by
// a sun that shines from anywhere, with no shadows, and seen in the water by the light that is not scattered on the
// way, for it is small.
//
//   mark     its share of the pixel is made less by the water
//   water_m  path in the water before the part
vec3 mark_radiance(Part part, inout SpaceMark mark, float before_m, float water_m, Sunlit sunlit) {
    if (view.diver.w > 0.0)
        return layer_colour * inverse_pi * view.diver.w;
    vec3 sky_light = view.sky_irradiance.rgb, sun_light = view.sun_irradiance.rgb;
    if (!part.in_water) {
        vec3 radiance = layer_colour * inverse_pi * 0.5 * (sky_light + max(view.sun.z, 0.0) * sun_light);
#ifdef TARN_HAZE
        radiance = through_air(part, mark.t, radiance);
#endif
        return radiance;
    }
    float depth = max(depth_of(part) - part.direction.z * mark.t, 0.0), way_m = water_m + mark.t;
    vec3 below = sun_below(view.sun.xyz, view.optics.x);
    vec3 irradiance = 0.5 * (sky_light * view.optics.z * transmittance(water, view.water, sky_slant * depth + way_m) +
                             below.z * sun_irradiance_below(below) * transmittance(water, view.water, depth / below.z + way_m));
#ifdef TARN_LAMP
    if (before_m == 0.0)
        irradiance += 0.5 * lamp_intensity(part.direction) * transmittance(water, view.water, 2.0 * mark.t) /
                      (mark.t * mark.t + view.diver.z * view.diver.z);
#endif
    mark.cover *= drawn_share(image_transmittance(water, view.water, way_m), way_m);
    return layer_colour * inverse_pi * irradiance + scattered_radiance(part, 0.0, mark.t, water_m, sunlit.way);
}

// Does a part show lines in space, cut by the water's level?
SpaceMark mark_before(Part part, float end_m, float before_m) {
    if (view.exposed.z == (part.in_water ? 1.0 : 2.0))
        return SpaceMark(far_m, 0.0);
    return mark_on(view, part, end_m, before_m);
}
#endif

#ifdef TARN_WAVES
// Slopes of a wavy surface inside a pixel, and what they do to light from above, in the mean over those that
// face the viewer. Facets that hide each other are left to the even chance of each (Smith 1967's assumption).
struct Glitter {
    vec3 sky;      // radiance of the sky mirrored, reflectance in it
    float mirror;  // mean reflectance
    vec3 sun;      // radiance of the sun mirrored
    float seen;    // mean projected size of the facets
};

Glitter glitter_of(Part first, End end, WaveSurface surface) {
    vec3 direction = direction_after(view, first, end.t), to_viewer = -direction;
    bool schlick = on(TARN_FLAG_SCHLICK);
    float eta = 1.0 / view.optics.x, seen = 0.0;
    Glitter g = Glitter(vec3(0.0), 0.0, vec3(0.0), 0.0);
    VisibleSlopes visible = visible_slopes(to_viewer, surface.mean, surface.taken);
    for (int k = 0; k < slopes_along * slopes_across; ++k) {
        float share;
        vec3 normal = normal_of_slope(visible_slope(visible, to_viewer, k / slopes_across, k % slopes_across, share));
        float cosine = clamp(dot(to_viewer, normal), 0.0, 1.0);
        float mirror = schlick ? fresnel_schlick(cosine, eta) : fresnel_dielectric(cosine, eta);
        vec3 reflected = direction + 2.0 * cosine * normal;
        reflected.z = abs(reflected.z);
        seen += share;
        g.mirror += share * mirror;
        g.sky += share * mirror * sky_radiance(soft_sky, reflected, view.sun.xyz);
    }
    float least = max(seen, 1e-4);
    g.mirror = seen > 0.0 ? g.mirror / least : 1.0;
    g.sky /= least;
    g.seen = least;
    if (on(TARN_FLAG_SUN_DISC) && view.sun.z > 0.0 && ((end.flags & end_lit) != 0u || !on(TARN_FLAG_SHADOWS))) {
        // Cox & Munk 1954: the share of facets that throw the sun into the eye. The sun's own width, seen in a
        // mirror, is half of it in slope.
        vec3 halfway = normalize(to_viewer + view.sun.xyz);
        vec2 needed = -halfway.xy / halfway.z;
        float width = 0.0625 * view.sun.w * view.sun.w;
        float chance = slope_density(needed - surface.mean, surface.taken + vec3(width, 0.0, width));
        float cosine = clamp(dot(to_viewer, halfway), 0.0, 1.0);
        float mirror = schlick ? fresnel_schlick(cosine, eta) : fresnel_dielectric(cosine, eta);
        float up2 = halfway.z * halfway.z;
        g.sun = view.sun_irradiance.rgb * (mirror * chance / (4.0 * up2 * up2 * least));
    }
    return g;
}
#endif

#ifdef TARN_MAP
// Radiance of the surface as a matte sheet in the colour of the depth below it.
vec3 depth_sheet(Part part, End end) {
    vec4 corners = textureGather(heights, (vec2(end.cell) + 1.0) * view.inverse_size.xy, 0) * view.heights.y;
    float level = surface_level(heights, view, part, end);
    float z = bilinear(corners, end.inside);
    vec3 albedo = depth_colour((level - z) / view.map.z);
    vec2 gradient = ground_gradient(heights, view.grid.xy, end.cell, end.inside, view.heights.y);
    albedo = marked(albedo, vec2(end.cell) + end.inside, z, true, level, length(gradient) / view.grid.z,
                    view.camera.w * end.t);
    // As if nothing stood in the sun's way, and no brighter than land: a map is to be read.
    vec3 irradiance = 0.35 * (view.sky_irradiance.rgb + max(view.sun.z, 0.0) * view.sun_irradiance.rgb);
    return albedo * inverse_pi * irradiance;
}
#endif

// What is left of a change: one sample's land may hide more sky than there is in the mean.
vec3 no_darker_than_nothing(vec3 radiance, vec3 change) { return max(change, -max(radiance, vec3(0.0))); }

#ifdef TARN_SPACE_LINES
const bool lines_hang = true;
#else
const bool lines_hang = false;
#endif

// A pixel's light, but for what a wavy surface mirrors of the land instead of the sky.
struct Shaded {
    bool mine; // there is something to store
    vec3 radiance;
};

#ifdef TARN_SHARED_LAND
// One facet a sample says whether land or sky is mirrored: a coin that is tossed. Pixels around that have the same
// facets have tossed it, too; each takes the mean of theirs, by how likely their slopes are its own.
const int share_reach = 2;
shared vec4 shared_land[64];  // xyz: what land changes, w: spread of slopes, 0: does not glitter
shared uint shared_means[64]; // mean slopes, as halves
shared uint shared_any;       // is there land to be shared?

void share_land(vec3 land, vec2 mean, float spread) {
    uint i = gl_LocalInvocationIndex;
    shared_land[i] = vec4(land, spread);
    shared_means[i] = packHalf2x16(mean);
    if (any(notEqual(land, vec3(0.0))))
        shared_any = 1u;
}

vec3 land_around() {
    uint own = gl_LocalInvocationIndex;
    float own_spread = shared_land[own].w;
    if (shared_any == 0u || own_spread == 0.0)
        return vec3(0.0);
    vec2 own_mean = unpackHalf2x16(shared_means[own]);
    ivec2 here = ivec2(gl_LocalInvocationID.xy);
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    ivec2 low = max(here - share_reach, ivec2(0)), high = min(here + share_reach, ivec2(7));
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
            vec4 other = shared_land[y * 8 + x];
            vec2 off = unpackHalf2x16(shared_means[y * 8 + x]) - own_mean;
            if (other.w == 0.0)
                continue;
            float weight = max(1.0 - dot(off, off) / (own_spread + other.w), 1e-3);
            sum += weight * other.xyz;
            weights += weight;
        }
    return sum / weights;
}
#endif

Shaded shade_pixel(ivec2 local, ivec2 pixel) {
    Shaded shaded = Shaded(false, vec3(0.0));
    if (any(greaterThanEqual(local, view.tile.zw)))
        return shaded;
    Part first = camera_part(view, pixel);
    if (left_out(view, first))
        return shaded;
    shaded.mine = true;
    End first_end = unpack_end(imageLoad(hits[0], local));
    Sunlit sunlit = Sunlit(1.0, 1.0);
#ifdef TARN_CAUSTICS
    if (first.in_water)
        sunlit = sunlit_of(local, 0);
#endif
    vec3 radiance = part_radiance(first, first_end, 0.0, 0.0, sunlit);
    float water_m = first.in_water ? first_end.t : 0.0;
    vec3 remaining = first.in_water ? seen_through(water_m) : vec3(1.0); // of light from above the water
    if ((first_end.flags & end_overlay) != 0u)
        radiance += overlay_radiance(first, first_end, texelFetch(overlay, pixel, 0).rgb);
    bool sheet = false; // the water shows its depth instead of itself
#ifdef TARN_MAP
    if ((first_end.flags & end_surface) != 0u && !first.in_water && view.map.z > 0.0) {
        sheet = true;
        radiance += depth_sheet(first, first_end);
    }
#endif
    if ((first_end.flags & end_surface) != 0u && !sheet) {
#ifdef TARN_WAVES
        WaveSurface met = unpack_surface(imageLoad(surfaces, local));
        float level = surface_level(heights, view, first, first_end);
        Glitter glitter;
        bool wavy = !first.in_water && !at_cut(view, first, first_end, level);
        if (wavy)
            glitter = glitter_of(first, first_end, met);
#else
        Surface surface = calm_surface(heights, view, first, first_end);
#endif
        for (int number = 1; number < 3; ++number) {
#ifdef TARN_WAVES
            Surface surface = Surface(slope_of_part(met, number, first.in_water, lot_of(view, pixel), view.offset.z,
                                                    direction_after(view, first, first_end.t), view.optics.x), level);
#endif
            Part part = split_part(view, first, first_end, surface, number);
            if (!wanted(view, part, number))
                continue;
            End end = unpack_end(number == 1 ? imageLoad(hits[1], local) : imageLoad(hits[2], local));
            vec3 instead = vec3(0.0); // what this part's light takes the place of
            bool facet = false, met_land = (end.flags & end_ground) != 0u;
#ifdef TARN_WAVES
            if (wavy && number == 2) // drawn by what facets let through
                part.weight = (1.0 - glitter.mirror) / (view.optics.x * view.optics.x);
            // What facets mirror of sky and sun is known in the mean: one of them says only what stands before the sky.
            facet = wavy && number == 1;
            if (facet) {
                radiance += glitter.sky + glitter.sun;
                part.weight = met.bright / glitter.seen;
                if (met_land || lines_hang)
                    instead = sky_radiance(sky_table, part.direction, view.sun.xyz);
            }
#endif
#ifdef TARN_CAUSTICS
            if (part.in_water)
                sunlit = sunlit_of(local, first.in_water ? 1 : 0);
#endif
            vec3 brought = facet && !met_land ? instead : part_radiance(part, end, first_end.t, water_m, sunlit);
#ifdef TARN_SPACE_LINES
            SpaceMark mark = mark_before(part, end.t, first_end.t);
            if (mark.cover > 0.0) {
                vec3 marked_so = mark_radiance(part, mark, first_end.t, water_m, sunlit);
                brought = mix(brought, marked_so, mark.cover);
            }
#endif
            brought = part.weight * (brought - instead);
            if (!part.in_water && first.in_water)
                brought *= remaining;
#ifdef TARN_SHARED_LAND
            if (facet) {
                share_land(brought, met.mean, met.taken.x + met.taken.z + 1e-6);
                continue;
            }
#endif
            radiance += facet ? no_darker_than_nothing(radiance, brought) : brought;
        }
    }
    shaded.radiance = radiance;
    return shaded;
}

void main() {
    ivec2 local = ivec2(gl_GlobalInvocationID.xy), pixel = pixel_of(view, local);
#ifdef TARN_SHARED_LAND
    shared_land[gl_LocalInvocationIndex] = vec4(0.0);
    shared_means[gl_LocalInvocationIndex] = 0u;
    if (gl_LocalInvocationIndex == 0u)
        shared_any = 0u;
    barrier();
#endif
    Shaded own = shade_pixel(local, pixel);
#ifdef TARN_SHARED_LAND
    barrier();
    own.radiance += no_darker_than_nothing(own.radiance, land_around());
#endif
    if (!own.mine)
        return;
    vec3 radiance = own.radiance;
#if defined(TARN_HAZE) || defined(TARN_SPACE_LINES)
    Part first = camera_part(view, pixel);
    End first_end = unpack_end(imageLoad(hits[0], local));
#endif
#ifdef TARN_HAZE
    if (!first.in_water && (first_end.flags & (end_surface | end_overlay)) != 0u)
        radiance = through_air(first, first_end.t, radiance);
#endif
#ifdef TARN_SPACE_LINES
    SpaceMark mark = mark_before(first, first_end.t, 0.0);
    if (mark.cover > 0.0) {
        Sunlit sunlit = Sunlit(1.0, 1.0);
#ifdef TARN_CAUSTICS
        if (first.in_water)
            sunlit = sunlit_of(local, 0);
#endif
        vec3 marked_so = mark_radiance(first, mark, 0.0, 0.0, sunlit);
        radiance = mix(radiance, marked_so, mark.cover);
    }
#endif
    radiance *= view.options.w;
    if (view.offset.z > 0.5)
        radiance += imageLoad(radiance_image, pixel).rgb;
    imageStore(radiance_image, pixel, vec4(radiance, 1.0));
}
