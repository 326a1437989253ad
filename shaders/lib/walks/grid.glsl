// lib/walks/grid.glsl — exact: every cell under the ray, one after the other.
//
// Source   Amanatides & Woo 1987, counting cells; the exact patch in each (lib/heightfield.glsl).
// Fails    nowhere but at float32's limits; slow: as many steps as cells are crossed.
// Bounds   none.
#include "lib/heightfield.glsl"

bool trace_field(sampler2D heights, sampler2D bounds, Field field, Ray ray, float t_max, bool with_water, out Hit hit) {
    Span span;
    if (!clip_ray(field, ray, t_max, span))
        return false;
    float t = span.t;
    vec2 cell = cell_at(span, t);
    for (int i = int(field.cells.x + field.cells.y) + 2; i > 0; --i) {
        vec2 t_border = borders(span, cell);
        float t_out = max(t, min(min(t_border.x, t_border.y), span.t_end));
        Meeting m = look_into(heights, field, ray, span, cell, t, t_out, with_water);
        if (m.met) {
            hit = hit_of(ray, span, m, cell, t, t_out);
            return true;
        }
        if (t_out >= span.t_end)
            return false;
        t = max(t, t_out);
        cell = beyond(span, cell, t_border);
    }
    return false;
}
