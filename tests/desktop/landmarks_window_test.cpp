// SPDX-License-Identifier: Apache-2.0
// Landmarks in the window: shown, found, set and moved by the mouse and by keys, taken back, saved, read only in an
// exercise.
#include <QComboBox>
#include <QDockWidget>
#include <QLabel>
#include <QPushButton>
#include <QTreeWidget>

#include "desktop/features/landmarks/landmarks_feature.h"
#include "handpiece/scan/landmarks/find_landmarks.h"
#include "handpiece/senses/view/camera.h"
#include "shell_support.h"

namespace handpiece::desktop::landmarks_window_test {
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

TEST_F(LandmarksTest, AreFoundByShapeBesideWhatAPersonSet) {
    // A real tooth of the rules without its landmarks, but for one that a person set elsewhere.
    cases::Case bare;
    static_cast<cases::Tooth&>(bare) = dentition::makeTooth(46, {}, {12000, 0});
    const std::vector<cases::Landmark> truth = bare.landmarks;
    const Vec3 own(0.0, 0.0, 1.0);
    bare.landmarks = {{LandmarkKind::cuspTip, "mesiobuccal", {own}, LandmarkSource::set}};
    cases::writeCase(bare, at("bare"));
    CommandLine line;
    line.file = own_.filePath("bare");
    startWithTooth(line);
    action("actionLandmarks")->trigger();
    // Cancelled, it changes nothing.
    press("landmarkFind");
    ASSERT_TRUE(feature().isFinding());
    press("landmarkFind");
    ASSERT_TRUE(waitFor([this] { return !feature().isFinding(); }));
    EXPECT_EQ(feature().marks().size(), 1u);
    EXPECT_FALSE(feature().isUnsaved());

    press("landmarkFind");
    ASSERT_TRUE(waitFor([this] { return !feature().isFinding(); }));
    const std::vector<cases::Landmark> found = landmarks::findLandmarks(*simulator().toothCase());
    EXPECT_GT(found.size(), 5u);
    EXPECT_EQ(feature().marks().size(), landmarks::withFound(bare.landmarks, found).size());
    EXPECT_EQ(feature().marks()[0].pointsMm[0], own);
    EXPECT_EQ(feature().marks()[0].source, LandmarkSource::set);
    for (std::size_t i = 1; i < feature().marks().size(); ++i) {
        EXPECT_EQ(feature().marks()[i].source, LandmarkSource::found);
        EXPECT_EQ(list()->topLevelItem(static_cast<int>(i))->text(1), "found");
    }
    EXPECT_TRUE(feature().isUnsaved());
    const QString note = window().findChild<QLabel*>("landmarkNote")->text();
    EXPECT_TRUE(note.contains("Not found") == (truth.size() > feature().marks().size())) << note.toStdString();
    press("landmarkUndo");
    EXPECT_EQ(feature().marks().size(), 1u);
    EXPECT_EQ(list()->topLevelItemCount(), 1);
    press("landmarkFind");
    ASSERT_TRUE(waitFor([this] { return !feature().isFinding(); }));
    press("landmarkSave");
    ASSERT_TRUE(waitFor([this] { return !feature().isUnsaved(); }));
    const cases::Case saved = cases::readCase(at("bare"));
    ASSERT_EQ(saved.landmarks.size(), feature().marks().size());
    EXPECT_EQ(saved.landmarks[0].source, LandmarkSource::set);
    EXPECT_EQ(saved.landmarks[1].source, LandmarkSource::found);
}

TEST_F(LandmarksTest, AreSetByClicksAndDeleted) {
    openMarked();
    action("actionLandmarks")->trigger();
    auto* kind = window().findChild<QComboBox*>("landmarkKind");
    auto* name = window().findChild<QComboBox*>("landmarkName");
    const auto choose = [&](LandmarkKind what) { kind->setCurrentIndex(static_cast<int>(what)); };
    const auto click = [&](const Vec3& p) {
        QTest::mouseClick(view(), Qt::LeftButton, Qt::NoModifier,
                          seen(geometry::TriangleTree(simulator().toothCase()->surface()).nearest(p).pointMm));
    };
    // A point: one click. The tooth of this number has a distobuccal cusp, this one lacks it.
    choose(LandmarkKind::cuspTip);
    EXPECT_EQ(name->findText("mesiobuccal"), -1) << "it is there";
    ASSERT_GE(name->findText("distobuccal"), 0);
    name->setCurrentIndex(name->findText("distobuccal"));
    press("landmarkSet");
    EXPECT_EQ(view()->tool(), Tool::landmarks);
    const Vec3 wanted(-1.5, 1.0, 6.0);
    click(wanted);
    ASSERT_EQ(feature().marks().size(), 3u);
    EXPECT_FALSE(feature().isPlacing());
    const cases::Landmark tip = feature().marks()[2];
    EXPECT_EQ(tip.name, "distobuccal");
    EXPECT_EQ(tip.source, LandmarkSource::set);
    EXPECT_LT(offSurfaceMm(tip.pointsMm[0]), 1e-9);
    EXPECT_LT(
        (tip.pointsMm[0] - geometry::TriangleTree(simulator().toothCase()->surface()).nearest(wanted).pointMm).norm(),
        0.1);
    EXPECT_EQ(list()->topLevelItem(2)->text(1), "set by hand");
    EXPECT_EQ(removedMm3(), 0.0) << "nothing is cut";
    // A line, point by point; a click too many is taken back.
    choose(LandmarkKind::fissure);
    name->setEditText("of mine");
    press("landmarkSet");
    for (const double x : {-2.0, 0.0, 2.0, 2.4})
        click(Vec3(x, 0.5, 6.0));
    const std::size_t four = feature().marks()[3].pointsMm.size();
    press("landmarkUndo");
    EXPECT_LT(feature().marks()[3].pointsMm.size(), four);
    press("landmarkSet");
    ASSERT_EQ(feature().marks().size(), 4u);
    const cases::Landmark groove = feature().marks()[3];
    EXPECT_EQ(groove.name, "of mine");
    EXPECT_GT(groove.pointsMm.size(), 8u);
    const geometry::TriangleTree tree(simulator().toothCase()->surface());
    EXPECT_LT((groove.pointsMm.front() - tree.nearest(Vec3(-2.0, 0.5, 6.0)).pointMm).norm(), 0.1);
    EXPECT_LT((groove.pointsMm.back() - tree.nearest(Vec3(2.0, 0.5, 6.0)).pointMm).norm(), 0.1);
    for (const Vec3& p : groove.pointsMm)
        EXPECT_LT(offSurfaceMm(p), 1e-9);
    // Too few clicks for a ring: nothing.
    choose(LandmarkKind::heightOfContour);
    press("landmarkSet");
    click(Vec3(1, 1, 6));
    EXPECT_EQ(feature().marks().size(), 5u);
    press("landmarkSet");
    EXPECT_EQ(feature().marks().size(), 4u);
    // An axis goes upwards, whichever end is clicked first.
    choose(LandmarkKind::longAxis);
    press("landmarkSet");
    click(Vec3(0.0, 0.0, 6.0));
    click(Vec3(3.0, 1.0, 4.0));
    ASSERT_EQ(feature().marks().size(), 5u);
    EXPECT_FALSE(feature().isPlacing());
    EXPECT_LT(feature().marks()[4].pointsMm[0].z(), feature().marks()[4].pointsMm[1].z());
    // What is deleted comes back.
    list()->setCurrentItem(list()->topLevelItem(3));
    press("landmarkDelete");
    ASSERT_EQ(feature().marks().size(), 4u);
    EXPECT_EQ(list()->topLevelItemCount(), 4);
    press("landmarkUndo");
    ASSERT_EQ(feature().marks().size(), 5u);
    EXPECT_EQ(feature().marks()[3].pointsMm, groove.pointsMm);
    press("landmarkSave");
    ASSERT_TRUE(waitFor([this] { return !feature().isUnsaved(); }));
    EXPECT_EQ(cases::readCase(at("marked")).landmarks.size(), 5u);
    // One step of undo for each that was set.
    for (std::size_t left : {4u, 3u, 2u}) {
        press("landmarkUndo");
        EXPECT_EQ(feature().marks().size(), left);
    }
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
    for (const char* button : {"landmarkSave", "landmarkFind", "landmarkSet", "landmarkDelete", "landmarkUndo"})
        EXPECT_FALSE(window().findChild<QPushButton*>(button)->isEnabled()) << button;
    view()->setTool(Tool::landmarks);
    const Vec3 top = feature().marks()[0].pointsMm[0];
    drag(seen(top), seen(top) + QPoint(60, 0));
    EXPECT_EQ(feature().marks()[0].pointsMm[0], top);
}

}  // namespace
}  // namespace handpiece::desktop::landmarks_window_test
