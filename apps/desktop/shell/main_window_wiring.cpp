// SPDX-License-Identifier: Apache-2.0
// What tells whom: simulator, picture, panels.
#include <QActionGroup>
#include <QComboBox>
#include <QElapsedTimer>
#include <QLabel>
#include <QStatusBar>

#include <chrono>
#include <numeric>

#include "desktop/view/section_bar.h"
#include "exercise/exercise_feature.h"
#include "exercise/exercise_words.h"
#include "handpiece/model/instrument/turbine.h"
#include "handpiece/record/session/event_watch.h"
#include "panels/drill_bar.h"
#include "panels/force_gauge.h"
#include "panels/measure_box.h"
#include "panels/notation.h"
#include "panels/notice_bar.h"
#include "panels/parameter_box.h"
#include "panels/plot_panel.h"
#include "panels/replay_bar.h"
#include "panels/status_line.h"
#include "panels/view_bar.h"
#include "panels/volume_bars.h"
#include "shell/error_dialog.h"
#include "shell/main_window.h"

namespace handpiece::desktop {
namespace {

constexpr int kReadoutMs = 100, kEyeMs = 700;

SectionPlace::Direction directionOf(MeasureBox::Orientation orientation) {
    switch (orientation) {
        case MeasureBox::Orientation::mesiodistal:
            return SectionPlace::Direction::mesioDistal;
        case MeasureBox::Orientation::horizontal:
            return SectionPlace::Direction::horizontal;
        default:
            return SectionPlace::Direction::buccoLingual;
    }
}

MeasureBox::Orientation orientationOf(SectionPlace::Direction direction) {
    switch (direction) {
        case SectionPlace::Direction::mesioDistal:
            return MeasureBox::Orientation::mesiodistal;
        case SectionPlace::Direction::horizontal:
            return MeasureBox::Orientation::horizontal;
        default:
            return MeasureBox::Orientation::buccolingual;
    }
}

/// Which tissues there are.
std::vector<cases::Tissue> presentOf(const cases::Case& toothCase) {
    std::vector<cases::Tissue> present;
    for (const cases::Part& part : toothCase.parts)
        if (std::find(present.begin(), present.end(), part.tissue) == present.end()) present.push_back(part.tissue);
    if (present.empty()) present.push_back(cases::Tissue::enamel);
    std::sort(present.begin(), present.end());
    return present;
}

}  // namespace

QString deviceText(const device::Capability& device) {
    if (device.name == "pointer") return MainWindow::tr("Mouse");
    return device.name == "simulated" ? MainWindow::tr("Simulated device") : QString::fromStdString(device.name);
}

void MainWindow::connectWork() {
    const Actions& a = *actions_;
    const auto on = [this, &a](const char* name, auto f) { connect(a[name], &QAction::triggered, this, f); };
    on("actionUndo", [this] {
        simulator_.undo();
        tellStep(WelcomeStrip::Step::undo);
    });
    on("actionRedo", [this] { simulator_.redo(); });
    on("actionReset", [this] { simulator_.reset(); });
    connect(&simulator_, &Simulator::documentChanged, this, &MainWindow::showDocument);
    connect(&simulator_, &Simulator::settingsChanged, this, &MainWindow::showSettings);
    connect(&simulator_, &Simulator::unsavedChanged, this, &MainWindow::showTitle);
    connect(&simulator_, &Simulator::ticked, this, &MainWindow::showTick);
    connect(&simulator_, &Simulator::plotted, plots_, &PlotPanel::append);
    connect(&simulator_, &Simulator::noticed, this, [this](const QString& id) {
        if (id == QLatin1String("pulp-exposed")) plots_->addEvent(simulator_.sample().timeS, tr("Pulp"));
    });

    connect(replay_, &ReplayBar::playRequested, &simulator_, &Simulator::play);
    connect(replay_, &ReplayBar::seekRequested, &simulator_, [this](double timeS) { simulator_.seek(timeS); });
    connect(replay_, &ReplayBar::speedChosen, &simulator_, &Simulator::setReplaySpeed);
    connect(replay_, &ReplayBar::closeRequested, &simulator_, [this] { simulator_.closeReplay(); });

    auto* layouts = new QActionGroup(this);
    const auto layout = [&](const char* name, Detail detail) {
        layouts->addAction(a[name]);
        on(name, [this, detail] { setDetail(detail); });
    };
    layout("actionLayoutPractice", Detail::practice);
    layout("actionLayoutLaboratory", Detail::laboratory);
    layout("actionLayoutPaper", Detail::paper);
    on("actionResetLayout", [this] {
        settings_.remove(layoutKey(detail_));
        arrange(detail_);
    });
    connect(a["actionFullScreen"], &QAction::toggled, this,
            [this](bool full) { full ? showFullScreen() : showNormal(); });

    auto* themes = new QActionGroup(this);
    const QString theme = settings_.value(QStringLiteral("window/theme"), QStringLiteral("system")).toString();
    const auto appearance = [&](const char* name, const char* key, Appearance value) {
        themes->addAction(a[name]);
        a[name]->setChecked(theme == QLatin1String(key));
        on(name, [this, key, value] {
            settings_.set(QStringLiteral("window/theme"), QLatin1String(key));
            emit appearanceChosen(value);
        });
    };
    appearance("actionThemeSystem", "system", Appearance::system);
    appearance("actionThemeLight", "light", Appearance::light);
    appearance("actionThemeDark", "dark", Appearance::dark);
}

void MainWindow::connectView() {
    const Actions& a = *actions_;
    const std::pair<const char*, view::StandardView> views[] = {
        {"actionViewOcclusal", view::StandardView::occlusal}, {"actionViewBuccal", view::StandardView::buccal},
        {"actionViewLingual", view::StandardView::lingual},   {"actionViewMesial", view::StandardView::mesial},
        {"actionViewDistal", view::StandardView::distal},     {"actionViewOblique", view::StandardView::oblique}};
    for (const auto& [name, standard] : views)
        connect(a[name], &QAction::triggered, this, [this, s = standard] { view_->showStandardView(s); });
    connect(a["actionFit"], &QAction::triggered, view_, &ViewWidget::fitTooth);
    connect(a["actionGoToBur"], &QAction::triggered, view_, &ViewWidget::goToBur);
    connect(looks_, &ViewBar::viewChosen, view_, &ViewWidget::showStandardView);
    connect(looks_, &ViewBar::fitRequested, view_, &ViewWidget::fitTooth);
    connect(looks_, &ViewBar::lookChanged, this, &MainWindow::takeLook);
    connect(view_, &ViewWidget::lookChanged, this, [this] { looks_->setLook(view_->look()); });

    connect(view_, &ViewWidget::cameraChanged, this, [this] {
        const view::Camera& eye = view_->camera();
        simulator_.setEar({eye.eyeMm, eye.forward(), eye.upward()});
        if (eyeDistanceMm_ > 0.0 && view_->hasFocus())
            tellStep(std::abs(eye.distanceMm() - eyeDistanceMm_) > 1e-6 ? WelcomeStrip::Step::zoom
                                                                        : WelcomeStrip::Step::orbit);
        eyeDistanceMm_ = eye.distanceMm();
        eyeTimer_.start(kEyeMs);
    });
    eyeTimer_.setSingleShot(true);
    connect(&eyeTimer_, &QTimer::timeout, this, &MainWindow::rememberEye);
    connect(view_, &ViewWidget::frameDrawn, this, [this] {
        if (!hasPicture_ && view_->hasTooth()) {
            hasPicture_ = true;
            emit firstPicture();
        }
    });
    connect(view_, &ViewWidget::openGlMissing, this,
            [this](const QString& what, const QString&) { tell(QStringLiteral("opengl-missing"), {what}); });
    connect(view_, &ViewWidget::burStepRequested, drill_, &DrillBar::chooseNext);
    connect(view_, &ViewWidget::speedStepRequested, drill_, &DrillBar::stepSpeed);
    connect(view_, &ViewWidget::refused, this, &MainWindow::tellLocked);
    connect(&simulator_, &Simulator::refused, this, &MainWindow::tellLocked);
    connect(view_, &ViewWidget::helpRequested, view_, &ViewWidget::toggleHelpCard);
    connect(a["actionHelp"], &QAction::triggered, view_, &ViewWidget::toggleHelpCard);
    HelpCard::Commands commands;
    for (const char* name : {"actionUndo", "actionRedo", "actionReset", "actionSave", "actionPicture", "actionReplay",
                             "actionLayoutPractice", "actionLayoutLaboratory", "actionFullScreen"})
        commands.emplace_back(a[name]->text().remove(QStringLiteral("...")),
                              a[name]->shortcut().toString(QKeySequence::NativeText));
    view_->setHelpCommands(commands);

    // The load and the depth stop: wheel in the picture, sliders in the box.
    connect(view_, &ViewWidget::loadChanged, measure_, &MeasureBox::setLoad);
    connect(measure_, &MeasureBox::loadChanged, view_, &ViewWidget::setLoad);
    connect(view_, &ViewWidget::stopChanged, this,
            [this](std::optional<double> depthMm) { measure_->setDepthStop(depthMm.value_or(0.0)); });
    connect(measure_, &MeasureBox::depthStopChanged, this,
            [this](double stopMm) { view_->setStop(stopMm > 0.0 ? std::optional<double>(stopMm) : std::nullopt); });
    connect(a["actionPedal"], &QAction::triggered, view_, &ViewWidget::latchPedal);
    connect(view_, &ViewWidget::pedalLatched, a["actionPedal"], &QAction::setChecked);

    // Tools. The picture decides; the actions follow.
    const std::pair<const char*, Tool> tools[] = {
        {"actionMeasure", Tool::calliper}, {"actionDepth", Tool::depth}, {"actionPulp", Tool::pulp}};
    for (const auto& [name, tool] : tools) {
        connect(a[name], &QAction::triggered, this,
                [this, t = tool](bool on) { view_->setTool(on ? t : Tool::drill); });
    }
    connect(view_, &ViewWidget::toolChanged, this, [this](Tool tool) {
        (*actions_)["actionMeasure"]->setChecked(tool == Tool::calliper);
        (*actions_)["actionDepth"]->setChecked(tool == Tool::depth);
        (*actions_)["actionPulp"]->setChecked(tool == Tool::pulp);
        measure_->setCalliperActive(tool == Tool::calliper);
    });
    connect(measure_, &MeasureBox::calliperToggled, this,
            [this](bool on) { view_->setTool(on ? Tool::calliper : Tool::drill); });
    connect(a["actionSection"], &QAction::triggered, this, [this](bool on) {
        if (!on && view_->tool() == Tool::section) view_->setTool(Tool::drill);
        view_->setSection(on ? std::optional(SectionPlace{}) : std::nullopt);
    });
    connect(view_, &ViewWidget::sectionChanged, this, &MainWindow::takeSection);
    connect(measure_, &MeasureBox::sectionChanged, this,
            [this](bool on, MeasureBox::Orientation orientation, double offsetMm) {
                SectionPlace next = view_->section().value_or(SectionPlace{});
                const bool turned = next.direction != directionOf(orientation);
                next.direction = directionOf(orientation);
                // Another direction begins in the middle of the tooth.
                next.offsetMm = turned ? toothBounds().centre()[axisAcross(next.direction)] : offsetMm;
                view_->setSection(on ? std::optional(next) : std::nullopt);
                takeSection();
            });
    connect(a["actionMirror"], &QAction::triggered, view_, &ViewWidget::setMirrorShown);
    connect(view_, &ViewWidget::mirrorChanged, a["actionMirror"], &QAction::setChecked);
    connect(a["actionCompare"], &QAction::triggered, view_, &ViewWidget::setCompare);
    connect(view_, &ViewWidget::compareChanged, a["actionCompare"], &QAction::setChecked);
    connect(a["actionClearMeasurements"], &QAction::triggered, view_, &ViewWidget::clearMeasurements);
    connect(view_, &ViewWidget::measured, this, [this](const Measurement& m) {
        if (m.kind == Measurement::Kind::distance) measure_->setCalliper(m.valueMm);
        statusBar()->showMessage(m.text(), 8000);
    });

    // Touch or cut with the left button: the two bindings change places.
    auto* hands = new QActionGroup(this);
    hands->addAction(a["actionTouch"]);
    hands->addAction(a["actionCut"]);
    a["actionCut"]->setChecked(true);
    connect(a["actionTouch"], &QAction::triggered, this, [this] { setTouching(true); });
    connect(a["actionCut"], &QAction::triggered, this, [this] { setTouching(false); });
    view_->setTurbine(instrument::turbineMesh());
    readouts_.setInterval(kReadoutMs);
    connect(&readouts_, &QTimer::timeout, this, &MainWindow::showReadouts);
}

core::Box MainWindow::toothBounds() const {
    return simulator_.tooth() ? simulator_.tooth()->base().tooth->outer.bounds()
                              : core::Box{core::Vec3::Constant(-10.0), core::Vec3::Constant(10.0)};
}

void MainWindow::takeSection() {
    const std::optional<SectionPlace> place = view_->section();
    (*actions_)["actionSection"]->setChecked(place.has_value());
    const SectionPlace shown = place.value_or(SectionPlace{});
    const core::Box bounds = toothBounds();
    const int axis = axisAcross(shown.direction);
    measure_->setSectionRange(bounds.min[axis], bounds.max[axis]);
    measure_->setSection(place.has_value(), orientationOf(shown.direction), shown.offsetMm);
}

void MainWindow::setTouching(bool touching) {
    if (touching == touching_) return;
    KeyBindings bindings = view_->bindings();
    for (std::size_t k = 0; k < KeyBindings::kMost; ++k) {
        const Binding cut = bindings.of(Action::cut)[k], touch = bindings.of(Action::touch)[k];
        bindings.set(Action::cut, k, touch);
        bindings.set(Action::touch, k, cut);
    }
    touching_ = touching;
    view_->setBindings(bindings);
    (*actions_)[touching ? "actionTouch" : "actionCut"]->setChecked(true);
}

void MainWindow::connectPanels() {
    measure_->setPulpLimits(simulator_.pulpLimits());
    view_->setPulpLimits(simulator_.pulpLimits());
    connect(drill_, &DrillBar::burChosen, &simulator_, &Simulator::setBur);
    connect(drill_, &DrillBar::burFileRequested, this, [this] {
        const QString file =
            questions.fileToOpen(tr("A bur of your own"), startFolder(), tr("Surfaces (*.stl *.ply *.obj)"));
        if (!file.isEmpty()) simulator_.setBur(file);
    });
    connect(drill_, &DrillBar::driveChosen, &simulator_, &Simulator::setDrive);
    connect(drill_, &DrillBar::speedSet, &simulator_, &Simulator::setSpeed);
    connect(parameters_, &ParameterBox::multipliersChanged, &simulator_, &Simulator::setMultipliers);
    connect(parameters_, &ParameterBox::hullMethodChosen, &simulator_, &Simulator::setHullMethod);
    connect(parameters_, &ParameterBox::forceModeChosen, &simulator_, &Simulator::setForceMode);
    connect(parameters_, &ParameterBox::voxelChosen, this, [this](int um) {
        if (simulator_.status().inStroke) {
            showProblem(problemById(QStringLiteral("voxel-in-stroke")));
            showSettings();
        } else {
            simulator_.setVoxel(um);
        }
    });
    connect(plots_, &PlotPanel::saveRequested, this, &MainWindow::savePlot);
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
    if (settings_.value(QStringLiteral("window/welcomeClosed")).toBool()) welcome_->hide();
}

void MainWindow::tellStep(WelcomeStrip::Step step) {
    if (!welcome_->isHidden() && !welcome_->done().contains(step)) welcome_->markDone(step);
}

/// What is no longer so is no longer told: an undo or a reset heals a pulp.
void MainWindow::takeBackNotices(const messages::HapticSample& sample) {
    constexpr double kNoneMm3 = session::EventWatch::kTellMm3;
    // A notice may be ahead of the sample that is shown: only what was seen open can be seen closed.
    const bool open = sample.removedMm3[static_cast<std::size_t>(cases::Tissue::pulp)] > kNoneMm3;
    if (wasOpen_ && !open) notices_->remove(QStringLiteral("pulp-exposed"));
    wasOpen_ = open;
    const bool cut = std::accumulate(sample.removedMm3.begin(), sample.removedMm3.end(), 0.0) > kNoneMm3;
    if (wasCut_ && !cut)
        for (const char* id : {"neighbour-touched", "out-of-bricks", "hull-needs-whole-tooth"})
            notices_->remove(QLatin1String(id));
    wasCut_ = cut;
}

void MainWindow::showDocument() {
    hasPicture_ = false;
    // What was told of the tooth before.
    for (const char* id : {"pulp-exposed", "neighbour-touched", "out-of-bricks", "samples-lost", "recording-incomplete",
                           "hull-needs-whole-tooth"})
        notices_->remove(QLatin1String(id));
    const bool replay = simulator_.mode() == Simulator::Mode::replay;
    replay_->setVisible(replay);
    plots_->clear();
    readouts_.stop();
    if (!simulator_.tooth() || !simulator_.toothCase()) {
        view_->clearTooth();
    } else {
        const cases::Case& toothCase = *simulator_.toothCase();
        view_->setTooth(simulator_.tooth(), toothCase, simulator_.pictureFeed());
        view_->setPointer(simulator_.mailbox(), simulator_.startPose());
        if (simulator_.bur()) view_->setBur(simulator_.bur());
        takePermissions();
        const std::vector<cases::Tissue> present = presentOf(toothCase);
        looks_->setPresent(present);
        parameters_->setPresent(present);
        parameters_->setTissues(toothCase.tissues);
        volumes_->setLegend(view::legendOf(present, view_->shownLook().palette));
        takeSection();
        measure_->setCalliper({});
        recallEye();
        if (simulator_.mode() == Simulator::Mode::review) view_->setSample(simulator_.sample());
        readouts_.start();
        view_->setFocus();
    }
    if (replay && simulator_.replay()) {
        const ReplayDriver& driver = *simulator_.replay();
        replay_->setDuration(driver.durationS());
        std::vector<ReplayMark> marks;
        for (const session::Event& event : driver.events()) {
            using Kind = ReplayMark::Kind;
            Kind kind = Kind::other;
            if (event.name == session::nameOf(session::EventName::keyFrame)) continue;
            if (event.name == session::nameOf(session::EventName::strokeBegin)) kind = Kind::strokeBegin;
            if (event.name == session::nameOf(session::EventName::strokeEnd)) kind = Kind::strokeEnd;
            if (event.name == session::nameOf(session::EventName::undo) ||
                event.name == session::nameOf(session::EventName::redo) ||
                event.name == session::nameOf(session::EventName::reset))
                kind = Kind::undo;
            if (event.name == session::nameOf(session::EventName::burChange) ||
                event.name == session::nameOf(session::EventName::parameterChange) ||
                event.name == session::nameOf(session::EventName::resume))
                kind = Kind::change;
            if (event.name == session::nameOf(session::EventName::pulpExposure) ||
                event.name == session::nameOf(session::EventName::neighbourTouched) ||
                event.name == session::nameOf(session::EventName::fault))
                kind = Kind::warning;
            marks.push_back({static_cast<double>(event.tick) / driver.rateHz(), kind, eventText(event.name)});
        }
        replay_->setMarks(marks);
        replay_->setTime(0.0);
        replay_->setPlaying(false);
    }
    showSettings();
    showTick();
    showTitle();
    showEnabled();
}

void MainWindow::tellLocked(exercise::Operation operation) {
    tell(QStringLiteral("help-locked"), {operationWords(operation)});
}

void MainWindow::takePermissions() {
    const exercise::Permissions now = simulator_.permissions();
    view_->setPermissions(now);
    looks_->setPermissions(now);
    measure_->setPermissions(now);
    welcome_->setAllowed(now.allows(exercise::Operation::guidance));
    volumes_->setLocked(now.locks(exercise::Operation::volumes));
    QStringList burs;
    for (const std::string& bur : now.burs())
        burs << QString::fromStdString(bur);
    drill_->setAllowedBurs(burs);
}

QString MainWindow::eventText(const std::string& name) {
    using session::EventName;
    const std::pair<EventName, QString> known[] = {{EventName::strokeBegin, tr("Stroke begins")},
                                                   {EventName::strokeEnd, tr("Stroke ends")},
                                                   {EventName::burChange, tr("Another bur")},
                                                   {EventName::firstDentine, tr("Dentine reached")},
                                                   {EventName::pulpExposure, tr("Pulp opened")},
                                                   {EventName::neighbourTouched, tr("Neighbour touched")},
                                                   {EventName::stall, tr("Bur stalled")},
                                                   {EventName::forceLimit, tr("Pressed too hard")},
                                                   {EventName::undo, tr("Undo")},
                                                   {EventName::redo, tr("Redo")},
                                                   {EventName::reset, tr("Reset")},
                                                   {EventName::parameterChange, tr("Settings changed")},
                                                   {EventName::fault, tr("Fault")},
                                                   {EventName::resume, tr("Gone on with")},
                                                   {EventName::end, tr("End")}};
    for (const auto& [event, text] : known)
        if (name == session::nameOf(event)) return text;
    return QString::fromStdString(name);
}

void MainWindow::showSettings() {
    if (simulator_.bur() && view_->hasTooth()) view_->setBur(simulator_.bur());
    if (simulator_.bur()) drill_->addOwnBur(simulator_.burName(), *simulator_.bur(), simulator_.burCuttingParameters());
    drill_->setBur(simulator_.burName());
    drill_->setDrive(simulator_.driveName());
    drill_->setSpeed(simulator_.setSpeedRpm());
    const force::Parameters& p = simulator_.parameters();
    parameters_->setMultipliers({p.stiffnessMultiplier, p.dampingMultiplier, p.frictionMultiplier});
    const device::Capability& c = simulator_.capability();
    parameters_->setLimits(
        {c.maxForceN, c.maxStiffnessNPerMm, c.maxDampingNSPerMm, c.maxForceSlopeNPerS, c.maxTorqueNmm}, deviceInHand());
    parameters_->setHullMethod(simulator_.isHullMethod());
    parameters_->setForceMode(p.law);
    parameters_->setVoxelUm(simulator_.voxelUm());
    gauge_->setLimit(c.maxForceN);
    plots_->setForceLimit(c.maxForceN);
    plots_->setFreeSpeed(instrument::driveByName(simulator_.driveName().toStdString()).freeSpeedRpm);
    // What a recording was made with is not what this person has in the hand.
    if (simulator_.mode() == Simulator::Mode::replay) return;
    settings_.set(QStringLiteral("work/bur"), simulator_.burName());
    settings_.set(QStringLiteral("work/drive"), simulator_.driveName());
    settings_.set(QStringLiteral("work/speedRpm"), simulator_.setSpeedRpm());
    if (simulator_.mode() == Simulator::Mode::liveSession)
        settings_.set(QStringLiteral("work/voxelUm"), simulator_.startVoxelUm());
    settings_.set(QStringLiteral("work/stiffness"), p.stiffnessMultiplier);
    settings_.set(QStringLiteral("work/damping"), p.dampingMultiplier);
    settings_.set(QStringLiteral("work/friction"), p.frictionMultiplier);
    settings_.set(QStringLiteral("work/crispContact"), p.transients.on);
    settings_.set(QStringLiteral("work/cuttingVibration"), p.vibration.on);
}

void MainWindow::showTick() {
    const messages::HapticSample& sample = simulator_.sample();
    const simulation::LiveSessionStatus& status = simulator_.status();
    drill_->setActualSpeed(sample.speedRpm, (sample.flags & messages::kStalled) != 0);
    gauge_->setForce(core::toVec(sample.forceN).norm(), sample.timeS,
                     simulator_.givesForce() && (sample.flags & messages::kForceLimited) != 0);
    tooth::TissueVolumes removed{};
    std::copy(sample.removedMm3.begin(), sample.removedMm3.end(), removed.begin());
    volumes_->setVolumes(removed);
    if (simulator_.mode() == Simulator::Mode::replay && simulator_.replay()) {
        view_->setSample(sample);
        const ReplayNow now = simulator_.replay()->now();
        replay_->setTime(now.timeS);
        replay_->setPlaying(now.playing);
    }
    takeBackNotices(sample);
    parameters_->setCutting(status.inStroke ? ParameterBox::Cutting::stroke
                            : status.cut    ? ParameterBox::Cutting::begun
                                            : ParameterBox::Cutting::none);
    if (simulator_.mode() == Simulator::Mode::liveSession) {
        if (sample.tick > 0 && sample.depthMm > -1.0) tellStep(WelcomeStrip::Step::hover);
        if ((sample.flags & messages::kCutting) != 0) tellStep(WelcomeStrip::Step::cut);
    }

    // The rate over a second of the clock, not of the loop.
    const qint64 nowNs =
        std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
            .count();
    if (nowNs - rateSinceNs_ > 1000000000) {
        if (rateSinceNs_ > 0 && status.ticks >= rateTicks_)
            rateHz_ = 1e9 * static_cast<double>(status.ticks - rateTicks_) / static_cast<double>(nowNs - rateSinceNs_);
        // A word is due when one in a hundred is late.
        late_ = status.lateTicks + status.missedPeriods > rateLate_ + static_cast<std::uint64_t>(0.01 * rateHz_) + 1;
        rateTicks_ = status.ticks;
        rateLate_ = status.lateTicks + status.missedPeriods;
        rateSinceNs_ = nowNs;
    }
    StatusFigures figures;
    showDevice(figures);
    figures.rateHz = rateHz_;
    figures.lateTicks = status.lateTicks;
    figures.missedPeriods = status.missedPeriods;
    figures.load = status.load;
    figures.late = late_;
    figures.busy = status.restoring || simulator_.isBusy();
    if (simulator_.mode() == Simulator::Mode::liveSession) {
        figures.recording = status.recording.recording && !simulator_.recording().empty()
                                ? StatusFigures::Recording::on
                                : StatusFigures::Recording::stopped;
        figures.recordingNote = QString::fromStdString(status.recording.message);
    }
    status_->setFigures(figures);
    showEnabled();
}

/// Depth under the bur's tip while it touches; a tenth of a second is quick enough to read.
void MainWindow::showReadouts() {
    if (!isVisible() || !simulator_.tooth()) return;
    const messages::HapticSample sample = view_->sample();
    if (sample.tick == 0 || sample.depthMm < -0.05 || !view_->permissions().allows(exercise::Operation::depthReadout)) {
        measure_->setDepth({});
        measure_->setLeftOverPulp({});
        return;
    }
    const core::Vec3 tip = core::toVec(sample.proxyPositionMm);
    struct Read {
        double depthMm;
        std::optional<double> leftMm;
    };
    const Read read = simulator_.tooth()->withProbe([&](const measure::ToothProbe& probe) {
        return Read{probe.depthBelowUncutMm(tip), probe.leftOverPulpMm(tip)};
    });
    measure_->setDepth(std::max(0.0, read.depthMm));
    measure_->setLeftOverPulp(read.leftMm, read.leftMm && *read.leftMm <= 0.0);
}

void MainWindow::showTitle() {
    const Document& document = simulator_.document();
    QString name = QString::fromStdString(document.name);
    // A starter tooth has a name in every language until it is saved under one of the student's own.
    if (document.starter && document.attemptFile.empty() && simulator_.toothCase())
        name = toothName(simulator_.toothCase()->fdiNumber);
    setWindowTitle(name.isEmpty() ? QStringLiteral("Handpiece") : QStringLiteral("%1[*] - Handpiece").arg(name));
    setWindowModified(simulator_.isUnsaved());
}

void MainWindow::showEnabled() {
    const Actions& a = *actions_;
    const simulation::LiveSessionStatus& status = simulator_.status();
    const bool free = !simulator_.isBusy(), liveSession = simulator_.mode() == Simulator::Mode::liveSession,
               open = simulator_.mode() != Simulator::Mode::empty;
    const bool may = liveSession && !status.restoring && !status.inStroke;
    for (const char* name :
         {"actionOpenCase", "actionOpenStl", "actionOpenSession", "actionChooseTooth", "actionResume", "actionRecover"})
        a[name]->setEnabled(free);
    resolution_->setEnabled(free);
    a["actionUndo"]->setEnabled(may && status.undoSteps > 0);
    a["actionRedo"]->setEnabled(may && status.redoSteps > 0);
    a["actionReset"]->setEnabled(may && status.cut);
    for (const char* name : {"actionSave", "actionSaveAs"})
        a[name]->setEnabled(free && liveSession);
    for (const char* name : {"actionKeepRecording", "actionReplay"})
        a[name]->setEnabled(free && liveSession && !simulator_.recording().empty());
    if (simulator_.mode() == Simulator::Mode::review) a["actionReplay"]->setEnabled(free);
    a["actionReport"]->setEnabled(free && open && simulator_.mode() != Simulator::Mode::review);
    for (const char* name :
         {"actionExportStl", "actionExportTissues", "actionPicture", "actionMeasure", "actionMirror", "actionCompare",
          "actionFit", "actionGoToBur", "actionDepth", "actionPulp", "actionSection"})
        a[name]->setEnabled(open);
    a["actionPedal"]->setEnabled(liveSession);
    exercise_->showAllowed();
}

void MainWindow::takeLook(const view::Look& look) {
    view_->setLook(look);
    if (simulator_.toothCase())
        volumes_->setLegend(view::legendOf(presentOf(*simulator_.toothCase()), view_->shownLook().palette));
    const auto set = [this](const char* key, const QVariant& value) {
        settings_.set(QStringLiteral("look/") + QLatin1String(key), value);
    };
    set("quality", static_cast<int>(look.quality));
    set("palette", static_cast<int>(look.palette));
    set("stereo", static_cast<int>(look.stereo));
    set("wet", look.wet);
    set("debris", look.debris);
    set("spray", look.spray);
    set("shadows", look.shadows);
    set("turbine", look.turbine);
    set("scaleBar", look.scaleBar);
}

}  // namespace handpiece::desktop
