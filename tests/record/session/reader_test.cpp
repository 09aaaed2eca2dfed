// SPDX-License-Identifier: Apache-2.0
#include "handpiece/record/session/session_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "handpiece/base/core/error.h"
#include "handpiece/record/session/session_writer.h"
#include "record/session/made_up_hand.h"
#include "support/random.h"

namespace handpiece::reader_test {
namespace {

class Reader : public testing::Test {
  protected:
    Reader() {
        session::SessionWriter writer(path(), {100, "a", "1", "{}", std::vector<std::byte>(10)});
        test::MadeUpHand hand(1, 100);
        for (std::uint64_t i = 0; i < 500; ++i)
            writer.append(session::recordOf(hand.next()));
        writer.append(session::Event{4, "undo", "text"});
        writer.append(session::KeyFrame{4, std::vector<std::byte>(100, std::byte{1})});
    }
    std::filesystem::path path() const { return folder_.path() / "s.h5"; }
    std::string bytes() const {
        std::ifstream in(path(), std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    void write(const std::string& content) const { std::ofstream(path(), std::ios::binary) << content; }
    std::string refusal() const {
        try {
            const session::SessionReader reader(path());
            for (std::uint64_t i = 0; i < reader.size(); i += 100)
                (void)reader.records(i, 100);
            (void)reader.events();
            for (std::size_t i = 0; i < reader.keyFrameTicks().size(); ++i)
                (void)reader.keyFrame(i);
            return "";
        } catch (const core::Error& e) {
            return e.what();
        }
    }

  private:
    test::TemporaryFolder folder_;
};

TEST_F(Reader, SaysWhatIsWrong) {
    EXPECT_EQ(refusal(), "");
    const std::string whole = bytes();
    write(whole.substr(0, whole.size() / 2));
    EXPECT_NE(refusal().find("missing"), std::string::npos) << refusal();
    write("no HDF5 at all, but long enough to be looked at");
    EXPECT_NE(refusal().find("not an HDF5 file"), std::string::npos);
    write("");
    EXPECT_NE(refusal().find("not an HDF5 file"), std::string::npos);
    std::filesystem::remove(path());
    EXPECT_NE(refusal().find("no such file"), std::string::npos);
    std::filesystem::create_directory(path());
    EXPECT_NE(refusal().find("folder"), std::string::npos);
    std::filesystem::remove(path());
}

// A session that goes on while somebody reads it: its last chunk, begun before, is written anew far behind.
TEST_F(Reader, ReadsOnWhileTheFileGrows) {
    const std::filesystem::path growing = path().parent_path() / "growing.h5";
    test::MadeUpHand hand(1, 100);
    constexpr std::uint64_t kBefore = 5550, kAfter = 60000;
    {
        session::SessionWriter writer(growing, {100, "a", "1", "{}", std::vector<std::byte>(10)});
        for (std::uint64_t i = 0; i < kBefore; ++i)
            writer.append(session::recordOf(hand.next()));
    }
    const session::SessionReader reader(growing);
    ASSERT_EQ(reader.size(), kBefore);
    session::SessionWriter writer(growing);
    for (std::uint64_t i = 0; i < kAfter; ++i)
        writer.append(session::recordOf(hand.next()));
    EXPECT_EQ(reader.records(0, kBefore).size(), kBefore);
    EXPECT_EQ(reader.records(kBefore - 1, 1).size(), 1u);
}

// Metadata carries checksums, packed chunks mostly betray themselves, key frames have a hash: what is read and does not
// throw has the right shape.
TEST_F(Reader, BytesThatChangedAreToldOrHarmless) {
    const std::string whole = bytes();
    std::mt19937_64 generator(test::seed());
    int refused = 0;
    constexpr int kTries = 300;
    for (int i = 0; i < kTries; ++i) {
        std::string damaged = whole;
        const std::size_t at = generator() % damaged.size();
        for (std::size_t k = at; k < std::min(at + 40, damaged.size()); ++k)
            damaged[k] = static_cast<char>(generator());
        write(damaged);
        refused += refusal().empty() ? 0 : 1;
    }
    EXPECT_GT(refused, 5);
}

}  // namespace
}  // namespace handpiece::reader_test
