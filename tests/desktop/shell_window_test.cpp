// SPDX-License-Identifier: Apache-2.0
// The program as a student uses it: open, cut, undo, save, open again, crash.
#include <QCheckBox>
#include <QComboBox>
#include <QDialog>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QFile>
#include <QJsonDocument>
#include <QJsonObject>
#include <QLabel>
#include <QMenu>
#include <QMenuBar>
#include <QProcess>
#include <QSet>
#include <QStatusBar>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numeric>
#include <set>

#include "cli/cli.h"
#include "desktop/features/drill/drill_bar.h"
#include "desktop/features/drill/parameter_box.h"
#include "desktop/features/files/chart_dialog.h"
#include "desktop/features/measure/measure_box.h"
#include "desktop/features/measure/volume_bars.h"
#include "desktop/features/replay/replay_bar.h"
#include "desktop/features/replay/timeline.h"
#include "desktop/features/sound/sound_control.h"
#include "desktop/picture/key_bindings.h"
#include "desktop/picture/section_bar.h"
#include "desktop/widgets/force_gauge.h"
#include "desktop/widgets/notice_bar.h"
#include "handpiece/app/input/pointer_controller.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/record/session/recorder.h"
#include "handpiece/record/session/session_reader.h"
#include "shell_support.h"

namespace handpiece::desktop::shell_window_test {
namespace {

namespace fs = std::filesystem;

void collect(const QMenu* menu, QSet<QAction*>& into) {
    for (QAction* action : menu->actions()) {
        into.insert(action);
        if (action->menu()) collect(action->menu(), into);
    }
}

TEST_F(ShellTest, OpensOnTheStarterToothWithBur330AndNoDialog) {
    start();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
    EXPECT_EQ(simulator().toothCase()->kind, "lower-first-molar");
    EXPECT_EQ(window().findChild<DrillBar*>()->bur(), "330");
    EXPECT_EQ(window().detail(), Detail::practice);
    for (const QWidget* widget : QApplication::topLevelWidgets())
        EXPECT_FALSE(widget->isVisible() && qobject_cast<const QDialog*>(widget)) << qPrintable(widget->objectName());
    EXPECT_TRUE(view()->hasTooth());
    EXPECT_FALSE(simulator().isUnsaved());
}

TEST_F(ShellTest, EveryCommandHasANameATooltipAKeyAndAPlaceInTheMenus) {
    start();
    QSet<QAction*> inMenus;
    for (QAction* top : window().menuBar()->actions())
        collect(top->menu(), inMenus);
    QSet<QString> names, keys;
    for (QAction* action : window().commands().all()) {
        EXPECT_TRUE(inMenus.contains(action)) << qPrintable(action->objectName());
        EXPECT_FALSE(action->toolTip().isEmpty()) << qPrintable(action->objectName());
        EXPECT_FALSE(action->shortcut().isEmpty()) << qPrintable(action->objectName());
        EXPECT_FALSE(action->shortcut().toString().contains("Alt")) << qPrintable(action->objectName());
        EXPECT_FALSE(action->text().contains('&')) << qPrintable(action->text());
        EXPECT_FALSE(keys.contains(action->shortcut().toString())) << qPrintable(action->shortcut().toString());
        keys.insert(action->shortcut().toString());
        // With the picture in focus its own keys come first: the command would never be heard.
        const QKeyCombination pressed = action->shortcut()[0];
        if (pressed.keyboardModifiers() & Qt::ControlModifier) {
            EXPECT_FALSE(KeyBindings().actionFor({Binding::Kind::key, pressed.key(), pressed.keyboardModifiers()}))
                << qPrintable(action->objectName());
        }
        EXPECT_FALSE(names.contains(action->objectName()));
        names.insert(action->objectName());
    }
    for (const char* name : {"actionResolution_6", "actionResolution_100", "actionLanguage_ja"})
        EXPECT_NE(window().findChild<QAction*>(name), nullptr) << name;
}

TEST_F(ShellTest, CutsUndoesSavesAndResumes) {
    startWithTooth();
    ASSERT_TRUE(cut());
    EXPECT_TRUE(simulator().isUnsaved());
    EXPECT_TRUE(window().isWindowModified());
    action("actionUndo")->trigger();
    ASSERT_TRUE(waitFor([this] { return removedMm3() == 0.0 && !simulator().isUnsaved(); }));
    action("actionRedo")->trigger();
    ASSERT_TRUE(waitFor([this] { return removedMm3() > 0.0 && settled(); }));
    const double cutMm3 = removedMm3();

    file_ = own_.filePath("mine.handpiece");
    action("actionSaveAs")->trigger();
    ASSERT_TRUE(waitFor([this] { return fs::exists(toPath(file_)) && !simulator().isUnsaved(); }));
    EXPECT_EQ(asked_, 0);
    // Another tooth in between: nothing is unsaved, so nobody asks.
    openTooth(11);
    ASSERT_TRUE(waitFor([this] { return simulator().toothCase()->kind == "upper-central-incisor"; }));
    action("actionResume")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().toothCase()->kind == "lower-first-molar"; }));
    EXPECT_EQ(asked_, 0);
    ASSERT_TRUE(waitFor([this] { return simulator().sample().tick > 10; }));
    EXPECT_NEAR(removedMm3(), cutMm3, 1e-9);

    // The same in the next start, from its settings.
    window().rememberAll();
    startWithTooth();
    action("actionResume")->trigger();
    ASSERT_TRUE(waitFor([&] { return std::abs(removedMm3() - cutMm3) < 1e-9 && simulator().sample().tick > 10; }));
}

TEST_F(ShellTest, AsksBeforeUnsavedWorkGoes) {
    startWithTooth();
    // The mouse's hand begins where an arm's does.
    const cases::Case& c = *simulator().toothCase();
    const core::Pose start = input::startPose(c.outer.bounds(), c.fdiNumber, c.buccalSign);
    EXPECT_LT((simulator().startPose().positionMm - start.positionMm).norm(), 1e-9);
    EXPECT_LT(simulator().startPose().orientation.angularDistance(start.orientation), 1e-6);
    ASSERT_TRUE(cut());
    answer_ = Questions::Unsaved::cancel;
    window().close();
    EXPECT_EQ(asked_, 1);
    EXPECT_TRUE(window().isVisible());
    EXPECT_GT(removedMm3(), 0.0);
    answer_ = Questions::Unsaved::save;
    file_ = own_.filePath("at-closing.handpiece");
    window().close();
    EXPECT_TRUE(waitFor([this] { return fs::exists(toPath(file_)) && !window().isVisible(); }));
}

TEST_F(ShellTest, OneCloseClosesATooth) {
    startWithTooth();
    window().close();
    EXPECT_FALSE(window().isVisible());
    startWithTooth();
    ASSERT_TRUE(cut());
    answer_ = Questions::Unsaved::discard;
    action("actionQuit")->trigger();
    EXPECT_EQ(asked_, 1);
    EXPECT_FALSE(window().isVisible());
}

TEST_F(ShellTest, WhatIsOpenedWhileAnotherToothIsOpeningIsNotLost) {
    const fs::path first = at("first"), last = at("last");
    for (const fs::path& place : {first, last}) {
        cases::Case made = eggTooth(46);
        made.name = place.filename().string();
        cases::writeCase(made, place);
    }
    startWithTooth();
    openTooth(11);
    ASSERT_TRUE(simulator().isBusy());
    window().openFile(toQString(first));
    window().openFile(toQString(last));
    ASSERT_TRUE(simulator().isBusy());
    bool sawFirst = false;
    ASSERT_TRUE(waitFor([&] {
        sawFirst = sawFirst || simulator().document().name == "first";
        return simulator().document().name == "last" && !simulator().isBusy();
    })) << simulator().document().name;
    EXPECT_FALSE(sawFirst);
    EXPECT_FALSE(window().errorDialog());

    // At the very start, before there is any tooth; and what was cut is asked about when it is known.
    start();
    ASSERT_TRUE(simulator().isBusy());
    window().openFile(toQString(last));
    ASSERT_TRUE(waitFor([&] { return simulator().document().name == "last" && !simulator().isBusy(); }));
    EXPECT_EQ(asked_, 0);
    view()->showStandardView(view::StandardView::occlusal);
    ASSERT_TRUE(cut());
    answer_ = Questions::Unsaved::cancel;
    simulator().exportStl(at("left.stl"));
    ASSERT_TRUE(simulator().isBusy());
    window().openFile(toQString(first));
    EXPECT_EQ(asked_, 0);
    ASSERT_TRUE(waitFor([&] { return asked_ == 1; }));
    EXPECT_EQ(simulator().document().name, "last");
    EXPECT_TRUE(simulator().isUnsaved());
}

TEST_F(ShellTest, AFullDiskLosesNothing) {
    startWithTooth();
    ASSERT_TRUE(cut());
    const double cutMm3 = removedMm3();
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit none{512, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &none), 0);
    file_ = own_.filePath("full.handpiece");
    action("actionSaveAs")->trigger();
    const bool told = waitFor([this] { return window().errorDialog() != nullptr; });
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    ASSERT_TRUE(told);
    EXPECT_FALSE(window().errorDialog()->problem().remedy.isEmpty()) << qPrintable(window().errorDialog()->text());
    EXPECT_FALSE(fs::exists(toPath(file_)));
    EXPECT_TRUE(simulator().isUnsaved());
    EXPECT_EQ(removedMm3(), cutMm3);
    window().errorDialog()->reject();
    action("actionSaveAs")->trigger();
    EXPECT_TRUE(waitFor([this] { return fs::exists(toPath(file_)) && !simulator().isUnsaved(); }));
}

TEST_F(ShellTest, ACaseThatVanishesIsSavedWithTheAttempt) {
    const cases::Case made = eggTooth(46);
    cases::writeCase(made, at("case"));
    CommandLine line;
    line.file = own_.filePath("case");
    startWithTooth(line);
    ASSERT_TRUE(cut());
    fs::remove_all(at("case"));
    ASSERT_TRUE(idle());
    simulator().saveAs(at("folder"));
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
    EXPECT_EQ(window().errorDialog()->problem().id, "case-vanished");
    window().errorDialog()->reject();
    file_ = own_.filePath("kept.handpiece");
    action("actionSaveAs")->trigger();
    ASSERT_TRUE(waitFor([this] { return fs::exists(toPath(file_)) && !simulator().isUnsaved(); }));
    const double cutMm3 = removedMm3();
    window().openFile(file_);
    ASSERT_TRUE(
        waitFor([this] { return simulator().document().attemptFile == toPath(file_) && !simulator().isBusy(); }));
    ASSERT_TRUE(waitFor([this] { return simulator().sample().tick > 10; }));
    EXPECT_NEAR(removedMm3(), cutMm3, 1e-9);
}

/// Where figures of two ways are held against each other.
class FinerShellTest : public ShellTest {
  protected:
    [[nodiscard]] Simulator::Options options() const override {
        Simulator::Options finer = ShellTest::options();
        finer.voxelUm = 100;
        return finer;
    }
};

// At voxels where the bands of the field are no longer the usual ones.
TEST_F(FinerShellTest, AnAttemptGoesFromTheWindowToTheCommandLineAndBack) {
    startWithTooth();
    ASSERT_TRUE(cut());
    file_ = own_.filePath("window.handpiece");
    action("actionSaveAs")->trigger();
    ASSERT_TRUE(waitFor([this] { return fs::exists(toPath(file_)) && !simulator().isUnsaved(); }));
    const std::string tooth = file_.toStdString(), out = at("plunge").string();
    const std::array line{"handpiece", "run",     "--case", tooth.c_str(), "--motion", "plunge", "--depth",
                          "0.5",       "--dwell", "0",      "--speed",     "4",        "--at",   "1.5",
                          "0",         "--voxel", "100",    "--out",       out.c_str()};
    double savedMm3 = 0.0;
    for (const double mm3 : cases::openAttempt(toPath(file_)).attempt.removedMm3)
        savedMm3 += mm3;
    ASSERT_GT(savedMm3, 0.0);
    ASSERT_EQ(cli::run(static_cast<int>(line.size()), line.data()), 0);
    const fs::path attempt = at("plunge") / "attempt";
    double cutMm3 = 0.0;
    for (const double mm3 : cases::openAttempt(attempt).attempt.removedMm3)
        cutMm3 += mm3;
    EXPECT_GT(cutMm3, savedMm3 + 0.001);
    window().openFile(toQString(attempt));
    ASSERT_TRUE(waitFor([&] { return simulator().document().attemptFile == attempt && !simulator().isBusy(); }));
    ASSERT_TRUE(waitFor([this] { return simulator().sample().tick > 10; }));
    EXPECT_NEAR(removedMm3(), cutMm3, 1e-9);
}

TEST_F(ShellTest, BadFilesAreToldAndTheToothStays) {
    startWithTooth();
    const auto before = simulator().tooth();
    std::ofstream(at("no.stl")) << "rubbish";
    std::ofstream(at("no.handpiece")) << "rubbish";
    std::ofstream(at("no.h5")) << "rubbish";
    std::ofstream(at("no.txt")) << "rubbish";
    fs::create_directories(at("empty"));
    for (const char* name :
         {"no.stl", "no.handpiece", "no.h5", "no.txt", "empty", "missing.stl", "missing.handpiece"}) {
        window().openFile(own_.filePath(name));
        ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; })) << name;
        EXPECT_TRUE(window().errorDialog()->text().size() > 20) << name;
        window().errorDialog()->reject();
        ASSERT_TRUE(waitFor([this] { return window().errorDialog() == nullptr; }));
        ASSERT_TRUE(idle());
    }
    EXPECT_EQ(simulator().tooth(), before);
    EXPECT_EQ(simulator().mode(), Simulator::Mode::liveSession);
}

TEST_F(ShellTest, ParametersReachTheLoopAndTheRecording) {
    startWithTooth();
    auto* box = window().findChild<ParameterBox*>();
    emit box->multipliersChanged(0.5, 2.0, 0.0);
    EXPECT_EQ(simulator().parameters().stiffnessMultiplier, 0.5);
    EXPECT_EQ(box->multipliers(), (ParameterBox::Multipliers{0.5, 2.0, 0.0}));
    const std::uint64_t tick = simulator().sample().tick;
    ASSERT_TRUE(waitFor([&] { return simulator().sample().lastCommand > 0 && simulator().sample().tick > tick; }));
    emit window().findChild<DrillBar*>()->burChosen("round-4");
    EXPECT_EQ(simulator().bur()->name(), "round-4");
    const std::uint64_t command = simulator().sample().lastCommand;
    EXPECT_TRUE(waitFor([&] { return simulator().sample().lastCommand > command; }));
}

TEST_F(ShellTest, TheVoxelChangesBeforeAndAfterCutting) {
    startWithTooth();
    simulator().setVoxel(150);
    ASSERT_TRUE(waitFor([this] { return simulator().voxelUm() == 150 && !simulator().isBusy(); }));
    view()->showStandardView(view::StandardView::occlusal);
    ASSERT_TRUE(waitFor([this] { return simulator().sample().tick > 100; }));
    ASSERT_TRUE(cut());
    const double cutMm3 = removedMm3();
    simulator().setVoxel(100);
    ASSERT_TRUE(waitFor([this] { return simulator().voxelUm() == 100 && !simulator().isBusy(); }));
    ASSERT_TRUE(waitFor([this] { return simulator().sample().tick > 10; }));
    EXPECT_EQ(window().errorDialog(), nullptr);
    EXPECT_GT(removedMm3(), 0.3 * cutMm3);
    EXPECT_LT(removedMm3(), 3.0 * cutMm3);
    EXPECT_TRUE(simulator().isUnsaved());
    const double againMm3 = removedMm3();
    EXPECT_TRUE(waitFor([this] { return simulator().status().undoSteps > 0; }));
    ASSERT_TRUE(undoAll());
    EXPECT_TRUE(waitFor([this] { return removedMm3() == 0.0; }));
    action("actionRedo")->trigger();
    EXPECT_TRUE(waitFor([&] { return removedMm3() > 0.5 * againMm3; }));
}

// Ctrl+Z as soon as the button is let go: the bur is still coming out, and the stroke has not ended.
TEST_F(ShellTest, AStrokeIsTakenBackThatHasJustBeenLetGo) {
    startWithTooth();
    ASSERT_TRUE(cut());
    const double onceMm3 = removedMm3();
    ASSERT_TRUE(waitFor([this] { return simulator().sample().tick > 100; }));
    // A busy machine may be so late that the bur is out already.
    bool wasInTime = false;
    for (int i = 0; i < 20 && !wasInTime; ++i) {
        ASSERT_TRUE(pressUntilCut());
        ASSERT_TRUE(waitFor([this] { return action("actionUndo")->isEnabled(); }));
        wasInTime = simulator().status().inStroke;
        action("actionUndo")->trigger();
        ASSERT_TRUE(waitFor([&] { return std::abs(removedMm3() - onceMm3) < 1e-9 && !simulator().status().inStroke; }));
        EXPECT_EQ(simulator().status().undoSteps, 1u) << "the one before stays";
    }
    if (!wasInTime) GTEST_SKIP() << "this machine is too busy: the bur was out before each of twenty undos";
}

TEST_F(ShellTest, ReplaysWhatWasDoneAndComesBack) {
    startWithTooth();
    ASSERT_TRUE(cut());
    const double cutMm3 = removedMm3();
    action("actionReplay")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay; }));
    EXPECT_GT(simulator().replay()->durationS(), 0.1);
    simulator().setReplaySpeed(32.0);
    simulator().play(true);
    ASSERT_TRUE(waitFor([this] { return !simulator().replay()->now().playing; }));
    ASSERT_TRUE(waitFor([&] { return std::abs(removedMm3() - cutMm3) < 1e-9; }));
    EXPECT_EQ(simulator().toothCase()->scenery.size(), 1u);
    simulator().closeReplay();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
    ASSERT_TRUE(waitFor([this] { return simulator().sample().tick > 10; }));
    EXPECT_NEAR(removedMm3(), cutMm3, 1e-9);
    EXPECT_TRUE(simulator().isUnsaved());
    EXPECT_EQ(simulator().toothCase()->scenery.size(), 1u);
    // What was done before can be undone, what is done now as well, and a second replay changes nothing of that.
    ASSERT_TRUE(cut());
    ASSERT_TRUE(waitFor([this] { return simulator().status().undoSteps == 2; }));
    action("actionReplay")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay; }));
    simulator().closeReplay();
    ASSERT_TRUE(waitFor([&] { return simulator().mode() == Simulator::Mode::liveSession && removedMm3() > cutMm3; }));
    ASSERT_TRUE(waitFor([this] { return simulator().status().undoSteps == 2; }));
    ASSERT_TRUE(undoAll());
    EXPECT_TRUE(waitFor([this] { return removedMm3() == 0.0 && !simulator().isUnsaved(); }));
    EXPECT_EQ(simulator().status().redoSteps, 2u);
}

TEST_F(ShellTest, LoadAndStopOfThePanelHoldForTheToothThatComesBack) {
    startWithTooth();
    view()->setLoad(1.7);
    view()->setStop(1.2);
    // Before the first tick there is nothing to replay, and the window says so.
    if (simulator().sample().tick == 0) {
        EXPECT_FALSE(action("actionReplay")->isEnabled());
    }
    ASSERT_TRUE(waitFor([this] { return action("actionReplay")->isEnabled(); }));
    EXPECT_GT(simulator().sample().tick, 0u);
    action("actionReplay")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay; }));
    simulator().closeReplay();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession && view()->hand(); }));
    EXPECT_DOUBLE_EQ(view()->hand()->loadN(), 1.7);
    ASSERT_TRUE(view()->hand()->stopMm());
    EXPECT_DOUBLE_EQ(*view()->hand()->stopMm(), 1.2);
}

TEST_F(FinerShellTest, PanelsFollowAReplayBackAndForth) {
    startWithTooth();
    ASSERT_TRUE(cut());
    simulator().setDrive(QStringLiteral("low-speed"));
    simulator().setMultipliers(0.5, 1.0, 1.0);
    ASSERT_TRUE(cut());
    action("actionReplay")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay; }));
    const session::SessionReader reader(simulator().document().caseFile);
    const auto& drill = *window().findChild<DrillBar*>();
    const auto& bars = *window().findChild<VolumeBars*>();
    const double endS = simulator().replay()->durationS();
    std::vector<std::uint64_t> changes;
    for (const session::Event& event : reader.events())
        if (event.name == "parameter change") changes.push_back(event.tick);
    ASSERT_EQ(changes.size(), 2u);
    std::set<QString> volumes;
    std::set<double> speeds;
    for (const double share : {1.0, 0.1, 0.7, 0.0, 0.5, 0.95, 0.3}) {
        simulator().seek(share * endS);
        const auto tick = static_cast<std::uint64_t>(share * endS * 1000.0 + 1e-6);
        const std::uint64_t index = reader.indexOfTick(tick + 1);
        const session::Record record = reader.records(index > 0 ? index - 1 : 0, 1).front();
        ASSERT_TRUE(waitFor([&] {
            return simulator().sample().tick == record.tick && !simulator().replay()->now().seeking;
        })) << share;
        ASSERT_TRUE(waitFor([&] { return view()->sample().tick == record.tick; })) << share;
        QTest::qWait(150);
        // Run up after a jump, it comes as near as a hand can feel.
        EXPECT_NEAR(removedMm3(), std::accumulate(record.removedMm3.begin(), record.removedMm3.end(), 0.0), 2e-3);
        EXPECT_NEAR(simulator().sample().speedRpm, static_cast<double>(record.speedRpm), 0.03 * 4e5) << share;
        EXPECT_NEAR(window().findChild<ForceGauge*>()->forceN(),
                    static_cast<double>(std::hypot(record.forceN[0], record.forceN[1], record.forceN[2])), 0.15);
        EXPECT_NEAR(window().findChild<ReplayBar*>()->timeS(), static_cast<double>(record.tick) / 1000, 1e-6);
        const bool early = record.tick < changes.front();
        const bool late = record.tick > changes.back();
        if (early || late) {
            EXPECT_EQ(simulator().driveName(), early ? "turbine" : "low-speed") << share;
            EXPECT_EQ(drill.speedRpm(), simulator().setSpeedRpm());
            EXPECT_EQ(window().findChild<ParameterBox*>()->multipliers().stiffness, early ? 1.0 : 0.5);
        }
        volumes.insert(bars.accessibleDescription());
        speeds.insert(drill.speedRpm());
    }
    EXPECT_GT(volumes.size(), 2u);
    EXPECT_EQ(speeds.size(), 2u);
    // The person's own choice stands.
    simulator().closeReplay();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
    EXPECT_EQ(simulator().driveName(), "low-speed");
}

TEST_F(ShellTest, LayoutsLanguagesAndColoursChangeWhileOneWorks) {
    startWithTooth();
    const auto tooth = simulator().tooth();
    for (const char* name : {"actionLayoutLaboratory", "actionLayoutPaper", "actionLayoutPractice", "actionThemeDark",
                             "actionThemeLight"}) {
        action(name)->trigger();
        QTest::qWait(50);
    }
    EXPECT_EQ(window().detail(), Detail::practice);
    action("actionLayoutPaper")->trigger();
    for (const char* code : {"ja", "en"}) {
        window().findChild<QAction*>(QStringLiteral("actionLanguage_%1").arg(code))->trigger();
        QTest::qWait(100);
        EXPECT_TRUE(window().isVisible());
        EXPECT_EQ(window().detail(), Detail::paper);
        EXPECT_TRUE(view()->hasTooth());
    }
    EXPECT_EQ(simulator().tooth(), tooth);
    EXPECT_EQ(simulator().mode(), Simulator::Mode::liveSession);
    // And it is so at the next start.
    window().rememberAll();
    start();
    EXPECT_EQ(window().detail(), Detail::paper);
    EXPECT_TRUE(action("actionThemeLight")->isChecked());
}

TEST_F(ShellTest, AFileThatCannotBeOpenedIsToldOfAndThereIsAToothAllTheSame) {
    CommandLine line;
    line.file = own_.filePath("missing.stl");
    start(line);
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
    window().errorDialog()->reject();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
    EXPECT_EQ(simulator().toothCase()->kind, "lower-first-molar");
}

TEST_F(ShellTest, ACaseASurfaceAndARecordingAreOpenedByDroppingThem) {
    startWithTooth();
    const cases::Case made = eggTooth(11);
    cases::writeCase(made, at("incisor"));
    drop(own_.filePath("incisor"));
    ASSERT_TRUE(waitFor([this] { return simulator().toothCase()->kind == "upper-central-incisor"; }));
    geometry::writeMesh(at("outer.stl"), made.outer);
    drop(own_.filePath("outer.stl"));
    ASSERT_TRUE(waitFor([this] { return simulator().document().name == "outer" && !simulator().isBusy(); }))
        << simulator().document().name;
    const QString recording = toQString(simulator().recording());
    ASSERT_TRUE(waitFor([this] { return simulator().sample().tick > 100; }));
    simulator().openStarter(aloneTooth(46));
    ASSERT_TRUE(waitFor([this] { return simulator().toothCase()->kind == "lower-first-molar"; }));
    drop(recording);
    EXPECT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay; }));
}

TEST_F(ShellTest, ARecordingOfAnotherEngineIsToldToBeApproximate) {
    startWithTooth();
    ASSERT_TRUE(waitFor([this] { return simulator().sample().tick > 100; }));
    action("actionReplay")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay; }));
    const auto* notices = window().findChild<NoticeBar*>();
    EXPECT_NE(notices->current(), "other-engine");
    {
        const session::SessionReader own(simulator().document().caseFile);
        session::SessionInfo info = own.info();
        --info.engineRevision;
        session::Recorder older(at("older.h5"), info);
        for (const session::Record& record : own.records(0, static_cast<std::size_t>(own.size())))
            older.pushWaiting(record);
    }
    drop(own_.filePath("older.h5"));
    ASSERT_TRUE(waitFor([&] { return notices->current() == "other-engine"; })) << notices->current().toStdString();
    EXPECT_EQ(simulator().document().name, "older.h5");
    simulator().openStarter(aloneTooth(11));
    EXPECT_TRUE(waitFor([&] { return notices->current().isEmpty(); })) << notices->current().toStdString();
}

TEST_F(ShellTest, AsksForWorkThatWaitsBehindAReplay) {
    startWithTooth();
    ASSERT_TRUE(cut());
    action("actionReplay")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay; }));
    answer_ = Questions::Unsaved::cancel;
    openTooth(11);
    EXPECT_EQ(asked_, 1);
    EXPECT_EQ(simulator().mode(), Simulator::Mode::replay);
    answer_ = Questions::Unsaved::save;
    file_ = own_.filePath("behind.handpiece");
    openTooth(11);
    ASSERT_TRUE(waitFor([this] { return simulator().toothCase()->kind == "upper-central-incisor"; }));
    EXPECT_TRUE(fs::exists(toPath(file_)));
    EXPECT_EQ(asked_, 2);
}

TEST_F(ShellTest, TheCodeGoesIntoRecordingsAndAttempts) {
    startWithTooth();
    const fs::path before = simulator().recording();
    simulator().setCode("A-17 \u00fc");
    ASSERT_TRUE(waitFor([&] { return simulator().recording() != before && !simulator().isBusy(); }));
    const fs::path recording = simulator().recording();
    view()->showStandardView(view::StandardView::occlusal);
    ASSERT_TRUE(cut());
    // Too late for this recording: it is said, and what is saved has it.
    simulator().setCode("B-4");
    EXPECT_EQ(window().findChild<NoticeBar*>()->current(), "code-later");
    file_ = own_.filePath("coded.handpiece");
    action("actionSaveAs")->trigger();
    ASSERT_TRUE(waitFor([this] { return fs::exists(toPath(file_)) && !simulator().isUnsaved(); }));
    EXPECT_EQ(cases::openAttempt(toPath(file_)).attempt.student, "B-4");
    simulator().close();
    EXPECT_EQ(session::SessionReader(recording).info().code, "A-17");
}

TEST_F(ShellTest, SectionControlsStayInStep) {
    startWithTooth();
    auto* box = window().findChild<MeasureBox*>();
    auto* on = box->findChild<QCheckBox*>("sectionOn");
    auto* offset = box->findChild<QDoubleSpinBox*>("sectionOffset");
    auto* bar = window().findChild<SectionBar*>();
    action("actionSection")->trigger();
    EXPECT_TRUE(on->isChecked());
    EXPECT_FALSE(bar->isVisible());
    EXPECT_NEAR(offset->value(), view()->section()->offsetMm, 0.05);
    // Beyond the tooth there is nothing to cut.
    offset->setValue(100.0);
    EXPECT_NEAR(offset->value(), view()->section()->offsetMm, 0.05);
    action("actionLayoutLaboratory")->trigger();
    EXPECT_TRUE(bar->isVisible());
    view()->setSection(SectionPlace{SectionPlace::Direction::horizontal, 1.0, true});
    const bool flipped = view()->section()->flipped;  // to the side that the eye sees
    EXPECT_NEAR(offset->value(), 1.0, 1e-9);
    EXPECT_NEAR(bar->place().offsetMm, 1.0, 1e-9);
    offset->setValue(1.5);
    EXPECT_NEAR(bar->place().offsetMm, 1.5, 1e-9);
    EXPECT_EQ(view()->section()->flipped, flipped);
    on->setChecked(false);
    EXPECT_FALSE(view()->section());
    EXPECT_FALSE(action("actionSection")->isChecked());
}

TEST_F(ShellTest, VoxelAndSoundsAreThereAtTheNextStart) {
    sound::Wav wav;
    wav.samples.assign(4800, 0.25f);
    sound::writeWav(wav, at("motor.wav"));
    startWithTooth();
    simulator().setVoxel(150);
    ASSERT_TRUE(waitFor([this] { return simulator().voxelUm() == 150 && !simulator().isBusy(); }));
    auto* control = window().findChild<SoundControl*>();
    file_ = own_.filePath("motor.wav");
    emit control->recordingFileRequested(SoundControl::Channel::motor);
    ASSERT_TRUE(waitFor([this] { return !simulator().isReadingSound(); }));
    window().rememberAll();
    startWithTooth();
    EXPECT_EQ(simulator().voxelUm(), 150);
    auto* source = window().findChild<SoundControl*>()->findChild<QComboBox*>("motorSource");
    EXPECT_EQ(source->currentIndex(), 1);
}

TEST_F(ShellTest, ARunIsToldInFigures) {
    CommandLine line;
    line.stats = own_.filePath("run.json");
    startWithTooth(line);
    ASSERT_TRUE(waitFor([this] { return simulator().sample().tick > 200; }));
    simulator().close();
    QMetaObject::invokeMethod(qApp, "aboutToQuit");
    QFile file(line.stats);
    ASSERT_TRUE(file.open(QIODevice::ReadOnly));
    const QJsonObject tick = QJsonDocument::fromJson(file.readAll()).object()["tick"].toObject();
    EXPECT_GT(tick["ticks"].toInt(), 0);
    EXPECT_GT(tick["ticks"].toInt() + tick["missedPeriods"].toInt(), 200);
    const QJsonObject work = tick["workUs"].toObject();
    EXPECT_GT(work["p50"].toDouble(), 0.0);
    EXPECT_LE(work["p50"].toDouble(), work["p99"].toDouble());
    EXPECT_LE(work["p99"].toDouble(), work["max"].toDouble());
}

TEST_F(ShellTest, AStarterToothIsMadeAtTheFirstStartAndKept) {
    Simulator::Options mine = options();
    mine.folders.starters = at("fresh");
    mine.starter = aloneTooth(11);
    fs::file_time_type made;
    for (const bool first : {true, false}) {
        host_ = std::make_unique<Host>(*qApp, CommandLine{}, mine);
        // Something to look at comes long before there is something to feel, and words for what is being done.
        QStringList steps;
        bool wasSketched = false;
        const auto look = [&] { wasSketched = wasSketched || (view()->hasSketch() && !view()->hasTooth()); };
        QObject::connect(&simulator(), &Simulator::jobStepped, [&](const QString& step) { steps << step, look(); });
        host_->start();
        ASSERT_TRUE(
            waitFor([this] { return view()->hasSketch() || simulator().mode() == Simulator::Mode::liveSession; }));
        look();
        // On a busy machine all of it may come between two looks.
        if (simulator().mode() != Simulator::Mode::liveSession) {
            EXPECT_TRUE(simulator().isBusy());
            EXPECT_TRUE(window().findChild<QLabel*>("jobTitle")->text().contains(steps.last()));
        }
        ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
        EXPECT_TRUE(wasSketched);
        EXPECT_FALSE(view()->hasSketch());
        EXPECT_EQ(steps.size(), first ? 5 : 4) << steps.join(", ").toStdString();
        EXPECT_EQ(simulator().toothCase()->kind, "upper-central-incisor");
        EXPECT_EQ(simulator().toothCase()->outer.triangles.size(), 4000u);
        EXPECT_FALSE(simulator().toothCase()->landmarks.empty());
        const fs::file_time_type now = fs::last_write_time(simulator().document().caseFile / "case.toml");
        if (first) {
            made = now;
        } else {
            EXPECT_EQ(now, made);
        }
        host_.reset();
    }
}

/// Eggs in a row for a mouth: 32 teeth, and what it takes to be found in the cache.
cases::Case eggMouth() {
    cases::Case mouth = eggTooth(46);
    mouth.scenery.clear();
    double atMm = 12.0;
    for (int quadrant = 1; quadrant <= 4; ++quadrant)
        for (int place = 1; place <= 8; ++place) {
            const int fdi = 10 * quadrant + place;
            if (fdi == 46) continue;
            cases::PlacedTooth other;
            static_cast<cases::Tooth&>(other) = eggTooth(fdi);
            other.parts.clear();
            other.outer = test::icosphere(1, [](const core::Vec3& v) -> core::Vec3 { return 3.0 * v; });
            other.inCase.positionMm = {0.0, (quadrant > 2 ? 1.0 : -1.0) * atMm, 0.0};
            atMm += 7.0 / 2.0;
            mouth.others.push_back(std::move(other));
        }
    return mouth;
}

TEST_F(ShellTest, TheChartOpensAnyToothOfTheMouthAndSaysWhatWasMadeAnew) {
    const fs::path cache = at("mouths");
    cases::writeCase(eggMouth(), course::keptMouthPlace({}, cache));
    for (const int fdi : {46, 23})
        cases::writeCase(eggTooth(fdi), course::keptToothPlace(fdi, {}, 4000, cache));
    Simulator::Options mine = options();
    mine.folders.starters = cache;
    mine.starter = {46, {}, 4000, true};
    host_ = std::make_unique<Host>(*qApp, CommandLine{}, mine);
    window().resize(1000, 700);
    host_->start();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
    EXPECT_EQ(simulator().toothCase()->others.size(), 31u);
    // By a click on the chart.
    action("actionChooseTooth")->trigger();
    auto* chart = window().findChild<ToothChart*>();
    ASSERT_NE(chart, nullptr);
    EXPECT_EQ(chart->chosen(), 46);
    QTest::mouseClick(chart, Qt::LeftButton, {}, chart->centreOf(23).toPoint());
    ASSERT_TRUE(waitFor([this] { return simulator().toothCase()->fdiNumber == 23; }));
    EXPECT_EQ(simulator().toothCase()->others.size(), 31u);
    EXPECT_EQ(simulator().toothCase()->outer.triangles.size(), 5120u) << "the fine one, not that of the mouth";
    ASSERT_TRUE(idle());
    // A kept tooth that is damaged is made anew, and that is told; the one that is open stays until then.
    fs::remove(course::keptToothPlace(46, {}, 4000, cache) / "outer.stl");
    simulator().openStarter({46, {}, 4000, true});
    EXPECT_TRUE(waitFor([this] { return window().findChild<NoticeBar*>()->current() == "cache-renewed"; }));
    simulator().cancelJob();
    ASSERT_TRUE(idle());
    EXPECT_EQ(simulator().toothCase()->fdiNumber, 23);
}

TEST_F(ShellTest, AToothThatCannotBeKeptIsOpenedAllTheSameSavedAndReadBack) {
    core::writeFile(at("file"), std::string("no folder"));
    Simulator::Options mine = options();
    mine.folders.starters = at("file") / "starter";
    mine.starter = {11, {}, 4000, false};
    host_ = std::make_unique<Host>(*qApp, CommandLine{}, mine);
    host_->start();
    QStringList told;
    QObject::connect(&simulator(), &Simulator::noticed, [&](const QString& id) { told << id; });
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
    EXPECT_EQ(told.count("cache-not-kept"), 1);
    EXPECT_EQ(simulator().toothCase()->fdiNumber, 11);
    // What is saved of it is the tooth that was open, bit for bit.
    const std::uint64_t key = cases::contentKey(*simulator().toothCase());
    simulator().saveAs(at("kept.handpiece"));
    ASSERT_TRUE(idle());
    simulator().open(at("kept.handpiece"));
    ASSERT_TRUE(waitFor([&] { return simulator().document().attemptFile == at("kept.handpiece"); }));
    ASSERT_TRUE(idle());
    EXPECT_EQ(cases::contentKey(*simulator().toothCase()), key);
}

TEST_F(ShellTest, TheChartShowsTheCasesOfAFolderAtTheirTeeth) {
    cases::Case school = eggTooth(16);
    school.name = "A school's molar";
    cases::writeCase(school, at("school") / "molar");
    Simulator::Options mine = options();
    mine.casesFolder = at("school");
    host_ = std::make_unique<Host>(*qApp, CommandLine{}, mine);
    window().resize(1000, 700);
    host_->start();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
    action("actionChooseTooth")->trigger();
    auto* dialog = window().findChild<ChartDialog*>();
    auto* mouths = dialog->findChild<QComboBox*>("chartMouth");
    ASSERT_TRUE(waitFor([&] { return mouths->count() == 2; }));
    EXPECT_TRUE(mouths->itemText(1).contains("A school's molar"));
    // At its tooth there is a choice.
    QTest::mouseClick(dialog->chart(), Qt::LeftButton, {}, dialog->chart()->centreOf(16).toPoint());
    auto* choice = dialog->findChild<QMenu*>("chartChoice");
    ASSERT_NE(choice, nullptr);
    ASSERT_EQ(choice->actions().size(), 2);
    choice->close();
    // Its own chart has that tooth and no other.
    mouths->setCurrentIndex(1);
    EXPECT_EQ(dialog->chart()->chosen(), 16);
    QTest::mouseClick(dialog->chart(), Qt::LeftButton, {}, dialog->chart()->centreOf(46).toPoint());
    EXPECT_TRUE(dialog->isVisible());
    QTest::mouseClick(dialog->chart(), Qt::LeftButton, {}, dialog->chart()->centreOf(16).toPoint());
    ASSERT_TRUE(waitFor([this] { return simulator().toothCase()->fdiNumber == 16; }));
    EXPECT_EQ(simulator().document().caseFile, at("school") / "molar");
}

TEST_F(ShellTest, TheFirstOpeningCanBeCancelled) {
    Simulator::Options mine = options();
    mine.folders.starters = at("fresh");
    mine.starter = {46, {}, 68151, true};
    host_ = std::make_unique<Host>(*qApp, CommandLine{}, mine);
    host_->start();
    ASSERT_TRUE(waitFor([this] { return view()->hasSketch(); }));
    QTest::mouseClick(window().findChild<QAbstractButton*>("jobCancel"), Qt::LeftButton);
    ASSERT_TRUE(idle());
    EXPECT_EQ(simulator().mode(), Simulator::Mode::empty);
    EXPECT_FALSE(view()->hasSketch());
    EXPECT_FALSE(window().errorDialog());
    EXPECT_FALSE(fs::exists(at("fresh")));
}

TEST_F(ShellTest, TissuesAreWrittenEachAsAClosedSurface) {
    startWithTooth();
    ASSERT_TRUE(cut());
    file_ = own_.filePath("tissues");
    action("actionExportTissues")->trigger();
    ASSERT_TRUE(idle());
    for (const char* name : {"enamel", "dentine", "pulp"}) {
        const auto mesh = geometry::readMesh(at("tissues") / (std::string(name) + ".stl"));
        const geometry::MeshReport report = geometry::inspect(mesh);
        EXPECT_EQ(report.openEdges, 0u) << name;
        EXPECT_GT(report.volumeMm3, 1.0) << name;
    }
    // A file stands where the folder should: one error, and the work goes on.
    std::ofstream(at("taken")) << "no folder";
    file_ = own_.filePath("taken");
    action("actionExportTissues")->trigger();
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
}

TEST_F(ShellTest, ThePapersForceAndHullAreChosenInItsLayout) {
    startWithTooth();
    auto* box = window().findChild<ParameterBox*>();
    for (const Detail detail : {Detail::laboratory, Detail::paper}) {
        window().setDetail(detail);
        for (const char* name : {"forceMode", "contactMethod", "voxelSize"})
            EXPECT_TRUE(box->findChild<QComboBox*>(name)->isVisibleTo(box)) << name;
    }
    auto* force = box->findChild<QComboBox*>("forceMode");
    force->setCurrentIndex(1);
    emit force->activated(1);
    EXPECT_EQ(simulator().parameters().law, force::LawId::penalty);
    ASSERT_TRUE(waitFor([&] { return simulator().sample().lastCommand > 0; }));
    // Another tooth is felt the same way, and a reset of the multipliers leaves it.
    simulator().openStarter(aloneTooth(11));
    ASSERT_TRUE(idle());
    EXPECT_EQ(simulator().parameters().law, force::LawId::penalty);
    EXPECT_EQ(force->currentIndex(), 1);
}

TEST_F(ShellTest, AHintGoesByItselfAndCoversNothing) {
    startWithTooth();
    auto* notices = window().findChild<NoticeBar*>();
    window().notices().hintMs = 300;
    file_ = own_.filePath("kept.png");
    action("actionPicture")->trigger();
    EXPECT_EQ(notices->current(), "saved");
    EXPECT_TRUE(waitFor([&] { return notices->current().isEmpty(); }));
    // Beside something of the work it stands in the status bar.
    window().notices().hintMs = 1500;
    window().notices().tell(Notice::stalled);
    file_ = own_.filePath("other.png");
    action("actionPicture")->trigger();
    EXPECT_EQ(notices->current(), "stalled");
    EXPECT_TRUE(window().statusBar()->currentMessage().contains("other.png"));
    EXPECT_TRUE(waitFor([&] { return notices->current().isEmpty(); }));
    EXPECT_TRUE(waitFor([&] { return window().statusBar()->currentMessage().isEmpty(); }));
    // A warning stays until somebody has read it.
    window().notices().hintMs = 100;
    window().notices().tell(Notice::neighbourTouched);
    QTest::qWait(400);
    EXPECT_EQ(notices->current(), "neighbour-touched");
    // The graver one takes its place.
    window().notices().tell(Notice::neighbourCut);
    EXPECT_EQ(notices->current(), "neighbour-cut");
}

TEST_F(ShellTest, PanelsThatNeedNoMoreLeaveNoGap) {
    startWithTooth();
    action("actionLayoutPractice")->trigger();
    window().resize(1440, 1000);
    QTest::qWait(50);
    for (const char* name : {"gaugeDock", "measureDock"}) {
        const auto* dock = window().findChild<QDockWidget*>(QLatin1String(name));
        EXPECT_LE(dock->height(), dock->sizeHint().height()) << name;
    }
    EXPECT_GT(window().findChild<QDockWidget*>(QStringLiteral("soundDock"))->height(), 150);
}

TEST_F(ShellTest, EveryLayoutFitsASmallScreenAndSaysEachTitleOnce) {
    startWithTooth();
    for (const char* code : {"en", "ja"}) {
        window().findChild<QAction*>(QStringLiteral("actionLanguage_%1").arg(QLatin1String(code)))->trigger();
        QTest::qWait(50);
        for (const char* layout : {"actionLayoutPractice", "actionLayoutLaboratory", "actionLayoutPaper"}) {
            SCOPED_TRACE(std::string(code) + " " + layout);
            action(layout)->trigger();
            for (const QSize screen : {QSize(1366, 768), QSize(1280, 720)}) {
                const QSize size = MainWindow::firstSize(screen);
                window().resize(size);
                QTest::qWait(50);  // what is asked for and what the layouts want instead
                EXPECT_EQ(window().size(), size)
                    << window().minimumSizeHint().width() << " x " << window().minimumSizeHint().height();
                EXPECT_GT(view()->width(), 400);
                EXPECT_GT(view()->height(), 250);
            }
            for (const QDockWidget* dock : window().findChildren<QDockWidget*>())
                for (const QLabel* label : dock->findChildren<QLabel*>())
                    EXPECT_FALSE(label->isVisible() && label->text() == dock->windowTitle())
                        << qPrintable(label->text());
        }
    }
}

TEST_F(ShellTest, BrokenSettingsAreToldInAStrip) {
    fs::create_directories(at("config"));
    std::ofstream(at("config/handpiece.ini")) << "no settings\n[at all";
    start();
    EXPECT_EQ(window().findChild<NoticeBar*>()->current(), "settings-broken");
    EXPECT_TRUE(fs::exists(at("config/handpiece.ini.broken")));
}

/// Not a test of its own: the program that AfterACrash kills.
TEST_F(ShellTest, DISABLED_CutsUntilItIsKilled) {
    own_ = QTemporaryDir(qEnvironmentVariable("HANDPIECE_TEST_FOLDER") + "/XXXXXX");
    Simulator::Options mine = options();
    mine.folders.sessions = toPath(qEnvironmentVariable("HANDPIECE_TEST_FOLDER") + "/data/sessions");
    mine.folders.starters = toPath(qEnvironmentVariable("HANDPIECE_TEST_STARTER"));
    host_ = std::make_unique<Host>(*qApp, CommandLine{}, mine);
    window().resize(1000, 700);
    host_->start();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
    view()->showStandardView(view::StandardView::occlusal);
    ASSERT_TRUE(cut());
    const std::uint64_t soFar = simulator().sample().tick;
    ASSERT_TRUE(waitFor([&] { return simulator().status().recording.writtenRecords > soFar; }));
    std::printf("cut %.9f\n", removedMm3());
    std::fflush(stdout);
    (void)waitFor([] { return false; });
}

TEST_F(ShellTest, AfterACrashTheToothComesBack) {
    QProcess child;
    QProcessEnvironment environment = QProcessEnvironment::systemEnvironment();
    environment.insert("HANDPIECE_TEST_FOLDER", own_.path());
    environment.insert("HANDPIECE_TEST_STARTER", shared().filePath("teeth"));
    child.setProcessEnvironment(environment);
    child.start(QCoreApplication::applicationFilePath(),
                {"--gtest_also_run_disabled_tests", "--gtest_filter=*DISABLED_CutsUntilItIsKilled"});
    QByteArray said;
    const bool cutThere = waitFor([&] {
        said += child.readAllStandardOutput();
        const auto at = said.indexOf("\ncut ");
        return (at >= 0 && said.indexOf('\n', at + 1) > 0) || child.state() == QProcess::NotRunning;
    });
    child.kill();
    child.waitForFinished();
    ASSERT_TRUE(cutThere && said.contains("\ncut ")) << said.constData();
    const double cutMm3 = said.mid(said.indexOf("\ncut ") + 5).split('\n').front().toDouble();
    ASSERT_GT(cutMm3, 0.0);

    start();
    auto* notices = window().findChild<NoticeBar*>();
    EXPECT_EQ(notices->current(), "crashed");
    // Named as the window names it, not as its folder.
    EXPECT_FALSE(notices->findChild<QLabel*>("noticeText")->text().contains("lower-first-molar"));
    // Later is another time: it is still there.
    QTest::mouseClick(notices->findChild<QAbstractButton*>("noticeLater"), Qt::LeftButton);
    EXPECT_EQ(notices->current(), QString());
    EXPECT_EQ(simulator().crashed().size(), 1u);
    window().greet();
    ASSERT_TRUE(
        waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession && !simulator().isBusy(); }));
    emit notices->remedyChosen("crashed");
    ASSERT_TRUE(waitFor([&] { return std::abs(removedMm3() - cutMm3) < 1e-6 && simulator().sample().tick > 10; }))
        << removedMm3() << " not " << cutMm3;
    EXPECT_TRUE(simulator().isUnsaved());
    EXPECT_TRUE(simulator().crashed().empty());
    EXPECT_EQ(simulator().toothCase()->scenery.size(), 1u);
    EXPECT_TRUE(waitFor([this] { return simulator().status().undoSteps == 1; }));

    // What follows is one session with what came before: report, replay and its time line have both.
    view()->showStandardView(view::StandardView::occlusal);
    ASSERT_TRUE(cut());
    ASSERT_TRUE(waitFor([this] { return simulator().status().undoSteps == 2; }));
    const double bothMm3 = removedMm3();
    action("actionReplay")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay; }));
    const fs::path recording = simulator().document().caseFile;
    const auto& marks = window().findChild<Timeline*>()->marks();
    EXPECT_EQ(std::count_if(marks.begin(), marks.end(),
                            [](const ReplayMark& m) { return m.kind == ReplayMark::Kind::strokeBegin; }),
              2);
    simulator().seek(simulator().replay()->durationS());
    EXPECT_TRUE(waitFor([&] { return std::abs(removedMm3() - bothMm3) < 1e-4; })) << removedMm3() << " " << bothMm3;
    simulator().seek(marks.front().timeS);
    EXPECT_TRUE(waitFor([this] { return removedMm3() < 0.02; })) << removedMm3();
    simulator().writeReport(at("report.html"));
    ASSERT_TRUE(idle());
    const std::vector<std::byte> page = core::readFile(at("report.html"));
    const std::string text(reinterpret_cast<const char*>(page.data()), page.size());
    EXPECT_NE(text.find("class=\"good\""), std::string::npos);
    EXPECT_NE(text.find("1 of 1 times"), std::string::npos);
    simulator().closeReplay();
    ASSERT_TRUE(waitFor([&] { return simulator().mode() == Simulator::Mode::liveSession && removedMm3() > cutMm3; }));
    EXPECT_EQ(simulator().recording(), recording);

    ASSERT_TRUE(waitFor([this] { return simulator().status().undoSteps == 2; }));
    ASSERT_TRUE(undoAll());
    EXPECT_TRUE(waitFor([this] { return removedMm3() == 0.0; }));
    EXPECT_FALSE(window().windowTitle().contains("lower-first-molar")) << qPrintable(window().windowTitle());
}

}  // namespace
}  // namespace handpiece::desktop::shell_window_test
