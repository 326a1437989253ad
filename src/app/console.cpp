#include "app/console.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <atomic>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace tarn::app {

namespace {

std::atomic<bool> stop_asked{false};
bool bar_shown = false;

volatile std::time_t first_asked = 0;

extern "C" void on_interrupt(int signal_number) {
    const std::time_t now = std::time(nullptr); // one of the few calls that a handler may make
    if (!stop_asked.exchange(true)) {
        first_asked = now;
    } else if (now - first_asked >= 2) { // asked again, not told twice at once by the terminal
        std::signal(signal_number, SIG_DFL);
        std::raise(signal_number);
    }
}

double parse_number(const std::string& option, std::string word) {
    while (!word.empty() && word.front() == ' ')
        word.erase(0, 1);
    while (!word.empty() && word.back() == ' ')
        word.pop_back();
    double value = 0.0;
    const char* first = word.c_str() + (!word.empty() && word[0] == '+');
    const auto [end, code] = std::from_chars(first, word.c_str() + word.size(), value);
    if (word.empty() || code != std::errc() || *end != '\0' || !std::isfinite(value))
        throw Error(option + ": '" + word + "' is no number");
    return value;
}

} // namespace

void catch_interrupts() {
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
}

bool interrupted() { return stop_asked.load(); }

Progress console_progress() {
    const bool terminal = ::isatty(STDERR_FILENO);
    return Progress([terminal, last = -1](double fraction, const std::string& what) mutable {
        const int percent = int(100.0 * fraction);
        if (terminal && percent != last) {
            last = percent;
            const int full = percent * 30 / 100;
            std::fprintf(stderr, "\r\033[K[%.*s%.*s] %3d %%  %s", full,
                         "##############################", 30 - full,
                         "..............................", percent, what.c_str());
            std::fflush(stderr);
            bar_shown = true;
        }
        return !stop_asked.load();
    });
}

void end_progress() {
    if (bar_shown)
        std::fprintf(stderr, "\r\033[K");
    bar_shown = false;
}

std::string shell_word(const std::string& word) {
    if (!word.empty() && word.find_first_of(" '\"\\$`*?;&|<>(){}[]#~!\n") == std::string::npos)
        return word;
    std::string out = "'";
    for (const char c : word)
        out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

std::vector<double> parse_numbers(const std::string& option, const std::string& words,
                                  std::size_t count) {
    std::vector<double> out;
    std::size_t from = 0;
    while (true) {
        const std::size_t comma = words.find(',', from);
        out.push_back(parse_number(option, words.substr(from, comma - from)));
        if (comma == std::string::npos)
            break;
        from = comma + 1;
    }
    if (out.size() != count)
        throw Error(text(option, " '", words, "': need ", count,
                         " numbers with commas between, got ", out.size()));
    return out;
}

glm::dvec3 parse_triple(const std::string& option, const std::string& words) {
    if (words.find(',') == std::string::npos)
        return glm::dvec3(parse_numbers(option, words, 1)[0]);
    const auto v = parse_numbers(option, words, 3);
    return {v[0], v[1], v[2]};
}

GeoPoint parse_place(const std::string& option, const std::string& words) {
    const auto v = parse_numbers(option, words, 2);
    if (std::abs(v[0]) > 90.0 || std::abs(v[1]) > 360.0)
        throw Error(option + " '" + words + "' is not on Earth",
                    "latitude first, then longitude, in degrees; south and west are negative");
    return {v[0], v[1]};
}

std::string format_area(double m2) {
    return m2 >= 1e6 ? fixed(m2 / 1e6, 3) + " km2" : fixed(m2, 0) + " m2";
}

std::string format_volume(double m3) {
    return m3 >= 1e8   ? fixed(m3 / 1e9, 4) + " km3"
           : m3 >= 1e6 ? fixed(m3 / 1e6, 3) + " million m3"
                       : fixed(m3, 0) + " m3";
}

void write_beside(const std::string& path, const std::string& content) {
    const std::string partial = path + text(".partial-", ::getpid());
    std::ofstream out(partial, std::ios::binary);
    out << content;
    out.close();
    std::error_code failed;
    if (out)
        std::filesystem::rename(partial, path, failed);
    if (!out || failed) {
        std::filesystem::remove(partial, failed);
        throw Error(path + ": cannot be written",
                    "check the folder, its permissions and free space");
    }
}

} // namespace tarn::app
