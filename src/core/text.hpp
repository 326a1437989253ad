#pragma once
/// @file text.hpp  Words from numbers, and from other words. text() streams its arguments into one
/// string (std::format needs GCC 13).
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

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

/// .0123 -> "1.23 %", to so many digits that count.
inline std::string percent(double share, int digits) {
    std::ostringstream out;
    out.precision(digits);
    out << 100.0 * share << " %";
    return out.str();
}

/// 7 with three digits -> "007".
inline std::string numbered(int number, std::size_t digits) {
    const std::string plain = std::to_string(number);
    return plain.size() < digits ? std::string(digits - plain.size(), '0') + plain : plain;
}

/// "a/b/c" by '/' -> a, b, c; parts of no length are left out.
inline std::vector<std::string> split(const std::string& words, char separator) {
    std::vector<std::string> out;
    std::istringstream in(words);
    for (std::string part; std::getline(in, part, separator);)
        if (!part.empty())
            out.push_back(part);
    return out;
}

/// The greatest of 1, 2 and 5 times a power of ten that is not above it, > 0: for scale bars.
inline double round_length(double length) {
    const double decade = std::pow(10.0, std::floor(std::log10(length)));
    return decade * (length / decade >= 5 ? 5 : length / decade >= 2 ? 2 : 1);
}

/// Of a round length: "2 km", "500 m", "20 cm".
inline std::string length_words(double metres) {
    return metres >= 1000 ? fixed(metres / 1000, 0) + " km"
           : metres >= 1  ? fixed(metres, 0) + " m"
                          : fixed(100 * metres, 0) + " cm";
}

} // namespace tarn
