// Any bytes as a texture of a scene folder: codes, bytes or heights, or one Error of one line.
#include "core/error.hpp"
#include "image/files.hpp"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tarn;
    static const bool quiet = (image::read_without_threads(), true);
    static const std::string path = "/dev/shm/tarn-fuzz-" + std::to_string(::getpid()) + ".tif";
    (void)quiet;
    if (FILE* out = std::fopen(path.c_str(), "wb")) {
        std::fwrite(data, 1, size, out);
        std::fclose(out);
    }
    for (int kind = 0; kind < 3; ++kind)
        try {
            if (kind == 0)
                image::read_codes(path);
            else if (kind == 1)
                image::read_bytes(path);
            else
                image::read_heights(path);
        } catch (const Error& error) {
            if (std::string(error.what()).find('\n') != std::string::npos)
                std::abort();
        }
    return 0;
}
