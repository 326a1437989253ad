// lib/walks/safety_exact.glsl — exact: safety radii as far as they are sure, the patch of the cell where not.
//
// Source   Baboud & Decoret 2006 with radii of the bilinear surface (src/core/safety_radius.hpp).
// Exact    A radius is used only by a ray above the cell's highest node, as it is defined, and above all
//          water; the crossing that it promises is bracketed by halving down to a few cells, and found by
//          their patches. Everywhere else the cell itself is solved and left through its border.
// Fails    at float32's limits; and radii are of straight rays: over their some hundred cells the Earth's curvature bends
//          a ray by centimetres, by which it may touch what it is taken to pass. Slow: most cells of rough ground have no radius at all.
// Bounds   R8, a texel a cell.
#include "lib/heightfield.glsl"

// Height of the ground below a ray after t metres, in float.
float ground_below(sampler2D heights, Field field, Ray ray, Span span, float t) {
    vec2 cell = cell_at(span, t);
    vec4 h = textureGather(heights, (cell + ray.base + 1.0) * field.texel, 0);
    return bilinear(h, clamp(span.o - cell + t * span.d, 0.0, 1.0));
}

bool trace_field(sampler2D heights, sampler2D bounds, Field field, Ray ray, float t_max, bool with_water, out Hit hit) {
    Span span;
    if (!clip_ray(field, ray, t_max, span))
        return false;
    float t = span.t, bracket = span.t_end; // a crossing lies before `bracket`, if it is less than t_end
    vec2 cell = cell_at(span, t);
    for (int i = 2 * int(field.cells.x + field.cells.y) + 64; i > 0; --i) {
        float radius = floor(255.0 * texelFetch(bounds, ivec2(cell + ray.base), 0).r + 0.5);
        if (radius > 0.0 && bracket == span.t_end) {
            vec4 h = textureGather(heights, (cell + ray.base + 1.0) * field.texel, 0);
            float highest = max(max(h.x, h.y), max(h.z, h.w)) + span.slack;
            vec2 t_border = (cell + mix(vec2(1.0 - radius), vec2(radius), span.ahead) - span.o) * span.inverse;
            float t_out = max(t, min(min(t_border.x, t_border.y), span.t_end));
            float z = height_at(span, t), z_out = height_at(span, t_out);
            if (z > highest && (!with_water || min(z, z_out) > field.water_top + span.slack)) {
                if (z_out > ground_below(heights, field, ray, span, t_out) + span.slack) {
                    if (t_out >= span.t_end)
                        return false;
                    cell = beyond_square(span, cell, radius, t_border, t_out);
                    t = max(t, t_out);
                    continue;
                }
                // Met once before t_out (or touched there): close in, then let the patches decide.
                float above = t, below = t_out;
                for (int k = 0; k < 24 && (below - above) * max(abs(span.d.x), abs(span.d.y)) > 1.0; ++k) {
                    float middle = 0.5 * (above + below);
                    if (height_at(span, middle) > ground_below(heights, field, ray, span, middle) + span.slack)
                        above = middle;
                    else
                        below = middle;
                }
                if (above > t) {
                    t = above;
                    cell = cell_at(span, t);
                }
                bracket = below;
            }
        }
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
        if (t > bracket)
            bracket = span.t_end; // it was only touched within the slack
        cell = beyond(span, cell, t_border);
    }
    return false;
}
