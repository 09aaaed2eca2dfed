// SPDX-License-Identifier: Apache-2.0
// What somebody else made is opened as the very bytes that were read apart, or not at all; one's own as it lies.
#include "desktop/work/outside_files.h"

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/taken_from.h"
#include "handpiece/base/prepared/prepared_files.h"
#include "handpiece/record/session/session_reader.h"
#include "shell_support.h"

namespace handpiece::desktop::outside_files_test {
namespace {

namespace fs = std::filesystem;

class OutsideFilesTest : public ::testing::Test {
  protected:
    [[nodiscard]] fs::path at(const char* name) const { return toPath(own_.filePath(QLatin1String(name))); }
    void put(const fs::path& file, const std::string& text) {
        fs::create_directories(file.parent_path());
        core::writeFile(file, text);
    }
    [[nodiscard]] static std::string textOf(const fs::path& file) {
        const std::vector<std::byte> bytes = core::readFile(file);
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }
    [[nodiscard]] Folders folders() const { return {at("config/h.ini"), at("data/sessions"), at("cache/teeth")}; }
    void begin() {
        files_.reset();
        files_ = std::make_unique<OutsideFiles>(folders(), [this](const fs::path& copy, const core::Progress&) {
            ++asked_;
            if (reader_) reader_(copy);
            return within_;
        });
    }
    /// Of the error that reading it ends with; empty: it may be opened.
    [[nodiscard]] std::string idOf(const fs::path& file) {
        try {
            files_->read(file);
        } catch (const core::Error& e) {
            EXPECT_FALSE(e.problem().empty());
            EXPECT_NE(e.where().find(file.string()), std::string::npos) << e.where() << " is no place of a person's";
            return e.id();
        }
        return {};
    }

    QTemporaryDir own_;
    std::unique_ptr<OutsideFiles> files_;
    std::function<void(const fs::path& copy)> reader_;
    std::vector<std::string> within_;  ///< that the reader read besides
    int asked_ = 0;
};

TEST_F(OutsideFilesTest, WhatIsOpenedIsWhatWasRead) {
    const fs::path theirs = at("usb/theirs.h5");
    put(theirs, "as it was read");
    // It is another file as soon as its reader has it.
    reader_ = [&](const fs::path& copy) {
        EXPECT_EQ(textOf(copy), "as it was read");
        EXPECT_EQ(copy.filename(), theirs.filename());
        fs::remove(theirs);
        put(theirs, "swapped");
    };
    begin();
    EXPECT_FALSE(files_->isAtHand(theirs));
    const fs::path opened = core::takenFrom(theirs);
    EXPECT_NE(opened, theirs);
    EXPECT_EQ(textOf(opened), "as it was read");
    EXPECT_EQ(asked_, 1);
    EXPECT_FALSE(files_->isAtHand(theirs)) << "it has changed since";
    reader_ = {};
    EXPECT_EQ(textOf(core::takenFrom(theirs)), "swapped");
    EXPECT_EQ(asked_, 2);
    // Read once, it is opened as often as one likes; the same bytes elsewhere as well.
    EXPECT_TRUE(files_->isAtHand(theirs));
    EXPECT_EQ(textOf(core::takenFrom(theirs)), "swapped");
    put(at("usb/again.h5"), "swapped");
    EXPECT_EQ(textOf(core::takenFrom(at("usb/again.h5"))), "swapped");
    EXPECT_EQ(asked_, 2);
    // A link in the folder of recordings leads out of it.
    fs::create_directories(folders().sessions);
    put(at("usb/linked.h5"), "linked");
    fs::create_symlink(at("usb/linked.h5"), folders().sessions / "linked.h5");
    EXPECT_FALSE(files_->isAtHand(folders().sessions / "linked.h5"));
    EXPECT_NE(core::takenFrom(folders().sessions / "linked.h5"), folders().sessions / "linked.h5");
    EXPECT_EQ(asked_, 3);
    // With it goes the asking.
    files_.reset();
    EXPECT_EQ(core::takenFrom(theirs), theirs);
}

TEST_F(OutsideFilesTest, WhatEndedItsReaderIsNotTriedAgain) {
    const fs::path bad = at("usb/bad.h5"), copied = at("usb/copied.h5"), damaged = at("usb/damaged.h5");
    put(bad, "bad"), put(copied, "bad"), put(damaged, "damaged");
    reader_ = [](const fs::path&) { throw core::Error("it ended", "").as("sandbox-died", {"SIGSEGV"}); };
    begin();
    EXPECT_EQ(idOf(bad), "sandbox-died");
    EXPECT_EQ(asked_, 1);
    EXPECT_EQ(idOf(bad), "sandbox-died");
    EXPECT_THROW((void)core::takenFrom(bad), core::Error);
    EXPECT_THROW((void)session::SessionReader(bad), core::Error) << "nobody opens it past this";
    try {
        files_->read(copied);
        ADD_FAILURE() << "the same bytes elsewhere";
    } catch (const core::Error& e) {
        EXPECT_EQ(e.id(), "sandbox-died");
    }
    EXPECT_EQ(asked_, 1);
    // What reads it otherwise, likewise.
    int ran = 0;
    for (int i = 0; i < 2; ++i)
        EXPECT_THROW(files_->once("returned 1",
                                  [&] {
                                      ++ran;
                                      throw core::Error("too slow", "").as("sandbox-slow");
                                  }),
                     core::Error);
    EXPECT_EQ(ran, 1);
    files_->once("returned 2", [&] { ++ran; });
    EXPECT_EQ(ran, 2);
    // What is only damaged may be looked at again, and what nobody's fault was.
    reader_ = [](const fs::path& copy) {
        throw core::Error("cut short", copy.string(), "copy it").as("session-damaged", {copy.string()});
    };
    EXPECT_EQ(idOf(damaged), "session-damaged");
    reader_ = [](const fs::path&) { throw core::Error("ended", "").as("sandbox-killed"); };
    EXPECT_EQ(idOf(damaged), "sandbox-killed");
    reader_ = {};
    EXPECT_EQ(idOf(damaged), "");
    EXPECT_EQ(asked_, 4);
}

TEST_F(OutsideFilesTest, WithoutAReaderOnesOwnIsOpenedStill) {
    reader_ = [](const fs::path&) {
        throw core::Error("nothing from outside is read here", "handpiece-sandbox")
            .as("sandbox-start", {"no Landlock"});
    };
    begin();
    const fs::path theirs = at("usb/theirs.h5"), mine = at("desk/mine.h5"), packed = at("desk/packed.h5"),
                   recorded = folders().sessions / "20260101-000000-000-1.h5";
    put(theirs, "theirs"), put(mine, "mine"), put(packed, "packed"), put(recorded, "recorded");
    EXPECT_TRUE(files_->isAtHand(recorded));
    EXPECT_EQ(core::takenFrom(recorded), recorded);
    EXPECT_THROW(files_->read(theirs), core::Error);
    EXPECT_THROW(files_->read(mine), core::Error);
    files_->made(mine);
    files_->made(core::readFile(packed));
    EXPECT_EQ(textOf(core::takenFrom(mine)), "mine");
    EXPECT_EQ(textOf(core::takenFrom(packed)), "packed");
    // And at the next start.
    begin();
    EXPECT_EQ(textOf(core::takenFrom(mine)), "mine");
    EXPECT_EQ(idOf(packed), "");
    EXPECT_THROW(files_->read(theirs), core::Error);
    put(mine, "no longer mine");
    EXPECT_THROW(files_->read(mine), core::Error);
}

TEST_F(OutsideFilesTest, WhatIsInAPackageIsReadWithIt) {
    begin();
    const fs::path packed = at("usb/work.handpiece"), unpacked = at("tmp/its.h5");
    put(packed, "PK"), put(unpacked, "a session");
    within_ = {prepared::sha256Of(core::readFile(unpacked))};
    EXPECT_FALSE(files_->isAtHand(packed));
    EXPECT_EQ(idOf(packed), "");
    EXPECT_TRUE(files_->isAtHand(packed));
    EXPECT_EQ(textOf(core::takenFrom(unpacked)), "a session");
    EXPECT_EQ(asked_, 1);
    // What the program wrote is at hand at once, and opened as it was written.
    const fs::path mine = at("desk/mine.handpiece");
    put(mine, "PK mine");
    files_->made(mine);
    EXPECT_TRUE(files_->isAtHand(mine));
    EXPECT_NE(core::takenFrom(mine), mine);
    EXPECT_EQ(textOf(core::takenFrom(mine)), "PK mine");
    // An exam's exercise, which the school has signed.
    const fs::path exam = at("data/exam/sitting.handpiece");
    put(exam, "PK");
    EXPECT_EQ(core::takenFrom(exam), exam);
    EXPECT_EQ(asked_, 1);
}

TEST_F(OutsideFilesTest, OfOtherKindsNothingIsAsked) {
    begin();
    put(at("tooth.stl"), "solid"), put(at("case/case.toml"), "format = 1");
    for (const char* name : {"tooth.stl", "case", "missing.h5"}) {
        EXPECT_TRUE(files_->isAtHand(at(name))) << name;
        files_->read(at(name));
    }
    EXPECT_EQ(asked_, 0);
}

/// Through the program that is locked in.
TEST_F(ShellTest, ARecordingOfSomebodyElseIsReadApartAndShown) {
    startWithTooth();
    ASSERT_TRUE(waitFor([this] { return simulator().sample().tick > 300; }));
    const fs::path recording = simulator().recording();
    simulator().close();
    const fs::path theirs = at("theirs.h5"), cut = at("cut.h5");
    fs::copy_file(recording, theirs);
    const std::vector<std::byte> bytes = core::readFile(recording);
    core::writeFile(cut, std::span(bytes).first(2000));
    const OutsideFiles& outside = *simulator().outside();
    EXPECT_TRUE(outside.isAtHand(recording));
    EXPECT_FALSE(outside.isAtHand(theirs));
    drop(toQString(theirs));
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay; }));
    EXPECT_EQ(simulator().document().caseFile, theirs);
    EXPECT_EQ(simulator().document().name, "theirs.h5");
    EXPECT_TRUE(outside.isAtHand(theirs));
    // Its file may go: what is shown was read.
    fs::remove(theirs);
    simulator().seek(simulator().replay()->durationS());
    EXPECT_TRUE(waitFor([this] { return !simulator().replay()->now().seeking; }));
    EXPECT_FALSE(window().errorDialog());
    drop(toQString(cut));
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
    EXPECT_FALSE(window().errorDialog()->problem().id.startsWith("sandbox-"))
        << qPrintable(window().errorDialog()->text());
    EXPECT_TRUE(window().errorDialog()->text().contains(toQString(cut))) << qPrintable(window().errorDialog()->text());
    EXPECT_EQ(simulator().mode(), Simulator::Mode::replay) << "what was open stays";
}

TEST_F(ShellTest, AnExerciseOfSomebodyElseIsReadApartAndOpened) {
    tasks::Task task;
    task.id = "theirs";
    task.toothCase = eggTooth(46);
    task.toothCase.exercise.emplace();
    task.toothCase.exercise->title["en"] = "Theirs";
    task.voxelMm = 0.1;
    tasks::writeTask(task, at("theirs.handpiece"));
    cases::Case alone = eggTooth(46);
    alone.name = "alone";
    cases::writeCase(alone, at("alone.handpiece"));
    startWithTooth();
    const OutsideFiles& outside = *simulator().outside();
    EXPECT_FALSE(outside.isAtHand(at("theirs.handpiece")));
    drop(own_.filePath("theirs.handpiece"));
    EXPECT_TRUE(simulator().isBusy()) << "beside the window";
    ASSERT_TRUE(
        waitFor([this] { return simulator().task() && simulator().task()->id == "theirs" && !simulator().isBusy(); }));
    EXPECT_EQ(simulator().document().taskPath, at("theirs.handpiece"));
    EXPECT_TRUE(outside.isAtHand(at("theirs.handpiece")));
    drop(own_.filePath("alone.handpiece"));
    ASSERT_TRUE(waitFor([this] { return simulator().document().name == "alone" && !simulator().isBusy(); }));
    EXPECT_EQ(simulator().document().caseFile, at("alone.handpiece"));
    EXPECT_FALSE(window().errorDialog());
}

}  // namespace
}  // namespace handpiece::desktop::outside_files_test
