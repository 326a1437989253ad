// lib/walks/safety_radius.glsl — approximate: the seed's method. Steps as far as a ray may at once, at least
// one texel; where it comes out below the surface, bisection.
//
// Source   Baboud & Decoret 2006 (Realistic Water Volumes, sec. 3.2). Radii: src/core/safety_radius.hpp,
//          which are those of the bilinear surface; that they are never taken for less than a texel
//          is the published method, and where it fails.
// Setting  the number of halvings.
// Fails    where the radius is 0 a ray can cut a crest within a texel unseen; at slanting steps along rough
//          ground that is common. No guard here: safety_exact.glsl is the guarded one.
// Bounds   R8, a texel a cell.
#include "lib/walks/sampled.glsl"

bool trace_field(sampler2D heights, sampler2D bounds, Field field, Ray ray, float t_max, bool with_water, out Hit hit) {
    Span span;
    if (!clip_ray(field, ray, t_max, span))
        return false;
    bool at_water;
    float t = span.t;
    if (depth_below(heights, field, ray, span, t, with_water, at_water) >= 0.0) {
        hit = hit_at(field, ray, span, t, at_water);
        return true;
    }
    vec2 cell = cell_at(span, t);
    for (int i = int(field.cells.x + field.cells.y) + 2; i > 0; --i) {
        float radius = max(floor(255.0 * texelFetch(bounds, ivec2(cell + ray.base), 0).r + 0.5), 1.0);
        vec2 t_border = (cell + mix(vec2(1.0 - radius), vec2(radius), span.ahead) - span.o) * span.inverse;
        float t_out = max(t, min(min(t_border.x, t_border.y), span.t_end));
        if (depth_below(heights, field, ray, span, t_out, with_water, at_water) >= 0.0) {
            t = bisect(heights, field, ray, span, t, t_out, with_water, int(field.setting), at_water);
            hit = hit_at(field, ray, span, t, at_water);
            return true;
        }
        if (t_out >= span.t_end)
            return false;
        // Into the cell behind the border that was crossed; along it, wherever the ray is.
        cell = beyond_square(span, cell, radius, t_border, t_out);
        t = max(t, t_out);
    }
    return false;
}
