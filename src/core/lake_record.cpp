#include "core/lake_record.hpp"

#include "core/error.hpp"

namespace tarn {

namespace {
constexpr const char* words[] = {"measured", "interpolated", "estimated", "unknown"};
}

std::string to_string(Bed bed) { return words[static_cast<int>(bed)]; }

Bed bed_from_string(const std::string& word) {
    for (int i = 0; i < 4; ++i)
        if (word == words[i])
            return static_cast<Bed>(i);
    throw Error("bed is '" + word + "'", "use measured, interpolated, estimated or unknown");
}

} // namespace tarn
