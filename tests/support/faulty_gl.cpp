// A GPU that fails, for tests: put before libOpenGL by LD_PRELOAD. TARN_TEST_GL_FAULT says how:
//   memory:texture  there is no memory for the third texture
//   memory:draw     nor for what the first dispatch needs
//   lost            the driver resets the GPU at the first dispatch; from then on nothing is drawn
//   or read
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>

namespace {

constexpr unsigned out_of_memory = 0x0505, context_lost = 0x0507;
unsigned pending = 0;
bool lost = false;
int textures = 0;

bool is(const char* fault) {
    const char* asked = std::getenv("TARN_TEST_GL_FAULT");
    return asked && !std::strcmp(asked, fault);
}

template <class Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

} // namespace

extern "C" {

unsigned glGetError() {
    if (lost)
        return context_lost;
    if (const unsigned code = pending) {
        pending = 0;
        return code;
    }
    return next<unsigned()>("glGetError")();
}

void glTextureStorage2D(unsigned texture, int levels, unsigned format, int width, int height) {
    if (is("memory:texture") && ++textures == 3)
        pending = out_of_memory;
    else
        next<void(unsigned, int, unsigned, int, int)>("glTextureStorage2D")(texture, levels, format,
                                                                            width, height);
}

void glDispatchCompute(unsigned x, unsigned y, unsigned z) {
    if (is("memory:draw"))
        pending = out_of_memory;
    else if (is("lost"))
        lost = true;
    else
        next<void(unsigned, unsigned, unsigned)>("glDispatchCompute")(x, y, z);
}

void glGetTextureImage(unsigned texture, int level, unsigned format, unsigned type, int bytes,
                       void* out) {
    if (!lost)
        next<void(unsigned, int, unsigned, unsigned, int, void*)>("glGetTextureImage")(
            texture, level, format, type, bytes, out);
}

} // extern "C"
