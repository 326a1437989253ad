// lib/walks/cone_steps.glsl — approximate: from cone to cone until steps are short, and there it ends.
//
// Source   cone step mapping (Dummer 2006) with conservative cones (src/core/cone_map.hpp), so that nothing is
//          passed over; the place is taken where a step falls below a quarter cell or the steps run out.
// Setting  the greatest number of steps.
// Fails    stops in the air above rough ground, up to a cell's relief too early; where the steps run out, far
//          in front of it. Rays that skim a crest are given to the crest.
// Bounds   as cone_map.glsl.
#include "lib/heightfield.glsl"

bool trace_field(sampler2D heights, sampler2D bounds, Field field, Ray ray, float t_max, bool with_water, out Hit hit) {
    Span span;
    if (!clip_ray(field, ray, t_max, span))
        return false;
    float t = span.t, pace = abs(span.d.x) + abs(span.d.y);
    float unit = with_water ? field.cone.y : field.cone.x;
    float steepest = with_water ? field.slope.y : field.slope.x;
    vec2 per_cell = 1.0 / (float(1 << field.shift) * vec2(textureSize(bounds, 0)));
    vec2 at = (span.o + ray.base) * per_cell, step_at = span.d * per_cell;
    for (float i = 0.0; i < field.setting; ++i) {
        vec2 cone = textureLod(bounds, at + t * step_at, 0.0).rg;
        float gap = height_at(span, t) - cone.x * unit;
        float closing = max(cone.y * cone.y * steepest * pace - climb_at(span, t), 1e-12);
        if (gap * pace < 0.25 * closing)
            break;
        t += gap / closing;
        if (t >= span.t_end)
            return false;
    }
    vec2 place = (span.o + t * span.d + ray.base + 0.5) * field.texel;
    vec2 height = textureLod(heights, place, 0.0).rg;
    bool water = with_water && height.g > 0.0 && field.water.x + field.water.y * height.g > height.r;
    hit = hit_at(field, ray, span, t, water);
    return true;
}
