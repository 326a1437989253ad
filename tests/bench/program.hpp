#pragma once
/// @file program.hpp  What measuring programs share: `--name value` words, and one line where
/// something is wrong.
#include "core/error.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <string>
#include <vector>

namespace tarn::bench {

class Words {
public:
    /// @throws tarn::Error  for a word that is not known, or one without a value
    Words(int argc, char** argv, const std::vector<std::string>& known) {
        for (int i = 1; i < argc; i += 2) {
            const std::string name = argv[i];
            if (std::find(known.begin(), known.end(), name) == known.end())
                throw Error("unknown option " + name);
            if (i + 1 >= argc)
                throw Error(name + " needs a value");
            given_[name] = argv[i + 1];
        }
    }
    std::string text(const std::string& name, const std::string& otherwise = {}) const {
        const auto at = given_.find(name);
        return at == given_.end() ? otherwise : at->second;
    }
    int count(const std::string& name, int otherwise) const {
        return std::max(1, std::atoi(text(name, std::to_string(otherwise)).c_str()));
    }
    double number(const std::string& name, double otherwise) const {
        const auto at = given_.find(name);
        return at == given_.end() ? otherwise : std::atof(at->second.c_str());
    }

private:
    std::map<std::string, std::string> given_;
};

struct PictureSize {
    int width_px = 0, height_px = 0;
};

/// "960x540". @throws tarn::Error
inline PictureSize parse_size(const std::string& words) {
    PictureSize out;
    if (std::sscanf(words.c_str(), "%dx%d", &out.width_px, &out.height_px) != 2)
        throw Error("--size '" + words + "' is not understood");
    return out;
}

/// main() of a program: runs it with its words.
inline int program(int argc, char** argv, const std::vector<std::string>& known,
                   int (*run)(const Words&)) {
    try {
        return run(Words(argc, argv, known));
    } catch (const std::exception& e) {
        std::cerr << e.what() << "\n";
        return 1;
    }
}

} // namespace tarn::bench
