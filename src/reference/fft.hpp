#pragma once
/// @file fft.hpp  Double-precision twin of shaders/lib/fft.glsl: FFTW's door.
#include <complex>
#include <vector>

namespace tarn::reference {

using Complex = std::complex<double>;

/// Same contract as the GLSL function of the same name: out[n] = sum of in[m] exp(2 pi i m n / N).
std::vector<Complex> fft_inverse(std::vector<Complex> line);

/// The same over both axes of side x side numbers, row-major.
std::vector<Complex> fft_inverse_2d(std::vector<Complex> grid, int side);

/// Forward (exp(-2 pi i ...)) over the three axes of frames x side x side numbers.
std::vector<Complex> fft_forward_3d(std::vector<Complex> frames, int count, int side);

} // namespace tarn::reference
