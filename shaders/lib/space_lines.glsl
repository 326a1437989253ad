// lib/space_lines.glsl — lines and points that hang in air and water, as wide on the picture as they say.
// C++ twin of near_stroke: src/reference/space_lines.hpp. Needs lib/parts.glsl where TARN_SPACE_LINES is defined.

// Where a ray passes a stroke.
struct StrokeSeen {
    float apart_rad; // between the ray and the nearest of the stroke, at the eye
    float t;         // metres from the eye to that; < 0: behind
};

// near_stroke — what is nearest to a ray of a straight stroke, by the angle that the eye sees between them.
//
//   direction  unit, of the ray, which begins at the eye
//   from, to   ends of the stroke, from the eye [m]; may be one place
// Source  the stroke's plane through the eye cuts the sphere of directions in a great circle.
StrokeSeen near_stroke(vec3 direction, vec3 from, vec3 to) {
    // The nearer end, by angle.
    float at_from = length(cross(from, direction)) / max(length(from), 1e-12),
          at_to = length(cross(to, direction)) / max(length(to), 1e-12);
    float t_from = dot(from, direction), t_to = dot(to, direction);
    StrokeSeen seen = StrokeSeen(at_from, t_from);
    if (t_from <= 0.0 || (t_to > 0.0 && at_to < at_from))
        seen = StrokeSeen(at_to, t_to);
    vec3 along = to - from, upright = cross(from, along);
    float size = length(upright);
    if (size > 1e-9 * dot(along, along)) {
        upright /= size;
        float off = dot(upright, direction);
        vec3 towards = normalize(direction - off * upright);
        float place = -dot(cross(from, towards), upright) / dot(cross(along, towards), upright);
        float t = dot(from + place * along, direction);
        if (place >= 0.0 && place <= 1.0 && t > 0.0)
            return StrokeSeen(abs(off), t);
    }
    return seen;
}

// stroke_cover — share of a pixel that it covers, [0, 1].
//
//   apart_px, width_px  from the pixel's middle; of the stroke
float stroke_cover(float apart_px, float width_px) { return clamp(0.5 * width_px - apart_px + 0.5, 0.0, 1.0); }

#ifdef TARN_SPACE_LINES
// As src/render/stroke_tree.cpp packs them, floats by their bits: [0] x: nodes, y: width of the widest [px]; then each
// node's low corner, w: the node after it and all below it, and high corner, w: strokes << 24 | first, 0 of an inner
// one, metres east and north of the field's first node and above heights.x; then each stroke's beginning from its node
// [m], w: that node, column | row << 16, and how far its end is from there [m], w: width [px].
layout(binding = TARN_BUFFER_SPACE_LINES, std430) readonly buffer SpaceLines { uvec4 space_lines[]; };

struct SpaceMark {
    float t;     // of the part [m]
    float cover; // share of the pixel, 0: there is none
};

// mark_on — the line or point in space that a part of a path meets first, before it ends.
//
//   end_m     path after which the part ends [m]
//   before_m  length of the path before it: pixels spread from the eye on
SpaceMark mark_on(ViewBlock view, Part part, float end_m, float before_m) {
    SpaceMark mark = SpaceMark(far_m, 0.0);
    uint nodes = space_lines[0].x;
    float pixel = view.camera.w, spread = 0.5 * uintBitsToFloat(space_lines[0].y) + 0.5;
    // The eye, as if the path had been straight.
    vec3 eye = vec3((part.base + part.origin.xy) * vec2(view.grid.z, -view.grid.z), part.origin.z) -
               before_m * part.direction;
    vec3 inverse = 1.0 / (part.direction + mix(vec3(-1e-12), vec3(1e-12), greaterThanEqual(part.direction, vec3(0.0))));
    uint i = 0u;
    while (i < nodes) {
        uvec4 low = space_lines[1u + 2u * i], high = space_lines[2u + 2u * i];
        vec3 from = uintBitsToFloat(low.xyz) - eye, to = uintBitsToFloat(high.xyz) - eye;
        float far = 0.5 * (length(from + to) + length(to - from)), grown = spread * pixel * far;
        from -= grown;
        to += grown;
#ifdef TARN_CURVED
        if (!part.in_water)
            from.z -= view.base.w * far * far; // level ground falls away below a line of sight
#endif
        vec3 a = from * inverse, b = to * inverse, enters = min(a, b), leaves = max(a, b);
        float first = max(max(enters.x, enters.y), max(enters.z, before_m)),
              last = min(min(leaves.x, leaves.y), min(leaves.z, before_m + end_m));
        if (!(first <= last)) {
            i = low.w;
            continue;
        }
        uint leaf = high.w;
        for (uint k = 0u; k < leaf >> 24; ++k) {
            uint at = 1u + 2u * (nodes + (leaf & 0xffffffu) + k);
            uint node = space_lines[at].w;
            vec3 begin = uintBitsToFloat(space_lines[at].xyz);
            vec4 along = uintBitsToFloat(space_lines[at + 1u]);
            vec2 nodes_away = vec2(node & 0xffffu, node >> 16) - part.base - part.origin.xy;
            vec3 near = vec3(nodes_away * vec2(view.grid.z, -view.grid.z) + begin.xy, begin.z - part.origin.z);
            vec3 end = near + along.xyz;
#ifdef TARN_CURVED
            if (!part.in_water) {
                near.z -= view.base.w * dot(near.xy, near.xy);
                end.z -= view.base.w * dot(end.xy, end.xy);
            }
#endif
            StrokeSeen seen = near_stroke(part.direction, near + before_m * part.direction, end + before_m * part.direction);
            float t = seen.t - before_m;
            if (!(t > 0.0 && t < end_m))
                continue;
            float cover = stroke_cover(seen.apart_rad / pixel, along.w);
            // A near one's soft rim does not cut into what is behind it.
            if (cover > mark.cover || (cover == mark.cover && cover > 0.0 && t < mark.t))
                mark = SpaceMark(t, cover);
        }
        ++i;
    }
    return mark;
}
#endif
