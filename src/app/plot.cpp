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

void require_gnuplot() {
    if (std::system("command -v gnuplot >/dev/null 2>&1") != 0)
        throw Error("gnuplot is not installed", "install gnuplot-nox, or leave the plot out");
}

/// Runs gnuplot on a script; its last words on stderr if it fails.
void run_gnuplot(const std::string& script) {
    require_gnuplot();
    FILE* pipe = ::popen("gnuplot >/dev/null 2>&1", "w");
    if (!pipe)
        throw Error("gnuplot cannot be started");
    const bool written = std::fwrite(script.data(), 1, script.size(), pipe) == script.size();
    if (::pclose(pipe) != 0 || !written)
        throw Error("gnuplot could not draw the plot", "check its version (5.4 is tested)");
}

/// What gnuplot is told first: how big, what kind, into which file beside `path`.
struct Sheet {
    std::string kind, head;
    fs::path partial;
};

Sheet sheet_for(const fs::path& path, int width_px, int height_px) {
    Sheet sheet;
    sheet.kind = path.extension().string();
    std::string terminal;
    if (sheet.kind == ".png")
        terminal = text("pngcairo size ", width_px, ",", height_px, " font 'DejaVu Sans,12'");
    else if (sheet.kind == ".svg")
        terminal = text("svg size ", width_px, ",", height_px,
                        " font 'DejaVu Sans,14' background 'white'");
    else if (sheet.kind == ".pdf")
        terminal = text("pdfcairo size ", width_px / 50.0, "cm,", height_px / 50.0,
                        "cm font 'DejaVu Sans,11'");
    else
        throw Error(path.string() + ": is no kind of plot", "name it .png, .svg or .pdf");
    sheet.partial = path.string() + text(".partial-", ::getpid());
    sheet.head = text("set encoding utf8\nset terminal ", terminal, "\nset output ",
                      quoted(sheet.partial.string()), "\n");
    return sheet;
}

/// Runs the script and puts the plot in its place, whole or not at all.
void draw(const Sheet& sheet, const std::string& script, const fs::path& path) {
    std::error_code failed;
    try {
        if (!std::ofstream(sheet.partial))
            throw Error(path.string() + ": cannot be written",
                        "check the folder and its permissions");
        run_gnuplot(sheet.head + script);
        // gnuplot does not say when the disk is full; a whole picture has its end.
        std::ifstream made(sheet.partial, std::ios::binary);
        const std::string content{std::istreambuf_iterator<char>(made), {}};
        const std::string tail =
            content.substr(content.size() - std::min<std::size_t>(content.size(), 64));
        if (tail.find(sheet.kind == ".png"   ? "IEND"
                      : sheet.kind == ".svg" ? "</svg>"
                                             : "%%EOF") == std::string::npos)
            throw Error(path.string() + ": the plot is incomplete", "check the free space");
        fs::rename(sheet.partial, path, failed);
        if (failed)
            throw Error(path.string() + ": cannot be written (" + failed.message() + ")",
                        "check the folder and its permissions");
    } catch (...) {
        fs::remove(sheet.partial, failed);
        throw;
    }
}

} // namespace

void check_plot(const fs::path& path) {
    sheet_for(path, 100, 100);
    require_gnuplot();
}

void draw_stages(const StagePlot& plot, const fs::path& path) {
    const Sheet sheet = sheet_for(path, 1100, 750);
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
    std::string script =
        text("set title ", quoted(plot.title), " noenhanced\nset ylabel 'water level [m]'\n",
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
    draw(sheet, script, path);
}

void draw_trades(const TradePlot& plot, const fs::path& path) {
    const int count = int(plot.panels.size()), across = count > 1 ? 2 : 1,
              down = (count + across - 1) / across;
    const Sheet sheet = sheet_for(path, 720 * across, 80 + 470 * down);
    std::string script = text("set multiplot layout ", down, ",", across, " title ",
                              quoted(plot.title + " - " + plot.device), " noenhanced font ',14'\n",
                              "set logscale xy\nset grid\nset border 3\nset tics nomirror\n",
                              "set xlabel 'time of one picture [ms]'\n",
                              "set ylabel 'rays missed or wrong, of those that hit'\n",
                              "set key outside right top reverse Left samplen 1.5 font ',10'\n",
                              "set format y '10^{%L}'\n");
    static const char* colours[] = {"#1f5fa8", "#2a9d8f", "#7b4fa3", "#555555",
                                    "#e07b39", "#c0392b", "#b8860b", "#c2185b"};
    for (const TradePlot::Panel& panel : plot.panels) {
        // What was not found among so many rays is drawn on the floor: less than one in them.
        const double floor = 0.5 / std::max(1.0, panel.judged);
        script += text("set title ", quoted(panel.title), " noenhanced font ',12'\nset yrange [",
                       0.4 * floor, ":2]\nunset arrow\nset arrow 1 from graph 0, first ", floor,
                       " to graph 1, first ", floor,
                       " nohead dashtype 3 lc rgb '#888888'\nset label 1 'none of ",
                       static_cast<long>(panel.judged), "' at graph 0.99, first ", floor,
                       " right offset 0,0.5 font ',9' textcolor rgb '#666666'\n");
        std::string data, curves;
        for (std::size_t m = 0; m < panel.methods.size(); ++m) {
            const TradePlot::Method& method = panel.methods[m];
            data += text("$m", m, " << END\n");
            for (const auto& p : method.points)
                data += text(p.time_ms, " ", std::max(p.failures, floor), " \"", p.setting, "\"\n");
            data += "END\n";
            curves +=
                text(m ? ", " : "plot ", "$m", m, " using 1:2 with linespoints lw 1.6 pt ",
                     m % 8 + 4, " ps 1.1 lc rgb '", colours[m % 8], "' title ", quoted(method.name),
                     ", $m", m, " using 1:2:3 with labels offset 0,0.7 font ',8' textcolor rgb '",
                     colours[m % 8], "' notitle");
        }
        script += data + curves + "\n";
    }
    script += "unset multiplot\nunset output\n";
    draw(sheet, script, path);
}

void draw_ways(const WayPlot& plot, const fs::path& path) {
    const Sheet sheet = sheet_for(path, 1200, 800);
    constexpr double floor = 1e-6; // of the errors that are drawn
    std::string script =
        text("set title ", quoted(plot.title + " - " + plot.device), " noenhanced font ',14'\n",
             "set logscale xy\nset grid\nset border 3\nset tics nomirror\n",
             "set xlabel 'time of one picture, as a share of the best one'\n",
             "set ylabel 'relative radiance error against the best, mean [%]'\n",
             "set key outside right top reverse Left samplen 1.5\nset format y '%g'\n",
             "set yrange [", 50.0 * floor, ":*]\nset offsets graph 0.04, graph 0.08, 0, 0\n");
    std::vector<std::string> effects;
    for (const auto& p : plot.points)
        if (std::find(effects.begin(), effects.end(), p.effect) == effects.end())
            effects.push_back(p.effect);
    static const char* colours[] = {"#222222", "#1f5fa8", "#2a9d8f", "#7b4fa3",
                                    "#e07b39", "#c0392b", "#b8860b", "#c2185b",
                                    "#558b2f", "#00838f", "#6d4c41", "#8e24aa"};
    std::string data, curves;
    const auto line_of = [&](const WayPlot::Point& p) {
        const bool named = p.error > floor; // those on the floor would hide each other
        return text(p.time_share, " ", 100.0 * std::max(p.error, floor), " \"", named ? p.name : "",
                    "\"\n");
    };
    std::vector<WayPlot::Point> front;
    for (const auto& p : plot.points)
        if (p.on_front)
            front.push_back(p);
    std::sort(front.begin(), front.end(),
              [](const auto& a, const auto& b) { return a.time_share < b.time_share; });
    data += "$front << END\n";
    for (const auto& p : front)
        data += line_of(p);
    data += "END\n";
    curves =
        "plot $front using 1:2 with lines lw 1.5 dashtype 2 lc rgb '#999999' title 'Pareto front'";
    for (std::size_t k = 0; k < effects.size(); ++k) {
        data += text("$e", k, " << END\n");
        for (const auto& p : plot.points)
            if (p.effect == effects[k])
                data += line_of(p);
        data += "END\n";
        const char* colour = colours[k % std::size(colours)];
        curves += text(", $e", k, " using 1:2 with points pt ", k % 8 + 4, " ps 1.2 lc rgb '",
                       colour, "' title ", quoted(effects[k]), ", $e", k,
                       " using 1:2:3 with labels noenhanced left offset 0.8,0.3 font ',9' "
                       "textcolor rgb '",
                       colour, "' notitle");
    }
    script += data + curves + "\nunset output\n";
    draw(sheet, script, path);
}

void draw_costs(const CostPlot& plot, const fs::path& path) {
    const Sheet sheet = sheet_for(path, 1100, 600);
    static const char* colours[] = {"#1f5fa8", "#c0392b", "#2a9d8f", "#e07b39",
                                    "#7b4fa3", "#555555", "#b8860b", "#c2185b"};
    std::string data, curves, ticks;
    double least = 1e300, most = 0.0;
    for (std::size_t k = 0; k < plot.curves.size(); ++k) {
        data += text("$c", k, " << END\n");
        for (const auto& p : plot.curves[k].points) {
            data += text(p.x, " ", p.ms, " ", p.low_ms, " ", p.high_ms, "\n");
            least = std::min(least, p.x);
            most = std::max(most, p.x);
            const std::string tick = text("'", p.x, "' ", p.x);
            if (ticks.find(tick) == std::string::npos)
                ticks += (ticks.empty() ? "" : ", ") + tick;
        }
        data += "END\n";
        const char* colour = colours[k % std::size(colours)];
        curves +=
            text(k ? ", " : "plot ", "$c", k, " using 1:2 with linespoints lw 2 pt ", k % 8 + 4,
                 " lc rgb '", colour, "' title ", quoted(plot.curves[k].name), " noenhanced, $c", k,
                 " using 1:3:(0):($4-$3) with vectors nohead lw 0.7 dashtype 3 lc rgb '", colour,
                 "' notitle");
    }
    draw(sheet,
         text("set title ", quoted(plot.title + " - " + plot.device),
              " noenhanced font ',13'\nset logscale xy\nset grid\nset border 3\n",
              "set tics nomirror\nset xlabel '", plot.x_label,
              "'\nset ylabel 'time of one picture [ms]'\nset format y '%g'\n",
              "set key outside right top reverse Left samplen 1.5\nset xrange [", 0.8 * least, ":",
              1.25 * most, "]\nset xtics (", ticks, ")\n", data, curves, "\nunset output\n"),
         path);
}

} // namespace tarn::app
