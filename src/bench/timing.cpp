#include "bench/timing.hpp"

#include "gpu/context.hpp"
#include "gpu/objects.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

namespace tarn::bench {

Times time_on_gpu(const std::function<void()>& work, int runs) {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    static bool clocks_are_up =
        gpu::is_software(); // a GPU that has waited for the CPU takes a while
    const auto warm = std::chrono::milliseconds(clocks_are_up ? 330 : 2000);
    clocks_are_up = true;
    for (int i = 0; i < 2 || Clock::now() - begin < warm; ++i) {
        work();
        glFinish();
    }
    std::vector<double> gpu, cpu;
    gpu::Timer timer;
    for (int i = 0; i < std::max(1, runs); ++i) {
        const auto start = Clock::now();
        timer.start();
        work();
        timer.stop();
        glFinish();
        cpu.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
        gpu.push_back(timer.milliseconds());
    }
    std::sort(gpu.begin(), gpu.end());
    std::sort(cpu.begin(), cpu.end());
    const std::size_t n = gpu.size();
    // Software GL's timer answers nothing for compute shaders, and where triangles are drawn the
    // time of day.
    const bool usable = !gpu::is_software() && gpu[n / 2] > 1e-3;
    const auto& t = usable ? gpu : cpu;
    return {t[n / 2], t[n / 4], t[n * 3 / 4], usable ? "gpu timer" : "finish to finish"};
}

std::vector<PartTime>
time_parts(const std::function<void(const std::function<void(const char*)>&)>& work, int runs) {
    using Clock = std::chrono::steady_clock;
    const bool stamps = !gpu::is_software(); // whose stamps do not move
    std::vector<std::string> names;
    std::vector<std::vector<double>> times;
    for (int run = stamps ? -3 : -1; run < std::max(1, runs); ++run) { // first to warm up
        std::vector<GLuint> queries;
        std::vector<Clock::time_point> moments;
        std::vector<std::string> seen;
        glFinish();
        work([&](const char* name) {
            seen.emplace_back(name);
            if (stamps) {
                queries.push_back(0);
                glCreateQueries(GL_TIMESTAMP, 1, &queries.back());
                glQueryCounter(queries.back(), GL_TIMESTAMP);
            } else {
                glFinish();
                moments.push_back(Clock::now());
            }
        });
        glFinish();
        names = seen;
        times.resize(names.size());
        for (std::size_t i = 0; i + 1 < names.size(); ++i) {
            double ms = 0.0;
            if (stamps) {
                GLuint64 from = 0, to = 0;
                glGetQueryObjectui64v(queries[i], GL_QUERY_RESULT, &from);
                glGetQueryObjectui64v(queries[i + 1], GL_QUERY_RESULT, &to);
                ms = double(to - from) * 1e-6;
            } else {
                ms = std::chrono::duration<double, std::milli>(moments[i + 1] - moments[i]).count();
            }
            if (run >= 0)
                times[i].push_back(ms);
        }
        glDeleteQueries(GLsizei(queries.size()), queries.data());
    }
    std::vector<PartTime> out;
    for (std::size_t i = 0; i + 1 < names.size(); ++i) {
        std::nth_element(times[i].begin(), times[i].begin() + std::ptrdiff_t(times[i].size() / 2),
                         times[i].end());
        if (names[i] != "end")
            out.push_back({names[i], times[i][times[i].size() / 2]});
    }
    return out;
}

} // namespace tarn::bench
