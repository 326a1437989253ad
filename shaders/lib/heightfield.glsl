// lib/heightfield.glsl — what every way of finding a ray's first hit shares: the field, rays, the part of a
// ray that can meet anything, and the exact answer inside one cell. The ways themselves are in lib/walks/,
// one a file, each a function trace_field(); passes include lib/walks/chosen.glsl, where the program puts the
// one asked for.
// Pure functions; samplers are parameters. C++ twin: src/reference/heightfield.hpp
//
// Surface  bilinear between nodes (Ramsey, Potter & Hansen 2004 solve the same patch). Four texels are
//          gathered and interpolated in float: hardware filters have 8-bit weights.
// Borders  Neighbouring cells share their nodes, and a ray found below the surface where it enters a
//          cell counts as a hit there: nothing slips through a border.

#include "shared/view_block.h"

// Heights inside the walks are in units of a texel (0 to 1 over the ground's 16 bits), so that what is
// fetched needs no conversion.
struct Field {
    vec2 cells;        // nodes minus one
    vec2 texel;        // one over the nodes
    float per_m;       // units a metre
    vec2 water;        // water texel -> units: x offset, y factor
    float top;         // no node is higher
    float bottom;      // of the block of earth, below all nodes
    float lowest;      // ground
    float water_top;   // no water is higher
    float per_spacing; // nodes a metre
    int root;          // maximum mipmap: level whose one block covers the field
    int shift;         // cone map: blocks of 2^shift cells a side
    vec2 cone;         // cone map texel -> units, of the ground's (x) and the surface's (y)
    vec2 slope;        // its steepest slopes, units a cell
    float setting;     // of methods that have one: steps, or rays' least stride
    float bend;        // 1/m: level ground falls by this times the squared distance (src/scene/curvature.hpp)
    float pixel;       // width of a pixel, cells a metre of path
};

// field_of — the field that a view block describes.
Field field_of(ViewBlock view) {
    return Field(view.grid.xy - 1.0, view.inverse_size.xy, view.units.x, view.units.yz, view.units.w, view.bounds.w,
                 view.slab.x, view.slab.y, view.base.z, view.walk.x, view.walk.y, view.bounds.xy, view.slab.zw, view.bounds.z,
                 view.base.w, view.camera.w * view.base.z);
}

// Origin and direction per metre of path: columns, rows, height [m]. Columns and rows count from the
// node `base`, near the origin: whole nodes stay whole numbers (floats hold them up to 2^24), and what is
// left is held to a ten-millionth of the distance travelled, wherever in the field the ray starts.
struct Ray {
    vec2 base;
    vec3 origin;
    vec3 direction;
    float begin;    // metres along it: nothing is met before
    float bend;     // 1/m: how it rises above its first direction over level ground (air_ray), 0 in water
};

struct Hit {
    float t;      // metres along the ray
    bool water;   // of the water's surface, else of the ground
    ivec2 cell;
    vec2 inside;  // position in the cell, [0, 1]
};

// ray_from — a ray from node `base` + origin.xy (columns, rows) at height origin.z; a straight one.
//
//   direction  scene axes (x east, y north), unit
Ray ray_from(Field field, vec2 base, vec3 origin, vec3 direction) {
    return Ray(base, origin, vec3(direction.x * field.per_spacing, -direction.y * field.per_spacing, direction.z), 0.0, 0.0);
}

// air_ray — the same through air, which may go for kilometres. Heights count from level ground, which falls away
//           below a line of sight: in such heights the line is a parabola. Only programs with TARN_CURVED know of it.
Ray air_ray(Field field, vec2 base, vec3 origin, vec3 direction) {
    Ray ray = ray_from(field, base, origin, direction);
    ray.bend = field.bend * dot(direction.xy, direction.xy);
    return ray;
}

// climb_of — metres of height a metre of path after t metres.
float climb_of(Ray ray, float t) {
#ifdef TARN_CURVED
    return ray.direction.z + 2.0 * ray.bend * t;
#else
    return ray.direction.z;
#endif
}

// bilinear — heights in gather order (0,1) (1,1) (1,0) (0,0), columns and rows.
float bilinear(vec4 h, vec2 p) {
    return h.w + p.x * (h.z - h.w) + p.y * ((h.x - h.w) + p.x * ((h.y - h.x) - (h.z - h.w)));
}

// twist — how far the fourth corner is out of the plane of the others: the coefficient of u v.
float twist(vec4 h) { return (h.y - h.x) - (h.z - h.w); }

// A surface along a ray through one cell: f(s) = curve s^2 + b s + above is the height of the ray above it
// at the fraction s of the way from border to border; below = f(1).
struct Gap {
    float above, below, curve;
};

// crosses — whether f falls to 0 anywhere in [0, 1]; from above at both ends it must dip between them.
bool crosses(Gap f) {
    float b = f.below - f.above - f.curve;
    return min(f.above, f.below) <= 0.0 || (b < 0.0 && -b < 2.0 * f.curve && b * b >= 4.0 * f.curve * f.above);
}

// first_crossing — the first s in [0, 1] at which f is 0; 2 if there is none.
//
//   Stable for curve -> 0 and near-double roots: the root is taken from whichever form of the formula
//   does not subtract like numbers. f falls through its first root, so the slope there is
//   -sqrt(discriminant): s = 2c / (-b + sqrt(D)) for b < 0, (-b - sqrt(D)) / 2a for b > 0 (then a < 0).
float first_crossing(Gap f) {
    if (!crosses(f))
        return 2.0;
    float b = f.below - f.above - f.curve;
    float root = sqrt(max(b * b - 4.0 * f.curve * f.above, 0.0));
    float s = (b <= 0.0 ? 2.0 * f.above : -b - root) / (b <= 0.0 ? root - b : 2.0 * f.curve);
    return f.above <= 0.0 ? 0.0 : clamp(s, 0.0, 1.0); // nan, from 0 / 0, counts as 0
}

// The part of a ray that can meet something, and what its walk needs again and again.
struct Span {
    vec2 o, d;        // columns and rows from ray.base; no component of d is 0
    vec2 inverse;     // 1 / d
    float oz, dz;     // height in units, and per metre
    float t, t_end;   // begin and end [m]
    float slack;      // rounding of height_at() anywhere in the span, doubled
    vec2 ahead;       // 1 where a cell's far border is the upper one, else 0
    vec2 low, high;   // first and last cell of the field, from ray.base
    float bend;       // of the ray, in units
};

// height_at — of a ray after t metres [units].
float height_at(Span span, float t) {
#ifdef TARN_CURVED
    return span.oz + t * (span.dz + t * span.bend);
#else
    return span.oz + t * span.dz;
#endif
}

// climb_at — how fast it climbs there [units a metre]. A curved ray stays above its tangent: what the tangent clears,
//            the ray clears.
float climb_at(Span span, float t) {
#ifdef TARN_CURVED
    return span.dz + 2.0 * t * span.bend;
#else
    return span.dz;
#endif
}

// sag_between — how far a ray's chord between two path lengths stands above it, times four [units]: of a Gap's curve.
float sag_between(Span span, float t, float t_out) {
#ifdef TARN_CURVED
    return span.bend * (t_out - t) * (t_out - t);
#else
    return 0.0;
#endif
}

// lowest_between — no more than the ray's height anywhere between two path lengths.
float lowest_between(Span span, float t, float t_out) {
#ifdef TARN_CURVED
    return height_at(span, t) + min(climb_at(span, t), 0.0) * (t_out - t);
#else
    return span.oz + (span.dz < 0.0 ? t_out : t) * span.dz;
#endif
}

#ifdef TARN_CURVED
// passes_height — path lengths at which a ray passes a height that it starts `above`, as it falls (x, never: far) and as
//                 it rises (y).
vec2 passes_height(float above, float dz, float bend) {
    const float never = 1e30;
    float d = dz * dz - 4.0 * bend * above;
    if (d < 0.0)
        return vec2(never);
    float root = sqrt(d), q = dz < 0.0 ? 0.5 * (root - dz) : min(-0.5 * (root + dz), -1e-30);
    float near = above / q, far = dz < 0.0 ? q / max(bend, 1e-30) : never;
    return dz < 0.0 ? vec2(above > 0.0 ? near : never, far) : vec2(never, above < 0.0 ? near : never);
}
#endif

// clip_ray — cut to the field's sides, its highest node and the bottom of the block of earth.
//
//   returns  false if nothing is left
bool clip_ray(Field field, Ray ray, float t_max, out Span span) {
    vec2 o = ray.origin.xy, d = ray.direction.xy;
    float oz = ray.origin.z * field.per_m, dz = ray.direction.z * field.per_m;
    vec2 low = -ray.base, high = field.cells - ray.base;
    // A ray that never leaves its column or row must be over the field (on its border, give or take
    // rounding); it creeps inwards by 1e-12 cells a metre, which changes no answer.
    bvec2 still = lessThan(abs(d), vec2(1e-12));
    vec2 within = clamp(o, low, high);
    if (any(greaterThan(mix(vec2(0.0), abs(o - within), still), vec2(1e-6))))
        return false;
    o = mix(o, within, still);
    d = mix(d, mix(vec2(1e-12), vec2(-1e-12), greaterThan(2.0 * o, low + high)), still);
    vec2 inverse = 1.0 / d;
    vec2 t_low = (low - o) * inverse, t_high = (high - o) * inverse;
    vec2 t_first = min(t_low, t_high), t_last = max(t_low, t_high);
    float t = max(ray.begin, max(t_first.x, t_first.y));
    float t_end = min(t_max, min(t_last.x, t_last.y));
    // Nothing is higher than the highest node or lower than the bottom. The slab is widened by the
    // rounding of oz + t dz: ground is only passed over if it is missed by more than this.
    float slack = 3e-7 * (abs(oz) + abs(dz) * max(t_end, 0.0)) + 1e-6 * field.per_m;
    float to_top = field.top + slack - oz, to_bottom = field.bottom - oz, bend = 0.0;
#ifdef TARN_CURVED
    bend = ray.bend * field.per_m;
    vec2 top_at = passes_height(-to_top, dz, bend), bottom_at = passes_height(-to_bottom, dz, bend);
    if (to_top < 0.0)
        t = max(t, top_at.x);
    t_end = min(t_end, top_at.y);
    if (to_bottom > 0.0)
        t = max(t, bottom_at.y);
    else
        t_end = min(t_end, bottom_at.x);
#else
    if (abs(ray.direction.z) > 1e-12) {
        float rise = 1.0 / dz;
        float t_top = to_top * rise, t_bottom = to_bottom * rise;
        t = max(t, min(t_top, t_bottom));
        t_end = min(t_end, max(t_top, t_bottom));
    } else if (to_top < 0.0 || to_bottom > 0.0) {
        return false;
    }
#endif
    slack = 3e-7 * (abs(oz) + (abs(dz) + bend * max(t_end, 0.0)) * max(t_end, 0.0)) + 1e-6 * field.per_m;
    span = Span(o, d, inverse, oz, dz, t, t_end, slack, vec2(greaterThan(d, vec2(0.0))), low, high - 1.0, bend);
    return t < t_end;
}

// cell_at — the cell over which a ray is after t metres, from ray.base; the nearest one of the field.
//           Rounds half a cell below to nearest, which costs two additions where floor() costs more;
//           on a border either cell will do.
vec2 cell_at(Span span, float t) {
    precise vec2 rounded = (span.o + t * span.d - 0.5) + 12582912.0;
    precise vec2 cell = rounded - 12582912.0;
    return clamp(cell, span.low, span.high);
}

// borders — path lengths at which the ray leaves a cell through its sides across columns and rows.
vec2 borders(Span span, vec2 cell) { return (cell + span.ahead - span.o) * span.inverse; }

// beyond — the next cell, given borders().
vec2 beyond(Span span, vec2 cell, vec2 t_border) {
    vec2 stride = 2.0 * span.ahead - 1.0;
    return t_border.x < t_border.y ? vec2(cell.x + stride.x, cell.y) : vec2(cell.x, cell.y + stride.y);
}

// Both surfaces along a ray through one cell.
struct Meeting {
    Gap ground, water;
    bool wet;       // is there water in the cell
    bool met;       // does the ray meet either surface
};

// beyond_square — the cell that a ray enters where it leaves the square of 2 radius - 1 cells around another,
//                 given the path lengths to the square's far sides. Never a cell behind on either axis:
//                 at a node two roundings could otherwise send a ray to and fro for ever.
vec2 beyond_square(Span span, vec2 cell, float radius, vec2 t_border, float t_out) {
    vec2 next = cell_at(span, t_out), stride = radius * (2.0 * span.ahead - 1.0);
    next = mix(min(next, cell), max(next, cell), span.ahead);
    return t_border.x < t_border.y ? vec2(cell.x + stride.x, next.y) : vec2(next.x, cell.y + stride.y);
}

// hit_at — a hit after t metres, wherever that is: for methods that find it by sampling.
Hit hit_at(Field field, Ray ray, Span span, float t, bool water) {
    vec2 cell = clamp(floor(span.o + t * span.d), span.low, span.high);
    return Hit(t, water, ivec2(cell + ray.base), clamp(span.o - cell + t * span.d, 0.0, 1.0));
}

// look_into — what a ray does in a cell, between path lengths t and t_out, t_out >= t (a ray on a grid line may
//             stand at the far border of the cell that it is taken to be in).
//
//   heights  RG16, ground and water; water 0 = none
//   cell     from ray.base
//   wet      whether there may be water to stop at
Meeting look_into(sampler2D heights, Field field, Ray ray, Span span, vec2 cell, float t, float t_out, bool wet) {
    // Corners in gather order: (0,1) (1,1) (1,0) (0,0), columns and rows.
    vec2 middle = (cell + ray.base + 1.0) * field.texel;
    vec4 ground = textureGather(heights, middle, 0);
    vec2 corner = span.o - cell;
    vec2 p_in = clamp(corner + t * span.d, 0.0, 1.0), p_out = clamp(corner + t_out * span.d, 0.0, 1.0);
    vec2 run = p_out - p_in;
    float bend = -run.x * run.y, z_in = height_at(span, t), z_out = height_at(span, t_out);
    Meeting m;
    float sag = sag_between(span, t, t_out);
    m.ground = Gap(z_in - bilinear(ground, p_in), z_out - bilinear(ground, p_out), bend * twist(ground) + sag);
    m.water = m.ground;
    m.wet = wet;
    m.met = crosses(m.ground);
    if (wet) {
        vec4 water = textureGather(heights, middle, 1);
        m.wet = min(min(water.x, water.y), min(water.z, water.w)) > 0.0;
        water = water * field.water.y + field.water.x;
        m.water = Gap(z_in - bilinear(water, p_in), z_out - bilinear(water, p_out), bend * twist(water) + sag);
        m.met = m.met || (m.wet && crosses(m.water));
    }
    return m;
}

// hit_of — where exactly, once it is known that a surface is met. Kept out of the loops: it costs a root
//          and a division, and happens once a ray.
Hit hit_of(Ray ray, Span span, Meeting m, vec2 cell, float t, float t_out) {
    float s = first_crossing(m.ground);
    bool at_water = false;
    if (m.wet) {
        float s_water = first_crossing(m.water);
        at_water = s_water < s;
        s = min(s, s_water);
    }
    t += s * max(t_out - t, 0.0);
    return Hit(t, at_water, ivec2(cell + ray.base), clamp(span.o - cell + t * span.d, 0.0, 1.0));
}
