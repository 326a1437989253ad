#include "core/error.hpp"
#include "core/heightfield.hpp"
#include "core/lake_record.hpp"
#include "core/progress.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <random>

using namespace tarn;

TEST(Heightfield, ErrorIsAtMostHalfAStep) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> z(-420.0f, 4800.0f);
    std::vector<float> input(64 * 32);
    for (float& value : input)
        value = z(random);
    for (const int spare : {0, 4, 1000}) {
        const Heightfield field = quantise(input, {64, 32}, 30.0, spare);
        for (int row = 0; row < 32; ++row)
            for (int col = 0; col < 64; ++col)
                ASSERT_NEAR(field.elevation_m(Node{col, row}), input[std::size_t(row * 64 + col)],
                            field.scale_m * 0.5000001);
        EXPECT_GE(*std::min_element(field.codes.values.begin(), field.codes.values.end()), spare);
        EXPECT_LE(*std::max_element(field.codes.values.begin(), field.codes.values.end()),
                  65535 - spare);
    }
}

TEST(Heightfield, FlatInputIsExact) {
    const Heightfield field = quantise(std::vector<float>(4, 123.5f), {2, 2}, 1.0);
    EXPECT_EQ(field.elevation_m(Node{1, 1}), 123.5);
}

TEST(Heightfield, BilinearElevationIsExactForABilinearFunction) {
    // z = 3 + 2c + 5r + 0.5 c r is reproduced by bilinear patches, up to the codes' rounding.
    std::vector<float> input;
    for (int r = 0; r < 5; ++r)
        for (int c = 0; c < 6; ++c)
            input.push_back(float(3 + 2 * c + 5 * r + 0.5 * c * r));
    Heightfield field = quantise(input, {6, 5}, 10.0);
    field.west_m = 100.0;
    field.north_m = 1000.0;
    for (double x = 100.0; x <= 150.0; x += 3.7)
        for (double y = 960.0; y <= 1000.0; y += 2.9) {
            const double c = (x - 100.0) / 10.0, r = (1000.0 - y) / 10.0;
            EXPECT_NEAR(field.elevation_m(x, y), 3 + 2 * c + 5 * r + 0.5 * c * r, field.scale_m);
        }
    EXPECT_DOUBLE_EQ(field.elevation_m(0.0, 2000.0),
                     field.elevation_m(Node{0, 0})); // outside: the edge
}

TEST(Heightfield, RefusesWhatItsContractForbids) {
    const std::vector<float> four(4, 1.0f);
    EXPECT_THROW(quantise(four, {1, 4}, 1.0), Error);
    EXPECT_THROW(quantise(four, {2, 3}, 1.0), Error);
    EXPECT_THROW(quantise(four, {2, 2}, 0.0), Error);
    EXPECT_THROW(quantise(four, {2, 2}, std::numeric_limits<double>::quiet_NaN()), Error);
    std::vector<float> hole(6, 1.0f);
    hole[4] = std::numeric_limits<float>::quiet_NaN();
    try {
        quantise(hole, {3, 2}, 1.0);
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(),
                     "elevation at column 1, row 1 is not finite; fill or mask no-data "
                     "cells before quantising");
    }
}

TEST(ErrorText, IsOneLineWithActivityCauseAndHint) {
    Error error("first\nsecond", "do this");
    error.during("reading x.tif").during("importing");
    EXPECT_STREQ(error.what(), "importing: reading x.tif: first second; do this");
}

TEST(Bed, WordsRoundTrip) {
    for (const Bed bed : {Bed::measured, Bed::interpolated, Bed::estimated, Bed::unknown})
        EXPECT_EQ(bed_from_string(to_string(bed)), bed);
    EXPECT_THROW(bed_from_string("sand"), Error);
}

TEST(ProgressReport, StopsWorkWhenTheListenerSaysSo) {
    Progress{}.report(0.5, "no listener");
    EXPECT_THROW(Progress([](double, const std::string&) { return false; }).report(0.5, "x"),
                 Cancelled);
}
