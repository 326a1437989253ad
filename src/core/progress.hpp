#pragma once
/// @file progress.hpp  How long work tells its caller where it stands, and hears that it may stop.
#include "core/error.hpp"

#include <functional>
#include <string>
#include <utility>

namespace tarn {

class Progress {
public:
    /// Shows `fraction` in [0, 1] of the step named `what`; returns false to ask for a stop.
    using Listener = std::function<bool(double fraction, const std::string& what)>;

    Progress() = default;
    explicit Progress(Listener listener) : listener_(std::move(listener)) {}

    /// @throws tarn::Cancelled  if the listener asked to stop
    void report(double fraction, const std::string& what) const {
        if (listener_ && !listener_(fraction, what))
            throw Cancelled();
    }

private:
    Listener listener_;
};

} // namespace tarn
