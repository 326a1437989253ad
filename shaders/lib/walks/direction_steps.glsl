// lib/walks/direction_steps.glsl — approximate: fewer steps the steeper the ray, then one secant.
//
// Source   parallax occlusion mapping (Tatarchuk 2006): from a sixth of the steps, looking straight down, to
//          all of them, looking along the ground; the last two heights are joined by a straight line.
// Setting  the greatest number of steps.
// Fails    as uniform steps, sooner; and the secant is off wherever the surface bends within a step:
//          stair-like shells on slopes. Never sees that it failed.
// Bounds   the heights, filtered.
#include "lib/walks/sampled.glsl"

bool trace_field(sampler2D heights, sampler2D bounds, Field field, Ray ray, float t_max, bool with_water, out Hit hit) {
    Span span;
    if (!sampled_span(field, ray, t_max, span))
        return false;
    float steps = mix(field.setting, ceil(field.setting / 6.0), abs(ray.direction.z));
    bool at_water;
    float before = span.t, stride = (span.t_end - span.t) / steps;
    float depth_before = depth_below(bounds, field, ray, span, before, with_water, at_water);
    if (depth_before >= 0.0) {
        hit = hit_at(field, ray, span, before, at_water);
        return true;
    }
    for (float i = 1.0; i <= steps; ++i) {
        float t = span.t + i * stride;
        float depth = depth_below(bounds, field, ray, span, t, with_water, at_water);
        if (depth >= 0.0) {
            float share = depth_before / (depth_before - depth);
            hit = hit_at(field, ray, span, mix(before, t, share), at_water);
            return true;
        }
        before = t;
        depth_before = depth;
    }
    return false;
}
