// lib/surface.glsl — shading normals of the ground. Pure functions; the sampler is a parameter.
// C++ twin: src/reference/surface.hpp

// ground_gradient — height gained per node to the east (x) and to the south (y).
//
//   Central differences at the four nodes around a place, interpolated bilinearly: smooth across
//   cells, where the gradient of the bilinear surface itself jumps. Edges repeat the last node.
//   heights      RG16 texture, ground in red
//   size         nodes
//   cell, inside cell and position in it, [0, 1]
//   scale_m      metres per unit texel
vec2 ground_gradient(sampler2D heights, vec2 size, ivec2 cell, vec2 inside, float scale_m) {
    // Four gathers fetch the 4 x 4 nodes around the cell; component order of a gather is
    // (0,1) (1,1) (1,0) (0,0) in columns and rows. Positions midway between texels are safe.
    vec2 base = vec2(cell);
    vec4 nw = textureGather(heights, (base + vec2(0.0, 0.0)) / size, 0);
    vec4 ne = textureGather(heights, (base + vec2(2.0, 0.0)) / size, 0);
    vec4 sw = textureGather(heights, (base + vec2(0.0, 2.0)) / size, 0);
    vec4 se = textureGather(heights, (base + vec2(2.0, 2.0)) / size, 0);
    // Rows 0..3 of columns 0..3: r0 = (nw.w nw.z ne.w ne.z), r1 = (nw.x nw.y ne.x ne.y), ...
    vec4 r0 = vec4(nw.w, nw.z, ne.w, ne.z), r1 = vec4(nw.x, nw.y, ne.x, ne.y);
    vec4 r2 = vec4(sw.w, sw.z, se.w, se.z), r3 = vec4(sw.x, sw.y, se.x, se.y);
    vec2 east_north = r1.zw - r1.xy, east_south = r2.zw - r2.xy;
    vec2 south_north = r2.yz - r0.yz, south_south = r3.yz - r1.yz;
    float east = mix(mix(east_north.x, east_north.y, inside.x),
                     mix(east_south.x, east_south.y, inside.x), inside.y);
    float south = mix(mix(south_north.x, south_north.y, inside.x),
                      mix(south_south.x, south_south.y, inside.x), inside.y);
    return vec2(east, south) * (0.5 * scale_m);
}

// normal_of — unit normal, scene axes, of a surface with that gradient.
vec3 normal_of(vec2 gradient_m_per_node, float spacing_m) {
    return normalize(vec3(-gradient_m_per_node.x, gradient_m_per_node.y, spacing_m));
}

// water_share — 1 where all nodes around carry a lake's level, 0 where none does, bilinear between.
float water_share(sampler2D heights, vec2 size, ivec2 cell, vec2 inside) {
    vec4 carries = vec4(greaterThan(textureGather(heights, (vec2(cell) + 1.0) / size, 1), vec4(0.0)));
    return mix(mix(carries.w, carries.z, inside.x), mix(carries.x, carries.y, inside.x), inside.y);
}
