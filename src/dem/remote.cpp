#include "dem/remote.hpp"

#include "core/error.hpp"
#include "core/text.hpp"
#include "dem/gdal_door.hpp"

#include <algorithm>
#include <cmath>
#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <cpl_vsi_error.h>
#include <cstdio>
#include <limits>
#include <set>
#include <sstream>
#include <unistd.h>
#include <zlib.h>

namespace tarn::dem {

namespace fs = std::filesystem;

const std::vector<RemoteSource>& known_sources() {
    static const std::vector<RemoteSource> sources = {
        {.name = "copernicus",
         .url = "https://copernicus-dem-30m.s3.amazonaws.com/"
                "Copernicus_DSM_COG_10_{NS}{lat}_00_{EW}{lon}_00_DEM/"
                "Copernicus_DSM_COG_10_{NS}{lat}_00_{EW}{lon}_00_DEM.tif",
         .about = "Copernicus GLO-30, 1\" worldwide, heights above EGM2008; (c) DLR e.V. 2010-2014 "
                  "and (c) Airbus Defence and Space GmbH 2014-2018, provided under COPERNICUS by "
                  "the European Union and ESA"},
        {.name = "3dep",
         .url = "https://prd-tnm.s3.amazonaws.com/StagedProducts/Elevation/13/TIFF/current/"
                "{ns}{lat}{ew}{lon}/USGS_13_{ns}{lat}{ew}{lon}.tif",
         .named_by_north = true,
         .missing_status = {403, 404, 410},
         .about = "USGS 3DEP 1/3\", United States, heights above NAVD88; public domain"},
    };
    return sources;
}

std::string tile_url(const RemoteSource& source, int south_deg, int west_deg) {
    const int lat =
        source.named_by_north ? south_deg + int(std::lround(source.tile_deg)) : south_deg;
    const auto digits = [](int value, int width) {
        std::string out = std::to_string(std::abs(value));
        return std::string(std::size_t(std::max(0, width - int(out.size()))), '0') + out;
    };
    std::string out;
    for (std::size_t i = 0; i < source.url.size();) {
        if (source.url[i] != '{') {
            out += source.url[i++];
            continue;
        }
        const std::size_t end = source.url.find('}', i);
        const std::string word =
            end == std::string::npos ? source.url.substr(i) : source.url.substr(i, end - i + 1);
        if (word == "{NS}")
            out += lat < 0 ? 'S' : 'N';
        else if (word == "{ns}")
            out += lat < 0 ? 's' : 'n';
        else if (word == "{EW}")
            out += west_deg < 0 ? 'W' : 'E';
        else if (word == "{ew}")
            out += west_deg < 0 ? 'w' : 'e';
        else if (word == "{lat}")
            out += digits(lat, 2);
        else if (word == "{lon}")
            out += digits(west_deg, 3);
        else
            throw Error("source '" + source.name + "': its URL has the placeholder " + word,
                        "use {NS} {ns} {EW} {ew} {lat} {lon}");
        i = end + 1;
    }
    return out;
}

namespace {

enum class Answer { there, missing };

/// Asks for a tile; what GDAL remembers of an earlier failure is forgotten first.
Answer ask(const std::string& path, const RemoteSource& source, const std::string& url) {
    GdalMessages quiet; // retries are announced as warnings
    VSICurlPartialClearCache(path.c_str());
    VSIErrorReset();
    VSIStatBufL stat;
    if (VSIStatExL(path.c_str(), &stat, VSI_STAT_EXISTS_FLAG | VSI_STAT_SET_ERROR_FLAG) == 0)
        return Answer::there;
    const std::string said = VSIGetLastErrorMsg();
    for (const int status : source.missing_status)
        if (said == text("HTTP response code: ", status))
            return Answer::missing;
    throw Error(source.name + ": the server gives no answer that can be used for " + url + " (" +
                    (said.empty() ? "no answer" : said) + ")",
                "try again later, or raise --timeout; what was fetched is kept");
}

using Blocks = std::set<std::pair<int, int>>; ///< column, row

Blocks parse_blocks(const char* words) {
    Blocks out;
    std::istringstream in(words ? words : "");
    int col = 0, row = 0;
    char comma = 0, semicolon = 0;
    while (in >> col >> comma >> row >> semicolon)
        out.emplace(col, row);
    return out;
}

/// One tile: which blocks are wanted, which are in the local copy, and the transfer.
class TileCopy {
public:
    TileCopy(const RemoteSource& source, std::string url, fs::path local)
        : source_(source), url_(std::move(url)), local_(std::move(local)) {
        std::error_code failed;
        if (fs::exists(local_, failed)) {
            GdalMessages quiet;
            copy_.reset(GDALDataset::Open(local_.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
            const char* from = copy_ ? copy_->GetMetadataItem("TARN_URL") : nullptr;
            if (!from || url_ != from)
                copy_.reset(); // damaged, or of another source of the same name: fetched anew
        }
        if (copy_)
            have_ = parse_blocks(copy_->GetMetadataItem("TARN_BLOCKS"));
    }

    /// @return false if the server has no such tile
    bool bring(const Bounds& bounds, Fetched& out, const Progress& progress, double from,
               double to) {
        Dataset remote;
        if (!copy_) {
            const std::string path = "/vsicurl/" + url_;
            if (ask(path, source_, url_) == Answer::missing)
                return false;
            remote = open_remote();
        }
        GDALDataset& shape = copy_ ? *copy_ : *remote;
        Blocks wanted = blocks_of(shape, bounds);
        Blocks lacking;
        std::set_difference(wanted.begin(), wanted.end(), have_.begin(), have_.end(),
                            std::inserter(lacking, lacking.end()));
        out.blocks_cached += wanted.size() - lacking.size();
        if (wanted.empty() || lacking.empty())
            return true;
        if (!remote) {
            if (ask("/vsicurl/" + url_, source_, url_) == Answer::missing)
                throw Error(source_.name + ": " + url_ + " is gone, but was there before",
                            "clear the cache to go on without it");
            remote = open_remote();
        }
        transfer(*remote, lacking, progress, from, to);
        out.blocks_fetched += lacking.size();
        return true;
    }

private:
    Dataset open_remote() const {
        GdalMessages messages;
        const std::string path = "/vsicurl/" + url_;
        Dataset remote(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY |
                                                           GDAL_OF_VERBOSE_ERROR));
        double g[6];
        if (!remote || remote->GetRasterCount() < 1 || remote->GetGeoTransform(g) != CE_None ||
            g[2] != 0.0 || g[4] != 0.0 || !remote->GetSpatialRef())
            throw Error(source_.name + ": " + url_ + " is no elevation tile (" + messages.last() +
                            ")",
                        "check the source's URL pattern");
        return remote;
    }

    /// Blocks are counted as the server's file has them.
    static std::pair<int, int> block_size(GDALDataset& tile) {
        int width = 0, height = 0;
        const char* kept = tile.GetMetadataItem("TARN_BLOCK_SIZE");
        if (!kept || std::sscanf(kept, "%d,%d", &width, &height) != 2 || width < 1 || height < 1)
            tile.GetRasterBand(1)->GetBlockSize(&width, &height);
        return {width, height};
    }

    static Blocks blocks_of(GDALDataset& tile, const Bounds& bounds) {
        double g[6];
        tile.GetGeoTransform(g);
        const std::pair<int, int> block = block_size(tile);
        const int width = block.first, height = block.second;
        constexpr double margin = 4.0; // pixels: what interpolation looks at
        const double shift = bounds.west_deg > g[0] + g[1] * tile.GetRasterXSize() ? 360.0
                             : bounds.east_deg < g[0]                              ? -360.0
                                                                                   : 0.0;
        const auto first = [&](double pixel, int size) {
            return std::max(0, int(std::floor((pixel - margin) / size)));
        };
        const auto last = [&](double pixel, int size, int pixels) {
            return std::min((pixels - 1) / size, int(std::floor((pixel + margin) / size)));
        };
        Blocks out;
        const double west = (bounds.west_deg - shift - g[0]) / g[1];
        const double east = (bounds.east_deg - shift - g[0]) / g[1];
        const double north = (bounds.north_deg - g[3]) / g[5];
        const double south = (bounds.south_deg - g[3]) / g[5];
        if (east < -margin || south < -margin || west > tile.GetRasterXSize() + margin ||
            north > tile.GetRasterYSize() + margin)
            return out;
        for (int r = first(north, height); r <= last(south, height, tile.GetRasterYSize()); ++r)
            for (int c = first(west, width); c <= last(east, width, tile.GetRasterXSize()); ++c)
                out.emplace(c, r);
        return out;
    }

    /// Writes a new copy with the old and the new blocks beside the old one, then renames it.
    void transfer(GDALDataset& remote, const Blocks& lacking, const Progress& progress, double from,
                  double to) {
        GdalMessages messages;
        GDALRasterBand& band = *remote.GetRasterBand(1);
        const std::pair<int, int> size = block_size(remote);
        const int width = size.first, height = size.second;
        const GDALDataType type = band.GetRasterDataType();
        const int cols = remote.GetRasterXSize(), rows = remote.GetRasterYSize();
        std::error_code unmade;
        fs::create_directories(local_.parent_path(), unmade);
        if (unmade)
            throw Error(local_.parent_path().string() + ": cannot be made (" + unmade.message() +
                            ")",
                        "name another folder with --cache");
        const fs::path partial = local_.string() + text(".partial-", ::getpid());
        CPLStringList options;
        if (width % 16 == 0 && height % 16 == 0) {
            options.SetNameValue("TILED", "YES");
            options.SetNameValue("BLOCKXSIZE", text(width).c_str());
            options.SetNameValue("BLOCKYSIZE", text(height).c_str());
        } else {
            options.SetNameValue("BLOCKYSIZE", text(height).c_str()); // strips
        }
        options.SetNameValue("SPARSE_OK", "TRUE");
        options.SetNameValue("COMPRESS", "DEFLATE");
        options.SetNameValue("ZLEVEL", "1");
        Dataset out(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
            partial.c_str(), cols, rows, 1, type, options.List()));
        const auto fail = [&](const std::string& cause, const std::string& hint) {
            out.reset();
            std::error_code ignored;
            fs::remove(partial, ignored);
            VSICurlPartialClearCache(("/vsicurl/" + url_).c_str());
            throw Error(cause, hint);
        };
        if (!out)
            fail(local_.string() + ": cannot be written (" + messages.last() + ")",
                 "check the cache folder, or name another with --cache");
        double g[6];
        remote.GetGeoTransform(g);
        out->SetGeoTransform(g);
        out->SetSpatialRef(remote.GetSpatialRef());
        int declared = 0;
        double nodata = band.GetNoDataValue(&declared);
        if (!declared)
            nodata =
                GDALDataTypeIsFloating(type) ? std::numeric_limits<double>::quiet_NaN() : -32768.0;
        out->GetRasterBand(1)->SetNoDataValue(nodata); // blocks that are not there read as this
        out->GetRasterBand(1)->SetUnitType(band.GetUnitType());
        if (band.GetScale() != 1.0 || band.GetOffset() != 0.0) {
            out->GetRasterBand(1)->SetScale(band.GetScale());
            out->GetRasterBand(1)->SetOffset(band.GetOffset());
        }
        std::vector<unsigned char> buffer(std::size_t(width) * std::size_t(height) *
                                          std::size_t(GDALGetDataTypeSizeBytes(type)));
        const auto carry = [&](GDALDataset& source, const std::pair<int, int>& block) {
            const int x = block.first * width, y = block.second * height;
            const int w = std::min(width, cols - x), h = std::min(height, rows - y);
            return w > 0 && h > 0 &&
                   source.GetRasterBand(1)->RasterIO(GF_Read, x, y, w, h, buffer.data(), w, h, type,
                                                     0, 0) == CE_None &&
                   out->GetRasterBand(1)->RasterIO(GF_Write, x, y, w, h, buffer.data(), w, h, type,
                                                   0, 0) == CE_None;
        };
        std::size_t done = 0;
        try {
            for (const auto& block : lacking) {
                progress.report(from + (to - from) * double(done++) / double(lacking.size()),
                                "fetching " + source_.name);
                if (!carry(remote, block)) {
                    const std::string said = messages.last();
                    fail(
                        source_.name + ": " + url_ + " cannot be read (" + said + ")",
                        "try again later, or raise --timeout; whole tiles fetched before are kept");
                }
            }
        } catch (const Cancelled&) {
            out.reset();
            std::error_code ignored;
            fs::remove(partial, ignored);
            throw;
        }
        if (copy_)
            for (const auto& block : have_)
                if (!carry(*copy_, block))
                    fail(local_.string() + ": cannot be read again (" + messages.last() + ")",
                         "remove it, it is only a copy");
        have_.insert(lacking.begin(), lacking.end());
        std::string list;
        for (const auto& [c, r] : have_)
            list += text(c, ",", r, ";");
        out->SetMetadataItem("TARN_URL", url_.c_str());
        out->SetMetadataItem("TARN_BLOCKS", list.c_str());
        out->SetMetadataItem("TARN_BLOCK_SIZE", text(width, ",", height).c_str());
        const GdalMessages closing; // a full disk shows only when the last block goes out
        out->FlushCache(true);
        out.reset();
        if (closing.failed())
            fail(local_.string() + ": cannot be written (" + closing.last() + ")",
                 "check the free space, or name another folder with --cache");
        std::error_code failed;
        fs::rename(partial, local_, failed);
        if (failed)
            fail(local_.string() + ": cannot be put in place (" + failed.message() + ")",
                 "check the cache folder, or name another with --cache");
    }

    const RemoteSource& source_;
    std::string url_;
    fs::path local_;
    Dataset copy_;
    Blocks have_;
};

} // namespace

Fetched fetch_tiles(const RemoteSource& source, const Bounds& bounds, const FetchOptions& options,
                    const Progress& progress) {
    register_drivers();
    if (!(options.timeout_s >= 1.0 && options.timeout_s <= 3600.0))
        throw Error(text("--timeout is ", options.timeout_s, " s, must be in [1, 3600]"));
    if (!(source.tile_deg >= 1.0 && source.tile_deg <= 90.0 &&
          source.tile_deg == std::floor(source.tile_deg)))
        throw Error(text("source '", source.name, "': tile_deg is ", source.tile_deg),
                    "whole degrees from 1 to 90 are possible");
    const ThreadOptions network{
        {"GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR"}, // no looking for side files
        {"GDAL_PAM_ENABLED", "NO"},                    // and none beside the copies
        {"GTIFF_USE_DEFER_STRILE_LOADING", "NO"},      // a cut header fails at once
        {"GDAL_HTTP_CONNECTTIMEOUT", text(std::min(options.timeout_s, 10.0))},
        {"GDAL_HTTP_TIMEOUT", text(options.timeout_s)},
        {"GDAL_HTTP_MAX_RETRY", "1"},
        {"GDAL_HTTP_RETRY_DELAY", "0.5"}};
    const auto edge = [&](double v) {
        return int(std::floor(v / source.tile_deg) * source.tile_deg);
    };
    const int side = int(source.tile_deg);
    struct Tile {
        int south, west;
    };
    std::vector<Tile> tiles;
    for (int south = edge(bounds.south_deg); south < bounds.north_deg; south += side)
        for (int west = edge(bounds.west_deg); west < bounds.east_deg; west += side)
            tiles.push_back({south, west >= 180 ? west - 360 : west < -180 ? west + 360 : west});
    if (tiles.size() > 400)
        throw Error(text("the region touches ", tiles.size(), " tiles of ", source.name),
                    "choose a smaller --radius");
    Fetched out;
    std::size_t missing = 0;
    std::string first_url;
    for (std::size_t i = 0; i < tiles.size(); ++i) {
        const std::string url = tile_url(source, tiles[i].south, tiles[i].west);
        if (first_url.empty())
            first_url = url;
        // Tiles may have one name in many folders: the URL's checksum tells them apart.
        const auto sum = ::crc32(0, reinterpret_cast<const unsigned char*>(url.data()),
                                 static_cast<unsigned>(url.size()));
        char folder[16];
        std::snprintf(folder, sizeof folder, "%08lx", static_cast<unsigned long>(sum));
        const fs::path local = options.cache / source.name / folder / fs::path(url).filename();
        TileCopy tile(source, url, local);
        const double step = 0.02 / double(tiles.size());
        if (tile.bring(bounds, out, progress, step * double(i), step * double(i + 1)))
            out.tiles.push_back(local);
        else
            ++missing;
    }
    std::erase_if(out.tiles, [](const fs::path& path) {
        std::error_code failed;
        return !fs::exists(path, failed); // only its margin was asked for
    });
    if (out.tiles.empty())
        throw Error(source.name + ": has no tile there (asked for " + first_url + ")",
                    "check --at (latitude first), or take another --source");
    out.notes.push_back(text(source.name, " (", source.about, "): ", out.blocks_fetched,
                             " blocks fetched, ", out.blocks_cached, " from the cache"));
    if (missing > 0)
        out.notes.push_back(text(missing, " of ", tiles.size(), " tiles do not exist in ",
                                 source.name, " (open sea, mostly): no data there"));
    return out;
}

} // namespace tarn::dem
