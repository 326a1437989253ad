// lib/heightfield.glsl — first hit of a ray with the bilinear ground, and with the water above it.
// Pure functions; samplers are parameters. C++ twin: src/reference/heightfield.hpp
//
// Method   maximum mipmap (Tevs, Ihrke & Seidel 2008) with blocks of 4 x 4 children and the exact
//          bilinear patch in each cell (Ramsey, Potter & Hansen 2004): no step length, no epsilon to
//          creep by; cells are counted in integers, so every step leaves its block. Blocks of level
//          L cover 4^L x 4^L cells; level 0 is the cell itself, whose four nodes one gather fetches.
// Exact    A block is skipped only if the ray stays above its greatest node, raised by the rounding
//          of the ray's own height: a bilinear surface never exceeds its nodes. Neighbouring cells
//          share their nodes, and a ray found below the surface where it enters a cell counts as a
//          hit there: nothing slips through a border.
// Fails    at float32's limits only: beyond some 2^24 cells of distance, or where the ray is flatter
//          than the rounding of its height. Figures: docs/limits.md.

#include "shared/view_block.h"

struct Field {
    ivec2 cells;       // nodes minus one
    vec2 nodes;        // as floats
    vec2 texel;        // one over them
    vec2 ground_m;     // x: height of code 0, y: metres per unit texel
    vec2 water_m;      // the same for the water
    float top_m;       // no node is higher
    float bottom_m;    // of the block of earth, below all nodes
    int root;          // level whose one block covers the field
    int step_limit;    // the walk ends here whatever happens
};

// field_of — the field that a view block describes.
Field field_of(ViewBlock view) {
    return Field(ivec2(view.grid.xy) - 1, view.grid.xy, 1.0 / view.grid.xy, vec2(0.0, view.heights.y), view.heights.zw,
                 view.grid.w, view.forward.w, int(view.walk.x), int(view.walk.y));
}

// Origin and direction per metre of path: columns, rows, height. Columns and rows count from the
// node `base`, near the origin: whole nodes stay whole numbers, and float32 holds what is left to a
// ten-millionth of the distance travelled, wherever in the field the ray starts.
struct Ray {
    ivec2 base;
    vec3 origin;
    vec3 direction;
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
               vec3(direction.x / spacing_m, -direction.y / spacing_m, direction.z));
}

// bilinear — heights in gather order (0,1) (1,1) (1,0) (0,0), columns and rows.
float bilinear(vec4 h, vec2 p) {
    return mix(mix(h.w, h.z, p.x), mix(h.x, h.y, p.x), p.y);
}

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

// trace_field
//
//   heights     RG16, ground and water codes; water code 0 = none
//   maxima      RG32F, level L in mip level 2 (L - 1); red: ground, green: water (-1e30: none)
//   t_max       [m]; the walk ends there without a hit
//   with_water  stop at the water's surface too (only from above)
//   returns     true with `hit` filled in
bool trace_field(sampler2D heights, sampler2D maxima, Field field, Ray ray, float t_max,
                 bool with_water, out Hit hit) {
    vec2 o = ray.origin.xy;
    vec2 d = ray.direction.xy;
    vec2 low = vec2(-ray.base), high = vec2(field.cells - ray.base);
    bvec2 still = lessThan(abs(d), vec2(1e-12)); // never leaves its column or row: must be over the field
    if ((still.x && (o.x < low.x || o.x > high.x)) || (still.y && (o.y < low.y || o.y > high.y)))
        return false;
    d = mix(d, vec2(d.x < 0.0 ? -1e-12 : 1e-12, d.y < 0.0 ? -1e-12 : 1e-12),
            lessThan(abs(d), vec2(1e-12)));
    vec2 inverse = 1.0 / d;
    float oz = ray.origin.z, dz = ray.direction.z;

    vec2 t_low = (low - o) * inverse, t_high = (high - o) * inverse;
    vec2 t_first = min(t_low, t_high), t_last = max(t_low, t_high);
    float t = max(0.0, max(t_first.x, t_first.y));
    float t_end = min(t_max, min(t_last.x, t_last.y));
    // Rounding of oz + t dz: a block is only skipped if it is missed by more than this.
    float slack = 3e-7 * (abs(oz) + abs(dz) * max(t_end, 0.0)) + 1e-6;
    float ceiling = field.top_m + slack;
    if (dz < 0.0)
        t = max(t, (ceiling - oz) / dz);
    else if (oz > ceiling)
        return false;
    else if (dz > 0.0)
        t_end = min(t_end, (ceiling - oz) / dz);
    // Nor is there anything below the bottom.
    if (dz > 0.0)
        t = max(t, (field.bottom_m - oz) / dz);
    else if (oz < field.bottom_m)
        return false;
    else if (dz < 0.0)
        t_end = min(t_end, (field.bottom_m - oz) / dz);
    slack = 3e-7 * (abs(oz) + abs(dz) * max(t_end, 0.0)) + 1e-6;
    if (!(t < t_end))
        return false;

    ivec2 ahead = ivec2(greaterThan(d, vec2(0.0))); // 1 where the far border is the upper one
    ivec2 stride = 2 * ahead - 1;
    // Blocks of 64 cells to begin with: most rays would only descend through the larger ones. Those
    // that fly far climb to them by themselves.
    int level = min(field.root, 3);
    ivec2 block = clamp(ivec2(floor(o + t * d)) + ray.base, ivec2(0), field.cells - 1) >> (2 * level);
    bool near_water = false; // is there any water in the block of 4 x 4 cells

    for (int i = 0; i < field.step_limit; ++i) {
        vec2 border = vec2(((block + ahead) << (2 * level)) - ray.base);
        vec2 t_border = (border - o) * inverse;
        float t_out = min(min(t_border.x, t_border.y), t_end);
        float lowest = oz + (dz < 0.0 ? t_out : t) * dz;

        if (level > 0) {
            vec2 highest = texelFetch(maxima, block, 2 * (level - 1)).rg;
            float top = with_water ? max(highest.r, highest.g) : highest.r;
            if (lowest <= top + slack) {
                --level;
                near_water = with_water && highest.g > -1e29;
                ivec2 child = (ivec2(floor(o + t * d)) + ray.base) >> (2 * level);
                block = clamp(child, block * 4, block * 4 + 3);
                block = min(block, (field.cells - 1) >> (2 * level));
                continue;
            }
        } else {
            vec2 middle = (vec2(block) + 1.0) * field.texel;
            vec4 ground = textureGather(heights, middle, 0) * field.ground_m.y + field.ground_m.x;
            float highest = max(max(ground.x, ground.y), max(ground.z, ground.w));
            vec4 water = vec4(0.0);
            bool wet = false;
            if (near_water) {
                vec4 code = textureGather(heights, middle, 1);
                wet = all(greaterThan(code, vec4(0.0)));
                water = code * field.water_m.y + field.water_m.x;
                if (wet)
                    highest = max(highest, max(max(water.x, water.y), max(water.z, water.w)));
            }
            if (lowest <= highest + slack) {
                vec2 p_in = clamp(o + t * d - vec2(block - ray.base), 0.0, 1.0);
                vec2 p_out = clamp(o + t_out * d - vec2(block - ray.base), 0.0, 1.0);
                float z_in = oz + t * dz, z_out = oz + t_out * dz;
                vec2 run = p_out - p_in;
                float bend = -run.x * run.y;
                float s = first_crossing(z_in - bilinear(ground, p_in), z_out - bilinear(ground, p_out),
                                         bend * (ground.w - ground.z - ground.x + ground.y));
                bool at_water = false;
                if (wet) {
                    float s_water =
                        first_crossing(z_in - bilinear(water, p_in), z_out - bilinear(water, p_out),
                                       bend * (water.w - water.z - water.x + water.y));
                    at_water = s_water < s;
                    s = min(s, s_water);
                }
                if (s <= 1.0) {
                    hit.t = t + s * max(t_out - t, 0.0);
                    hit.water = at_water;
                    hit.cell = block;
                    hit.inside = p_in + s * run;
                    return true;
                }
            }
        }
        if (t_out >= t_end)
            return false;
        t = max(t, t_out);
        ivec2 next = block;
        if (t_border.x < t_border.y)
            next.x += stride.x;
        else
            next.y += stride.y;
        // Up one level whenever the parent is left; its number follows from the child's.
        if (level < field.root && (next >> 2) != (block >> 2)) {
            ++level;
            block = next >> 2;
        } else {
            block = next;
        }
    }
    return false;
}
