// SPDX-License-Identifier: Apache-2.0
// An exercise in the window: its words, what it locks, handing in, looking at what was handed in.
#include <QAbstractSpinBox>
#include <QCheckBox>
#include <QComboBox>
#include <QDialog>
#include <QDockWidget>
#include <QLabel>
#include <QListView>
#include <QPushButton>
#include <QSlider>
#include <QToolButton>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <set>

#include "desktop/features/drill/drill_bar.h"
#include "desktop/features/drill/welcome_strip.h"
#include "desktop/features/exercise/exercise_feature.h"
#include "desktop/features/exercise/exercise_panel.h"
#include "desktop/features/measure/measure_box.h"
#include "desktop/features/measure/volume_bars.h"
#include "desktop/picture/help_card.h"
#include "desktop/widgets/notice_bar.h"
#include "desktop/widgets/tooth_chart.h"
#include "handpiece/base/core/file.h"
#include "handpiece/record/session/session_reader.h"
#include "shell_support.h"

namespace handpiece::desktop::exercise_window_test {
namespace {

namespace fs = std::filesystem;

class ExerciseTest : public ShellTest {
  protected:
    fs::path makeCase(const char* name, const std::vector<std::string>& locked) {
        cases::Case made = eggTooth(46);
        made.name = name;
        made.exercise.emplace();
        made.exercise->title = {{"en", "Class <b>I</b> cavity"}, {"ja", "I級窩洞"}};
        made.exercise->instructions = {{"en", "1.5 mm deep.\nKeep off the pulp."}, {"ja", "深さ1.5 mm。"}};
        made.exercise->lockedHelps = locked;
        cases::writeCase(made, at(name));
        return at(name);
    }
    void openCase(const fs::path& place) {
        window().openFile(toQString(place));
        ASSERT_TRUE(waitFor([&] {
            return simulator().document().caseFile == place && simulator().mode() == Simulator::Mode::liveSession &&
                   !simulator().isBusy() && simulator().sample().tick > 10;
        }));
        view()->showStandardView(view::StandardView::occlusal);
    }
    [[nodiscard]] ExerciseFeature& feature() { return *window().findChild<ExerciseFeature*>(); }
    void startWith(const std::vector<std::string>& locked, const CommandLine& line = {}) {
        startWithTooth(line);
        feature().questions.student = [this](const QString&) {
            ++askedStudent_;
            return std::optional<QString>(student_);
        };
        feature().questions.lookOrGoOn = [this](const QString& student) {
            askedAbout_ = student;
            return choice_;
        };
        openCase(makeCase("exercise", locked));
    }
    template <class W>
    [[nodiscard]] W* part(const char* name) {
        return window().findChild<W*>(QLatin1String(name));
    }
    [[nodiscard]] fs::path handIn(const char* name) {
        file_ = own_.filePath(QLatin1String(name));
        action("actionHandIn")->trigger();
        EXPECT_TRUE(waitFor([&] {
            return fs::exists(toPath(file_)) && !simulator().isBusy() &&
                   simulator().mode() == Simulator::Mode::liveSession && simulator().sample().tick > 10;
        }));
        return toPath(file_);
    }

    int askedStudent_ = 0;
    QString student_ = QStringLiteral("S-07"), askedAbout_;
    ExerciseFeature::Choice choice_ = ExerciseFeature::Choice::look;
};

TEST_F(ExerciseTest, TitleAndInstructionsStandInTheWindowInItsLanguageAsPlainText) {
    startWithTooth();
    auto* dock = part<QDockWidget>("exerciseDock");
    EXPECT_TRUE(dock->isHidden()) << "a starter tooth is no exercise";
    EXPECT_FALSE(action("actionExercise")->isEnabled());
    openCase(makeCase("exercise", {"undo", "guide"}));
    EXPECT_FALSE(dock->isHidden());
    EXPECT_EQ(part<QLabel>("exerciseTitle")->text(), "Class <b>I</b> cavity");
    EXPECT_EQ(part<QLabel>("exerciseTitle")->textFormat(), Qt::PlainText);
    EXPECT_EQ(part<QLabel>("exerciseInstructions")->text(), "1.5 mm deep.\nKeep off the pulp.");
    EXPECT_TRUE(part<QLabel>("exerciseLocked")->text().contains("Undo, redo, reset"));
    EXPECT_TRUE(part<QLabel>("exerciseLocked")->text().contains("First steps"));
    // Closed and asked for again: the picture keeps its size.
    QCoreApplication::processEvents();
    const QSize picture = view()->size();
    dock->toggleViewAction()->trigger();
    EXPECT_TRUE(dock->isHidden());
    QCoreApplication::processEvents();
    EXPECT_GE(view()->width(), picture.width()) << "no narrower than it was";
    window().setDetail(Detail::laboratory);
    EXPECT_TRUE(dock->isHidden()) << "closed by a person";
    action("actionExercise")->trigger();
    EXPECT_FALSE(dock->isHidden());
    window().setDetail(Detail::practice);
    EXPECT_FALSE(dock->isHidden());
    QCoreApplication::processEvents();
    EXPECT_GE(view()->width(), picture.width()) << "no narrower than it was";
    openTooth(11);
    ASSERT_TRUE(waitFor([&] { return simulator().toothCase()->kind == "upper-central-incisor"; }));
    EXPECT_TRUE(dock->isHidden());
}

TEST_F(ExerciseTest, SpeaksJapaneseWhereTheWindowDoes) {
    CommandLine line;
    line.language = QStringLiteral("ja");
    startWith({}, line);
    EXPECT_EQ(part<QLabel>("exerciseTitle")->text(), QStringLiteral("I級窩洞"));
    EXPECT_EQ(part<QLabel>("exerciseInstructions")->text(), QStringLiteral("深さ1.5 mm。"));
    Language language;
    EXPECT_TRUE(language.use(QStringLiteral("en")));
}

TEST_F(ExerciseTest, ForWorkByMirrorShowsNothingElseAndEachRecordingSaysSo) {
    startWith({"direct-view"});
    std::vector<fs::path> recordings{simulator().recording()};
    EXPECT_TRUE(view()->camera().mirrored);
    EXPECT_TRUE(action("actionMirrorView")->isChecked());
    EXPECT_FALSE(action("actionMirrorView")->isEnabled());
    EXPECT_TRUE(action("actionMirrorView")->toolTip().contains("Locked"));
    EXPECT_TRUE(part<QLabel>("exerciseLocked")->text().contains("by mirror"));
    openCase(makeCase("another", {"direct-view"}));
    recordings.push_back(simulator().recording());
    EXPECT_TRUE(view()->camera().mirrored);
    openCase(makeCase("free", {}));
    EXPECT_FALSE(view()->camera().mirrored);
    EXPECT_TRUE(action("actionMirrorView")->isEnabled());
    for (const fs::path& recording : recordings) {
        const session::SessionReader reader(recording);
        const auto& events = reader.events();
        const auto way =
            std::find_if(events.begin(), events.end(), [](const auto& e) { return e.name == "working way"; });
        ASSERT_NE(way, events.end()) << recording;
        // As soon as the picture stands: on a busy machine that takes some hundred ticks.
        EXPECT_LT(way->tick, 2000u);
        EXPECT_NE(way->text.find(R"("mirror_only": true)"), std::string::npos) << way->text;
    }
}

/// Tries everything a person can reach, and notes what came about that a lock should have kept away.
class LockTest : public ExerciseTest {
  protected:
    void start(const std::vector<std::string>& locked) {
        startWith(locked);
        if (HasFatalFailure()) return;
        window().questions.fileToOpen = [](const QString&, const QString&, const QString&) { return QString(); };
        window().questions.fileToSave = [this](const QString&, const QString&, const QString& filter) {
            if (filter.contains(QLatin1String("html"))) open_.insert("score");
            return QString();
        };
        feature().questions.student = [](const QString&) { return std::nullopt; };
        window().setDetail(Detail::laboratory);
        QObject::connect(&closer_, &QTimer::timeout, [this] { closeDialogs(); });
        closer_.start(30);
    }
    /// Another exercise, locked otherwise, in the same window.
    void openLocked(const char* name, const std::vector<std::string>& locked) {
        openCase(makeCase(name, locked));
        open_.clear();
    }
    void closeDialogs() {
        for (QDialog* dialog : window().findChildren<QDialog*>())
            if (dialog->isVisible()) dialog->reject();
        while (QWidget* popup = QApplication::activePopupWidget())
            popup->close();
        for (HelpCard* card : window().findChildren<HelpCard*>())
            card->close();
    }
    /// Which locks are seen to be open now.
    void look() {
        QCoreApplication::processEvents();
        const view::Look look = view()->shownLook();
        const OverlayState written = view()->written();
        const Tool tool = view()->tool();
        const bool stop = view()->hand() && view()->hand()->stopMm();
        const bool measures = tool == Tool::calliper || tool == Tool::depth || tool == Tool::pulp;
        const auto note = [this](const char* help, bool isOpen) {
            if (isOpen) open_.insert(help);
        };
        note("depth", measures || stop || look.removedDepthColours || !written.measurements.empty() ||
                          !part<QLabel>("depthReadout")->isHidden() || !part<QLabel>("pulpReadout")->isHidden());
        note("tissue-colours", look.palette != view::Palette::natural || !written.legend.empty());
        note("cross-section", view()->section().has_value() || look.cutAway.has_value());
        const bool hides = std::any_of(look.visible.begin(), look.visible.end(), [](bool v) { return !v; });
        note("transparency", look.tooth != view::ToothShown::now || hides || view()->isComparing());
        note("guide", stop || !written.hint.isEmpty() || !window().findChild<WelcomeStrip*>()->isHidden());
        note("score", window().findChild<VolumeBars*>()->accessibleDescription().contains(QLatin1Char('0')));
        note("mirror", view()->isMirrorShown() || tool == Tool::mirror);
        note("scale-bar", written.scaleBar);
        note("calliper", tool == Tool::calliper || !part<QLabel>("calliperReadout")->isHidden());
        note("compare", view()->isComparing());
        note("direct-view", !view()->isMirrorView());
        for (const ToothChart* chart : window().findChildren<ToothChart*>())
            note("chart", chart->isVisible());
    }
    void tryCommands() {
        for (QAction* command : window().commands().all()) {
            // They end what is being looked at; the replay has a walk of its own.
            if (command->objectName() == "actionQuit" || command->objectName() == "actionReplay") continue;
            command->trigger();
            look();
            closeDialogs();
        }
    }
    void tryKeysAndPointer() {
        const QPoint middle = view()->rect().center();
        for (const ActionInfo& info : actionInfos())
            for (const Binding& binding : view()->bindings().of(info.action))
                for (int often = 0; often < 4; ++often) {
                    if (binding.kind == Binding::Kind::key)
                        QTest::keyClick(view(), static_cast<Qt::Key>(binding.code), binding.modifiers);
                    if (binding.kind == Binding::Kind::button)
                        QTest::mouseClick(view(), static_cast<Qt::MouseButton>(binding.code), binding.modifiers,
                                          middle);
                    if (binding.kind == Binding::Kind::wheel) {
                        QWheelEvent turn(QPointF(middle), view()->mapToGlobal(QPointF(middle)), {}, QPoint(0, 120),
                                         Qt::NoButton, binding.modifiers, Qt::NoScrollPhase, false);
                        QApplication::sendEvent(view(), &turn);
                    }
                    look();
                    closeDialogs();
                    if (info.action == Action::escape) break;
                }
    }
    void tryPanels() {
        // They ask for files, read sounds, cut the tooth anew or open another; none is a help.
        const std::set<QString> others{"voxelSize",   "contactMethod", "resolutionBox", "viewsButton", "plotSave",
                                       "replayClose", "motorRecord",   "cuttingRecord", "statusDevice"};
        for (QWidget* widget : window().findChildren<QWidget*>()) {
            if (!widget->isEnabled() || others.count(widget->objectName()) > 0 ||
                widget->objectName().startsWith(QLatin1String("qt_")) || qobject_cast<QDialog*>(widget->window()))
                continue;
            // A menu, or a command that has had its turn.
            const auto* tool = qobject_cast<QToolButton*>(widget);
            if (tool && (tool->menu() || tool->defaultAction())) continue;
            if (auto* button = qobject_cast<QAbstractButton*>(widget)) {
                button->click();
                look();
            } else if (auto* box = qobject_cast<QComboBox*>(widget)) {
                for (int i = 0; i < box->count(); ++i) {
                    box->setCurrentIndex(i);
                    emit box->activated(i);
                    look();
                }
            } else if (auto* slider = qobject_cast<QSlider*>(widget)) {
                slider->setValue(slider->value() == slider->minimum() ? slider->maximum() : slider->minimum());
                look();
            } else if (auto* spin = qobject_cast<QAbstractSpinBox*>(widget)) {
                spin->stepBy(1);
                look();
            }
            closeDialogs();
        }
    }
    void tryEverything() {
        look();
        tryCommands();
        tryKeysAndPointer();
        tryPanels();
        action("actionLayoutLaboratory")->trigger();
    }
    /// What the recording under way says was done, as well.
    void lookIntoTheRecording() {
        const fs::path recording = simulator().recording();
        ASSERT_FALSE(recording.empty());
        simulator().close();
        for (const session::Event& event : session::SessionReader(recording).events())
            for (const auto& [name, help] :
                 {std::pair(session::EventName::undo, "undo"), std::pair(session::EventName::redo, "undo"),
                  std::pair(session::EventName::reset, "reset")})
                if (event.name == session::nameOf(name)) {
                    open_.insert(help);
                    if (name == session::EventName::reset) open_.insert("undo");
                }
    }
    [[nodiscard]] static std::set<std::string> all() { return {cases::kHelps.begin(), cases::kHelps.end()}; }
    [[nodiscard]] static std::vector<std::string> allInARow() { return {cases::kHelps.begin(), cases::kHelps.end()}; }

    std::set<std::string> open_;
    QTimer closer_;
};

TEST_F(LockTest, WithoutLocksTheWalkFindsEveryHelp) {
    start({});
    ASSERT_TRUE(cut());
    // One after the other: each takes what the one before has left.
    action("actionUndo")->trigger();
    const auto isDone = [this](const char* next) {
        return action(next)->isEnabled() && !simulator().status().restoring;
    };
    ASSERT_TRUE(waitFor([&] { return isDone("actionRedo") && !simulator().status().cut; }));
    action("actionRedo")->trigger();
    ASSERT_TRUE(waitFor([&] { return isDone("actionReset") && simulator().status().cut; }));
    action("actionReset")->trigger();
    ASSERT_TRUE(waitFor([this] { return !simulator().status().cut && !simulator().status().restoring; }));
    // What a busy machine has not done yet when it is looked at, another walk finds; undo and reset stand in the
    // recording.
    for (int walk = 0; walk < 10 && open_.size() + 2 < all().size(); ++walk)
        tryEverything();
    lookIntoTheRecording();
    EXPECT_EQ(open_, all()) << "what it does not find it could not find locked either";
}

TEST_F(LockTest, WithAllLocksNothingIsOpenAtWorkNorInAReplayOfIt) {
    start(allInARow());
    ASSERT_TRUE(cut());
    tryEverything();
    EXPECT_EQ(open_, std::set<std::string>{});
    action("actionReplay")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay && !simulator().isBusy(); }));
    EXPECT_FALSE(part<QDockWidget>("exerciseDock")->isHidden());
    tryEverything();
    EXPECT_EQ(open_, std::set<std::string>{}) << "in the replay";
    simulator().closeReplay();
    ASSERT_TRUE(
        waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession && !simulator().isBusy(); }));
    tryEverything();
    lookIntoTheRecording();
    EXPECT_EQ(open_, std::set<std::string>{}) << "afterwards";
}

TEST_F(LockTest, EachLockAloneClosesEveryWayToItsHelp) {
    start({});
    // A third of them, each time others; all with HANDPIECE_EVERY_LOCK=1 (tools/nightly).
    const std::size_t step = std::getenv("HANDPIECE_EVERY_LOCK") ? 1 : 3;
    const std::size_t first = std::random_device{}() % step;
    std::printf("every lock of %zu, from %zu on\n", step, first);
    for (std::size_t i = first; i < std::size(cases::kHelps); i += step) {
        const std::string_view help = cases::kHelps[i];
        openLocked((std::string("only-") + std::string(help)).c_str(), {std::string(help)});
        if (HasFatalFailure()) return;
        if (help == "undo" || help == "reset") {
            ASSERT_TRUE(cut());
        }
        tryEverything();
        ASSERT_TRUE(idle());
        lookIntoTheRecording();
        EXPECT_EQ(open_.count(std::string(help)), 0u) << help;
    }
}

TEST_F(LockTest, WhatIsLockedSaysSo) {
    start({"mirror", "depth"});
    EXPECT_TRUE(action("actionMirror")->toolTip().contains("Locked"));
    EXPECT_FALSE(action("actionCompare")->toolTip().contains("Locked"));
    QTest::keyClick(view(), Qt::Key_M);
    EXPECT_EQ(window().findChild<NoticeBar*>()->current(), "help-locked");
    openLocked("free", {});
    EXPECT_FALSE(action("actionMirror")->toolTip().contains("Locked"));
    EXPECT_TRUE(action("actionMirror")->isEnabled());
}

TEST_F(LockTest, LocksAreThereAfterACrash) {
    start({"cross-section"});
    ASSERT_TRUE(cut());
    const fs::path sessions = at("data/sessions");
    // As a power cut leaves it: its marker stays.
    const fs::path recording = simulator().recording();
    const fs::path marker = fs::path(recording).replace_extension(".json");
    ASSERT_TRUE(waitFor([&] { return simulator().isUnsaved(); }));
    fs::copy_file(marker, sessions / "kept.json");
    fs::remove_all(at("exercise"));
    simulator().close();
    fs::rename(sessions / "kept.json", marker);
    window().greet();
    ASSERT_EQ(simulator().crashed().size(), 1u);
    simulator().recover(simulator().crashed().front());
    ASSERT_TRUE(
        waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession && !simulator().isBusy(); }));
    EXPECT_TRUE(simulator().permissions().locks(exercise::Operation::section));
    EXPECT_EQ(part<QLabel>("exerciseInstructions")->text(), "1.5 mm deep.\nKeep off the pulp.");
    EXPECT_EQ(simulator().recording(), recording) << "the work goes on in its recording";
    EXPECT_TRUE(simulator().document().recordings.empty());
}

TEST_F(ExerciseTest, AResumedAttemptKeepsToTheBursThatAreAllowed) {
    startWith({});
    simulator().setBur(QStringLiteral("245"));
    ASSERT_TRUE(cut());
    file_ = own_.filePath("mine.handpiece");
    action("actionSaveAs")->trigger();
    ASSERT_TRUE(waitFor([this] { return fs::exists(toPath(file_)) && !simulator().isBusy(); }));
    // The teacher allows fewer burs since.
    cases::OpenAttempt open = cases::openAttempt(toPath(file_));
    EXPECT_EQ(open.attempt.bur, "245");
    open.toothCase.exercise->allowedBurs = {"round-4", "330"};
    cases::writeAttempt(open.attempt, toPath(file_), &open.toothCase);
    action("actionResume")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().burName() == "round-4" && !simulator().isBusy(); }));
    EXPECT_EQ(window().findChild<DrillBar*>()->bur(), "round-4");
    EXPECT_EQ(window().findChild<NoticeBar*>()->current(), "bur-locked");
    simulator().setBur(QStringLiteral("245"));
    EXPECT_EQ(simulator().burName(), "round-4");
}

TEST_F(ExerciseTest, HandsInTheToothItsRecordingsAndWhoseItIs) {
    startWith({"depth", "undo"});
    ASSERT_TRUE(cut());
    const double before = removedMm3();
    const fs::path file = handIn("in.handpiece");
    EXPECT_EQ(askedStudent_, 1);
    EXPECT_EQ(simulator().code(), "S-07");
    EXPECT_FALSE(simulator().isUnsaved());
    EXPECT_NEAR(removedMm3(), before, 1e-9) << "the work goes on";
    EXPECT_FALSE(action("actionDepth")->isEnabled());
    const cases::Attempt first = cases::readAttempt(file);
    EXPECT_TRUE(first.handedIn);
    EXPECT_EQ(first.student, "S-07");
    ASSERT_EQ(first.recordings.size(), 1u);
    EXPECT_TRUE(first.recordings[0].packed);
    EXPECT_FALSE(cases::readRecording(file, first.recordings[0].name).empty());
    // Cut on, after a replay, and handed in again: nobody is asked twice, all recordings are in it.
    ASSERT_TRUE(cut());
    action("actionReplay")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay && !simulator().isBusy(); }));
    simulator().closeReplay();
    ASSERT_TRUE(
        waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession && !simulator().isBusy(); }));
    const cases::Attempt second = cases::readAttempt(handIn("again.handpiece"));
    EXPECT_EQ(askedStudent_, 1);
    ASSERT_EQ(second.recordings.size(), 1u) << "all of it is one recording, named once";
    EXPECT_TRUE(second.recordings[0].packed);
    EXPECT_EQ(second.recordings[0].name, first.recordings[0].name);
}

TEST_F(ExerciseTest, WhoLooksAtWhatWasHandedInHasNoLocksAndChangesNothing) {
    startWith({"depth", "undo", "cross-section", "score"});
    ASSERT_TRUE(cut());
    const double cutMm3 = removedMm3();
    const fs::path file = handIn("in.handpiece");
    const auto bytes = core::readFile(file);

    // Another start, as a teacher's.
    startWith({});
    window().openFile(toQString(file));
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::review; }));
    EXPECT_EQ(askedAbout_, "S-07");
    EXPECT_TRUE(part<QLabel>("exerciseStudent")->text().contains("S-07"));
    EXPECT_EQ(part<QLabel>("exerciseTitle")->text(), "Class <b>I</b> cavity");
    EXPECT_TRUE(part<QLabel>("exerciseLocked")->isHidden());
    EXPECT_NEAR(removedMm3(), cutMm3, 1e-9);
    for (const char* name : {"actionDepth", "actionSection", "actionCompare", "actionMeasure"}) {
        EXPECT_TRUE(action(name)->isEnabled()) << name;
        action(name)->trigger();
        EXPECT_TRUE(action(name)->isChecked()) << name;
        action(name)->trigger();
    }
    for (const char* name : {"actionUndo", "actionReset", "actionSave", "actionHandIn", "actionPedal"})
        EXPECT_FALSE(action(name)->isEnabled()) << name;
    EXPECT_FALSE(view()->hand()) << "the mouse only looks";
    // What was done is watched, with nothing locked; closing it leads back.
    part<QPushButton>("exerciseWatch_1")->click();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay; }));
    EXPECT_TRUE(action("actionDepth")->isEnabled());
    EXPECT_TRUE(action("actionReport")->isEnabled());
    const double endS = simulator().replay()->durationS();
    simulator().seek(endS);
    EXPECT_TRUE(waitFor([&] { return simulator().replay()->now().timeS > endS - 0.01; }));
    simulator().closeReplay();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::review; }));
    EXPECT_EQ(core::readFile(file), bytes);

    // Or gone on with: then as the exercise has it.
    part<QPushButton>("exerciseGoOn")->click();
    ASSERT_TRUE(
        waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession && !simulator().isBusy(); }));
    EXPECT_FALSE(action("actionDepth")->isEnabled());
    EXPECT_NEAR(removedMm3(), cutMm3, 1e-9);
    // Saved over itself it keeps what came with it.
    action("actionSave")->trigger();
    ASSERT_TRUE(waitFor([this] { return !simulator().isBusy(); }));
    const cases::Attempt saved = cases::readAttempt(file);
    EXPECT_FALSE(saved.handedIn);
    ASSERT_EQ(saved.recordings.size(), 2u);
    EXPECT_TRUE(saved.recordings[0].packed);
    EXPECT_FALSE(saved.recordings[1].packed);
}

}  // namespace
}  // namespace handpiece::desktop::exercise_window_test
