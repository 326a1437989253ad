// lib/noise.glsl — smooth value noise on a lattice. Pure functions. C++ twin: src/reference/noise.hpp

// lattice_hash — one of 2^32 numbers for a lattice point; equal bit for bit on every device.
uint lattice_hash(ivec2 p, uint seed) {
    uint h = uint(p.x) * 0x8da6b343u ^ uint(p.y) * 0xd8163841u ^ seed * 0xcb1ab31fu;
    h = (h ^ (h >> 16)) * 0x7feb352du;
    h = (h ^ (h >> 15)) * 0x846ca68bu;
    return h ^ (h >> 16);
}

// value_noise — in [0, 1], continuous with continuous slope; lattice spacing 1.
float value_noise(vec2 p, uint seed) {
    vec2 cell = floor(p);
    ivec2 i = ivec2(cell);
    vec2 t = p - cell;
    t = t * t * (3.0 - 2.0 * t);
    vec4 corner = vec4(lattice_hash(i, seed) >> 8, lattice_hash(i + ivec2(1, 0), seed) >> 8,
                       lattice_hash(i + ivec2(0, 1), seed) >> 8, lattice_hash(i + ivec2(1, 1), seed) >> 8) *
                  (1.0 / 16777216.0);
    return mix(mix(corner.x, corner.y, t.x), mix(corner.z, corner.w, t.x), t.y);
}

// faded_noise — three octaves from `wavelength` down, each turned against the last so that the
//               lattice does not show, each fading to its mean, 0.5, before a footprint of
//               `footprint` metres would alias it.
float faded_noise(vec2 p_m, float wavelength_m, float footprint_m, uint seed) {
    float sum = 0.0, weight = 0.5;
    for (uint octave = 0u; octave < 3u; ++octave) {
        p_m = vec2(0.8 * p_m.x - 0.6 * p_m.y, 0.6 * p_m.x + 0.8 * p_m.y); // 36.87 degrees
        float share = clamp(2.0 - 4.0 * footprint_m / wavelength_m, 0.0, 1.0);
        if (share > 0.0)
            sum += weight * share * (value_noise(p_m / wavelength_m, seed + octave) - 0.5);
        weight *= 0.5;
        wavelength_m *= 0.4;
    }
    return 0.5 + sum;
}
