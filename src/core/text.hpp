#pragma once
/// @file text.hpp  Streams its arguments into one string (std::format needs GCC 13).
#include <sstream>
#include <string>

namespace tarn {

template <class... Parts>
std::string text(const Parts&... parts) {
    std::ostringstream out;
    out.precision(12); // a coordinate in metres keeps its millimetres
    (out << ... << parts);
    return out.str();
}

/// `value` with exactly `digits` decimals.
inline std::string fixed(double value, int digits) {
    std::ostringstream out;
    out.setf(std::ios::fixed);
    out.precision(digits);
    out << value;
    return out.str();
}

} // namespace tarn
