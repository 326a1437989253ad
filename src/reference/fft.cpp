#include "reference/fft.hpp"

#include <fftw3.h>
#include <mutex>

namespace tarn::reference {

namespace {

std::mutex planning; // FFTW's planner may run in one thread at a time

std::vector<Complex> transform(std::vector<Complex> data, std::vector<int> sides, int sign) {
    auto* numbers =
        reinterpret_cast<fftw_complex*>(data.data()); // the same layout, by the standard
    fftw_plan plan;
    {
        const std::lock_guard lock(planning);
        plan =
            fftw_plan_dft(int(sides.size()), sides.data(), numbers, numbers, sign, FFTW_ESTIMATE);
    }
    fftw_execute(plan);
    const std::lock_guard lock(planning);
    fftw_destroy_plan(plan);
    return data;
}

} // namespace

std::vector<Complex> fft_inverse(std::vector<Complex> line) {
    const int n = int(line.size());
    return transform(std::move(line), {n}, FFTW_BACKWARD);
}

std::vector<Complex> fft_inverse_2d(std::vector<Complex> grid, int side) {
    return transform(std::move(grid), {side, side}, FFTW_BACKWARD);
}

std::vector<Complex> fft_forward_3d(std::vector<Complex> frames, int count, int side) {
    return transform(std::move(frames), {count, side, side}, FFTW_FORWARD);
}

} // namespace tarn::reference
