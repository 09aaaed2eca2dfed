// SPDX-License-Identifier: Apache-2.0
// The teacher's marking desk, by clicks: a folder is scored, sorted, filtered, opened in the picture, overridden with a
// reason, commented, exported; blind with one's own marks first; gone on with.
#include <QCheckBox>
#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QProgressBar>
#include <QPushButton>
#include <QTabWidget>
#include <QTableView>
#include <QToolButton>
#include <QTreeWidget>
#include <set>

#include "desktop/features/marking/agreement_page.h"
#include "desktop/features/marking/sheet_panel.h"
#include "handpiece/app/assessment/marks.h"
#include "handpiece/app/marking/returned_marks.h"
#include "handpiece/model/case/attempt.h"
#include "marking_support.h"

namespace handpiece::desktop::marking_window_test {
namespace {

namespace fs = std::filesystem;

TEST_F(MarkingTest, AFolderIsScoredLookedAtOverriddenAndExported) {
    makeWork();
    begin(QStringLiteral("Tanaka"), false);
    ASSERT_NE(feature().desk(), nullptr);
    ASSERT_EQ(rows(), 4);
    EXPECT_FALSE(part<QProgressBar>("markingProgress")->isVisible());
    const int first = rowOf("S-07-first.handpiece"), second = rowOf("S-08-second.handpiece"),
              session = rowOf("S-09.h5"), broken = rowOf("broken.handpiece");
    ASSERT_GE(std::min({first, second, session, broken}), 0);
    EXPECT_FALSE(table()->model()->index(first, 0).data(Qt::DecorationRole).value<QPixmap>().isNull());
    EXPECT_TRUE(cell(broken, WorkTable::kFlags).contains("not scored"));
    EXPECT_FALSE(cell(broken, WorkTable::kState).isEmpty());
    EXPECT_TRUE(cell(first, WorkTable::kFlags).contains("unproven"));
    EXPECT_FALSE(cell(session, WorkTable::kFlags).contains("unproven")) << "cut again, to the same tooth";
    EXPECT_EQ(cell(second, WorkTable::kScore), cell(session, WorkTable::kScore)) << "one tooth, two files";
    EXPECT_NE(cell(first, WorkTable::kScore), cell(second, WorkTable::kScore));
    keep(part<QDialog>("markingDesk"), "desk.png");
    // Sorted by score, both ways.
    sortBy(WorkTable::kScore);
    const QString end = cell(0, WorkTable::kFile);
    sortBy(WorkTable::kScore);
    EXPECT_NE(cell(0, WorkTable::kFile), end);
    EXPECT_EQ(cell(3, WorkTable::kFile), end);
    // Filtered.
    click("markingProblem");
    EXPECT_EQ(rows(), 1);
    click("markingUnproven");
    EXPECT_EQ(rows(), 3);
    click("markingProblem");
    click("markingUnproven");
    ASSERT_EQ(rows(), 4);

    // Opened in the picture.
    openRow(rowOf("S-08-second.handpiece"));
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::review && !simulator().isBusy(); }));
    EXPECT_GT(removedMm3(), 0.0);
    ASSERT_TRUE(part<QDockWidget>("markingDock")->isVisible());
    const std::string code = part<SheetPanel>("markingSheet")->code().toStdString();
    const double before = desk().finalScore(code)->score;
    // An override needs a reason.
    chooseCriterion(0);
    setPoints(12.5);
    EXPECT_FALSE(part<QPushButton>("sheetSay")->isEnabled());
    type("sheetReason", QStringLiteral("   "));
    EXPECT_FALSE(part<QPushButton>("sheetSay")->isEnabled());
    type("sheetReason", QStringLiteral("ragged margins"));
    click("sheetSay");
    ASSERT_EQ(desk().sheet(code).overrides.size(), 1u);
    EXPECT_EQ(desk().sheet(code).overrides.at("enamel").reason, "ragged margins");
    EXPECT_NEAR(desk().finalScore(code)->score, 12.5 + *desk().finalScore(code)->criteria[1].points, 1e-9);
    EXPECT_DOUBLE_EQ(desk().machine(code)->assessment.score, before) << "the machine's stands beside";
    EXPECT_TRUE(part<QLabel>("sheetSummary")->text().contains("12.5") ||
                part<QTreeWidget>("sheetCriteria")->topLevelItem(0)->text(2).contains("12.5"));
    keep(&window(), "sheet.png");
    // A comment at the tooth in the middle of the picture.
    type("sheetComment", QStringLiteral("look here"));
    click("sheetCommentPlace");
    click("sheetCommentAdd");
    ASSERT_EQ(desk().sheet(code).comments.size(), 1u);
    const marking::Comment comment = desk().sheet(code).comments[0];
    EXPECT_EQ(comment.criterion, "enamel");
    ASSERT_TRUE(comment.placeMm);
    EXPECT_GT(comment.placeMm->z(), 4.0) << "of the top of the egg";
    // A click on it brings the eye there.
    view()->showStandardView(view::StandardView::buccal);
    auto* list = part<QListWidget>("sheetComments");
    QTest::mouseClick(list->viewport(), Qt::LeftButton, Qt::NoModifier, list->visualItemRect(list->item(0)).center());
    EXPECT_LT((view()->camera().targetMm - *comment.placeMm).norm(), 1e-9);
    // Another where one clicks in the picture, off the middle; a click beside the tooth is none.
    view()->showStandardView(view::StandardView::occlusal);
    click("sheetCommentPick");
    QTest::mouseClick(view(), Qt::LeftButton, Qt::NoModifier, QPoint(4, view()->height() / 2));
    EXPECT_TRUE(part<QPushButton>("sheetCommentPick")->isChecked()) << "there is no tooth";
    const QPoint aside = view()->rect().center() + QPoint(view()->width() / 10, view()->width() / 16);
    const view::Ray ray =
        view::rayThrough(view()->camera(), {view()->width(), view()->height()}, core::Vec2(aside.x(), aside.y()));
    QTest::mouseClick(view(), Qt::LeftButton, Qt::NoModifier, aside);
    EXPECT_FALSE(part<QPushButton>("sheetCommentPick")->isChecked());
    type("sheetComment", QStringLiteral("and here"));
    click("sheetCommentAdd");
    ASSERT_EQ(desk().sheet(code).comments.size(), 2u);
    const marking::Comment pinned = desk().sheet(code).comments[1];
    ASSERT_TRUE(pinned.placeMm);
    const core::Vec3 off = *pinned.placeMm - ray.originMm;
    EXPECT_LT((off - off.dot(ray.direction) * ray.direction).norm(), 1e-6) << "under the pointer";
    EXPECT_GT((*pinned.placeMm - *comment.placeMm).norm(), 0.5);
    // Who passes.
    QTest::keyClick(part<QComboBox>("sheetDecision"), Qt::Key_Down);
    EXPECT_FALSE(part<QPushButton>("sheetDecide")->isEnabled());
    type("sheetDecisionReason", QStringLiteral("good enough"));
    click("sheetDecide");
    EXPECT_EQ(desk().passed(code), score::Passed::yes);

    EXPECT_FALSE(part<QLabel>("sheetNotShown")->isVisible());

    // To the recording, by next or previous; evidence of time stands in it.
    const int from = rowOf("S-08-second.handpiece"), to = rowOf("S-09.h5");
    ASSERT_EQ(std::abs(from - to), 1) << "of equal score before the override, so side by side";
    click(to > from ? "sheetNext" : "sheetPrevious");
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay && !simulator().isBusy(); }));
    ASSERT_TRUE(waitFor([this] {
        return simulator().replay() && simulator().replay()->now().timeS > simulator().replay()->durationS() - 0.01;
    })) << "it shows how it ended";
    EXPECT_TRUE(part<QCheckBox>("sheetCommentTime")->isEnabled());
    click("sheetCommentTime");
    type("sheetComment", QStringLiteral("at the end"));
    click("sheetCommentAdd");
    const std::string other = part<SheetPanel>("markingSheet")->code().toStdString();
    ASSERT_EQ(desk().sheet(other).comments.size(), 1u);
    EXPECT_GT(*desk().sheet(other).comments[0].timeS, 0.1);
    simulator().seek(0.0);
    ASSERT_TRUE(waitFor([this] { return simulator().replay()->now().timeS < 0.01; }));
    QTest::mouseClick(list->viewport(), Qt::LeftButton, Qt::NoModifier, list->visualItemRect(list->item(0)).center());
    EXPECT_TRUE(waitFor(
        [&] { return std::abs(simulator().replay()->now().timeS - *desk().sheet(other).comments[0].timeS) < 0.02; }));

    // What cannot be opened leaves the tooth before in the picture, which is told, and nothing is pinned to it.
    click("sheetTable");
    openRow(rowOf("broken.handpiece"));
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
    window().errorDialog()->reject();
    EXPECT_TRUE(part<QLabel>("sheetNotShown")->isVisible());
    EXPECT_FALSE(part<QPushButton>("sheetCommentPick")->isEnabled());

    // Tables for others.
    const auto written = [this](const char* way, const char* name) {
        file_ = own_.filePath(QLatin1String(name));
        part<QAction>(way)->trigger();
        const auto bytes = core::readFile(toPath(file_));
        return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    const std::string codes = written("markingExport_codes", "codes.csv");
    EXPECT_EQ(codes.find("S-0"), std::string::npos);
    EXPECT_NE(codes.find("ragged margins"), std::string::npos);
    EXPECT_NE(written("markingExport_files", "files.csv").find("S-08-second.handpiece"), std::string::npos);
    const std::string page = written("markingExport_class", "class.html");
    EXPECT_NE(page.find("S-08-second"), std::string::npos);
    EXPECT_NE(page.find("<svg"), std::string::npos);
    EXPECT_EQ(page.find("broken"), std::string::npos) << "it has no score";

    // Back to the student: of the work that is open, and of each that has a score.
    click("sheetTable");
    openRow(rowOf("S-09.h5"));
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay && !simulator().isBusy(); }));
    file_ = own_.filePath("S-09-marks.json");
    click("sheetReturn");
    const auto returned = [](const fs::path& file) {
        const auto bytes = core::readFile(file);
        return marking::parseReturned({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
    };
    const marking::ReturnedMarks alone = returned(toPath(file_));
    EXPECT_EQ(alone.marker, "Tanaka");
    ASSERT_EQ(alone.comments.size(), 1u);
    EXPECT_EQ(alone.comments[0].timeS, desk().sheet(other).comments[0].timeS);
    EXPECT_TRUE(areOf(alone, desk().machine(other)->identity));
    file_ = own_.filePath("given");
    part<QAction>("markingExport_returned")->trigger();
    EXPECT_EQ(std::distance(fs::directory_iterator(at("given")), {}), 3) << "the broken one has no score";
    const marking::ReturnedMarks all = returned(at("given") / "S-08-second-marks.json");
    ASSERT_EQ(all.changes.size(), 1u);
    EXPECT_EQ(all.changes[0].reason, "ragged margins");
    EXPECT_EQ(all.passed, score::Passed::yes);
    EXPECT_EQ(all.comments.size(), 2u);

    // Another start goes on where this one was.
    start();
    begin(QStringLiteral("Tanaka"), false);
    EXPECT_EQ(desk().sheet(code).overrides.at("enamel").points, 12.5);
    EXPECT_EQ(desk().sheet(code).comments.size(), 2u);
    EXPECT_EQ(desk().passed(code), score::Passed::yes);
    // The other kind of marking is another desk.
    begin(QStringLiteral("Tanaka"), true);
    ASSERT_NE(window().errorDialog(), nullptr);
    window().errorDialog()->reject();
}

TEST_F(MarkingTest, WhatIsHalfTypedWaitsWhileAnotherWorkIsLookedAt) {
    makeWork();
    begin(QStringLiteral("Tanaka"), false);
    const auto isOpen = [this] { return simulator().mode() == Simulator::Mode::review && !simulator().isBusy(); };
    openRow(rowOf("S-08-second.handpiece"));
    ASSERT_TRUE(waitFor(isOpen));
    const QString code = part<SheetPanel>("markingSheet")->code();
    const auto shows = [this](double points, const char* reason) {
        return part<QDoubleSpinBox>("sheetPoints")->value() == points &&
               part<QLineEdit>("sheetReason")->text() == QLatin1String(reason);
    };
    chooseCriterion(0);
    setPoints(12.5);
    type("sheetReason", QStringLiteral("ragged"));
    type("sheetComment", QStringLiteral("look"));
    part<QComboBox>("sheetDecision")->setFocus();
    QTest::keyClick(part<QComboBox>("sheetDecision"), Qt::Key_End);
    type("sheetDecisionReason", QStringLiteral("it hurts"));
    // Another criterion of it, and back.
    chooseCriterion(1);
    EXPECT_TRUE(shows(-0.1, ""));
    chooseCriterion(0);
    EXPECT_TRUE(shows(12.5, "ragged"));
    // Another work, and back.
    const bool hasNext = part<QToolButton>("sheetNext")->isEnabled();
    click(hasNext ? "sheetNext" : "sheetPrevious");
    ASSERT_NE(part<SheetPanel>("markingSheet")->code(), code);
    chooseCriterion(0);
    EXPECT_TRUE(shows(-0.1, ""));
    EXPECT_TRUE(part<QLineEdit>("sheetComment")->text().isEmpty());
    EXPECT_EQ(part<QComboBox>("sheetDecision")->currentIndex(), 0);
    ASSERT_TRUE(idle());
    click(hasNext ? "sheetPrevious" : "sheetNext");
    ASSERT_EQ(part<SheetPanel>("markingSheet")->code(), code);
    chooseCriterion(0);
    EXPECT_TRUE(shows(12.5, "ragged"));
    EXPECT_EQ(part<QLineEdit>("sheetComment")->text(), "look");
    EXPECT_EQ(part<QComboBox>("sheetDecision")->currentIndex(), 2);
    EXPECT_EQ(part<QLineEdit>("sheetDecisionReason")->text(), "it hurts");
    EXPECT_TRUE(desk().sheet(code.toStdString()).overrides.empty()) << "nothing is said yet";
    // Said, and taken back: nothing waits any more.
    ASSERT_TRUE(idle());
    click("sheetSay");
    ASSERT_EQ(desk().sheet(code.toStdString()).overrides.size(), 1u);
    click("sheetWithdraw");
    EXPECT_TRUE(shows(-0.1, ""));
    chooseCriterion(1);
    chooseCriterion(0);
    EXPECT_TRUE(shows(-0.1, ""));
}

TEST_F(MarkingTest, BlindOnesOwnMarksComeFirst) {
    makeWork();
    fs::remove(works() / "broken.handpiece");
    begin(QStringLiteral("Sato"), true);
    ASSERT_EQ(rows(), 4) << "three works, one of them twice";
    for (int row = 0; row < 4; ++row) {
        EXPECT_EQ(cell(row, WorkTable::kFile), "hidden");
        EXPECT_TRUE(table()->model()->index(row, 0).data(Qt::DecorationRole).isNull()) << "equal pictures would tell";
        for (const int column : {WorkTable::kScore, WorkTable::kMachine, WorkTable::kPassed, WorkTable::kFlags})
            EXPECT_EQ(cell(row, column), "") << "the machine's score is hidden";
    }
    keep(part<QDialog>("markingDesk"), "blind.png");
    openRow(0);
    std::set<std::string> marked;
    for (int i = 0; i < 4; ++i) {
        ASSERT_TRUE(waitFor([this] {
            return !simulator().isBusy() &&
                   (simulator().mode() == Simulator::Mode::review || simulator().mode() == Simulator::Mode::replay);
        }));
        const QString code = part<SheetPanel>("markingSheet")->code();
        ASSERT_TRUE(waitFor([&] { return window().windowTitle().contains(code); }))
            << window().windowTitle().toStdString();
        EXPECT_FALSE(window().windowTitle().contains("S-0")) << "nor does the title say whose it is";
        if (simulator().mode() == Simulator::Mode::review) {
            EXPECT_EQ(simulator().reviewed().student, "");
        }
        ASSERT_TRUE(marked.insert(code.toStdString()).second);
        EXPECT_TRUE(part<QLabel>("sheetSummary")->text().contains("hidden"));
        auto* tree = part<QTreeWidget>("sheetCriteria");
        ASSERT_EQ(tree->topLevelItemCount(), 3);
        EXPECT_TRUE(tree->isColumnHidden(2) && tree->isColumnHidden(3) && tree->isColumnHidden(4));
        if (i == 0) keep(&window(), "blind-sheet.png");
        EXPECT_FALSE(part<QPushButton>("sheetGiveIn")->isEnabled());
        chooseCriterion(0);
        chooseBand(1 + i % 2);
        click("sheetSay");
        chooseCriterion(1);
        setPoints(15);
        click("sheetSay");
        EXPECT_FALSE(part<QPushButton>("sheetGiveIn")->isEnabled()) << "all points together are missing";
        chooseCriterion(2);
        setPoints(60 + i);
        click("sheetSay");
        click("sheetGiveIn");
        EXPECT_TRUE(desk().sheet(code.toStdString()).isIn);
        if (i < 3) click("sheetNext");
    }
    ASSERT_TRUE(desk().areAllIn());
    for (const std::string& code : desk().codes())
        EXPECT_NE(desk().machine(code), nullptr);
    EXPECT_EQ(part<QTreeWidget>("sheetCriteria")->isColumnHidden(4), false);
    click("sheetTable");
    for (int row = 0; row < 4; ++row)
        EXPECT_NE(cell(row, WorkTable::kFile), "hidden");
    // Agreement with pictures.
    auto* tabs = part<QTabWidget>("markingTabs");
    QTest::mouseClick(tabs->tabBar(), Qt::LeftButton, Qt::NoModifier, tabs->tabBar()->tabRect(2).center());
    ASSERT_TRUE(waitFor([this] { return part<QTreeWidget>("agreementTable")->topLevelItemCount() == 3; }));
    EXPECT_GT(part<QComboBox>("agreementPicture")->count(), 0);
    EXPECT_TRUE(part<SvgView>("agreementPlot")->hasPicture());
    keep(part<QDialog>("markingDesk"), "agreement.png");
    file_ = own_.filePath("marks.csv");
    part<QAction>("markingExport_marks")->trigger();
    EXPECT_EQ(assessment::readMarks(toPath(file_)).size(), 3u);
    file_ = own_.filePath("agreement");
    part<QAction>("markingExport_agreement")->trigger();
    EXPECT_TRUE(fs::exists(toPath(file_) / "agreement.json"));
    EXPECT_TRUE(fs::exists(toPath(file_) / "01.svg"));
}

/// Twelve works, one that is broken and one that came twice, on a school's screen: every press lies on what is seen.
class ManyWorks : public MarkingTest {
  protected:
    static constexpr int kWorks = 12;
    void makeMany() {
        makeExercise();
        CommandLine line;
        line.file = toQString(exercise() / "case");
        startWithTooth(line);
        for (int i = 1; i <= kWorks; ++i) {
            ASSERT_TRUE(cut());
            save(("S-" + std::to_string(100 + i) + ".handpiece").c_str());
        }
        simulator().close();
        fs::copy_file(works() / "S-103.handpiece", works() / "S-999-again.handpiece");
        core::writeFile(works() / "broken.handpiece", std::string_view("no zip"));
        window().resize(1366, 768);
    }
    /// At this place of a widget, where nothing lies over it.
    void pressOn(QWidget* widget, const QPoint& at) {
        ASSERT_TRUE(waitFor([&] { return widget->isVisible() && widget->isEnabled(); }))
            << widget->objectName().toStdString();
        const QWidget* seen = widget->window()->childAt(widget->mapTo(widget->window(), at));
        ASSERT_TRUE(seen == widget || widget->isAncestorOf(seen))
            << widget->objectName().toStdString() << " is not seen, but "
            << (seen != nullptr ? seen->objectName().toStdString() : "nothing");
        QTest::mouseClick(widget, Qt::LeftButton, Qt::NoModifier, at);
    }
    void pressOn(const char* name) {
        auto* widget = part<QWidget>(name);
        ASSERT_NO_FATAL_FAILURE(pressOn(widget, QPoint(8, widget->height() / 2)));
    }
    /// A criterion, by its row in the tree.
    void pressRow(int row) {
        auto* tree = part<QTreeWidget>("sheetCriteria");
        const QRect place = tree->visualItemRect(tree->topLevelItem(row));
        ASSERT_TRUE(tree->viewport()->rect().contains(place.center())) << "of few criteria none is out of sight";
        ASSERT_NO_FATAL_FAILURE(pressOn(tree->viewport(), QPoint(place.left() + 8, place.center().y())));
        ASSERT_EQ(tree->currentItem(), tree->topLevelItem(row));
    }
    [[nodiscard]] QString summary() { return part<QLabel>("sheetSummary")->text(); }
};

class ManyWorksBlind : public ManyWorks, public ::testing::WithParamInterface<bool> {};

/// In one start of the program, and in two.
TEST_P(ManyWorksBlind, TwelveAreMarkedToTheEnd) {
    const bool startsAnew = GetParam();
    makeMany();
    begin(QStringLiteral("Sato"), true);
    constexpr int kRows = kWorks + 2 + 1;  // one of them twice
    ASSERT_EQ(rows(), kRows);
    // Nothing tells whose a work is or which come twice: no picture, no name of a file, also of what is broken.
    int problems = 0;
    for (int row = 0; row < kRows; ++row) {
        EXPECT_EQ(cell(row, WorkTable::kFile), "hidden");
        EXPECT_TRUE(table()->model()->index(row, 0).data(Qt::DecorationRole).isNull());
        const QString state = cell(row, WorkTable::kState);
        EXPECT_FALSE(state.contains("S-") || state.contains("broken") || state.contains("same") ||
                     state.contains(QLatin1Char('/')))
            << state.toStdString();
        problems += cell(row, WorkTable::kFlags).isEmpty() ? 0 : 1;
    }
    EXPECT_GE(problems, 2);
    EXPECT_GE(table()->viewport()->height(), 12 * table()->rowHeight(0)) << "a dozen is seen at once";
    EXPECT_TRUE(part<QLabel>("markingCount")->text().contains("0 of 15"));
    const QRect first = table()->visualRect(table()->model()->index(0, 0));
    ASSERT_NO_FATAL_FAILURE(pressOn(table()->viewport(), first.center()));
    ASSERT_NO_FATAL_FAILURE(pressOn("markingOpen"));
    std::set<std::string> done;
    for (int i = 0; i < kRows; ++i) {
        const QString code = part<SheetPanel>("markingSheet")->code();
        ASSERT_TRUE(done.insert(code.toStdString()).second) << "one comes again before all were seen";
        const bool isBad = desk().error(code.toStdString()).has_value();
        const auto isThere = [&] {
            return window().errorDialog() != nullptr ||
                   (!simulator().isBusy() && !part<QLabel>("sheetNotShown")->isVisible());
        };
        if (i == 1 && !isBad) {
            // Marks may begin before the tooth has come, which takes no key from them.
            ASSERT_NO_FATAL_FAILURE(pressRow(0));
            ASSERT_TRUE(waitFor(isThere));
            EXPECT_TRUE(part<QTreeWidget>("sheetCriteria")->hasFocus());
        }
        ASSERT_TRUE(waitFor(isThere));
        if (auto* error = window().errorDialog()) {
            EXPECT_TRUE(isBad);
            EXPECT_TRUE(error->problem().what.contains(code)) << error->problem().what.toStdString();
            EXPECT_FALSE(error->problem().what.contains("broken") || error->problem().where.contains("broken"));
            error->reject();
            ASSERT_TRUE(waitFor([this] { return window().errorDialog() == nullptr; }));
        }
        if (startsAnew && i == 5) {
            // In the middle the program ends and begins again.
            start();
            window().resize(1366, 768);
            begin(QStringLiteral("Sato"), true);
            EXPECT_TRUE(part<QLabel>("markingCount")->text().contains("5 of 15"));
            for (int row = 0; row < kRows; ++row)
                if (cell(row, WorkTable::kCode) == code) {
                    table()->scrollTo(table()->model()->index(row, 0));
                    openRow(row);
                }
            ASSERT_EQ(part<SheetPanel>("markingSheet")->code(), code);
            ASSERT_TRUE(waitFor([this] {
                return window().errorDialog() != nullptr ||
                       (!simulator().isBusy() && !part<QLabel>("sheetNotShown")->isVisible());
            }));
            if (auto* error = window().errorDialog()) {
                error->reject();
                ASSERT_TRUE(waitFor([this] { return window().errorDialog() == nullptr; }));
            }
        }
        EXPECT_TRUE(summary().contains(isBad ? "cannot be scored" : "hidden")) << summary().toStdString();
        if (!isBad) {
            EXPECT_FALSE(part<QPushButton>("sheetGiveIn")->isEnabled());
            ASSERT_NO_FATAL_FAILURE(pressRow(0));
            chooseBand(1 + (i % 5 == 0 ? 1 : 0));
            ASSERT_NO_FATAL_FAILURE(pressOn("sheetSay"));
            ASSERT_NO_FATAL_FAILURE(pressRow(1));
            setPoints(15);
            ASSERT_NO_FATAL_FAILURE(pressOn("sheetSay"));
            ASSERT_NO_FATAL_FAILURE(pressRow(2));
            setPoints(40 + 3 * i);
            ASSERT_NO_FATAL_FAILURE(pressOn("sheetSay"));
        }
        ASSERT_NO_FATAL_FAILURE(pressOn("sheetGiveIn"));
        ASSERT_TRUE(desk().sheet(code.toStdString()).isIn);
        if (i + 1 < kRows) {
            EXPECT_FALSE(desk().areAllIn());
            EXPECT_TRUE(summary().contains(QStringLiteral("marked: %1.").arg(kRows - i - 1)))
                << summary().toStdString();
            ASSERT_NO_FATAL_FAILURE(pressOn("sheetNext"));
        }
    }
    ASSERT_TRUE(desk().areAllIn());
    EXPECT_FALSE(part<QToolButton>("sheetNext")->isEnabled());
    ASSERT_NO_FATAL_FAILURE(pressOn("sheetTable"));
    int again = 0;
    for (int row = 0; row < kRows; ++row) {
        EXPECT_NE(cell(row, WorkTable::kFile), "hidden");
        const std::string code = cell(row, WorkTable::kCode).toStdString();
        const bool isRepeat = desk().isRepeat(code);
        again += isRepeat ? 1 : 0;
        // What is wrong with a work, which may be drawn as well, stands in the place of that.
        if (!desk().error(code)) {
            EXPECT_EQ(cell(row, WorkTable::kState).contains("second time"), isRepeat);
        }
    }
    EXPECT_EQ(again, 1) << "a tenth of fourteen";
    const int twin = rowOf("S-999-again.handpiece");
    ASSERT_GE(twin, 0);
    EXPECT_TRUE(cell(twin, WorkTable::kState).contains("S-103.handpiece")) << "now it is told whose it is the same as";
    // How far marker and machine agree: each criterion, every coefficient, every plot.
    auto* tabs = part<QTabWidget>("markingTabs");
    ASSERT_NO_FATAL_FAILURE(pressOn(tabs->tabBar(), tabs->tabBar()->tabRect(2).center()));
    auto* tree = part<QTreeWidget>("agreementTable");
    ASSERT_TRUE(waitFor([&] { return tree->topLevelItemCount() == 3; }));
    EXPECT_EQ(tree->topLevelItem(0)->text(0), "enamel taken") << "in words, not by its id";
    EXPECT_EQ(tree->topLevelItem(2)->text(0), "all points together");
    std::set<QString> coefficients;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < tree->topLevelItem(i)->childCount(); ++k)
            coefficients.insert(tree->topLevelItem(i)->child(k)->text(2));
    EXPECT_EQ(coefficients,
              (std::set<QString>{"weighted kappa", "bias, limits of agreement", "ICC(2,1)", "Krippendorff's alpha"}));
    auto* pictures = part<QComboBox>("agreementPicture");
    ASSERT_GE(pictures->count(), 2);
    pictures->setFocus();
    QTest::keyClick(pictures, Qt::Key_Home);
    for (int i = 0; i < pictures->count(); ++i) {
        EXPECT_EQ(pictures->currentIndex(), i);
        EXPECT_TRUE(part<SvgView>("agreementPlot")->hasPicture()) << pictures->currentText().toStdString();
        QTest::keyClick(pictures, Qt::Key_Down);
    }
    keep(part<QDialog>("markingDesk"), "agreement-twelve.png");
}

INSTANTIATE_TEST_SUITE_P(Starts, ManyWorksBlind, ::testing::Bool(),
                         [](const auto& of) { return of.param ? "Two" : "One"; });

TEST_F(MarkingTest, AnotherStartFindsTheFolderAgainAndAnotherFolderItsOwnExercise) {
    makeWork();
    begin(QStringLiteral("Sato"), true);
    const std::vector<std::string> codes = desk().codes();
    start();  // as after a change of the language
    action("actionMarkingDesk")->trigger();
    EXPECT_EQ(part<QLineEdit>("markingFolder")->text(), toQString(works()));
    EXPECT_EQ(part<QLineEdit>("markingExercise")->text(), toQString(exercise()));
    EXPECT_EQ(part<QLineEdit>("markingMarker")->text(), "Sato");
    EXPECT_TRUE(part<QCheckBox>("markingBlind")->isChecked());
    click("markingBegin");
    ASSERT_TRUE(waitFor([this] { return feature().desk() != nullptr && !feature().isAtWork(); }));
    EXPECT_EQ(window().errorDialog(), nullptr);
    EXPECT_EQ(desk().codes(), codes);
    // Work of another exercise, which came along with it.
    fs::create_directories(at("other"));
    fs::copy(exercise(), at("other") / "exercise", fs::copy_options::recursive);
    fs::copy_file(works() / "S-07-first.handpiece", at("other") / "S-01.handpiece");
    drop(own_.filePath("other"));
    EXPECT_EQ(part<QLineEdit>("markingFolder")->text(), own_.filePath("other"));
    EXPECT_TRUE(part<QLineEdit>("markingExercise")->text().endsWith("other/exercise"));
}

TEST_F(MarkingTest, AFolderIsDroppedAndScoringIsCancelled) {
    makeWork();
    fs::copy(at("exercise"), works() / "exercise", fs::copy_options::recursive);
    drop(own_.filePath("works"));
    ASSERT_TRUE(part<QDialog>("markingDesk")->isVisible());
    EXPECT_EQ(part<QLineEdit>("markingFolder")->text(), own_.filePath("works"));
    EXPECT_TRUE(part<QLineEdit>("markingExercise")->text().endsWith("works/exercise")) << "it came along";
    EXPECT_FALSE(part<QPushButton>("markingBegin")->isEnabled()) << "nobody marks without a name";
    type("markingMarker", QStringLiteral("T"));
    click("markingBegin");
    ASSERT_TRUE(waitFor([this] { return feature().desk() != nullptr && feature().isAtWork(); }));
    click("markingCancel");
    ASSERT_TRUE(waitFor([this] { return !feature().isAtWork(); }));
    EXPECT_TRUE(part<QLabel>("markingNote")->text().contains("Cancelled"));
    click("markingScore");
    ASSERT_TRUE(waitFor([this] { return !feature().isAtWork(); }));
    ASSERT_TRUE(
        waitFor([this] { return rowOf("S-09.h5") >= 0 && !cell(rowOf("S-09.h5"), WorkTable::kScore).isEmpty(); }));
    // What is wrong is told, and nothing is open.
    type("markingExercise", own_.filePath("none"));
    part<QTabWidget>("markingTabs")->setCurrentIndex(0);
    type("markingExercise", own_.filePath("none"));
    click("markingBegin");
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
    window().errorDialog()->reject();
}

}  // namespace
}  // namespace handpiece::desktop::marking_window_test
