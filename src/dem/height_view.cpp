#include "dem/height_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace tarn::dem {

namespace {

/// What both kinds of view have in common.
class ViewBand : public GDALRasterBand {
public:
    double GetNoDataValue(int* has) override {
        if (has)
            *has = voids_declared ? TRUE : FALSE;
        return voids_declared ? std::numeric_limits<double>::quiet_NaN() : -1e10;
    }
    bool voids_declared = true;

protected:
    /// Heights of a window; `stride` floats from one row of `out` to the next.
    virtual CPLErr read(int x, int y, int cols, int rows, float* out, GSpacing stride) = 0;

    CPLErr IReadBlock(int x_block, int y_block, void* out) override {
        const int x = x_block * nBlockXSize, y = y_block * nBlockYSize;
        return read(x, y, std::min(nBlockXSize, nRasterXSize - x),
                    std::min(nBlockYSize, nRasterYSize - y), static_cast<float*>(out), nBlockXSize);
    }
    /// Whole windows of floats go straight through, not by way of blocks of our own.
    CPLErr IRasterIO(GDALRWFlag way, int x, int y, int cols, int rows, void* out, int out_cols,
                     int out_rows, GDALDataType type, GSpacing pixel, GSpacing line,
                     GDALRasterIOExtraArg* extra) override {
        if (way == GF_Read && type == GDT_Float32 && cols == out_cols && rows == out_rows &&
            pixel == 4 && line % 4 == 0)
            return read(x, y, cols, rows, static_cast<float*>(out), line / 4);
        return GDALRasterBand::IRasterIO(way, x, y, cols, rows, out, out_cols, out_rows, type,
                                         pixel, line, extra);
    }
};

class HeightBand final : public ViewBand {
public:
    HeightBand(GDALDataset* owner, GDALRasterBand& source, HeightRule rule,
               std::shared_ptr<HeightFindings> findings)
        : source_(source), rule_(std::move(rule)), findings_(std::move(findings)) {
        const std::string driver = source.GetDataset() ? source.GetDataset()->GetDriverName() : "";
        by_lines_ = driver == "AAIGrid" || driver == "GRASSASCIIGrid" || driver == "ISG";
        for (const double v : rule_.void_values)
            float_voids_.push_back(static_cast<float>(v));
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

private:
    CPLErr read(int x, int y, int cols, int rows, float* out, GSpacing stride) override {
        const auto width = std::size_t(cols);
        // GDAL finds a line of an ASCII grid by calling itself for the line before: with a header
        // that lies about their number that never ends, or ends the stack. Line by line it is safe.
        for (; by_lines_ && lines_known_ < y; ++lines_known_) {
            double first = 0.0;
            if (source_.RasterIO(GF_Read, 0, lines_known_, 1, 1, &first, 1, 1, GDT_Float64, 0, 0) !=
                CE_None)
                return CE_Failure;
        }
        lines_known_ = std::max(lines_known_, y + 1);
        // Whole metres and floats are exact as float; what is scaled or wider is not.
        const GDALDataType stored = source_.GetRasterDataType();
        const bool plain = rule_.base == 0.0 && rule_.scale == 1.0 && rule_.offset == 0.0 &&
                           rule_.factor == 1.0 &&
                           (stored == GDT_Float32 || stored == GDT_Int16 || stored == GDT_UInt16 ||
                            stored == GDT_Byte);
        if (plain) {
            if (source_.RasterIO(GF_Read, x, y, cols, rows, out, cols, rows, GDT_Float32, 4,
                                 stride * 4) != CE_None)
                return CE_Failure;
        } else {
            wide_.resize(width * std::size_t(rows));
            if (source_.RasterIO(GF_Read, x, y, cols, rows, wide_.data(), cols, rows, GDT_Float64,
                                 0, 0) != CE_None)
                return CE_Failure;
        }
        if (rule_.use_mask) {
            mask_.resize(width * std::size_t(rows));
            if (source_.GetMaskBand()->RasterIO(GF_Read, x, y, cols, rows, mask_.data(), cols, rows,
                                                GDT_Byte, 0, 0) != CE_None)
                return CE_Failure;
        }
        constexpr float none = std::numeric_limits<float>::quiet_NaN();
        for (int r = 0; r < rows; ++r) {
            float* z = out + r * stride;
            const std::size_t first = std::size_t(r) * width;
            if (plain) {
                for (const float v : float_voids_)
                    for (std::size_t c = 0; c < width; ++c)
                        z[c] = z[c] == v ? none : z[c];
                bool odd = false;
                for (std::size_t c = 0; c < width; ++c) {
                    const bool far = !(std::abs(z[c]) < highest_m);
                    odd |= far;
                    z[c] = far ? none : z[c];
                }
                if (rule_.find_forgotten)
                    for (std::size_t c = 0; c < width; ++c)
                        if (z[c] == -9999.0f || std::isnan(z[c])) {
                            z[c] = none;
                            odd = true;
                        }
                if (odd && rule_.find_forgotten)
                    findings_->forgotten = true;
            } else {
                for (std::size_t c = 0; c < width; ++c)
                    z[c] = metres(wide_[first + c]);
            }
            if (rule_.use_mask)
                for (std::size_t c = 0; c < width; ++c)
                    if (mask_[first + c] == 0)
                        z[c] = none;
        }
        return CE_None;
    }

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
        const double z = rule_.base + rule_.factor * (rule_.offset + rule_.scale * stored);
        return std::abs(z) < double(highest_m) ? static_cast<float>(z) : none;
    }

    static constexpr float highest_m = 12'000.0f;
    GDALRasterBand& source_;
    HeightRule rule_;
    std::vector<float> float_voids_;
    std::shared_ptr<HeightFindings> findings_;
    bool by_lines_ = false;
    int lines_known_ = 0;
    std::vector<double> wide_; ///< scratch
    std::vector<unsigned char> mask_;
};

class HeightDataset final : public GDALDataset {
public:
    HeightDataset(GDALDataset& source, int band, HeightRule rule,
                  std::shared_ptr<HeightFindings> findings) {
        nRasterXSize = source.GetRasterXSize();
        nRasterYSize = source.GetRasterYSize();
        eAccess = GA_ReadOnly;
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

/// Tiles of one grid as one band; the last tile that has a height at a node counts.
class JoinedBand final : public ViewBand {
public:
    JoinedBand(GDALDataset* owner, std::vector<JoinedTile> tiles, int cols, int rows)
        : tiles_(std::move(tiles)) {
        poDS = owner;
        nBand = 1;
        eDataType = GDT_Float32;
        nBlockXSize = std::min(cols, 256);
        nBlockYSize = std::min(rows, 256);
        nRasterXSize = cols;
        nRasterYSize = rows;
        eAccess = GA_ReadOnly;
    }

private:
    CPLErr read(int x, int y, int cols, int rows, float* out, GSpacing stride) override {
        constexpr float none = std::numeric_limits<float>::quiet_NaN();
        for (int r = 0; r < rows; ++r)
            std::fill_n(out + r * stride, cols, none);
        for (const JoinedTile& tile : tiles_) {
            const int x0 = std::max(x, tile.col), y0 = std::max(y, tile.row);
            const int x1 = std::min(x + cols, tile.col + tile.raster->GetRasterXSize());
            const int y1 = std::min(y + rows, tile.row + tile.raster->GetRasterYSize());
            if (x0 >= x1 || y0 >= y1)
                continue;
            const auto width = std::size_t(x1 - x0), height = std::size_t(y1 - y0);
            part_.resize(width * height);
            if (tile.raster->GetRasterBand(1)->RasterIO(GF_Read, x0 - tile.col, y0 - tile.row,
                                                        x1 - x0, y1 - y0, part_.data(), x1 - x0,
                                                        y1 - y0, GDT_Float32, 0, 0) != CE_None)
                return CE_Failure;
            for (std::size_t r = 0; r < height; ++r) {
                float* to = out + (y0 - y + std::ptrdiff_t(r)) * stride + (x0 - x);
                const float* from = part_.data() + r * width;
                for (std::size_t c = 0; c < width; ++c)
                    to[c] = std::isnan(from[c]) ? to[c] : from[c];
            }
        }
        return CE_None;
    }

    std::vector<JoinedTile> tiles_;
    std::vector<float> part_; ///< scratch
};

class JoinedDataset final : public GDALDataset {
public:
    JoinedDataset(std::vector<JoinedTile> tiles, const GeoTransform& transform, GridSize size,
                  const OGRSpatialReference& crs)
        : transform_(transform), crs_(crs) {
        nRasterXSize = size.cols;
        nRasterYSize = size.rows;
        eAccess = GA_ReadOnly;
        SetBand(1, new JoinedBand(this, std::move(tiles), size.cols, size.rows));
    }
    CPLErr GetGeoTransform(double* out) override {
        std::copy(transform_.v, transform_.v + 6, out);
        return CE_None;
    }
    const OGRSpatialReference* GetSpatialRef() const override { return &crs_; }

private:
    GeoTransform transform_;
    OGRSpatialReference crs_;
};

} // namespace

void declare_voids(GDALDataset& view, bool declared) {
    static_cast<ViewBand*>(view.GetRasterBand(1))->voids_declared = declared;
}

Dataset join_views(std::vector<JoinedTile> tiles, const GeoTransform& transform, GridSize size,
                   const OGRSpatialReference& crs) {
    return Dataset(new JoinedDataset(std::move(tiles), transform, size, crs));
}

Dataset view_heights(GDALDataset& source, int band, HeightRule rule,
                     std::shared_ptr<HeightFindings> findings) {
    return Dataset(new HeightDataset(source, band, std::move(rule), std::move(findings)));
}

} // namespace tarn::dem
