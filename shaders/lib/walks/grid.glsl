// lib/walks/grid.glsl — exact: every cell under the ray, one after the other.
//
// Source   Amanatides & Woo 1987, in integers; the exact patch in each cell (lib/heightfield.glsl).
// Fails    nowhere but at float32's limits; slow: as many steps as cells are crossed.
// Bounds   none.
#include "lib/heightfield.glsl"

bool trace_field(usampler2D codes, sampler2D bounds, Field field, Ray ray, float t_max, bool with_water, out Hit hit) {
    Span span;
    if (!clip_ray(field, ray, t_max, span))
        return false;
    float t = span.t;
    ivec2 cell = cell_at(field, ray, span, t);
    for (int i = field.cells.x + field.cells.y + 2; i > 0; --i) {
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
