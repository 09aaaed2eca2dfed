// SPDX-License-Identifier: Apache-2.0
// From where and how one works: the clock, by mirror, with a finger rest; by clicks and keys, and what the record has.
#include <QCheckBox>
#include <QDockWidget>
#include <QLabel>
#include <QToolButton>

#include "desktop/features/position/position_panel.h"
#include "handpiece/app/input/working_position.h"
#include "handpiece/record/session/session_reader.h"
#include "shell_support.h"

namespace handpiece::desktop::position_window_test {
namespace {

using core::Vec3;

class PositionTest : public ShellTest {
  protected:
    template <class W>
    [[nodiscard]] W* part(const char* name) {
        return window().findChild<W*>(QLatin1String(name));
    }
    void openPanel() {
        startWithTooth();
        part<QDockWidget>("positionDock")->show();
        part<QDockWidget>("positionDock")->raise();
        QTest::qWait(20);
    }
    void click(int hour) {
        QTest::mouseClick(part<QToolButton>(qPrintable(QStringLiteral("positionHour_%1").arg(hour))), Qt::LeftButton);
    }
    [[nodiscard]] input::WorkingPosition seat(int hour) {
        return input::workingPosition(*input::headInCase(*simulator().toothCase()), false, hour);  // 46
    }
    void hover(const QPoint& where) {
        QMouseEvent move(QEvent::MouseMove, QPointF(where), view()->mapToGlobal(QPointF(where)), Qt::NoButton,
                         Qt::NoButton, Qt::NoModifier);
        QApplication::sendEvent(view(), &move);
    }
    [[nodiscard]] Vec3 target() { return Vec3(view()->hand()->target().positionMm); }
};

TEST_F(PositionTest, AClickOnAnHourTakesTheEyeThere) {
    openPanel();
    for (const int hour : {9, 12, 3, 8}) {
        click(hour);
        EXPECT_GT((-view()->camera().forward()).dot(seat(hour).toEye), 0.9999) << hour;
        EXPECT_TRUE(part<QToolButton>(qPrintable(QStringLiteral("positionHour_%1").arg(hour)))->isChecked());
        // The handle points to the hand as nearly as the bur's axis lets it.
        const auto& q = view()->hand()->target().orientation;
        const core::Quat turn(q[0], q[1], q[2], q[3]);
        EXPECT_LT(turn.angularDistance(input::handleTowards(turn, seat(hour).toHand)), 1e-6) << hour;
    }
    auto* clock = part<PositionClock>("positionClock");
    clock->setFocus();
    QTest::keyClick(clock, Qt::Key_Right);
    EXPECT_GT((-view()->camera().forward()).dot(seat(9).toEye), 0.9999);
    QTest::keyClick(clock, Qt::Key_Left);
    QTest::keyClick(clock, Qt::Key_Left);  // there is no hour before 8
    EXPECT_GT((-view()->camera().forward()).dot(seat(8).toEye), 0.9999);
    const QString usual = part<QLabel>("positionUsual")->text();
    EXPECT_TRUE(usual.contains(QStringLiteral("46"))) << usual.toStdString();
    part<QCheckBox>("positionLeftHanded")->click();
    EXPECT_NE(part<QLabel>("positionUsual")->text(), usual);
}

TEST_F(PositionTest, ByMirrorThePictureIsTurnedOverAndTheHandIsNot) {
    startWithTooth();
    const QPoint right(view()->width() * 6 / 10, view()->height() / 2);
    hover(right);
    const Vec3 plain = target();
    const auto pixel = [this](const Vec3& p) {
        return view::pixelOf(view()->camera(), {view()->width(), view()->height()}, p);
    };
    const auto before = pixel(plain);
    ASSERT_TRUE(before);
    action("actionMirrorView")->trigger();
    EXPECT_TRUE(view()->isMirrorView());
    EXPECT_TRUE(action("actionMirrorView")->isChecked());
    hover(right + QPoint(1, 0));
    hover(right);
    EXPECT_LT((target() - plain).norm(), 0.02) << "the same place of the tooth";
    const auto seen = pixel(plain);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->x(), view()->width() - before->x(), 1e-6);
    EXPECT_NEAR(seen->y(), before->y(), 1e-6);
    // Tools are on the picture.
    view()->setTool(Tool::calliper);
    QTest::mouseClick(view(), Qt::LeftButton, Qt::NoModifier, right);
    ASSERT_TRUE(view()->written().calliperStartMm);
    const auto picked = pixel(*view()->written().calliperStartMm);
    ASSERT_TRUE(picked);
    EXPECT_NEAR(picked->x(), right.x(), 0.5);
    // It stays whatever the eye does, and goes with the tooth.
    view()->showStandardView(view::StandardView::buccal);
    EXPECT_TRUE(view()->camera().mirrored);
    action("actionMirrorView")->trigger();
    EXPECT_FALSE(view()->camera().mirrored);
}

TEST_F(PositionTest, TheRecordSaysFromWhereAndHow) {
    openPanel();
    click(11);
    action("actionMirrorView")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().sample().timeS > 0.3; }));
    action("actionMirrorView")->trigger();
    part<QCheckBox>("depthStopOn")->click();
    ASSERT_TRUE(waitFor([this] { return simulator().status().recording.writtenRecords > 0; }));
    const std::vector<std::string> expected{
        R"({"position": 0, "mirror_only": false, "finger_rest": false, "depth_stop": true, "depth_per_pass_mm": 0.3})",
        R"({"position": 11, "mirror_only": false, "finger_rest": false, "depth_stop": true, "depth_per_pass_mm": 0.3})",
        R"({"position": 11, "mirror_only": true, "finger_rest": false, "depth_stop": true, "depth_per_pass_mm": 0.3})",
        R"({"position": 11, "mirror_only": false, "finger_rest": false, "depth_stop": true, "depth_per_pass_mm": 0.3})",
        R"({"position": 11, "mirror_only": false, "finger_rest": false, "depth_stop": false, "depth_per_pass_mm": 0.3})"};
    std::vector<std::string> told;
    EXPECT_TRUE(waitFor([&] {
        QTest::qWait(300);  // it is written by and by, and stays readable
        told.clear();
        const session::SessionReader reader(simulator().recording());
        for (const session::Event& event : reader.events())
            if (event.name == "working way") told.push_back(event.text);
        return told.size() >= expected.size();
    }));
    EXPECT_EQ(told, expected);
}

TEST_F(PositionTest, ARecordingThatGoesOnAfterAReplayDoesNotCountWhatWasBefore) {
    openPanel();
    click(11);
    action("actionMirrorView")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().status().recording.writtenRecords > 0; }));
    const std::filesystem::path recording = simulator().recording();
    simulator().replayThis();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay; }));
    simulator().closeReplay();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
    ASSERT_EQ(simulator().recording(), recording);
    EXPECT_FALSE(view()->isMirrorView());
    ASSERT_TRUE(waitFor([&] {
        QTest::qWait(300);
        std::string last;
        const session::SessionReader reader(recording);
        for (const session::Event& event : reader.events())
            if (event.name == "working way") last = event.text;
        return last ==
               R"({"position": 0, "mirror_only": false, "finger_rest": false, "depth_stop": true, "depth_per_pass_mm": 0.3})";
    }));
}

TEST_F(PositionTest, AToothThatStandsAloneHasNoFingerRest) {
    startWithTooth();
    EXPECT_FALSE(action("actionFingerRest")->isEnabled());
}

}  // namespace
}  // namespace handpiece::desktop::position_window_test
