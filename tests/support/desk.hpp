#pragma once
/// @file desk.hpp  A screen without a monitor (Xvfb), a program on it, and somebody at keyboard and
/// mouse (xdotool).
#include "image/files.hpp"
#include "support/files.hpp"

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <thread>
#include <vector>

namespace tarn::test_support {

inline void pause(double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

/// A process of its own group, ended with this object.
class Process {
public:
    /// @param out  where its stdout and stderr go
    Process(const std::vector<std::string>& words, const std::string& out,
            const std::string& display = {}) {
        child_ = ::fork();
        if (child_ != 0)
            return;
        ::setpgid(0, 0);
        const int file = ::open(out.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
        ::dup2(file, 1);
        ::dup2(file, 2);
        if (!display.empty())
            ::setenv("DISPLAY", display.c_str(), 1);
        std::vector<char*> arguments;
        for (const std::string& word : words)
            arguments.push_back(const_cast<char*>(word.c_str()));
        arguments.push_back(nullptr);
        ::execvp(arguments[0], arguments.data());
        ::_exit(127);
    }
    ~Process() {
        if (!code_ && child_ > 0) {
            ::kill(-child_, SIGKILL);
            ::waitpid(child_, nullptr, 0);
        }
    }
    Process(const Process&) = delete;

    bool alive() { return !wait(0.0); }
    /// Exit code, 128 and more for a signal; nothing if it still runs after `seconds`.
    std::optional<int> wait(double seconds) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
        while (!code_) {
            int status = 0;
            if (::waitpid(child_, &status, WNOHANG) == child_) {
                code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
                break;
            }
            if (std::chrono::steady_clock::now() >= end)
                return std::nullopt;
            pause(0.02);
        }
        return code_;
    }
    pid_t id() const { return child_; }
    /// Memory that it holds [MB].
    double resident_mb() const {
        std::ifstream in("/proc/" + std::to_string(child_) + "/statm");
        double pages = 0.0, resident = 0.0;
        in >> pages >> resident;
        return resident * double(::sysconf(_SC_PAGESIZE)) / 1e6;
    }

private:
    pid_t child_ = -1;
    std::optional<int> code_;
};

/// Is what a driven window needs installed?
inline bool has_desk() {
    return std::system("command -v Xvfb >/dev/null && command -v xdotool >/dev/null && "
                       "command -v import >/dev/null && command -v xprop >/dev/null") == 0;
}

#define TARN_NEEDS_DESK()                                                                          \
    if (!::tarn::test_support::has_desk())                                                         \
    GTEST_SKIP() << "no Xvfb, xdotool, xprop or import here: scripts/setup test installs them"

/// One screen with one window of `tarn view` on it.
class Desk {
public:
    static constexpr int width_px = 1000, height_px = 860;

    Desk() {
        const std::string number = (folder_ / "display").string();
        // The shell hands its descriptor 3 on: Xvfb writes the number of its display there.
        server_ = std::make_unique<Process>(
            std::vector<std::string>{
                "sh", "-c",
                "exec Xvfb -displayfd 3 -screen 0 1300x900x24 -nolisten tcp -noreset "
                "3>'" +
                    number + "'"},
            (folder_ / "xvfb.log").string());
        for (int i = 0; i < 500 && display_.empty(); ++i) {
            pause(0.02);
            const std::string said = read_file(number);
            if (said.find('\n') != std::string::npos)
                display_ = ":" + said.substr(0, said.find('\n'));
        }
        EXPECT_FALSE(display_.empty()) << read_file(folder_ / "xvfb.log");
    }

    std::string log_path() const { return (folder_ / "session.log").string(); }
    std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

    /// As a screen of fine pixels says to programs that ask: 96 dots an inch is a scale of 1.
    void set_dpi(int dpi) const {
        const std::string line =
            "DISPLAY=" + display_ +
            " xprop -root -f RESOURCE_MANAGER 8s -set RESOURCE_MANAGER 'Xft.dpi:\t" +
            std::to_string(dpi) + "\n'";
        EXPECT_EQ(std::system(line.c_str()), 0);
    }

    /// Starts `tarn view` and waits for its first picture.
    void open(const std::string& scene, std::vector<std::string> more = {},
              const std::string& size = std::to_string(width_px) + "x" +
                                        std::to_string(height_px)) {
        const double patience_s = 60.0;
        std::filesystem::remove(log_path());
        std::vector<std::string> words = {TARN_PROGRAM,
                                          "view",
                                          scene,
                                          "--size",
                                          size,
                                          "--pictures",
                                          folder_.path().string(),
                                          "--session-log",
                                          log_path()};
        words.insert(words.end(), more.begin(), more.end());
        program_ = std::make_unique<Process>(words, (folder_ / "tarn.log").string(), display_);
        ASSERT_TRUE(wait_for("first picture", patience_s)) << read_file(folder_ / "tarn.log");
        focus();
    }
    Process& program() { return *program_; }
    std::string said() const { return read_file(folder_ / "tarn.log"); }

    void xdo(const std::string& words) const {
        const std::string line = "DISPLAY=" + display_ + " xdotool " + words + " >/dev/null 2>&1";
        (void)!std::system(line.c_str());
    }
    /// There is no window manager to give the window the keyboard.
    void focus() const { xdo("search --class tarn windowfocus --sync"); }
    void key(const std::string& name, double then_s = 0.4) const {
        xdo("key " + name);
        pause(then_s);
    }
    void hold(const std::string& name, double seconds) const {
        xdo("keydown " + name);
        pause(seconds);
        xdo("keyup " + name);
        pause(0.4);
    }
    void click(int x, int y, double then_s = 0.5) const {
        xdo("mousemove " + std::to_string(x) + " " + std::to_string(y) + " sleep .25 click 1");
        pause(then_s);
    }

    Picture screenshot(const std::string& name = "shot") const {
        const std::string path = (folder_ / (name + ".png")).string();
        const std::string line =
            "DISPLAY=" + display_ + " import -silent -window root " + path + " 2>/dev/null";
        EXPECT_EQ(std::system(line.c_str()), 0);
        return image::read_rgba(path);
    }

    /// All lines of the session's log so far.
    std::vector<nlohmann::json> log() const {
        std::vector<nlohmann::json> out;
        std::ifstream in(log_path());
        for (std::string line; std::getline(in, line);)
            if (auto one = nlohmann::json::parse(line, nullptr, false); !one.is_discarded())
                out.push_back(one);
        return out;
    }
    /// The newest line of an event; null if there is none.
    nlohmann::json last(const std::string& event) const {
        nlohmann::json out;
        for (const auto& line : log())
            if (line["event"] == event)
                out = line;
        return out;
    }
    int count(const std::string& event) const {
        int out = 0;
        for (const auto& line : log())
            out += line["event"] == event;
        return out;
    }
    bool wait_for(const std::string& event, double seconds, int more_than = 0) {
        for (double waited = 0.0; waited < seconds; waited += 0.1) {
            if (count(event) > more_than)
                return true;
            if (!program_->alive())
                return false;
            pause(0.1);
        }
        return false;
    }

private:
    TempFolder folder_;
    std::string display_;
    std::unique_ptr<Process> server_, program_;
};

} // namespace tarn::test_support
