#pragma once
/// @file parallel.hpp  A loop over rows shared out between threads.
#include <algorithm>
#include <exception>
#include <thread>
#include <vector>

namespace tarn {

/// Calls work(first, last) for parts of [0, count), one part a thread, and waits for all. The parts
/// must not write to the same memory. The first exception is thrown on after all have ended.
/// @param threads  0: all cores
template <class Work>
void share_out(int count, int threads, Work work) {
    const int cores = threads > 0 ? threads : std::max(1, int(std::thread::hardware_concurrency()));
    const int parts = std::clamp(count / 16, 1, cores); // a thread costs as much as some rows
    const auto bound = [&](int k) { return int(static_cast<long long>(count) * k / parts); };
    std::vector<std::exception_ptr> failures(static_cast<std::size_t>(parts));
    const auto run = [&](int k) {
        try {
            work(bound(k), bound(k + 1));
        } catch (...) {
            failures[static_cast<std::size_t>(k)] = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> others;
        for (int k = 1; k < parts; ++k)
            others.emplace_back(run, k);
        run(0);
    }
    for (const std::exception_ptr& failure : failures)
        if (failure)
            std::rethrow_exception(failure);
}

} // namespace tarn
