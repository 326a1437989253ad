#pragma once
/// @file error.hpp  The one exception type: a cause, what we were doing, and what to try.
///
/// Bad input, missing files, failed GL calls and failed shaders throw Error. Broken promises
/// between our own functions are `assert`. Nothing prints and nothing exits outside app/.
#include <exception>
#include <string>
#include <string_view>

namespace tarn {

class Error : public std::exception {
public:
    /// @param cause  what is wrong and where: names the file, field or value
    /// @param hint   what to do about it
    explicit Error(std::string cause, std::string hint = {});

    /// Puts what a caller was doing in front of the cause; rethrow afterwards.
    Error& during(std::string_view activity);

    /// One line: "activity: cause; hint".
    const char* what() const noexcept override { return text_.c_str(); }

private:
    void rebuild();
    std::string activities_, cause_, hint_, text_;
};

/// Thrown by Progress::report when the user asked to stop. Not an Error: nothing is wrong.
class Cancelled : public std::exception {
public:
    const char* what() const noexcept override { return "cancelled; nothing was written"; }
};

} // namespace tarn
