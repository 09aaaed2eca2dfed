// SPDX-License-Identifier: Apache-2.0
// What lies beside a student's result: the tooth as it was worked on, and the teacher's own work, which the editor
// takes along.
#include <QTabWidget>

#include "desktop/features/editor/editor_dialog.h"
#include "desktop/features/editor/editor_feature.h"
#include "practice_support.h"

namespace handpiece::desktop::result_window_test {
namespace {

namespace fs = std::filesystem;

TEST_F(PracticeTest, TheResultShowsTheToothAsItWasWorkedOn) {
    const cases::View palatal{core::Vec3(0.0, -30.0, 5.0), core::Vec3(0.0, 0.0, -1.0), core::Vec3(0.0, 0.0, 1.0)};
    makeExercise("one", false, {}, [&](tasks::Task& task) { task.toothCase.exercise->view = palatal; });
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    finish();
    const auto looks = [&] {
        const core::Vec3 wanted = (palatal.targetMm - palatal.eyeMm).normalized();
        return (part<SolidView>("resultTooth")->camera().forward() - wanted).norm() < 1e-9;
    };
    EXPECT_TRUE(looks());
    ASSERT_TRUE(waitFor([this] { return part<QRadioButton>("resultIdeal")->isEnabled(); }));
    QTest::mouseClick(part<QRadioButton>("resultIdeal"), Qt::LeftButton);
    EXPECT_TRUE(looks()) << "in the same view";
    // Turned by hand it stays so while own and ideal change over.
    part<SolidView>("resultTooth")->lookFrom(view::StandardView::occlusal);
    QTest::mouseClick(part<QRadioButton>("resultOwn"), Qt::LeftButton);
    EXPECT_FALSE(looks());
}

TEST_F(PracticeTest, TheTeachersOwnWorkPlaysBesideAlsoAfterTheWorkWasResumed) {
    const fs::path place = makeExercise("one", false);
    startWithTooth();
    // The teacher's own: cut and taken along with the exercise.
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    finish();
    EXPECT_TRUE(part<QPushButton>("resultTeacherWork")->isHidden()) << "there is none";
    const fs::path session = result().shown()->work.session;
    result().close();
    host_.reset();
    startWithTooth();
    // In the editor: what is no recording, or of another tooth, is told and changes nothing.
    ASSERT_TRUE(cut());
    const fs::path eggs = simulator().recording();
    ASSERT_FALSE(eggs.empty());
    simulator().close();
    file_ = toQString(place / "exercise.toml");
    action("actionEditExercise")->trigger();
    auto& editor = *window().findChild<EditorFeature*>();
    const auto take = [&](const fs::path& file) {
        file_ = toQString(file);
        part<QTabWidget>("editorTabs")->setCurrentIndex(2);
        click("editorTeacherWorkTake");
        ASSERT_TRUE(waitFor([&] { return !editor.isBusy(); }));
    };
    const auto refused = [&](const fs::path& file, const char* why) {
        take(file);
        ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; })) << why;
        EXPECT_EQ(window().errorDialog()->problem().id, why);
        window().errorDialog()->reject();
        ASSERT_TRUE(waitFor([this] { return window().errorDialog() == nullptr; }));
        EXPECT_EQ(editor.dialog()->draft().now().teacherWork, nullptr);
        EXPECT_FALSE(part<QPushButton>("editorTeacherWorkDrop")->isEnabled());
    };
    fs::copy_file(eggs, at("eggs.h5"));
    refused(place / "exercise.toml", "work-no-session");
    refused(at("eggs.h5"), "other-tooth");
    // One of another exercise on this tooth: its points tell.
    const course::FinishedWork judged =
        course::judged(session, std::make_shared<const tasks::Task>(tasks::readTask(place)));
    const QString points = QLocale().toString(judged.result.assessment.score, 'f', 1);
    take(session);
    ASSERT_NE(editor.dialog()->draft().now().teacherWork, nullptr);
    EXPECT_TRUE(part<QLabel>("editorTeacherWork")->text().contains(points))
        << part<QLabel>("editorTeacherWork")->text().toStdString();
    ASSERT_EQ(judged.result.assessment.passed, score::Passed::no) << "a line cut by one press";
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
    EXPECT_EQ(window().errorDialog()->problem().id, "teacher-work-fails");
    EXPECT_TRUE(window().errorDialog()->problem().what.contains(points));
    window().errorDialog()->reject();
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() == nullptr; }));
    picture(part<QDialog>("exerciseEditor"), "editor-teacher");
    click("editorTeacherWorkDrop");
    EXPECT_EQ(editor.dialog()->draft().now().teacherWork, nullptr);
    click("editorUndo");
    click("editorSave");
    const tasks::Task task = tasks::readTask(place);
    ASSERT_NE(task.teacherWork, nullptr);
    EXPECT_EQ(*task.teacherWork, core::readFile(session));
    editor.dialog()->close();
    host_.reset();
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    save("work.handpiece");
    resume("work.handpiece");
    finish();
    ASSERT_TRUE(waitFor([this] { return part<QPushButton>("resultTeacherWork")->isVisible(); }));
    const fs::path own = simulator().document().caseFile;
    // From its beginning, where no place was looked at.
    click("resultTeacherWork");
    const auto isTeachers = [&] {
        return simulator().mode() == Simulator::Mode::replay && !simulator().isBusy() &&
               simulator().document().caseFile.filename() == tasks::kTeacherWorkFile;
    };
    ASSERT_TRUE(waitFor(isTeachers));
    ASSERT_TRUE(waitFor([this] { return simulator().replay()->now().playing; }));
    EXPECT_EQ(core::readFile(simulator().document().caseFile), core::readFile(session));
    EXPECT_FALSE(view()->written().markMm);
    // At the place that was looked at, the seconds in which the teacher's bur cut there: both cut in the middle.
    const core::Vec3 cutMm(0.0, 0.0, -0.03);
    store().add(school::Comment{school::newId(), store().attempts().back().id, "Sato", "here", cutMm, {}, 5});
    result().close();
    action("actionProgress")->trigger();
    part<QTableWidget>("progressTable")->setCurrentCell(0, 0);
    click("progressOpen");
    ASSERT_TRUE(waitFor([this] { return part<QPushButton>("resultTeacherWork")->isVisible(); }));
    auto* comments = part<QListWidget>("resultComments");
    QTest::mouseClick(comments->viewport(), Qt::LeftButton, Qt::NoModifier,
                      comments->visualItemRect(comments->item(0)).center());
    ASSERT_TRUE(waitFor([&] { return simulator().document().caseFile == own && !simulator().isBusy(); }));
    // The result lay over it and made room; a press brings it back.
    ASSERT_TRUE(waitFor([this] { return part<QPushButton>("resultBack")->isVisible(); }));
    EXPECT_FALSE(result().isVisible());
    click("resultBack");
    EXPECT_TRUE(result().isVisible());
    EXPECT_FALSE(part<QPushButton>("resultBack")->isVisible());
    const double endS = [&] {
        click("resultTeacherWork");
        EXPECT_TRUE(waitFor(isTeachers));
        EXPECT_TRUE(waitFor([this] { return view()->written().markMm.has_value(); }));
        return simulator().replay()->durationS();
    }();
    EXPECT_EQ(*view()->written().markMm, cutMm);
    std::vector<measures::Measured> truth(1);
    truth.front().evidence.emplace_back().placeMm = cutMm;
    const assessment::Recording recording{session, "teacher", {}, {}};
    static_cast<void>(assessment::readRecord(std::span(&recording, 1), truth, 0.1, {}, {}));
    ASSERT_TRUE(truth.front().evidence.front().timeS) << "the teacher never cut in the middle";
    bool wasPlaying = false;
    ASSERT_TRUE(waitFor([&] {
        const ReplayNow now = simulator().replay()->now();
        wasPlaying |= now.playing;
        return wasPlaying && !now.playing && !now.seeking;
    }));
    EXPECT_NEAR(simulator().replay()->now().timeS, std::min(endS, *truth.front().evidence.front().timeS + 1.5), 0.3);
    picture(&window(), "teacher");
    // Nor is it lost where the exercise is edited.
    EXPECT_EQ(draft::taskOf(draft::contentOf(task)).teacherWork, task.teacherWork);
}

}  // namespace
}  // namespace handpiece::desktop::result_window_test
