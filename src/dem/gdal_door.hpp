#pragma once
/// @file gdal_door.hpp  GDAL's C++ classes behind RAII, and its messages as tarn::Error.
#include "core/grid.hpp"
#include "core/progress.hpp"

#include <cpl_error.h>
#include <gdal_priv.h>
#include <memory>
#include <string>
#include <vector>

namespace tarn::dem {

using Dataset = GDALDatasetUniquePtr;

/// Collects GDAL's messages on this thread instead of letting them go to stderr.
class GdalMessages {
public:
    GdalMessages();
    ~GdalMessages();
    GdalMessages(const GdalMessages&) = delete;
    GdalMessages& operator=(const GdalMessages&) = delete;
    std::string last() const; ///< the newest warning or error, or "no further message"
    bool warned() const { return !kept_.last.empty(); }
    bool failed() const { return kept_.failed; } ///< an error (not only warnings) was said

    struct Kept {
        std::string last;
        bool failed = false;
    };

private:
    Kept kept_;
};

/// Options of the gdal* utility functions ("-r", "bilinear", ...), freed on scope exit.
class Arguments {
public:
    Arguments(std::initializer_list<std::string> words);
    void add(const std::string& word) { list_.AddString(word.c_str()); }
    char** get() { return list_.List(); }

private:
    CPLStringList list_;
};

/// Feeds GDAL's progress callback into ours; `check()` rethrows a cancellation.
class GdalProgress {
public:
    GdalProgress(const Progress& progress, std::string what, double from, double to)
        : progress_(progress), what_(std::move(what)), from_(from), to_(to) {}
    static int CPL_STDCALL callback(double fraction, const char*, void* self);
    void check() const {
        if (cancelled_)
            throw Cancelled();
    }

private:
    const Progress& progress_;
    std::string what_;
    double from_, to_;
    bool cancelled_ = false;
};

/// Sets GDAL's options for this thread as long as it lives.
class ThreadOptions {
public:
    ThreadOptions(std::initializer_list<std::pair<const char*, std::string>> options);
    ~ThreadOptions();
    ThreadOptions(const ThreadOptions&) = delete;
    ThreadOptions& operator=(const ThreadOptions&) = delete;

private:
    std::vector<std::pair<std::string, std::string>> before_; ///< "" = was not set
};

/// A MEM dataset of one band over our own memory; nothing is copied.
/// @throws tarn::Error  if GDAL has no memory for it
Dataset wrap_memory(void* data, GridSize size, GDALDataType type);

/// Registers the drivers once; safe to call often.
void register_drivers();

/// The affine of an axis-aligned raster.
struct GeoTransform {
    double v[6] = {0, 1, 0, 0, 0, 1};
    bool north_up() const { return v[2] == 0.0 && v[4] == 0.0 && v[1] > 0.0 && v[5] < 0.0; }
};

} // namespace tarn::dem
