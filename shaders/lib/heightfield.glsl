// lib/heightfield.glsl — what every way of finding a ray's first hit shares: the field, rays, the part of a
// ray that can meet anything, and the exact answer inside one cell. The ways themselves are in lib/walks/,
// one a file, each a function trace_field(); passes include lib/walk.glsl, which the program replaces by
// the one chosen.
// Pure functions; samplers are parameters. C++ twin: src/reference/heightfield.hpp
//
// Surface  bilinear between nodes (Ramsey, Potter & Hansen 2004 solve the same patch). Four texels are
//          gathered and interpolated in float: hardware filters have 8-bit weights.
// Borders  Neighbouring cells share their nodes, and a ray found below the surface where it enters a
//          cell counts as a hit there: nothing slips through a border.

#include "shared/view_block.h"

struct Field {
    ivec2 cells;       // nodes minus one
    vec2 nodes;        // as floats
    vec2 texel;        // one over them
    vec2 ground_m;     // x: height of code 0, y: metres per code
    vec2 water_m;      // the same for the water
    float top_m;       // no node is higher
    float bottom_m;    // of the block of earth, below all nodes
    float spacing_m;   // between nodes
    int root;          // maximum mipmap: level whose one block covers the field
    int shift;         // cone map: blocks of 2^shift cells a side
    vec2 cone_m;       // cone map: metres per unit texel, of the ground's (x) and the surface's (y)
    float setting;     // of methods that have one: steps, or rays' least stride
};

// field_of — the field that a view block describes.
Field field_of(ViewBlock view) {
    return Field(ivec2(view.grid.xy) - 1, view.grid.xy, 1.0 / view.grid.xy, vec2(0.0, view.heights.y / 65535.0),
                 vec2(view.heights.z, view.heights.w / 65535.0),
                 view.grid.w, view.forward.w, view.grid.z, view.walk.x, view.walk.y, view.bounds.xy, view.bounds.z);
}

// Origin and direction per metre of path: columns, rows, height. Columns and rows count from the
// node `base`, near the origin: whole nodes stay whole numbers, and float32 holds what is left to a
// ten-millionth of the distance travelled, wherever in the field the ray starts.
struct Ray {
    ivec2 base;
    vec3 origin;
    vec3 direction;
    float begin;    // metres along it: nothing is met before
};

struct Hit {
    float t;      // metres along the ray
    bool water;   // of the water's surface, else of the ground
    ivec2 cell;
    vec2 inside;  // position in the cell, [0, 1]
};

// ray_from — a ray from node `base` + origin.xy (columns, rows) at height origin.z.
//
//   direction  scene axes (x east, y north), unit
Ray ray_from(ivec2 base, vec3 origin, vec3 direction, float spacing_m) {
    vec2 whole = floor(origin.xy);
    return Ray(base + ivec2(whole), vec3(origin.xy - whole, origin.z),
               vec3(direction.x / spacing_m, -direction.y / spacing_m, direction.z), 0.0);
}

// bilinear — heights in gather order (0,1) (1,1) (1,0) (0,0), columns and rows.
float bilinear(vec4 h, vec2 p) {
    vec2 west_east = mix(h.wz, h.xy, p.y);
    return mix(west_east.x, west_east.y, p.x);
}

// twist — how far the fourth corner is out of the plane of the others: the coefficient of u v.
float twist(vec4 h) { return h.w - h.z - h.x + h.y; }

// first_crossing — where f(s) = a s^2 + b s + c first falls to 0 in [0, 1], given f(0) = above and
//                  f(1) = below; 2 if it does not.
//
//   curve  the quadratic coefficient a. Stable for a -> 0 and near-double roots: the root is taken
//          from whichever form of the formula does not subtract like numbers.
float first_crossing(float above, float below, float curve) {
    if (above <= 0.0)
        return 0.0;
    float b = below - above - curve;
    if (below > 0.0 && !(curve > 0.0 && b < 0.0 && -b < 2.0 * curve))
        return 2.0; // above at both ends, and no dip between them
    float discriminant = b * b - 4.0 * curve * above;
    if (discriminant < 0.0)
        return below > 0.0 ? 2.0 : 1.0;
    // f falls through its first root, so the slope there, -sqrt(discriminant), is negative:
    // s = 2c / (-b + sqrt(D)) for b < 0, and (-b - sqrt(D)) / 2a for b > 0 (then a < 0).
    float root = sqrt(discriminant);
    float s = b <= 0.0 ? 2.0 * above / (root - b) : -(b + root) / (2.0 * curve);
    return below > 0.0 && s > 1.0 ? 2.0 : clamp(s, 0.0, 1.0);
}

// The part of a ray that can meet something, and what its walk needs again and again.
struct Span {
    vec2 o, d;        // columns and rows; no component of d is 0
    vec2 inverse;     // 1 / d
    float oz, dz;     // height
    float t, t_end;   // begin and end [m]
    float slack;      // rounding of oz + t dz anywhere in the span [m], doubled
    ivec2 ahead;      // 1 where a cell's far border is the upper one, else 0
    ivec2 stride;     // +1 or -1
};

// clip_ray — cut to the field's sides, its highest node and the bottom of the block of earth.
//
//   returns  false if nothing is left
bool clip_ray(Field field, Ray ray, float t_max, out Span span) {
    vec2 o = ray.origin.xy, d = ray.direction.xy;
    float oz = ray.origin.z, dz = ray.direction.z;
    // A ray that never leaves its column or row creeps: 1e-12 cells a metre change no answer, and it is
    // over the field at once or, for all purposes, never.
    d = vec2(abs(d.x) < 1e-12 ? 1e-12 : d.x, abs(d.y) < 1e-12 ? 1e-12 : d.y);
    vec2 inverse = 1.0 / d;
    vec2 t_low = (vec2(-ray.base) - o) * inverse, t_high = (vec2(field.cells - ray.base) - o) * inverse;
    vec2 t_first = min(t_low, t_high), t_last = max(t_low, t_high);
    float t = max(ray.begin, max(t_first.x, t_first.y));
    float t_end = min(t_max, min(t_last.x, t_last.y));
    // Nothing is higher than the highest node or lower than the bottom. The slab is widened by the
    // rounding of oz + t dz: ground is only passed over if it is missed by more than this.
    float slack = 3e-7 * (abs(oz) + abs(dz) * max(t_end, 0.0)) + 1e-6;
    float to_top = field.top_m + slack - oz, to_bottom = field.bottom_m - oz;
    if (abs(dz) > 1e-12) {
        float rise = 1.0 / dz;
        float t_top = to_top * rise, t_bottom = to_bottom * rise;
        t = max(t, min(t_top, t_bottom));
        t_end = min(t_end, max(t_top, t_bottom));
    } else if (to_top < 0.0 || to_bottom > 0.0) {
        return false;
    }
    slack = 3e-7 * (abs(oz) + abs(dz) * max(t_end, 0.0)) + 1e-6;
    ivec2 ahead = ivec2(greaterThan(d, vec2(0.0)));
    span = Span(o, d, inverse, oz, dz, t, t_end, slack, ahead, 2 * ahead - 1);
    return t < t_end;
}

// cell_at — the cell over which a ray is after t metres; the nearest one of the field.
ivec2 cell_at(Field field, Ray ray, Span span, float t) {
    return clamp(ivec2(floor(span.o + t * span.d)) + ray.base, ivec2(0), field.cells - 1);
}

// borders — path lengths at which the ray leaves a block of cells through its sides across columns
//           and across rows; blocks are 2^shift cells a side.
vec2 borders(Ray ray, Span span, ivec2 block, int shift) {
    return (vec2(((block + span.ahead) << shift) - ray.base) - span.o) * span.inverse;
}

// meet_cell — first hit within one cell, between path lengths t and t_out.
//
//   codes    R32UI view of the heights: ground in the lower 16 bits, water in the upper ones, so that
//            one gather fetches both surfaces' four nodes
//   wet      whether there may be water to stop at
//   returns  true with `hit` filled in
bool meet_cell(usampler2D codes, Field field, Ray ray, Span span, ivec2 cell, float t, float t_out, bool wet,
               out Hit hit) {
    // Corners in gather order: (0,1) (1,1) (1,0) (0,0), columns and rows.
    uvec4 code = textureGather(codes, (vec2(cell) + 1.0) * field.texel);
    vec4 ground = vec4(code & 0xffffu) * field.ground_m.y + field.ground_m.x;
    float highest = max(max(ground.x, ground.y), max(ground.z, ground.w));
    code >>= 16;
    wet = wet && all(greaterThan(code, uvec4(0u)));
    vec4 water = vec4(0.0);
    if (wet) {
        water = vec4(code) * field.water_m.y + field.water_m.x;
        highest = max(highest, max(max(water.x, water.y), max(water.z, water.w)));
    }
    float z_in = span.oz + t * span.dz, z_out = span.oz + t_out * span.dz;
    if (min(z_in, z_out) > highest + span.slack)
        return false;
    vec2 corner = vec2(cell - ray.base);
    vec2 p_in = clamp(span.o + t * span.d - corner, 0.0, 1.0);
    vec2 p_out = clamp(span.o + t_out * span.d - corner, 0.0, 1.0);
    vec2 run = p_out - p_in;
    float bend = -run.x * run.y;
    float s = first_crossing(z_in - bilinear(ground, p_in), z_out - bilinear(ground, p_out), bend * twist(ground));
    bool at_water = false;
    if (wet) {
        float s_water = first_crossing(z_in - bilinear(water, p_in), z_out - bilinear(water, p_out), bend * twist(water));
        at_water = s_water < s;
        s = min(s, s_water);
    }
    if (s > 1.0)
        return false;
    hit = Hit(t + s * max(t_out - t, 0.0), at_water, cell, p_in + s * run);
    return true;
}
