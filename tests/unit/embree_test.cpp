// The double-precision walk over every cell against Embree, which knows nothing of grids: each
// cell's bilinear surface cut into 12 x 12 squares of two triangles. Where Embree is installed
// (libembree-dev).
#include <gtest/gtest.h>

#if __has_include(<embree3/rtcore.h>)
#include "bench/adversary.hpp"
#include "reference/heightfield.hpp"

#include <embree3/rtcore.h>
#include <glm/geometric.hpp>

using namespace tarn;

namespace {

/// Calls of Embree with a field whose cells are cut into `cut` x `cut` squares of two triangles.
class Mesh {
public:
    Mesh(const Heightfield& field, int cut)
        : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        const unsigned cols = unsigned((field.size().cols - 1) * cut + 1),
                       rows = unsigned((field.size().rows - 1) * cut + 1);
        RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0,
                                                              RTC_FORMAT_FLOAT3, 12, cols * rows));
        for (unsigned r = 0; r < rows; ++r)
            for (unsigned c = 0; c < cols; ++c) {
                const double x = field.x_m(double(c) / cut), y = field.y_m(double(r) / cut);
                *v++ = float(x);
                *v++ = float(y);
                *v++ = float(field.elevation_m(x, y));
            }
        auto* i = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
            mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, 2 * (cols - 1) * (rows - 1)));
        for (unsigned r = 0; r + 1 < rows; ++r)
            for (unsigned c = 0; c + 1 < cols; ++c)
                for (const unsigned k :
                     {r * cols + c, r * cols + c + 1, (r + 1) * cols + c, r * cols + c + 1,
                      (r + 1) * cols + c + 1, (r + 1) * cols + c})
                    *i++ = k;
        rtcCommitGeometry(mesh);
        rtcAttachGeometry(scene_, mesh);
        rtcReleaseGeometry(mesh);
        rtcCommitScene(scene_);
    }
    ~Mesh() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    Mesh(const Mesh&) = delete;
    Mesh& operator=(const Mesh&) = delete;

    /// Distance to the first hit, infinity if there is none.
    double first_hit(const bench::TestRay& ray) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit query{};
        query.ray.org_x = float(ray.origin.x);
        query.ray.org_y = float(ray.origin.y);
        query.ray.org_z = float(ray.origin.z);
        query.ray.dir_x = float(ray.direction.x);
        query.ray.dir_y = float(ray.direction.y);
        query.ray.dir_z = float(ray.direction.z);
        query.ray.tfar = std::numeric_limits<float>::infinity();
        query.ray.mask = ~0u;
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &query);
        return query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? std::numeric_limits<double>::infinity()
                                                           : query.ray.tfar;
    }

private:
    RTCDevice device_;
    RTCScene scene_;
};

} // namespace

TEST(Embree, FindsWhatTheReferenceFinds) {
    for (const auto& field : bench::adversarial_fields()) {
        if (field.scene.ground.size().count() > 20'000)
            continue; // meshes of 288 triangles a cell
        const Heightfield& g = field.scene.ground;
        constexpr int cut = 12;
        const Mesh mesh(g, cut);
        // Two triangles differ from the bilinear square by a quarter of its twist at most.
        double twist = 0.0;
        for (int r = 0; r + 1 < g.size().rows; ++r)
            for (int c = 0; c + 1 < g.size().cols; ++c)
                twist = std::max(
                    twist,
                    std::abs(g.elevation_m(Node{c, r}) - g.elevation_m(Node{c + 1, r}) -
                             g.elevation_m(Node{c, r + 1}) + g.elevation_m(Node{c + 1, r + 1})));
        // ... and Embree counts in float: some 6e-8 of a kilometre for origin, direction and vertex
        // each.
        const double mesh_error_m = 0.25 * twist / (cut * cut) + 5e-4;
        long judged = 0, hits = 0, lost = 0;
        for (const auto kind : {bench::RayClass::any, bench::RayClass::straight_down,
                                bench::RayClass::through_node, bench::RayClass::grazing}) {
            for (const bench::TestRay& ray : bench::make_rays(field.scene, kind, 4'000, 9)) {
                // Only rays that come from over the field: Embree's surface has no sides.
                const auto over = [&](glm::dvec3 p) {
                    return p.x > g.west_m && p.x < g.east_m() && p.y > g.south_m() &&
                           p.y < g.north_m;
                };
                if (!over(ray.origin) ||
                    ray.origin.z < g.elevation_m(ray.origin.x, ray.origin.y) + mesh_error_m)
                    continue;
                const auto first = [&](double dz, double dx, double dy) {
                    const auto hit = reference::trace_field(
                        g, nullptr, ray.origin + glm::dvec3(dx, dy, dz), ray.direction, 1e9);
                    return hit ? hit->t : std::numeric_limits<double>::infinity();
                };
                // Right is anything between the answers for rays moved by the mesh's own error.
                double nearest = first(0, 0, 0), farthest = nearest;
                const double aside = 2e-5 * (glm::length(ray.origin) + 100.0) * 1e-1 + 1e-4;
                for (const double dz : {-mesh_error_m, 0.0, mesh_error_m})
                    for (const auto& [dx, dy] : {std::pair{0.0, 0.0},
                                                 {aside, 0.0},
                                                 {-aside, 0.0},
                                                 {0.0, aside},
                                                 {0.0, -aside}}) {
                        const double t = first(dz, dx, dy);
                        nearest = std::min(nearest, t);
                        farthest = std::max(farthest, t);
                    }
                double got = mesh.first_hit(ray);
                if (got > farthest * (1 + 1e-5) + 1e-3) {
                    // Embree loses some of the rays that are aimed exactly at a vertex of its mesh,
                    // even in its robust mode; a hair aside it does not. No others.
                    ASSERT_EQ(kind, bench::RayClass::through_node) << field.name;
                    ++lost;
                    got = mesh.first_hit(
                        {ray.origin + glm::dvec3(aside, 0.3 * aside, 0), ray.direction});
                }
                ++judged;
                hits += std::isfinite(got);
                ASSERT_GE(got, nearest - 1e-5 * std::min(nearest, 1e6) - 1e-3)
                    << field.name << " " << bench::ray_class_names[std::size_t(kind)];
                ASSERT_TRUE(got <= farthest + 1e-5 * std::min(farthest, 1e6) + 1e-3)
                    << field.name << ": " << got << " " << farthest;
            }
        }
        EXPECT_GT(hits, judged / 5) << field.name;
        EXPECT_GT(judged, 3'000) << field.name;
        EXPECT_LT(lost, 40) << field.name;
        std::printf("%s: %ld rays, %ld hits, %ld lost by Embree at vertices\n", field.name.c_str(),
                    judged, hits, lost);
    }
}

#else
TEST(Embree, FindsWhatTheReferenceFinds) {
    GTEST_SKIP() << "libembree-dev is not installed: the reference is not checked against it";
}
#endif
