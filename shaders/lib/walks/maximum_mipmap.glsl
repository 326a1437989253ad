// lib/walks/maximum_mipmap.glsl — exact: over a pyramid of block maxima, down to the cell.
//
// Source   maximum mipmaps (Tevs, Ihrke & Seidel 2008) with blocks of 4 x 4 children, cells counted in
//          integers, no step length and no epsilon to creep by. Blocks of level L cover 4^L x 4^L cells.
// Exact    A block is skipped only if the ray stays above its greatest node, raised by the rounding of
//          the ray's own height: a bilinear surface never exceeds its nodes.
// Fails    at float32's limits only: docs/limits.md.
// Bounds   RG32F, level L in mip level 2 (L - 1); red: ground, green: water (-1e30: none).
#include "lib/heightfield.glsl"

bool trace_field(sampler2D heights, sampler2D bounds, Field field, Ray ray, float t_max, bool with_water, out Hit hit) {
    Span span;
    if (!clip_ray(field, ray, t_max, span))
        return false;
    float t = span.t, per_m = field.per_m;
    ivec2 base = ivec2(ray.base), cells = ivec2(field.cells);
    ivec2 ahead = ivec2(span.ahead);
    // Blocks of 64 cells to begin with: most rays would only descend through the larger ones. Those
    // that fly far climb to them by themselves.
    int level = min(field.root, 3);
    ivec2 block = (ivec2(cell_at(span, t)) + base) >> (2 * level);
    bool near_water = false; // is there any water in the block of 4 x 4 cells
    for (int i = 8 * (cells.x + cells.y) + 256; i > 0; --i) {
        vec2 t_border = (vec2(((block + ahead) << (2 * level)) - base) - span.o) * span.inverse;
        float t_out = max(t, min(min(t_border.x, t_border.y), span.t_end));
        if (level > 0) {
            float lowest = lowest_between(span, t, t_out);
            vec2 highest = texelFetch(bounds, block, 2 * (level - 1)).rg * per_m;
            float top = with_water ? max(highest.r, highest.g) : highest.r;
            if (lowest <= top + span.slack) {
                --level;
                near_water = with_water && highest.g > -1e20;
                ivec2 child = (ivec2(floor(span.o + t * span.d)) + base) >> (2 * level);
                block = clamp(child, block * 4, block * 4 + 3);
                block = min(block, (cells - 1) >> (2 * level));
                continue;
            }
        } else {
            vec2 cell = vec2(block - base);
            Meeting m = look_into(heights, field, ray, span, cell, t, t_out, near_water);
            if (m.met) {
                hit = hit_of(ray, span, m, cell, t, t_out);
                return true;
            }
        }
        if (t_out >= span.t_end)
            return false;
        t = max(t, t_out);
        ivec2 next = block;
        if (t_border.x < t_border.y)
            next.x += 2 * ahead.x - 1;
        else
            next.y += 2 * ahead.y - 1;
        // Up one level whenever the parent is left; its number follows from the child's.
        if (level < field.root && (next >> 2) != (block >> 2)) {
            ++level;
            block = next >> 2;
        } else {
            block = next;
        }
    }
    return false;
}
