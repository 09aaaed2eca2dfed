// SPDX-License-Identifier: Apache-2.0
// What came with the program is believed to the last byte or not at all.
#include "handpiece/base/prepared/prepared_files.h"

#include <gtest/gtest.h>

#include <random>

#include "handpiece/base/core/file.h"
#include "handpiece/base/prepared/packed_bytes.h"
#include "support/random.h"

namespace handpiece::prepared::prepared_files_test {
namespace {

std::vector<std::byte> bytesOf(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

class PreparedFiles : public testing::Test {
  protected:
    void SetUp() override {
        core::writeFile(folder_.path() / "good", std::string_view("a tooth"));
        core::writeFile(folder_.path() / "stranger", std::string_view("not in the list"));
        use(folder_.path(), believed_, [this](const std::string& problem) { told_.push_back(problem); });
    }
    void TearDown() override { use({}, {}, {}); }

    const test::TemporaryFolder folder_;
    const std::string good_ = sha256Of(bytesOf("a tooth")), gone_ = sha256Of(bytesOf("gone"));
    const std::vector<Believed> believed_{{"good", good_}, {"gone", gone_}};
    std::vector<std::string> told_;
};

TEST_F(PreparedFiles, ABelievedOneIsRead) {
    EXPECT_EQ(good_, "05c5f99655998237f43d37f0ed811ebadbaf9c4aafa68ee8c4ba6cb39e018127");
    EXPECT_EQ(read("good"), bytesOf("a tooth"));
    EXPECT_TRUE(isKnown("good"));
    EXPECT_TRUE(told_.empty());
}

TEST_F(PreparedFiles, AChangedByteIsRefusedAndToldOnce) {
    core::writeFile(folder_.path() / "good", std::string_view("a toath"));
    EXPECT_FALSE(read("good"));
    EXPECT_FALSE(read("good"));
    ASSERT_EQ(told_.size(), 1u);
    EXPECT_NE(told_[0].find((folder_.path() / "good").string()), std::string::npos) << told_[0];
    EXPECT_NE(told_[0].find("Install the package again"), std::string::npos) << told_[0];
}

TEST_F(PreparedFiles, AMissingOneIsToldAndAStrangerNeverLookedAt) {
    EXPECT_FALSE(read("stranger"));
    EXPECT_FALSE(isKnown("stranger"));
    EXPECT_FALSE(read("../good"));
    EXPECT_TRUE(told_.empty()) << told_[0];
    EXPECT_FALSE(read("gone"));
    EXPECT_EQ(told_.size(), 1u);
}

TEST_F(PreparedFiles, WithoutTheirFolderThereAreNone) {
    use({}, believed_, [this](const std::string& problem) { told_.push_back(problem); });
    EXPECT_FALSE(read("good"));
    EXPECT_EQ(told_.size(), 1u);
    // A program built without any says nothing.
    use({}, {}, [this](const std::string& problem) { told_.push_back(problem); });
    EXPECT_FALSE(read("good"));
    EXPECT_EQ(told_.size(), 1u);
}

TEST_F(PreparedFiles, TheListNamesAllOfThemAndIsTheSameEachTime) {
    const std::string list = listSource(folder_.path());
    EXPECT_NE(list.find("{\"good\",\n         \"" + good_ + "\"}"), std::string::npos) << list;
    EXPECT_LT(list.find("\"good\""), list.find("\"stranger\""));
    EXPECT_EQ(list, listSource(folder_.path()));
}

TEST(PackedBytes, ComeBackAndDamageIsSeen) {
    std::vector<std::byte> data(3'000'000);
    std::mt19937_64 dice(test::seed());
    for (std::byte& b : data)
        b = static_cast<std::byte>(dice() % 7);
    std::vector<std::byte> packed;
    pack(data, packed);
    pack({}, packed);
    EXPECT_LT(packed.size(), data.size() / 2);
    std::span<const std::byte> rest(packed);
    EXPECT_EQ(unpack(rest, data.size()), data);
    EXPECT_EQ(unpack(rest, data.size()), std::vector<std::byte>());
    EXPECT_TRUE(rest.empty());
    EXPECT_EQ(fromPlanes(inPlanes(data, 4), 4), data);

    rest = packed;
    EXPECT_FALSE(unpack(rest, data.size() - 1)) << "more than is wanted";
    for (const std::size_t at : {std::size_t{0}, std::size_t{7}, std::size_t{9}, packed.size() / 2}) {
        std::vector<std::byte> bad = packed;
        bad[at] ^= std::byte{0x40};
        rest = bad;
        EXPECT_FALSE(unpack(rest, data.size())) << at;
    }
    rest = std::span(packed).first(packed.size() / 2);
    EXPECT_FALSE(unpack(rest, data.size()));
}

}  // namespace
}  // namespace handpiece::prepared::prepared_files_test
