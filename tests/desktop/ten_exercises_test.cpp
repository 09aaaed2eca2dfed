// SPDX-License-Identifier: Apache-2.0
// Each of the ten exercises that come along, as a student has it: chosen, begun, cut a little, finished, its result
// seen. Minutes of CPU, for the teeth are the real ones: tools/nightly large. HANDPIECE_TEST_TEETH: a folder in which
// they are kept from one run to the next; HANDPIECE_TEST_PICTURES: one for pictures of all of it.
#include <QDockWidget>
#include <QLabel>
#include <QListWidget>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QRadioButton>
#include <QTableWidget>

#include "desktop/features/exercise/assessment_words.h"
#include "desktop/features/exercise/exercises_dialog.h"
#include "desktop/features/exercise/practice_feature.h"
#include "desktop/features/exercise/result_dialog.h"
#include "desktop/picture/solid_view.h"
#include "handpiece/app/course/shipped_exercises.h"
#include "shell_support.h"

namespace handpiece::desktop::ten_exercises_test {
namespace {

class TenExercises : public ShellTest, public ::testing::WithParamInterface<int> {
  protected:
    [[nodiscard]] Simulator::Options options() const override {
        Simulator::Options options = ShellTest::options();
        // The egg that is open at the start stays apart from what is made here.
        if (const QString kept = qEnvironmentVariable("HANDPIECE_TEST_TEETH"); !kept.isEmpty())
            options.folders.starters = toPath(kept);
        return options;
    }
    template <class W>
    [[nodiscard]] W* part(const char* name) {
        return window().findChild<W*>(QLatin1String(name));
    }
    void picture(QWidget* widget, const std::string& name) {
        const QString folder = qEnvironmentVariable("HANDPIECE_TEST_PICTURES");
        if (folder.isEmpty()) return;
        QTest::qWait(2500);  // what is drawn beside has time to come
        const QString number = QStringLiteral("/%1-").arg(GetParam(), 2, 10, QLatin1Char('0'));
        widget->grab().save(folder + number + QString::fromStdString(name) + QStringLiteral(".png"));
    }
    /// Presses for at most so many ticks where the picture's middle is, or beside it.
    [[nodiscard]] bool cutAt(const QPoint& at, std::uint64_t mostTicks) {
        const double before = removedMm3();
        QMouseEvent move(QEvent::MouseMove, QPointF(at), view()->mapToGlobal(QPointF(at)), Qt::NoButton, Qt::NoButton,
                         Qt::NoModifier);
        QApplication::sendEvent(view(), &move);
        std::uint64_t tick = simulator().sample().tick;
        static_cast<void>(waitFor([&] {
            return simulator().sample().tick > tick + 2000 ||
                   (simulator().sample().tick > tick + 300 && speedMmS() < 1.0);
        }));
        tick = simulator().sample().tick;
        QTest::mousePress(view(), Qt::LeftButton, Qt::NoModifier, at);
        static_cast<void>(
            waitFor([&] { return removedMm3() > before + 0.05 || simulator().sample().tick > tick + mostTicks; }));
        QTest::mouseRelease(view(), Qt::LeftButton, Qt::NoModifier, at);
        static_cast<void>(
            waitFor([this] { return simulator().sample().pedal == 0.0 && !simulator().status().inStroke; }));
        return removedMm3() > before;
    }
};

TEST_P(TenExercises, IsBegunCutAndFinished) {
    const auto& all = course::shippedExercises();
    const course::Shipped& shipped = all.at(static_cast<std::size_t>(GetParam() - 1));
    ASSERT_EQ(shipped.number, GetParam());
    startWithTooth();
    window().resize(1280, 800);
    action("actionExercises")->trigger();
    auto* dialog = part<ExercisesDialog>("exercisesDialog");
    ASSERT_TRUE(dialog->isVisible());
    auto* list = part<QListWidget>("exercisesList");
    QListWidgetItem* item = list->item(GetParam() - 1);
    ASSERT_NE(item, nullptr);
    EXPECT_EQ(item->text(), inThisLanguage(shipped.exercise.title));
    list->scrollToItem(item);
    QTest::mouseClick(list->viewport(), Qt::LeftButton, Qt::NoModifier, list->visualItemRect(item).center());
    ASSERT_TRUE(QTest::qWaitFor([&] { return dialog->isReady(); }, 1'500'000)) << "the tooth was not made";
    EXPECT_FALSE(part<QLabel>("exercisesNote")->isVisible()) << part<QLabel>("exercisesNote")->text().toStdString();
    EXPECT_FALSE(part<QLabel>("exercisesWords")->text().isEmpty());
    EXPECT_FALSE(part<QLabel>("exercisesAsks")->text().isEmpty());
    ASSERT_NE(dialog->ideal(), nullptr);
    EXPECT_TRUE(waitFor([this] { return part<SolidView>("exercisesIdeal")->isDrawn(); }));
    picture(dialog, "choose");
    QTest::mouseClick(part<QPushButton>("exercisesBegin"), Qt::LeftButton);
    ASSERT_TRUE(waitFor([&] {
        return simulator().task() && simulator().task()->id == shipped.id && simulator().isRecorded() &&
               simulator().mode() == Simulator::Mode::liveSession && !simulator().isBusy();
    }));
    ASSERT_EQ(window().errorDialog(), nullptr);
    ASSERT_TRUE(part<QDockWidget>("exerciseDock")->isVisible());
    EXPECT_TRUE(part<QPushButton>("exerciseFinish")->isVisible());
    EXPECT_EQ(simulator().burName().toStdString(), shipped.exercise.bur);
    EXPECT_EQ(simulator().driveName().toStdString(), shipped.drive);
    EXPECT_EQ(simulator().setSpeedRpm(), instrument::driveByName(shipped.drive).freeSpeedRpm);
    picture(&window(), "begin");
    // The task as glass, where it is not there already.
    QAction* glass = action("actionZones");
    ASSERT_TRUE(glass->isEnabled());
    if (!glass->isChecked()) glass->trigger();
    QTest::qWait(3000);
    ASSERT_EQ(window().errorDialog(), nullptr) << "the preparation does not lie on the tooth";
    picture(&window(), "glass");
    // At the start view, and where nothing is hit there a little beside.
    const QPoint middle = view()->rect().center();
    bool isCut = false;
    for (const QPoint& beside : {QPoint(0, 0), QPoint(0, 60), QPoint(0, -60), QPoint(60, 0), QPoint(-60, 0)})
        if ((isCut = cutAt(middle + beside, 4000))) break;
    picture(&window(), "cut");
    EXPECT_TRUE(isCut) << "with the first bur nothing can be cut in the middle of the start view";
    const double cutMm3 = removedMm3();
    QTest::mouseClick(part<QPushButton>("exerciseFinish"), Qt::LeftButton);
    auto* result = part<ResultDialog>("resultDialog");
    ASSERT_TRUE(QTest::qWaitFor([&] { return result->isVisible() || window().errorDialog() != nullptr; }, 1'500'000));
    ASSERT_EQ(window().errorDialog(), nullptr);
    if (part<QPlainTextEdit>("judgeWords")->isVisible())
        QTest::mouseClick(part<QPushButton>("judgeShow"), Qt::LeftButton);
    ASSERT_TRUE(part<QLabel>("resultScore")->isVisible());
    EXPECT_TRUE(part<QLabel>("resultProof")->text().startsWith("Proven"))
        << part<QLabel>("resultProof")->text().toStdString();
    const score::Assessment& judged = result->shown()->work.result.assessment;
    EXPECT_NE(judged.passed, score::Passed::yes) << "so little was done";
    ASSERT_TRUE(judged.completeness && judged.completeness->value);
    EXPECT_LE(judged.score, 0.25 * judged.maxScore) << "nor does it look good";
    if (judged.lostUndone() >= 0.1) {
        EXPECT_TRUE(part<QLabel>("resultUndone")->text().startsWith("Not finished"));
        EXPECT_TRUE(part<QPushButton>("resultShowUndone")->isVisible());
    }
    EXPECT_EQ(part<QTableWidget>("resultTable")->rowCount(), static_cast<int>(judged.criteria.size()));
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay && !simulator().isBusy(); }));
    EXPECT_TRUE(waitFor([&] { return std::abs(removedMm3() - cutMm3) < 1e-3; })) << removedMm3() << " " << cutMm3;
    // Cut anew, as long as it takes: of a crown more than a minute on a busy machine.
    ASSERT_TRUE(QTest::qWaitFor([this] { return part<QRadioButton>("resultIdeal")->isEnabled(); }, 1'500'000));
    EXPECT_TRUE(waitFor([this] { return part<SolidView>("resultTooth")->isDrawn(); }));
    picture(result, "result");
    school::Store& store = *window().findChild<PracticeFeature*>()->store();
    ASSERT_EQ(store.attempts().size(), 1u);
    EXPECT_EQ(store.attempts().front().exercise, shipped.id);
    EXPECT_TRUE(store.attempts().front().proven);
    // A row that leads somewhere does.
    auto* table = part<QTableWidget>("resultTable");
    for (int row = 0; row < table->rowCount(); ++row) {
        if (table->item(row, 4)->text().isEmpty()) continue;
        table->scrollToItem(table->item(row, 4));
        QTest::mouseClick(table->viewport(), Qt::LeftButton, Qt::NoModifier,
                          table->visualItemRect(table->item(row, 4)).center());
        EXPECT_TRUE(waitFor([this] { return view()->written().markMm.has_value(); }));
        result->hide();
        picture(&window(), "evidence");
        break;
    }
    ASSERT_EQ(window().errorDialog(), nullptr);
}

INSTANTIATE_TEST_SUITE_P(All, TenExercises, ::testing::Range(1, 11));

}  // namespace
}  // namespace handpiece::desktop::ten_exercises_test
