#include "gpu/context.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <cstring>
#include <functional>

namespace tarn::gpu {

namespace {

std::string egl_error() {
    std::ostringstream out;
    out << "EGL error 0x" << std::hex << eglGetError();
    return out.str();
}

struct Way {
    std::string name;
    std::function<EGLDisplay()> open;
};

/// The ways in the order of preference. Client extensions say which platforms exist.
std::vector<Way> ways() {
    std::vector<Way> out;
    const char* text_of = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    const std::string extensions = text_of ? text_of : "";
    if (extensions.find("EGL_MESA_platform_surfaceless") != std::string::npos)
        out.push_back({"surfaceless", [] {
                           return eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA,
                                                        EGL_DEFAULT_DISPLAY, nullptr);
                       }});
    const auto query =
        reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    if (query && extensions.find("EGL_EXT_platform_device") != std::string::npos) {
        EGLDeviceEXT devices[16];
        EGLint count = 0;
        if (query(16, devices, &count))
            for (EGLint i = 0; i < count; ++i)
                out.push_back({text("device ", i), [device = devices[i]] {
                                   return eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, device,
                                                                nullptr);
                               }});
    }
    out.push_back({"default", [] { return eglGetDisplay(EGL_DEFAULT_DISPLAY); }});
    return out;
}

/// Context on an initialised display, or null with `why` set.
EGLContext create(EGLDisplay display, std::string& why) {
    if (!eglBindAPI(EGL_OPENGL_API)) {
        why = "no desktop OpenGL (" + egl_error() + ")";
        return nullptr;
    }
    const EGLint wanted_config[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0,
                                    EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!eglChooseConfig(display, wanted_config, &config, 1, &count) || count == 0) {
        why = "no OpenGL configuration (" + egl_error() + ")";
        return nullptr;
    }
    const EGLint wanted[] = {EGL_CONTEXT_MAJOR_VERSION,
                             4,
                             EGL_CONTEXT_MINOR_VERSION,
                             5,
                             EGL_CONTEXT_OPENGL_PROFILE_MASK,
                             EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                             EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                             EGL_LOSE_CONTEXT_ON_RESET, // then check_gl() is told of it
                             EGL_NONE};
    EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, wanted);
    if (!context) { // drivers that know no such notice
        EGLint plain[std::size(wanted)];
        std::copy(std::begin(wanted), std::end(wanted), plain);
        plain[std::size(wanted) - 3] = EGL_NONE;
        context = eglCreateContext(display, config, EGL_NO_CONTEXT, plain);
    }
    if (!context) {
        why = "OpenGL 4.5 core is not offered (" + egl_error() + ")";
        return nullptr;
    }
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        why = "the context cannot be made current (" + egl_error() + ")";
        eglDestroyContext(display, context);
        return nullptr;
    }
    return context;
}

} // namespace

Context::Context() {
    std::string tried;
    for (const Way& way : ways()) {
        EGLDisplay display = way.open();
        std::string why;
        if (!display || !eglInitialize(display, nullptr, nullptr)) {
            why = "no display (" + egl_error() + ")";
        } else if (EGLContext context = create(display, why)) {
            display_ = display;
            context_ = context;
            way_ = way.name;
            return;
        } else {
            eglTerminate(display);
        }
        tried += (tried.empty() ? "" : ", ") + way.name + ": " + why;
    }
    throw Error("no OpenGL 4.5 context without a window; tried " + tried,
                "install a driver (Debian: libegl-mesa0 libgl1-mesa-dri) and run tarn doctor");
}

Context::~Context() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglTerminate(display_);
}

std::string Context::renderer() const {
    return reinterpret_cast<const char*>(glGetString(GL_RENDERER));
}

std::string Context::version() const {
    return reinterpret_cast<const char*>(glGetString(GL_VERSION));
}

int Context::max_texture_side_px() const {
    GLint side = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
    return side;
}

bool is_software() {
    const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    const std::string renderer = name ? name : "";
    return renderer.find("llvmpipe") != std::string::npos ||
           renderer.find("softpipe") != std::string::npos;
}

std::vector<DisplayAttempt> probe_displays() {
    std::vector<DisplayAttempt> out;
    for (const Way& way : ways()) {
        DisplayAttempt attempt{.way = way.name, .result = {}};
        EGLDisplay display = way.open();
        EGLint major = 0, minor = 0;
        if (display && eglInitialize(display, &major, &minor)) {
            const char* vendor = eglQueryString(display, EGL_VENDOR);
            attempt.ok = true;
            attempt.result = text(vendor ? vendor : "unknown vendor", ", EGL ", major, ".", minor);
            eglTerminate(display);
        } else {
            attempt.result = "no display (" + egl_error() + ")";
        }
        out.push_back(attempt);
    }
    return out;
}

} // namespace tarn::gpu
