#include "dem/gdal_door.hpp"

#include "core/error.hpp"

#include <cpl_conv.h>

#include <mutex>

namespace tarn::dem {

namespace {
void CPL_STDCALL keep(CPLErr level, CPLErrorNum, const char* message) {
    auto& kept = *static_cast<GdalMessages::Kept*>(CPLGetErrorHandlerUserData());
    if (level >= CE_Warning)
        kept.last = message;
    kept.failed |= level >= CE_Failure;
}
} // namespace

GdalMessages::GdalMessages() { CPLPushErrorHandlerEx(keep, &kept_); }
GdalMessages::~GdalMessages() { CPLPopErrorHandler(); }
std::string GdalMessages::last() const {
    return kept_.last.empty() ? "no further message" : kept_.last;
}

Arguments::Arguments(std::initializer_list<std::string> words) {
    for (const auto& word : words)
        add(word);
}

int CPL_STDCALL GdalProgress::callback(double fraction, const char*, void* self) {
    auto& me = *static_cast<GdalProgress*>(self);
    try { // an exception must not travel through GDAL's frames
        me.progress_.report(me.from_ + fraction * (me.to_ - me.from_), me.what_);
    } catch (const Cancelled&) {
        me.cancelled_ = true;
        return FALSE;
    }
    return TRUE;
}

ThreadOptions::ThreadOptions(std::initializer_list<std::pair<const char*, std::string>> options) {
    for (const auto& [name, value] : options) {
        const char* old = CPLGetThreadLocalConfigOption(name, nullptr);
        before_.emplace_back(name, old ? old : "");
        CPLSetThreadLocalConfigOption(name, value.c_str());
    }
}

ThreadOptions::~ThreadOptions() {
    for (const auto& [name, value] : before_)
        CPLSetThreadLocalConfigOption(name.c_str(), value.empty() ? nullptr : value.c_str());
}

Dataset wrap_memory(void* data, GridSize size, GDALDataType type) {
    register_drivers();
    auto* driver = GetGDALDriverManager()->GetDriverByName("MEM");
    Dataset out(driver->Create("", size.cols, size.rows, 0, type, nullptr));
    char pointer[64] = {};
    CPLPrintPointer(pointer, data, sizeof pointer - 1);
    CPLStringList options;
    options.SetNameValue("DATAPOINTER", pointer);
    if (!out || out->AddBand(type, options.List()) != CE_None)
        throw Error("out of memory");
    return out;
}

void register_drivers() {
    static std::once_flag once;
    std::call_once(once, [] {
        GDALAllRegister();
        // GDAL would keep a twentieth of all memory in blocks; streaming needs far less.
        if (!CPLGetConfigOption("GDAL_CACHEMAX", nullptr))
            GDALSetCacheMax64(GIntBig(64) << 20);
    });
}

} // namespace tarn::dem
