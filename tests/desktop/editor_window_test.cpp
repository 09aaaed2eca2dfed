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

#include "desktop/features/editor/editor_dialog.h"
#include "desktop/features/editor/editor_feature.h"
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
    ASSERT_TRUE(waitFor([this] { return !feature().isBusy() && part<SolidView>("editorIdeal")->isDrawn(); }));
    look("preparation");

    page(2);
    choose("editorBur", part<QComboBox>("editorBur")->findData("330"));
    tick("editorBurs", "330");
    tick("editorBurs", "245");
    tick("editorHelps", "undo");
    QTest::mouseClick(part<QCheckBox>("editorTimed"), Qt::LeftButton, Qt::NoModifier, QPoint(8, 8));
    type(part<QSpinBox>("editorMinutes"), "12");
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
