#include "core/error.hpp"

#include <utility>

namespace tarn {

Error::Error(std::string cause, std::string hint)
    : cause_(std::move(cause)), hint_(std::move(hint)) {
    rebuild();
}

Error& Error::during(std::string_view activity) {
    activities_ = std::string(activity) + ": " + activities_;
    rebuild();
    return *this;
}

void Error::rebuild() {
    text_ = activities_ + cause_;
    if (!hint_.empty())
        text_ += "; " + hint_;
    for (char& c : text_) // libraries' messages may hold line breaks; ours are one line
        if (c == '\n' || c == '\r')
            c = ' ';
}

} // namespace tarn
