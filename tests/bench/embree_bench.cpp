// tarn_embree_bench — what Embree needs for the rays of `tarn bench --intersection`: primary rays
// of the same views, one at a time and in packets of eight, two threads. Ground and water as two
// meshes of two triangles a cell.
//
//   tarn_embree_bench [SIDE] [WIDTHxHEIGHT]
#include "bench/intersection.hpp"
#include "core/parallel.hpp"
#include "reference/camera.hpp"
#include "scene/samples.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <embree3/rtcore.h>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

namespace {

using namespace tarn;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

void add_mesh(RTCDevice device, RTCScene scene, const Heightfield& field, bool skip_none) {
    const unsigned cols = unsigned(field.size().cols), rows = unsigned(field.size().rows);
    std::vector<unsigned> triangles;
    const auto has = [&](unsigned i) {
        return !skip_none || field.codes.values[i] != no_water_code;
    };
    for (unsigned r = 0; r + 1 < rows; ++r)
        for (unsigned c = 0; c + 1 < cols; ++c) {
            const unsigned nw = r * cols + c, ne = nw + 1, sw = nw + cols, se = sw + 1;
            if (has(nw) && has(ne) && has(sw) && has(se))
                triangles.insert(triangles.end(), {nw, ne, sw, ne, se, sw});
        }
    if (triangles.empty())
        return;
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, std::size_t(cols) * rows));
    for (unsigned r = 0; r < rows; ++r)
        for (unsigned c = 0; c < cols; ++c) {
            *v++ = float(field.x_m(c));
            *v++ = float(field.y_m(r));
            *v++ = float(field.elevation_m(Node{int(c), int(r)}));
        }
    auto* i = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, triangles.size() / 3));
    std::copy(triangles.begin(), triangles.end(), i);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene, mesh);
    rtcReleaseGeometry(mesh);
}

} // namespace

int main(int argc, char** argv) {
    const int side = argc > 1 ? std::atoi(argv[1]) : 4096;
    int width = 800, height = 600;
    if (argc > 2 && std::sscanf(argv[2], "%dx%d", &width, &height) != 2)
        return 2;
    const scene::Scene lake = scene::mountain_lake(side);
    static std::atomic<long long> bytes{0}, peak{0};
    RTCDevice device = rtcNewDevice("threads=2");
    rtcSetDeviceMemoryMonitorFunction(
        device,
        [](void*, ssize_t change, bool) {
            const long long now = bytes += change;
            if (now > peak)
                peak = now;
            return true;
        },
        nullptr);
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    const auto begin = Clock::now();
    add_mesh(device, scene, lake.ground, false);
    add_mesh(device, scene, lake.water, true);
    rtcCommitScene(scene);
    std::printf("Embree %d.%d, %d^2: build %.1f s, %.2f GB (peak %.2f GB)\n", RTC_VERSION_MAJOR,
                RTC_VERSION_MINOR, side, seconds_since(begin), double(bytes) * 1e-9,
                double(peak) * 1e-9);
    for (const auto& view : bench::mountain_views()) {
        const double half = std::tan(0.5 * view.camera.fov_deg * M_PI / 180.0);
        const auto run = [&](int packet) {
            share_out(height, 2, [&](int first, int last) {
                RTCIntersectContext context;
                rtcInitIntersectContext(&context);
                for (int y = first; y < last; ++y)
                    for (int x = 0; x < width; x += packet) {
                        RTCRayHit8 rays;
                        int valid[8];
                        for (int k = 0; k < packet; ++k) {
                            const glm::dvec3 d = reference::pixel_direction(
                                view.camera.forward, view.camera.right, view.camera.up,
                                {half * width / height, half},
                                {(x + k + 0.5) / width, (y + 0.5) / height});
                            const glm::dvec3& o = view.camera.position;
                            if (packet == 1) {
                                RTCRayHit ray{};
                                ray.ray.org_x = float(o.x);
                                ray.ray.org_y = float(o.y);
                                ray.ray.org_z = float(o.z);
                                ray.ray.dir_x = float(d.x);
                                ray.ray.dir_y = float(d.y);
                                ray.ray.dir_z = float(d.z);
                                ray.ray.tfar = INFINITY;
                                ray.ray.mask = ~0u;
                                ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
                                rtcIntersect1(scene, &context, &ray);
                                continue;
                            }
                            valid[k] = -1;
                            rays.ray.org_x[k] = float(o.x);
                            rays.ray.org_y[k] = float(o.y);
                            rays.ray.org_z[k] = float(o.z);
                            rays.ray.dir_x[k] = float(d.x);
                            rays.ray.dir_y[k] = float(d.y);
                            rays.ray.dir_z[k] = float(d.z);
                            rays.ray.tnear[k] = 0;
                            rays.ray.tfar[k] = INFINITY;
                            rays.ray.time[k] = 0;
                            rays.ray.mask[k] = ~0u;
                            rays.ray.flags[k] = 0;
                            rays.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
                        }
                        if (packet == 8)
                            rtcIntersect8(valid, scene, &context, &rays);
                    }
            });
        };
        for (const int packet : {1, 8}) {
            std::vector<double> times;
            run(packet);
            for (int i = 0; i < 5; ++i) {
                const auto start = Clock::now();
                run(packet);
                times.push_back(seconds_since(start));
            }
            std::sort(times.begin(), times.end());
            std::printf("  %-8s packets of %d: %7.1f ms, %6.2f M rays/s\n", view.name.c_str(),
                        packet, 1e3 * times[2], 1e-6 * width * height / times[2]);
        }
    }
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
}
