#pragma once
/// @file words.hpp  Lists as benchmarks take them on the command line.
#include <algorithm>
#include <string>
#include <vector>

namespace tarn::test_support {

/// "a,b,c" -> a, b, c
inline std::vector<std::string> split(const std::string& words) {
    std::vector<std::string> out;
    std::size_t from = 0;
    while (from <= words.size()) {
        const std::size_t comma = std::min(words.find(',', from), words.size());
        out.push_back(words.substr(from, comma - from));
        from = comma + 1;
    }
    return out;
}

} // namespace tarn::test_support
