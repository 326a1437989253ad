// The wave equation of ripples against theory: speed, energy, shores, any time step, rain.
#include "render/ripples.hpp"
#include "render/waves.hpp"
#include "scene/samples.hpp"
#include "support/gpu_function.hpp"
#include "waves/ripples.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

using namespace tarn;
using render::RipplePond;
using render::Ripples;

namespace {

/// Kinetic and potential energy, the latter by the product of two states that leapfrog conserves.
double energy(const Ripples& ripples, int n, double speed, double texel) {
    const std::vector<float> now = ripples.read(), before = ripples.read(true);
    double sum = 0.0;
    const auto at = [&](const std::vector<float>& h, int x, int y) {
        x = std::clamp(x, 0, n - 1); // no slope across a reflecting edge
        y = std::clamp(y, 0, n - 1);
        return double(h[std::size_t(y * n + x)]);
    };
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const double v = (at(now, x, y) - at(before, x, y)) / ripples.step_s();
            sum += 0.5 * v * v;
            for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(0, 1)})
                sum += 0.5 * speed * speed / (texel * texel) *
                       (at(now, x + dx, y + dy) - at(now, x, y)) *
                       (at(before, x + dx, y + dy) - at(before, x, y));
        }
    return sum * texel * texel;
}

double mean(const std::vector<float>& h) {
    double sum = 0.0;
    for (const float v : h)
        sum += v;
    return sum / double(h.size());
}

} // namespace

TEST(RipplesGpu, RingsRunAtTheSpeedOfTheWaves) {
    test_support::context();
    const RipplePond pond{.texels = 512, .damping_per_s = 0.0, .edge = RipplePond::Edge::absorbs};
    Ripples ripples(pond);
    ripples.move_to(0.0);
    ripples.poke({4.0, 4.0}, 0.01, 6 * pond.texel_m);
    double last = 0.0;
    for (const double time : {4.0, 8.0, 10.0}) {
        ripples.move_to(time);
        const auto h = ripples.read();
        // The front: farthest place that is a tenth of the ring's greatest height.
        float top = 0.0f;
        for (const float v : h)
            top = std::max(top, std::abs(v));
        int front = 0;
        for (int x = 256; x < 512; ++x)
            if (std::abs(h[std::size_t(256 * 512 + x)]) > 0.3f * top)
                front = x - 256;
        const double radius = front * pond.texel_m;
        if (last > 0.0)
            EXPECT_NEAR(radius, last, 2.5 * pond.texel_m) << time; // predicted from the time before
        last = radius + pond.speed_m_per_s * (time == 4.0 ? 4.0 : 2.0);
        EXPECT_NEAR(mean(h), 0.0, 1e-6); // a dent moves water, it adds none
    }
}

TEST(RipplesGpu, EnergyIsKeptByWallsAndFadesWithTheDamping) {
    test_support::context();
    for (const double damping : {0.0, 0.8}) {
        const RipplePond pond{
            .texels = 128, .damping_per_s = damping, .edge = RipplePond::Edge::reflects};
        Ripples ripples(pond);
        ripples.move_to(0.0);
        ripples.poke({1.0, 1.2}, 0.01, 6 * pond.texel_m);
        ripples.move_to(1.0);
        const double start = energy(ripples, 128, pond.speed_m_per_s, pond.texel_m);
        ripples.move_to(4.0);
        const double later = energy(ripples, 128, pond.speed_m_per_s, pond.texel_m);
        const double expected = std::exp(-2.0 * damping * 3.0);
        EXPECT_NEAR(later / start, expected, damping > 0.0 ? 0.03 * expected : 1e-3) << damping;
    }
}

TEST(RipplesGpu, AbsorbingShoresLetWavesOutAndReflectingOnesDoNot) {
    test_support::context();
    for (const bool by_mask : {false, true})
        for (const bool absorbs : {false, true}) {
            RipplePond pond{.texels = 256, .damping_per_s = 0.0};
            pond.edge = absorbs ? RipplePond::Edge::absorbs : RipplePond::Edge::reflects;
            if (by_mask) { // a round pond of 1.6 m in the middle of the square
                pond.mask.assign(256 * 256, 0);
                for (int y = 0; y < 256; ++y)
                    for (int x = 0; x < 256; ++x)
                        if (std::hypot(x - 128, y - 128) > 100)
                            pond.mask[std::size_t(y * 256 + x)] = absorbs ? 2 : 1;
            }
            Ripples ripples(pond);
            ripples.move_to(0.0);
            ripples.poke({2.0, 2.0}, 0.01, 8 * pond.texel_m);
            ripples.move_to(2.0);
            const double start = energy(ripples, 256, pond.speed_m_per_s, pond.texel_m);
            ripples.move_to(14.0); // once across and back
            const double later = energy(ripples, 256, pond.speed_m_per_s, pond.texel_m);
            std::printf("%s %s: %.4f of the energy is left\n", by_mask ? "round" : "square",
                        absorbs ? "absorbs" : "reflects", later / start);
            if (absorbs)
                EXPECT_LT(later / start, 0.05);
            else // the energy's sum sees the land beside a round shore as if it had a slope
                EXPECT_NEAR(later / start, 1.0, by_mask ? 0.1 : 1e-3);
            for (const float h : ripples.read())
                ASSERT_LT(std::abs(h), 0.011f);
        }
}

TEST(RipplesGpu, AnyTimeStepIsStable) {
    test_support::context();
    RipplePond pond{.texels = 128, .edge = RipplePond::Edge::wraps};
    pond.drops_per_m2_s = 50.0;
    Ripples ripples(pond);
    double time = 0.0;
    for (const double step : {1e-6, 0.01, 0.1, 3.0, 600.0, 1e6, 1e9, -5.0, -1e9, 0.0}) {
        time += step;
        ripples.move_to(time);
        float most = 0.0f;
        for (const float h : ripples.read()) {
            ASSERT_TRUE(std::isfinite(h)) << step;
            most = std::max(most, std::abs(h));
        }
        EXPECT_GT(most, 0.0f) << step;
        EXPECT_LT(most, 8 * pond.drop_height_m) << step;
    }
    EXPECT_LT(ripples.steps(),
              10'000); // a billion seconds cost no more than what damping lets live
}

TEST(RipplesGpu, RainIsTheSameHoweverItsTimeIsReached) {
    test_support::context();
    RipplePond pond{.texels = 128};
    pond.drops_per_m2_s = 50.0;
    Ripples direct(pond), slow(pond);
    direct.move_to(20.0);
    for (double t = 14.0; t < 20.0; t += 1.0 / 60.0)
        slow.move_to(t);
    slow.move_to(20.0);
    const auto a = direct.read(), b = slow.read();
    float most = 0.0f, off = 0.0f;
    for (std::size_t i = 0; i < a.size(); ++i) {
        most = std::max(most, std::abs(a[i]));
        off = std::max(off, std::abs(a[i] - b[i]));
    }
    EXPECT_LT(off, 2e-3f * most);
}

// Campbell's theorem (waves/ripples.hpp) for the slopes that rain keeps up.
TEST(RipplesGpu, RainsMeanSquareSlopeIsPredicted) {
    test_support::context();
    RipplePond pond{.texels = 256};
    waves::RippleSettings rain;
    rain.rain_drops_per_m2_s = pond.drops_per_m2_s = 40.0;
    Ripples ripples(pond);
    double sum = 0.0;
    const int times = 20;
    for (int k = 0; k < times; ++k) {
        ripples.move_to(10.0 + 1.3 * k);
        const auto h = ripples.read();
        for (int y = 0; y < 256; ++y)
            for (int x = 0; x < 256; ++x) {
                const float here = h[std::size_t(y * 256 + x)];
                const double sx = (h[std::size_t(y * 256 + (x + 1) % 256)] - here) / pond.texel_m;
                const double sy = (h[std::size_t((y + 1) % 256 * 256 + x)] - here) / pond.texel_m;
                sum += sx * sx + sy * sy;
            }
    }
    const double measured = sum / (256.0 * 256.0 * times);
    std::printf("rain of 40 drops: mean square slope %.3e, predicted %.3e\n", measured,
                waves::rain_slope(rain));
    // The first instants, before half the energy is in motion, and rings of few texels: within a
    // fifth.
    EXPECT_NEAR(measured / waves::rain_slope(rain), 1.0, 0.2);
}

// Pokes of a scene: rings on one square of water around them, the same however their time is
// reached, held by the lake's own shores.
TEST(RipplesGpu, PokesShowTheirRingsAtAnyTimeAndStopAtTheShore) {
    test_support::context();
    const scene::Scene scene = scene::bowl(513); // water within 250 m of the middle
    waves::Settings s;
    s.texels = 128;
    s.ripples.pokes = {{.x_m = 0.0, .y_m = 247.0, .height_m = 0.1, .radius_m = 0.5, .time_s = 2.0}};
    const waves::Sea sea = waves::make_sea(scene.ground, scene.water, scene.lakes, s);
    ASSERT_EQ(sea.cascades.size(), 1u);
    const waves::Cascade& c = sea.cascades[0];
    render::WaveField field, other;
    field.set(sea);
    other.set(sea);
    const auto most = [&](double time) {
        field.move_to(time);
        float top = 0.0f;
        for (const glm::vec3& v : field.read(0))
            top = std::max(top, std::abs(v.x));
        return top;
    };
    EXPECT_EQ(most(1.0), 0.0f);
    EXPECT_GT(most(2.2), 0.01f);
    EXPECT_GT(most(4.0), 0.003f);
    for (double t = 0.0; t < 5.0; t += 0.13)
        other.move_to(t);
    other.move_to(5.0);
    field.move_to(1.0);
    field.move_to(5.0);
    EXPECT_EQ(field.read(0), other.read(0));
    // Nothing on land; waves on the water side.
    int wet = 0;
    const auto texels = field.read(0);
    for (int y = 0; y < c.texels; ++y)
        for (int x = 0; x < c.texels; ++x) {
            const glm::dvec2 at = c.corner_m + c.texel_m() * glm::dvec2(x, y);
            const float h = texels[std::size_t(y * c.texels + x)].x;
            if (glm::length(at) > 252.0)
                ASSERT_EQ(h, 0.0f) << x << " " << y;
            wet += glm::length(at) < 248.0 && std::abs(h) > 1e-4f;
        }
    EXPECT_GT(wet, 100);
}
