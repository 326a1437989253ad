#pragma once
/// @file parallel.hpp  A loop over rows shared out between threads.
#include <algorithm>
#include <thread>
#include <vector>

namespace tarn {

/// Calls work(first, last) for parts of [0, count), one part a thread, and waits for all.
/// @param threads  0: all cores
template <class Work>
void share_out(int count, int threads, Work work) {
    const int cores = threads > 0 ? threads : std::max(1, int(std::thread::hardware_concurrency()));
    const int parts = std::clamp(count / 16, 1, cores); // a thread costs as much as some rows
    const auto bound = [&](int k) { return int(static_cast<long long>(count) * k / parts); };
    std::vector<std::jthread> others;
    for (int k = 1; k < parts; ++k)
        others.emplace_back([&, k] { work(bound(k), bound(k + 1)); });
    work(0, bound(1));
}

} // namespace tarn
