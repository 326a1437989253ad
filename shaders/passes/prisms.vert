#version 450 core
// passes/prisms.vert — the faces of prisms of light, two below each cell of a grid, and of the two of flat water that they
// take the place of: three-sided ones, whose section turns about where light focuses, and nothing else.
// gl_InstanceID is the prism, cut into four lengths of even light; gl_VertexID counts three vertices for each of top,
// bottom and the two halves of three sides. Reads prisms and shares. No vertex is fed in.
#include "shared/view_block.h"
#include "shared/prisms.h"

layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_BUFFER_PRISMS, std430) readonly buffer Prisms { vec4 corners[]; };
layout(binding = TARN_BUFFER_SHARES, std430) readonly buffer Shares { float shares[]; };
layout(location = 0) uniform vec4 grid;  // xy: first corner [m], z: spacing [m], w: corners a side
layout(location = 1) uniform vec3 depth; // x: of the camera [m], y: of the tops, < 0: above the level, z: of the bottoms

layout(location = 0) out vec3 from_eye;   // place, scene axes [m]
layout(location = 1) flat out float strength; // of the light in this length, in the mean, against that below flat water;
                                              // < 0: its faces look inwards

const float near_m = 0.01;

vec2 section_at(vec4 corner, float z) { return corner.xy + z * corner.zw; }

float cross2(vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; }

// Volume of one length as it is drawn, with sides in two halves: < 0 where it is turned inside out. Three tetrahedra.
//
//   order  corners by their numbers: each half runs from the top of one to the foot of a later one
float volume_between(vec4 corner[3], ivec3 order, float low, float high) {
    vec3 a0 = vec3(section_at(corner[order.x], low), low);
    vec3 a1 = vec3(section_at(corner[order.y], low), low) - a0, a2 = vec3(section_at(corner[order.z], low), low) - a0;
    vec3 b0 = vec3(section_at(corner[order.x], high), high) - a0, b1 = vec3(section_at(corner[order.y], high), high) - a0,
         b2 = vec3(section_at(corner[order.z], high), high) - a0;
    float side = order.y == 1 ? 1.0 : -1.0; // corners are counter-clockwise, their numbers may not be
    return side * (determinant(mat3(a1, a2, b2)) + determinant(mat3(a1, b2, b1)) + determinant(mat3(b1, b2, b0))) / 6.0;
}

// cuts — depths between the lengths of a prism: each twice as deep as the one before, but where its section turns
//        about: there light focuses, and no length is to have both sides of that.
vec3 cuts(vec3 area, float bottom) {
    vec3 cut = bottom * vec3(0.125, 0.25, 0.5);
    float p = abs(area.z) > 1e-12 * area.x ? 0.5 * area.y / area.z : 0.0, q = area.x / area.z, d = p * p - q;
    vec2 roots = abs(area.z) <= 1e-12 * area.x ? vec2(-area.x / area.y, -1.0) : d > 0.0 ? vec2(-p - sqrt(d), -p + sqrt(d)) : vec2(-1.0);
    int taken = -1;
    for (int i = 0; i < 2; ++i) {
        float r = roots[i];
        if (!(r > 0.0 && r < bottom))
            continue;
        int best = -1;
        float least = 1e30;
        for (int k = 0; k < 3; ++k) {
            float off = abs(log(r / cut[k]));
            if (k != taken && off < least) {
                least = off;
                best = k;
            }
        }
        cut[best] = r;
        taken = best;
    }
    cut = vec3(min(cut.x, min(cut.y, cut.z)), clamp(cut.y, min(cut.x, cut.z), max(cut.x, cut.z)), max(cut.x, max(cut.y, cut.z)));
    return cut;
}

void main() {
    int side = int(grid.w), cells = side - 1, lengths = 4;
    int prism = gl_InstanceID / lengths, part = gl_InstanceID % lengths, number = prism / 2;
    bool flat_water = number == cells * cells, upper = prism % 2 == 1;
    ivec2 cell = flat_water ? ivec2(0) : ivec2(number % cells, number / cells);
    int stride = flat_water ? cells : 1;
    // Counter-clockwise seen from above; corners in the order of their numbers are 0 1 2 in the lower prism (south-west,
    // south-east, north-east) and 0 2 1 in the upper one (south-west, north-east, north-west).
    vec4 corner[3];
    float through = 0.0;
    for (int k = 0; k < 3; ++k) {
        ivec2 at = k == 0 ? ivec2(0) : upper ? (k == 1 ? ivec2(1, 1) : ivec2(0, 1)) : (k == 1 ? ivec2(1, 0) : ivec2(1, 1));
        int i = (cell.y + at.y * stride) * side + cell.x + at.x * stride;
        corner[k] = corners[i];
        through += shares[i] / 3.0;
    }
    float step_m = grid.z * float(stride), flux = (flat_water ? -0.5 : 0.5 * through) * step_m * step_m;
    vec4 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    vec3 area = 0.5 * vec3(cross2(e1.xy, e2.xy), cross2(e1.xy, e2.zw) + cross2(e1.zw, e2.xy), cross2(e1.zw, e2.zw));
    vec3 cut = cuts(area, depth.z);
    float low = part == 0 ? depth.y : cut[part - 1], high = part == 3 ? depth.z : cut[part], from = max(low, 0.0);
    // As much light as falls in; a length that is next to nothing is no brighter than a hundred times flat water.
    float volume = volume_between(corner, upper ? ivec3(0, 2, 1) : ivec3(0, 1, 2), from, high);
    float least = 0.01 * area.x * max(high - from, 1e-6);
    strength = flux * (high - from) / (abs(volume) < least ? (volume < 0.0 ? -least : least) : volume);

    int face = gl_VertexID / 3, v = gl_VertexID % 3;
    vec2 place;
    float z;
    if (face < 2) {
        z = face == 0 ? low : high;
        place = section_at(corner[face == 0 ? v : 2 - v], z);
    } else {
        // A side's two halves are split alike in both prisms that share it: from the top of the corner with the lower
        // number, to the foot of the other one. Roles of the vertices: 0 that top, 1 its foot, 2 that foot, 3 its top.
        // Seen from outside, corner a is on the left.
        int k = (face - 2) / 2, a = k, b = (k + 1) % 3;
        bool second = face % 2 == 1, turned = upper ? k != 0 : k == 2; // b has the lower number
        int w = turned ? (second ? (v == 0 ? 0 : 3 - v) : (v == 0 ? 0 : 4 - v)) : (second && v > 0 ? v + 1 : v);
        bool own = w < 2;
        z = w == 0 || w == 3 ? low : high;
        place = section_at(corner[own != turned ? a : b], z);
    }
    vec2 camera = view.camera.xy * vec2(view.grid.z, -view.grid.z);
    from_eye = vec3(place - camera, depth.x - z);
    float ahead = dot(from_eye, view.forward.xyz);
    vec2 plane = vec2(dot(from_eye, view.right.xyz) / view.right.w, dot(from_eye, view.up.xyz) / view.up.w);
    // From the whole picture to the tile that is drawn; rows go down.
    vec2 tile = vec2(view.tile.zw);
    vec2 pixel = (plane * vec2(0.5, -0.5) + 0.5 * ahead) / view.inverse_size.zw - ahead * (vec2(view.tile.xy) + floor(view.offset.xy));
    gl_Position = vec4(2.0 * pixel / tile - ahead, ahead - 2.0 * near_m, ahead);
}
