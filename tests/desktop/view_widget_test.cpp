// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/view_widget.h"

#include <gtest/gtest.h>

#include <QApplication>
#include <QDoubleSpinBox>
#include <QElapsedTimer>
#include <QSignalSpy>
#include <QTest>
#include <QWheelEvent>
#include <cmath>
#include <numbers>

#include "desktop/picture/overlay.h"
#include "handpiece/model/instrument/catalogue.h"
#include "view_ball.h"

namespace handpiece::desktop::view_widget_test {
namespace {

using core::Vec2;
using core::Vec3;

/// Where the line of sight through a pixel meets the ball, in closed form.
Vec3 onBall(const ViewWidget& view, const QPoint& pixel) {
    const view::Ray ray = view::rayThrough(view.camera(), {view.width(), view.height()}, Vec2(pixel.x(), pixel.y()));
    const double b = ray.originMm.dot(ray.direction), c = ray.originMm.squaredNorm() - kRadius * kRadius;
    return ray.originMm + (-b - std::sqrt(b * b - c)) * ray.direction;
}

class ViewTest : public ::testing::Test {
  protected:
    void SetUp() override {
        view_.resize(800, 600);
        view_.show();
        view_.setTooth(live_, std::make_shared<const cases::Case>(ballCase()), nullptr);
        view_.setBur(instrument::makeInstrument("round-4").bur);
        core::Pose start;
        start.positionMm = {0, 0, 12};
        mailbox_ = std::make_shared<device::PointerMailbox>();
        view_.setPointer(mailbox_, start);
        moveTo(centre_);
    }
    void moveTo(const QPoint& to, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
        QMouseEvent move(QEvent::MouseMove, QPointF(to), view_.mapToGlobal(QPointF(to)), Qt::NoButton, held_,
                         modifiers);
        QApplication::sendEvent(&view_, &move);
    }
    void press(Qt::MouseButton button, const QPoint& at, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
        held_ |= button;
        QTest::mousePress(&view_, button, modifiers, at);
    }
    void release(Qt::MouseButton button, const QPoint& at, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
        held_ &= ~Qt::MouseButtons(button);
        QTest::mouseRelease(&view_, button, modifiers, at);
    }
    void wheel(int notches, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
        QWheelEvent turned(QPointF(centre_), view_.mapToGlobal(QPointF(centre_)), {}, {0, 120 * notches}, Qt::NoButton,
                           modifiers, Qt::NoScrollPhase, false);
        QApplication::sendEvent(&view_, &turned);
    }
    [[nodiscard]] const device::PointerTarget& target() { return mailbox_->read(); }
    [[nodiscard]] Vec3 targetMm() {
        const device::PointerTarget& now = target();
        return {now.positionMm[0], now.positionMm[1], now.positionMm[2]};
    }

    const std::shared_ptr<simulation::LiveTooth> live_ =
        std::make_shared<simulation::LiveTooth>(cuttableBall(), tooth::StateDelta{});
    ViewWidget view_;
    std::shared_ptr<device::PointerMailbox> mailbox_;
    const QPoint centre_{400, 300};
    Qt::MouseButtons held_;
};

TEST_F(ViewTest, TheBurHoversOffTheSurfaceUnderThePointer) {
    for (const QPoint at : {QPoint(400, 300), QPoint(470, 260), QPoint(340, 350)}) {
        moveTo(at);
        EXPECT_GE(targetMm().norm(), kRadius + 0.9 * input::kHoverMm);
        EXPECT_LE((targetMm() - onBall(view_, at)).norm(), 2.5);
        EXPECT_EQ(target().pedal, 0.0);
    }
}

TEST_F(ViewTest, TheLeftButtonCutsAndItsReleaseLifts) {
    QSignalSpy pressed(&view_, &ViewWidget::pressedChanged);
    press(Qt::LeftButton, centre_);
    EXPECT_EQ(target().pedal, 1.0);
    EXPECT_DOUBLE_EQ(target().loadN, input::kFirstLoadN);
    moveTo(centre_ + QPoint(30, 0));
    EXPECT_EQ(target().pedal, 1.0);
    release(Qt::LeftButton, centre_ + QPoint(30, 0));
    EXPECT_EQ(target().pedal, 0.0);
    EXPECT_EQ(target().loadN, 0.0);
    ASSERT_EQ(pressed.count(), 2);
    EXPECT_TRUE(pressed[0][0].toBool());
    EXPECT_FALSE(pressed[1][0].toBool());
}

TEST_F(ViewTest, ThePedalIsShownUpAsSoonAsItIsLetGo) {
    EXPECT_FALSE(view_.written().pedalDown);
    view_.setLoad(3.0);
    press(Qt::LeftButton, centre_);
    EXPECT_TRUE(view_.written().pedalDown);
    // Deep in a cavity: the bur comes out of it turning.
    messages::HapticSample deep;
    deep.tick = 1;
    deep.depthMm = 0.1;
    deep.proxyPositionMm = {0.0, 0.0, kRadius - 2.0};
    view_.hand()->follow(deep);
    release(Qt::LeftButton, centre_);
    EXPECT_FALSE(view_.written().pedalDown);
    view_.latchPedal(true);
    EXPECT_TRUE(view_.written().pedalDown);
    view_.latchPedal(false);
    EXPECT_FALSE(view_.written().pedalDown);
}

TEST_F(ViewTest, WithControlItTouchesWithTheBurStill) {
    press(Qt::LeftButton, centre_, Qt::ControlModifier);
    EXPECT_EQ(target().pedal, 0.0);
    EXPECT_GT(target().loadN, 0.0);
    release(Qt::LeftButton, centre_, Qt::ControlModifier);
    EXPECT_EQ(target().loadN, 0.0);
}

TEST_F(ViewTest, ShiftMakesTheHandSlower) {
    moveTo(centre_ + QPoint(150, 0));
    moveTo(centre_);
    const Vec3 from = targetMm();
    moveTo(centre_ + QPoint(20, 0));
    const double quick = (targetMm() - from).norm();
    moveTo(centre_);
    moveTo(centre_, Qt::ShiftModifier);
    moveTo(centre_ + QPoint(20, 0), Qt::ShiftModifier);
    EXPECT_NEAR((targetMm() - from).norm(), input::kSlowFactor * quick, 0.1 * quick);
}

TEST_F(ViewTest, TheWheelSetsLoadAndStop) {
    QSignalSpy load(&view_, &ViewWidget::loadChanged), stop(&view_, &ViewWidget::stopChanged);
    wheel(3, Qt::ShiftModifier);
    EXPECT_NEAR(view_.hand()->loadN(), 1.3, 1e-9);
    wheel(-100, Qt::ShiftModifier);
    EXPECT_NEAR(view_.hand()->loadN(), input::kMinLoadN, 1e-9);
    EXPECT_EQ(load.count(), 2);
    EXPECT_FALSE(view_.hand()->stopMm());
    wheel(-1, Qt::ControlModifier);
    EXPECT_FALSE(view_.hand()->stopMm()) << "off is the lower end";
    wheel(1, Qt::ControlModifier);
    ASSERT_TRUE(view_.hand()->stopMm());
    const double first = *view_.hand()->stopMm();
    wheel(2, Qt::ControlModifier);
    EXPECT_NEAR(*view_.hand()->stopMm(), first + 0.2, 1e-9);
    wheel(-60, Qt::ControlModifier);
    EXPECT_FALSE(view_.hand()->stopMm());
    EXPECT_EQ(stop.count(), 3);
}

TEST_F(ViewTest, TurningTheViewFreezesTheBur) {
    const view::Camera before = view_.camera();
    press(Qt::RightButton, centre_);
    EXPECT_TRUE(target().frozen);
    moveTo(centre_ + QPoint(60, 25));
    EXPECT_GT((view_.camera().eyeMm - before.eyeMm).norm(), 1.0);
    EXPECT_NEAR(view_.camera().distanceMm(), before.distanceMm(), 1e-9);
    release(Qt::RightButton, centre_);
    EXPECT_FALSE(target().frozen);

    const view::Camera turned = view_.camera();
    press(Qt::RightButton, centre_, Qt::ShiftModifier);
    moveTo(centre_ + QPoint(20, 0), Qt::ShiftModifier);
    EXPECT_NEAR((view_.camera().targetMm - turned.targetMm).norm(),
                20 * view::mmPerPixel(turned, {800, 600}, turned.targetMm), 1e-6);
    release(Qt::RightButton, centre_, Qt::ShiftModifier);

    QTest::keyPress(&view_, Qt::Key_Space);
    const Vec3 eye = view_.camera().eyeMm;
    moveTo(centre_ + QPoint(90, 0));
    EXPECT_GT((view_.camera().eyeMm - eye).norm(), 1.0);
    EXPECT_TRUE(target().frozen);
    QTest::keyRelease(&view_, Qt::Key_Space);
    EXPECT_FALSE(target().frozen);
}

TEST_F(ViewTest, TheWheelGoesNearerToWhatIsUnderThePointer) {
    const Vec3 point = onBall(view_, centre_);
    const auto before = view::pixelOf(view_.camera(), {800, 600}, point);
    const double distance = (view_.camera().eyeMm - point).norm();
    wheel(3);
    EXPECT_LT((view_.camera().eyeMm - point).norm(), distance / 1.3);
    const auto after = view::pixelOf(view_.camera(), {800, 600}, point);
    ASSERT_TRUE(before && after);
    EXPECT_LT((*after - *before).norm(), 1.0);
}

TEST_F(ViewTest, KeysShowTheDentalViews) {
    QTest::keyClick(&view_, Qt::Key_1);
    EXPECT_GT(-view_.camera().forward().z(), 0.999);
    QTest::keyClick(&view_, Qt::Key_2);
    EXPECT_LT(view_.camera().forward().y(), -0.9) << "the cheek is +y: the eye looks along -y";
    QTest::keyClick(&view_, Qt::Key_4);
    EXPECT_LT(view_.camera().forward().x(), -0.9);
}

TEST_F(ViewTest, TheKeyboardAloneMovesAndCuts) {
    const Vec3 before = targetMm();
    QTest::keyClick(&view_, Qt::Key_Right);
    const Vec3 after = targetMm();
    EXPECT_NEAR((after - before).norm(), input::kNudgeMm, 0.02);
    EXPECT_GT((after - before).dot(view_.camera().right()), 0.08);
    QTest::keyClick(&view_, Qt::Key_PageUp, Qt::ShiftModifier);
    EXPECT_NEAR((targetMm() - after).norm(), input::kFineNudgeMm, 0.005);
    QTest::keyPress(&view_, Qt::Key_Return);
    EXPECT_EQ(target().pedal, 1.0);
    EXPECT_GT(target().loadN, 0.0);
    QTest::keyRelease(&view_, Qt::Key_Return);
    EXPECT_EQ(target().loadN, 0.0);
    QTest::keyClick(&view_, Qt::Key_P);
    EXPECT_TRUE(view_.hand()->pedalLatched());
    EXPECT_EQ(target().pedal, 1.0);
}

TEST_F(ViewTest, EscapeAndLostFocusStopTheBur) {
    press(Qt::LeftButton, centre_);
    QTest::keyClick(&view_, Qt::Key_Escape);
    EXPECT_TRUE(target().away);
    EXPECT_EQ(target().pedal, 0.0);
    EXPECT_FALSE(view_.hand()->isPressed());
    release(Qt::LeftButton, centre_);

    moveTo(centre_ + QPoint(5, 5));
    EXPECT_FALSE(target().away);
    QSignalSpy latched(&view_, &ViewWidget::pedalLatched);
    QTest::keyClick(&view_, Qt::Key_P);
    QFocusEvent lost(QEvent::FocusOut, Qt::OtherFocusReason);
    QApplication::sendEvent(&view_, &lost);
    EXPECT_TRUE(target().away);
    EXPECT_EQ(target().pedal, 0.0);
    ASSERT_EQ(latched.count(), 2);
    EXPECT_FALSE(latched[1][0].toBool());
}

TEST_F(ViewTest, TheHandTurnsTheBur) {
    const auto axis = [&] {
        const auto& q = target().orientation;
        return Vec3(core::Quat(q[0], q[1], q[2], q[3]) * Vec3::UnitZ());
    };
    moveTo(centre_);
    QTest::keyClick(&view_, Qt::Key_N);
    EXPECT_GT(axis().dot(onBall(view_, centre_).normalized()), 0.98);
    QTest::keyClick(&view_, Qt::Key_R);
    EXPECT_GT(axis().z(), 0.999);
    const Vec3 tip = targetMm();
    QTest::keyPress(&view_, Qt::Key_T);
    moveTo(centre_ + QPoint(40, 0));
    QTest::keyRelease(&view_, Qt::Key_T);
    EXPECT_LT(axis().z(), 0.9999);
    EXPECT_LT((targetMm() - tip).norm(), 1e-6);
}

TEST_F(ViewTest, OtherKeysAskForWhatIsNotTheViews) {
    QSignalSpy bur(&view_, &ViewWidget::burStepRequested), speed(&view_, &ViewWidget::speedStepRequested),
        help(&view_, &ViewWidget::helpRequested);
    QTest::keyClick(&view_, Qt::Key_Period);
    QTest::keyClick(&view_, Qt::Key_Comma);
    QTest::keyClick(&view_, Qt::Key_Plus, Qt::ShiftModifier);
    QTest::keyClick(&view_, Qt::Key_Minus);
    QTest::keyClick(&view_, Qt::Key_F1);
    ASSERT_EQ(bur.count(), 2);
    EXPECT_EQ(bur[0][0].toInt(), 1);
    EXPECT_EQ(bur[1][0].toInt(), -1);
    ASSERT_EQ(speed.count(), 2);
    EXPECT_EQ(speed[0][0].toInt(), 1);
    EXPECT_EQ(help.count(), 1);
}

TEST_F(ViewTest, WithTheMouseInTheLeftHandTheButtonsChange) {
    view_.setBindings(KeyBindings::of(KeyBindings::Set::leftHanded));
    press(Qt::RightButton, centre_);
    EXPECT_EQ(target().pedal, 1.0);
    release(Qt::RightButton, centre_);
    press(Qt::LeftButton, centre_);
    EXPECT_EQ(target().pedal, 0.0);
    EXPECT_TRUE(target().frozen);
    release(Qt::LeftButton, centre_);
}

TEST_F(ViewTest, AKeyBoundAnewDoesWhatItIsBoundTo) {
    KeyBindings bindings;
    ASSERT_TRUE(bindings.set(Action::latchPedal, 0, *Binding::fromId("key:K")));
    view_.setBindings(bindings);
    QTest::keyClick(&view_, Qt::Key_P);
    EXPECT_FALSE(view_.hand()->pedalLatched());
    QTest::keyClick(&view_, Qt::Key_K);
    EXPECT_TRUE(view_.hand()->pedalLatched());
}

TEST_F(ViewTest, TheCalliperMeasuresBetweenTwoClicks) {
    QSignalSpy measured(&view_, &ViewWidget::measured);
    QTest::keyClick(&view_, Qt::Key_D);
    ASSERT_EQ(view_.tool(), Tool::calliper);
    EXPECT_TRUE(target().frozen) << "the bur waits";
    const QPoint a(350, 280), b(460, 330);
    for (const QPoint& at : {a, b}) {
        press(Qt::LeftButton, at);
        release(Qt::LeftButton, at);
    }
    ASSERT_EQ(measured.count(), 1);
    const auto one = measured[0][0].value<Measurement>();
    EXPECT_EQ(one.kind, Measurement::Kind::distance);
    EXPECT_NEAR(one.valueMm, (onBall(view_, a) - onBall(view_, b)).norm(), 0.05);
    EXPECT_EQ(target().loadN, 0.0) << "a click of a tool does not cut";
}

TEST_F(ViewTest, TheCalliperMeasuresBetweenTwoPointsPickedByKeys) {
    QSignalSpy measured(&view_, &ViewWidget::measured);
    QEvent leave(QEvent::Leave);
    QApplication::sendEvent(&view_, &leave);
    QTest::keyClick(&view_, Qt::Key_D);
    ASSERT_EQ(view_.tool(), Tool::calliper);
    // The cross begins in the middle: 8 pixels a step, one with Shift.
    for (int i = 0; i < 6; ++i)
        QTest::keyClick(&view_, Qt::Key_Left);
    QTest::keyClick(&view_, Qt::Key_Left, Qt::ShiftModifier);
    QTest::keyClick(&view_, Qt::Key_Return);
    for (int i = 0; i < 13; ++i)
        QTest::keyClick(&view_, Qt::Key_Right);
    for (int i = 0; i < 4; ++i)
        QTest::keyClick(&view_, Qt::Key_Down);
    const QImage crossed = view_.snapshot();
    QTest::keyClick(&view_, Qt::Key_Return);
    ASSERT_EQ(measured.count(), 1);
    const QPoint a = centre_ - QPoint(49, 0), b = a + QPoint(104, 32);
    EXPECT_NEAR(measured[0][0].value<Measurement>().valueMm, (onBall(view_, a) - onBall(view_, b)).norm(), 0.05);
    EXPECT_EQ(target().loadN, 0.0) << "the key that cuts only picks";
    // The cross is seen, and the mouse takes it away.
    const auto armsOf = [&](const QImage& image) { return std::pair(image.copy(b.x() + 6, b.y() - 3, 6, 6), image); };
    view_.clearMeasurements();
    const QImage alone = view_.snapshot();
    moveTo({20, 500});
    EXPECT_NE(armsOf(alone).first, armsOf(view_.snapshot()).first);
    EXPECT_EQ(armsOf(alone).first, armsOf(crossed).first);
}

TEST_F(ViewTest, DepthAndPulpArePickedByKeys) {
    QSignalSpy measured(&view_, &ViewWidget::measured);
    QEvent leave(QEvent::Leave);
    QApplication::sendEvent(&view_, &leave);
    for (const Tool tool : {Tool::depth, Tool::pulp}) {
        view_.setTool(tool);
        QTest::keyClick(&view_, Qt::Key_Return);
    }
    ASSERT_EQ(measured.count(), 2);
    EXPECT_NEAR(measured[0][0].value<Measurement>().valueMm, 0.0, 0.02);
    EXPECT_NEAR(measured[1][0].value<Measurement>().valueMm, kRadius - kPulpRadius, 0.15);
}

/// What each action of a button or the wheel does is done by keys as well.
TEST_F(ViewTest, TheKeysDoAllThatThePointerDoes) {
    const auto instead = [](Action action) -> std::vector<Action> {
        switch (action) {
            case Action::cut:
                return {Action::cutKey};
            case Action::touch:
                return {Action::touchKey};
            case Action::orbit:
                return {Action::orbitHold};
            case Action::pan:
                return {Action::panHold};
            case Action::zoom:
                return {Action::nearer, Action::farther};
            case Action::load:
                return {Action::moreLoad, Action::lessLoad};
            case Action::stop:
                return {Action::deeperStop, Action::shallowerStop};
            case Action::pass:
                return {Action::deeperPass, Action::shallowerPass};
            default:
                return {};
        }
    };
    for (const auto set : {KeyBindings::Set::rightHanded, KeyBindings::Set::leftHanded}) {
        const KeyBindings bindings = KeyBindings::of(set);
        for (const ActionInfo& info : actionInfos()) {
            if (info.takes != ActionInfo::Takes::buttons && info.takes != ActionInfo::Takes::wheel) continue;
            EXPECT_FALSE(instead(info.action).empty()) << info.name << " has no key";
            for (const Action key : instead(info.action)) {
                EXPECT_EQ(infoOf(key).takes, ActionInfo::Takes::keys);
                EXPECT_EQ(bindings.of(key)[0].kind, Binding::Kind::key) << infoOf(key).name;
            }
        }
    }

    // Space and an arrow turn as far as a drag of as many pixels.
    const view::Camera first = view_.camera();
    press(Qt::RightButton, centre_);
    moveTo(centre_ + QPoint(20, 0));
    release(Qt::RightButton, centre_ + QPoint(20, 0));
    const view::Camera dragged = view_.camera();
    view_.setCamera(first);
    QTest::keyPress(&view_, Qt::Key_Space);
    QTest::keyClick(&view_, Qt::Key_Right);
    QTest::keyRelease(&view_, Qt::Key_Space);
    EXPECT_NEAR((view_.camera().eyeMm - dragged.eyeMm).norm(), 0.0, 1e-9);
    QTest::keyClick(&view_, Qt::Key_Right);
    EXPECT_NEAR((view_.camera().eyeMm - dragged.eyeMm).norm(), 0.0, 1e-9) << "without the key the bur moves";

    view_.setCamera(first);
    press(Qt::MiddleButton, centre_);
    moveTo(centre_ + QPoint(0, -20));
    release(Qt::MiddleButton, centre_ + QPoint(0, -20));
    const view::Camera shifted = view_.camera();
    view_.setCamera(first);
    QTest::keyPress(&view_, Qt::Key_Space, Qt::ShiftModifier);
    QTest::keyClick(&view_, Qt::Key_Up, Qt::ShiftModifier);
    QTest::keyRelease(&view_, Qt::Key_Space, Qt::ShiftModifier);
    EXPECT_GT((shifted.eyeMm - first.eyeMm).norm(), 0.1);
    EXPECT_NEAR((view_.camera().eyeMm - shifted.eyeMm).norm(), 0.0, 1e-9);

    view_.setCamera(first);
    moveTo(centre_);
    wheel(1);
    const double near = view_.camera().distanceMm();
    view_.setCamera(first);
    QTest::keyClick(&view_, Qt::Key_Plus, Qt::ControlModifier);
    EXPECT_NEAR(view_.camera().distanceMm(), near, 1e-9);
    QTest::keyClick(&view_, Qt::Key_Minus, Qt::ControlModifier);
    EXPECT_NEAR(view_.camera().distanceMm(), first.distanceMm(), 1e-9);

    // Tilting: the handle's end goes where the arrow points.
    const auto axis = [&] {
        const auto& q = target().orientation;
        return Vec3(core::Quat(q[0], q[1], q[2], q[3]) * Vec3::UnitZ());
    };
    const Vec3 upright = axis();
    QTest::keyPress(&view_, Qt::Key_T);
    QTest::keyClick(&view_, Qt::Key_Right);
    QTest::keyRelease(&view_, Qt::Key_T);
    EXPECT_GT((axis() - upright).dot(view_.camera().right()), 0.02);

    const double loadN = view_.hand()->loadN();
    QTest::keyClick(&view_, Qt::Key_W);
    EXPECT_NEAR(view_.hand()->loadN(), loadN + 0.1, 1e-9);
    QTest::keyClick(&view_, Qt::Key_S);
    EXPECT_NEAR(view_.hand()->loadN(), loadN, 1e-9);
    EXPECT_FALSE(view_.hand()->stopMm());
    QTest::keyClick(&view_, Qt::Key_V);
    ASSERT_TRUE(view_.hand()->stopMm());
    const double stopMm = *view_.hand()->stopMm();
    QTest::keyClick(&view_, Qt::Key_V);
    EXPECT_NEAR(*view_.hand()->stopMm(), stopMm + 0.1, 1e-9);
    for (int i = 0; i < 40 && view_.hand()->stopMm(); ++i)
        QTest::keyClick(&view_, Qt::Key_G);
    EXPECT_FALSE(view_.hand()->stopMm());

    QTest::keyPress(&view_, Qt::Key_Return, Qt::ControlModifier);
    EXPECT_TRUE(view_.hand()->isPressed());
    EXPECT_EQ(target().pedal, 0.0) << "with the bur still";
    QTest::keyRelease(&view_, Qt::Key_Return, Qt::ControlModifier);
    EXPECT_FALSE(view_.hand()->isPressed());
}

TEST_F(ViewTest, AMeasureIsWrittenOnceAndNotThroughTheTooth) {
    view_.setTool(Tool::depth);
    press(Qt::LeftButton, centre_);
    release(Qt::LeftButton, centre_);
    // Kept, it is no longer read as well while the pointer stays; elsewhere there is a reading again.
    EXPECT_EQ(view_.written().measurements.size(), 1u);
    EXPECT_FALSE(view_.written().reading);
    press(Qt::LeftButton, centre_);
    release(Qt::LeftButton, centre_);
    EXPECT_EQ(view_.written().measurements.size(), 1u) << "twice at one place";
    moveTo(centre_ + QPoint(40, 0));
    EXPECT_TRUE(view_.written().reading);
    // From behind the tooth hides it.
    const view::Camera front = view_.camera();
    view::Camera behind = front;
    behind.eyeMm = 2.0 * front.targetMm - front.eyeMm;
    view_.setCamera(behind);
    EXPECT_TRUE(view_.written().measurements.empty());
    view_.setCamera(front);
    EXPECT_EQ(view_.written().measurements.size(), 1u);
}

TEST_F(ViewTest, DepthAndPulpAreReadWhereOneClicks) {
    QSignalSpy measured(&view_, &ViewWidget::measured);
    view_.setTool(Tool::depth);
    press(Qt::LeftButton, centre_);
    release(Qt::LeftButton, centre_);
    view_.setTool(Tool::pulp);
    press(Qt::LeftButton, centre_);
    release(Qt::LeftButton, centre_);
    ASSERT_EQ(measured.count(), 2);
    const auto depth = measured[0][0].value<Measurement>(), pulp = measured[1][0].value<Measurement>();
    EXPECT_EQ(depth.kind, Measurement::Kind::depth);
    EXPECT_NEAR(depth.valueMm, 0.0, 0.02);
    EXPECT_EQ(pulp.kind, Measurement::Kind::pulp);
    EXPECT_NEAR(pulp.valueMm, kRadius - kPulpRadius, 0.15);
    EXPECT_EQ(pulpLight(pulp.valueMm), Light::good);
    EXPECT_EQ(pulpLight(0.3), Light::near);
    EXPECT_EQ(pulpLight(0.1), Light::harmed);
    EXPECT_EQ(pulpLight(0.87), Light::good);
    EXPECT_EQ(pulpLight(0.87, {1.0, 0.5}), Light::near);
    EXPECT_EQ(pulpLight(0.4, {1.0, 0.5}), Light::harmed);
}

TEST_F(ViewTest, TheSectionStepsAndIsCutThrough) {
    QTest::keyClick(&view_, Qt::Key_X);
    ASSERT_EQ(view_.tool(), Tool::section);
    ASSERT_TRUE(view_.section());
    const double at = view_.section()->offsetMm;
    QTest::keyClick(&view_, Qt::Key_Right);
    EXPECT_NEAR(view_.section()->offsetMm, at + 0.1, 1e-9);
    wheel(-2);
    EXPECT_NEAR(view_.section()->offsetMm, at - 0.1, 1e-9);
    QDoubleSpinBox* box = view_.findChild<QDoubleSpinBox*>("sectionBarOffset");
    ASSERT_TRUE(box && box->isVisible());
    EXPECT_NEAR(box->value(), at - 0.1, 1e-9);
    box->setValue(0.5);
    EXPECT_NEAR(view_.section()->offsetMm, 0.5, 1e-9);

    // Looking along -x at the plane x = 0.5, one measures on its face: from rim to rim.
    view_.showStandardView(view::StandardView::mesial);
    view_.setTool(Tool::calliper);
    QSignalSpy measured(&view_, &ViewWidget::measured);
    const double r = std::sqrt(kRadius * kRadius - 0.25) - 0.05;
    for (const double side : {-1.0, 1.0}) {
        const auto pixel = view::pixelOf(view_.camera(), {800, 600}, Vec3(0.5, side * r, 0));
        ASSERT_TRUE(pixel);
        press(Qt::LeftButton, {static_cast<int>(std::lround(pixel->x())), static_cast<int>(std::lround(pixel->y()))});
        release(Qt::LeftButton, {0, 0});
    }
    ASSERT_EQ(measured.count(), 1);
    EXPECT_NEAR(measured[0][0].value<Measurement>().valueMm, 2 * r, 0.15);
    QTest::keyClick(&view_, Qt::Key_X);
    EXPECT_FALSE(view_.section());
}

TEST_F(ViewTest, WhatTheExerciseLocksStaysAway) {
    view_.setTool(Tool::depth);
    cases::Exercise exercise;
    exercise.lockedHelps = {"depth", "cross-section", "transparency"};
    view_.setPermissions(exercise::permissionsOf(&exercise, exercise::WorkMode::work));
    EXPECT_EQ(view_.tool(), Tool::drill);
    QTest::keyClick(&view_, Qt::Key_D);
    EXPECT_EQ(view_.tool(), Tool::drill);
    QTest::keyClick(&view_, Qt::Key_X);
    EXPECT_FALSE(view_.section());
    QTest::keyClick(&view_, Qt::Key_C);
    EXPECT_FALSE(view_.isComparing());
    view_.setPermissions({});
    QTest::keyClick(&view_, Qt::Key_C);
    EXPECT_TRUE(view_.isComparing());
}

TEST_F(ViewTest, AfterAnotherViewTheBurIsUnderThePointerAgain) {
    moveTo(centre_ + QPoint(40, 20));
    QTest::keyClick(&view_, Qt::Key_1);
    const Vec3 hovered = targetMm();
    EXPECT_LE((hovered - onBall(view_, centre_ + QPoint(40, 20))).norm(), 2.5);
    QTest::keyClick(&view_, Qt::Key_Up);
    const Vec3 byKeys = targetMm();
    QTest::keyClick(&view_, Qt::Key_2);
    EXPECT_LT((targetMm() - byKeys).norm(), 1e-9) << "where keys put it it stays";
}

TEST_F(ViewTest, TheMirrorIsDraggedAndTheBurWaits) {
    QSignalSpy mirror(&view_, &ViewWidget::mirrorChanged);
    QTest::keyClick(&view_, Qt::Key_M);
    EXPECT_TRUE(view_.isMirrorShown());
    EXPECT_EQ(view_.tool(), Tool::mirror);
    press(Qt::LeftButton, centre_);
    moveTo(centre_ + QPoint(40, 10));
    release(Qt::LeftButton, centre_ + QPoint(40, 10));
    EXPECT_EQ(target().loadN, 0.0);
    EXPECT_TRUE(target().frozen);
    view_.setTool(Tool::drill);
    EXPECT_TRUE(view_.isMirrorShown()) << "it stays while one cuts";
    EXPECT_FALSE(target().frozen);
    QTest::keyClick(&view_, Qt::Key_M);
    EXPECT_FALSE(view_.isMirrorShown());
    EXPECT_EQ(mirror.count(), 2);
}

TEST_F(ViewTest, TheHandlesOfOneViewServeBothHalves) {
    view_.setCompare(true);
    moveTo({120, 300});
    const Vec3 left = targetMm();
    moveTo({10, 10});
    moveTo({520, 300});
    EXPECT_LT((targetMm() - left).norm(), 0.05);
}

/// Every corner of the ball's box lies in a picture of this size.
bool sees(const view::Camera& camera, const view::Viewport& port) {
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 at(corner & 1 ? kRadius : -kRadius, corner & 2 ? kRadius : -kRadius,
                      corner & 4 ? kRadius : -kRadius);
        const auto pixel = view::pixelOf(camera, port, at);
        if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > port.width || pixel->y() > port.height)
            return false;
    }
    return true;
}

TEST_F(ViewTest, ComparingShowsTheWholeToothInEachHalfAndGivesTheEyeBack) {
    view_.resize(800, 700);  // so that the tooth as it stands is wider than half a picture
    view_.showStandardView(view::StandardView::occlusal);
    const view::Camera before = view_.camera();
    ASSERT_FALSE(sees(before, {400, 700}));
    view_.setCompare(true);
    EXPECT_TRUE(sees(view_.camera(), {400, 700}));
    EXPECT_LT((view_.camera().forward() - before.forward()).norm(), 1e-9);
    view_.setCompare(false);
    EXPECT_EQ((view_.camera().eyeMm - before.eyeMm).norm(), 0.0);

    // Turned meanwhile, it keeps the direction and comes as near as it was.
    view_.setCompare(true);
    view_.setCamera(view::orbited(view_.camera(), 0.4, 0.2));
    const Vec3 forward = view_.camera().forward();
    view_.setCompare(false);
    EXPECT_LT((view_.camera().forward() - forward).norm(), 1e-9);
    EXPECT_NEAR(view_.camera().distanceMm(), before.distanceMm(), 1e-6);
}

TEST_F(ViewTest, TheLooksScaleBarIsTheOneThatIsDrawn) {
    EXPECT_TRUE(view_.look().scaleBar) << "there is one at the start";
    const QImage with = view_.snapshot();
    view::Look look = view_.look();
    look.scaleBar = false;
    view_.setLook(look);
    const QImage without = view_.snapshot();
    const auto letters = [&](const QImage& picture) {  // what is written is paler than anything that is drawn there
        int count = 0;
        for (int y = view_.height() - 60; y < view_.height(); ++y)
            for (int x = 0; x < 150; ++x)
                count += picture.pixelColor(x, y).lightness() > 225;
        return count;
    };
    EXPECT_GT(letters(with), 50);
    EXPECT_EQ(letters(without), 0);
}

/// Lets the drawing come to rest after a change; false where nothing is drawn for want of OpenGL.
bool comesToRest(ViewWidget& view) {
    QSignalSpy missing(&view, &ViewWidget::openGlMissing), frames(&view, &ViewWidget::frameDrawn);
    EXPECT_TRUE(QTest::qWaitFor([&] { return frames.count() + missing.count() > 0; }, 60000)) << "nothing is drawn";
    if (frames.isEmpty()) return false;
    // Quiet for longer than a picture takes that is being drawn now, in small steps: of a process that was not let run
    // meanwhile nothing is to be seen.
    // The first picture of a comparison makes a renderer of its own.
    constexpr int kStepMs = 25, kLongestMs = 300000;
    constexpr double kQuietMs = 1500.0;
    double slowestMs = 0.0, quietMs = 0.0;
    bool refining = true;
    qsizetype seen = 0;
    QElapsedTimer since;
    since.start();
    while (refining || quietMs < kQuietMs + 4.0 * slowestMs) {
        if (since.hasExpired(kLongestMs)) {
            ADD_FAILURE() << "it never comes to rest";
            break;
        }
        QTest::qWait(kStepMs);
        QCoreApplication::processEvents();
        quietMs += kStepMs;
        for (; seen < frames.count(); ++seen) {
            const auto report = frames[seen][0].value<view::FrameReport>();
            slowestMs = std::max(slowestMs, report.drawMs + report.readMs);
            refining = report.refining;
            quietMs = 0.0;
        }
    }
    return true;
}

TEST_F(ViewTest, AComparedPictureIsAsFineAtRestAsOneAlone) {
    if (!comesToRest(view_)) GTEST_SKIP() << "no OpenGL 3.3 here";
    view::Look look = view_.look();
    look.bur = look.turbine = false;
    view_.setLook(look);
    view_.setCompare(true);
    view_.setCamera(view::orbited(view_.camera(), 0.5, 0.3));  // in motion both are coarse
    const view::Camera eye = view_.camera();
    ASSERT_TRUE(comesToRest(view_));
    const QImage both = view_.snapshot();
    view_.setCompare(false);
    view_.resize(400, 600);
    view_.setCamera(eye);
    ASSERT_TRUE(comesToRest(view_));
    const QImage one = view_.snapshot();
    const QRect ball(100, 180, 200, 240);  // clear of all that is written
    int before = 0, now = 0;
    for (int y = ball.top(); y < ball.bottom(); ++y)
        for (int x = ball.left(); x < ball.right(); ++x) {
            const auto differs = [&](QRgb a, QRgb b) {
                return std::abs(qRed(a) - qRed(b)) + std::abs(qGreen(a) - qGreen(b)) + std::abs(qBlue(a) - qBlue(b)) >
                       6;
            };
            before += differs(both.pixel(x, y), one.pixel(x, y));
            now += differs(both.pixel(400 + x, y), one.pixel(x, y));
        }
    EXPECT_EQ(before, 0);
    EXPECT_EQ(now, 0);
}

/// What hides the tooth: pixels that the overlay paints within the outline of a tooth of a first molar's size.
int hidden(const QSize& size, view::StandardView standard, const OverlayState& written, bool compare = false) {
    const core::Box crown{Vec3(-5.5, -5.2, -3.5), Vec3(5.5, 5.2, 3.5)};
    const view::Viewport port{compare ? size.width() / 2 : size.width(), size.height()};
    OverlayState state = written;
    state.camera = clearOfWriting(view::standardView(standard, crown, 1, port), port);
    state.compare = compare;
    QPolygonF points;
    const auto bent = [](double v) { return std::copysign(std::pow(std::abs(v), 0.7), v); };  // rounder than a box
    for (int i = 0; i < 60; ++i)
        for (int j = 0; j <= 30; ++j) {
            const double a = 2 * std::numbers::pi * i / 60, b = std::numbers::pi * (j / 30.0 - 0.5);
            const Vec3 at(5.5 * bent(std::cos(a)) * bent(std::cos(b)), 5.2 * bent(std::sin(a)) * bent(std::cos(b)),
                          3.5 * bent(std::sin(b)));
            const auto pixel = view::pixelOf(state.camera, port, at);
            if (pixel) points << QPointF(pixel->x(), pixel->y());
        }
    QImage paper(size, QImage::Format_ARGB32_Premultiplied), tooth(size, QImage::Format_ARGB32_Premultiplied);
    paper.fill(Qt::transparent);
    tooth.fill(Qt::transparent);
    QPainter painter(&paper);
    paintOverlay(painter, QRect(QPoint(), size), state);
    painter.end();
    QPainter dots(&tooth);
    dots.setPen(QPen(Qt::white, 8));
    for (const QPointF& point : points)
        for (int half = 0; half <= (compare ? 1 : 0); ++half)
            dots.drawPoint(point + QPointF(half * port.width, 0));
    dots.end();
    int count = 0;
    for (int y = 0; y < size.height(); ++y)
        for (int x = 0; x < size.width(); ++x) {
            const bool seam = compare && std::abs(x - port.width) < 3;
            count += !seam && qAlpha(paper.pixel(x, y)) > 0 && qAlpha(tooth.pixel(x, y)) > 0;
        }
    return count;
}

TEST(Overlay, WritesNothingOverTheToothInASmallWindow) {
    OverlayState state;
    state.hasHand = state.scaleBar = true;
    state.loadN = 1.0;
    state.stopMm = 1.5;
    state.legend =
        view::legendOf({cases::Tissue::enamel, cases::Tissue::dentine, cases::Tissue::pulp, cases::Tissue::caries,
                        cases::Tissue::gum, cases::Tissue::bone, cases::Tissue::neighbour},
                       view::Palette::natural);
    // The picture's sizes at 1366 x 768 and at 1280 x 720, in the three layouts.
    for (const QSize size : {QSize(788, 674), QSize(788, 631), QSize(788, 352), QSize(702, 583)})
        for (const auto& [standard, name] : view::standardViews())
            for (const QString& hint :
                 {QString(), QString("Point at the cavity's floor; a click keeps what is left")}) {
                state.hint = hint;
                EXPECT_EQ(hidden(size, standard, state), 0) << name << ", " << size.width() << " x " << size.height();
                if (!hint.isEmpty()) continue;
                EXPECT_EQ(hidden(size, standard, state, true), 0)
                    << name << " compared, " << size.width() << " x " << size.height();
            }
}

TEST(Overlay, KeptReadingsAreOutOfTheWayWhileOneCuts) {
    OverlayState state;
    state.hasHand = true;
    Measurement depth;
    depth.kind = Measurement::Kind::depth;
    depth.fromMm = depth.toMm = Vec3(0, 0, 3.5);
    state.measurements.push_back(depth);
    const QSize size(788, 631);
    EXPECT_GT(hidden(size, view::StandardView::occlusal, state), 200);
    state.pressed = true;
    EXPECT_EQ(hidden(size, view::StandardView::occlusal, state), 0);
}

TEST_F(ViewTest, TheCardOfKeysComesAndGoes) {
    press(Qt::LeftButton, centre_);
    view_.toggleHelpCard();
    QWidget* card = view_.findChild<QWidget*>("helpCard");
    ASSERT_TRUE(card && card->isVisible());
    QTest::keyClick(card, Qt::Key_F1);
    EXPECT_FALSE(card->isVisible());
    view_.toggleHelpCard();
    bool shown = false;
    for (const QWidget* one : view_.findChildren<QWidget*>("helpCard"))
        shown = shown || one->isVisible();
    EXPECT_TRUE(shown);
}

TEST_F(ViewTest, GingivaThatWasCutBleedsUntilItIsStanched) {
    const auto bur = instrument::makeInstrument("round-4").bur;
    messages::HapticSample sample;
    sample.timeS = 1.0;
    live_->gingiva().hear(sample, *bur);
    EXPECT_FALSE(view_.isBleeding());
    sample.timeS = 2.0;
    sample.flags = messages::kCutsGingiva;
    live_->gingiva().hear(sample, *bur);
    EXPECT_TRUE(view_.isBleeding());
    sample.timeS = 3.0;
    sample.flags = 0;
    live_->gingiva().hear(sample, *bur);
    EXPECT_TRUE(view_.isBleeding());
    view_.clearBlood();
    EXPECT_FALSE(view_.isBleeding());
}

TEST_F(ViewTest, InAReplayMouseAndKeysTurnTheViewOnly) {
    view_.setPointer(nullptr, {});
    EXPECT_EQ(view_.hand(), nullptr);
    press(Qt::LeftButton, centre_);
    release(Qt::LeftButton, centre_);
    QTest::keyClick(&view_, Qt::Key_Left);
    messages::HapticSample sample;
    sample.proxyPositionMm = {1, 2, 9};
    view_.setSample(sample);
    EXPECT_EQ(view_.sample().proxyPositionMm[2], 9.0);
    const view::Camera before = view_.camera();
    press(Qt::RightButton, centre_);
    moveTo(centre_ + QPoint(50, 0));
    release(Qt::RightButton, centre_);
    EXPECT_GT((view_.camera().eyeMm - before.eyeMm).norm(), 1.0);
}

TEST_F(ViewTest, ItDrawsWhenSomethingChangesAndRestsElse) {
    if (!comesToRest(view_)) GTEST_SKIP() << "no OpenGL 3.3 here";
    QSignalSpy frames(&view_, &ViewWidget::frameDrawn);
    QTest::qWait(500);
    EXPECT_EQ(frames.count(), 0) << "nothing changes: nothing is drawn";
    const QImage picture = view_.snapshot();
    EXPECT_EQ(picture.size(), QSize(800, 600));
    EXPECT_NE(picture.pixel(400, 300), picture.pixel(5, 150)) << "a ball before the ground";
    view_.showStandardView(view::StandardView::occlusal);
    EXPECT_TRUE(frames.wait(60000));
}

TEST(ViewWithoutATooth, TakesEverythingCalmly) {
    ViewWidget view;
    view.resize(400, 300);
    view.show();
    for (const int key : {Qt::Key_D, Qt::Key_X, Qt::Key_M, Qt::Key_C, Qt::Key_C, Qt::Key_F, Qt::Key_1, Qt::Key_Return})
        QTest::keyClick(&view, static_cast<Qt::Key>(key));
    QTest::mouseClick(&view, Qt::LeftButton, Qt::NoModifier, {100, 100});
    view.setLoad(2.0);
    view.escape();
    EXPECT_FALSE(view.snapshot().isNull());
    EXPECT_EQ(view.tool(), Tool::drill);
}

}  // namespace
}  // namespace handpiece::desktop::view_widget_test
