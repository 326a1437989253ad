// lib/fft.glsl — Fourier transform of lines of N pairs of complex numbers, two transforms side by side in xy and zw,
// by the invocations of a workgroup together.
// The one library file with a global: the lines are in shared memory. C++ twin: src/reference/fft.hpp
//
// A program defines TARN_FFT_N (a power of two, 16 to 2048) and TARN_FFT_LANES (lines side by side), has
// N / 4 invocations a lane, and puts its numbers into fft_line[index * TARN_FFT_LANES + lane].
// Source  self-sorting radix-4 transform (Stockham; Govindaraju et al. 2008, HPC on GPUs), a last radix-2
//         pass where N is no power of four. Twiddles come from a table, not from the driver's sine.

shared vec4 fft_line[TARN_FFT_N * TARN_FFT_LANES];

// Both numbers of a pair times one.
vec4 complex_product(vec4 a, vec2 b) { return a * b.x + vec4(-a.y, a.x, -a.w, a.z) * b.y; }

// fft_inverse — in place: line[n] = sum over m of line[m] exp(2 pi i m n / N). Not divided by N.
//
//   index    of the invocation in its lane, [0, N / 4)
//   TWIDDLE  a macro of the program: TWIDDLE(n) = exp(2 pi i n / N)
// Ends with a barrier: the results may be read at once.
void fft_inverse(uint index, uint lane) {
    const uint quarter = uint(TARN_FFT_N / 4);
    uint done = 1u; // length of the transforms that are finished
    barrier();
    for (; done * 4u <= uint(TARN_FFT_N); done *= 4u) {
        uint k = index & (done - 1u), turn = k * (quarter / done);
        vec4 a = fft_line[index * TARN_FFT_LANES + lane];
        vec4 b = complex_product(fft_line[(index + quarter) * TARN_FFT_LANES + lane], TWIDDLE(turn));
        vec4 c = complex_product(fft_line[(index + 2u * quarter) * TARN_FFT_LANES + lane], TWIDDLE(2u * turn));
        vec4 d = complex_product(fft_line[(index + 3u * quarter) * TARN_FFT_LANES + lane], TWIDDLE(3u * turn));
        vec4 ac = a + c, a_c = a - c, bd = b + d, less = b - d;
        vec4 b_d = vec4(-less.y, less.x, -less.w, less.z); // i (b - d)
        uint to = ((index - k) * 4u + k) * TARN_FFT_LANES + lane, stride = done * TARN_FFT_LANES;
        barrier();
        fft_line[to] = ac + bd;
        fft_line[to + stride] = a_c + b_d;
        fft_line[to + 2u * stride] = ac - bd;
        fft_line[to + 3u * stride] = a_c - b_d;
        barrier();
    }
    if (done < uint(TARN_FFT_N)) {
        const uint middle = 2u * quarter;
        for (uint j = index; j < middle; j += quarter) { // each pair stays in its places
            vec4 a = fft_line[j * TARN_FFT_LANES + lane];
            vec4 b = complex_product(fft_line[(j + middle) * TARN_FFT_LANES + lane], TWIDDLE(j));
            fft_line[j * TARN_FFT_LANES + lane] = a + b;
            fft_line[(j + middle) * TARN_FFT_LANES + lane] = a - b;
        }
        barrier();
    }
}
