// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/drill/drill_feature.h"

#include <QActionGroup>
#include <QMouseEvent>
#include <cmath>
#include <numeric>

#include "desktop/features/drill/drill_bar.h"
#include "desktop/features/drill/parameter_box.h"
#include "desktop/framework/helps.h"
#include "desktop/picture/key_bindings_dialog.h"
#include "desktop/widgets/force_gauge.h"
#include "desktop/work/device_words.h"
#include "desktop/work/simulator.h"
#include "handpiece/app/input/pointer_controller.h"
#include "handpiece/model/instrument/turbine.h"
#include "handpiece/record/session/event_watch.h"

namespace handpiece::desktop {
namespace {

using exercise::Operation;

using Command = DrillFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::undo, "actionUndo", QT_TRANSLATE_NOOP("Commands", "Undo"),
     QT_TRANSLATE_NOOP("Commands", "Put back what the last stroke took away"), "undo", "Ctrl+Z", in(Shelf::edit, 0),
     in(Shelf::toolBar, 10), Operation::undo, onCard(1)},
    {Command::redo, "actionRedo", QT_TRANSLATE_NOOP("Commands", "Redo"),
     QT_TRANSLATE_NOOP("Commands", "Take the stroke away again"), "redo", "Ctrl+Shift+Z", in(Shelf::edit, 1),
     in(Shelf::toolBar, 11), Operation::redo, onCard(2)},
    {Command::reset, "actionReset", QT_TRANSLATE_NOOP("Commands", "Reset the tooth"),
     QT_TRANSLATE_NOOP("Commands", "Put back all that was cut"), "reset", "Ctrl+Backspace", in(Shelf::edit, 10),
     in(Shelf::toolBar, 12), brief(QT_TRANSLATE_NOOP("Commands", "Reset")), Operation::reset, onCard(3)},
    {Command::touch, "actionTouch", QT_TRANSLATE_NOOP("Commands", "Touch"),
     QT_TRANSLATE_NOOP("Commands", "The left button touches with the bur still"), "touch", "F2", in(Shelf::tools, 0),
     in(Shelf::toolBar, 0), kCheckable},
    {Command::cut, "actionCut", QT_TRANSLATE_NOOP("Commands", "Cut"),
     QT_TRANSLATE_NOOP("Commands", "The left button presses and cuts"), "cut", "F3", in(Shelf::tools, 1),
     in(Shelf::toolBar, 1), kCheckable},
    {Command::pedal, "actionPedal", QT_TRANSLATE_NOOP("Commands", "Hold the pedal down"),
     QT_TRANSLATE_NOOP("Commands", "The turbine keeps turning (key P)"), "speed", "F4", in(Shelf::tools, 2),
     kCheckable},
    {Command::bindings, "actionBindings", QT_TRANSLATE_NOOP("Commands", "Keys and mouse..."),
     QT_TRANSLATE_NOOP("Commands", "Choose which key or button does what"), "keyboard", "Ctrl+Shift+K",
     in(Shelf::tools, 20)},
    {Command::firstSteps, "actionFirstSteps", QT_TRANSLATE_NOOP("Commands", "First steps again"),
     QT_TRANSLATE_NOOP("Commands", "Show the hints of the first minute again, from the first"), "info", "Ctrl+Shift+F1",
     in(Shelf::help, 1)},
};

}  // namespace

DrillFeature::DrillFeature(const FeatureContext& context)
    : Feature(context),
      commands_(window_.commands(), kCommands),
      bar_(new DrillBar),
      gauge_(new ForceGauge),
      parameters_(new ParameterBox),
      welcome_(new WelcomeStrip) {
    addDocks();
    view_.addStrip(welcome_, StripStack::Where::below);
    view_.setTurbine(instrument::turbineMesh());
    connectCommands();
    connectPanels();
    connectWelcome();
    recallBindings();
    const auto tellLocked = [this](Operation operation) {
        if (operation == Operation::elsewhere) return window_.notices().tell(Notice::examRuns);
        window_.notices().tell(Notice::helpLocked, {operationWords(operation)});
    };
    connect(&view_, &ViewWidget::refused, this, tellLocked);
    connect(&simulator_, &Simulator::refused, this, tellLocked);
    connect(&simulator_, &Simulator::settingsChanged, this, &DrillFeature::showSettings);
    connect(&simulator_.hands(), &DeviceManager::changed, this, &DrillFeature::showSettings);
    keepShown();
}

/// Which burs are listed goes over to the window of another language.
void DrillFeature::keepShown() {
    const QString words = QStringLiteral("passing/burWords"), shape = QStringLiteral("passing/burShape");
    bar_->setShown({settings_.value(words).toString(), settings_.value(shape, -1).toInt()});
    connect(&window_, &MainWindow::aboutToRemember, this, [this, words, shape] {
        settings_.set(words, bar_->shown().words);
        settings_.set(shape, bar_->shown().shape);
    });
}

void DrillFeature::addDocks() {
    Docks& docks = window_.docks();
    docks.add({"drillDock",
               tr("Handpiece"),
               20,
               {{Detail::practice, Qt::LeftDockWidgetArea, 20, 510},
                {Detail::laboratory, Qt::LeftDockWidgetArea, 20, 510},
                {Detail::paper, Qt::LeftDockWidgetArea, 20, 510}}},
              bar_);
    docks.add({"gaugeDock",
               tr("Pressure"),
               40,
               {{Detail::practice, Qt::RightDockWidgetArea, 30, 0, nullptr, 0, false},
                {Detail::laboratory, Qt::RightDockWidgetArea, 70, 0, nullptr, 0, false}}},
              gauge_);
    docks.add(
        {"parameterDock",
         tr("Parameters"),
         80,
         {{Detail::laboratory, Qt::RightDockWidgetArea, 40, 480}, {Detail::paper, Qt::RightDockWidgetArea, 40, 460}}},
        parameters_);
    // The docks' titles say it.
    gauge_->setHeadingShown(false);
    parameters_->setHeadingShown(false);
}

void DrillFeature::connectCommands() {
    on(commands_[Command::undo], [this] {
        if (simulator_.status().inStroke || undosWhenOut_ > 0)
            ++undosWhenOut_;
        else
            takeBack();
    });
    on(commands_[Command::redo], [this] { simulator_.redo(); });
    on(commands_[Command::reset], [this] {
        if (simulator_.status().cut) return simulator_.reset();
        // Only gingiva was cut, which is a sign in the picture and nothing of the tooth.
        view_.clearBlood();
        window_.notices().takeBack(End::toothWhole);
    });
    // Touch or cut with the left button: the two bindings change places.
    auto* hands = new QActionGroup(this);
    hands->addAction(commands_[Command::touch]);
    hands->addAction(commands_[Command::cut]);
    commands_[Command::cut]->setChecked(true);
    on(commands_[Command::touch], [this] { setTouching(true); });
    on(commands_[Command::cut], [this] { setTouching(false); });
    connect(commands_[Command::pedal], &QAction::triggered, &view_, &ViewWidget::latchPedal);
    connect(&view_, &ViewWidget::pedalLatched, commands_[Command::pedal], &QAction::setChecked);
    on(commands_[Command::bindings], [this] { editBindings(); });
    on(commands_[Command::firstSteps], [this] { showFirstSteps(); });

    const auto enable = [this](Command command, auto can) {
        window_.commands().enableWhile(commands_[command], [this, can] {
            return simulator_.mode() == Simulator::Mode::liveSession && can(simulator_.status());
        });
    };
    using Status = simulation::LiveSessionStatus;
    const auto isFree = [](const Status& status) { return !status.restoring && !status.inStroke; };
    enable(Command::undo, [this](const Status& status) {
        return !status.restoring && (status.inStroke ? isComingOut() : status.undoSteps > 0);
    });
    enable(Command::redo, [isFree](const Status& status) { return isFree(status) && status.redoSteps > 0; });
    enable(Command::reset,
           [this, isFree](const Status& status) { return isFree(status) && (status.cut || view_.isBleeding()); });
    enable(Command::pedal, [](const Status&) { return true; });
    window_.commands().enableWhile(commands_[Command::firstSteps], [this] {
        return simulator_.mode() == Simulator::Mode::liveSession &&
               simulator_.permissions().allows(Operation::guidance);
    });
}

void DrillFeature::connectPanels() {
    connect(bar_, &DrillBar::burChosen, &simulator_, &Simulator::setBur);
    connect(bar_, &DrillBar::burFileRequested, this, [this] {
        const QString file = window_.questions.open(tr("A bur of your own"), tr("Surfaces (*.stl *.ply *.obj)"));
        if (!file.isEmpty()) simulator_.setBur(file);
    });
    connect(bar_, &DrillBar::driveChosen, &simulator_, &Simulator::setDrive);
    connect(bar_, &DrillBar::speedSet, &simulator_, &Simulator::setSpeed);
    connect(&view_, &ViewWidget::burStepRequested, bar_, &DrillBar::chooseNext);
    connect(&view_, &ViewWidget::speedStepRequested, bar_, &DrillBar::stepSpeed);
    connect(parameters_, &ParameterBox::multipliersChanged, &simulator_, &Simulator::setMultipliers);
    connect(parameters_, &ParameterBox::hullMethodChosen, &simulator_, &Simulator::setHullMethod);
    connect(parameters_, &ParameterBox::forceModeChosen, &simulator_, &Simulator::setForceMode);
    connect(parameters_, &ParameterBox::voxelChosen, this, [this](int um) {
        if (simulator_.status().inStroke) {
            window_.showProblem(problemById(QStringLiteral("voxel-in-stroke")));
            showSettings();
        } else {
            simulator_.setVoxel(um);
        }
    });
}

void DrillFeature::connectWelcome() {
    std::set<WelcomeStrip::Step> done;
    for (const QString& step : settings_.value(QStringLiteral("window/welcome")).toStringList())
        done.insert(static_cast<WelcomeStrip::Step>(step.toInt()));
    welcome_->setDone(done);
    const auto keep = [this] {
        QStringList steps;
        for (const WelcomeStrip::Step step : welcome_->done())
            steps << QString::number(static_cast<int>(step));
        settings_.set(QStringLiteral("window/welcome"), steps);
    };
    connect(welcome_, &WelcomeStrip::doneChanged, this, keep);
    connect(welcome_, &WelcomeStrip::closed, this, [this, keep] {
        keep();
        settings_.set(QStringLiteral("window/welcomeClosed"), true);
    });
    // A step is done by the person's own hand: a view that is chosen, or comes with a tooth, moves the eye too.
    view_.installEventFilter(this);
    connect(&view_, &ViewWidget::cameraChanged, this, [this] {
        if (gesture_) tellStep(*gesture_);
    });
}

bool DrillFeature::eventFilter(QObject* watched, QEvent* event) {
    using Step = WelcomeStrip::Step;
    const auto note = [this](std::optional<Step> step) {
        gesture_ = step;
        QMetaObject::invokeMethod(
            this, [this] { gesture_.reset(); }, Qt::QueuedConnection);
    };
    if (event->type() == QEvent::Wheel) note(Step::zoom);
    if (event->type() == QEvent::MouseMove) {
        hasMoved_ = true;
        note(static_cast<QMouseEvent*>(event)->buttons() == Qt::NoButton ? std::nullopt : std::optional(Step::orbit));
    }
    return Feature::eventFilter(watched, event);
}

void DrillFeature::showFirstSteps() {
    settings_.set(QStringLiteral("window/welcomeClosed"), false);
    welcome_->beginAgain();
}

void DrillFeature::tellStep(WelcomeStrip::Step step) {
    if (!welcome_->isHidden() && !welcome_->done().contains(step)) welcome_->markDone(step);
}

void DrillFeature::recallBindings() {
    KeyBindings bindings;
    const QVariantMap chosen = settings_.value(QStringLiteral("window/bindings")).toMap();
    bindings.giveWayTo(chosen);
    bindings.fromMap(chosen);
    view_.setBindings(bindings);
}

void DrillFeature::editBindings() {
    setTouching(false);
    auto* dialog = new KeyBindingsDialog(view_.bindings(), &window_);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    connect(dialog, &QDialog::accepted, this, [this, dialog] {
        view_.setBindings(dialog->bindings());
        settings_.set(QStringLiteral("window/bindings"), dialog->bindings().toMap());
    });
    dialog->open();
}

void DrillFeature::setTouching(bool touching) {
    if (touching == touching_) return;
    KeyBindings bindings = view_.bindings();
    for (std::size_t k = 0; k < KeyBindings::kMost; ++k) {
        const Binding cut = bindings.of(Action::cut)[k], touch = bindings.of(Action::touch)[k];
        bindings.set(Action::cut, k, touch);
        bindings.set(Action::touch, k, cut);
    }
    touching_ = touching;
    view_.setBindings(bindings);
    commands_[touching ? Command::touch : Command::cut]->setChecked(true);
}

/// What is no longer so is no longer told: an undo or a reset heals a pulp.
void DrillFeature::takeBackNotices(const messages::HapticSample& sample) {
    constexpr double kNoneMm3 = session::EventWatch::kTellMm3;
    // A notice may be ahead of the sample that is shown: only what was seen open can be seen closed.
    const bool open = sample.removedMm3[static_cast<std::size_t>(cases::Tissue::pulp)] > kNoneMm3;
    if (wasOpen_ && !open) window_.notices().takeBack(End::pulpHealed);
    wasOpen_ = open;
    const bool cut = std::accumulate(sample.removedMm3.begin(), sample.removedMm3.end(), 0.0) > kNoneMm3;
    if (wasCut_ && !cut) window_.notices().takeBack(End::toothWhole);
    wasCut_ = cut;
}

void DrillFeature::showDocument() {
    undosWhenOut_ = 0;
    const bool isOpen = simulator_.tooth() && simulator_.toothCase();
    // Nobody cuts in a replay or a work that is looked at, nor before there is a tooth.
    welcome_->setAllowed(isOpen && simulator_.mode() == Simulator::Mode::liveSession &&
                         simulator_.permissions().allows(Operation::guidance));
    if (isOpen) {
        const exercise::Permissions now = simulator_.permissions();
        QStringList burs;
        for (const std::string& bur : now.burs())
            burs << QString::fromStdString(bur);
        bar_->setAllowedBurs(burs);
        parameters_->setPresent(presentTissues(*simulator_.toothCase()));
        parameters_->setTissues(simulator_.toothCase()->tissues);
    }
    showSettings();
}

void DrillFeature::showSettings() {
    if (simulator_.bur()) bar_->addOwnBur(simulator_.burName(), *simulator_.bur(), simulator_.burCuttingParameters());
    bar_->setBur(simulator_.burName());
    bar_->setDrive(simulator_.driveName());
    gauge_->setPressLimits(instrument::pressLimitsOf(simulator_.driveName().toStdString()));
    bar_->setSpeed(simulator_.setSpeedRpm());
    const force::Parameters& p = simulator_.parameters();
    parameters_->setMultipliers({p.stiffnessMultiplier, p.dampingMultiplier, p.frictionMultiplier});
    const device::Capability& c = simulator_.capability();
    parameters_->setLimits(
        {c.maxForceN, c.maxStiffnessNPerMm, c.maxDampingNSPerMm, c.maxForceSlopeNPerS, c.maxTorqueNmm},
        deviceInHand(simulator_));
    parameters_->setHullMethod(simulator_.isHullMethod());
    parameters_->setForceMode(p.law);
    parameters_->setVoxelUm(simulator_.voxelUm());
    gauge_->setLimit(c.maxForceN);
    // What a recording was made with is not what this person has in the hand.
    if (simulator_.mode() != Simulator::Mode::replay) keepSettings();
}

void DrillFeature::keepSettings() {
    const force::Parameters& p = simulator_.parameters();
    settings_.set(QStringLiteral("work/bur"), simulator_.burName());
    settings_.set(QStringLiteral("work/drive"), simulator_.chosenDriveName());
    settings_.set(QStringLiteral("work/speedRpm"), simulator_.chosenSpeedRpm());
    if (simulator_.mode() == Simulator::Mode::liveSession)
        settings_.set(QStringLiteral("work/voxelUm"), simulator_.startVoxelUm());
    settings_.set(QStringLiteral("work/stiffness"), p.stiffnessMultiplier);
    settings_.set(QStringLiteral("work/damping"), p.dampingMultiplier);
    settings_.set(QStringLiteral("work/friction"), p.frictionMultiplier);
    settings_.set(QStringLiteral("work/crispContact"), p.transients.on);
    settings_.set(QStringLiteral("work/cuttingVibration"), p.vibration.on);
}

void DrillFeature::takeBack() {
    simulator_.undo();
    tellStep(WelcomeStrip::Step::undo);
}

/// The button is let go, and the bur on its way out of what it cut: the stroke ends when it is.
bool DrillFeature::isComingOut() const {
    const input::PointerController* const hand = view_.hand();
    return hand != nullptr && !hand->isPressed() && !hand->pedalLatched();
}

void DrillFeature::showTick() {
    const messages::HapticSample& sample = simulator_.sample();
    const simulation::LiveSessionStatus& status = simulator_.status();
    if (!isComingOut()) undosWhenOut_ = 0;
    if (undosWhenOut_ > 0 && !status.inStroke && !status.restoring) {
        --undosWhenOut_;
        takeBack();
    }
    bar_->setActualSpeed(sample.speedRpm, (sample.flags & messages::kStalled) != 0);
    gauge_->setForce(core::toVec(sample.forceN).norm(), sample.timeS,
                     simulator_.givesForce() && (sample.flags & messages::kForceLimited) != 0);
    takeBackNotices(sample);
    parameters_->setCutting(status.inStroke ? ParameterBox::Cutting::stroke
                            : status.cut    ? ParameterBox::Cutting::begun
                                            : ParameterBox::Cutting::none);
    if (simulator_.mode() != Simulator::Mode::liveSession) return;
    // The bur comes to lie near the tooth by itself: with the mouse, only who moved it has moved over the tooth.
    const bool byMouse = simulator_.mailbox() != nullptr;
    welcome_->setPointerIsMouse(byMouse);
    if (sample.tick > 0 && sample.depthMm > -1.0 && (!byMouse || hasMoved_)) tellStep(WelcomeStrip::Step::hover);
    if ((sample.flags & messages::kCutting) != 0) tellStep(WelcomeStrip::Step::cut);
}

}  // namespace handpiece::desktop
