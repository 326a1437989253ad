// The yardstick is measured before anything is measured with it.
#include "core/error.hpp"
#include "image/annotate.hpp"
#include "image/compare.hpp"
#include "image/error_map.hpp"
#include "image/files.hpp"
#include "image/tone.hpp"
#include "support/files.hpp"

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <limits>

using namespace tarn;
using namespace tarn::image;
using test_support::TempFolder;

namespace {
Image flat(int w, int h, float value) {
    Image image{.width_px = w, .height_px = h};
    image.radiance.assign(std::size_t(w) * std::size_t(h), glm::vec3(value));
    image.distance_m.assign(image.radiance.size(), 100.0f);
    return image;
}
} // namespace

TEST(Compare, EqualPicturesHaveNoError) {
    const Difference d = compare(flat(9, 7, 0.3f), flat(9, 7, 0.3f));
    EXPECT_EQ(d.mean_relative, 0.0);
    EXPECT_EQ(d.psnr_db, std::numeric_limits<double>::infinity());
}

TEST(Compare, ATwoPercentShiftIsTwoPercent) {
    const Difference d = compare(flat(10, 10, 0.51f), flat(10, 10, 0.5f));
    EXPECT_NEAR(d.mean_relative, 0.02, 1e-6);
    EXPECT_NEAR(d.p99_relative, 0.02, 1e-6);
    EXPECT_NEAR(d.psnr_db, 20 * std::log10(50.0), 1e-4);
}

TEST(Compare, OneBrokenPixelIsFound) {
    Image a = flat(100, 100, 0.5f);
    a.radiance[1234] = glm::vec3(5.0f);
    const Difference d = compare(a, flat(100, 100, 0.5f));
    EXPECT_EQ(d.worst_pixel, 1234u);
    EXPECT_NEAR(d.max_relative, 9.0, 1e-5);
    EXPECT_NEAR(d.mean_relative, 9e-4, 1e-8);
    a.radiance[7].g = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(compare(a, flat(100, 100, 0.5f)).finite);
    EXPECT_THROW(compare(a, flat(10, 100, 0.5f)), Error);
}

TEST(Compare, DistancesAreJudgedAwayFromEdges) {
    Image a = flat(20, 20, 1.0f), b = a;
    a.distance_m[205] += 0.5f; // (5, 10)
    for (int y = 0; y < 20; ++y)
        b.distance_m[std::size_t(y) * 20 + 15] =
            std::numeric_limits<float>::infinity(); // a line of sky
    const DistanceDifference d = compare_distances(a, b, 0.01, 1e-5);
    EXPECT_EQ(d.pixels, 400u);
    EXPECT_EQ(d.edges, 60u);
    EXPECT_EQ(d.different, 1u);
    EXPECT_NEAR(d.worst_m, 0.5, 1e-6);
}

TEST(Tone, MidGreyStaysAndBlackAndWhiteAreEnds) {
    Image image = flat(4, 4, 0.18f);
    const int grey = tone_map(image, 1.0).bytes[0];
    EXPECT_NEAR(grey, 255 * srgb_encode(0.18), 1.0);
    EXPECT_EQ(tone_map(flat(4, 4, 0.0f), 1.0).bytes[5], 0);
    EXPECT_GE(tone_map(flat(4, 4, 1e4f), 1.0).bytes[5], 254);
    EXPECT_EQ(encode_linear(flat(1, 1, 1.0f)).bytes[0], 255);
    // More light is never darker.
    int last = 0;
    for (float v = 0.0f; v < 8.0f; v += 0.05f) {
        const Picture p = tone_map(flat(4, 4, v), 1.0);
        int sum = 0;
        for (const auto byte : p.bytes)
            sum += byte;
        EXPECT_GE(sum, last);
        last = sum;
    }
}

TEST(Tone, ColoursOutsideTheGamutKeepTheirLuminance) {
    const glm::vec3 luminance(0.2126f, 0.7152f, 0.0722f);
    for (const glm::vec3 c : {glm::vec3(-0.1f, 0.4f, 0.5f), glm::vec3(0.3f, -0.02f, -0.05f)}) {
        const glm::vec3 in = into_gamut(c);
        EXPECT_NEAR(glm::dot(in, luminance), glm::dot(c, luminance), 1e-6);
        EXPECT_NEAR(std::min({in.r, in.g, in.b}), 0.0f, 1e-6);
    }
    EXPECT_EQ(into_gamut({0.1f, 0.2f, 9.0f}), glm::vec3(0.1f, 0.2f, 9.0f));
    EXPECT_EQ(into_gamut({-1.0f, 0.0f, 0.0f}), glm::vec3(0.0f));
}

TEST(Tone, AutomaticExposureBringsTheMiddleToTheKey) {
    EXPECT_NEAR(auto_exposure(flat(50, 50, 0.02f), 0.2, 0.0, 1e9), 10.0, 1e-3);
    EXPECT_NEAR(auto_exposure(flat(50, 50, 0.02f), 0.2, 0.0, 4.0), 4.0, 1e-9);
    Image lamp = flat(50, 50, 0.0f); // a lit quarter in the night
    for (int y = 0; y < 25; ++y)
        for (int x = 0; x < 25; ++x)
            lamp.radiance[std::size_t(y * 50 + x)] = glm::vec3(0.02f);
    EXPECT_NEAR(auto_exposure(lamp, 0.2, 0.0, 1e9, 0.02), 10.0, 1e-3);
}

TEST(Files, ExrKeepsEveryBitAndItsDistances) {
    const TempFolder temp;
    Image image = flat(33, 17, 0.0f);
    for (std::size_t i = 0; i < image.radiance.size(); ++i) {
        image.radiance[i] = {float(i) * 1.1f, 1e-7f * float(i), 3e4f};
        image.distance_m[i] = i % 5 ? float(i) * 17.3f : std::numeric_limits<float>::infinity();
    }
    write_exr(temp / "a.exr", image, {{"tarn:level_m", "313.31"}});
    const Image back = read_exr(temp / "a.exr");
    EXPECT_EQ(back.radiance, image.radiance);
    EXPECT_EQ(back.distance_m, image.distance_m);
    EXPECT_EQ(read_metadata(temp / "a.exr").at("tarn:level_m"), "313.31");
}

TEST(Files, PngKeepsPixelsAndMetadataAndLeavesNothingElse) {
    const TempFolder temp;
    Picture p{.width_px = 64, .height_px = 40, .channels = 3};
    for (int i = 0; i < 64 * 40 * 3; ++i)
        p.bytes.push_back(std::uint8_t(i * 7));
    write_png(temp / "a.png", p, {{"tarn:camera", "x=1,y=2"}});
    const Picture back = read_rgba(temp / "a.png");
    for (std::size_t i = 0; i < 64 * 40; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            ASSERT_EQ(back.bytes[4 * i + k], p.bytes[3 * i + k]);
    EXPECT_EQ(read_metadata(temp / "a.png").at("tarn:camera"), "x=1,y=2");
    EXPECT_THROW(write_png(temp / "no/such/folder.png", p, {}), Error);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(temp.path()), {}), 1);
    EXPECT_THROW(read_rgba(temp / "none.png"), Error);
    EXPECT_THROW(read_codes(temp / "a.png"), Error);
}

TEST(Annotate, TextAndBarsChangeThePicture) {
    Picture p{.width_px = 120,
              .height_px = 40,
              .channels = 3,
              .bytes = std::vector<std::uint8_t>(120 * 40 * 3, 90)};
    fill_box(p, -5, 30, 60, 99, 255);
    EXPECT_EQ(p.bytes[(35 * 120 + 10) * 3], 255);
    EXPECT_EQ(p.bytes[(35 * 120 + 70) * 3], 90);
    EXPECT_TRUE(draw_text(p, 5, 20, 14, "10 km")) << "fonts-dejavu-core is not installed";
    EXPECT_GT(std::count_if(p.bytes.begin(), p.bytes.end(), [](int byte) { return byte > 180; }),
              60 * 10 * 3 + 100);
}

// One pixel that is no number stays black and leaves the others their exposure.
TEST(Tone, APixelThatIsNoNumberDarkensNoOther) {
    Image image{.width_px = 16, .height_px = 16, .radiance = {}, .distance_m = {}};
    image.radiance.assign(256, glm::vec3(0.3f));
    const double exposure = image::auto_exposure(image, 0.18, 0.1, 10.0);
    image.radiance[40].g = std::numeric_limits<float>::quiet_NaN();
    image.radiance[90].r = std::numeric_limits<float>::infinity();
    EXPECT_DOUBLE_EQ(image::auto_exposure(image, 0.18, 0.1, 10.0), exposure);
    const Picture shown = image::tone_map(image, exposure), linear = image::encode_linear(image);
    for (const Picture* p : {&shown, &linear}) {
        EXPECT_EQ(p->bytes[3 * 40 + 1], 0);
        EXPECT_EQ(p->bytes[3 * 90], 0);
        EXPECT_GT(p->bytes[0], 50);
    }
}

TEST(Annotate, LettersLoseTheirMarksAndNothingBreaks) {
    Picture plain{.width_px = 300, .height_px = 40, .channels = 3, .bytes = {}};
    plain.bytes.assign(std::size_t(300 * 40 * 3), 60);
    Picture marked = plain, broken = plain;
    ASSERT_TRUE(image::draw_text(plain, 10, 28, 18, "Rotoma Zurich Lac d'Annecy"));
    image::draw_text(marked, 10, 28, 18, "Rotom\xC4\x81 Z\xC3\xBCrich Lac d'Annecy");
    EXPECT_EQ(plain.bytes, marked.bytes);
    image::draw_text(broken, 10, 28, 18, "cut \xC4"); // half a letter
    image::draw_text(broken, 10, 28, 18, "\xF0\x9F\x8C\x8A");
}

TEST(Annotate, ResizesAndPastes) {
    Picture p{.width_px = 40, .height_px = 20, .channels = 3, .bytes = {}};
    p.bytes.assign(std::size_t(40 * 20 * 3), 200);
    const Picture small = image::resized(p, 10, 5);
    EXPECT_EQ(small.bytes.size(), std::size_t(10 * 5 * 3));
    for (const std::uint8_t b : small.bytes)
        EXPECT_NEAR(b, 200, 1);
    Picture sheet{.width_px = 20, .height_px = 20, .channels = 3, .bytes = {}};
    sheet.bytes.assign(std::size_t(20 * 20 * 3), 0);
    image::paste(sheet, small, 15, -2); // over two edges
    EXPECT_NEAR(sheet.bytes[std::size_t((0 * 20 + 16) * 3)], 200, 1);
    EXPECT_EQ(sheet.bytes[std::size_t((4 * 20 + 16) * 3)], 0);
    EXPECT_EQ(sheet.bytes[std::size_t((0 * 20 + 14) * 3)], 0);
}

// What the fuzzer found: 227 bytes that claim six gigabytes.
TEST(Compare, AnErrorMapShowsWhereAndHowMuch) {
    Image a{.width_px = 64, .height_px = 32, .radiance = {}, .distance_m = {}};
    a.radiance.assign(64 * 32, glm::vec3(1.0f));
    a.distance_m.assign(64 * 32, 1.0f);
    Image b = a;
    b.radiance[5] = glm::vec3(1.01f); // 1 %: half way
    b.radiance[6] = glm::vec3(3.0f);
    b.radiance[7] = glm::vec3(1.00001f);
    const Picture map = error_map(b, a);
    const auto at = [&](int i) {
        return std::array<int, 3>{map.bytes[std::size_t(3 * i)], map.bytes[std::size_t(3 * i + 1)],
                                  map.bytes[std::size_t(3 * i + 2)]};
    };
    EXPECT_EQ(at(0), (std::array<int, 3>{0, 0, 0}));
    EXPECT_EQ(at(7), (std::array<int, 3>{0, 0, 0}));
    EXPECT_EQ(at(6), (std::array<int, 3>{255, 255, 255}));
    EXPECT_NEAR(at(5)[1], 135, 2);
    EXPECT_GT(map.height_px, 32); // with a legend
    Image other = a;
    other.width_px = 32;
    other.height_px = 64;
    EXPECT_THROW(error_map(other, a), Error);
}

TEST(Files, PicturesWrittenByRowsAreTheWholeOnesOrNothing) {
    const TempFolder temp;
    Image image{.width_px = 37, .height_px = 29, .radiance = {}, .distance_m = {}};
    Picture picture{.width_px = 37, .height_px = 29, .channels = 3, .bytes = {}};
    for (int i = 0; i < 37 * 29; ++i) {
        image.radiance.emplace_back(0.1f * float(i), 1.0f / float(i + 1), -3.0f);
        image.distance_m.push_back(float(i * i));
        for (int k = 0; k < 3; ++k)
            picture.bytes.push_back(std::uint8_t(i * 7 + k * 31));
    }
    const auto part = [](const auto& values, int first, int last, int a_row) {
        return std::vector(values.begin() + first * a_row, values.begin() + last * a_row);
    };
    write_exr(temp / "whole.exr", image, {});
    write_png(temp / "whole.png", picture, {});
    for (const bool finish : {false, true}) {
        RowWriter exr = RowWriter::exr(temp / "rows.exr", 37, 29, {{"tarn:level_m", "7"}});
        RowWriter png = RowWriter::png(temp / "rows.png", 37, 29, 3, {});
        for (int first = 0; first < (finish ? 29 : 16); first += 8) {
            const int last = std::min(first + 8, 29);
            exr.add(Image{37, last - first, part(image.radiance, first, last, 37),
                          part(image.distance_m, first, last, 37)});
            png.add(Picture{37, last - first, 3, part(picture.bytes, first, last, 3 * 37)});
        }
        if (finish) {
            exr.finish();
            png.finish();
        } else {
            EXPECT_THROW(png.finish(), Error); // 13 rows are missing
        }
    }
    const Image read = read_exr(temp / "rows.exr"), whole = read_exr(temp / "whole.exr");
    EXPECT_EQ(read.radiance, whole.radiance);
    EXPECT_EQ(read.distance_m, whole.distance_m);
    EXPECT_EQ(read_metadata(temp / "rows.exr").at("tarn:level_m"), "7");
    EXPECT_EQ(read_rgba(temp / "rows.png").bytes, read_rgba(temp / "whole.png").bytes);
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(temp.path()))
        files += entry.is_regular_file();
    EXPECT_EQ(files, 4); // nothing of those that were not finished
    EXPECT_THROW(RowWriter::png(temp / "no/such/folder.png", 4, 4, 3, {}), Error);
}

TEST(Files, AHeaderThatLiesAboutItsSizeIsRefusedBeforeMemoryIsAskedFor) {
    const std::string path =
        std::string(TARN_SOURCE_DIR) + "/tests/fuzz/seeds/texture/lies_about_its_size.tif";
    for (const auto& read : {std::function<void()>([&] { read_codes(path); }),
                             std::function<void()>([&] { read_heights(path); }),
                             std::function<void()>([&] { read_rgba(path); })})
        try {
            read();
            FAIL() << "taken";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("says that it is"), std::string::npos)
                << error.what();
        }
}
