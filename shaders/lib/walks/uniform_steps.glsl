// lib/walks/uniform_steps.glsl — approximate: equal steps through the slab, then bisection.
//
// Source   relief mapping (Policarpo, Oliveira & Comba 2005): so many slices, 8 halvings.
// Setting  the number of slices.
// Fails    passes whatever is thinner than a step: ridges, needles, far crests - more of it the flatter the
//          ray and the larger the field, since the number of steps is fixed. Never sees that it failed.
// Bounds   the heights, filtered.
#include "lib/walks/sampled.glsl"

bool trace_field(sampler2D heights, sampler2D bounds, Field field, Ray ray, float t_max, bool with_water, out Hit hit) {
    Span span;
    if (!sampled_span(field, ray, t_max, span))
        return false;
    bool at_water;
    float before = span.t, stride = (span.t_end - span.t) / field.setting;
    if (depth_below(bounds, field, ray, span, before, with_water, at_water) >= 0.0) {
        hit = hit_at(field, ray, span, before, at_water);
        return true;
    }
    for (float i = 1.0; i <= field.setting; ++i) {
        float t = span.t + i * stride;
        if (depth_below(bounds, field, ray, span, t, with_water, at_water) >= 0.0) {
            t = bisect(bounds, field, ray, span, before, t, with_water, 8, at_water);
            hit = hit_at(field, ray, span, t, at_water);
            return true;
        }
        before = t;
    }
    return false;
}
