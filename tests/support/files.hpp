#pragma once
/// @file files.hpp  Temporary folders, the real data sets, and running the program itself.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

namespace tarn::test_support {

/// A folder of this test's own, removed with it.
class TempFolder {
public:
    TempFolder() {
        std::string pattern =
            (std::filesystem::temp_directory_path() / "tarn-test-XXXXXX").string();
        path_ = ::mkdtemp(pattern.data());
    }
    ~TempFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TempFolder(const TempFolder&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// Real elevation data: $TARN_TEST_DATA, or shared/data beside the checkout.
inline std::filesystem::path data(const std::string& name) {
    const char* chosen = std::getenv("TARN_TEST_DATA");
    return std::filesystem::path(chosen ? chosen : TARN_SHARED_DATA) / name;
}

/// First line of a test that needs one of the real data sets: says so where it is absent.
#define TARN_NEEDS_DATA(name)                                                                      \
    if (!std::filesystem::exists(::tarn::test_support::data(name)))                                \
    GTEST_SKIP() << "real data not here: " << ::tarn::test_support::data(name)                     \
                 << " (set TARN_TEST_DATA)"

struct Outcome {
    int code = -1;
    std::string out, err;
};

inline std::string read_file(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Runs a shell command line; "tarn" at its beginning is the program under test.
inline Outcome run(std::string command) {
    const TempFolder folder;
    if (command.starts_with("tarn"))
        command.replace(0, 4, TARN_PROGRAM);
    const std::string line = command + " >'" + (folder / "out").string() + "' 2>'" +
                             (folder / "err").string() + "' </dev/null";
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            read_file(folder / "out"), read_file(folder / "err")};
}

} // namespace tarn::test_support
