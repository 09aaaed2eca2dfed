// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "handpiece/record/session/layout.h"
#include "handpiece/record/session/recorder.h"
#include "handpiece/record/session/session_reader.h"
#include "handpiece/record/session/session_writer.h"
#include "record/session/made_up_hand.h"
#include "support/random.h"

namespace handpiece::session_test {
namespace {

using session::EventName;

session::SessionInfo info(double rateHz = 1000) {
    return {rateHz, "desk-7", "0.2.0", R"({"case": "molar", "bur": "round-4"})",
            std::vector<std::byte>(70000, std::byte{5})};
}

std::vector<std::byte> someBytes(std::size_t count, std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    std::vector<std::byte> bytes(count);
    for (std::byte& b : bytes)
        b = static_cast<std::byte>(generator());
    return bytes;
}

std::vector<session::Record> records(std::size_t count, double rateHz = 1000) {
    test::MadeUpHand hand(test::seed(), rateHz);
    std::vector<session::Record> all;
    for (std::size_t i = 0; i < count; ++i)
        all.push_back(session::recordOf(hand.next()));
    return all;
}

class Session : public testing::Test {
  protected:
    std::filesystem::path file(const char* name = "session.h5") const { return folder_.path() / name; }

  private:
    test::TemporaryFolder folder_;
};

TEST_F(Session, WhatIsRecordedIsRead) {
    for (const double rateHz : {1000.0, 2000.0, 4000.0, 8000.0, 100.0}) {
        const auto all = records(static_cast<std::size_t>(2.3 * rateHz) + 1, rateHz);
        const std::string longText(5000, 'x');
        const auto frame = someBytes(200001, 5);
        {
            session::Recorder recorder(file(), info(rateHz));
            for (std::size_t i = 0; i < all.size(); ++i) {
                recorder.pushWaiting(all[i]);
                if (i == 3) recorder.event(3, EventName::strokeBegin);
                if (i == 60) recorder.event(60, EventName::parameterChange, longText + "\xC3\xA4");
                if (i == 70) recorder.keyFrame(70, frame);
                if (i == 90) recorder.keyFrame(90, {});
            }
            const session::RecorderStatus status = recorder.close();
            EXPECT_EQ(status.message, "");
            EXPECT_EQ(status.writtenRecords, all.size());
            EXPECT_EQ(status.lostRecords + status.lostItems, 0u);
            EXPECT_FALSE(status.recording);
        }
        const session::SessionReader reader(file());
        EXPECT_TRUE(reader.isComplete());
        EXPECT_EQ(reader.info().rateHz, rateHz);
        EXPECT_EQ(reader.info().code, "desk-7");
        EXPECT_EQ(reader.info().version, "0.2.0");
        EXPECT_EQ(reader.info().engineRevision, core::kEngineRevision);
        EXPECT_EQ(reader.info().settings, info().settings);
        EXPECT_EQ(reader.info().tooth, info().tooth);
        ASSERT_EQ(reader.size(), all.size());
        EXPECT_EQ(reader.records(0, all.size() + 5), all);
        EXPECT_EQ(reader.records(101, 7), std::vector(all.begin() + 101, all.begin() + 108));
        EXPECT_TRUE(reader.records(all.size(), 1).empty());
        EXPECT_EQ(reader.indexOfTick(77), 77u);
        EXPECT_EQ(reader.indexOfTick(1u << 30), all.size());
        const std::vector<session::Event> events{{3, "stroke begin", ""},
                                                 {60, "parameter change", longText + "\xC3\xA4"}};
        EXPECT_EQ(reader.events(), events);
        ASSERT_EQ(reader.keyFrameTicks(), (std::vector<std::uint64_t>{70, 90}));
        EXPECT_EQ(reader.keyFrame(0), (session::KeyFrame{70, frame}));
        EXPECT_EQ(reader.keyFrameBefore(89)->state, frame);
        EXPECT_EQ(reader.keyFrameBefore(1000)->tick, 90u);
        EXPECT_FALSE(reader.keyFrameBefore(69));
    }
}

TEST_F(Session, OneWithoutAnEngineRevisionIsOfTheFirst) {
    EXPECT_EQ(session::SessionReader(HANDPIECE_SOURCE_DIR "/tests/fuzz/corpus/session/whole.h5").info().engineRevision,
              1);
}

TEST_F(Session, OneFromBeforeTheLayersOfCariesIsRead) {
    // Of format 1: ten tissues a row.
    const session::SessionReader reader(HANDPIECE_SOURCE_DIR "/tests/fuzz/corpus/session/whole.h5");
    const std::vector<session::Record> all = reader.records(0, reader.size());
    ASSERT_GT(all.size(), 10u);
    double known = 0.0;
    for (const session::Record& r : all)
        for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
            if (t < cases::kFirstTissueCount)
                known = std::max(known, r.removedMm3[t]);
            else
                ASSERT_EQ(r.removedMm3[t], 0.0);
        }
    EXPECT_GT(known, 0.0);
    EXPECT_LT(known, 100.0);
}

/// Records i .. i + count, with a key frame and an event, numbered from 0 on.
void recordPart(session::Recorder& recorder, const std::vector<session::Record>& all, std::size_t from,
                std::size_t count, std::byte mark) {
    recorder.event(0, EventName::resume, "on");
    recorder.keyFrame(0, std::vector<std::byte>(5000, mark));
    for (std::size_t i = 0; i < count; ++i) {
        session::Record r = all[from + i];
        r.tick = i;
        recorder.pushWaiting(r);
    }
}

TEST_F(Session, GoesOnWhereItWasClosed) {
    // A first part that fills its chunks, and ones that leave the last in pieces.
    for (const std::size_t parts : {std::size_t{1400}, std::size_t{1001}, std::size_t{1}}) {
        const auto all = records(9000);
        {
            session::Recorder recorder(file(), info());
            for (std::size_t i = 0; i < parts; ++i)
                recorder.pushWaiting(all[i]);
            recorder.event(parts - 1, EventName::end, "{}");
            recorder.keyFrame(parts - 1, someBytes(70000, 3));
        }
        std::uint64_t at = parts;
        for (const std::size_t more : {std::size_t{2500}, std::size_t{3}, std::size_t{800}}) {
            session::Recorder recorder(file());
            EXPECT_EQ(recorder.firstTick(), at);
            recordPart(recorder, all, at, more, std::byte{9});
            const session::RecorderStatus status = recorder.close();
            EXPECT_EQ(status.message, "");
            EXPECT_EQ(status.lostItems, 0u);
            at += more;
        }
        const session::SessionReader reader(file());
        EXPECT_TRUE(reader.isComplete());
        EXPECT_EQ(reader.info().tooth, info().tooth);
        ASSERT_EQ(reader.size(), at);
        EXPECT_EQ(reader.records(0, at), std::vector(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(at)));
        ASSERT_EQ(reader.events().size(), 4u);
        EXPECT_EQ(reader.events()[1], (session::Event{parts, "resume", "on"}));
        EXPECT_EQ(reader.keyFrameTicks(), (std::vector<std::uint64_t>{parts - 1, parts, parts + 2500, parts + 2503}));
        EXPECT_EQ(reader.keyFrame(0).state, someBytes(70000, 3));
        EXPECT_EQ(reader.keyFrame(3).state, std::vector<std::byte>(5000, std::byte{9}));
    }
}

TEST_F(Session, GoesOnWhereItWasCutOffWithoutWhatWasNotDone) {
    const auto all = records(4000);
    {
        session::Recorder recorder(file("whole.h5"), info());
        for (std::size_t i = 0; i < 1750; ++i)
            recorder.pushWaiting(all[i]);
        recorder.event(1300, EventName::strokeBegin);
        recorder.event(1600, EventName::strokeEnd);
        recorder.keyFrame(1600, someBytes(900, 3));
        while (recorder.status().writtenRecords < 1400)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        // As a killed program leaves it: samples up to tick 1399, the rest is told and lost.
        std::filesystem::copy_file(file("whole.h5"), file());
    }
    {
        const session::SessionReader cut(file());
        ASSERT_EQ(cut.size(), 1400u);
        EXPECT_EQ(cut.events().size(), 2u);
        EXPECT_EQ(cut.endTick(), 1601u);
    }
    {
        session::Recorder recorder(file());
        EXPECT_EQ(recorder.firstTick(), 1601u);
        recordPart(recorder, all, 1601, 2000, std::byte{7});
    }
    const session::SessionReader reader(file());
    ASSERT_EQ(reader.size(), 3400u);
    EXPECT_EQ(reader.records(1399, 2)[0], all[1399]);
    EXPECT_EQ(reader.records(1399, 2)[1], all[1601]);
    EXPECT_EQ(reader.records(3399, 1)[0], all[3600]);
    const std::vector<session::Event> events{{1300, "stroke begin", ""}, {1601, "resume", "on"}};
    EXPECT_EQ(reader.events(), events);
    EXPECT_EQ(reader.keyFrameTicks(), std::vector<std::uint64_t>{1601});
    EXPECT_EQ(reader.keyFrame(0).state.back(), std::byte{7});
    EXPECT_THROW(session::Recorder(file("none.h5")), core::Error);
}

TEST_F(Session, TheSameInputGivesTheSameContent) {
    const auto all = records(3000);
    std::vector<session::Record> read[2];
    std::uintmax_t sizes[2];
    for (int i = 0; i < 2; ++i) {
        {
            session::Recorder recorder(file(), info());
            for (const session::Record& r : all)
                recorder.pushWaiting(r);
        }
        read[i] = session::SessionReader(file()).records(0, all.size());
        sizes[i] = std::filesystem::file_size(file());
    }
    EXPECT_EQ(read[0], read[1]);
    EXPECT_EQ(sizes[0], sizes[1]);
}

TEST_F(Session, AnHourTakesLessThanAHundredMegabytes) {
    constexpr std::size_t kSeconds = 120;
    const auto all = records(kSeconds * 1000);
    {
        session::SessionWriter writer(file(), info());
        for (const session::Record& r : all) {
            writer.append(r);
            if (r.tick % 6000 == 0) writer.append(session::Event{r.tick, "stroke begin", ""});
        }
    }
    const double megabytesAnHour = static_cast<double>(std::filesystem::file_size(file())) * 3600 / kSeconds / 1e6;
    RecordProperty("megabytesAnHour", std::to_string(megabytesAnHour));
    EXPECT_LT(megabytesAnHour, 97.0);  // the rest is for key frames
    EXPECT_GT(megabytesAnHour, 10.0);
}

TEST_F(Session, AFullDiskStopsTheRecordingAndKeepsWhatWasWritten) {
    const auto all = records(200000);
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    for (const rlim_t limit : {rlim_t{600000}, rlim_t{1u << 20}, rlim_t{1500001}}) {
        std::string message;
        std::uint64_t written = 0;
        {
            session::Recorder recorder(file(), info());
            const rlimit small{limit, before.rlim_max};
            setrlimit(RLIMIT_FSIZE, &small);
            for (const session::Record& r : all)
                recorder.pushWaiting(r);
            recorder.event(5, EventName::strokeEnd);
            recorder.keyFrame(5, someBytes(100000, 1));
            const session::RecorderStatus status = recorder.close();
            setrlimit(RLIMIT_FSIZE, &before);
            EXPECT_FALSE(status.recording);
            message = status.message;
            written = status.writtenRecords;
        }
        EXPECT_NE(message.find("no longer recorded"), std::string::npos);
        EXPECT_NE(message.find("File too large"), std::string::npos) << message;
        const session::SessionReader reader(file());
        EXPECT_FALSE(reader.isComplete());
        EXPECT_GE(reader.size(), written);
        EXPECT_GT(reader.size(), 5000u);
        EXPECT_LE(std::filesystem::file_size(file()), limit);
        const auto read = reader.records(0, static_cast<std::size_t>(reader.size()));
        EXPECT_TRUE(std::equal(read.begin(), read.end(), all.begin()));
    }
}

TEST_F(Session, ASlowReaderOfTheQueueIsCountedNotWaitedFor) {
    const auto all = records(40000, 100);
    session::Recorder recorder(file(), info(100));
    std::uint64_t refused = 0;
    for (const session::Record& r : all)
        refused += recorder.push(r) ? 0 : 1;  // 400 s of ticks at once
    const session::RecorderStatus status = recorder.close();
    EXPECT_GT(refused, 0u);
    EXPECT_EQ(status.lostRecords, refused);
    EXPECT_EQ(session::SessionReader(file()).size(), all.size() - refused);
}

TEST_F(Session, WhatCannotBeWrittenIsToldOnceAndHoldsNobodyUp) {
    const auto all = records(9000);
    session::Recorder recorder(file(), info());
    for (const session::Record& r : all)
        recorder.pushWaiting(r);
    for (const session::Record& r : all)
        recorder.pushWaiting(r);  // ticks that do not rise
    const session::RecorderStatus status = recorder.close();
    EXPECT_FALSE(status.recording);
    EXPECT_NE(status.message.find("tick 0 comes after tick 8999"), std::string::npos) << status.message;
    const session::SessionReader reader(file());
    EXPECT_GE(reader.size(), 8400u);  // whole chunks at the least
}

TEST_F(Session, BadPlacesAndCodesAreRefused) {
    EXPECT_THROW(session::Recorder(file("no/such/folder/x.h5"), info()), core::Error);
    for (const char* code : {"Anna Schmidt", "a/b", "user@host", "123456789012345678901234567890123"}) {
        session::SessionInfo bad = info();
        bad.code = code;
        EXPECT_THROW(session::Recorder(file("bad.h5"), bad), core::Error) << code;
    }
    EXPECT_THROW(session::Recorder(file("bad.h5"), info(0)), core::Error);
    EXPECT_FALSE(std::filesystem::exists(file("bad.h5")));
}

TEST_F(Session, NobodyElseMayLookIntoIt) {
    namespace fs = std::filesystem;
    constexpr fs::perms kOwn = fs::perms::owner_read | fs::perms::owner_write;
    const auto record = [&] {
        session::Recorder recorder(file(), info());
        EXPECT_EQ(fs::status(file()).permissions(), kOwn) << "while it grows";
        for (const session::Record& r : records(100))
            recorder.pushWaiting(r);
    };
    record();
    EXPECT_EQ(fs::status(file()).permissions(), kOwn);
    // What one shares on purpose stays shared.
    fs::permissions(file(), fs::perms(0640));
    { session::Recorder recorder(file(), info()); }
    EXPECT_EQ(fs::status(file()).permissions(), fs::perms(0640));
    // A link that lies where the file begins leads nowhere.
    fs::remove(file());
    const fs::path other = file().parent_path() / "other", begun = fs::path(file()) += ".begun";
    std::ofstream(other) << "stays";
    fs::create_symlink(other, begun);
    record();
    EXPECT_EQ(fs::file_size(other), 5u);
    EXPECT_FALSE(fs::is_symlink(fs::symlink_status(file())));
}

TEST_F(Session, NothingInTheFileNamesPersonMachineOrPlace) {
    {
        session::Recorder recorder(file(), info());
        for (const session::Record& r : records(2000))
            recorder.pushWaiting(r);
    }
    std::ifstream in(file(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    EXPECT_EQ(bytes.find(file().parent_path().filename().string()), std::string::npos);
    EXPECT_EQ(bytes.find("session.h5"), bytes.find("session.h5', 'r'"));  // in the README alone
}

}  // namespace
}  // namespace handpiece::session_test
