#pragma once
/// @file context.hpp  An OpenGL 4.5 core context without a window.
#include "gpu/gl.hpp"

#include <string>
#include <vector>

namespace tarn::gpu {

/// One way of getting a display without a screen, and how it went.
struct DisplayAttempt {
    std::string way;    ///< "surfaceless", "device 0", "default"
    std::string result; ///< "ok: vendor, EGL version" or what failed
    bool ok = false;
};

class Context {
public:
    /// Tries EGL's surfaceless platform, then each EGL device, then the default display, and makes
    /// the context current on this thread.
    /// @throws tarn::Error  saying for each way what failed
    Context();
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    std::string renderer() const; ///< GL_RENDERER, for logs and benchmark labels
    std::string version() const;  ///< GL_VERSION
    std::string way() const { return way_; }
    int max_texture_side_px() const;

private:
    void* display_ = nullptr;
    void* context_ = nullptr;
    std::string way_;
};

/// Is the current context drawn by the CPU (Mesa's llvmpipe and softpipe)?
bool is_software();

/// Every headless way this machine offers, for `tarn doctor`. Creates no context.
std::vector<DisplayAttempt> probe_displays();

} // namespace tarn::gpu
