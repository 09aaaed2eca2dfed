// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/image.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <array>
#include <initializer_list>
#include <random>

#include "handpiece/base/core/file.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::view::image_test {
namespace {

Image noise(int width, int height, std::mt19937_64& generator) {
    Image image{width, height, {}};
    image.rgba.resize(4u * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (auto& byte : image.rgba)
        byte = static_cast<std::uint8_t>(generator());
    return image;
}

std::uint32_t bigEndian(const std::vector<std::byte>& bytes, std::size_t at) {
    std::uint32_t v = 0;
    for (std::size_t i = 0; i < 4; ++i)
        v = v << 8 | std::to_integer<std::uint32_t>(bytes[at + i]);
    return v;
}

TEST(Image, APngGivesEveryPixelBack) {
    std::mt19937_64 generator(test::seed());
    const test::TemporaryFolder folder;
    for (const auto& [width, height] : {std::pair{1, 1}, {7, 3}, {64, 200}, {321, 1}}) {
        const Image image = noise(width, height, generator);
        const auto path = folder.path() / "a.png";
        writePng(image, path);
        const Image back = readPng(path);
        EXPECT_EQ(back.width, width);
        EXPECT_EQ(back.height, height);
        EXPECT_EQ(back.rgba, image.rgba);
    }
}

TEST(Image, TheFileIsAPngByTheBookAndTheSameEachTime) {
    std::mt19937_64 generator(test::seed());
    const test::TemporaryFolder folder;
    const Image image = noise(31, 17, generator);
    writePng(image, folder.path() / "a.png");
    writePng(image, folder.path() / "b.png");
    const auto a = core::readFile(folder.path() / "a.png");
    EXPECT_EQ(a, core::readFile(folder.path() / "b.png"));
    const std::array<int, 8> signature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    for (std::size_t i = 0; i < 8; ++i)
        EXPECT_EQ(std::to_integer<int>(a[i]), signature[i]);
    EXPECT_EQ(bigEndian(a, 16), 31u);
    EXPECT_EQ(bigEndian(a, 20), 17u);
}

TEST(Image, DamagedFilesAreRefusedAndNothingElseHappens) {
    std::mt19937_64 generator(test::seed());
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "a.png";
    writePng(noise(23, 19, generator), path);
    const auto whole = core::readFile(path);
    int refused = 0;
    for (int i = 0; i < 600; ++i) {
        auto bytes = whole;
        if (i % 2 == 0) {
            bytes.resize(generator() % bytes.size());
        } else {
            for (std::uint64_t k = 0; k <= generator() % 4; ++k)
                bytes[generator() % bytes.size()] = static_cast<std::byte>(generator());
        }
        core::writeFile(path, bytes);
        try {
            const Image image = readPng(path);
            EXPECT_EQ(image.rgba.size(),
                      4u * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
        } catch (const core::Error& e) {
            EXPECT_FALSE(e.problem().empty());
            ++refused;
        }
    }
    EXPECT_GT(refused, 500) << "checksums find nearly every fault";
}

TEST(Image, WhatCannotBeReadIsSaid) {
    const test::TemporaryFolder folder;
    EXPECT_THROW((void)readPng(folder.path() / "none.png"), core::Error);
    EXPECT_THROW((void)readPng(folder.path()), core::Error);
    const auto text = folder.path() / "text.png";
    core::writeFile(text, std::string_view("this is not a picture"));
    EXPECT_NE(test::errorOf([&] { (void)readPng(text); }).find("text.png"), std::string::npos);
    core::writeFile(text, std::string_view());
    EXPECT_NE(test::errorOf([&] { (void)readPng(text); }).find("empty"), std::string::npos);
}

TEST(Image, APictureThatSaysItIsHugeIsRefusedBeforeMemoryIsTaken) {
    // A signature and an IHDR of 20000 x 20000 with a right checksum, then the end.
    const std::vector<int> bytes{0x89, 'P', 'N', 'G',  '\r', '\n', 0x1A, '\n', 0,    0, 0, 13, 'I', 'H', 'D',
                                 'R',  0,   0,   0x4E, 0x20, 0,    0,    0x4E, 0x20, 8, 6, 0,  0,   0};
    std::vector<std::byte> file;
    for (const int b : bytes)
        file.push_back(static_cast<std::byte>(b));
    std::uint32_t crc = 0xFFFFFFFFu;  // of PNG, bit by bit, over the chunk's name and data
    for (std::size_t i = 12; i < file.size(); ++i) {
        crc ^= std::to_integer<std::uint32_t>(file[i]);
        for (int k = 0; k < 8; ++k)
            crc = (crc & 1u) != 0 ? 0xEDB88320u ^ (crc >> 1) : crc >> 1;
    }
    for (int shift = 24; shift >= 0; shift -= 8)
        file.push_back(static_cast<std::byte>((~crc >> shift) & 0xFFu));
    for (const int b : std::initializer_list<int>{0, 0, 0, 0, 'I', 'D', 'A', 'T', 0x35, 0xAF, 0x06, 0x1E})
        file.push_back(static_cast<std::byte>(b));
    const test::TemporaryFolder folder;
    core::writeFile(folder.path() / "huge.png", file);
    const std::string error = test::errorOf([&] { (void)readPng(folder.path() / "huge.png"); });
    EXPECT_NE(error.find("20000 x 20000"), std::string::npos) << error;
}

TEST(Image, WhatIsNoPictureIsNotWritten) {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "a.png";
    EXPECT_THROW(writePng({}, path), core::Error);
    EXPECT_THROW(writePng({4, 4, std::vector<std::uint8_t>(63)}, path), core::Error);
    EXPECT_THROW(writePng({16385, 1, std::vector<std::uint8_t>(4 * 16385)}, path), core::Error);
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_THROW(writePng({1, 1, std::vector<std::uint8_t>(4)}, folder.path() / "no" / "folder" / "a.png"),
                 core::Error);
}

TEST(Image, DifferencesAreThoseOfTheBytes) {
    Image a{10, 10, std::vector<std::uint8_t>(400, 100)}, b = a;
    EXPECT_EQ(compareImages(a, b).rms, 0.0);
    b.rgba[4 * 37 + 1] = 120;
    b.rgba[4 * 38 + 2] = 95;
    const ImageDifference d = compareImages(a, b, 8);
    EXPECT_DOUBLE_EQ(d.largest, 20.0);
    EXPECT_DOUBLE_EQ(d.rms, std::sqrt((20.0 * 20.0 + 5.0 * 5.0) / 400.0));
    EXPECT_DOUBLE_EQ(d.differingShare, 0.01);
    EXPECT_DOUBLE_EQ(compareImages(a, b, 4).differingShare, 0.02);
    b.width = 20;
    b.height = 5;
    EXPECT_THROW((void)compareImages(a, b), core::Error);
}

TEST(Image, EnlargedItLiesBetweenItsPixels) {
    Image small{2, 2, {10, 0, 0, 255, 210, 0, 0, 255, 10, 100, 0, 255, 210, 100, 0, 255}};
    Image same;
    enlarge(small, {2, 2}, same);
    EXPECT_EQ(same.rgba, small.rgba);
    Image large;
    enlarge(small, {40, 20}, large);
    ASSERT_EQ(large.rgba.size(), 4u * 40u * 20u);
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 40; ++x) {
            const double across = std::clamp((x + 0.5) / 20.0 - 0.5, 0.0, 1.0);
            const double down = std::clamp((y + 0.5) / 10.0 - 0.5, 0.0, 1.0);
            EXPECT_NEAR(large.at(x, y)[0], 10.0 + 200.0 * across, 2.0);
            EXPECT_NEAR(large.at(x, y)[1], 100.0 * down, 2.0);
            EXPECT_GE(large.at(x, y)[3], 254);
        }
}

}  // namespace
}  // namespace handpiece::view::image_test
