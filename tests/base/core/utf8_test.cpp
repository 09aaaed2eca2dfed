// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/utf8.h"
#include "handpiece/base/core/error.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <set>
#include <string>

namespace handpiece::core::utf8_test {
namespace {

/// As RFC 3629 writes a number.
std::string written(std::uint32_t c) {
    const auto byte = [](std::uint32_t bits) { return static_cast<char>(bits); };
    if (c < 0x80) return {byte(c)};
    if (c < 0x800) return {byte(0xc0 | c >> 6), byte(0x80 | (c & 0x3f))};
    if (c < 0x10000) return {byte(0xe0 | c >> 12), byte(0x80 | (c >> 6 & 0x3f)), byte(0x80 | (c & 0x3f))};
    return {byte(0xf0 | c >> 18), byte(0x80 | (c >> 12 & 0x3f)), byte(0x80 | (c >> 6 & 0x3f)), byte(0x80 | (c & 0x3f))};
}

TEST(Utf8, EveryCharacterAndNothingElse) {
    std::set<std::string> all;
    for (std::uint32_t c = 0; c < 0x110000; ++c) {
        const bool isHalfOfAPair = c >= 0xd800 && c < 0xe000;
        const std::string text = written(c);
        ASSERT_EQ(utf8Length(text), isHalfOfAPair ? 0u : text.size()) << c;
        ASSERT_EQ(utf8Length(text + "x"), isHalfOfAPair ? 0u : text.size()) << c;
        if (!isHalfOfAPair && text.size() <= 3) all.insert(text);
    }
    // All of up to three bytes: it is a character, or none.
    for (std::uint32_t bytes = 0; bytes < 1u << 24; ++bytes) {
        const std::array<char, 3> text{static_cast<char>(bytes), static_cast<char>(bytes >> 8),
                                       static_cast<char>(bytes >> 16)};
        const std::string_view view(text.data(), text.size());
        const std::size_t length = utf8Length(view);
        if (length == 3) {
            ASSERT_TRUE(all.contains(std::string(view))) << bytes;
        }
        ASSERT_LE(length, 3u) << bytes;
    }
    for (const char* none : {"", "\x80", "\xc0\xaf", "\xc1\xbf", "\xe0\x80\xaf", "\xed\xa0\x80", "\xf0\x80\x80\xaf",
                             "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xe2\x82", "\xff"})
        EXPECT_EQ(utf8Length(none), 0u) << none;
    EXPECT_EQ(utf8Prefix(""), 0u);
    EXPECT_EQ(utf8Prefix("a\u68ee\n"), 5u);
    EXPECT_EQ(utf8Prefix("a\u68ee\xff..."), 4u);
    EXPECT_EQ(utf8Prefix("a\xe6\xa3"), 1u);
    EXPECT_EQ(asUtf8(""), "");
    EXPECT_EQ(asUtf8("a\u68ee\n"), "a\u68ee\n");
    EXPECT_EQ(asUtf8("\xff"
                     "a\u68ee\xe6\xa3"),
              "\\xffa\u68ee\\xe6\\xa3");
    EXPECT_STREQ(Error("not there", "caf\xe9").what(), "caf\\xe9: not there");
}

TEST(Utf8, WhatIsPrintedHoldsNoControlCharacters) {
    EXPECT_EQ(printable("\x1b[31mred\a"), "?[31mred?");
    EXPECT_EQ(printable(std::string_view("o.stl\0x", 7)), "o.stl?x");
    EXPECT_EQ(printable("a\nb\tc\r"), "a b c ");
    EXPECT_EQ(printable("\x7f\xc2\x9b"
                        "31m"),
              "??31m");
    // Whatever else there is stays as it is.
    EXPECT_EQ(printable("46 \xc3\xa9 \xe6\xad\xaf \xc2\xb5m"), "46 \xc3\xa9 \xe6\xad\xaf \xc2\xb5m");
    const Error error(std::string("the name \"a\0b\x1b\"", 15), "c\nd", "e");
    EXPECT_STREQ(error.what(), "c d: the name \"a?b?\" (e)");
}

}  // namespace
}  // namespace handpiece::core::utf8_test
