#pragma once
/// @file session_log.hpp  What went on in a window, a JSON object a line: for tests and for
/// figures.
#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace tarn::view {

class SessionLog {
public:
    /// @param path  empty: nothing is written
    /// @throws tarn::Error  if it cannot be written
    explicit SessionLog(const std::string& path) {
        if (path.empty())
            return;
        out_.open(path);
        if (!out_)
            throw Error(path + ": cannot be written", "check the path given with --session-log");
    }
    bool on() const { return out_.is_open(); }

    /// {"t": seconds, "event": "...", and what else}
    void write(double t, const std::string& event,
               const std::vector<std::pair<std::string, double>>& numbers,
               const std::string& words = {}) {
        if (!on())
            return;
        out_ << "{\"t\": " << fixed(t, 3) << ", \"event\": \"" << event << '"';
        for (const auto& [name, value] : numbers)
            out_ << ", \"" << name << "\": " << text(value);
        if (!words.empty()) {
            std::string plain;
            for (const char c : words)
                plain += c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
            out_ << ", \"text\": \"" << plain << '"';
        }
        out_ << "}\n" << std::flush;
    }

    /// A frame of the window took this long; every second of them becomes a line.
    void frame(double t, double ms, bool moving) {
        (moving ? moving_ms_ : resting_ms_).push_back(ms);
        if (t - last_ < 1.0)
            return;
        last_ = t;
        for (auto* list : {&moving_ms_, &resting_ms_}) {
            if (list->empty())
                continue;
            std::sort(list->begin(), list->end());
            write(t, list == &moving_ms_ ? "moving" : "resting",
                  {{"frames", double(list->size())},
                   {"median_ms", (*list)[list->size() / 2]},
                   {"worst_ms", list->back()}});
            list->clear();
        }
    }

private:
    std::ofstream out_;
    std::vector<double> moving_ms_, resting_ms_;
    double last_ = 0.0;
};

} // namespace tarn::view
