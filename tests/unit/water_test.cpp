// Water types and their colour, against published figures, limits and independent sums.
#include "core/error.hpp"
#include "reference/fresnel.hpp"
#include "reference/medium.hpp"
#include "scene/water_colour.hpp"
#include "scene/water_types.hpp"
#include "support/files.hpp"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <random>

using namespace tarn;
using namespace tarn::scene;

TEST(WaterTypes, PureWaterIsPopeAndFrys) {
    const WaterOptics pure = water_type("pure");
    EXPECT_DOUBLE_EQ(band_at(pure.bands, 440).absorption_per_m, .00635);
    EXPECT_NEAR(band_at(pure.bands, 555).absorption_per_m, (.0565 + .0619) / 2, 1e-12);
    EXPECT_DOUBLE_EQ(band_at(pure.bands, 700).absorption_per_m, .624);
    EXPECT_NEAR(band_at(pure.bands, 550).scattering_per_m, .0015, 1e-12);
    EXPECT_NEAR(pure.absorption_per_m.x, .2755, 1e-12); // 620 nm
}

// A ray of the model fades over depth, at the mean cosine .86, as Jerlov's light does.
TEST(WaterTypes, JerlovsLightFadesAsHisTableSays) {
    struct Row {
        const char* name;
        double kd_425, kd_550, kd_700;
    };
    for (const Row& row : {Row{"jerlov I", .022, .063, .56}, Row{"jerlov II", .081, .089, .61},
                           Row{"jerlov 3C", .54, .19, .71}, Row{"jerlov 9C", 1.9, .63, 1.1}}) {
        const WaterOptics w = water_type(row.name);
        for (const auto& [nm, kd] :
             {std::pair{425.0, row.kd_425}, {550.0, row.kd_550}, {700.0, row.kd_700}})
            EXPECT_NEAR(band_at(w.bands, nm).attenuation_per_m() / .86, kd, .02 * kd)
                << row.name << " " << nm; // bands lie 10 nm apart, his 25
    }
}

TEST(WaterTypes, RelationsThatHoldInAnyWater) {
    for (const std::string& name : water_type_names())
        for (const WaterBand& band : water_type(name).bands) {
            const double kd = diffuse_attenuation_per_m(band),
                         c = band.absorption_per_m + band.scattering_per_m;
            EXPECT_GT(kd, band.absorption_per_m) << name;
            EXPECT_LT(kd, 1.2 * c) << name;
            EXPECT_LE(band.backscattering_per_m, 0.5 * band.scattering_per_m) << name;
        }
}

TEST(WaterTypes, SecchiDepthComesBack) {
    double before = 0.0;
    for (const double z : {.1, .5, 2.0, 8.0, 25.0, 80.0}) {
        const WaterOptics w = water_by_secchi(z);
        EXPECT_NEAR(secchi_depth_m(w), z, 1e-6 * z);
        // The classical rule, Kd(490) = 1.7 / Z (1.45 is used, too), holds to a factor of two.
        const double kd = diffuse_attenuation_per_m(band_at(w.bands, 490));
        if (z <= 25.0) {
            EXPECT_GT(kd * z, 1.45 / 2) << z;
            EXPECT_LT(kd * z, 1.7 * 2) << z;
        }
        EXPECT_GT(z, before);
        before = z;
    }
    EXPECT_THROW(water_by_secchi(0.0), Error);
    EXPECT_THROW(water_by_secchi(std::nan("")), Error);
}

TEST(WaterTypes, TablesAreReadAndBadOnesNamed) {
    const test_support::TempFolder folder;
    const auto file = folder.path() / "water.csv";
    const auto write = [&](const std::string& words) {
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file) << words;
    };
    write("\xef\xbb\xbf# a lake\nwavelength,a,b\n400, .1, .5\n550 .2 .4 .01\r\n700;.7;.3\n");
    const WaterOptics w = read_water_table(file);
    ASSERT_EQ(w.bands.size(), 3u);
    EXPECT_NEAR(w.bands[0].backscattering_per_m, .0183 * .5, 1e-12);
    EXPECT_NEAR(w.bands[1].backscattering_per_m, .01, 1e-12);
    EXPECT_EQ(w.name, "table water.csv");
    for (const auto& [words, expected] :
         {std::pair{"400 .1 .5\n400 .2 .4\n", "wavelengths must rise at 400 nm"},
          {"400 .1 .5\n500 .2\n", "line 2: is not 3 to 4 numbers"},
          {"400 .1 .5\n", "fewer than two wavelengths"},
          {"", "fewer than two wavelengths"},
          {"400 -1 .5\n500 .1 .1\n", "absorption_per_m at 400 nm is -1"},
          {"400 .1 .1 .2\n500 .1 .1\n", "backscattering_per_m at 400 nm"},
          {"400 .1 nan\n500 .1 .1\n", "line 1: is not 3"},
          {"400 .1 x\n500 .1 .1\n600 1 1\n", "line 1: is not 3"},
          {"nm a b\n400 .1 .1\n600 1 1\nx\n", "line 4"}}) {
        write(words);
        try {
            read_water_table(file);
            ADD_FAILURE() << words;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
        }
    }
    EXPECT_THROW(read_water_table(file.parent_path()), Error);
}

TEST(WaterColour, TheObserverIsTheCIEs) {
    // White's coordinates: an even spectrum has x = y = z = 1/3 within the fit's 1 %, so the sun's
    // colour is near white in sRGB (its D65 has 6504 K).
    glm::dvec3 sun(0.0);
    for (double nm = 380; nm <= 780; nm += 1)
        sun += sunlight_colour(nm);
    EXPECT_GT(sun.x, sun.y); // 5772 K is yellower than 6504 K
    EXPECT_GT(sun.y, sun.z);
    EXPECT_LT(sun.x / sun.y, 1.25);
    EXPECT_GT(sun.z / sun.y, 0.75);
    EXPECT_LT(sunlight_colour(500).x, 0.0); // out of gamut, as spectral cyan is
}

TEST(WaterColour, LimitsOfTheTable) {
    for (const char* name : {"pure", "clear lake", "jerlov 9C"}) {
        const WaterOptics w = water_type(name);
        const WaterTable t = make_water_table(w, true);
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(t.rows[0][0][k], 1.0, 1e-6);
            EXPECT_EQ(t.rows[1][0][k], 0.0f);
            EXPECT_NEAR(t.rows[0].back()[k], 0.0, 1e-3);
        }
    }
    // Red goes first in clear water, blue in brown.
    const auto left = [](const char* name) {
        return reference::Medium(water_type(name), true).transmittance(5.0);
    };
    EXPECT_LT(left("clear lake").x, left("clear lake").y);
    EXPECT_LT(left("humic lake").z, left("humic lake").x);
    // Three channels are three exponentials.
    const WaterTable rgb = make_water_table(water_type("pure"), false);
    EXPECT_NEAR(rgb.rows[0][1000].x,
                std::exp(-water_type("pure").attenuation_per_m().x * rgb.path_m(1000)), 1e-6);
}

// An even sky: what enters over n^2 equals what would leave again. .066 and .475 are the published
// diffuse reflectances of flat water.
TEST(WaterColour, DiffuseReflectancesOfFlatWater) {
    const WaterTable t = make_water_table(
        {.absorption_per_m = glm::dvec3(0), .backscattering_per_m = glm::dvec3(0)}, true);
    EXPECT_NEAR(1.0 - t.sky_entering, .066, 1e-3);
    EXPECT_NEAR(t.rows[3][0].y, .475, 2e-3);
    const reference::Medium medium({}, true);
    EXPECT_NEAR(medium.sky_entering(), t.sky_entering, 1e-5);
    EXPECT_NEAR(medium.thrown_back(0.0).y, t.rows[3][0].y, 1e-3);
}

// Photons between a white-ish flat bed and the surface, by brute force: what reaches the bed in all
// against the closed form 1 / (1 - A B).
TEST(WaterColour, LightThrownBackAtTheBedByPhotons) {
    const double absorption = 0.15, depth = 2.0, albedo = 0.6, n = 1.333;
    WaterOptics optics{.absorption_per_m = glm::dvec3(absorption),
                       .backscattering_per_m = glm::dvec3(0),
                       .index = n};
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> even;
    double arrived = 0.0;
    constexpr int photons = 400'000;
    for (int i = 0; i < photons; ++i) {
        double weight = 1.0; // has just arrived at the bed
        while (weight > 1e-4) {
            arrived += weight;
            const double cosine = std::sqrt(1.0 - even(random)); // Lambert
            weight *= albedo * std::exp(-2.0 * absorption * depth / cosine) *
                      reference::fresnel_dielectric(cosine, n);
        }
    }
    const double closed =
        1.0 / (1.0 - albedo * reference::Medium(optics, true).thrown_back(depth).y);
    EXPECT_NEAR(arrived / photons / closed, 1.0, 2e-3);
    EXPECT_GT(closed, 1.05); // there is something to see
}

// Published bulk reflectivity of deep water: pi L / E around .04 in Tessendorf's notes (5.1) for
// the sea's blue; irradiance reflectance R = .33 b_b / a (Gordon et al. 1975) in all waters where
// b_b << a.
TEST(WaterColour, BulkReflectivityIsOfThePublishedSize) {
    for (const char* name : {"pure", "clear lake", "eutrophic lake", "jerlov II"}) {
        const WaterOptics w = water_type(name);
        for (const double nm : {440.0, 550.0, 650.0}) {
            const WaterBand band = band_at(w.bands, nm);
            if (band.backscattering_per_m > 0.1 * band.absorption_per_m)
                continue;
            WaterOptics one{.absorption_per_m = glm::dvec3(band.absorption_per_m),
                            .backscattering_per_m = glm::dvec3(band.backscattering_per_m)};
            const double L = reference::Medium(one, false).path_radiance(1.0, 0.0, 1.0, 0.0, 1e5).y;
            const double ratio =
                M_PI * L / (0.33 * band.backscattering_per_m / band.absorption_per_m);
            EXPECT_GT(ratio, 0.6) << name << " " << nm; // quasi-single scattering: .25 against .33
            EXPECT_LT(ratio, 1.0) << name << " " << nm;
        }
    }
}
