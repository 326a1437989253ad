// The patch in a cell against bisection in long double.
#include "support/gpu_function.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace tarn;

TEST(HeightfieldGpu, FirstCrossingIsTheRootThatBisectionFinds) {
    // f(s) = curve s^2 + (below - above - curve) s + above, against bisection in long double.
    std::mt19937 random(12);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    std::vector<glm::vec4> in;
    for (int i = 0; i < 200'000; ++i) {
        const float above = std::pow(10.0f, 4 * unit(random)),
                    below = (i % 3 ? 1.0f : 1e-4f) * unit(random) * above;
        const float curve = i % 4 == 0 ? 1e-7f * unit(random) * above : 6.0f * unit(random) * above;
        in.emplace_back(above, below, curve, 0);
    }
    const auto got = test_support::GpuFunction(
        "lib/heightfield.glsl", "result.x = first_crossing(Gap(x.x, x.y, x.z));")(in);
    int crossings = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
        const long double c = in[i].x, e = in[i].y, a = in[i].z, b = e - c - a;
        const auto f = [&](long double s) { return (a * s + b) * s + c; };
        long double high = 1.0L;
        bool crosses = e <= 0.0L;
        if (!crosses && a > 0.0L && -b / (2 * a) > 0.0L && -b / (2 * a) < 1.0L &&
            f(-b / (2 * a)) <= 0.0L) {
            high = -b / (2 * a);
            crosses = true;
        }
        // Near-tangent: the discriminant is below its own float32 rounding; either answer is right.
        const long double rounding = 1e-6L * (b * b + std::abs(4 * a * c));
        if (e > 0.0L && std::abs(b * b - 4 * a * c) < rounding)
            continue;
        if (!crosses) {
            ASSERT_GT(got[i].x, 1.0f) << double(c) << " " << double(e) << " " << double(a);
            continue;
        }
        ++crossings;
        long double low = 0.0L;
        for (int k = 0; k < 80; ++k) {
            const long double m = (low + high) / 2;
            (f(m) > 0.0L ? low : high) = m;
        }
        // The root is as certain as f over its slope there.
        const long double slope = std::abs(2 * a * low + b);
        const long double certain =
            4e-7L * (c + std::abs(a) + std::abs(b)) / std::max(slope, 1e-30L) + 2e-7L;
        ASSERT_NEAR(got[i].x, double(low), double(std::min(certain, 1.0L)))
            << double(c) << " " << double(e) << " " << double(a);
    }
    EXPECT_GT(crossings, 50'000);
}
