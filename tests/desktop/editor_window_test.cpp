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
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/course/finished_work.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/assess/task/target.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "handpiece/model/tooth/state_file.h"
#include "shell_support.h"

namespace handpiece::desktop::editor_window_test {
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
        // A field that was only just made is not on the screen yet, and hears of no focus.
        (void)QTest::qWaitFor([field] { return field->isVisible(); });
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
    /// An attempt in which all that a preparation asks for is gone.
    [[nodiscard]] QString idealWork(const cases::Case& on, const preparation::Recipe& recipe, double voxelMm,
                                    const char* name) {
        simulation::SimulationSettings settings;
        settings.field = simulation::fieldSettingsAt(voxelMm);
        const simulation::SimulationSetup station = simulation::makeSimulation(on, settings, false, {});
        const tooth::StateDelta state = zones::idealState(*preparation::layOn(on, recipe).zones, station.tooth);
        cases::Attempt attempt;
        attempt.caseFile = toPath(own_.filePath(QLatin1String(name) + QStringLiteral("-case.handpiece")));
        cases::writeCase(on, attempt.caseFile);
        attempt.caseKey = cases::contentKey(on);
        attempt.caseName = on.name;
        attempt.state = tooth::encodeState(state, station.identity());
        attempt.voxelMm = voxelMm;
        attempt.removedMm3 = state.removedMm3.own;
        attempt.bur = "330";
        attempt.cuttingParameters = "carbide";
        attempt.drive = "turbine";
        const QString file = own_.filePath(QLatin1String(name) + QStringLiteral(".handpiece"));
        cases::writeAttempt(attempt, toPath(file));
        return file;
    }
    /// Of 100, as `handpiece score` gives them.
    [[nodiscard]] static double points(const QString& work, const tasks::Task& task) {
        const score::Result judged =
            assessment::scoreWork(assessment::readWork(toPath(work), task), task, course::rubricOf(task));
        return 100.0 * judged.assessment.score / judged.assessment.maxScore;
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

TEST_F(EditorTest, ATargetIsPaintedInThePicture) {
    startWithTooth();
    beginBlock();
    page(1);
    choose("editorTemplate", part<QComboBox>("editorTemplate")->findData("painted"));
    ASSERT_TRUE(settled());
    EXPECT_TRUE(hasErrors()) << "nothing is painted";
    EXPECT_EQ(now().rubric->id, "own-target");
    EXPECT_FALSE(part<QComboBox>("editorBrush")->isHidden());
    EXPECT_TRUE(part<QPushButton>("editorTakeWork")->isHidden());
    auto* picture = part<SolidView>("editorPicture");
    ASSERT_TRUE(waitFor([&] { return picture->isDrawn(); }));
    const double top = now().tooth->outer.bounds().max.z();
    const auto pixel = [&](const core::Vec3& place) {
        const auto at = view::pixelOf(picture->camera(), {picture->width(), picture->height()}, place);
        return QPointF(at->x(), at->y());
    };
    const auto stroke = [&](const core::Vec3& from, const core::Vec3& to) {
        QTest::mousePress(picture, Qt::LeftButton, Qt::NoModifier, pixel(from).toPoint());
        for (int i = 1; i <= 10; ++i) {
            const QPointF at = pixel(from + 0.1 * i * (to - from));
            QMouseEvent move(QEvent::MouseMove, at, picture->mapToGlobal(at), Qt::NoButton, Qt::LeftButton,
                             Qt::NoModifier);
            QApplication::sendEvent(picture, &move);
        }
        ASSERT_TRUE(waitFor([&] { return picture->isDrawn(); }));
        look("painting");
        QTest::mouseRelease(picture, Qt::LeftButton, Qt::NoModifier, pixel(to).toPoint());
    };
    const core::Vec3 eye = picture->camera().eyeMm;
    type(part<QDoubleSpinBox>("editorBrushRadius"), "0.80");
    stroke({-2.0, 0.0, top}, {2.0, 0.0, top});
    ASSERT_EQ(now().preparation->strokes.size(), 1u);
    EXPECT_EQ(now().preparation->strokes[0].radiusMm, 0.8);
    EXPECT_GT(now().preparation->strokes[0].pointsMm.size(), 5u);
    EXPECT_EQ(picture->camera().eyeMm, eye) << "the tooth does not turn under the brush";
    for (const core::Vec3& p : now().preparation->strokes[0].pointsMm)
        EXPECT_NEAR(p.z(), top, 1e-6);
    ASSERT_TRUE(settled());
    EXPECT_FALSE(hasErrors());
    EXPECT_GT(editor().preparationPage()->glass().surfaces().size(), 0u);
    const auto& zones = *editor().preparationPage()->glass().laid()->zones;
    EXPECT_EQ(zones.at({1.0, 0.5, top - 0.5}), zones::Zone::target);
    EXPECT_NE(zones.at({1.0, 1.5, top - 0.5}), zones::Zone::target);
    ASSERT_TRUE(waitFor([&] { return picture->isDrawn(); }));
    look("painted");
    // A part of it is erased; a stroke is a step back.
    choose("editorBrush", 1);
    stroke({1.5, 0.0, top}, {2.0, 0.0, top});
    ASSERT_EQ(now().preparation->strokes.size(), 2u);
    EXPECT_TRUE(now().preparation->strokes[1].erases);
    ASSERT_TRUE(settled());
    EXPECT_NE(editor().preparationPage()->glass().laid()->zones->at({1.9, 0.0, top - 0.5}), zones::Zone::target);
    press("editorUndo");
    EXPECT_EQ(now().preparation->strokes.size(), 1u);
    ASSERT_TRUE(settled());
    // Beside the tooth, and when asked to, it turns.
    choose("editorBrush", 2);
    stroke({0.0, 0.0, top}, {1.0, 0.0, top});
    EXPECT_EQ(now().preparation->strokes.size(), 1u);
    EXPECT_GT((picture->camera().eyeMm - eye).norm(), 0.1);
    // It is saved as data and comes back.
    file_ = own_.filePath("painted.handpiece");
    press("editorSaveAs");
    const tasks::Task saved = tasks::readTask(toPath(file_));
    EXPECT_EQ(saved.preparation, now().preparation);
    EXPECT_NO_THROW(tasks::requireTarget(saved));
    EXPECT_NEAR(points(idealWork(saved.toothCase, *saved.preparation, saved.voxelMm, "painted-ideal"), saved), 100.0,
                1.0);
    // A click beside the tooth paints nothing; another template forgets the paint, and a step back brings it back.
    choose("editorBrush", 0);
    const draft::Content before = now();
    QTest::mousePress(picture, Qt::LeftButton, Qt::NoModifier, QPoint(3, 3));
    QTest::mouseRelease(picture, Qt::LeftButton, Qt::NoModifier, QPoint(3, 3));
    EXPECT_EQ(now().preparation, before.preparation);
    for (int twice = 0; twice < 2; ++twice) {
        choose("editorTemplate", part<QComboBox>("editorTemplate")->findData("block-cross"));
        ASSERT_TRUE(settled());
        EXPECT_TRUE(part<QComboBox>("editorBrush")->isHidden());
        EXPECT_EQ(now().preparation->preparation, "block-cross");
        press("editorUndo");
        ASSERT_TRUE(settled());
        EXPECT_EQ(now().preparation, before.preparation);
    }
    press("editorUndo");
    ASSERT_TRUE(settled());
    EXPECT_TRUE(hasErrors()) << "all strokes taken back";
}

TEST_F(EditorTest, ATeachersOwnWorkBecomesTheTarget) {
    startWithTooth();
    beginBlock();
    // Work on this very block, at 100 um, and on another tooth.
    preparation::Recipe cross;
    cross.preparation = "block-cross";
    const auto work = [&](const cases::Case& on, const char* name) { return idealWork(on, cross, 0.1, name); };
    const QString own = work(*now().tooth, "own");
    cases::Case other = *now().tooth;
    for (core::Vec3& v : other.outer.vertices)
        v.z() *= 1.01;
    const QString foreign = work(other, "foreign");
    page(1);
    choose("editorTemplate", part<QComboBox>("editorTemplate")->findData("recorded-work"));
    ASSERT_TRUE(settled());
    EXPECT_TRUE(hasErrors()) << "no work yet";
    for (const QString& bad : {foreign, own_.filePath("nothing.handpiece")}) {
        file_ = bad;
        press("editorTakeWork");
        ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
        window().errorDialog()->reject();
        EXPECT_FALSE(now().preparation->recorded);
        ASSERT_TRUE(settled());
    }
    file_ = own;
    press("editorTakeWork");
    ASSERT_TRUE(waitFor([this] { return now().preparation->recorded != nullptr; }));
    ASSERT_TRUE(settled());
    EXPECT_FALSE(hasErrors());
    EXPECT_EQ(now().voxelMm, 0.1);
    EXPECT_EQ(now().rubric->id, "own-target");
    const auto& laid = *editor().preparationPage()->glass().laid();
    const double top = now().tooth->outer.bounds().max.z();
    EXPECT_EQ(laid.zones->at({2.0, 0.0, top - 1.0}), zones::Zone::target);
    EXPECT_EQ(laid.zones->at({2.0, 0.0, top - 1.6}), zones::Zone::leewayFloor);
    EXPECT_EQ(laid.zones->at({2.0, 2.0, top - 1.0}), zones::Zone::container);
    auto* picture = part<SolidView>("editorPicture");
    ASSERT_TRUE(waitFor([&] { return picture->isDrawn(); }));
    look("recorded");
    choose("editorLike", part<QComboBox>("editorLike")->findData("class-five"));
    EXPECT_EQ(now().preparation->kind(), "class-five");
    EXPECT_EQ(now().rubric->id, "33-class-v");
    press("editorUndo");
    file_ = own_.filePath("made-of-work.handpiece");
    press("editorSaveAs");
    const tasks::Task saved = tasks::readTask(toPath(file_));
    EXPECT_EQ(saved.preparation->recorded->hash(), now().preparation->recordedHash);
    EXPECT_NO_THROW(tasks::requireTarget(saved));
    EXPECT_NEAR(points(own, saved), 100.0, 1.0) << "one's own work";
    preparation::Recipe deeper = cross;
    deeper.numbers = {{"depth_mm", 2.0}};
    EXPECT_LT(points(idealWork(saved.toothCase, deeper, 0.1, "deeper"), saved), 80.0);
    press("editorUndo");
    EXPECT_FALSE(now().preparation->recorded);
    ASSERT_TRUE(settled());
}

TEST_F(EditorTest, AnOnlayIsSetByItsHandlesAndTried) {
    startWithTooth();
    cases::Case molar;
    static_cast<cases::Tooth&>(molar) = dentition::makeTooth(46, {1, 25.0}, {6000, 3000});
    cases::Case incisor;
    static_cast<cases::Tooth&>(incisor) = dentition::makeTooth(11, {1, 25.0}, {4000, 2000});
    const QString molarFile = own_.filePath("molar.handpiece"), incisorFile = own_.filePath("incisor.handpiece");
    cases::writeCase(molar, toPath(molarFile));
    cases::writeCase(incisor, toPath(incisorFile));
    action("actionNewExercise")->trigger();
    // It does not lie on an incisor: one error.
    file_ = incisorFile;
    press("editorTakeCase");
    ASSERT_TRUE(waitFor([this] { return now().tooth != nullptr; }));
    page(1);
    choose("editorTemplate", part<QComboBox>("editorTemplate")->findData("onlay"));
    ASSERT_TRUE(settled());
    const auto errors = [this] {
        const auto& all = editor().problems();
        return std::count_if(all.begin(), all.end(),
                             [](const draft::Problem& p) { return p.severity == rubric::Severity::error; });
    };
    EXPECT_EQ(errors(), 1);
    page(0);
    file_ = molarFile;
    press("editorTakeCase");
    ASSERT_TRUE(waitFor([this] { return now().tooth->fdiNumber == 46; }));
    page(1);
    ASSERT_TRUE(settled());
    EXPECT_EQ(errors(), 0);
    EXPECT_EQ(now().rubric->id, "46-onlay");
    EXPECT_NE(now().rubric->criterion("cusp-mesiobuccal"), nullptr);
    EXPECT_EQ(now().rubric->criterion("cusp-mesiolingual"), nullptr);
    // A cusp more: so does the rubric.
    type(part<QDoubleSpinBox>("editorNumber_cap_mesiolingual_mm"), "1.50");
    EXPECT_NE(now().rubric->criterion("cusp-mesiolingual"), nullptr);
    ASSERT_TRUE(settled());
    press("editorUndo");
    ASSERT_TRUE(settled());
    EXPECT_EQ(now().rubric->criterion("cusp-mesiolingual"), nullptr);
    auto* picture = part<SolidView>("editorPicture");
    const PreparationPage& shown = *editor().preparationPage();
    ASSERT_TRUE(waitFor([&] { return picture->isDrawn() && !shown.handles().empty(); }));
    look("onlay");
    const auto at = std::find_if(shown.handles().begin(), shown.handles().end(),
                                 [](const draft::Handle& h) { return h.number == "cap_mesiobuccal_mm"; });
    ASSERT_NE(at, shown.handles().end());
    const draft::Handle handle = *at;
    const view::Viewport port{picture->width(), picture->height()};
    const auto pixel = [&](const core::Vec3& place) {
        const auto p = view::pixelOf(picture->camera(), port, place);
        return QPointF(p->x(), p->y());
    };
    const QPointF from = pixel(handle.placeMm), to = pixel(handle.placeMm + 0.25 * handle.way);
    QTest::mousePress(picture, Qt::LeftButton, Qt::NoModifier, from.toPoint());
    for (const double share : {0.5, 1.0}) {
        const QPointF there = from + share * (to - from);
        QMouseEvent move(QEvent::MouseMove, there, picture->mapToGlobal(there), Qt::NoButton, Qt::LeftButton,
                         Qt::NoModifier);
        QApplication::sendEvent(picture, &move);
    }
    EXPECT_TRUE(picture->isDragging());
    QTest::mouseRelease(picture, Qt::LeftButton, Qt::NoModifier, to.toPoint());
    // Along its line it is drawn by 0.25 mm; a number goes by 0.05 mm a step, and counts square to the surface.
    EXPECT_NEAR(now().preparation->number("cap_mesiobuccal_mm"), 1.75 + 0.25 * handle.perMm, 0.05 + 1e-9);
    ASSERT_TRUE(settled());
    page(2);
    type(part<QDoubleSpinBox>("editorVoxel"), "200");
    page(4);
    type(part<QLineEdit>("editorId"), "onlay-46");
    ASSERT_TRUE(settled());
    file_ = own_.filePath("onlay.handpiece");
    press("editorSaveAs");
    const tasks::Task saved = tasks::readTask(toPath(file_));
    EXPECT_EQ(saved.preparation, now().preparation);
    EXPECT_NO_THROW(tasks::requireTarget(saved));
    ASSERT_TRUE(settled());
    press("editorTry");
    ASSERT_TRUE(waitFor([this] { return simulator().task() && !simulator().isBusy(); }));
    EXPECT_EQ(simulator().task()->id, "onlay-46");
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
}  // namespace handpiece::desktop::editor_window_test
