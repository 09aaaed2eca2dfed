// SPDX-License-Identifier: Apache-2.0
// Between any two writes to the disk, and inside those that cross a page, the file can be opened as any file.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "handpiece/base/core/error.h"
#include "handpiece/record/session/layout.h"
#include "handpiece/record/session/session_reader.h"
#include "handpiece/record/session/session_writer.h"
#include "record/session/made_up_hand.h"
#include "support/random.h"

namespace handpiece::survival_test {
namespace {

struct Change {
    std::uint64_t address;
    std::vector<unsigned char> data;  // empty: the file's new length
};

class Copy {
  public:
    explicit Copy(std::filesystem::path path) : path_(std::move(path)) { std::ofstream(path_, std::ios::binary); }
    void put(std::uint64_t address, const unsigned char* data, std::size_t bytes) {
        std::fstream out(path_, std::ios::binary | std::ios::in | std::ios::out);
        out.seekp(static_cast<std::streamoff>(address));
        out.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(bytes));
    }
    void apply(const Change& change) {
        if (change.data.empty()) {
            std::filesystem::resize_file(path_, change.address);
        } else {
            put(change.address, change.data.data(), change.data.size());
        }
    }

  private:
    std::filesystem::path path_;
};

class Survival : public testing::TestWithParam<int> {};

TEST_P(Survival, EveryMomentOfTheFileIsReadable) {
    const int chunks = GetParam();
    const std::size_t stride = chunks < 50 ? 1 : 37;
    const test::TemporaryFolder folder;
    constexpr double kRateHz = 100;
    const std::size_t rows = session::chunkRows(kRateHz), count = rows * static_cast<std::size_t>(chunks) + rows / 2;
    test::MadeUpHand hand(test::seed(), kRateHz);
    std::vector<session::Record> all;
    for (std::size_t i = 0; i < count; ++i)
        all.push_back(session::recordOf(hand.next()));

    std::vector<Change> changes;
    const auto observe = [&](std::uint64_t address, std::span<const unsigned char> data) {
        changes.push_back({address, {data.begin(), data.end()}});
    };
    const auto write = [&](session::SessionWriter& writer, std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            writer.append(all[i]);
            if (i % 50 == 7) writer.append(session::Event{i, "stroke begin", std::string(i % 900, 'e')});
            if (i % 200 == 9) writer.append(session::KeyFrame{i, std::vector<std::byte>(3000 + 100 * i, std::byte{7})});
        }
        writer.close();
        EXPECT_EQ(writer.failure(), "");
    };
    std::size_t begun = 0;
    // Closed in the middle of a chunk, and gone on with.
    const std::size_t first = count / 2 + 3;
    {
        session::SessionWriter writer(folder.path() / "written.h5", {kRateHz, "a", "1", "{}", {}}, observe);
        begun = changes.size();
        write(writer, 0, first);
    }
    {
        session::SessionWriter writer(folder.path() / "written.h5", observe);
        EXPECT_EQ(writer.firstTick(), first);
        write(writer, first, count);
    }

    const std::filesystem::path path = folder.path() / "copy.h5";
    Copy copy(path);
    std::uint64_t least = 0;
    std::size_t leastEvents = 0, leastFrames = 0, torn = 0;
    const auto look = [&] {
        const session::SessionReader reader(path);
        ASSERT_GE(reader.size(), least);
        least = reader.size();
        const std::uint64_t from = chunks < 50 || least < 3 * rows ? 0 : least - 3 * rows;
        const auto read = reader.records(from, static_cast<std::size_t>(least - from));
        ASSERT_TRUE(std::equal(read.begin(), read.end(), all.begin() + static_cast<std::ptrdiff_t>(from)));
        const auto events = reader.events();
        ASSERT_GE(events.size(), leastEvents);
        leastEvents = events.size();
        ASSERT_GE(reader.keyFrameTicks().size(), leastFrames);
        leastFrames = reader.keyFrameTicks().size();
        if (leastFrames > 0) {
            ASSERT_EQ(reader.keyFrame(leastFrames - 1).state.back(), std::byte{7});
        }
    };
    std::string moment;
    const auto check = [&] {
        SCOPED_TRACE(moment);
        try {
            look();
        } catch (const core::Error& e) {
            FAIL() << e.what();
        }
    };
    for (std::size_t i = 0; i < changes.size(); ++i) {
        const Change& change = changes[i];
        const std::uint64_t end = change.address + change.data.size();
        const bool isLookedAt = i >= begun && (i % stride == 0 || i + 60 > changes.size());
        // A killed process may have written the pages before a boundary and none after it.
        if (isLookedAt && !change.data.empty() && change.address / 4096 != (end - 1) / 4096) {
            const std::uint64_t boundary = (change.address / 4096 + 1) * 4096;
            copy.put(change.address, change.data.data(), static_cast<std::size_t>(boundary - change.address));
            moment = "torn write " + std::to_string(i) + " at " + std::to_string(change.address);
            check();
            ++torn;
        }
        copy.apply(change);
        moment = "after write " + std::to_string(i) + " of " + std::to_string(changes.size());
        if (isLookedAt || i + 1 == begun) check();
        if (HasFatalFailure()) return;
    }
    EXPECT_EQ(least, count);
    EXPECT_GT(torn, 0u);
    EXPECT_TRUE(session::SessionReader(path).isComplete());
    RecordProperty("writes", static_cast<int>(changes.size()));
}

INSTANTIATE_TEST_SUITE_P(Chunks, Survival, testing::Values(6, 400));

}  // namespace
}  // namespace handpiece::survival_test
