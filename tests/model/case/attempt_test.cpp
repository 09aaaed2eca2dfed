// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/case/package_type.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/package.h"
#include "support/random.h"

namespace handpiece::cases::attempt_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

template <class Work>
std::string errorOf(const Work& work) {
    try {
        work();
    } catch (const core::Error& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        return e.what();
    }
    return {};
}

class AttemptTest : public testing::Test {
  protected:
    void SetUp() override {
        Case c;
        c.name = "molar";
        // Thirds are rounded when they are written: the key must not mind.
        c.outer = test::boxMesh({-4, -4, -8}, {4, 4, 19.0 / 3.0});
        c.parts = {{"enamel", Tissue::enamel, 10, test::boxMesh({-4, -4, 2}, {4, 4, 19.0 / 3.0})}};
        writeCase(c, casePlace());
        tooth_ = c;
    }
    [[nodiscard]] fs::path folder() const { return temporary_.path(); }
    [[nodiscard]] fs::path casePlace() const { return folder() / "cases" / "molar"; }
    [[nodiscard]] Attempt sample() const {
        Attempt a;
        a.caseFile = casePlace();
        a.caseKey = contentKey(tooth_);
        a.caseName = "molar \"46\"";
        for (int i = 0; i < 5000; ++i)
            a.state.push_back(static_cast<std::byte>(i * i));
        a.voxelMm = 0.025;
        a.removedMm3[static_cast<std::size_t>(Tissue::enamel)] = 1.0 / 3.0;
        a.removedMm3[static_cast<std::size_t>(Tissue::caries)] = 2e-9;
        a.bur = "330";
        a.cuttingParameters = "carbide";
        a.drive = "turbine";
        a.elapsedS = 61.25;
        a.student = "S-07 \xc3\xa4\nsecond line";
        a.session = "session.h5";
        a.counters = {{"strokes", 17}, {"pulp exposures", -1}};
        a.undoDepth = 12;
        return a;
    }
    static void expectSame(const Attempt& a, const Attempt& b) {
        EXPECT_EQ(a.caseKey, b.caseKey);
        EXPECT_EQ(a.caseName, b.caseName);
        EXPECT_EQ(a.state, b.state);
        EXPECT_EQ(a.voxelMm, b.voxelMm);
        EXPECT_EQ(a.removedMm3, b.removedMm3);
        EXPECT_EQ(a.bur, b.bur);
        EXPECT_EQ(a.cuttingParameters, b.cuttingParameters);
        EXPECT_EQ(a.drive, b.drive);
        EXPECT_EQ(a.elapsedS, b.elapsedS);
        EXPECT_EQ(a.student, b.student);
        EXPECT_EQ(a.session, b.session);
        EXPECT_EQ(a.counters, b.counters);
        EXPECT_EQ(a.undoDepth, b.undoDepth);
    }
    Case tooth_;

  private:
    test::TemporaryFolder temporary_;
};

TEST_F(AttemptTest, ComesBackAsItWasSavedWithItsCase) {
    for (const fs::path& place : {folder() / "attempts" / "one", folder() / "one.handpiece"}) {
        fs::create_directories(place.parent_path());
        writeAttempt(sample(), place);
        EXPECT_TRUE(isAttempt(place));
        const OpenAttempt open = openAttempt(place);
        expectSame(open.attempt, sample());
        EXPECT_EQ(fs::weakly_canonical(open.attempt.caseFile), fs::weakly_canonical(casePlace()));
        EXPECT_EQ(open.toothCase.name, "molar");
        EXPECT_EQ(contentKey(open.toothCase), contentKey(tooth_));
    }
    EXPECT_FALSE(isAttempt(casePlace()));
    EXPECT_FALSE(isAttempt(folder() / "none.handpiece"));
    // Saved again, it replaces the old one.
    Attempt next = sample();
    next.undoDepth = 3;
    writeAttempt(next, folder() / "attempts" / "one");
    EXPECT_EQ(readAttempt(folder() / "attempts" / "one").undoDepth, 3);
}

TEST_F(AttemptTest, HandedInItBringsItsRecordingsAlong) {
    Attempt a = sample();
    a.handedIn = true;
    a.recordings = {{"monday.h5", true}, {"tuesday.h5", false}};
    const std::vector<std::byte> bytes(70000, std::byte{7});
    const fs::path place = folder() / "in.handpiece";
    writeAttempt(a, place, &tooth_, {{"monday.h5", bytes}});
    const OpenAttempt open = openAttempt(place);
    expectSame(open.attempt, a);
    EXPECT_TRUE(open.attempt.handedIn);
    EXPECT_EQ(open.attempt.recordings, a.recordings);
    EXPECT_EQ(readAttempt(place).recordings, a.recordings);
    EXPECT_EQ(readRecording(place, "monday.h5"), bytes);
    EXPECT_THAT(errorOf([&] { (void)readRecording(place, "tuesday.h5"); }), HasSubstr("no recording"));
    EXPECT_THAT(errorOf([&] { (void)readRecording(place, "../attempt.toml"); }), HasSubstr("is no recording"));
    // As a folder, too.
    writeAttempt(a, folder() / "in", nullptr, {{"monday.h5", bytes}});
    EXPECT_EQ(readAttempt(folder() / "in").recordings, a.recordings);
    EXPECT_EQ(readRecording(folder() / "in", "monday.h5"), bytes);
    // Saved and not handed in: what was recorded is named.
    a.handedIn = false;
    writeAttempt(a, place, &tooth_);
    EXPECT_FALSE(readAttempt(place).handedIn);
    EXPECT_EQ(readAttempt(place).recordings, (std::vector<Attempt::Recording>{{"monday.h5"}, {"tuesday.h5"}}));
    // Nothing to say: the files are those of before.
    writeAttempt(sample(), place, &tooth_);
    EXPECT_EQ(readPackage(place).count(kRecordingsFile), 0u);
}

TEST_F(AttemptTest, ARecordingThatIsNotItsOwnOrTooMuchIsRefused) {
    Attempt a = sample();
    const fs::path place = folder() / "in.handpiece";
    EXPECT_THAT(errorOf([&] { writeAttempt(a, place, &tooth_, {{"other.h5", {}}}); }), HasSubstr("no recording of"));
    a.recordings = {{"big.h5"}};
    EXPECT_THAT(errorOf([&] {
                    writeAttempt(a, place, &tooth_, {{"big.h5", std::vector<std::byte>(kMaxRecordingBytes + 1)}});
                }),
                HasSubstr("256 MB"));
    EXPECT_FALSE(fs::exists(place));
    writeAttempt(a, place, &tooth_);
    PackageFiles files = readPackage(place);
    const auto with = [&](const std::string& text) {
        files[kRecordingsFile].resize(text.size());
        std::transform(text.begin(), text.end(), files[kRecordingsFile].begin(),
                       [](char c) { return static_cast<std::byte>(c); });
        writePackage(place, files);
        return errorOf([&] { (void)readAttempt(place); });
    };
    EXPECT_THAT(with("format = 1\nrecordings = [\"../case.h5\"]"), HasSubstr("plain file name"));
    EXPECT_THAT(with("format = 1\nrecordings = [\"attempt.toml\"]"), HasSubstr("plain file name"));
    EXPECT_THAT(with("format = 2"), HasSubstr("newer Handpiece"));
    EXPECT_THAT(with("format = 1\nmarks = 3"), HasSubstr("marks"));
    EXPECT_THAT(with("format = 1\n#" + std::string(300 << 10, 'x')), HasSubstr("more than"));
}

TEST_F(AttemptTest, AFileSaysWhatItIsAndAHandInWhatItIsOf) {
    Attempt a = sample();
    a.handedIn = true;
    a.handIn = Attempt::HandIn{"46-class-i", 2, "c29df62bcbcde75d", "{\"score\": 81}", 70.5, "a \"little\" rough\n2"};
    const fs::path place = folder() / "in.handpiece";
    writeAttempt(a, place, &tooth_);
    EXPECT_EQ(readAttempt(place).handIn, a.handIn);
    EXPECT_EQ(packageType(place), PackageType::handIn);
    writeAttempt(a, folder() / "in", nullptr);
    EXPECT_EQ(readAttempt(folder() / "in").handIn, a.handIn) << "as a folder, too";
    writeAttempt(sample(), folder() / "saved.handpiece", &tooth_);
    EXPECT_EQ(packageType(folder() / "saved.handpiece"), PackageType::attempt);
    EXPECT_FALSE(readAttempt(folder() / "saved.handpiece").handIn);
    writeCase(tooth_, folder() / "case.handpiece");
    EXPECT_EQ(packageType(folder() / "case.handpiece"), PackageType::toothCase);
    EXPECT_FALSE(isAttempt(folder() / "case.handpiece"));

    PackageFiles files = readPackage(place);
    const auto put = [&](const char* name, const std::string& text) {
        files[name].resize(text.size());
        std::transform(text.begin(), text.end(), files[name].begin(), [](char c) { return static_cast<std::byte>(c); });
        writePackage(place, files);
    };
    const auto with = [&](const char* name, const std::string& text) {
        const std::vector<std::byte> before = files[name];
        put(name, text);
        const std::string why = errorOf([&] { (void)readAttempt(place); });
        EXPECT_EQ(why.find('\n'), std::string::npos) << why;
        files[name] = before;
        return why;
    };
    const std::string head = "format = 1\nexercise = \"x\"\nexercise_hash = \"c29df62bcbcde75d\"\n";
    EXPECT_EQ(with(kHandInFile, head), "");
    EXPECT_THAT(with(kHandInFile, head + "expected_percent = 101"), HasSubstr("0 to 100"));
    EXPECT_THAT(with(kHandInFile, head + "marks = 3"), HasSubstr("marks"));
    EXPECT_THAT(with(kHandInFile, "format = 1\nexercise_hash = \"x\""), HasSubstr("16 hexadecimal digits"));
    EXPECT_THAT(with(kHandInFile, "format = 2"), HasSubstr("newer Handpiece"));
    EXPECT_THAT(with(kHandInResultFile, std::string((4 << 20) + 1, '{')), HasSubstr("more than"));
    EXPECT_THAT(with(kPackageFile, "format = 1\ntype = \"virus\""), HasSubstr("no type \"virus\""));
    EXPECT_THAT(with(kPackageFile, "format = 2\ntype = \"attempt\""), HasSubstr("newer Handpiece"));
    EXPECT_THAT(with(kPackageFile, "format = 1\ntype = \"exercise\""), HasSubstr("has no exercise.toml"));
    EXPECT_THAT(with(kPackageFile, std::string(65 << 10, '#')), HasSubstr("more than"));
    // An exam is nobody's case, exercise or attempt here.
    put(kPackageFile, "format = 1\ntype = \"exam\"\n");
    EXPECT_THAT(errorOf([&] { (void)readAttempt(place); }), HasSubstr("exam"));
    EXPECT_THAT(errorOf([&] { (void)openAttempt(place); }), HasSubstr("exam"));
    EXPECT_THAT(errorOf([&] { (void)readCase(place); }), HasSubstr("exam"));
    EXPECT_FALSE(isAttempt(place));
    // Of before: nothing says it.
    files.erase(kPackageFile);
    writePackage(place, files);
    EXPECT_EQ(packageType(place), PackageType::attempt);
    EXPECT_TRUE(isAttempt(place));
}

TEST_F(AttemptTest, MovesTogetherWithItsCase) {
    writeAttempt(sample(), folder() / "attempts" / "one");
    EXPECT_EQ(errorOf([&] {
                  const auto text = core::readFile(folder() / "attempts" / "one" / "attempt.toml");
                  EXPECT_THAT(
                      std::string(reinterpret_cast<const char*>(text.data()), text.size()),
                      AllOf(HasSubstr("case = \"../../cases/molar\""), testing::Not(HasSubstr(folder().string()))));
              }),
              "");
    fs::create_directory(folder() / "stick");
    fs::rename(folder() / "cases", folder() / "stick" / "cases");
    fs::rename(folder() / "attempts", folder() / "stick" / "attempts");
    EXPECT_EQ(openAttempt(folder() / "stick" / "attempts" / "one").toothCase.name, "molar");
}

TEST_F(AttemptTest, PackedWithItsCaseItNeedsNothingElse) {
    const fs::path place = folder() / "whole.handpiece";
    writeAttempt(sample(), place, &tooth_);
    fs::remove_all(folder() / "cases");
    const OpenAttempt open = openAttempt(place);
    expectSame(open.attempt, sample());
    EXPECT_EQ(open.toothCase.parts.size(), 1u);
    EXPECT_EQ(readCase(place).name, "molar");
    Case other = tooth_;
    other.parts[0].priority = 11;
    EXPECT_THAT(errorOf([&] { writeAttempt(sample(), place, &other); }), HasSubstr("not the case"));
    EXPECT_THAT(errorOf([&] { writeAttempt(sample(), folder() / "f", &tooth_); }), HasSubstr("one file"));
}

TEST_F(AttemptTest, WhatIsPassedOnTellsNothingOfTheMachine) {
    const fs::path place = folder() / "sent" / "whole.handpiece";
    fs::create_directory(folder() / "sent");
    writeAttempt(sample(), place, &tooth_);
    const PackageFiles content = readPackage(place);
    const std::vector<std::byte>& bytes = content.at("attempt.toml");
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    EXPECT_THAT(text, AllOf(HasSubstr("case = \"whole.handpiece\""), testing::Not(HasSubstr("molar\"\ncase_key"))));
    EXPECT_THAT(text, testing::Not(HasSubstr("..")));
    const OpenAttempt open = openAttempt(place);
    EXPECT_EQ(open.attempt.caseFile, place) << "its case is in itself";
    // Taken out of its file, it still finds its case there.
    writeAttempt(open.attempt, folder() / "out");
    EXPECT_EQ(openAttempt(folder() / "out").toothCase.name, "molar");
}

TEST_F(AttemptTest, NamesItsCaseFromWhereItLies) {
    writeAttempt(sample(), folder() / "one");
    const fs::path file = folder() / "one" / "attempt.toml";
    const auto bytes = core::readFile(file);
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto opened = [&](const std::string& place) {
        std::string changed = text;
        const std::size_t at = changed.find("case = \"") + 8;
        changed.replace(at, changed.find('"', at) - at, place);
        core::writeFile(file, changed);
        return errorOf([&] { (void)openAttempt(folder() / "one"); });
    };
    EXPECT_EQ(opened("../cases/molar"), "");
    EXPECT_THAT(opened("/dev/zero"), HasSubstr("from where the attempt lies"));
    std::string up;
    for (int i = 0; i < 40; ++i)
        up += "../";
    EXPECT_THAT(opened(up + "dev/zero"), HasSubstr("not a plain file"));
    EXPECT_NE(opened(up + "etc/hostname"), "");
}

TEST_F(AttemptTest, SavedAgainItIsSharedAsBefore) {
    const fs::path one = folder() / "one";
    writeAttempt(sample(), one);
    fs::permissions(one, fs::perms::owner_all);
    fs::permissions(one / "tooth.state", fs::perms::owner_read | fs::perms::owner_write);
    writeAttempt(sample(), one);
    EXPECT_EQ(fs::status(one).permissions(), fs::perms::owner_all);
    EXPECT_EQ(fs::status(one / "tooth.state").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(AttemptTest, ACaseThatChangedOrVanishedIsTold) {
    writeAttempt(sample(), folder() / "one");
    Case changed = tooth_;
    changed.name = "renamed";
    writeCase(changed, casePlace());
    EXPECT_EQ(openAttempt(folder() / "one").toothCase.name, "renamed") << "a name is not the tooth";
    changed.parts[0].tissue = Tissue::dentine;
    writeCase(changed, casePlace());
    EXPECT_THAT(errorOf([&] { (void)openAttempt(folder() / "one"); }), AllOf(HasSubstr("changed"), HasSubstr("molar")));
    fs::remove_all(casePlace());
    EXPECT_THAT(errorOf([&] { (void)openAttempt(folder() / "one"); }),
                AllOf(HasSubstr("no longer"), HasSubstr("molar")));
    expectSame(readAttempt(folder() / "one"), sample());
}

TEST_F(AttemptTest, WhatIsDamagedIsTold) {
    const fs::path place = folder() / "one";
    writeAttempt(sample(), place);
    EXPECT_THAT(errorOf([&] { (void)readAttempt(casePlace()); }), HasSubstr("no attempt"));
    EXPECT_THAT(errorOf([&] { (void)readAttempt(folder() / "none"); }), HasSubstr("no attempt"));
    core::writeFile(place / "tooth.state", "other bytes");
    EXPECT_THAT(errorOf([&] { (void)readAttempt(place); }), AllOf(HasSubstr("tooth.state"), HasSubstr("damaged")));
    fs::remove(place / "tooth.state");
    EXPECT_THAT(errorOf([&] { (void)readAttempt(place); }), AllOf(HasSubstr("tooth.state"), HasSubstr("no such file")));
    const std::string good = attemptToml(sample());
    const auto with = [&good](const std::string& from, const std::string& to) {
        std::string text = good;
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        text.replace(at, from.size(), to);
        return errorOf([&] { (void)parseAttempt(text, "a.toml"); });
    };
    EXPECT_EQ(with("drive", "drive"), "");
    EXPECT_THAT(with("format = 1", "format = 2"), HasSubstr("newer Handpiece"));
    EXPECT_THAT(with("format = 1", "form = 1"), HasSubstr("format"));
    EXPECT_THAT(with("voxel_mm = 0.025", "voxel_mm = -0.025"), HasSubstr("-0.025"));
    EXPECT_THAT(with("voxel_mm = 0.025", "voxel_mm = 0"), HasSubstr("above zero"));
    EXPECT_THAT(with("voxel_mm = 0.025", "voxel_mm = 1e-9"), HasSubstr("0.005"));
    EXPECT_THAT(with("voxel_mm = 0.025", "voxel_mm = 1e9"), HasSubstr("0.005"));
    EXPECT_THAT(with("elapsed_s = 61.25", "elapsed_s = inf"), HasSubstr("inf"));
    EXPECT_THAT(with("undo_depth = 12", "undo_depth = -1"), HasSubstr("-1"));
    EXPECT_THAT(with("enamel = 0", "enamel = -0"), HasSubstr("below zero"));
    EXPECT_THAT(with("enamel = 0", "cheese = 0"), HasSubstr("cheese"));
    EXPECT_THAT(with("case_key = \"", "case_key = \"x"), HasSubstr("hexadecimal"));
    EXPECT_THAT(with("session.h5", "../session.h5"), HasSubstr("plain file name"));
    EXPECT_THAT(with("case = \"", "cases = \""), HasSubstr("\"cases\""));
    EXPECT_THAT(with("case = \"", "case = \"\"  # "), HasSubstr("names no case"));
}

TEST_F(AttemptTest, NothingSenselessIsSaved) {
    Attempt a = sample();
    a.elapsedS = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(errorOf([&] { writeAttempt(a, folder() / "bad"); }), "");
    a = sample();
    a.removedMm3[1] = -1.0;
    EXPECT_NE(errorOf([&] { writeAttempt(a, folder() / "bad"); }), "");
    a = sample();
    a.caseFile.clear();
    EXPECT_NE(errorOf([&] { writeAttempt(a, folder() / "bad"); }), "");
    EXPECT_FALSE(fs::exists(folder() / "bad"));
    fs::create_directory(folder() / "thesis");
    core::writeFile(folder() / "thesis" / "a.txt", "years");
    EXPECT_THAT(errorOf([&] { writeAttempt(sample(), folder() / "thesis"); }), HasSubstr("not replaced"));
    EXPECT_THAT(errorOf([&] { writeAttempt(sample(), casePlace()); }), HasSubstr("not replaced"))
        << "a case is never overwritten by an attempt";
}

}  // namespace
}  // namespace handpiece::cases::attempt_test
