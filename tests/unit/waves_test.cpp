// Spectra, fetch and the making of a sea, against closed forms and published growth.
#include "core/error.hpp"
#include "scene/samples.hpp"
#include "support/files.hpp"
#include "waves/sea.hpp"
#include "waves/wind_rose.hpp"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

using namespace tarn;
using waves::Model;

namespace {

waves::Settings windy(Model model, double wind) {
    waves::Settings s;
    s.model = model;
    s.wind_m_per_s = wind;
    return s;
}

/// A lake of any shape: deep where `wet` says so.
scene::Scene lake(int side, double spacing_m, const std::function<bool(int, int)>& wet) {
    scene::Scene scene = scene::bowl(side);
    for (Heightfield* h : {&scene.ground, &scene.water}) {
        h->spacing_m = spacing_m;
        h->west_m = 0.0;
        h->north_m = 0.0;
    }
    scene.ground.offset_m = -20.0;
    scene.ground.scale_m = 0.01;
    scene.water.offset_m = -0.01;
    scene.water.scale_m = 0.01;
    for (int row = 0; row < side; ++row)
        for (int col = 0; col < side; ++col) {
            scene.ground.codes[{col, row}] = wet(col, row) ? 0 : 4000;
            scene.water.codes[{col, row}] = wet(col, row) ? 1 : 0;
        }
    scene.lakes[0].level_m = 0.0;
    scene.lakes[0].west_north = {0, 0};
    scene.lakes[0].east_south = {side - 1, side - 1};
    scene.lakes[0].mean_depth_m = 20.0;
    return scene;
}

waves::Sea sea_of(const scene::Scene& scene, const waves::Settings& s) {
    return waves::make_sea(scene.ground, scene.water, scene.lakes, s);
}

} // namespace

TEST(Waves, DispersionHasItsLimits) {
    EXPECT_NEAR(waves::omega_per_s(1.0, 1e4), std::sqrt(9.81), 1e-4);             // deep
    EXPECT_NEAR(waves::omega_per_s(1e-3, 2.0) / 1e-3, std::sqrt(9.81 * 2), 1e-5); // shallow
    EXPECT_EQ(waves::omega_per_s(1.0, 0.0), 0.0);
    // Slowest where gravity and surface tension pull alike: 23 cm/s at 1.7 cm.
    double slowest = 1e9, at = 0.0;
    for (double k = 50; k < 1000; k += 0.5)
        if (waves::omega_per_s(k, 1e4) / k < slowest) {
            slowest = waves::omega_per_s(k, 1e4) / k;
            at = k;
        }
    EXPECT_NEAR(slowest, 0.231, 0.001);
    EXPECT_NEAR(2 * M_PI / at, 0.0172, 0.0003);
    EXPECT_NEAR(at, waves::greatest_k_per_m, 8.0);
    for (const double k : {0.01, 0.5, 3.0, 300.0})
        for (const double depth : {0.1, 3.0, 1e4}) {
            const double h = 1e-5 * k;
            EXPECT_NEAR(waves::group_speed_m_per_s(k, depth),
                        (waves::omega_per_s(k + h, depth) - waves::omega_per_s(k - h, depth)) /
                            (2 * h),
                        1e-6 * (1 + waves::group_speed_m_per_s(k, depth)));
        }
}

// Hasselmann et al. 1973: m0 = 1.6e-7 (g F / U^2) U^4 / g^2; Pierson & Moskowitz: Hs = .21 U^2 / g.
TEST(Waves, HeightsGrowAsPublished) {
    for (const double wind : {4.0, 8.0, 15.0})
        for (const double fetch : {1e3, 5e3, 2e4}) {
            const waves::Spectrum s(windy(Model::jonswap, wind), fetch, 1e4);
            const double grown = 4 * std::sqrt(1.6e-7 * fetch / 9.81) * wind; // Hs
            // Less what the small-wave cut-off takes.
            EXPECT_NEAR(s.significant_height_m() / grown, 0.985, 0.016) << wind << " " << fetch;
            const double period = 2 * M_PI / (22 * std::cbrt(9.81 * 9.81 / (wind * fetch)));
            EXPECT_NEAR(s.peak_period_s(), period, 1e-9 * period);
        }
    for (const double wind : {5.0, 12.0}) {
        const double grown = 0.21 * wind * wind / 9.81;
        EXPECT_NEAR(waves::Spectrum(windy(Model::phillips, wind), 1e6, 1e4).significant_height_m() /
                        grown,
                    1.0, 0.2);
        EXPECT_NEAR(waves::Spectrum(windy(Model::jonswap, wind), 1e6, 1e4).significant_height_m() /
                        grown,
                    1.0, 0.05);
    }
}

TEST(Waves, ShallowWaterHoldsWavesDownAndDeepWaterDoesNot) {
    const waves::Settings tma = windy(Model::tma, 10), deep = windy(Model::jonswap, 10);
    const waves::Spectrum a(tma, 5e3, 1e3), b(deep, 5e3, 1e3);
    for (double k = 0.3; k < 100; k *= 1.3)
        EXPECT_NEAR(a.density(k), b.density(k), 1e-3 * b.density(k)) << k;
    double last = 1e9;
    for (const double depth : {20.0, 5.0, 2.0, 1.0, 0.5}) {
        const double height = waves::Spectrum(tma, 5e3, depth).significant_height_m();
        EXPECT_LT(height, last);
        EXPECT_LT(height, 0.7 * depth) << depth;
        last = height;
    }
}

TEST(Waves, SpreadingAddsUpToOneAndSlopesStayBelowCoxAndMunk) {
    for (const Model model : {Model::phillips, Model::jonswap, Model::tma})
        for (const double wind : {2.0, 6.0, 20.0}) {
            const waves::Spectrum s(windy(model, wind), 3e3, 30.0);
            for (const double k : {0.5 * s.peak_k(), s.peak_k(), 5 * s.peak_k(), 50 * s.peak_k()}) {
                double sum = 0.0;
                for (int i = 0; i < 7200; ++i)
                    sum += s.spread(k, (i + 0.5) * 2 * M_PI / 7200 - M_PI) * 2 * M_PI / 7200;
                EXPECT_NEAR(sum, 1.0, 1e-3) << int(model) << " " << k;
            }
            EXPECT_LE(s.moments().slope(), 1.01 * waves::cox_munk_slope(wind))
                << int(model) << " " << wind;
            EXPECT_GT(s.moments().slope_along, s.moments().slope_across);
            // The two-dimensional density says the same as the two factors.
            double height = 0.0;
            const double top = 4 * s.peak_k(), step = top / 400;
            for (int i = -400; i < 400; ++i)
                for (int j = -400; j < 400; ++j) {
                    const glm::dvec2 k((i + 0.5) * step, (j + 0.5) * step);
                    if (std::hypot(k.x, k.y) < top)
                        height += s.at(k) * step * step;
                }
            EXPECT_NEAR(height / s.moments(s.lowest_k() / 4, top).height, 1.0, 0.01);
        }
}

TEST(Waves, StraightFetchIsTheDistanceToTheShore) {
    // A channel 100 squares long and 11 wide, of 10 m.
    const scene::Scene scene =
        lake(128, 10.0, [](int c, int r) { return c >= 10 && c < 110 && r >= 40 && r < 51; });
    const waves::WaterMask mask = waves::water_mask(scene.ground, scene.water);
    ASSERT_EQ(mask.side_m, 10.0);
    EXPECT_NEAR(waves::straight_fetch_m(mask, {109, 45}, 270.0), 995.0, 1e-6); // from the west
    EXPECT_NEAR(waves::straight_fetch_m(mask, {10, 45}, 270.0), 5.0, 1e-6);
    EXPECT_NEAR(waves::straight_fetch_m(mask, {60, 40}, 180.0), 105.0, 1e-6); // from the south
    EXPECT_NEAR(waves::straight_fetch_m(mask, {60, 45}, 315.0), 55.0 * std::sqrt(2.0), 1e-6);
    EXPECT_EQ(waves::straight_fetch_m(mask, {5, 5}, 0.0), 0.0);
    // Narrow water: the effective fetch is far below the straight one, but not for the wind across.
    const Grid<float> along = waves::effective_fetch_m(mask, 270.0),
                      across = waves::effective_fetch_m(mask, 180.0);
    EXPECT_LT((along[{109, 45}]), 500.0f);
    EXPECT_GT((along[{109, 45}]), 150.0f);
    EXPECT_NEAR((across[{60, 40}]), 105.0f, 12.0f);
    // In the middle of a wide square all directions see a like distance: sum of cos^2 over sum of
    // cos.
    const scene::Scene disc =
        lake(201, 10.0, [](int c, int r) { return std::hypot(c - 100, r - 100) < 90; });
    const waves::WaterMask round = waves::water_mask(disc.ground, disc.water);
    double squares = 0.0, cosines = 0.0;
    for (int k = -7; k <= 7; ++k) {
        squares += std::pow(std::cos(6 * k * M_PI / 180), 2);
        cosines += std::cos(6 * k * M_PI / 180);
    }
    EXPECT_NEAR((waves::effective_fetch_m(round, 123.0)[{100, 100}]), 895.0 * squares / cosines,
                10.0);
}

TEST(Waves, APondStaysCalmInTheWindThatRoughensALake) {
    // A lake 2 km wide beside a pond of 60 m.
    const scene::Scene scene = lake(257, 10.0, [](int c, int r) {
        return (c < 200 && r > 20 && r < 220) || (c >= 230 && c < 236 && r >= 100 && r < 106);
    });
    const waves::Sea sea = sea_of(scene, windy(Model::jonswap, 8));
    const auto share = [&](int c, int r, std::size_t j) {
        return sea.amplitude[{c, r}][j] / 255.0;
    };
    EXPECT_LT(share(5, 215, 0), 0.3); // upwind corner (wind from 240)
    double lake_height = 0.0, pond_height = 0.0;
    for (int r = 21; r < 220; ++r)
        for (int c = 0; c < 200; ++c) {
            double here = 0.0;
            for (std::size_t j = 0; j < sea.cascades.size(); ++j)
                here += std::pow(share(c, r, j), 2) * sea.cascades[j].moments.height;
            lake_height = std::max(lake_height, here);
        }
    for (std::size_t j = 0; j < sea.cascades.size(); ++j)
        pond_height += std::pow(share(233, 103, j), 2) * sea.cascades[j].moments.height;
    EXPECT_LT(4 * std::sqrt(pond_height), 0.25 * 4 * std::sqrt(lake_height));
    EXPECT_NEAR(4 * std::sqrt(lake_height), sea.report.significant_height_m,
                0.05 * sea.report.significant_height_m);
}

TEST(Waves, PondsSmallerThanASquareOfTheFetchMapHaveTheirWaves) {
    // 2049 nodes of 2 m: squares of 9; a pond of 6 x 6 nodes across a corner of four of them.
    const scene::Scene scene =
        lake(2049, 2.0, [](int c, int r) { return c >= 897 && c < 903 && r >= 897 && r < 903; });
    const waves::WaterMask mask = waves::water_mask(scene.ground, scene.water);
    EXPECT_GT(mask.side_m, 12.0);
    const waves::Sea sea = sea_of(scene, windy(Model::jonswap, 8));
    int most = 0;
    for (const auto& shares : sea.amplitude.values)
        most = std::max(most, int(shares[0]));
    EXPECT_EQ(most, 255);
}

TEST(Waves, NoBandIsCountedTwiceAndNothingIsLost) {
    const scene::Scene scene = scene::tank();
    for (const Model model : {Model::phillips, Model::jonswap, Model::tma})
        for (int cascades = 1; cascades <= 4; ++cascades)
            for (const int texels : {128, 512}) {
                waves::Settings s = windy(model, 6);
                s.cascades = cascades;
                s.texels = texels;
                s.fetch_m = 3000.0;
                const waves::Sea sea = sea_of(scene, s);
                double height = 0.0, slope = sea.roughness.trace();
                for (std::size_t j = 0; j < sea.cascades.size(); ++j) {
                    const waves::Cascade& c = sea.cascades[j];
                    if (j > 0)
                        EXPECT_EQ(c.low_k, sea.cascades[j - 1].high_k);
                    // Four texels for the shortest wave; several of the longest in a patch.
                    EXPECT_LE(c.high_k, 0.5 * M_PI * texels / c.patch_m * 1.0001);
                    if (j > 0)
                        EXPECT_GE(c.low_k * c.patch_m / (2 * M_PI), 10.5);
                    // The lattice holds nothing outside the band.
                    const double dk = 2 * M_PI / c.patch_m;
                    for (int y = 0; y < texels; ++y)
                        for (int x = 0; x < texels; ++x) {
                            const double k = dk * std::hypot(x < texels / 2 ? x : x - texels,
                                                             y < texels / 2 ? y : y - texels);
                            if (k < c.low_k || k >= c.high_k)
                                ASSERT_EQ(c.h0[std::size_t(y * texels + x)].x, 0.0f);
                        }
                    height += c.moments.height;
                    slope += c.moments.slope();
                }
                const waves::Spectrum whole(s, 3000.0, 8.0);
                EXPECT_NEAR(slope / whole.moments().slope(), 1.0, 0.01)
                    << int(model) << cascades << texels;
                // Few or small patches leave out the shortest, lowest waves.
                const bool roomy = cascades >= 3 || (cascades == 2 && texels == 512);
                EXPECT_NEAR(height / whole.moments().height, 1.0, roomy ? 0.03 : 0.2)
                    << int(model) << cascades << texels;
                // No two sides in a simple ratio: what repeats after 1, 2, 3, ... of one does not
                // of another.
                for (std::size_t j = 1; j < sea.cascades.size(); ++j) {
                    const double ratio = sea.cascades[j - 1].patch_m / sea.cascades[j].patch_m;
                    for (int n = 1; n <= 4; ++n)
                        EXPECT_GT(std::abs(n * ratio - std::round(n * ratio)), 0.005) << ratio;
                }
            }
}

// The lattice's variances add up to the integral, over many seeds within 1 %.
TEST(Waves, VarianceAndSlopesAreTheSpectrumsIntegral) {
    const scene::Scene scene = scene::tank();
    for (const Model model : {Model::phillips, Model::jonswap, Model::tma}) {
        waves::Settings s = windy(model, 6);
        s.texels = 128;
        s.fetch_m = 3000.0;
        double height = 0.0, slope = 0.0, expected = 0.0, expected_slope = 0.0;
        for (std::uint32_t seed = 1; seed <= 120; ++seed) {
            s.seed = seed;
            const waves::Sea sea = sea_of(scene, s);
            for (const waves::Cascade& c : sea.cascades) {
                expected += c.moments.height;
                expected_slope += c.moments.slope();
                const double dk = 2 * M_PI / c.patch_m;
                for (int y = 0; y < 128; ++y)
                    for (int x = 0; x < 128; ++x) {
                        const glm::vec4& h = c.h0[std::size_t(y * 128 + x)];
                        const double power = 2.0 * (double(h.x) * h.x + double(h.y) * h.y);
                        const double k2 =
                            dk * dk *
                            (std::pow(x < 64 ? x : x - 128, 2) + std::pow(y < 64 ? y : y - 128, 2));
                        height += power;
                        slope += power * k2;
                    }
            }
        }
        EXPECT_NEAR(height / expected, 1.0, 0.01) << int(model);
        EXPECT_NEAR(slope / expected_slope, 1.0, 0.01) << int(model);
    }
}

TEST(Waves, ExtremesAreDrawnOrSaidToBeCalm) {
    const scene::Scene scene = scene::tank();
    const auto with = [&](auto change) {
        waves::Settings s = windy(Model::jonswap, 6);
        s.texels = 128;
        s.fetch_m = 2000.0;
        change(s);
        return sea_of(scene, s);
    };
    EXPECT_TRUE(with([](auto& s) { s.wind_m_per_s = 0.0; }).still());
    EXPECT_TRUE(with([](auto& s) { s.wind_m_per_s = 0.1; }).still());
    EXPECT_EQ(with([](auto& s) { s.wind_m_per_s = 0.1; }).report.notes.size(), 1u);
    EXPECT_TRUE(with([](auto& s) { s.depth_m = 0.0; }).still());
    const waves::Sea storm = with([](auto& s) {
        s.wind_m_per_s = 60.0;
        s.texels = 512;
    });
    EXPECT_FALSE(storm.still());
    EXPECT_FALSE(storm.report.notes.empty()); // choppiness held back
    for (const waves::Cascade& c : storm.cascades)
        EXPECT_LE(c.choppiness * 6.0 * std::sqrt(c.moments.slope()), 0.951);
    const waves::Sea small = with([](auto& s) { s.patch_m = 0.5; });
    EXPECT_LT(small.report.drawn_height_m, 0.2 * small.report.significant_height_m);
    EXPECT_FALSE(small.report.notes.empty()); // says that the patch holds little
    const waves::Sea list = with([](auto& s) {
        s.model = Model::gerstner;
        s.cascades = 1;
        s.list = {{0.1, 10.0, 0.0, 0.0}, {0.01, 0.1, 0.0, 0.0}, {2.0, 6.0, 10.0, 0.0}};
        s.choppiness = 2.0;
    });
    double steepness = 0.0;
    for (const auto& w : list.settings.list)
        if (w.length_m > 1.0)
            steepness += 2 * M_PI / w.length_m * w.amplitude_m;
    EXPECT_NEAR(list.cascades[0].choppiness, 0.98 / steepness, 0.05 * 0.98 / steepness);
    EXPECT_NE(list.report.notes[0].find("left out"), std::string::npos);
    // Rain is no denser than it is drawn.
    const auto rain = [&](double rate) {
        return with([&](auto& s) {
                   s.model = Model::calm;
                   s.ripples.rain_drops_per_m2_s = rate;
               })
            .cascades[0]
            .moments.slope();
    };
    EXPECT_NEAR(rain(400) / rain(200), 2.0, 1e-9);
    EXPECT_EQ(rain(1e4), rain(5e3));
    const waves::Sea frozen = with([](auto& s) { s.loop_s = 0.05; });
    ASSERT_EQ(frozen.report.notes.size(), 1u);
    EXPECT_NE(frozen.report.notes[0].find("stand still"), std::string::npos);
    for (const double patch : {0.5, 5.0, 1e5}) {
        const waves::Sea sea = with([&](auto& s) { s.patch_m = patch; });
        double slope = sea.roughness.trace();
        for (const waves::Cascade& c : sea.cascades)
            slope += c.moments.slope();
        EXPECT_TRUE(std::isfinite(slope) && slope > 0.0) << patch;
    }
    EXPECT_THROW(with([](auto& s) { s.texels = 100; }), Error);
    EXPECT_THROW(with([](auto& s) { s.wind_m_per_s = std::nan(""); }), Error);
    EXPECT_THROW(with([](auto& s) { s.model = Model::sines; }), Error);
    EXPECT_EQ(waves::loop_fraction(5e9, 600.0), waves::loop_fraction(5e9 + 600.0 * 1e5, 600.0));
}

TEST(Waves, WindRosesAreReadAndBadOnesNameTheirLine) {
    const test_support::TempFolder folder;
    const auto write = [&](const std::string& words) {
        std::ofstream(folder.path() / "rose") << words;
        return folder.path() / "rose";
    };
    const auto rose =
        waves::read_wind_rose(write("direction,speed,share\n0,3,1\r\n# calm\n240; 8 ; 3\n\n"));
    ASSERT_EQ(rose.size(), 2u);
    EXPECT_EQ(rose[1].from_deg, 240.0);
    EXPECT_EQ(rose[1].share, 0.75);
    EXPECT_EQ(waves::prevailing(rose).speed_m_per_s, 8.0);
    for (const char* bad :
         {"0,3\n", "0,3,1,5\n", "0,200,1\n", "-5,3,1\n", "0,nan,1\n", "", "a b c\n", "1,2,0\n"})
        EXPECT_THROW(waves::read_wind_rose(write(bad)), Error) << bad;
    try {
        waves::read_wind_rose(write("0,3,1\n0,3\n"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("line 2"), std::string::npos);
    }
    EXPECT_THROW(waves::read_wind_rose(folder.path()), Error);
}
