// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/hash.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>

#include "handpiece/base/core/hash_text.h"
#include "support/random.h"

namespace handpiece::core::hash_test {
namespace {

std::uint64_t hashOf(std::string_view text) {
    Hasher h;
    h.add(text);
    return h.value();
}

TEST(Hash, differsForEveryOneBitChange) {
    std::mt19937_64 generator(test::seed());
    std::string text(37, '\0');
    for (char& c : text)
        c = static_cast<char>(generator());
    std::set<std::uint64_t> seen{hashOf(text)};
    for (std::size_t bit = 0; bit < 8 * text.size(); ++bit) {
        std::string changed = text;
        changed[bit / 8] = static_cast<char>(changed[bit / 8] ^ (1 << (bit % 8)));
        EXPECT_TRUE(seen.insert(hashOf(changed)).second) << "bit " << bit;
    }
}

TEST(Hash, isReadAsItIsWrittenAndNothingElseIs) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 1000; ++i) {
        const std::uint64_t hash = generator() >> (i % 64);
        EXPECT_EQ(readHash(fmt::format("{:016x}", hash)), hash);
        EXPECT_EQ(readHash(fmt::format("{:016X}", hash)), hash);
    }
    for (const char* text : {"", "0", "0123456789abcde", "0123456789abcdef0", "0x23456789abcdef", "-123456789abcdef",
                             "+123456789abcdef", " 123456789abcdef", "0123456789abcdeg", "0123456789abcde "})
        EXPECT_FALSE(readHash(text)) << text;
    EXPECT_FALSE(readHash(std::string_view("0123456789abcde\0", 16)));
}

TEST(Hash, tellsLengthAndOrderApart) {
    EXPECT_NE(hashOf(""), hashOf(std::string_view("\0", 1)));
    EXPECT_NE(hashOf(std::string_view("a\0", 2)), hashOf("a"));
    Hasher ab, ba;
    ab.add(1);
    ab.add(2);
    ba.add(2);
    ba.add(1);
    EXPECT_NE(ab.value(), ba.value());
}

TEST(Hash, spreadsItsBits) {
    // Counters are the worst input: every output bit must still be set about half the time.
    std::array<int, 64> ones{};
    for (int i = 0; i < 4096; ++i) {
        Hasher h;
        h.add(i);
        for (std::size_t b = 0; b < 64; ++b)
            ones[b] += static_cast<int>(h.value() >> b & 1);
    }
    for (std::size_t b = 0; b < 64; ++b)
        EXPECT_NEAR(ones[b], 2048, 5 * 32) << "bit " << b;  // five sigma
}

}  // namespace
}  // namespace handpiece::core::hash_test
