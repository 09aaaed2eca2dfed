// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A student's way through an exercise under the offscreen platform: a block in coarse voxels, chosen, worked on,
/// finished by clicks.

#include <QComboBox>
#include <QFile>
#include <QLabel>
#include <QListWidget>
#include <QPlainTextEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QRadioButton>
#include <QSpinBox>
#include <QTableWidget>

#include "desktop/features/exercise/exercise_feature.h"
#include "desktop/features/exercise/exercises_dialog.h"
#include "desktop/features/exercise/practice_feature.h"
#include "desktop/features/exercise/progress_dialog.h"
#include "desktop/features/exercise/result_dialog.h"
#include "desktop/features/exercise/section_card.h"
#include "desktop/picture/solid_view.h"
#include "desktop/widgets/notice_bar.h"
#include "desktop/work/live_zones.h"
#include "handpiece/app/assessment/recording.h"
#include "handpiece/app/course/shipped_exercises.h"
#include "handpiece/app/marking/returned_marks.h"
#include "handpiece/assess/draft/draft.h"
#include "handpiece/base/core/file.h"
#include "shell_support.h"

namespace handpiece::desktop {

class PracticeTest : public ShellTest {
  protected:
    /// A block in coarse voxels, so that a test need not wait, with what the program's own has.
    std::filesystem::path makeExercise(const char* id, bool asksFirst, std::vector<std::string> locked = {},
                                       const std::function<void(tasks::Task&)>& change = {}) {
        tasks::Task task = course::blockTask("line", 1);
        task.id = id;
        task.voxelMm = 1e-3 * kVoxelUm;
        task.ownJudgement = asksFirst;
        task.rubric = rubric::shippedRubricText("dexterity-line");
        task.toothCase.exercise->title = {{"en", std::string("Line ") + id}, {"ja", "直線"}};
        task.toothCase.exercise->instructions = {{"en", "Cut the line."}};
        task.toothCase.exercise->lockedHelps = std::move(locked);
        task.toothCase.exercise->allowedBurs = {"330", "round-2"};
        if (change) change(task);
        const std::filesystem::path place = at("exercises") / id;
        std::filesystem::create_directories(place.parent_path());
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
        // Beside the title stands what was reached.
        ASSERT_TRUE(waitFor([&] { return !list->findItems(title, Qt::MatchContains).isEmpty(); }));
        QListWidgetItem* item = list->findItems(title, Qt::MatchContains).front();
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
    /// For people to look at, where HANDPIECE_TEST_PICTURES names a folder.
    void picture(QWidget* widget, const char* name) {
        const QString folder = qEnvironmentVariable("HANDPIECE_TEST_PICTURES");
        if (folder.isEmpty()) return;
        QTest::qWait(1500);  // what is drawn beside has time to come
        widget->grab().save(folder + QLatin1Char('/') + QLatin1String(name) + QStringLiteral(".png"));
    }
    void save(const char* name) {
        file_ = own_.filePath(QLatin1String(name));
        action("actionSaveAs")->trigger();
        ASSERT_TRUE(waitFor([this] { return QFile::exists(file_) && !simulator().isBusy(); }));
        ASSERT_EQ(window().errorDialog(), nullptr);
    }
    void resume(const char* name) {
        const std::filesystem::path place = toPath(own_.filePath(QLatin1String(name)));
        window().openFile(toQString(place));
        ASSERT_TRUE(waitFor([&] {
            return simulator().document().attemptFile == place && simulator().mode() == Simulator::Mode::liveSession &&
                   simulator().isRecorded() && !simulator().isBusy();
        }));
        view()->showStandardView(view::StandardView::occlusal);
    }
    /// Presses in the middle of the picture for a while, whatever comes of it.
    void press(std::uint64_t ticks) {
        const QPoint middle = view()->rect().center();
        QTest::mousePress(view(), Qt::LeftButton, Qt::NoModifier, middle);
        const std::uint64_t from = simulator().sample().tick;
        EXPECT_TRUE(waitFor([&] { return simulator().sample().tick > from + ticks; }));
        QTest::mouseRelease(view(), Qt::LeftButton, Qt::NoModifier, middle);
    }
    [[nodiscard]] bool isTold(const char* notice) {
        const auto bars = window().findChildren<NoticeBar*>();
        return std::any_of(bars.begin(), bars.end(), [&](const NoticeBar* bar) {
            return bar->isVisible() && bar->current() == QLatin1String(notice);
        });
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

}  // namespace handpiece::desktop
