#pragma once
/// @file checksums.hpp  Sums up files on a thread of its own while other work goes on.
#include "core/progress.hpp"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace tarn::dem {

/// Files are summed one after another; the destructor stops in the middle of one.
class Checksums {
public:
    Checksums() = default;
    ~Checksums();
    Checksums(const Checksums&) = delete;
    Checksums& operator=(const Checksums&) = delete;

    /// Files added wait until start(): reading and warping the same files has all cores busy.
    void add(const std::string& path);
    void start();
    /// Waits for all; in the order they were added.
    /// @throws tarn::Cancelled
    std::vector<std::string> finish(const Progress& progress);

private:
    void work();
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::string> paths_, sums_; ///< under mutex_
    bool started_ = false;                  ///< under mutex_
    bool closed_ = false;                   ///< under mutex_: no more will come
    std::atomic<bool> stop_{false};
    std::thread worker_;
};

/// CRC-32 (as zip has it) of a file's bytes, hexadecimal; empty if `stop` was set meanwhile. Files
/// on the network are not fetched for it.
std::string checksum(const std::string& path, const std::atomic<bool>& stop);

} // namespace tarn::dem
