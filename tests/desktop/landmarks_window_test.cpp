// SPDX-License-Identifier: Apache-2.0
// Landmarks in the window: shown, moved by the mouse and by keys, taken back, saved, read only in an exercise.
#include <QDockWidget>
#include <QPushButton>
#include <QTreeWidget>

#include "desktop/features/landmarks/landmarks_feature.h"
#include "handpiece/senses/view/camera.h"
#include "shell_support.h"

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;
using cases::LandmarkKind;
using cases::LandmarkSource;
using core::Vec3;

class LandmarksTest : public ShellTest {
  protected:
    /// An egg whose top and one side have names, and a horn within.
    cases::Case marked() const {
        cases::Case made = eggTooth(46);
        made.landmarks = {{LandmarkKind::cuspTip, "mesiobuccal", {{0.0, 0.0, 6.0}}, LandmarkSource::generated},
                          {LandmarkKind::pulpHorn, "mesial", {{0.0, 0.0, 1.0}}, LandmarkSource::generated}};
        return made;
    }
    void openMarked() {
        cases::writeCase(marked(), at("marked"));
        CommandLine line;
        line.file = own_.filePath("marked");
        startWithTooth(line);
        ASSERT_EQ(simulator().toothCase()->landmarks.size(), 2u);
    }
    [[nodiscard]] LandmarksFeature& feature() { return *window().findChild<LandmarksFeature*>(); }
    [[nodiscard]] QTreeWidget* list() { return window().findChild<QTreeWidget*>("landmarkList"); }
    void press(const char* button) {
        auto* found = window().findChild<QPushButton*>(QLatin1String(button));
        ASSERT_TRUE(found->isEnabled()) << button;
        QTest::mouseClick(found, Qt::LeftButton);
    }
    [[nodiscard]] QPoint seen(const Vec3& pointMm) {
        const auto pixel = view::pixelOf(view()->camera(), {view()->width(), view()->height()}, pointMm);
        return pixel ? QPoint(qRound(pixel->x()), qRound(pixel->y())) : QPoint(-1, -1);
    }
    void drag(const QPoint& from, const QPoint& to) {
        QTest::mousePress(view(), Qt::LeftButton, Qt::NoModifier, from);
        for (const QPoint at : {(from + to) / 2, to}) {
            QMouseEvent move(QEvent::MouseMove, QPointF(at), view()->mapToGlobal(QPointF(at)), Qt::NoButton,
                             Qt::LeftButton, Qt::NoModifier);
            QApplication::sendEvent(view(), &move);
        }
        QTest::mouseRelease(view(), Qt::LeftButton, Qt::NoModifier, to);
    }
    [[nodiscard]] double offSurfaceMm(const Vec3& p) {
        return geometry::TriangleTree(simulator().toothCase()->surface()).nearest(p).distanceMm;
    }
};

TEST_F(LandmarksTest, AreShownMovedTakenBackAndSavedIntoTheCase) {
    openMarked();
    auto* dock = window().findChild<QDockWidget*>("landmarksDock");
    EXPECT_TRUE(dock->isHidden());
    EXPECT_TRUE(view()->landmarks().empty());
    action("actionLandmarks")->trigger();
    EXPECT_FALSE(dock->isHidden());
    // Those on the surface are shown; what lies inside is ticked first.
    ASSERT_EQ(view()->landmarks().size(), 1u);
    EXPECT_EQ(list()->topLevelItemCount(), 2);
    EXPECT_EQ(list()->topLevelItem(0)->text(1), "generated");
    list()->topLevelItem(1)->setCheckState(0, Qt::Checked);
    EXPECT_EQ(view()->landmarks().size(), 2u);
    list()->topLevelItem(1)->setCheckState(0, Qt::Unchecked);

    action("actionMoveLandmarks")->trigger();
    EXPECT_EQ(view()->tool(), Tool::landmarks);
    const Vec3 before = feature().marks()[0].pointsMm[0];
    drag(seen(before), seen(before) + QPoint(60, 0));
    const cases::Landmark moved = feature().marks()[0];
    EXPECT_GT((moved.pointsMm[0] - before).norm(), 0.3);
    EXPECT_LT(offSurfaceMm(moved.pointsMm[0]), 1e-9);
    EXPECT_EQ(moved.source, LandmarkSource::set);
    EXPECT_EQ(list()->topLevelItem(0)->text(1), "set by hand");
    EXPECT_EQ(removedMm3(), 0.0) << "nothing is cut";
    EXPECT_EQ(feature().marks()[1].source, LandmarkSource::generated);
    // By keys as well.
    view()->setFocus();
    QTest::keyClick(view(), Qt::Key_Left);
    EXPECT_GT((feature().marks()[0].pointsMm[0] - moved.pointsMm[0]).norm(), 1e-3);
    EXPECT_LT(offSurfaceMm(feature().marks()[0].pointsMm[0]), 1e-9);
    press("landmarkUndo");
    EXPECT_EQ(feature().marks()[0].pointsMm[0], moved.pointsMm[0]);
    press("landmarkReset");
    EXPECT_EQ(feature().marks()[0].pointsMm[0], before);
    EXPECT_EQ(feature().marks()[0].source, LandmarkSource::generated);
    press("landmarkUndo");
    EXPECT_TRUE(feature().isUnsaved());

    press("landmarkSave");
    ASSERT_TRUE(waitFor([this] { return !feature().isUnsaved(); }));
    const cases::Case saved = cases::readCase(at("marked"));
    EXPECT_LT((saved.landmarks.at(0).pointsMm.at(0) - moved.pointsMm[0]).norm(), 1e-4);
    EXPECT_EQ(saved.landmarks.at(0).source, LandmarkSource::set);
    EXPECT_EQ(cases::contentKey(saved), cases::contentKey(marked()));
}

TEST_F(LandmarksTest, AreAskedAboutBeforeAnotherToothAndMakeACaseOfATooth) {
    openMarked();
    action("actionMoveLandmarks")->trigger();
    EXPECT_TRUE(action("actionLandmarks")->isChecked());
    const Vec3 top = feature().marks()[0].pointsMm[0];
    drag(seen(top), seen(top) + QPoint(40, 20));
    ASSERT_TRUE(feature().isUnsaved());
    int asked = 0;
    Questions::Unsaved answer = Questions::Unsaved::cancel;
    feature().askUnsaved = [&] {
        ++asked;
        return answer;
    };
    openTooth(11);
    EXPECT_EQ(asked, 1);
    EXPECT_FALSE(simulator().isBusy());
    // A place that cannot be written says so, and what was moved stays.
    fs::remove(at("marked") / "case.toml");
    answer = Questions::Unsaved::save;
    openTooth(11);
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
    window().errorDialog()->reject();
    EXPECT_TRUE(feature().isUnsaved());
    answer = Questions::Unsaved::discard;
    openTooth(11);
    ASSERT_TRUE(waitFor([this] { return simulator().toothCase()->fdiNumber == 11; }));
    EXPECT_TRUE(feature().marks().empty());
    EXPECT_FALSE(action("actionMoveLandmarks")->isEnabled());
}

TEST_F(LandmarksTest, AreReadOnlyInAnExercise) {
    cases::Case given = marked();
    given.exercise.emplace();
    cases::writeCase(given, at("given"));
    CommandLine line;
    line.file = own_.filePath("given");
    startWithTooth(line);
    action("actionLandmarks")->trigger();
    EXPECT_EQ(view()->landmarks().size(), 1u);
    ASSERT_TRUE(waitFor([this] { return !action("actionMoveLandmarks")->isEnabled(); }));
    EXPECT_FALSE(window().findChild<QPushButton*>("landmarkSave")->isEnabled());
    view()->setTool(Tool::landmarks);
    const Vec3 top = feature().marks()[0].pointsMm[0];
    drag(seen(top), seen(top) + QPoint(60, 0));
    EXPECT_EQ(feature().marks()[0].pointsMm[0], top);
}

}  // namespace
}  // namespace handpiece::desktop
