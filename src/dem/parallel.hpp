#pragma once
/// @file parallel.hpp  Independent pieces of work on all cores.
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace tarn::dem {

/// Calls work(i) for i in [0, count), each once, on as many threads as there are cores. The pieces
/// must not write to the same memory. The first exception is thrown on after all have ended.
template <class Work>
void each_in_parallel(int count, Work work) {
    const int threads =
        std::min(count, std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
    std::atomic<int> next{0};
    std::mutex mutex;
    std::exception_ptr failure;
    const auto run = [&] {
        try {
            for (int i = next++; i < count; i = next++)
                work(i);
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!failure)
                failure = std::current_exception();
            next = count;
        }
    };
    std::vector<std::thread> helpers;
    for (int k = 1; k < threads; ++k)
        helpers.emplace_back(run);
    run();
    for (std::thread& helper : helpers)
        helper.join();
    if (failure)
        std::rethrow_exception(failure);
}

} // namespace tarn::dem
