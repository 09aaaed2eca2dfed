// SPDX-License-Identifier: Apache-2.0
// A student's whole way by real clicks: choose, work, finish, judge oneself, see why, again, progress; and what befalls
// it.
#include <QComboBox>
#include <QFile>
#include <QLabel>
#include <QListWidget>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QRadioButton>
#include <QSpinBox>
#include <QTableWidget>

#include "desktop/features/exercise/exercises_dialog.h"
#include "desktop/features/exercise/practice_feature.h"
#include "desktop/features/exercise/progress_dialog.h"
#include "desktop/features/exercise/result_dialog.h"
#include "desktop/picture/solid_view.h"
#include "handpiece/app/course/shipped_exercises.h"
#include "handpiece/base/core/file.h"
#include "shell_support.h"

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;

class PracticeTest : public ShellTest {
  protected:
    /// A block in coarse voxels, so that a test need not wait, with what the program's own has.
    fs::path makeExercise(const char* id, bool asksFirst, std::vector<std::string> locked = {}) {
        tasks::Task task = course::blockTask("line", 1);
        task.id = id;
        task.voxelMm = 0.1;
        task.ownJudgement = asksFirst;
        task.rubric = rubric::shippedRubricText("dexterity-line");
        task.toothCase.exercise->title = {{"en", std::string("Line ") + id}, {"ja", "直線"}};
        task.toothCase.exercise->instructions = {{"en", "Cut the line."}};
        task.toothCase.exercise->lockedHelps = std::move(locked);
        task.toothCase.exercise->allowedBurs = {"330", "round-2"};
        const fs::path place = at("exercises") / id;
        fs::create_directories(place.parent_path());
        tasks::writeTask(task, place);
        return place;
    }
    template <class W>
    [[nodiscard]] W* part(const char* name) {
        return window().findChild<W*>(QLatin1String(name));
    }
    void click(const char* name) { QTest::mouseClick(part<QPushButton>(name), Qt::LeftButton); }
    [[nodiscard]] ExercisesDialog& exercises() { return *part<ExercisesDialog>("exercisesDialog"); }
    [[nodiscard]] ResultDialog& result() { return *part<ResultDialog>("resultDialog"); }
    [[nodiscard]] school::Store& store() { return *window().findChild<PracticeFeature*>()->store(); }
    /// In the list, by its title, with a click on its row.
    void chooseInList(const QString& title) {
        auto* list = part<QListWidget>("exercisesList");
        ASSERT_TRUE(waitFor([&] { return !list->findItems(title, Qt::MatchExactly).isEmpty(); }));
        QListWidgetItem* item = list->findItems(title, Qt::MatchExactly).front();
        list->scrollToItem(item);
        QTest::mouseClick(list->viewport(), Qt::LeftButton, Qt::NoModifier, list->visualItemRect(item).center());
        ASSERT_EQ(list->currentItem(), item);
        ASSERT_TRUE(waitFor([&] { return exercises().isReady(); }));
    }
    void openExercises() {
        exercises().setFolder(at("exercises"));
        ASSERT_TRUE(action("actionExercises")->isEnabled());
        action("actionExercises")->trigger();
        ASSERT_TRUE(exercises().isVisible());
    }
    void begin(const char* id) {
        chooseInList(QStringLiteral("Line ") + QLatin1String(id));
        click("exercisesBegin");
        ASSERT_TRUE(waitFor([&] {
            return simulator().task() && simulator().task()->id == id && simulator().isRecorded() &&
                   simulator().mode() == Simulator::Mode::liveSession && !simulator().isBusy();
        }));
        EXPECT_FALSE(exercises().isVisible());
        view()->showStandardView(view::StandardView::occlusal);
    }
    void finish() {
        ASSERT_TRUE(waitFor([this] { return action("actionFinish")->isEnabled(); }));
        ASSERT_TRUE(part<QPushButton>("exerciseFinish")->isVisible());
        click("exerciseFinish");
        ASSERT_TRUE(waitFor([this] { return result().isVisible(); })) << "no result";
        ASSERT_EQ(window().errorDialog(), nullptr);
        ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay && !simulator().isBusy(); }));
    }
};

TEST_F(PracticeTest, FromTheChoiceToTheResultAndAgain) {
    const fs::path place = makeExercise("one", true, {"undo", "depth"});
    makeExercise("two", false);
    startWithTooth();
    EXPECT_FALSE(action("actionFinish")->isEnabled()) << "a starter tooth is no exercise";
    EXPECT_FALSE(action("actionResult")->isEnabled());
    openExercises();
    chooseInList(QStringLiteral("Line one"));
    // What it asks, and the ideal to turn around.
    EXPECT_EQ(part<QLabel>("exercisesWords")->text(), "Cut the line.");
    EXPECT_TRUE(part<QLabel>("exercisesAbout")->text().contains("round-2"));
    EXPECT_TRUE(part<QLabel>("exercisesAbout")->text().contains("Undo"));
    EXPECT_TRUE(part<QLabel>("exercisesAsks")->text().contains("target removed"));
    EXPECT_EQ(part<QLabel>("exercisesBest")->text(), "Not tried yet.");
    ASSERT_NE(exercises().ideal(), nullptr);
    begin("one");
    // Its voxel, its burs and its locks hold; a setting of the student's own is refused, and told of.
    EXPECT_EQ(simulator().voxelUm(), 100);
    EXPECT_FALSE(action("actionUndo")->isEnabled());
    EXPECT_TRUE(simulator().permissions().allowsBur("330"));
    EXPECT_FALSE(simulator().permissions().allowsBur("round-8"));
    simulator().setVoxel(50);
    ASSERT_NE(window().errorDialog(), nullptr);
    window().errorDialog()->reject();
    EXPECT_EQ(simulator().voxelUm(), 100);
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() == nullptr; }));
    ASSERT_TRUE(cut());
    ASSERT_TRUE(simulator().isUnsaved());
    const double cutMm3 = removedMm3();
    finish();
    // One's own judgement first: nothing is seen, and all is kept already.
    EXPECT_TRUE(part<QSpinBox>("judgePercent")->isVisible());
    EXPECT_FALSE(part<QLabel>("resultScore")->isVisible());
    ASSERT_EQ(store().attempts().size(), 1u);
    EXPECT_FALSE(store().judgementOf(store().attempts().front().id));
    part<QSpinBox>("judgePercent")->setFocus();
    part<QSpinBox>("judgePercent")->selectAll();
    QTest::keyClicks(part<QSpinBox>("judgePercent"), "65");
    QTest::keyClicks(part<QPlainTextEdit>("judgeWords"), "too short");
    click("judgeShow");
    ASSERT_TRUE(part<QLabel>("resultScore")->isVisible());
    EXPECT_TRUE(part<QLabel>("resultOwnJudgement")->text().contains("65"));
    EXPECT_TRUE(part<QLabel>("resultProof")->text().startsWith("Proven"));
    // What is stored is what the library says of the recording.
    ASSERT_EQ(store().attempts().size(), 1u);
    const school::Attempt kept = store().attempts().front();
    const tasks::Task task = tasks::readTask(place);
    const auto again = std::make_shared<const tasks::Task>(task);
    const course::FinishedWork truth = course::finish(result().shown()->work.session, again);
    EXPECT_EQ(kept.score, truth.result.assessment.score);
    EXPECT_EQ(kept.maxScore, truth.result.assessment.maxScore);
    EXPECT_EQ(kept.exerciseHash, rubric::hashText(tasks::contentHash(task)));
    EXPECT_EQ(kept.sessionHashes, truth.result.identity.sessionHashes);
    EXPECT_TRUE(kept.proven);
    EXPECT_EQ(kept.device, "pointer");
    EXPECT_FALSE(kept.recordings.empty());
    EXPECT_EQ(store().judgementOf(kept.id)->percent, 65.0);
    EXPECT_EQ(store().judgementOf(kept.id)->words, "too short");
    ASSERT_EQ(store().exercises().size(), 1u);
    EXPECT_TRUE(simulator().crashed().empty()) << "what is kept is no crash";
    EXPECT_FALSE(simulator().isUnsaved());
    // The tooth lies open as it was left, and a row of the table for each criterion.
    EXPECT_TRUE(waitFor([&] { return std::abs(removedMm3() - cutMm3) < 1e-3; })) << removedMm3();
    auto* table = part<QTableWidget>("resultTable");
    EXPECT_EQ(table->rowCount(), static_cast<int>(truth.rubric.criteria.size()));
    // Own and ideal, by a click each.
    ASSERT_TRUE(waitFor([this] { return part<QRadioButton>("resultIdeal")->isEnabled(); }));
    auto* tooth = part<SolidView>("resultTooth");
    ASSERT_TRUE(waitFor([&] { return tooth->isDrawn(); }));
    const QImage own = tooth->picture();
    QTest::mouseClick(part<QRadioButton>("resultIdeal"), Qt::LeftButton);
    ASSERT_TRUE(waitFor([&] { return tooth->isDrawn() && tooth->picture() != own; }));
    // Again: whole, with the best so far.
    click("resultAgain");
    ASSERT_TRUE(waitFor([this] {
        return simulator().mode() == Simulator::Mode::liveSession && simulator().task() && removedMm3() == 0.0 &&
               simulator().isRecorded();
    }));
    EXPECT_FALSE(result().isVisible());
    action("actionResult")->trigger();
    EXPECT_TRUE(result().isVisible());
    click("resultNext");
    ASSERT_TRUE(exercises().isVisible());
    EXPECT_EQ(part<QListWidget>("exercisesList")->currentItem()->text(), "Line two");
    chooseInList(QStringLiteral("Line one"));
    EXPECT_TRUE(part<QLabel>("exercisesBest")->text().contains("1")) << "best so far";
}

TEST_F(PracticeTest, AClickOnEvidenceTurnsTheEyeAndPlaysTheSeconds) {
    makeExercise("one", false);
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    ASSERT_TRUE(cut());
    finish();
    ASSERT_EQ(store().attempts().size(), 1u) << "kept without being asked";
    const double endS = simulator().replay()->durationS();
    measures::Evidence there;
    there.placeMm = core::Vec3(1.0, 0.5, -0.5);
    emit result().evidenceChosen(there);
    EXPECT_EQ(view()->camera().targetMm, *there.placeMm);
    EXPECT_GT(view()->camera().eyeMm.z(), 10.0) << "from where one sees into a block";
    ASSERT_TRUE(waitFor([&] { return simulator().sample().tick + 5 >= static_cast<std::uint64_t>(1e3 * endS); }));
    there.timeS = 0.5 * endS;
    emit result().evidenceChosen(there);
    bool wasPlaying = false;
    ASSERT_TRUE(waitFor([&] {
        const ReplayNow now = simulator().replay()->now();
        wasPlaying |= now.playing;
        return wasPlaying && !now.playing && !now.seeking;
    }));
    EXPECT_NEAR(simulator().replay()->now().timeS, std::min(endS, 0.5 * endS + 1.5), 0.3);
    // Also when something else was opened meanwhile.
    openTooth(11);
    ASSERT_TRUE(
        waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession && !simulator().isBusy(); }));
    emit result().evidenceChosen(there);
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay && !simulator().isBusy(); }));
    EXPECT_EQ(simulator().document().caseFile, result().shown()->work.session);
}

TEST_F(PracticeTest, CancelledAndRefusedFinishingBringsTheToothBack) {
    makeExercise("one", false);
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    const double cutMm3 = removedMm3();
    action("actionFinish")->trigger();
    ASSERT_TRUE(simulator().isBusy());
    simulator().cancelJob();
    ASSERT_TRUE(waitFor([this] {
        return simulator().mode() == Simulator::Mode::liveSession && !simulator().isBusy() &&
               simulator().sample().tick > 10;
    }));
    EXPECT_NEAR(removedMm3(), cutMm3, 1e-9);
    EXPECT_TRUE(simulator().isUnsaved());
    EXPECT_TRUE(simulator().task()) << "still that exercise";
    EXPECT_FALSE(result().isVisible());
    EXPECT_TRUE(store().attempts().empty());
    // And finished after all.
    finish();
    EXPECT_EQ(store().attempts().size(), 1u);
}

TEST_F(PracticeTest, ProgressIsACurveOverTheAttempts) {
    startWithTooth();
    store().see({"one", 1, "aa", "Line one", 1, 1});
    for (int i = 0; i < 4; ++i) {
        school::Attempt a;
        a.id = school::newId();
        a.exercise = "one";
        a.exerciseHash = "aa";
        a.rubricHash = "bb";
        a.began = a.finished = 1'700'000'000'000 + i;
        a.device = i == 3 ? "other-arm" : "pointer";
        a.score = 20.0 + 20.0 * i;
        a.maxScore = 100.0;
        a.wholeScore = i == 1 ? 120.0 : 100.0;
        a.passed = i < 2 ? "no" : "yes";
        store().add(a);
    }
    action("actionProgress")->trigger();
    auto* curve = part<ProgressCurve>("progressCurve");
    ASSERT_TRUE(curve->isVisible());
    ASSERT_EQ(curve->lines().size(), 2u) << "devices are never pooled";
    EXPECT_EQ(curve->lines()[0].points, (std::vector<std::pair<int, double>>{{1, 20.0}, {2, 40.0}, {3, 60.0}}));
    EXPECT_EQ(curve->lines()[0].isWhole, (std::vector<bool>{true, false, true}));
    EXPECT_EQ(curve->lines()[1].points, (std::vector<std::pair<int, double>>{{4, 80.0}}));
    EXPECT_EQ(part<QComboBox>("progressExercise")->currentText(), "Line one");
    EXPECT_EQ(part<QTableWidget>("progressTable")->rowCount(), 4);
    EXPECT_TRUE(part<QTableWidget>("progressTable")->item(0, 1)->text().contains("80"));
    EXPECT_TRUE(part<QLabel>("progressNote")->isVisible());
}

TEST_F(PracticeTest, AStoreThatCannotBeReadIsToldAndTheWorkGoesOn) {
    fs::create_directories(at("data"));
    core::writeFile(at("data") / "results.db", std::string(4096, 'x'));
    makeExercise("one", false);
    startWithTooth();
    window().openFile(toQString(at("exercises") / "one"));
    ASSERT_TRUE(waitFor([this] { return simulator().task() && simulator().isRecorded(); }));
    ASSERT_NE(window().errorDialog(), nullptr);
    window().errorDialog()->reject();
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() == nullptr; }));
    view()->showStandardView(view::StandardView::occlusal);
    ASSERT_TRUE(cut());
    ASSERT_TRUE(waitFor([this] { return action("actionFinish")->isEnabled(); }));
    action("actionFinish")->trigger();
    ASSERT_TRUE(waitFor([this] { return result().isVisible(); }));
    // Not kept: told, and the next start offers the work. What lay there is not touched.
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
    EXPECT_EQ(simulator().crashed().size(), 1u);
    EXPECT_EQ(core::readFile(at("data") / "results.db").size(), 4096u);
}

TEST_F(PracticeTest, AnExerciseThatACrashInterruptedIsStillOne) {
    makeExercise("one", false);
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    ASSERT_TRUE(waitFor([this] { return simulator().isUnsaved(); }));
    const std::uint64_t written = simulator().status().recording.writtenRecords;
    ASSERT_TRUE(waitFor([&] { return simulator().status().recording.writtenRecords > written + 100; }));
    const double cutMm3 = removedMm3();
    // What lies there in this moment is what a crash would leave.
    const fs::path recording = simulator().recording();
    const fs::path marker = fs::path(recording).replace_extension(".json");
    const auto record = core::readFile(recording), mark = core::readFile(marker);
    host_.reset();
    core::writeFile(recording, record);
    core::writeFile(marker, mark);
    startWithTooth();
    ASSERT_EQ(simulator().crashed().size(), 1u);
    simulator().recover(simulator().crashed().front());
    ASSERT_TRUE(waitFor([this] { return simulator().task() && simulator().isRecorded() && !simulator().isBusy(); }));
    EXPECT_EQ(simulator().task()->id, "one");
    EXPECT_NEAR(removedMm3(), cutMm3, 0.01);
    finish();
    ASSERT_EQ(store().attempts().size(), 1u);
    EXPECT_GT(store().attempts().front().finished, store().attempts().front().began);
    EXPECT_TRUE(simulator().crashed().empty());
}

TEST_F(PracticeTest, ThePageIsWrittenWithPictures) {
    makeExercise("one", false);
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    finish();
    file_ = own_.filePath("result.html");
    click("resultPage");
    ASSERT_TRUE(waitFor([this] { return QFile::exists(file_); }));
    const auto bytes = core::readFile(toPath(file_));
    const std::string page(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    EXPECT_NE(page.find("Line one"), std::string::npos);
    EXPECT_NE(page.find("data:image/png"), std::string::npos);
}

}  // namespace
}  // namespace handpiece::desktop
