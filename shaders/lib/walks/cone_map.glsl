// lib/walks/cone_map.glsl — exact: from cone to cone through the air, then cell by cell.
//
// Source   cone step mapping (Dummer 2006) made conservative for the bilinear surface by measuring
//          distance as columns plus rows (src/core/cone_map.hpp says why that suffices), and ended by
//          the exact patch. The union of the seed's safety distances with exactness.
// Exact    Cones are only left where the next step would be shorter than a cell; there the cell is
//          solved and left through its border, in integers. No step is shorter than that and no
//          epsilon is needed: at most two steps for each column and row crossed.
// Fails    at float32's limits only: docs/limits.md. Slow where a ray skims rough ground for long.
// Bounds   RG16, a texel a block: top and slope, of the ground, or of the higher of ground and water.
#include "lib/heightfield.glsl"
#define TARN_WALK_HAS_BEAMS

// beam_reach — metres that all rays of a beam fly before any of them can meet something.
//
//   spread   greatest difference of the beam's unit directions from the middle ray's
//   returns  path length; at most the first place where a step would be shorter than a block
float beam_reach(sampler2D bounds, Field field, Ray middle, float spread, bool with_water) {
    Span span;
    // The sides and the slab are those of the middle ray: a beam that may miss it reaches nowhere.
    vec3 o = vec3(middle.origin.xy + vec2(middle.base), middle.origin.z);
    vec3 d = middle.direction;
    float unit = with_water ? field.cone_m.y : field.cone_m.x;
    float side = float(1 << field.shift);
    vec2 size = side * vec2(textureSize(bounds, 0));
    float far = 1.5 * (abs(o.x) + abs(o.y) + size.x + size.y) / max(abs(d.x) + abs(d.y), 1e-6);
    float across = 1.5 * spread / field.spacing_m; // columns plus rows a metre, > sqrt(2)
    float pace = abs(d.x) + abs(d.y) + across, sink = spread - d.z;
    float aside = 3e-7 * (pace * far + abs(o.x) + abs(o.y)) + side / 64.0;
    float slack = 3e-7 * (abs(o.z) + abs(d.z) * far) + 1e-6;
    float t = 0.0;
    for (int i = 0; i < 64 && t < far; ++i) {
        vec2 at = o.xy + t * d.xy;
        // Outside the field the nearest block's cone holds no more: distance to it counts besides.
        vec2 beyond = max(abs(at - 0.5 * size) - 0.5 * size, 0.0);
        vec2 cone = textureLod(bounds, at / size, 0.0).rg;
        float reach = aside + t * across + beyond.x + beyond.y;
        float gap = o.z + t * d.z - slack - unit * (cone.x + reach * cone.y) - t * spread;
        float closing = max(unit * cone.y * pace + sink, 1e-12);
        if (gap * pace < side * closing)
            break;
        t += gap / closing;
    }
    return min(t, far);
}

bool trace_field(usampler2D codes, sampler2D bounds, Field field, Ray ray, float t_max, bool with_water, out Hit hit) {
    Span span;
    if (!clip_ray(field, ray, t_max, span))
        return false;
    float t = span.t, dz = span.dz;
    float pace = abs(span.d.x) + abs(span.d.y); // columns plus rows a metre
    float unit = with_water ? field.cone_m.y : field.cone_m.x;
    // Blocks are looked up at rounded places, by the filter unit: a ray may be this much [cells]
    // outside the block that it gets; 1/64 of a texel is for the unit (it keeps 8 bits or more).
    vec2 whole = span.o + vec2(ray.base);
    float side = float(1 << field.shift);
    vec2 per_cell = 1.0 / (side * vec2(textureSize(bounds, 0)));
    float aside = 3e-7 * (pace * span.t_end + abs(whole.x) + abs(whole.y)) + side / 64.0;
    vec2 at = whole * per_cell, step_at = span.d * per_cell;
    float above = span.oz - span.slack, tilt = unit * pace;
    ivec2 cell = cell_at(field, ray, span, t);
    int steps = 2 * (field.cells.x + field.cells.y) + 8;
    while (--steps > 0) {
        float far = t;
        while (true) {
            vec2 cone = textureLod(bounds, at + t * step_at, 0.0).rg;
            float gap = above + t * dz - unit * (cone.x + aside * cone.y);
            float closing = max(tilt * cone.y - dz, 1e-12); // of ray and cone, per metre
            if (gap * pace < closing || --steps < 0)
                break; // the next step would be shorter than a cell
            t += gap / closing;
            if (t >= span.t_end)
                return false;
        }
        if (t > far)
            cell = cell_at(field, ray, span, t);
        vec2 t_border = borders(ray, span, cell, 0);
        float t_out = min(min(t_border.x, t_border.y), span.t_end);
        if (meet_cell(codes, field, ray, span, cell, t, t_out, with_water, hit))
            return true;
        if (t_out >= span.t_end)
            return false;
        t = max(t, t_out);
        if (t_border.x < t_border.y)
            cell.x += span.stride.x;
        else
            cell.y += span.stride.y;
    }
    return false;
}
