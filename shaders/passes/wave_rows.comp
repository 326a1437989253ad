#version 450 core
// passes/wave_rows.comp — the spectrum at a time, transformed along x.
// Reads h0 and turns; writes fields. A workgroup a row (x) and cascade (y).
//
// Real fields travel in pairs, one in the real and one in the imaginary part, and pairs in twos:
//   0  height, d Dx / dy; slopes   1  displacements Dx, Dy; d Dx / dx, d Dy / dy
// D = i k / |k| h: towards the crests. (Tessendorf 2001 prints -i in eq. 29, which flattens them.)
#include "shared/wave_block.h"
#ifndef TARN_FFT_N
#define TARN_FFT_N 512
#endif
#ifndef TARN_WAVE_FIELDS
#define TARN_WAVE_FIELDS 2 // pairs of pairs: 1 without displacement
#endif
layout(local_size_x = TARN_FFT_N / 4) in;
layout(binding = TARN_BUFFER_WAVE_H0, std430) readonly buffer H0 { vec4 h0[]; };
layout(binding = TARN_BUFFER_WAVE_TURNS, std430) readonly buffer Turns { uint turns[]; };
layout(binding = TARN_BUFFER_WAVE_FIELDS, std430) writeonly buffer Fields { vec4 fields[]; };
layout(binding = TARN_BUFFER_TWIDDLES, std430) readonly buffer Twiddles { vec2 twiddles[]; };
layout(binding = TARN_BUFFER_WAVE_LIMITS, std430) writeonly buffer Limits { uint limits[]; }; // made anew further on
layout(location = 0) uniform uint now;    // of the loop, in 2^-32
layout(location = 1) uniform vec4 stride; // of wave vectors in each cascade [rad/m]
#define TWIDDLE(n) twiddles[n]
#define TARN_FFT_LANES 1
#include "lib/fft.glsl"

// A + i B for the transforms A and B of two real fields.
vec2 pair(vec2 a, vec2 b) { return vec2(a.x - b.y, a.y + b.x); }
vec2 times_i(vec2 a) { return vec2(-a.y, a.x); }

void main() {
    const uint n = uint(TARN_FFT_N), quarter = n / 4u;
    uint index = gl_LocalInvocationID.x, row = gl_WorkGroupID.x, cascade = gl_WorkGroupID.y;
    float dk = stride[cascade];
    vec2 h[4], k[4];
    float ky = dk * float(row < n / 2u ? int(row) : int(row) - int(n));
    for (int part = 0; part < 4; ++part) {
        uint col = index + uint(part) * quarter;
        uint at = (cascade * n + row) * n + col;
        vec4 both = h0[at];
        // Whole turns vanish in the product of whole numbers.
        float phase = float(turns[at] * now) * (6.28318530718 / 4294967296.0);
        float c = cos(phase), s = sin(phase);
        h[part] = vec2(both.x * c + both.y * s + both.z * c - both.w * s,
                       both.y * c - both.x * s + both.w * c + both.z * s);
        k[part] = vec2(dk * float(col < n / 2u ? int(col) : int(col) - int(n)), ky);
    }
    if (row == 0u && index < uint(TARN_WAVE_LIMITS))
        limits[cascade * uint(TARN_WAVE_LIMITS) + index] = 0u;
    for (int field = 0; field < TARN_WAVE_FIELDS; ++field) {
        barrier();
        for (int part = 0; part < 4; ++part) {
            vec2 q = k[part], along = q / max(length(q), 1e-20), ih = times_i(h[part]);
            fft_line[index + uint(part) * quarter] =
                field == 0 ? vec4(pair(h[part], -along.x * q.y * h[part]), pair(q.x * ih, q.y * ih))
                           : vec4(pair(along.x * ih, along.y * ih), pair(-q.x * along.x * h[part], -q.y * along.y * h[part]));
        }
        fft_inverse(index, 0u);
        uint out_at = ((cascade * uint(TARN_WAVE_FIELDS) + uint(field)) * n + row) * n;
        for (uint part = 0u; part < 4u; ++part)
            fields[out_at + index + part * quarter] = fft_line[index + part * quarter];
    }
}
