// lib/walks/sampled.glsl — the field as the sampling methods see it: heights at points. No method itself.

#include "lib/heightfield.glsl"

// depth_below — how far a ray is below the surface after t metres [units]; < 0 above it.
//
//   smooth_heights  RG16, ground and water, filtered bilinearly by the hardware (8-bit weights)
//   at_water        is the water the higher surface there
//
//   Water is filtered, too, so beside nodes without water it sinks to nothing within a cell: these methods
//   lose up to a cell of it along the shore.
float depth_below(sampler2D smooth_heights, Field field, Ray ray, Span span, float t, bool with_water, out bool at_water) {
    vec2 place = (span.o + t * span.d + ray.base + 0.5) * field.texel;
    vec2 height = textureLod(smooth_heights, place, 0.0).rg;
    float water = field.water.x + field.water.y * height.g;
    at_water = with_water && height.g > 0.0 && water > height.r;
    return (at_water ? water : height.r) - height_at(span, t);
}

// bisect — the crossing between t_above and t_below, halved so many times.
float bisect(sampler2D smooth_heights, Field field, Ray ray, Span span, float t_above, float t_below, bool with_water,
             int halvings, out bool at_water) {
    for (int i = 0; i < halvings; ++i) {
        float middle = 0.5 * (t_above + t_below);
        if (depth_below(smooth_heights, field, ray, span, middle, with_water, at_water) >= 0.0)
            t_below = middle;
        else
            t_above = middle;
    }
    depth_below(smooth_heights, field, ray, span, t_below, with_water, at_water);
    return t_below;
}

// sampled_span — the part of a ray between the highest and the lowest node: what these methods step
//                through. False if nothing is left.
bool sampled_span(Field field, Ray ray, float t_max, out Span span) {
    if (!clip_ray(field, ray, t_max, span))
        return false;
#ifdef TARN_CURVED
    span.t_end = min(span.t_end, passes_height(span.oz - field.lowest, span.dz, span.bend).x);
#else
    if (span.dz < 0.0)
        span.t_end = min(span.t_end, (field.lowest - span.oz) / span.dz);
#endif
    return span.t < span.t_end;
}
