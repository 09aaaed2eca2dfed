// SPDX-License-Identifier: Apache-2.0
// What is shown and said of an exercise: the result's rows, the words at the ring and the eye there, the exercises'
// list, the numbers while one works.
#include <algorithm>
#include <random>

#include "desktop/features/exercise/assessment_words.h"
#include "desktop/features/exercise/live_card.h"
#include "desktop/features/exercise/result_rows.h"
#include "desktop/picture/overlay.h"
#include "desktop/picture/show_view.h"
#include "handpiece/model/case/case.h"
#include "practice_support.h"

namespace handpiece::desktop::said_window_test {
namespace {

/// A channel, whose floor and width are judged.
void asChannel(tasks::Task& task) {
    task.preparation = course::blockTask("channel", 1).preparation;
    task.rubric = rubric::shippedRubricText("block-channel");
    task.hasLiveBar = true;
}

TEST_F(PracticeTest, TheResultSaysWhatWasAskedWhichSideAndWhatToDo) {
    makeExercise("one", false, {}, asChannel);
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    finish();
    auto* table = part<QTableWidget>("resultTable");
    QStringList heads;
    for (int i = 0; i < table->columnCount(); ++i)
        heads << table->horizontalHeaderItem(i)->text();
    EXPECT_EQ(heads, QStringList({"What was judged", "Yours", "Asked", "Points", "Why not all points"}));
    const course::FinishedWork& work = result().shown()->work;
    const auto& all = work.result.assessment.criteria;
    const auto rowOf = [&](const char* id) {
        for (std::size_t i = 0; i < all.size(); ++i)
            if (all[i].id == id) return static_cast<int>(i);
        return -1;
    };
    const auto cell = [&](const char* id, int column) { return table->item(rowOf(id), column)->text(); };
    EXPECT_EQ(cell("target", 2), "96 % or more");
    EXPECT_TRUE(cell("target", 4).contains("too little of the target is cut")) << cell("target", 4).toStdString();
    // Of a criterion that has points of its own the factor of what is unfinished stands at its row.
    const auto& floor = all[static_cast<std::size_t>(rowOf("floor"))];
    ASSERT_TRUE(floor.value) << floor.reason;
    ASSERT_GT(floor.ownPoints, *floor.points + 0.05);
    EXPECT_TRUE(cell("floor", 4).contains("the work is not finished")) << cell("floor", 4).toStdString();
    // Nothing that a student cannot use: no uncertainty of seconds, no bare spectral arc length.
    EXPECT_TRUE(cell("time", 1).endsWith(" min")) << cell("time", 1).toStdString();
    EXPECT_FALSE(cell("time", 1).contains(QChar(0xb1)));
    score::CriterionScore smooth;
    smooth.measure = "smoothness";
    for (const auto& [value, words] : {std::pair{-1.6, "even"}, {-3.5, "fairly even"}, {-7.5, "uneven"}}) {
        smooth.value = value;
        EXPECT_TRUE(plainValue(smooth).startsWith(QLatin1String(words))) << plainValue(smooth).toStdString();
    }
    // The dearest first, with its advice; the exercise that trains it is a press away.
    auto* error = part<QLabel>("resultError_1");
    ASSERT_NE(error, nullptr);
    EXPECT_TRUE(error->text().contains("asked: ")) << error->text().toStdString();
    const auto practise = result().findChildren<QPushButton*>(QRegularExpression("_practise$"));
    ASSERT_FALSE(practise.empty());
    // At the ring: the value, what was asked, which side. The eye is not rolled.
    click("resultShow_1");
    ASSERT_TRUE(waitFor([this] { return view()->written().markMm.has_value(); }));
    const QString words = view()->written().markWords;
    EXPECT_TRUE(words.contains("asked: ") && words.contains("too ")) << words.toStdString();
    const view::Camera eye = view()->camera();
    const auto& start = *work.task->toothCase.exercise->view;
    EXPECT_NEAR(eye.forward().cross(eye.up).normalized().dot(
                    (start.targetMm - start.eyeMm).normalized().cross(start.up).normalized()),
                1.0, 0.35)
        << "right is right";
    EXPECT_LT((eye.eyeMm - eye.targetMm).norm(), 21.0) << "near";
    // Nothing burnt out, nothing drowned: the surface can be read.
    ASSERT_TRUE(waitFor([this] { return !view()->picture().isNull(); }));
    QTest::qWait(1500);
    const QImage seen = view()->picture().convertToFormat(QImage::Format_RGB32);
    int tooth = 0, lost = 0;
    for (int y = 0; y < seen.height(); ++y)
        for (int x = 0; x < seen.width(); ++x) {
            const QRgb p = seen.pixel(x, y);
            if (qRed(p) + qGreen(p) + qBlue(p) < 180) continue;  // the dark ground
            ++tooth;
            if (std::min({qRed(p), qGreen(p), qBlue(p)}) >= 250) ++lost;
        }
    EXPECT_GT(tooth, seen.width() * seen.height() / 4);
    EXPECT_LT(lost, 0.02 * tooth) << "of the picture's tooth this share is white: " << 100.0 * lost / tooth << " %";
    action("actionResult")->trigger();
    QTest::mouseClick(practise.front(), Qt::LeftButton);
    ASSERT_TRUE(exercises().isVisible());
    ASSERT_TRUE(waitFor([this] { return exercises().isReady(); }));
    EXPECT_TRUE(part<QListWidget>("exercisesList")
                    ->currentItem()
                    ->text()
                    .startsWith(QString::fromStdString(
                        course::shippedExercise("dexterity-steps").exercise.title.at("en").substr(0, 3))));
}

TEST(ShowView, IsNearAndNeverRolled) {
    std::mt19937 chance(7);
    std::uniform_real_distribution<double> of(-1.0, 1.0);
    for (int i = 0; i < 2000; ++i) {
        const core::Vec3 draw = i % 2 == 0 ? core::Vec3(0.1 * of(chance), 0.1 * of(chance), 1.0).normalized()
                                           : core::Vec3(0.1 * of(chance), 1.0, 0.2 * of(chance)).normalized();
        view::Camera worked;
        worked.targetMm = core::Vec3(0, 0, 4);
        worked.eyeMm = worked.targetMm + 29.0 * (draw + core::Vec3(0.4 * of(chance), 0.4, 0.1)).normalized();
        worked.up = core::Vec3::UnitZ();
        const core::Vec3 place(4.0 * of(chance), 4.0 * of(chance), 4.0 + 2.0 * of(chance));
        const view::Camera eye = lookingAtPlace(place, draw, core::Vec3(0, 0, 4), worked);
        ASSERT_LT((eye.eyeMm - place).norm(), 21.0);
        ASSERT_LT((eye.targetMm - place).norm(), 1e-9);
        // What pointed up in the picture before points up in it now: nothing of it to the side.
        const core::Vec3 right = eye.forward().cross(eye.up).normalized();
        const core::Vec3 wasUp = (worked.up - worked.up.dot(worked.forward()) * worked.forward()).normalized();
        ASSERT_LT(std::abs(right.dot(wasUp)), 1e-6) << i;
        ASSERT_GT(eye.up.dot(wasUp), 0.0) << i;
        // From about where one worked.
        ASSERT_GT(eye.forward().dot(worked.forward()), 0.6) << i;
    }
}

TEST_F(PracticeTest, YourToothIsNeverTheOneThatWasShownBefore) {
    makeExercise("one", false);
    makeExercise("two", false, {}, asChannel);
    startWithTooth();
    openExercises();
    begin("one");
    ASSERT_TRUE(cut());
    finish();
    auto* tooth = part<SolidView>("resultTooth");
    ASSERT_TRUE(waitFor([&] { return tooth->isDrawn() && !tooth->picture().isNull(); }));
    const QImage before = tooth->picture();
    openExercises();
    begin("two");
    ASSERT_TRUE(cut());
    bool wasSeen = false;
    const auto watch = [&] { wasSeen = wasSeen || (result().isVisible() && tooth->picture() == before); };
    QTimer often;
    QObject::connect(&often, &QTimer::timeout, &often, watch);
    often.start(1);
    finish();
    watch();
    ASSERT_TRUE(waitFor([&] { return tooth->isDrawn() && !tooth->picture().isNull(); }));
    EXPECT_FALSE(wasSeen);
    EXPECT_NE(tooth->picture(), before);
}

TEST_F(PracticeTest, TheListTicksWhatIsPassedAndNamesTheNextStep) {
    startWithTooth();
    const auto& all = course::shippedExercises();
    const auto attempt = [&](std::size_t which, const char* passed, double score, school::Milliseconds at) {
        school::Attempt one;
        one.id = school::newId();
        one.exercise = all[which].id;
        one.exerciseHash = one.rubricHash = "a";
        one.device = "pointer";
        one.score = score;
        one.maxScore = one.wholeScore = 100.0;
        one.passed = passed;
        one.began = one.finished = at;
        one.result = "{}";
        school::Store& kept = store();
        kept.see({one.exercise, 1, "a", all[which].exercise.title.at("en"), at, at, {}});
        kept.add(one, {});
    };
    attempt(0, "no", 40.0, 1);
    attempt(0, "yes", 82.0, 2);
    attempt(1, "no", 55.0, 3);
    openExercises();
    auto* list = part<QListWidget>("exercisesList");
    const QString first = inThisLanguage(all[0].exercise.title), second = inThisLanguage(all[1].exercise.title);
    EXPECT_EQ(list->item(0)->text(), QStringLiteral("✓ ") + first + QStringLiteral(" (82 %)"));
    EXPECT_EQ(list->item(1)->text(), second + QStringLiteral(" (55 %)"));
    EXPECT_EQ(list->item(2)->text(), inThisLanguage(all[2].exercise.title));
    auto* next = part<QPushButton>("exercisesNextStep");
    ASSERT_TRUE(next->isVisible());
    EXPECT_EQ(next->text(), QStringLiteral("Next step: ") + second);
    QTest::mouseClick(next, Qt::LeftButton);
    EXPECT_EQ(list->currentRow(), 1);
    ASSERT_TRUE(waitFor([this] { return exercises().isReady(); }));
    EXPECT_EQ(part<QLabel>("exercisesBest")->text(), "Best so far: 55 %. Attempts: 1");
}

TEST_F(PracticeTest, TheCardTellsWhileOneWorksWhatTheScoreTellsAfterwards) {
    makeExercise("one", false, {}, asChannel);
    makeExercise("locked", false, {"depth"}, asChannel);
    startWithTooth();
    openExercises();
    begin("one");
    EXPECT_TRUE(part<QLabel>("exerciseUndo")->isVisible()) << "what undo does is said";
    EXPECT_TRUE(action("actionZones")->isChecked()) << "what is asked is seen from the beginning";
    std::vector<course::LiveValue> last;
    QObject::connect(window().findChild<LiveZones*>(), &LiveZones::valued, &window(),
                     [&](const std::vector<course::LiveValue>& values) { last = values; });
    ASSERT_TRUE(cut());
    ASSERT_TRUE(waitFor([&] { return !last.empty() && last.front().value; }));
    EXPECT_TRUE(part<LiveCard>("liveCard")->isVisible());
    QTest::qWait(2500);
    const std::vector<course::LiveValue> told = last;
    finish();
    for (const course::LiveValue& one : told)
        for (const score::CriterionScore& c : result().shown()->work.result.assessment.criteria)
            EXPECT_TRUE(c.id != one.criterion || one.value == c.value) << c.id;
    openExercises();
    begin("locked");
    last.clear();
    ASSERT_TRUE(cut());
    QTest::qWait(1500);
    EXPECT_TRUE(last.empty()) << "depths are withheld";
    EXPECT_FALSE(part<LiveCard>("liveCard")->isVisible());
}

}  // namespace
}  // namespace handpiece::desktop::said_window_test
