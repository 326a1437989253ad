// lib/walks/cone_map.glsl — exact: from cone to cone through the air, then cell by cell.
//
// Source   cone step mapping (Dummer 2006) with a plain disc around each cone's foot, made conservative for
//          the bilinear surface by measuring distance as columns plus rows (src/core/cone_map.hpp says
//          why that suffices), and ended by the exact patch.
// Exact    Cones are left where the next step would be shorter than a quarter cell; there the cell is
//          solved and left through its border, counted in whole cells. So no epsilon is needed, and
//          there are at most eight steps for each column and row.
// Fails    at float32's limits only: docs/limits.md. Slow where a ray skims rough ground for long.
// Coarse   with TARN_COARSE no longer exact: where a block of dry ground is narrower than a pixel, its top is taken
//          for the ground, and no patch is solved. Outlines of far land rise by less than their slope times a pixel.
// Bounds   RG16, a texel a block, of the ground, or of the higher of ground and water: its top; and slope, free
//          distance and the mark of water in one code (src/core/cone_map.hpp).
#include "lib/heightfield.glsl"
#define TARN_WALK_HAS_BEAMS

// Cones that a ray may pass before those beside it, which may stand before a cell already, look into it.
// GPUs run rays in step and are fastest with few; software GL with all that there are (not defined).
// #define TARN_CONES_A_LOOK 8

// Cells looked into before cones are asked again, at most 3. Where one has to be, the next often has, too.
#ifndef TARN_LOOKS
#define TARN_LOOKS 3
#endif

// A texel of the bounds: how to read its second channel.
float cone_slope(float code, float steepest) { return code * code * steepest; }
// Cells around the block free of anything higher than its top, or a little less.
float cone_free(float code) { return 512.0 * fract(code * (65535.0 / 256.0) + 0.5 / 256.0) - 3.0; }
bool cone_wet(float code) { return fract(code * 32767.5 + 0.25) > 0.5; }

// beam_reach — metres that all rays of a beam fly before any of them can meet something.
//
//   spread   greatest difference of the beam's unit directions from the middle ray's
//   returns  path length; at most the first place where a step would be shorter than a block
float beam_reach(sampler2D bounds, Field field, Ray middle, float spread, bool with_water) {
    vec2 o = middle.origin.xy + middle.base, d = middle.direction.xy;
    float oz = middle.origin.z * field.per_m, dz = middle.direction.z * field.per_m;
    float unit = with_water ? field.cone.y : field.cone.x;
    float steepest = with_water ? field.slope.y : field.slope.x;
    float side = float(1 << field.shift);
    vec2 size = side * vec2(textureSize(bounds, 0));
    float far = 1.5 * (abs(o.x) + abs(o.y) + size.x + size.y) / max(abs(d.x) + abs(d.y), 1e-6);
    float across = 1.5 * spread * field.per_spacing; // columns plus rows a metre, > sqrt(2) spread
    float pace = abs(d.x) + abs(d.y) + across, sink = spread * field.per_m - dz;
    float aside = 3e-7 * (pace * far + abs(o.x) + abs(o.y)) + side / 64.0;
    float slack = 3e-7 * (abs(oz) + abs(dz) * far) + 1e-6 * field.per_m;
    float t = 0.0;
    for (int i = 0; i < 64 && t < far; ++i) {
        vec2 at = o + t * d;
        // Outside the field the nearest block's cone is as far away as it is.
        vec2 out_by = max(abs(at - 0.5 * size) - 0.5 * size, 0.0);
        vec2 cone = textureLod(bounds, at / size, 0.0).rg;
        float slope = cone_slope(cone.y, steepest), reach = aside + t * across + out_by.x + out_by.y;
        float gap = oz + t * dz - slack - cone.x * unit - t * spread * field.per_m;
        float by_cone = (gap - reach * slope) / max(slope * pace + sink, 1e-12);
        float by_plain = min(gap / max(sink, 1e-12), (cone_free(cone.y) - reach) / pace);
        float stride = max(by_cone, by_plain);
        if (stride * pace < side)
            break;
        t += stride;
    }
    return min(t, far);
}

// Cones are left for the cell's exact patch where the next step would be shorter than this [cells]: a
// patch costs as much as ten steps, and most that are solved too early are not hit.
const float least_step = 0.25;

bool trace_field(sampler2D heights, sampler2D bounds, Field field, Ray ray, float t_max, bool with_water, out Hit hit) {
    Span span;
    if (!clip_ray(field, ray, t_max, span))
        return false;
    float t = span.t;
    float pace = abs(span.d.x) + abs(span.d.y); // columns plus rows a metre
    float unit = with_water ? field.cone.y : field.cone.x;
    float steepest = with_water ? field.slope.y : field.slope.x;
    // Blocks are looked up at rounded places, by the filter unit: a ray may be this much [cells]
    // outside the block that it gets; 1/64 of a texel is for the unit (it keeps 8 bits or more).
    vec2 whole = span.o + ray.base;
    float side = float(1 << field.shift);
    vec2 per_cell = 1.0 / (side * vec2(textureSize(bounds, 0)));
    float aside = 3e-7 * (pace * span.t_end + abs(whole.x) + abs(whole.y)) + side / 64.0;
    vec2 at = whole * per_cell, step_at = span.d * per_cell;
    Span low = span; // as low as rounding may have it
    low.oz -= span.slack;
    float inverse_pace = 1.0 / pace, inverse_sink = 1.0 / max(-span.dz, 1e-12);
    vec2 cell = cell_at(span, t);
    int steps = int(2.0 / least_step * (field.cells.x + field.cells.y)) + 8;
    float t_out;
    Meeting m;
    while (true) {
        float before = t;
        vec2 cone;
#ifdef TARN_CONES_A_LOOK
        bool look = false;
        for (int k = 0; k < TARN_CONES_A_LOOK && !look; ++k) {
#else
        while (true) {
#endif
            cone = textureLod(bounds, at + t * step_at, 0.0).rg;
            float slope = cone_slope(cone.y, steepest);
            float gap = height_at(low, t) - unit * cone.x, climb = climb_at(span, t);
#ifdef TARN_CURVED
            inverse_sink = 1.0 / max(-climb, 1e-12);
#endif
            float by_cone = (gap - aside * slope) / max(slope * pace - climb, 1e-12);
            float by_plain = min(gap * inverse_sink, (cone_free(cone.y) - aside) * inverse_pace);
            float stride = max(by_cone, by_plain);
#ifdef TARN_CONES_A_LOOK
            look = stride * pace < least_step || t + stride == t || --steps < 0;
            if (look)
                break;
#else
            if (stride * pace < least_step || t + stride == t || --steps < 0)
                break;
#endif
            t += stride;
            if (t >= span.t_end)
                return false;
        }
        if (t > before)
            cell = cell_at(span, t);
#ifdef TARN_CONES_A_LOOK
        if (!look)
            continue;
#endif
#ifdef TARN_COARSE
        // A ray along a pixel of far land: by whole blocks, until one stands in its way.
        if (t * field.pixel > side && !(with_water && cone_wet(cone.y))) {
            if (height_at(span, t) <= unit * cone.x) {
                hit = hit_at(field, ray, span, t, false);
                return true;
            }
            t += 0.5 * side * inverse_pace;
            if (t >= span.t_end)
                return false;
            continue;
        }
#endif
        bool wet = with_water && cone_wet(cone.y);
        for (int k = 0; k < TARN_LOOKS; ++k) {
            vec2 t_border = borders(span, cell);
            t_out = max(t, min(min(t_border.x, t_border.y), span.t_end));
            m = look_into(heights, field, ray, span, cell, t, t_out, wet);
            if (m.met)
                break;
            if (t_out >= span.t_end || --steps < 0)
                return false;
            t = max(t, t_out);
            cell = beyond(span, cell, t_border);
        }
        if (m.met)
            break;
    }
    hit = hit_of(ray, span, m, cell, t, t_out);
    return true;
}
