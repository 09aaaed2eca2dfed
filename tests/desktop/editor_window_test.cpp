// SPDX-License-Identifier: Apache-2.0
// The teacher's exercise editor by clicks: from an empty draft to a file that a student opens.
#include <QCheckBox>
#include <QComboBox>
#include <QDir>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QSpinBox>
#include <QTabWidget>
#include <QTableWidget>
#include <set>

#include "desktop/features/editor/curve_view.h"
#include "desktop/features/editor/editor_dialog.h"
#include "desktop/features/editor/editor_feature.h"
#include "desktop/features/editor/editor_pages.h"
#include "desktop/picture/solid_view.h"
#include "shell_support.h"

namespace handpiece::desktop {
namespace {

class EditorTest : public ShellTest {
  protected:
    [[nodiscard]] EditorFeature& feature() { return *window().findChild<EditorFeature*>(); }
    [[nodiscard]] EditorDialog& editor() { return *feature().dialog(); }
    [[nodiscard]] const draft::Content& now() { return editor().draft().now(); }
    template <class W>
    [[nodiscard]] W* part(const char* name) {
        W* found = editor().findChild<W*>(QLatin1String(name));
        EXPECT_TRUE(found) << name;
        return found;
    }
    void press(const char* name) {
        auto* button = part<QPushButton>(name);
        ASSERT_TRUE(button->isEnabled()) << name;
        QTest::mouseClick(button, Qt::LeftButton);
    }
    void page(int index) { part<QTabWidget>("editorTabs")->setCurrentIndex(index); }
    /// By keys, as a person goes through a list.
    void choose(const char* name, int index) {
        auto* box = part<QComboBox>(name);
        ASSERT_GE(index, 0);
        box->setFocus();
        QTest::keyClick(box, Qt::Key_Home);
        for (int i = 0; i < index; ++i)
            QTest::keyClick(box, Qt::Key_Down);
        ASSERT_EQ(box->currentIndex(), index);
    }
    void type(QWidget* field, const QString& text) {
        field->setFocus();
        QTest::keyClick(field, Qt::Key_A, Qt::ControlModifier);
        QTest::keyClicks(field, text);
        QTest::keyClick(field, Qt::Key_Tab);
    }
    void tick(const char* list, const char* data) {
        auto* of = part<QListWidget>(list);
        for (int i = 0; i < of->count(); ++i)
            if (of->item(i)->data(Qt::UserRole).toString() == QLatin1String(data)) {
                of->scrollToItem(of->item(i));
                of->setCurrentRow(i);
                QTest::keyClick(of, Qt::Key_Space);
                return;
            }
        ADD_FAILURE() << data;
    }
    void cell(int row, int column, const QString& text) {
        auto* table = part<QTableWidget>("editorCriteria");
        // The line of the cell before.
        QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
        table->scrollToItem(table->item(row, column));
        table->setCurrentCell(row, column);
        table->editItem(table->item(row, column));
        auto* line = table->viewport()->findChild<QLineEdit*>();
        ASSERT_TRUE(line);
        line->selectAll();
        QTest::keyClicks(line, text);
        QTest::keyClick(line, Qt::Key_Return);
        QCoreApplication::processEvents();  // the table takes it then
    }
    [[nodiscard]] QString atRow(int row) { return part<QTableWidget>("editorCriteria")->item(row, 10)->text(); }
    [[nodiscard]] bool settled() {
        return waitFor([this] { return !feature().isBusy(); });
    }
    [[nodiscard]] bool hasErrors() { return draft::hasErrors(editor().problems()); }
    void look(const char* name) {
        const QString folder = qEnvironmentVariable("HANDPIECE_EDITOR_PICTURES");
        if (folder.isEmpty()) return;
        QCoreApplication::processEvents();
        EXPECT_TRUE(editor().grab().save(QDir(folder).filePath(QLatin1String(name) + QStringLiteral(".png"))));
    }
    void beginBlock() {
        action("actionNewExercise")->trigger();
        ASSERT_TRUE(editor().isVisible());
        press("editorTakeBlock");
        ASSERT_TRUE(waitFor([this] { return now().tooth != nullptr; }));
    }
};

TEST_F(EditorTest, FromNothingToAFileThatAStudentOpens) {
    startWithTooth();
    action("actionNewExercise")->trigger();
    EXPECT_TRUE(hasErrors()) << "no tooth yet";
    EXPECT_FALSE(part<QPushButton>("editorTry")->isEnabled());
    EXPECT_FALSE(part<QPushButton>("editorSaveAs")->isEnabled());
    look("tooth");
    press("editorTakeBlock");
    ASSERT_TRUE(waitFor([this] { return now().tooth != nullptr; }));

    page(1);
    choose("editorTemplate", part<QComboBox>("editorTemplate")->findData("block-cross"));
    ASSERT_TRUE(now().preparation);
    EXPECT_EQ(now().rubric->id, "dexterity-cross") << "the rubric that comes along";
    EXPECT_TRUE(part<QComboBox>("editorSide")->isHidden());
    type(part<QDoubleSpinBox>("editorNumber_depth_mm"), "1.80");
    EXPECT_DOUBLE_EQ(now().preparation->number("depth_mm"), 1.8);
    type(part<QDoubleSpinBox>("editorLeewaySide"), "0.35");
    EXPECT_DOUBLE_EQ(now().preparation->leeway.sideMm, 0.35);
    ASSERT_TRUE(settled());
    press("editorShowIdeal");
    ASSERT_TRUE(waitFor([this] { return !feature().isBusy() && part<SolidView>("editorPicture")->isDrawn(); }));
    look("preparation");

    page(2);
    choose("editorBur", part<QComboBox>("editorBur")->findData("330"));
    tick("editorBurs", "330");
    tick("editorBurs", "245");
    tick("editorHelps", "undo");
    QTest::mouseClick(part<QCheckBox>("editorTimed"), Qt::LeftButton, Qt::NoModifier, QPoint(8, 8));
    type(part<QDoubleSpinBox>("editorMinutes"), "12");
    for (const char* box : {"editorHardLimit", "editorLiveBar"})
        QTest::mouseClick(part<QCheckBox>(box), Qt::LeftButton, Qt::NoModifier, QPoint(8, 8));
    choose("editorLevel", 2);
    press("editorTakeView");
    ASSERT_TRUE(now().exercise.view);
    EXPECT_EQ(now().exercise.view->eyeMm, view()->camera().eyeMm);
    look("work");

    page(4);
    type(part<QLineEdit>("editorId"), "cross-of-mine");
    type(part<QLineEdit>("editorTitleEn"), "Cross");
    part<QLineEdit>("editorTitleJa")->setFocus();
    part<QLineEdit>("editorTitleJa")->insert(QStringLiteral("十字"));
    emit part<QLineEdit>("editorTitleJa")->textEdited(QStringLiteral("十字"));
    QTest::keyClicks(part<QPlainTextEdit>("editorInstructionsEn"), "Cut a cross.");
    look("texts");
    ASSERT_TRUE(settled());
    EXPECT_FALSE(hasErrors());
    EXPECT_TRUE(editor().draft().isUnsaved());

    file_ = own_.filePath("cross.handpiece");
    press("editorSaveAs");
    EXPECT_FALSE(editor().draft().isUnsaved());
    const tasks::Task saved = tasks::readTask(toPath(file_));
    EXPECT_EQ(saved.id, "cross-of-mine");
    EXPECT_EQ(saved.minutes, 12.0);
    EXPECT_TRUE(saved.isTimeHard);
    EXPECT_TRUE(saved.hasLiveBar);
    EXPECT_EQ(saved.level, "basic");
    EXPECT_TRUE(draft::contentOf(saved).isTimeHard && draft::contentOf(saved).hasLiveBar) << "kept when edited again";
    EXPECT_DOUBLE_EQ(saved.preparation->number("depth_mm"), 1.8);
    EXPECT_EQ(saved.rubric, rubric::shippedRubricText("dexterity-cross"));
    const cases::Exercise& exercise = *saved.toothCase.exercise;
    EXPECT_EQ(exercise.bur, "330");
    EXPECT_EQ(std::set<std::string>(exercise.allowedBurs.begin(), exercise.allowedBurs.end()),
              (std::set<std::string>{"245", "330"}));
    EXPECT_EQ(exercise.lockedHelps, std::vector<std::string>{"undo"});
    EXPECT_EQ(exercise.title.at("ja"), "十字");
    EXPECT_EQ(exercise.instructions.at("en"), "Cut a cross.");

    ASSERT_TRUE(settled());
    press("editorTry");
    ASSERT_TRUE(waitFor([this] { return simulator().task() && !simulator().isBusy(); }));
    EXPECT_EQ(simulator().task()->id, "cross-of-mine");
    EXPECT_EQ(simulator().burName(), "330");
    EXPECT_TRUE(simulator().permissions().locks(exercise::Operation::undo));
}

TEST_F(EditorTest, NumbersAreDraggedByHandlesInThePicture) {
    startWithTooth();
    beginBlock();
    page(1);
    choose("editorTemplate", part<QComboBox>("editorTemplate")->findData("block-cross"));
    ASSERT_TRUE(settled());
    auto* picture = part<SolidView>("editorPicture");
    const PreparationPage& shown = *editor().preparationPage();
    ASSERT_EQ(shown.handles().size(), 3u);
    ASSERT_TRUE(waitFor([&] { return picture->isDrawn(); }));
    EXPECT_GT(shown.glass().surfaces().size(), 0u);
    look("handles");
    const auto handleOf = [&](std::string_view number) {
        for (std::size_t i = 0; i < shown.handles().size(); ++i)
            if (shown.handles()[i].number == number) return static_cast<int>(i);
        return -1;
    };
    // By the pointer, as far as `mm` along the handle's way; the button stays down unless it is let go.
    const auto drag = [&](std::string_view number, double mm, bool isLetGo) {
        const int handle = handleOf(number);
        ASSERT_GE(handle, 0);
        const draft::Handle one = shown.handles()[static_cast<std::size_t>(handle)];
        const view::Viewport port{picture->width(), picture->height()};
        const auto pixel = [&](const core::Vec3& place) {
            const auto at = view::pixelOf(picture->camera(), port, place);
            return QPoint(static_cast<int>(std::lround(at->x())), static_cast<int>(std::lround(at->y())));
        };
        const QPoint from = pixel(one.placeMm), to = pixel(one.placeMm + mm * one.way);
        ASSERT_GT((to - from).manhattanLength(), 4);
        QTest::mousePress(picture, Qt::LeftButton, Qt::NoModifier, from);
        for (const double share : {0.3, 0.7, 1.0}) {
            const QPointF at = QPointF(from) + share * QPointF(to - from);
            QMouseEvent move(QEvent::MouseMove, at, picture->mapToGlobal(at), Qt::NoButton, Qt::LeftButton,
                             Qt::NoModifier);
            QApplication::sendEvent(picture, &move);
        }
        EXPECT_TRUE(picture->isDragging());
        if (isLetGo) QTest::mouseRelease(picture, Qt::LeftButton, Qt::NoModifier, to);
    };
    const double before = now().preparation->number("width_mm");
    auto* field = part<QDoubleSpinBox>("editorNumber_width_mm");
    // While it is held only field and glass follow; Escape gives it up.
    drag("width_mm", 0.6, false);
    EXPECT_NEAR(field->value(), before + 1.2, 0.15);
    EXPECT_EQ(now().preparation->number("width_mm"), before) << "no step of the draft yet";
    ASSERT_TRUE(waitFor([&] { return shown.glass().recipe().number("width_mm") == field->value(); }))
        << "the glass goes along";
    look("dragging");
    QTest::keyClick(picture, Qt::Key_Escape);
    EXPECT_FALSE(picture->isDragging());
    EXPECT_TRUE(editor().isVisible()) << "Escape was the handle's";
    EXPECT_EQ(field->value(), before);
    ASSERT_TRUE(settled());
    EXPECT_EQ(shown.glass().recipe().number("width_mm"), before);
    // Let go it is one step, on a twentieth of a millimetre.
    drag("width_mm", 0.6, true);
    const double wide = now().preparation->number("width_mm");
    EXPECT_NEAR(wide, before + 1.2, 0.15);
    EXPECT_NEAR(wide / 0.05, std::round(wide / 0.05), 1e-9);
    ASSERT_TRUE(settled());
    // The handle stands on the wall of now.
    const core::Vec3 place = shown.handles()[static_cast<std::size_t>(handleOf("width_mm"))].placeMm;
    EXPECT_NEAR(shown.glass().laid()->zones->targetMm(place), 0.0, 0.01);
    drag("depth_mm", 0.5, true);
    EXPECT_NEAR(now().preparation->number("depth_mm"), 2.0, 0.15);
    ASSERT_TRUE(settled());
    press("editorUndo");
    EXPECT_EQ(now().preparation->number("depth_mm"), 1.5);
    EXPECT_EQ(now().preparation->number("width_mm"), wide);
    press("editorUndo");
    EXPECT_EQ(now().preparation->number("width_mm"), before);
    ASSERT_TRUE(settled());
    // Beside a handle the tooth turns.
    const core::Vec3 eye = picture->camera().eyeMm;
    QTest::mousePress(picture, Qt::LeftButton, Qt::NoModifier, QPoint(12, picture->height() - 60));
    QMouseEvent move(QEvent::MouseMove, QPointF(60, picture->height() - 90.0),
                     picture->mapToGlobal(QPointF(60, picture->height() - 90.0)), Qt::NoButton, Qt::LeftButton,
                     Qt::NoModifier);
    QApplication::sendEvent(picture, &move);
    QTest::mouseRelease(picture, Qt::LeftButton, Qt::NoModifier, QPoint(60, picture->height() - 90));
    EXPECT_GT((picture->camera().eyeMm - eye).norm(), 1.0);
    // The start view can be that of the picture.
    page(2);
    press("editorTakePictureView");
    ASSERT_TRUE(now().exercise.view);
    EXPECT_EQ(now().exercise.view->eyeMm, picture->camera().eyeMm);
    type(part<QDoubleSpinBox>("editorEyeZ"), "55");
    EXPECT_EQ(now().exercise.view->eyeMm.z(), 55.0);
}

TEST_F(EditorTest, AllOfARubricHasItsField) {
    startWithTooth();
    beginBlock();
    page(1);
    choose("editorTemplate", part<QComboBox>("editorTemplate")->findData("block-line"));
    page(3);
    const auto line = [this](const char* name, const QString& text) { type(part<QLineEdit>(name), text); };
    auto* table = part<QTableWidget>("editorCriteria");
    table->setCurrentCell(0, 0);
    const std::string first = now().rubric->criteria[0].id, second = now().rubric->criteria[1].id;
    line("editorDevices", "pointer, haply");
    EXPECT_EQ(now().rubric->criteria[0].devices, (std::vector<std::string>{"pointer", "haply"}));
    line("editorExcludes", QString::fromStdString(second));
    EXPECT_EQ(now().rubric->criteria[0].excludes, std::vector<std::string>{second});
    choose("editorStatus", 3);
    EXPECT_EQ(now().rubric->criteria[0].status, rubric::Status::proposal);
    line("editorSource", "my own");
    EXPECT_EQ(now().rubric->criteria[0].source, "my own");
    // A knot of the curve, dragged down to fewer points; Escape gives up.
    auto* curve = part<CurveView>("editorCurve");
    const auto knots = now().rubric->criteria[0].knots;
    ASSERT_GE(knots.size(), 2u);
    const QPoint from = curve->at(knots.back()).toPoint(), to = from + QPoint(0, 25);
    const auto pull = [&](bool isLetGo) {
        QTest::mousePress(curve, Qt::LeftButton, Qt::NoModifier, from);
        QMouseEvent move(QEvent::MouseMove, QPointF(to), curve->mapToGlobal(QPointF(to)), Qt::NoButton, Qt::LeftButton,
                         Qt::NoModifier);
        QApplication::sendEvent(curve, &move);
        if (isLetGo) QTest::mouseRelease(curve, Qt::LeftButton, Qt::NoModifier, to);
    };
    pull(false);
    QTest::keyClick(curve, Qt::Key_Escape);
    QTest::mouseRelease(curve, Qt::LeftButton, Qt::NoModifier, to);
    EXPECT_EQ(now().rubric->criteria[0].knots, knots);
    pull(true);
    EXPECT_LT(now().rubric->criteria[0].knots.back().points, knots.back().points);
    press("editorUndo");
    EXPECT_EQ(now().rubric->criteria[0].knots, knots);
    look("rubric");

    part<QTabWidget>("editorRubricTabs")->setCurrentIndex(1);
    line("editorRubricId", "own-line");
    line("editorRubricVersion", "2");
    EXPECT_EQ(now().rubric->id, "own-line");
    EXPECT_EQ(now().rubric->version, "2");
    const auto write = [this](const char* name, int row, int column, const QString& text) {
        auto* list = part<QTableWidget>(name);
        list->item(row, column)->setText(text);
    };
    press("editorStepsAdd");
    write("editorSteps", 0, 1, QString::fromStdString(first + ", " + second));
    ASSERT_EQ(now().rubric->steps.size(), 1u);
    EXPECT_EQ(now().rubric->steps[0].criteria, (std::vector<std::string>{first, second}));
    const auto rules = static_cast<int>(now().rubric->rules.size());
    press("editorRulesAdd");
    write("editorRules", rules, 1, "nonsense");
    EXPECT_NE(part<QTableWidget>("editorRules")->item(rules, 1)->toolTip(), "") << "told in its cell";
    const std::string band = now().rubric->bands.front().id;
    write("editorRules", rules, 1, QString::fromStdString(band + " of " + first + " least 1"));
    EXPECT_EQ(now().rubric->rules.back().needs[0].least, 1);
    EXPECT_EQ(now().rubric->rules.back().needs[0].of, std::vector<std::string>{first});
    write("editorRules", rules, 3, "60");
    EXPECT_EQ(now().rubric->rules.back().elseAtMost, 60.0);
    look("rules");
    // A name that changes is followed.
    write("editorBandNames", 0, 0, "best");
    EXPECT_EQ(now().rubric->rules.back().needs[0].bands, std::vector<std::string>{"best"});

    part<QTabWidget>("editorRubricTabs")->setCurrentIndex(2);
    line("editorRubricLanguage", "de");
    press("editorRubricAddLanguage");
    auto* words = part<QTableWidget>("editorRubricTexts");
    ASSERT_EQ(words->columnCount(), 4);
    write("editorRubricTexts", 0, 3, QStringLiteral("Rille"));
    EXPECT_EQ(now().rubric->title.at("de"), "Rille");
    look("words");
    // All of it comes back from the file.
    ASSERT_TRUE(settled());
    file_ = own_.filePath("rubric.handpiece");
    press("editorSaveAs");
    const rubric::Rubric saved = rubric::parseRubric(tasks::readTask(toPath(file_)).rubric, "saved");
    EXPECT_EQ(rubric::hashOf(saved), rubric::hashOf(*now().rubric));
    EXPECT_EQ(rubric::rubricToml(saved), rubric::rubricToml(*now().rubric));
}

TEST_F(EditorTest, ARubricIsMendedAtItsRowAndTakenBack) {
    startWithTooth();
    beginBlock();
    page(1);
    choose("editorTemplate", part<QComboBox>("editorTemplate")->findData("block-line"));
    page(3);
    auto* table = part<QTableWidget>("editorCriteria");
    ASSERT_GE(table->rowCount(), 3);
    EXPECT_EQ(atRow(0), "");
    // A figure that no measure can have is told at its row at once; mended, it is gone.
    cell(0, 4, "60: 0, 960: 100");
    EXPECT_NE(atRow(0), "");
    EXPECT_TRUE(hasErrors());
    look("judgement");
    cell(0, 4, "60: 0, 96: 100");
    EXPECT_EQ(atRow(0), "");
    // What cannot be read stays to be mended, and the rubric as it was.
    cell(0, 4, "sixty");
    EXPECT_TRUE(atRow(0).contains("cannot be read"));
    EXPECT_EQ(table->item(0, 4)->text(), "sixty");
    EXPECT_EQ(now().rubric->criteria[0].knots.size(), 2u);
    cell(0, 4, "60: 0, 90: 100");
    EXPECT_EQ(atRow(0), "");
    EXPECT_EQ(now().rubric->criteria[0].knots[1].value, 90.0);
    cell(0, 6, "40");
    EXPECT_EQ(now().rubric->totalWeight, 90.0);
    EXPECT_FALSE(hasErrors());
    const auto rows = table->rowCount();
    press("editorAddCriterion");
    EXPECT_EQ(table->rowCount(), rows + 1);
    press("editorRemoveCriterion");
    EXPECT_EQ(table->rowCount(), rows);
    // All of it back, and forth.
    while (editor().draft().canUndo())
        press("editorUndo");
    EXPECT_FALSE(editor().draft().isUnsaved());
    EXPECT_FALSE(now().tooth);
    while (editor().draft().canRedo())
        press("editorRedo");
    EXPECT_EQ(now().rubric->criteria[0].weight, 40.0);
    ASSERT_TRUE(settled());
}

TEST_F(EditorTest, APreparationThatDoesNotLieOnTheToothIsTold) {
    startWithTooth();
    action("actionNewExercise")->trigger();
    press("editorTakeStarter");  // the egg: it has no landmarks
    ASSERT_TRUE(waitFor([this] { return now().tooth != nullptr; }));
    EXPECT_EQ(now().tooth->fdiNumber, 46);
    page(1);
    choose("editorTemplate", part<QComboBox>("editorTemplate")->findData("class-two"));
    EXPECT_FALSE(part<QComboBox>("editorSide")->isHidden());
    choose("editorSide", 1);
    EXPECT_EQ(now().preparation->side, "distal");
    EXPECT_EQ(now().rubric->id, "46-class-ii-do");
    ASSERT_TRUE(settled());
    EXPECT_TRUE(hasErrors());
    EXPECT_FALSE(part<QPushButton>("editorTry")->isEnabled());
    choose("editorTemplate", 0);
    ASSERT_TRUE(settled());
    EXPECT_FALSE(hasErrors());
}

TEST_F(EditorTest, ChangesAreAskedAboutBeforeTheyGo) {
    startWithTooth();
    int asked = 0;
    Questions::Unsaved answer = Questions::Unsaved::cancel;
    beginBlock();
    feature().askUnsaved = [&] {
        ++asked;
        return answer;
    };
    window().close();
    EXPECT_EQ(asked, 1);
    EXPECT_TRUE(window().isVisible());
    editor().close();
    EXPECT_EQ(asked, 2);
    EXPECT_TRUE(editor().isVisible());
    answer = Questions::Unsaved::save;
    file_.clear();  // and then no file is named
    editor().close();
    EXPECT_TRUE(editor().isVisible());
    file_ = own_.filePath("block.handpiece");
    editor().close();
    EXPECT_FALSE(editor().isVisible());
    EXPECT_TRUE(tasks::isTask(toPath(file_)));
    EXPECT_EQ(asked, 4);

    // What was saved is opened again; a file that is none is told of.
    action("actionEditExercise")->trigger();
    EXPECT_TRUE(editor().isVisible());
    EXPECT_TRUE(now().tooth);
    EXPECT_FALSE(editor().draft().isUnsaved());
    file_ = own_.filePath("nothing.handpiece");
    action("actionEditExercise")->trigger();
    ASSERT_TRUE(window().errorDialog());
    window().errorDialog()->reject();
    EXPECT_TRUE(now().tooth);
    ASSERT_TRUE(settled());
}

}  // namespace
}  // namespace handpiece::desktop
