#pragma once
/// @file bowl_scene.hpp  The bowl sample as DEM and scene, for tests of the program.
#include "support/files.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <string>

namespace tarn::test_support {

/// One bowl scene for all tests of this program.
struct Shared {
    TempFolder folder;
    std::string dem, scene;
    Shared() : dem((folder / "bowl.tif").string()), scene((folder / "bowl").string()) {
        EXPECT_EQ(std::system((std::string(TARN_SAMPLES_PROGRAM) + " " + folder.path().string() +
                               " bowl >/dev/null")
                                  .c_str()),
                  0);
        const Outcome made = run("tarn import " + dem + " --level 10 --name Bowl -o " + scene);
        EXPECT_EQ(made.code, 0) << made.err;
        EXPECT_NE(made.out.find("wrote " + scene), std::string::npos);
    }
};

inline Shared& shared() {
    static Shared once;
    return once;
}

inline int lines(const std::string& text) {
    return int(std::count(text.begin(), text.end(), '\n'));
}

/// Failure is exit code 1 or 2 and exactly one line on stderr, nothing on stdout.
inline void expect_one_line(const std::string& command, int code, const std::string& words) {
    const Outcome o = run(command);
    EXPECT_EQ(o.code, code) << command << "\n" << o.err;
    EXPECT_NE(o.err.find(words), std::string::npos) << command << "\n" << o.err;
    if (code == 1) {
        EXPECT_EQ(lines(o.err), 1) << o.err;
        EXPECT_EQ(o.out, "");
    }
}

} // namespace tarn::test_support
