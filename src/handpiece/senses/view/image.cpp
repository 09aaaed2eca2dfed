// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/image.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::view {

namespace {

constexpr std::uint32_t kLargestSide = 16384;
constexpr std::uint64_t kLargestFile = 2ull << 30;

/// libpng's simplified interface: no long jumps, its state is given back at the end.
struct PngImage {
    png_image image{};
    PngImage() { image.version = PNG_IMAGE_VERSION; }
    ~PngImage() { png_image_free(&image); }
    PngImage(const PngImage&) = delete;
    PngImage& operator=(const PngImage&) = delete;
};

[[noreturn]] void refuse(const PngImage& png, const std::filesystem::path& path) {
    throw core::Error(fmt::format("this is no picture that can be read: {}", png.image.message), path.string(),
                      "give a whole PNG file");
}

void requireWhole(const Image& image, const std::string& where) {
    const auto side = [](int n) { return n >= 1 && n <= static_cast<int>(kLargestSide); };
    if (!side(image.width) || !side(image.height))
        throw core::Error(fmt::format("a picture of {} x {} pixels cannot be written", image.width, image.height),
                          where, fmt::format("1 to {} a side", kLargestSide));
    if (image.rgba.size() != 4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
        throw core::Error(
            fmt::format("{} bytes do not make {} x {} pixels", image.rgba.size(), image.width, image.height), where);
}

}  // namespace

std::vector<std::byte> pngOf(const Image& image) {
    requireWhole(image, "the picture");
    PngImage png;
    png.image.width = static_cast<png_uint_32>(image.width);
    png.image.height = static_cast<png_uint_32>(image.height);
    png.image.format = PNG_FORMAT_RGBA;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png.image);
    std::vector<std::byte> bytes(size);
    if (png_image_write_to_memory(&png.image, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr) == 0)
        throw core::Error(fmt::format("the picture cannot be packed: {}", png.image.message));
    bytes.resize(size);
    return bytes;
}

void writePng(const Image& image, const std::filesystem::path& path) {
    core::writeFile(path, pngOf(image));
}

Image readPng(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = core::readFile(path, kLargestFile);
    PngImage png;
    if (bytes.empty()) throw core::Error("the file is empty", path.string(), "give a whole PNG file");
    if (png_image_begin_read_from_memory(&png.image, bytes.data(), bytes.size()) == 0) refuse(png, path);
    if (png.image.width > kLargestSide || png.image.height > kLargestSide)
        throw core::Error(fmt::format("a picture of {} x {} pixels is too large", png.image.width, png.image.height),
                          path.string(), fmt::format("at most {} a side", kLargestSide));
    png.image.format = PNG_FORMAT_RGBA;
    Image out;
    out.width = static_cast<int>(png.image.width);
    out.height = static_cast<int>(png.image.height);
    out.rgba.resize(4 * static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
    if (png_image_finish_read(&png.image, nullptr, out.rgba.data(), 0, nullptr) == 0) refuse(png, path);
    return out;
}

ImageDifference compareImages(const Image& a, const Image& b, int tolerance) {
    if (a.width != b.width || a.height != b.height)
        throw core::Error(fmt::format("pictures of {} x {} and {} x {} pixels cannot be compared", a.width, a.height,
                                      b.width, b.height));
    requireWhole(a, "the first picture");
    requireWhole(b, "the second picture");
    ImageDifference out;
    double sum = 0.0;
    std::size_t differing = 0;
    int largest = 0;
    for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
        int most = 0;
        for (std::size_t c = i; c < i + 4; ++c) {
            const int d = std::abs(static_cast<int>(a.rgba[c]) - static_cast<int>(b.rgba[c]));
            sum += d * d;
            most = std::max(most, d);
        }
        differing += most > tolerance ? 1 : 0;
        largest = std::max(largest, most);
    }
    out.rms = std::sqrt(sum / static_cast<double>(a.rgba.size()));
    out.largest = largest;
    out.differingShare = 4.0 * static_cast<double>(differing) / static_cast<double>(a.rgba.size());
    return out;
}

namespace {
/// Where a larger picture's pixel lies between two of a smaller one's: the first, and the second's share in 256ths.
struct Between {
    int first, second, share;
};
std::vector<Between> betweens(int from, int to) {
    std::vector<Between> all;
    for (int i = 0; i < to; ++i) {
        const double at = std::clamp((i + 0.5) * from / to - 0.5, 0.0, from - 1.0);
        const int first = static_cast<int>(at);
        all.push_back({first, std::min(first + 1, from - 1), static_cast<int>(256.0 * (at - first))});
    }
    return all;
}
}  // namespace

void enlarge(const Image& image, const Viewport& size, Image& out) {
    const auto columns = betweens(image.width, size.width), rows = betweens(image.height, size.height);
    const std::size_t row = 4 * static_cast<std::size_t>(size.width);
    out.width = size.width;
    out.height = size.height;
    out.rgba.resize(row * static_cast<std::size_t>(size.height));
    // Two rows made wide at a time; each is used by one or more of the new ones.
    std::array<std::vector<std::uint8_t>, 2> wide{std::vector<std::uint8_t>(row), std::vector<std::uint8_t>(row)};
    std::array<int, 2> holds{-1, -1};
    const auto widened = [&](int y) -> const std::uint8_t* {
        const auto slot = static_cast<std::size_t>(y & 1);
        if (holds[slot] == y) return wide[slot].data();
        const std::uint8_t* from = image.at(0, y);
        std::uint8_t* to = wide[slot].data();
        for (const Between& b : columns) {
            const std::uint8_t *l = from + 4 * b.first, *r = from + 4 * b.second;
            for (int c = 0; c < 4; ++c)
                *to++ = static_cast<std::uint8_t>((l[c] * (256 - b.share) + r[c] * b.share) >> 8);
        }
        holds[slot] = y;
        return wide[slot].data();
    };
    for (std::size_t y = 0; y < rows.size(); ++y) {
        const std::uint8_t *upper = widened(rows[y].first), *lower = widened(rows[y].second);
        const auto low = static_cast<std::uint16_t>(rows[y].share), high = static_cast<std::uint16_t>(256 - low);
        std::uint8_t* to = out.rgba.data() + row * y;
        for (std::size_t i = 0; i < row; ++i)
            to[i] = static_cast<std::uint8_t>(static_cast<std::uint16_t>(upper[i] * high + lower[i] * low) >> 8);
    }
}

}  // namespace handpiece::view
