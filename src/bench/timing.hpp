#pragma once
/// @file timing.hpp  How long the GPU takes for something.
#include <functional>
#include <string>
#include <vector>

namespace tarn::bench {

struct Times {
    double median_ms = 0, low_ms = 0, high_ms = 0; ///< low and high: quartiles
    const char* clock = "";                        ///< which one was used
};

/// GPU timer where it works, else from finish to finish with the CPU's clock (software GL answers
/// about a nanosecond to every timer query). Warms up for a third of a second first, at least
/// twice: long enough for a GPU to leave its idle clock.
/// @param work  issues GL commands; the context must be current
/// @param runs  at least 1
Times time_on_gpu(const std::function<void()>& work, int runs);

/// Median time of each part of a piece of work.
struct PartTime {
    std::string name;
    double median_ms = 0;
};

/// @param work  issues GL commands and calls what it is given before each of its parts by its name,
///              and with "end" after the last
std::vector<PartTime>
time_parts(const std::function<void(const std::function<void(const char*)>&)>& work, int runs);

} // namespace tarn::bench
