// SPDX-License-Identifier: Apache-2.0
// A device in the window: chosen, cut with, unplugged, set up, checked.
#include <QCheckBox>
#include <QComboBox>
#include <QDialog>
#include <QFile>
#include <QInputDialog>
#include <QLabel>
#include <QMenu>
#include <QPushButton>
#include <QRegularExpression>
#include <QSpinBox>
#include <QTabWidget>
#include <QToolButton>
#include <QTreeWidget>
#include <atomic>
#include <thread>

#include "desktop/features/device/fidelity_box.h"
#include "desktop/features/device/first_plug_in.h"
#include "desktop/features/device/profile_box.h"
#include "desktop/features/drill/welcome_strip.h"
#include "desktop/widgets/notice_bar.h"
#include "devices/drivers/gamepad_virtual.h"
#include "handpiece/app/simulation/cut_session.h"
#include "handpiece/app/simulation/session_player.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/rt/clock.h"
#include "led_driver.h"
#include "shell_support.h"

namespace handpiece::desktop::device_window_test {
namespace {

class DeviceWindowTest : public ShellTest {
  protected:
    [[nodiscard]] Simulator::Options options() const override {
        Simulator::Options options = ShellTest::options();
        options.hands.profiles = at("devices");
        options.hands.patience = std::chrono::milliseconds(200);
        options.hands.desk.look = [] {
            drivers::Found there, absent;
            there.driver = "openhaptics";
            there.makes = "Led arms";
            there.available = true;
            there.models = {"Led Arm"};
            absent.driver = "haply";
            absent.makes = "Haply Inverse3";
            absent.why = "Its service is not running.";
            absent.remedy = "Start Haply Hub.";
            return std::vector<drivers::Found>{there, absent};
        };
        options.hands.desk.open = [led = led_](const input::DeviceChoice& choice) {
            if (choice.name != "openhaptics" || led->unplugged)
                throw core::Error("it is not there", choice.name, "plug it in").as("device-missing", {choice.name});
            return input::openDevice(std::make_unique<LedDriver>(led), choice);
        };
        options.hands.desk.driver = [led = led_](const input::DeviceChoice&) {
            return std::make_unique<LedDriver>(led);
        };
        return options;
    }
    void startHere(const CommandLine& line = {}) { startWithTooth(line); }
    [[nodiscard]] DeviceManager& hands() { return simulator().hands(); }
    [[nodiscard]] QAction* entry(const char* name) {
        return window().findChild<QAction*>(QStringLiteral("actionDevice_") + QLatin1String(name));
    }
    template <class W>
    [[nodiscard]] W* part(const char* name) {
        return window().findChild<W*>(QLatin1String(name));
    }
    [[nodiscard]] QString noticed() { return window().findChild<NoticeBar*>()->current(); }
    /// By the menu, as a person does.
    [[nodiscard]] bool choose(const char* name) {
        hands().look();
        if (!waitFor([&] { return entry(name) != nullptr; })) return false;
        entry(name)->trigger();
        return true;
    }
    [[nodiscard]] bool chooseLed() {
        host_->settings().set(QStringLiteral("device/seen_openhaptics"), true);
        return choose("openhaptics") && waitFor([&] { return simulator().usedHand() && !simulator().isBusy(); });
    }
    /// Where the hand must be to have the bur there, tip down.
    void leadBur(const core::Vec3& toothMm, const input::ToothPlace& place) {
        const workspace::WorkspaceMapping p = input::placingFor(hands().current()->profile(), place);
        const core::Quat stylus = p.toothInDevice * workspace::WorkspaceTransform(p).burInStylus().conjugate();
        const core::Vec3 at =
            p.deviceMm + p.scale * (p.toothInDevice * (toothMm - p.toothMm)) - stylus * p.tipFromStylusMm;
        const std::lock_guard lock(led_->mutex);
        led_->orientation = {stylus.w(), stylus.x(), stylus.y(), stylus.z()};
        led_->toMm = {at.x(), at.y(), at.z()};
    }
    [[nodiscard]] bool burTo(double x, double z) {
        const cases::Case& c = *simulator().toothCase();
        const core::Box box = c.outer.bounds();
        const core::Vec3 to(x, 0.0, box.max.z() + z);
        leadBur(to, {box, c.fdiNumber, c.buccalSign});
        return waitFor([&] {
            const auto& at = simulator().sample().positionMm;
            return led_->hasCome() && std::abs(at[0] - to.x()) < 0.02 && std::abs(at[2] - to.z()) < 0.02;
        });
    }
    /// With the upper button down, into the middle of the crown.
    [[nodiscard]] bool cutWithIt() {
        const double before = removedMm3();
        if (!burTo(0.0, 1.0)) return false;
        led_->buttons = 1;
        if (!waitFor([&] { return simulator().sample().pedal > 0.5 && simulator().sample().speedRpm > 1000.0; }))
            return false;
        const core::Box box = simulator().toothCase()->outer.bounds();
        leadBur({0.0, 0.0, box.max.z() - 1.0},
                {box, simulator().toothCase()->fdiNumber, simulator().toothCase()->buccalSign});
        return waitFor([&] { return removedMm3() > before + 0.05; });
    }
    [[nodiscard]] bool liftIt() {
        led_->buttons = 0;
        return burTo(0.0, 2.0) && waitFor([&] { return !simulator().status().inStroke; });
    }

    std::shared_ptr<Led> led_ = std::make_shared<Led>();
};

TEST_F(DeviceWindowTest, CutsUntilItIsUnpluggedThenTheMouseGoesOnAndNothingIsLost) {
    startHere();
    ASSERT_TRUE(simulator().mailbox());
    ASSERT_TRUE(choose("haply"));
    ASSERT_TRUE(waitFor([&] { return window().errorDialog() != nullptr; }));
    EXPECT_TRUE(window().errorDialog()->findChild<QLabel*>("errorWhat")->text().contains("haply"));
    window().errorDialog()->close();
    EXPECT_TRUE(simulator().mailbox());

    ASSERT_TRUE(chooseLed());
    EXPECT_FALSE(simulator().mailbox());
    EXPECT_EQ(simulator().capability().maxForceN, 3.0);
    const auto* welcome = window().findChild<WelcomeStrip*>();
    EXPECT_TRUE(waitFor([&] { return welcome->text().contains("Move the handpiece"); }))
        << welcome->text().toStdString();
    EXPECT_TRUE(entry("openhaptics")->isChecked());
    EXPECT_FALSE(entry("mouse")->isChecked());
    EXPECT_EQ(host_->settings().value("work/device").toString(), "openhaptics");
    const auto* field = part<QToolButton>("statusDevice");
    EXPECT_TRUE(waitFor([&] { return field->text().contains("Led Arm") && field->text().contains("Hz"); }))
        << field->text().toStdString();

    EXPECT_TRUE(waitFor([&] { return part<QLabel>("deviceLimits")->text().contains("Led Arm"); }))
        << part<QLabel>("deviceLimits")->text().toStdString();

    ASSERT_TRUE(cutWithIt());
    EXPECT_GT(led_->largestSentN, 0.05);
    EXPECT_LE(led_->largestSentN, 3.0);
    const std::filesystem::path session = simulator().recording();
    // The mouse looks, and moves no bur.
    QTest::mousePress(view(), Qt::LeftButton, Qt::NoModifier, view()->rect().center());
    QTest::mouseRelease(view(), Qt::LeftButton, Qt::NoModifier, view()->rect().center());

    led_->unplugged = true;
    EXPECT_TRUE(waitFor([&] { return noticed() == "device-trouble" || noticed() == "device-lost"; }));
    ASSERT_TRUE(waitFor([&] {
        return noticed() == "device-lost" && !simulator().isBusy() &&
               simulator().mode() == Simulator::Mode::liveSession;
    }));
    EXPECT_FALSE(simulator().usedHand());
    EXPECT_TRUE(simulator().mailbox());
    EXPECT_TRUE(part<QLabel>("noticeText")->text().contains("gone"));
    EXPECT_TRUE(waitFor([&] { return field->text() == "Mouse"; })) << field->text().toStdString();
    EXPECT_TRUE(waitFor([&] { return led_->open == 0; }));

    // The recording is whole up to there, and what it ended with is the tooth that is open. It goes on with the mouse.
    const simulation::SessionPlayer player(session, false);
    EXPECT_GT(player.durationS(), 0.1);
    const auto& events = player.events();
    const auto end = std::find_if(events.rbegin(), events.rend(),
                                  [](const auto& e) { return e.name == session::nameOf(session::EventName::end); });
    ASSERT_TRUE(end != events.rend());
    const tooth::StateDelta now = simulator().tooth()->state({simulator().sample().removedMm3, {}});
    EXPECT_NE(end->text.find(simulation::hashText(tooth::stateHash(now))), std::string::npos) << end->text;
    EXPECT_GT(removedMm3(), 0.05);
    EXPECT_TRUE(simulator().isUnsaved());
    ASSERT_TRUE(waitFor([&] { return simulator().status().undoSteps >= 1; }));
    ASSERT_TRUE(undoAll());
    EXPECT_TRUE(waitFor([&] { return removedMm3() < 1e-9; })) << removedMm3();

    // It is offered again, and comes back.
    led_->unplugged = false;
    led_->buttons = 0;
    auto* reconnect = part<QPushButton>("noticeRemedy");
    ASSERT_TRUE(reconnect && !reconnect->isHidden());
    reconnect->click();
    EXPECT_TRUE(waitFor([&] { return simulator().usedHand() != nullptr && !simulator().isBusy(); }));
    EXPECT_TRUE(waitFor([&] { return noticed().isEmpty(); })) << noticed().toStdString();
    entry("mouse")->trigger();
    EXPECT_TRUE(waitFor([&] { return simulator().mailbox() != nullptr && !simulator().isBusy(); }));
    EXPECT_EQ(host_->settings().value("work/device").toString(), "mouse");
}

TEST_F(DeviceWindowTest, OneThatNeverTellsWhereItIsIsToldOfUntilItDoes) {
    startHere();
    led_->silent = true;
    ASSERT_TRUE(chooseLed());
    ASSERT_TRUE(waitFor([&] { return noticed() == "device-trouble"; }));
    EXPECT_TRUE(part<QLabel>("noticeText")->text().contains("not told"));
    EXPECT_TRUE(simulator().usedHand());
    led_->silent = false;
    EXPECT_TRUE(waitFor([&] { return noticed().isEmpty(); })) << noticed().toStdString();
}

TEST_F(DeviceWindowTest, TheLowerButtonHeldInTheAirUndoes) {
    startHere();
    ASSERT_TRUE(chooseLed());
    ASSERT_TRUE(cutWithIt());
    ASSERT_TRUE(liftIt());
    ASSERT_TRUE(waitFor([&] { return simulator().status().undoSteps >= 1; }));
    // On a busy machine, where the arm was lost for a moment, the cut is several strokes.
    const std::size_t strokes = simulator().status().undoSteps;
    const double cutMm3 = removedMm3();
    led_->buttons = 2;
    EXPECT_TRUE(waitFor(
        [&] { return simulator().status().undoSteps == strokes - 1 && removedMm3() < cutMm3 - 1e-6 && settled(); }));
    const std::uint64_t tick = simulator().sample().tick;
    ASSERT_TRUE(waitFor([&] { return simulator().sample().tick > tick + 1200; }));
    EXPECT_EQ(simulator().status().undoSteps, strokes - 1) << "once a press";
}

TEST_F(DeviceWindowTest, TheFirstTimeThreeStepsComeByThemselvesAndBlockNothing) {
    led_->wantsCalibration = true;
    startHere();
    ASSERT_TRUE(choose("openhaptics"));
    ASSERT_TRUE(waitFor([&] { return part<FirstPlugIn>("firstPlugIn") != nullptr; }));
    auto* steps = part<FirstPlugIn>("firstPlugIn");
    EXPECT_FALSE(steps->isModal());
    EXPECT_TRUE(simulator().mailbox()) << "the mouse works on";
    ASSERT_TRUE(cut());
    auto* next = steps->findChild<QPushButton*>("firstNext");
    EXPECT_TRUE(waitFor([&] { return steps->findChild<QLabel*>("firstConnected")->text().contains("answers"); }))
        << steps->findChild<QLabel*>("firstConnected")->text().toStdString();
    EXPECT_TRUE(steps->findChild<QLabel*>("deviceModel")->text().contains("Led Arm"));
    next->click();
    EXPECT_EQ(steps->step(), FirstPlugIn::Step::calibrate);
    ASSERT_TRUE(waitFor([&] { return steps->findChild<QLabel*>("firstCalibrationText")->text().contains("inkwell"); }));
    steps->findChild<QPushButton*>("firstCalibrate")->click();
    EXPECT_TRUE(waitFor([&] {
        return led_->calibrations == 1 &&
               steps->findChild<QLabel*>("firstCalibrationState")->text().startsWith("Calibrated");
    }));
    next->click();
    EXPECT_EQ(steps->step(), FirstPlugIn::Step::feel);
    ASSERT_TRUE(waitFor([&] { return steps->block().isRunning(); }));
    leadBur({0.0, 0.0, 1.0}, FeelBlock::place());
    ASSERT_TRUE(waitFor([&] { return led_->hasCome() && steps->block().sample().depthMm < 0.0; }));
    leadBur({0.0, 0.0, -1.0}, FeelBlock::place());
    EXPECT_TRUE(waitFor([&] {
        const auto& f = steps->block().sample().forceN;
        return f[2] > 0.1;
    }));
    EXPECT_TRUE(waitFor([&] { return led_->largestSentN > 0.05; }));
    leadBur({0.0, 0.0, 2.0}, FeelBlock::place());
    ASSERT_TRUE(waitFor([&] { return led_->hasCome(); }));
    // Another scale is another opening; another hand is not.
    auto* scale = steps->findChild<QComboBox*>("profileScale");
    scale->setCurrentIndex(1);
    emit scale->activated(1);
    EXPECT_TRUE(waitFor([&] { return led_->opened == 2 && steps->block().isRunning(); }));
    auto* hand = steps->findChild<QComboBox*>("profileHand");
    hand->setCurrentIndex(1);
    emit hand->activated(1);
    next->click();
    ASSERT_TRUE(waitFor([&] { return simulator().usedHand() && !simulator().isBusy(); }));
    EXPECT_TRUE(hands().current()->wasSetUp());
    const workspace::Profile kept = workspace::profileFor(hands().current()->info(), at("devices"));
    EXPECT_TRUE(kept.placing.leftHanded);
    EXPECT_EQ(kept.placing.scale, 2.0);
    EXPECT_EQ(led_->opened, 2);
    EXPECT_GT(removedMm3(), 0.0) << "what the mouse cut meanwhile is there";
}

TEST_F(DeviceWindowTest, ThePageTellsSetsAndChecks) {
    startHere();
    ASSERT_TRUE(chooseLed());
    action("actionDevicePage")->trigger();
    auto* page = part<QDialog>("devicePage");
    ASSERT_TRUE(page);
    EXPECT_TRUE(waitFor([&] {
        return page->findChild<QLabel*>("devicePose")->text().contains("mm") &&
               page->findChild<QLabel*>("deviceTemperature")->text().contains("25") &&
               page->findChild<QLabel*>("deviceLate")->text().contains("p99");
    }));
    led_->buttons = 2;
    EXPECT_TRUE(waitFor([&] { return page->findChild<QLabel*>("deviceButtons")->text().contains("lower"); }));
    led_->buttons = 0;

    auto* friction = page->findChild<QCheckBox*>("profileFriction");
    friction->click();
    EXPECT_EQ(workspace::profileFor(hands().current()->info(), at("devices")).shaping.frictionCompensation,
              friction->isChecked());
    page->findChild<QCheckBox*>("deviceCrisp")->click();
    EXPECT_TRUE(simulator().parameters().transients.on);
    EXPECT_TRUE(host_->settings().value("work/crispContact").toBool());
    for (const QWidget* widget : page->findChildren<QWidget*>()) {
        const QString name = widget->objectName();
        if (name.startsWith("profile") || name.startsWith("deviceCrisp") || name.startsWith("deviceVibration")) {
            EXPECT_GT(widget->toolTip().size(), 20) << name.toStdString();
        }
    }

    auto* box = page->findChild<FidelityBox*>();
    auto* list = page->findChild<QTreeWidget*>("fidelityList");
    page->findChild<QSpinBox*>("fidelitySeconds")->setValue(600);
    page->findChild<QPushButton*>("fidelityStart")->click();
    EXPECT_TRUE(waitFor([&] { return led_->opened == 2; })) << "the check has it for itself";
    EXPECT_TRUE(waitFor([&] { return simulator().mailbox() != nullptr; }));
    page->findChild<QPushButton*>("fidelityCancel")->click();
    EXPECT_TRUE(waitFor([&] { return simulator().usedHand() != nullptr && !simulator().isBusy(); }));
    EXPECT_FALSE(box->report());
    page->findChild<QSpinBox*>("fidelitySeconds")->setValue(2);
    page->findChild<QPushButton*>("fidelityStart")->click();
    ASSERT_TRUE(waitFor([&] { return box->report().has_value(); }));
    EXPECT_EQ(list->topLevelItemCount(), static_cast<int>(box->report()->findings.size()));
    EXPECT_GT(list->topLevelItemCount(), 4);
    for (const fidelity::Finding& finding : box->report()->findings) {
        const auto rows = list->findItems(toQString(nameOf(finding, config::words())), Qt::MatchExactly, 1);
        ASSERT_EQ(rows.size(), 1) << finding.id;
        EXPECT_FALSE(rows[0]->text(2).isEmpty()) << finding.id;
    }
    {
        fidelity::Report report = *box->report();
        report.troubles = {link::DeviceFault::stalled, link::DeviceFault::vendorError};
        report.vendorCode = 0x302;
        box->setReport(report);
        const auto rows = list->findItems(QStringLiteral("Troubles"), Qt::MatchExactly, 1);
        ASSERT_EQ(rows.size(), 1);
        EXPECT_TRUE(rows[0]->text(2).contains(problemOf(link::DeviceFault::stalled, 0).what));
        EXPECT_TRUE(rows[0]->text(2).contains("0x0302")) << rows[0]->text(2).toStdString();
    }
    for (const char* name : {"fidelity.html", "fidelity.json"}) {
        file_ = own_.filePath(QLatin1String(name));
        page->findChild<QPushButton*>("fidelitySave")->click();
        QFile written(file_);
        ASSERT_TRUE(written.open(QIODevice::ReadOnly)) << name;
        EXPECT_TRUE(written.readAll().contains("Led Arm")) << name;
    }
    EXPECT_TRUE(waitFor([&] { return simulator().usedHand() != nullptr && !simulator().isBusy(); }));
}

TEST_F(DeviceWindowTest, EveryNameOfTheDialogsIsInTheGuide) {
    startHere();
    ASSERT_TRUE(chooseLed());
    action("actionDevicePage")->trigger();
    action("actionDeviceSetUp")->trigger();
    QFile guide(QStringLiteral(HANDPIECE_DESKTOP_OBJECTS));
    ASSERT_TRUE(guide.open(QIODevice::ReadOnly));
    const QString text = QString::fromUtf8(guide.readAll());
    int seen = 0;
    for (const char* dialog : {"devicePage", "firstPlugIn"}) {
        const auto* root = part<QDialog>(dialog);
        ASSERT_TRUE(root) << dialog;
        QSet<QString> names;
        for (const QWidget* widget : root->findChildren<QWidget*>()) {
            const QString name = widget->objectName();
            if (name.isEmpty() || name.startsWith("qt_") || name.startsWith("Scroll")) continue;
            EXPECT_FALSE(names.contains(name)) << "twice: " << name.toStdString();
            names << name;
            EXPECT_TRUE(text.contains(QStringLiteral("`%1`").arg(name))) << name.toStdString();
            ++seen;
        }
    }
    EXPECT_GT(seen, 40);
}

TEST_F(DeviceWindowTest, OneThatIsNotThereAtTheStartIsToldOfAndTheMouseWorks) {
    CommandLine line;
    line.device = QStringLiteral("haply");
    startHere(line);
    ASSERT_TRUE(waitFor([&] { return noticed() == "device-absent"; }));
    EXPECT_FALSE(window().errorDialog());
    EXPECT_TRUE(simulator().mailbox());
    ASSERT_TRUE(cut());
}

TEST_F(DeviceWindowTest, TheSchoolChoosesBelowThePerson) {
    const QString file = own_.filePath(QStringLiteral("school.toml"));
    core::writeFile(toPath(file), "[hand]\ndevice = \"openhaptics\"\nleft_handed = true\n");
    qputenv("HANDPIECE_SCHOOL_SETTINGS", file.toLocal8Bit());
    Settings(options().folders.settingsFile).set(QStringLiteral("device/seen_openhaptics"), true);
    startHere();
    EXPECT_TRUE(waitFor([&] { return simulator().usedHand() != nullptr && !simulator().isBusy(); }));
    EXPECT_TRUE(hands().current()->profile().placing.leftHanded);
    const QMenu* menu = part<QMenu>("menuDevice");
    ASSERT_TRUE(menu && entry("mouse"));
    entry("mouse")->trigger();
    ASSERT_TRUE(waitFor([&] { return simulator().mailbox() && !simulator().isBusy(); }));
    startHere();
    EXPECT_TRUE(hands().wanted().isEmpty());
    qputenv("HANDPIECE_SCHOOL_SETTINGS", "");
}

/// A pedal whose foot is the test's.
struct DoublePedal {
    std::atomic<double> pressed{0.0};
    std::atomic<bool> attached{true}, absent{false};
};

class PedalWindowTest : public DeviceWindowTest {
  protected:
    [[nodiscard]] Simulator::Options options() const override {
        Simulator::Options options = DeviceWindowTest::options();
        options.pedals.look = [] {
            return std::vector<drivers::PedalFound>{{"Left Pedal", 1, 0}, {"Foot Pedal", 2, 1}};
        };
        options.pedals.open = [pedal = pedal_](const std::string& name, std::shared_ptr<link::PedalValue> value) {
            if (pedal->absent) throw core::Error("it is not there", name, "plug it in").as("device-missing", {name});
            // As FootPedal does: 250 times a second, zero when it is lost and when it ends.
            auto end = std::make_shared<std::atomic<bool>>(false);
            auto thread = std::make_shared<std::thread>([pedal, value, end] {
                while (!*end) {
                    value->write(pedal->attached ? static_cast<float>(pedal->pressed) : 0.0f, rt::monotonicNs());
                    std::this_thread::sleep_for(std::chrono::milliseconds(4));
                }
                value->write(0.0f, rt::monotonicNs());
            });
            const std::shared_ptr<void> held(nullptr, [thread, end](void*) {
                *end = true;
                thread->join();
            });
            return PedalDesk::Open{name, [pedal] { return pedal->attached.load(); }, held};
        };
        return options;
    }
    [[nodiscard]] bool choosePedal(const char* name) {
        simulator().foot().look();
        const auto found = [&]() -> QAction* {
            for (QAction* action : part<QMenu>("menuPedal")->actions())
                if (action->text() == QLatin1String(name)) return action;
            return nullptr;
        };
        if (!waitFor([&] { return found() != nullptr; })) return false;
        found()->trigger();
        return true;
    }
    [[nodiscard]] bool pedalIs(double value) {
        return waitFor([&] { return std::abs(simulator().sample().pedal - value) < 1e-3; });
    }

    std::shared_ptr<DoublePedal> pedal_ = std::make_shared<DoublePedal>();
};

TEST_F(PedalWindowTest, StandsBesideTheMouseTheOnePressedHarderCountsAndIsRemembered) {
    startHere();
    ASSERT_TRUE(choosePedal("Foot Pedal"));
    ASSERT_TRUE(waitFor([&] { return simulator().foot().isThere(); }));
    EXPECT_EQ(host_->settings().value("work/pedal").toString(), "Foot Pedal");
    EXPECT_TRUE(pedalIs(0.0));
    pedal_->pressed = 0.5;
    EXPECT_TRUE(pedalIs(0.5));
    EXPECT_TRUE(waitFor([&] { return simulator().sample().speedRpm > 1000.0; })) << "the foot alone turns the bur";
    // The button beside it: harder.
    view()->latchPedal(true);
    EXPECT_TRUE(pedalIs(1.0));
    view()->latchPedal(false);
    EXPECT_TRUE(pedalIs(0.5));
    // Unplugged it is up, and said so; back again, the word goes.
    pedal_->attached = false;
    EXPECT_TRUE(pedalIs(0.0));
    EXPECT_TRUE(waitFor([&] { return noticed() == "pedal-lost"; }));
    pedal_->attached = true;
    EXPECT_TRUE(waitFor([&] { return noticed() != "pedal-lost"; }));
    EXPECT_TRUE(pedalIs(0.5));
    // Next time it is there by itself; without it a person is told, and works on.
    startHere();
    EXPECT_TRUE(pedalIs(0.5));
    pedal_->absent = true;
    startHere();
    EXPECT_TRUE(waitFor([&] { return noticed() == "pedal-absent"; }));
    EXPECT_TRUE(pedalIs(0.0));
    part<QAction>("actionFoot_none")->trigger();
    EXPECT_TRUE(host_->settings().value("work/pedal").toString().isEmpty());
}

TEST_F(PedalWindowTest, StandsBesideAnArm) {
    startHere();
    ASSERT_TRUE(chooseLed());
    ASSERT_TRUE(burTo(0.0, 1.0));
    pedal_->pressed = 0.75;
    ASSERT_TRUE(choosePedal("Left Pedal"));
    EXPECT_TRUE(pedalIs(0.75)) << "chosen while the arm is in the hand";
    led_->buttons = 1;
    EXPECT_TRUE(pedalIs(1.0));
    led_->buttons = 0;
    EXPECT_TRUE(pedalIs(0.75));
    part<QAction>("actionFoot_none")->trigger();
    EXPECT_TRUE(pedalIs(0.0));
}

/// SDL's own joystick, through the driver as it is.
TEST_F(DeviceWindowTest, ARealJoystickIsAPedal) {
    std::string why;
    if (!test::hasVirtualJoysticks(why)) GTEST_SKIP() << why;
    test::VirtualJoystick joystick("Double Foot Pedal", false, 1, 0);
    joystick.axis(0, -1.0);
    startHere();
    simulator().foot().choose(QStringLiteral("Double Foot Pedal"));
    ASSERT_TRUE(waitFor([&] { return simulator().foot().isThere(); }));
    ASSERT_TRUE(joystick.settle());
    joystick.axis(0, 1.0);
    EXPECT_TRUE(waitFor([&] { return simulator().sample().pedal > 0.99; }));
    joystick.unplug();
    EXPECT_TRUE(waitFor([&] { return simulator().sample().pedal == 0.0 && noticed() == "pedal-lost"; }));
}

/// Two arms that only their serials tell apart.
class TwoArmsTest : public DeviceWindowTest {
  protected:
    [[nodiscard]] Simulator::Options options() const override {
        Simulator::Options options = DeviceWindowTest::options();
        options.hands.desk.look = [] {
            drivers::Found arms;
            arms.driver = "haply";
            arms.makes = "Haply Inverse3";
            arms.available = true;
            arms.models = {"Inverse3 A1", "Inverse3 B2"};
            arms.units = {{"A1", "Inverse3 A1"}, {"B2", "Inverse3 B2"}};
            return std::vector<drivers::Found>{arms};
        };
        options.hands.desk.open = [led = led_, opened = opened_](const input::DeviceChoice& choice) {
            *opened = choice.name + "/" + choice.which;
            return input::openDevice(std::make_unique<LedDriver>(led), choice);
        };
        return options;
    }
    [[nodiscard]] bool inHand() {
        return waitFor([&] { return simulator().usedHand() && !simulator().isBusy(); });
    }
    std::shared_ptr<std::string> opened_ = std::make_shared<std::string>();
};

TEST_F(TwoArmsTest, TheSecondIsChosenByTheMenuOrByNameAndRemembered) {
    startHere();
    for (const char* name : {"haply:A1", "haply:B2"})
        host_->settings().set(QStringLiteral("device/seen_") + QLatin1String(name), true);
    ASSERT_TRUE(choose("haply:B2"));
    ASSERT_TRUE(inHand());
    EXPECT_EQ(*opened_, "haply/B2");
    EXPECT_TRUE(entry("haply:B2")->isChecked());
    EXPECT_FALSE(entry("haply:A1")->isChecked());
    EXPECT_EQ(part<QToolButton>("statusDevice")->text().contains("B2"), true)
        << part<QToolButton>("statusDevice")->text().toStdString();
    opened_->clear();
    startHere();
    ASSERT_TRUE(inHand());
    EXPECT_EQ(*opened_, "haply/B2");
    // One that the list does not know.
    action("actionDeviceNamed")->trigger();
    auto* dialog = part<QInputDialog>("deviceNameDialog");
    ASSERT_TRUE(dialog);
    host_->settings().set(QStringLiteral("device/seen_haply:C3"), true);
    dialog->setTextValue(QStringLiteral(" haply:C3 "));
    dialog->accept();
    ASSERT_TRUE(waitFor([&] { return *opened_ == "haply/C3"; }));
    ASSERT_TRUE(inHand());
}

/// The simulated arm by its name, as a person finds it, and a fault by the command line.
TEST_F(ShellTest, TheSimulatedArmIsAlwaysThereAndAnInjectedFaultEndsInTheMouse) {
    CommandLine line;
    line.device = QStringLiteral("simulated");
    line.inject = QStringLiteral("unplug@0.5:1000");
    Settings(options().folders.settingsFile).set(QStringLiteral("device/seen_simulated"), true);
    startWithTooth(line);
    ASSERT_TRUE(waitFor([&] { return simulator().usedHand() != nullptr; }));
    ASSERT_TRUE(waitFor([&] { return window().findChild<NoticeBar*>()->current() == "device-lost"; }));
    ASSERT_TRUE(waitFor([&] { return simulator().mailbox() != nullptr && !simulator().isBusy(); }));
    EXPECT_EQ(simulator().status().fault, "");
    ASSERT_TRUE(cut());
}

}  // namespace
}  // namespace handpiece::desktop::device_window_test
