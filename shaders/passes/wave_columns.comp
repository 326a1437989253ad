#version 450 core
// passes/wave_columns.comp — fields transformed along y, in place.
// A workgroup some columns (x), side by side so that memory is read in whole sectors, and a field of a cascade (y).
#include "shared/wave_block.h"
#ifndef TARN_FFT_N
#define TARN_FFT_N 512
#endif
#ifndef TARN_FFT_LANES
#define TARN_FFT_LANES 4
#endif
layout(local_size_x = TARN_FFT_LANES, local_size_y = TARN_FFT_N / 4) in;
layout(binding = TARN_BUFFER_WAVE_FIELDS, std430) buffer Fields { vec4 fields[]; };
layout(binding = TARN_BUFFER_TWIDDLES, std430) readonly buffer Twiddles { vec2 twiddles[]; };
#define TWIDDLE(n) twiddles[n]
#include "lib/fft.glsl"

void main() {
    const uint n = uint(TARN_FFT_N), quarter = n / 4u, lanes = uint(TARN_FFT_LANES);
    uint lane = gl_LocalInvocationID.x, index = gl_LocalInvocationID.y;
    uint first = gl_WorkGroupID.y * n * n + gl_WorkGroupID.x * lanes + lane;
    for (uint part = 0u; part < 4u; ++part)
        fft_line[(index + part * quarter) * lanes + lane] = fields[first + (index + part * quarter) * n];
    fft_inverse(index, lane);
    for (uint part = 0u; part < 4u; ++part)
        fields[first + (index + part * quarter) * n] = fft_line[(index + part * quarter) * lanes + lane];
}
