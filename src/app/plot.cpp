#include "app/plot.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace tarn::app {

namespace fs = std::filesystem;

namespace {

/// For gnuplot, in single quotes: within double ones it would run what stands in backquotes.
std::string quoted(const std::string& words) {
    std::string out = "'";
    for (const char c : words)
        if (c == '\'')
            out += "''";
        else if (static_cast<unsigned char>(c) >= 32)
            out += c;
    return out + "'";
}

/// Runs gnuplot on a script; its last words on stderr if it fails.
void run_gnuplot(const std::string& script) {
    if (std::system("command -v gnuplot >/dev/null 2>&1") != 0)
        throw Error("gnuplot is not installed", "install gnuplot-nox, or leave out --plot");
    FILE* pipe = ::popen("gnuplot >/dev/null 2>&1", "w");
    if (!pipe)
        throw Error("gnuplot cannot be started");
    const bool written = std::fwrite(script.data(), 1, script.size(), pipe) == script.size();
    if (::pclose(pipe) != 0 || !written)
        throw Error("gnuplot could not draw the plot", "check its version (5.4 is tested)");
}

} // namespace

void draw_stages(const StagePlot& plot, const fs::path& path) {
    const std::string kind = path.extension().string();
    std::string terminal;
    if (kind == ".png")
        terminal = "pngcairo size 1100,750 font 'DejaVu Sans,12'";
    else if (kind == ".svg")
        terminal = "svg size 1100,750 font 'DejaVu Sans,14' background 'white'";
    else if (kind == ".pdf")
        terminal = "pdfcairo size 22cm,15cm font 'DejaVu Sans,11'";
    else
        throw Error(path.string() + ": is no kind of plot", "name it .png, .svg or .pdf");
    const fs::path partial = path.string() + text(".partial-", ::getpid());
    double low = plot.points.front().level_m, high = low;
    bool volumes = false;
    for (const auto& p : plot.points) {
        low = std::min(low, p.level_m);
        high = std::max(high, p.level_m);
        volumes |= !std::isnan(p.volume_million_m3);
    }
    high = std::max(high, plot.spill_level_m); // NaN compares false: no line
    if (low == high)
        high = low + 1.0;
    high += 0.06 * (high - low); // room for the label of the topmost line
    std::string script = text(
        "set encoding utf8\nset terminal ", terminal, "\nset output ", quoted(partial.string()),
        "\nset title ", quoted(plot.title), " noenhanced\nset ylabel 'water level [m]'\n",
        "set xlabel 'area [km²]' textcolor rgb '#1f5fa8'\nset yrange [", low, ":", high,
        "]\nset xrange [0:*]\nset grid\nset border 15\nset tics nomirror\n",
        "set key bottom right box opaque width 1\n");
    if (volumes)
        script += "set x2label 'volume [10⁶ m³]' textcolor rgb '#b0482f'\nset x2tics\n"
                  "set x2range [0:*]\n";
    const auto line = [&](int tag, double level, const char* what) {
        if (level >= low && level <= high)
            script += text("set arrow ", tag, " from graph 0, first ", level, " to graph 1, first ",
                           level, " nohead dashtype 2 lc rgb '#555555'\n", "set label ", tag, " '",
                           what, " ", fixed(level, 2), " m' at graph 0.02, first ", level,
                           " offset 0,0.6 textcolor rgb '#333333'\n");
    };
    line(1, plot.lake_level_m, "lake level");
    line(2, plot.spill_level_m, "spills above");
    script += "$data << END\n";
    for (const auto& p : plot.points)
        script += text(
            p.level_m, " ", p.area_km2, " ",
            std::isnan(p.volume_million_m3) ? std::string("NaN") : text(p.volume_million_m3), "\n");
    script += "END\nplot $data using 2:1 with lines lw 2.5 lc rgb '#1f5fa8' title 'area'";
    if (volumes)
        script += ", $data using 3:1 axes x2y1 with lines lw 2.5 lc rgb '#b0482f' title 'volume'";
    script += "\nunset output\n";
    std::error_code failed;
    try {
        if (!std::ofstream(partial))
            throw Error(path.string() + ": cannot be written",
                        "check the folder and its permissions");
        run_gnuplot(script);
        // gnuplot does not say when the disk is full; a whole picture has its end.
        std::ifstream made(partial, std::ios::binary);
        const std::string content{std::istreambuf_iterator<char>(made), {}};
        const std::string tail =
            content.substr(content.size() - std::min<std::size_t>(content.size(), 64));
        if (tail.find(kind == ".png"   ? "IEND"
                      : kind == ".svg" ? "</svg>"
                                       : "%%EOF") == std::string::npos)
            throw Error(path.string() + ": the plot is incomplete", "check the free space");
        fs::rename(partial, path, failed);
        if (failed)
            throw Error(path.string() + ": cannot be written (" + failed.message() + ")",
                        "check the folder and its permissions");
    } catch (...) {
        fs::remove(partial, failed);
        throw;
    }
}

} // namespace tarn::app
