// SPDX-License-Identifier: Apache-2.0
// A student's whole way by real clicks: choose, work, finish, judge oneself, see why, again, progress; and what befalls
// it.
#include "practice_support.h"

namespace handpiece::desktop::practice_window_test {
namespace {

namespace fs = std::filesystem;

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
    EXPECT_EQ(simulator().voxelUm(), kVoxelUm);
    EXPECT_FALSE(action("actionUndo")->isEnabled());
    EXPECT_TRUE(simulator().permissions().allowsBur("330"));
    EXPECT_FALSE(simulator().permissions().allowsBur("round-8"));
    simulator().setVoxel(50);
    ASSERT_NE(window().errorDialog(), nullptr);
    window().errorDialog()->reject();
    EXPECT_EQ(simulator().voxelUm(), kVoxelUm);
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
    // Own and ideal, by a click each. While it is not there the window says why.
    auto* tooth = part<SolidView>("resultTooth");
    if (auto* ideal = part<QRadioButton>("resultIdeal"); !ideal->isEnabled()) {
        EXPECT_TRUE(ideal->toolTip().contains("being cut")) << ideal->toolTip().toStdString();
        EXPECT_TRUE(tooth->caption().contains("being cut")) << tooth->caption().toStdString();
    }
    ASSERT_TRUE(waitFor([this] { return part<QRadioButton>("resultIdeal")->isEnabled(); }));
    EXPECT_FALSE(tooth->caption().contains("being cut")) << tooth->caption().toStdString();
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

TEST_F(PracticeTest, TheDriveOfAnExerciseHoldsForItAlone) {
    makeExercise("slow", false, {}, [](tasks::Task& task) {
        task.drive = "low-speed";
        task.speedRpm = 20000.0;
    });
    makeExercise("free", false, {}, [](tasks::Task& task) { task.drive.clear(); });
    startWithTooth();
    simulator().setDrive(QStringLiteral("weak-turbine"));
    const double own = instrument::driveByName("weak-turbine").freeSpeedRpm;
    simulator().setSpeed(0.5 * own);
    openExercises();
    begin("slow");
    EXPECT_EQ(simulator().driveName(), "low-speed");
    EXPECT_EQ(simulator().setSpeedRpm(), 20000.0);
    simulator().setSpeed(10000.0);  // within it: for this work
    const auto kept = [this](const char* key) { return host_->settings().value(QLatin1String(key)).toString(); };
    EXPECT_EQ(kept("work/drive"), "weak-turbine");
    EXPECT_DOUBLE_EQ(kept("work/speedRpm").toDouble(), 0.5 * own);
    openExercises();
    begin("free");
    EXPECT_EQ(simulator().driveName(), "weak-turbine");
    EXPECT_DOUBLE_EQ(simulator().setSpeedRpm(), 0.5 * own);
    // What is chosen where nothing is named is a choice.
    simulator().setDrive(QStringLiteral("turbine"));
    openExercises();
    begin("slow");
    EXPECT_EQ(simulator().driveName(), "low-speed");
    openTooth(11);
    ASSERT_TRUE(waitFor([&] { return simulator().toothCase()->kind == "upper-central-incisor"; }));
    EXPECT_EQ(simulator().driveName(), "turbine");
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
    // A section beside it, of a place on the tooth: its figures, and no second time for one inside it.
    auto* section = window().findChild<QWidget*>(QStringLiteral("sectionCard"));
    EXPECT_TRUE(section->isHidden()) << "the place lies in the block";
    measures::Evidence onTop;
    const core::Box box = simulator().tooth()->model().outer.bounds();
    onTop.placeMm = core::Vec3(box.centre().x() + 5.0, box.centre().y() + 4.0, box.max.z());
    emit result().evidenceChosen(onTop);
    ASSERT_TRUE(waitFor([&] { return section->isVisible(); }));
    EXPECT_TRUE(section->accessibleDescription().isEmpty()) << "nothing was to be cut there, and nothing was";
    report::PlaceSection figures;
    figures.ownDeepMm = 0.94;
    EXPECT_EQ(SectionCard::figuresOf(figures).replace(QChar(0xa0), QLatin1Char(' ')), "Depth: 0.9 mm.");
    figures.idealDeepMm = 1.0;
    EXPECT_EQ(SectionCard::figuresOf(figures).replace(QChar(0xa0), QLatin1Char(' ')), "Depth: 0.9 mm, ideal: 1.0 mm.");
    figures.idealDeepMm = 0.0;
    EXPECT_EQ(SectionCard::figuresOf(figures).replace(QChar(0xa0), QLatin1Char(' ')),
              "Nothing was to be cut here: 0.9 mm deep.");
    EXPECT_LE(section->geometry().right(), view()->width());
    there.timeS = 0.5 * endS;
    emit result().evidenceChosen(there);
    EXPECT_TRUE(section->isHidden()) << "of another place";
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

TEST_F(PracticeTest, AnAttemptResumedThreeTimesIsOneProvenChain) {
    makeExercise("one", false, {"cross-section"});
    startWithTooth();
    openExercises();
    begin("one");
    const std::int64_t began = simulator().document().began;
    EXPECT_GT(began, 0);
    ASSERT_TRUE(cut());
    save("work.handpiece");
    for (int sitting = 0; sitting < 3; ++sitting) {
        if (sitting == 1) {  // also over a restart of the program
            host_.reset();
            startWithTooth();
        }
        const double before = cases::readAttempt(toPath(file_)).elapsedS;
        EXPECT_GT(before, 0.0);
        resume("work.handpiece");
        ASSERT_TRUE(simulator().task()) << "it is still that exercise";
        EXPECT_EQ(simulator().task()->id, "one");
        EXPECT_TRUE(simulator().permissions().locks(exercise::Operation::section));
        EXPECT_GE(simulator().workedS(), before) << "the clock goes on";
        EXPECT_EQ(simulator().document().recordings.size(), static_cast<std::size_t>(sitting) + 1);
        ASSERT_TRUE(cut());
        save("work.handpiece");
    }
    const double cutMm3 = removedMm3();
    finish();
    ASSERT_EQ(store().attempts().size(), 1u);
    const school::Attempt kept = store().attempts().front();
    EXPECT_TRUE(kept.proven) << result().shown()->work.result.proof;
    EXPECT_EQ(kept.sessionHashes.size(), 4u);
    EXPECT_EQ(kept.recordings.size(), 4u);
    EXPECT_GT(kept.workedS, 1.0);
    EXPECT_TRUE(part<QLabel>("resultProof")->text().startsWith("Proven"));
    EXPECT_TRUE(waitFor([&] { return std::abs(removedMm3() - cutMm3) < 1e-3; }));
    // The hand's time is that of all four.
    const auto& all = result().shown()->work.work.recordings;
    ASSERT_EQ(all.size(), 4u);
    std::vector<measures::Measured> time =
        assessment::readRecord(all, {}, 0.1, std::vector<measures::Request>{{"time"}}, {});
    // A recording goes on after its attempt was saved; the attempt's clock is that of what was saved.
    EXPECT_GE(*time.front().value, kept.workedS - 0.5);
    // What happened in the first is played out of the first.
    measures::Evidence there;
    there.timeS = 0.2;
    there.session = 0;
    emit result().evidenceChosen(there);
    ASSERT_TRUE(waitFor([&] {
        return simulator().mode() == Simulator::Mode::replay && simulator().document().caseFile == all[0].path &&
               !simulator().isBusy();
    }));
}

TEST_F(PracticeTest, WhatWasCutAfterSavingAndGivenUpBreaksNoChain) {
    makeExercise("one", false);
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    save("work.handpiece");
    const double savedMm3 = removedMm3();
    ASSERT_TRUE(cut());
    ASSERT_GT(removedMm3(), savedMm3);
    answer_ = Questions::Unsaved::discard;
    const int asked = asked_;
    resume("work.handpiece");
    EXPECT_EQ(asked_, asked + 1);
    EXPECT_NEAR(removedMm3(), savedMm3, 1e-9);
    ASSERT_TRUE(cut());
    finish();
    ASSERT_EQ(store().attempts().size(), 1u);
    EXPECT_TRUE(store().attempts().front().proven) << result().shown()->work.result.proof;
    EXPECT_NE(result().shown()->work.result.proof.find("given up"), std::string::npos);
    const auto& all = result().shown()->work.work.recordings;
    ASSERT_EQ(all.size(), 2u);
    const std::vector<measures::Measured> strokes =
        assessment::readRecord(all, {}, 0.1, std::vector<measures::Request>{{"strokes"}}, {});
    EXPECT_EQ(*strokes.front().value, 2.0) << "the one that was given up is none";
}

TEST_F(PracticeTest, AnAttemptWithASittingMissingIsScoredAndToldToBeUnproven) {
    makeExercise("one", false);
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    save("work.handpiece");
    resume("work.handpiece");
    ASSERT_TRUE(cut());
    const fs::path second = simulator().recording();
    save("work.handpiece");
    resume("work.handpiece");
    ASSERT_TRUE(fs::remove(second));
    ASSERT_TRUE(cut());
    finish();
    ASSERT_EQ(store().attempts().size(), 1u);
    EXPECT_FALSE(store().attempts().front().proven);
    EXPECT_TRUE(part<QLabel>("resultProof")->text().contains("no longer there"));
    EXPECT_EQ(store().attempts().front().sessionHashes.size(), 2u);
}

TEST_F(PracticeTest, TheClockRunsAndAHardLimitEndsTheWork) {
    makeExercise("soft", false, {}, [](tasks::Task& task) { task.minutes = 0.02; });
    makeExercise("hard", false, {}, [](tasks::Task& task) {
        task.minutes = 0.25;
        task.isTimeHard = true;
    });
    startWithTooth();
    EXPECT_TRUE(part<QLabel>("exerciseClock")->isHidden());
    openExercises();
    begin("soft");
    ASSERT_TRUE(waitFor([this] { return isTold("time-up"); }));
    EXPECT_FALSE(simulator().isTimeOver());
    EXPECT_TRUE(part<QLabel>("exerciseClock")->text().contains("0:01"));
    ASSERT_TRUE(cut()) << "one can go on";
    finish();
    EXPECT_GT(store().attempts().front().lateS(), 0.0);
    EXPECT_TRUE(part<QLabel>("resultTime")->text().contains("over by"));
    openExercises();
    begin("hard");
    EXPECT_FALSE(simulator().isTimeOver());
    ASSERT_TRUE(cut());
    ASSERT_TRUE(waitFor([this] { return simulator().isTimeOver() && isTold("time-over"); }));
    const double cutMm3 = removedMm3();
    press(1500);
    EXPECT_EQ(removedMm3(), cutMm3) << "the pedal is dead";
    EXPECT_EQ(simulator().sample().pedal, 0.0);
    action("actionUndo")->trigger();
    press(300);
    EXPECT_EQ(removedMm3(), cutMm3) << "nor is anything taken back";
    // Saved and resumed, it is still over.
    save("late.handpiece");
    resume("late.handpiece");
    ASSERT_TRUE(waitFor([this] { return simulator().isTimeOver(); }));
    press(1000);
    EXPECT_EQ(removedMm3(), cutMm3);
    finish();
    EXPECT_EQ(store().attempts().size(), 2u);
    EXPECT_TRUE(store().attempts().back().proven) << "what the dead pedal did is replayed as it was";
}

TEST_F(PracticeTest, ResultsOfBeforeAreOpenedWithWhatIsLeftOfThem) {
    const fs::path place = makeExercise("one", true);
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    finish();
    part<QSpinBox>("judgePercent")->setValue(40);
    click("judgeShow");
    const school::Attempt kept = store().attempts().front();
    store().add(school::Comment{school::newId(), kept.id, "Sato", "look here", core::Vec3(0, 0, -0.5), 0.3, 5});
    host_.reset();
    startWithTooth();
    const auto openFirst = [this] {
        action("actionProgress")->trigger();
        auto* table = part<QTableWidget>("progressTable");
        EXPECT_FALSE(part<QPushButton>("progressOpen")->isEnabled());
        QTest::mouseClick(table->viewport(), Qt::LeftButton, Qt::NoModifier,
                          table->visualItemRect(table->item(0, 0)).center());
        click("progressOpen");
        ASSERT_TRUE(waitFor([this] { return result().isVisible(); }));
    };
    openFirst();
    const course::FinishedWork& shown = result().shown()->work;
    EXPECT_EQ(shown.result.assessment.score, kept.score);
    EXPECT_TRUE(part<QLabel>("resultScore")->isVisible()) << "nobody is asked again";
    EXPECT_TRUE(part<QLabel>("resultOwnJudgement")->text().contains("40"));
    ASSERT_NE(shown.own, nullptr);
    EXPECT_TRUE(part<QPushButton>("resultPage")->isEnabled());
    // The teacher's comment leads to its place and seconds.
    auto* comments = part<QListWidget>("resultComments");
    ASSERT_TRUE(comments->isVisible());
    EXPECT_TRUE(comments->item(0)->text().contains("Sato: look here"));
    QTest::mouseClick(comments->viewport(), Qt::LeftButton, Qt::NoModifier,
                      comments->visualItemRect(comments->item(0)).center());
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay && !simulator().isBusy(); }));
    ASSERT_TRUE(view()->written().markMm);
    EXPECT_EQ(*view()->written().markMm, core::Vec3(0, 0, -0.5));
    EXPECT_EQ(store().attempts().size(), 1u) << "seen, not done again";
    simulator().close();
    // Its recording gone, and then the exercise as well: the result stands.
    result().close();
    ASSERT_EQ(kept.recordings.size(), 1u);
    fs::remove(simulator().folders().sessions / kept.recordings.front());
    openFirst();
    EXPECT_EQ(result().shown()->work.own, nullptr);
    EXPECT_TRUE(part<QPushButton>("resultPage")->isEnabled());
    result().close();
    fs::remove_all(place);
    openFirst();
    EXPECT_EQ(result().shown()->work.result.assessment.score, kept.score);
    EXPECT_FALSE(part<QPushButton>("resultPage")->isEnabled());
    EXPECT_EQ(part<QLabel>("resultTitle")->text(), "Line one");
}

TEST_F(PracticeTest, WhatWasLostIsDueLaterAndShownWithoutHelps) {
    makeExercise("one", false);
    makeExercise("two", false);
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    finish();
    const std::vector<school::Retest> lost = store().retests();
    ASSERT_FALSE(lost.empty()) << "so little was cut that points are lost";
    EXPECT_EQ(lost.front().due - store().attempts().front().finished, 7LL * 24 * 3600 * 1000);
    openExercises();
    chooseInList(QStringLiteral("Line one"));
    EXPECT_FALSE(part<QPushButton>("exercisesRetest")->isVisible()) << "not before its time";
    exercises().close();
    // Eight days later.
    school::Attempt before = store().attempts().front();
    before.id = school::newId();
    std::vector<school::Retest> due = lost;
    for (school::Retest& one : due)
        one.due = before.finished - 1;
    store().add(before, due);
    openExercises();
    chooseInList(QStringLiteral("Line two"));
    EXPECT_FALSE(part<QPushButton>("exercisesRetest")->isVisible());
    chooseInList(QStringLiteral("(due)"));
    EXPECT_TRUE(part<QLabel>("exercisesDue")->text().startsWith("Due once more"));
    EXPECT_TRUE(part<QPushButton>("exercisesBegin")->isVisible()) << "nobody must";
    click("exercisesRetest");
    ASSERT_TRUE(waitFor([&] {
        return simulator().task() && simulator().isRecorded() && !simulator().isBusy() && removedMm3() == 0.0;
    }));
    for (const auto help : {exercise::Operation::depthStop, exercise::Operation::section,
                            exercise::Operation::transparency, exercise::Operation::compare})
        EXPECT_TRUE(simulator().permissions().locks(help));
    EXPECT_FALSE(action("actionZones")->isEnabled());
    view()->showStandardView(view::StandardView::occlusal);
    ASSERT_TRUE(cut());
    finish();
    const std::vector<school::Retest> after = store().retests("one");
    ASSERT_FALSE(after.empty());
    EXPECT_GT(after.front().due, store().attempts().back().finished) << "it waits again";
    EXPECT_EQ(store().attempts().back().exerciseHash, before.exerciseHash) << "helps are not the exercise";
}

TEST_F(PracticeTest, TheLiveBarCountsAsTheScoreDoesAndIsNotThereUnlessAllowed) {
    makeExercise("one", false);
    makeExercise("live", false, {}, [](tasks::Task& task) { task.hasLiveBar = true; });
    startWithTooth();
    openExercises();
    begin("one");
    EXPECT_FALSE(part<QProgressBar>("exerciseTarget")->isVisible());
    openExercises();
    begin("live");
    ASSERT_TRUE(part<QProgressBar>("exerciseTarget")->isVisible());
    LiveShares last;
    int counts = 0;
    QObject::connect(window().findChild<LiveZones*>(), &LiveZones::counted, &window(), [&](const LiveShares& shares) {
        last = shares;
        ++counts;
    });
    ASSERT_TRUE(cut());
    ASSERT_TRUE(cut());
    const int before = counts;
    ASSERT_TRUE(waitFor([&] { return counts > before && last.targetRemoved > 0.0; }));
    // Nothing more is cut, and so nothing more counted.
    const int settledAt = counts;
    QTest::qWait(1500);
    EXPECT_LE(counts, settledAt + 2);
    const auto& task = *simulator().task();
    const preparation::Laid laid = preparation::layOn(task.toothCase, *task.preparation);
    tooth::ToothMirror mirror(simulator().tooth()->modelShared());
    mirror.apply(simulator().tooth()->state({}));
    const zones::ZoneVolumes truth = zones::zoneVolumes(*laid.zones, mirror);
    EXPECT_EQ(last.targetRemoved, truth.removedMm3(zones::Zone::target) / truth.targetMm3());
    EXPECT_EQ(last.beyondMm3, truth.removedMm3(zones::Zone::container));
    EXPECT_EQ(part<QProgressBar>("exerciseTarget")->value(), static_cast<int>(100.0 * last.targetRemoved));
}

/// Pictures of all of it in both languages: HANDPIECE_TEST_PICTURES names their folder.
TEST_F(PracticeTest, DISABLED_IsLookedAt) {
    const fs::path place = makeExercise("one", false, {}, [](tasks::Task& task) {
        task.minutes = 0.05;
        task.hasLiveBar = true;
    });
    for (const char* language : {"en", "ja"}) {
        CommandLine line;
        line.language = QLatin1String(language);
        const auto look = [&](QWidget* widget, const char* name) {
            picture(widget, (std::string(name) + "-" + language).c_str());
        };
        startWithTooth(line);
        window().openFile(toQString(place));
        ASSERT_TRUE(
            waitFor([this] { return simulator().task() && simulator().isRecorded() && !simulator().isBusy(); }));
        view()->showStandardView(view::StandardView::occlusal);
        ASSERT_TRUE(cut());
        ASSERT_TRUE(cut());
        look(&window(), "work");
        finish();
        look(&result(), "result");
        ASSERT_TRUE(waitFor([this] { return !store().retests().empty(); }));
        measures::Evidence there;
        there.placeMm = core::Vec3(0.0, 0.0, -0.2);
        emit result().evidenceChosen(there);
        result().hide();
        look(&window(), "mark");
        there.placeMm = core::Vec3(0.0, 0.0, -4.0);
        emit result().evidenceChosen(there);
        look(&window(), "mark-hidden");
        school::Attempt before = store().attempts().back();
        before.id = school::newId();
        std::vector<school::Retest> due = store().retests();
        for (school::Retest& one : due)
            one.due = 1;
        store().add(before, due);
        store().add(
            school::Comment{school::newId(), before.id, "Sato", "floor too flat here", core::Vec3::Zero(), 0.3, 5});
        openExercises();
        auto* list = part<QListWidget>("exercisesList");
        ASSERT_TRUE(waitFor([&] { return exercises().isReady() && list->count() > 1; }));
        list->setCurrentRow(list->count() - 1);
        ASSERT_TRUE(waitFor([&] { return exercises().isReady(); }));
        look(&exercises(), "due");
        exercises().close();
        action("actionProgress")->trigger();
        look(part<ProgressDialog>("progressDialog"), "progress");
        part<QTableWidget>("progressTable")->setCurrentCell(0, 0);
        click("progressOpen");
        ASSERT_TRUE(waitFor([this] { return result().isVisible(); }));
        look(&result(), "older");
        host_.reset();
    }
}

TEST_F(PracticeTest, TwiceOutOfOrderAndHalfLosesNothing) {
    makeExercise("one", true);
    makeExercise("two", false);
    startWithTooth();
    openExercises();
    begin("one");
    // Finish without a cut: judged all the same, and twice pressed it is one attempt.
    ASSERT_TRUE(waitFor([this] { return action("actionFinish")->isEnabled(); }));
    action("actionFinish")->trigger();
    action("actionFinish")->trigger();
    ASSERT_TRUE(waitFor([this] { return result().isVisible(); }));
    ASSERT_TRUE(idle());
    EXPECT_EQ(store().attempts().size(), 1u);
    EXPECT_EQ(store().attempts().front().passed, "no");
    // Closed without a word: no judgement, and the result is still to be had.
    result().close();
    EXPECT_FALSE(store().judgementOf(store().attempts().front().id));
    action("actionResult")->trigger();
    EXPECT_TRUE(part<QLabel>("resultScore")->isVisible());
    // Another exercise over unfinished work: one is asked, and stays where one says so.
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    answer_ = Questions::Unsaved::cancel;
    openExercises();
    chooseInList(QStringLiteral("Line two"));
    const int asked = asked_;
    click("exercisesBegin");
    EXPECT_EQ(asked_, asked + 1);
    EXPECT_EQ(simulator().task()->id, "one");
    EXPECT_GT(removedMm3(), 0.0);
    // The window closed while it is judged: the work is offered at the next start.
    ASSERT_TRUE(exercises().close());
    ASSERT_TRUE(idle());
    action("actionFinish")->trigger();
    ASSERT_TRUE(simulator().isBusy());
    host_.reset();
    startWithTooth();
    EXPECT_EQ(store().attempts().size(), 1u);
    ASSERT_EQ(simulator().crashed().size(), 1u);
    simulator().recover(simulator().crashed().front());
    ASSERT_TRUE(waitFor([this] { return simulator().task() && simulator().isRecorded() && !simulator().isBusy(); }));
    EXPECT_GT(removedMm3(), 0.0);
    finish();
    EXPECT_EQ(store().attempts().size(), 2u);
    EXPECT_TRUE(store().attempts().back().proven);
}

TEST_F(PracticeTest, AFinishedWorkIsHandedInAsTheCommandLineDoesIt) {
    const fs::path place = makeExercise("one", true);
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    finish();
    part<QSpinBox>("judgePercent")->setValue(65);
    part<QPlainTextEdit>("judgeWords")->setPlainText("too short");
    click("judgeShow");
    std::optional<QString> code;
    int asked = 0;
    const auto answer = [&] {
        window().findChild<ExerciseFeature*>()->questions.student = [&](const QString&) {
            ++asked;
            return code;
        };
    };
    answer();
    file_ = own_.filePath("desk/a7.handpiece");
    const fs::path file = toPath(file_);
    fs::create_directories(file.parent_path());
    click("resultHandIn");
    EXPECT_FALSE(fs::exists(file)) << "asked for a code, and that was given up";
    code = "A7";
    // A full disk first: told, and nothing of it stays.
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit none{512, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &none), 0);
    click("resultHandIn");
    const bool told = waitFor([this] { return window().errorDialog() != nullptr; });
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    ASSERT_TRUE(told);
    EXPECT_FALSE(window().errorDialog()->problem().remedy.isEmpty());
    EXPECT_TRUE(fs::is_empty(file.parent_path()));
    window().errorDialog()->reject();
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() == nullptr; }));
    click("resultHandIn");
    ASSERT_TRUE(waitFor([this] { return part<QLabel>("resultNote")->text().startsWith("Handed in"); }));
    EXPECT_EQ(asked, 2) << "a code is asked for once";
    picture(&result(), "handed-in");
    // The same to the byte as `handpiece exercise hand-in` of the same recording.
    const auto task = std::make_shared<const tasks::Task>(tasks::readTask(place));
    const fs::path session = result().shown()->work.session;
    fs::create_directories(at("cli"));
    course::handIn(course::judged(session, task), {"A7", 65.0, "too short"}, at("cli") / "a7.handpiece");
    EXPECT_EQ(core::readFile(file), core::readFile(at("cli") / "a7.handpiece"));
    // The teacher's desk has it, and comes to the same score.
    const std::vector<marking::ReturnedWork> works = marking::findWork(file.parent_path());
    ASSERT_EQ(works.size(), 1u);
    EXPECT_FALSE(works.front().error);
    const assessment::Work read = assessment::readWork(works.front().path, *task);
    EXPECT_TRUE(read.isProven) << read.proof;
    const score::Result judged = assessment::scoreWork(read, *task, course::rubricOf(*task));
    EXPECT_EQ(judged.assessment.score, store().attempts().front().score);
    EXPECT_EQ(judged.identity.sessionHashes, store().attempts().front().sessionHashes);
    // Later, from the list of all attempts.
    host_.reset();
    startWithTooth();
    answer();
    fs::create_directories(at("later"));
    file_ = own_.filePath("later/a7.handpiece");
    const auto handInFirst = [this] {
        action("actionProgress")->trigger();
        EXPECT_FALSE(part<QPushButton>("progressHandIn")->isEnabled());
        part<QTableWidget>("progressTable")->setCurrentCell(0, 0);
        click("progressHandIn");
    };
    handInFirst();
    ASSERT_TRUE(waitFor([this] { return part<QLabel>("resultNote")->text().startsWith("Handed in"); }));
    EXPECT_EQ(core::readFile(file), core::readFile(toPath(file_)));
    result().close();
    // And when its recording is gone: told, and there is no button for it.
    fs::remove(session);
    file_ = own_.filePath("gone.handpiece");
    handInFirst();
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
    EXPECT_EQ(window().errorDialog()->problem().id, "nothing-to-hand-in");
    EXPECT_FALSE(part<QPushButton>("resultHandIn")->isEnabled());
    EXPECT_FALSE(QFile::exists(file_));
}

TEST_F(PracticeTest, WhatATeacherGivesBackIsSeenAtItsPlacesAndTimes) {
    const fs::path place = makeExercise("one", false);
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    finish();
    // The teacher's side, at a desk that has what was handed in.
    const auto task = std::make_shared<const tasks::Task>(tasks::readTask(place));
    fs::create_directories(at("desk"));
    course::handIn(result().shown()->work, {"A7", {}, {}}, at("desk") / "a7.handpiece");
    marking::DeskSetup setup;
    setup.folder = at("desk");
    setup.marker = "Sato";
    setup.exercise = task->id;
    setup.exerciseHash = rubric::hashText(tasks::contentHash(*task));
    setup.rubric = course::rubricOf(*task);
    marking::Desk desk(setup, marking::findWork(setup.folder));
    const std::string code = desk.codes().front();
    desk.take(0, marking::scoreReturned(desk.works().front(), *task, setup.rubric, {true, false, {}}));
    ASSERT_NE(desk.machine(code), nullptr) << desk.problem(code);
    const rubric::Criterion& c = *std::find_if(setup.rubric.criteria.begin(), setup.rubric.criteria.end(),
                                               [](const rubric::Criterion& one) { return one.isGraded(); });
    desk.override(code, c.id, {c.bands.empty() ? "" : c.bands.front().id, c.weight, {}, "<b>well</b> seen"});
    desk.comment(code, {0, "", "look here", core::Vec3(0.5, 0.25, -0.5), 0.3, {}});
    desk.decide(code, marking::Decision{true, "good enough"});
    const std::string given = marking::returnedJson(marking::returnedMarks(desk, code));
    // What is broken, or of another work, is told, and nothing is kept.
    const std::string id = store().attempts().front().id;
    const auto refused = [&](const std::string& text, const char* why) {
        core::writeFile(at("bad.json"), text);
        window().openFile(own_.filePath("bad.json"));
        ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; })) << why;
        EXPECT_EQ(window().errorDialog()->problem().id, why);
        window().errorDialog()->reject();
        ASSERT_TRUE(waitFor([this] { return window().errorDialog() == nullptr; }));
        EXPECT_TRUE(store().returnedOf(id).empty());
    };
    refused(given.substr(0, given.size() / 2), "returned-damaged");
    std::string other = given;
    const auto state = other.find("\"state_hash\": \"") + 15;
    other[state] = other[state] == '0' ? '1' : '0';
    refused(other, "returned-of-another");
    result().close();
    // By the button in Progress.
    file_ = own_.filePath("a7-marks.json");
    core::writeFile(toPath(file_), given);
    action("actionProgress")->trigger();
    click("progressReturned");
    ASSERT_TRUE(waitFor([this] { return result().isVisible(); }));
    EXPECT_EQ(store().returnedOf(id).size(), 1u);
    EXPECT_EQ(result().shown()->work.result.assessment.score, store().attempts().front().score)
        << "the machine's stays";
    const QString says = part<QLabel>("resultTeacher")->text();
    EXPECT_TRUE(part<QLabel>("resultTeacher")->isVisible());
    EXPECT_TRUE(says.contains("Sato") && says.contains("good enough")) << says.toStdString();
    EXPECT_TRUE(says.contains(QLocale().toString(desk.finalScore(code)->score, 'f', 1))) << says.toStdString();
    auto* comments = part<QListWidget>("resultComments");
    ASSERT_EQ(comments->count(), 2);
    EXPECT_TRUE(comments->item(0)->text().contains("<b>well</b> seen")) << "text, never markup";
    EXPECT_TRUE(comments->item(1)->text().contains("Sato: look here"));
    const auto row = static_cast<int>(&c - setup.rubric.criteria.data());
    EXPECT_TRUE(part<QTableWidget>("resultTable")->item(row, 3)->text().contains("Sato"));
    picture(&result(), "returned");
    // The comment turns the eye to its place and plays its seconds.
    QTest::mouseClick(comments->viewport(), Qt::LeftButton, Qt::NoModifier,
                      comments->visualItemRect(comments->item(1)).center());
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay && !simulator().isBusy(); }));
    ASSERT_TRUE(waitFor([this] { return view()->written().markMm.has_value(); }));
    EXPECT_EQ(*view()->written().markMm, core::Vec3(0.5, 0.25, -0.5));
    ASSERT_TRUE(waitFor([this] { return simulator().replay()->now().playing; }));
    // Once more, dropped on the window: in the place of what was there. And it is there another day.
    host_.reset();
    startWithTooth();
    drop(file_);
    ASSERT_TRUE(waitFor([this] { return result().isVisible(); }));
    EXPECT_EQ(store().returnedOf(id).size(), 1u);
    result().close();
    action("actionProgress")->trigger();
    part<QTableWidget>("progressTable")->setCurrentCell(0, 0);
    click("progressOpen");
    ASSERT_TRUE(waitFor([this] { return result().isVisible(); }));
    EXPECT_EQ(part<QListWidget>("resultComments")->count(), 2);
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
}  // namespace handpiece::desktop::practice_window_test
