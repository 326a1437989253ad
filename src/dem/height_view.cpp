#include "dem/height_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tarn::dem {

namespace {

class HeightBand final : public GDALRasterBand {
public:
    HeightBand(GDALDataset* owner, GDALRasterBand& source, HeightRule rule,
               std::shared_ptr<HeightFindings> findings)
        : source_(source), rule_(std::move(rule)), findings_(std::move(findings)) {
        poDS = owner;
        nBand = 1;
        eDataType = GDT_Float32;
        source.GetBlockSize(&nBlockXSize, &nBlockYSize);
        // A file stored as one huge strip need not be held as one.
        constexpr int most_values = 1 << 20;
        if (double(nBlockXSize) * nBlockYSize > most_values)
            nBlockYSize = std::max(1, most_values / nBlockXSize);
        nRasterXSize = source.GetXSize();
        nRasterYSize = source.GetYSize();
        eAccess = GA_ReadOnly;
    }

    double GetNoDataValue(int* has) override {
        if (has)
            *has = TRUE;
        return std::numeric_limits<double>::quiet_NaN();
    }

protected:
    CPLErr IReadBlock(int x_block, int y_block, void* out) override {
        const int x = x_block * nBlockXSize, y = y_block * nBlockYSize;
        const int cols = std::min(nBlockXSize, nRasterXSize - x);
        const int rows = std::min(nBlockYSize, nRasterYSize - y);
        const auto line = std::size_t(nBlockXSize);
        auto* values = static_cast<float*>(out);
        // Float64 in between: -3.4e38 and 65535 as stored, before anything is scaled.
        std::vector<double> stored(std::size_t(cols) * std::size_t(rows));
        if (source_.RasterIO(GF_Read, x, y, cols, rows, stored.data(), cols, rows, GDT_Float64, 0,
                             0) != CE_None)
            return CE_Failure;
        std::vector<unsigned char> mask;
        if (rule_.use_mask) {
            mask.resize(stored.size());
            if (source_.GetMaskBand()->RasterIO(GF_Read, x, y, cols, rows, mask.data(), cols, rows,
                                                GDT_Byte, 0, 0) != CE_None)
                return CE_Failure;
        }
        for (int r = 0; r < rows; ++r)
            for (int c = 0; c < cols; ++c) {
                const auto i = std::size_t(r) * std::size_t(cols) + std::size_t(c);
                const bool masked = rule_.use_mask && mask[i] == 0;
                values[std::size_t(r) * line + std::size_t(c)] =
                    masked ? std::numeric_limits<float>::quiet_NaN() : metres(stored[i]);
            }
        return CE_None;
    }

private:
    float metres(double stored) const {
        constexpr float none = std::numeric_limits<float>::quiet_NaN();
        for (const double v : rule_.void_values) // as float: how most files hold what they declare
            if (stored == v || static_cast<float>(stored) == static_cast<float>(v))
                return none;
        if (!std::isfinite(stored) ||
            (rule_.find_forgotten && (stored == -9999.0 || stored == -32768.0))) {
            if (rule_.find_forgotten)
                findings_->forgotten = true;
            return none;
        }
        const double z = rule_.factor * (rule_.offset + rule_.scale * stored);
        return std::abs(z) < 12'000.0 ? static_cast<float>(z) : none;
    }

    GDALRasterBand& source_;
    HeightRule rule_;
    std::shared_ptr<HeightFindings> findings_;
};

class HeightDataset final : public GDALDataset {
public:
    HeightDataset(GDALDataset& source, int band, HeightRule rule,
                  std::shared_ptr<HeightFindings> findings) {
        nRasterXSize = source.GetRasterXSize();
        nRasterYSize = source.GetRasterYSize();
        eAccess = GA_ReadOnly;
        // A VRT keeps nameless datasets of this driver as they are; others it opens by name.
        poDriver = GetGDALDriverManager()->GetDriverByName("MEM");
        has_transform_ = source.GetGeoTransform(transform_.v) == CE_None;
        SetBand(1, new HeightBand(this, *source.GetRasterBand(band), std::move(rule),
                                  std::move(findings)));
    }

    CPLErr GetGeoTransform(double* out) override {
        std::copy(transform_.v, transform_.v + 6, out);
        return has_transform_ ? CE_None : CE_Failure;
    }
    CPLErr SetGeoTransform(double* in) override {
        std::copy(in, in + 6, transform_.v);
        has_transform_ = true;
        return CE_None;
    }
    const OGRSpatialReference* GetSpatialRef() const override {
        return crs_.IsEmpty() ? nullptr : &crs_;
    }
    CPLErr SetSpatialRef(const OGRSpatialReference* crs) override {
        crs_ = crs ? *crs : OGRSpatialReference();
        return CE_None;
    }

private:
    GeoTransform transform_;
    bool has_transform_ = false;
    OGRSpatialReference crs_;
};

} // namespace

Dataset view_heights(GDALDataset& source, int band, HeightRule rule,
                     std::shared_ptr<HeightFindings> findings) {
    return Dataset(new HeightDataset(source, band, std::move(rule), std::move(findings)));
}

} // namespace tarn::dem
