#pragma once
/// @file median.hpp  The middle value.
#include <algorithm>
#include <cassert>
#include <vector>

namespace tarn::dem {

/// The upper median of at least one value; their order is lost.
template <class T>
T median(std::vector<T> values) {
    assert(!values.empty());
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

} // namespace tarn::dem
