#include "bench/timing.hpp"

#include "gpu/objects.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

namespace tarn::bench {

Times time_on_gpu(const std::function<void()>& work, int runs) {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    for (int i = 0; i < 2 || Clock::now() - begin < std::chrono::milliseconds(330); ++i) {
        work();
        glFinish();
    }
    std::vector<double> gpu, cpu;
    gpu::Timer timer;
    for (int i = 0; i < std::max(1, runs); ++i) {
        const auto start = Clock::now();
        timer.start();
        work();
        timer.stop();
        glFinish();
        cpu.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
        gpu.push_back(timer.milliseconds());
    }
    std::sort(gpu.begin(), gpu.end());
    std::sort(cpu.begin(), cpu.end());
    const std::size_t n = gpu.size();
    const bool usable = gpu[n / 2] > 1e-3;
    const auto& t = usable ? gpu : cpu;
    return {t[n / 2], t[n / 4], t[n * 3 / 4], usable ? "gpu timer" : "finish to finish"};
}

} // namespace tarn::bench
