#pragma once
/// @file checksum.hpp  A number that changes with every byte: for telling one content from another,
/// not for
///                     keeping anybody out.
#include <cstddef>
#include <cstdint>

namespace tarn {

/// FNV-1a with 64 bits (Fowler, Noll & Vo).
class Checksum {
public:
    void add(const void* data, std::size_t bytes) {
        const auto* at = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < bytes; ++i)
            sum_ = (sum_ ^ at[i]) * 1099511628211ull;
    }
    std::uint64_t value() const { return sum_; }

private:
    std::uint64_t sum_ = 14695981039346656037ull;
};

} // namespace tarn
