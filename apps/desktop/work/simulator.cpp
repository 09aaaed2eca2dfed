// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/simulator.h"

#include <algorithm>
#include <atomic>
#include <tuple>

#include "handpiece/base/core/engine_revision.h"

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;
constexpr int kPollMs = 33, kReplayPollMs = 16;

DeviceManager::Options withFoot(DeviceManager::Options options, const Foot& foot) {
    options.foot = foot.value();
    return options;
}

}  // namespace

/// What turns samples into what the ear is told; read by whichever thread has the samples, written by the window's.
struct Simulator::Ear {
    std::atomic<double> radiusMm{0.5}, freeSpeedRpm{400000.0};
    std::atomic<int> edges{6};
    messages::HapticSample before;
    bool begun = false;

    void hear(sound::Player& player, const messages::HapticSample& now, double stepS) {
        if (begun)
            player.setDrill(sound::drillStateOf(before, now, stepS, radiusMm.load(std::memory_order_relaxed),
                                                edges.load(std::memory_order_relaxed),
                                                freeSpeedRpm.load(std::memory_order_relaxed)));
        before = now;
        begun = true;
    }
};

Simulator::Simulator(const Options& options, QObject* parent)
    : QObject(parent),
      options_(options),
      outside_(std::make_shared<const OutsideFiles>(options.folders)),
      foot_(options.pedals),
      hands_(withFoot(options.hands, foot_)),
      shelf_(options.folders.sessions, options.shelf),
      voxelUm_(options.voxelUm) {
    const instrument::Instrument made = instrument::makeInstrument(burName_.toStdString());
    settings_.bur = made.bur;
    settings_.cuttingParameters = made.cuttingParameters;
    settings_.drive = driveAt(driveName_.toStdString(), 0.0);
    speedRpm_ = chosenRpm_ = settings_.drive.freeSpeedRpm;
    settings_.field = simulation::fieldSettingsAt(1e-3 * voxelUm_);
    settings_.capability = device::pointerCapability();
    connect(&hands_, &DeviceManager::changed, this, &Simulator::passHandpiece);
    if (options.sound) player_ = std::make_unique<sound::Player>();
    connect(&timer_, &QTimer::timeout, this, &Simulator::poll);
    timer_.setTimerType(Qt::PreciseTimer);
    shelf_.tidy();
}

Simulator::~Simulator() {
    soundJob_.reset();
    job_.reset();
    touch_.reset();
    stopAll();
}

SessionNote Simulator::noteNow() const {
    SessionNote note{toQString(document_.caseFile), QString::fromStdString(document_.name),
                     toQString(document_.attemptFile), unsaved_};
    if (toothCase_ && toothCase_->exercise)
        note.exercise = QString::fromStdString(cases::exerciseText(*toothCase_->exercise));
    for (const RecordingPlace& recording : document_.recordings)
        note.recordings << QString::fromStdString(recording.name);
    note.starter = document_.starter;
    note.workedOn = document_.workedOn;
    note.task = toQString(document_.taskPath);
    note.beforeS = document_.beforeS;
    note.began = document_.began;
    note.exam = QString::fromStdString(document_.exam);
    return note;
}

/// Puts a tooth in place: a loop, its listener, a recording, a hand.
void Simulator::sit(LoadedTooth loaded) {
    stopAll();
    document_ = std::move(loaded.document);
    toothCase_ = loaded.toothCase;
    tooth_ = loaded.liveTooth;
    settings_ = loaded.station.settings;
    burName_ = QString::fromStdString(loaded.bur);
    driveName_ = QString::fromStdString(loaded.drive);
    speedRpm_ = loaded.speedRpm;
    voxelUm_ = static_cast<int>(std::lround(1e3 * settings_.field.voxelMm));
    hull_ = false;
    sample_ = {};
    sample_.removedMm3 = loaded.state.removedMm3.own;
    sample_.removedOthersMm3 = loaded.state.removedMm3.sumOfOthers();
    status_ = {};
    savedMm3_ = loaded.state.removedMm3.own;
    savedOthersMm3_ = sample_.removedOthersMm3;
    unsaved_ = false;
    isTimeTold_ = false;
    const auto& task = document_.task;
    // An exam has a time of its own.
    isTimeOver_->store(!exam_ && task && task->minutes && task->isTimeHard && loaded.elapsedS >= 60.0 * *task->minutes,
                       std::memory_order_relaxed);
    isPaused_->store(false, std::memory_order_relaxed);

    simulation::LiveSessionSettings liveSession;
    liveSession.code = loaded.code.empty() ? code_.toStdString() : loaded.code;
    sessionCode_ = liveSession.code;
    liveSession.elapsedS = elapsedS_ = loaded.elapsedS;
    liveSession.history = std::move(loaded.history);
    liveSession.realTime = options_.realTime;
    const cases::Exercise* exercise = toothCase_->exercise ? &*toothCase_->exercise : nullptr;
    liveSession.lowerButtonUndoes =
        exercise::permissionsOf(exercise, exercise::WorkMode::work).allows(exercise::Operation::undo);
    if (options_.record || exam_) {
        try {
            if (loaded.recording.empty()) {
                document_.beforeS = loaded.elapsedS;
                liveSession.sessionFile = shelf_.begin(noteNow());
            } else {
                shelf_.goOn(loaded.recording);
                liveSession.sessionFile = loaded.recording;
                liveSession.session = loaded.session;
            }
        } catch (const core::Error& error) {
            emit noticed(QStringLiteral("recording-stopped"), {problemOf(error).what});
        }
    }
    const auto make = [&] {
        std::unique_ptr<device::Device> device = takeHandpiece();
        settings_.capability = device->capability();
        settings_.parameters.gripMm = force::Parameters{}.gripMm;
        if (usedHand_) settings_.parameters = usedHand_->fitted(settings_.parameters);
        loaded.station.settings.capability = settings_.capability;
        loaded.station.settings.parameters = settings_.parameters;
        return std::make_unique<simulation::LiveSession>(loaded.station, *toothCase_, std::move(device), liveSession,
                                                         tooth_);
    };
    try {
        liveSession_ = make();
    } catch (const core::Error& error) {
        if (liveSession.sessionFile.empty()) throw;
        // Better to work without a record than not at all. What one that was to go on holds stays marked.
        liveSession.sessionFile.clear();
        if (liveSession.session == simulation::LiveSessionSettings::Session::anew) {
            shelf_.end();
        } else {
            shelf_.leave();
        }
        emit noticed(QStringLiteral("recording-stopped"), {problemOf(error).what});
        liveSession_ = make();
    }
    // A recording that goes on is the one under way, not one of those before it.
    std::erase_if(document_.recordings, [current = shelf_.current().filename().string()](const RecordingPlace& place) {
        return !place.packed && place.name == current;
    });
    pictureFeed_ = liveSession_->subscribe();
    pollFeed_ = liveSession_->subscribe();
    if (player_) {
        ear_ = std::make_shared<Ear>();
        tellDrill();
        liveSession_->setListener([player = player_.get(), ear = ear_, periodS = 1.0 / settings_.rateHz](
                                      const messages::HapticSample& sample) { ear->hear(*player, sample, periodS); });
    }
    mode_ = Mode::liveSession;
    timer_.start(kPollMs);
    emit documentChanged();
    emit settingsChanged();
    emit unsavedChanged(false);
    if (!loaded.missingBur.empty())
        emit noticed(QStringLiteral("bur-missing"), {QString::fromStdString(loaded.missingBur), burName_});
    if (!loaded.lockedBur.empty())
        emit noticed(QStringLiteral("bur-locked"), {QString::fromStdString(loaded.lockedBur)});
}

ReplayDriver::Heard Simulator::replayEar() {
    if (!player_) return {};
    ear_ = std::make_shared<Ear>();
    return [player = player_.get(), ear = ear_](const messages::HapticSample& sample, double stepS,
                                                const simulation::SimulationSetup& station) {
        ear->radiusMm = station.settings.bur->maxRadiusMm();
        ear->edges = station.settings.cuttingParameters.edges;
        ear->freeSpeedRpm = station.settings.drive.freeSpeedRpm;
        ear->hear(*player, sample, stepS);
    };
}

void Simulator::watch(std::unique_ptr<ReplayDriver> driver) {
    replay_ = std::move(driver);
    toothCase_ = std::make_shared<const cases::Case>(replay_->toothCase());
    tooth_ = replay_->tooth();
    takeReplayed(replay_->firstSettings());
    mode_ = Mode::replay;
    sample_ = replay_->now().sample;
    status_ = {};
    timer_.start(kReplayPollMs);
    emit documentChanged();
    emit plotted(replay_->plot());
    if (replay_->engineRevision() != core::kEngineRevision)
        emit noticed(QStringLiteral("other-engine"),
                     {QString::number(replay_->engineRevision()), QString::number(core::kEngineRevision)});
}

/// What the recorded hand had, beside the device that is here.
void Simulator::takeReplayed(const simulation::SimulationSettings& settings) {
    const device::Capability capability = settings_.capability;
    settings_ = settings;
    settings_.capability = capability;
    burName_ = QString::fromStdString(settings_.bur->name());
    hull_ = settings_.hull;
    const auto& known = instrument::drives();
    if (std::none_of(known.begin(), known.end(), [&](const auto& d) { return d.name == settings_.drive.name; })) return;
    driveName_ = QString::fromStdString(settings_.drive.name);
    speedRpm_ = settings_.drive.freeSpeedRpm;
}

void Simulator::stopLiveSession(bool keepMarker) {
    timer_.stop();
    if (liveSession_) {
        liveSession_->stop();
        status_ = liveSession_->status();
    }
    liveSession_.reset();
    if (player_) player_->setDrill({});
    pictureFeed_.reset();
    pollFeed_.reset();
    mailbox_.reset();
    usedHand_.reset();
    if (keepMarker || !document_.exam.empty()) {
        shelf_.leave();
    } else {
        shelf_.end();
    }
    mode_ = Mode::empty;
}

void Simulator::stopAll(bool keepsReview) {
    timer_.stop();
    replay_.reset();
    // A tooth that waits behind a replay: what nobody saved of it is offered again at the next start.
    if (leftFor_ && !leftFor_->file.note.unsaved && leftFor_->file.note.exam.isEmpty())
        shelf_.settle(leftFor_->file.session);
    leftFor_.reset();
    if (!keepsReview) reviewed_.reset();
    stopLiveSession(false);
}

void Simulator::close() {
    waiting_ = {};
    job_.reset();
    touch_.reset();
    stopAll();
    document_ = {};
    toothCase_.reset();
    tooth_.reset();
    unsaved_ = false;
    shelf_.tidy();
    emit documentChanged();
    emit unsavedChanged(false);
}

void Simulator::poll() {
    if (replay_) {
        ReplayNow now = replay_->now();
        sample_ = now.sample;
        const auto shown = [](const simulation::SimulationSettings& s) {
            const force::Parameters& p = s.parameters;
            return std::tuple(s.bur, s.hull, s.drive.name, s.drive.freeSpeedRpm, p.law, p.stiffnessMultiplier,
                              p.dampingMultiplier, p.frictionMultiplier, p.transients.on, p.vibration.on);
        };
        if (shown(now.settings) != shown(settings_)) {
            takeReplayed(now.settings);
            emit settingsChanged();
        }
        if (const std::optional<Problem> problem = replay_->takeProblem()) {
            replay_->play(false);
            emit failed(*problem);
        }
        emit ticked();
        return;
    }
    if (!liveSession_) return;
    const bool fine = status_.fault.empty();
    sample_ = pollFeed_->read();
    status_ = liveSession_->status();
    if (sample_.tick > 0 && (sample_.flags & messages::kRestoring) == 0) markUnsaved(isCutSinceSaved());
    if (fine && !status_.fault.empty())
        emit failed(problemById(QStringLiteral("sitting-ended"), {QString::fromStdString(status_.fault)}));
    watchTime();
    emit plotted(liveSession_->takePlot());
    for (const simulation::Notice& notice : liveSession_->takeNotices()) {
        // Hands says which, and what to do.
        if (notice.id == "device-fault" && usedHand_) continue;
        // Nobody holds a mouse's force: that it ends somewhere is no news.
        if (notice.id == "force-limited" && !givesForce()) continue;
        QStringList arguments;
        for (const std::string& a : notice.arguments)
            arguments << QString::fromStdString(a);
        if (notice.cause) arguments = {problemOf(*notice.cause).what};
        if (notice.id == "hull-needs-whole-tooth") {
            hull_ = false;
            emit settingsChanged();
        }
        emit noticed(QString::fromStdString(notice.id), arguments);
    }
    emit ticked();
}

void Simulator::markUnsaved(bool unsaved, bool inAnyCase) {
    if (unsaved == unsaved_ && !inAnyCase) return;
    unsaved_ = unsaved;
    try {
        shelf_.note(noteNow());
    } catch (const core::Error& error) {
        emit noticed(QStringLiteral("recording-stopped"), {problemOf(error).what});
    }
    emit unsavedChanged(unsaved);
}

bool Simulator::mayWork() {
    return mode_ == Mode::liveSession && liveSession_ && status_.fault.empty();
}

bool Simulator::mayTakeBack() {
    if (!mayWork()) return false;
    if (isTimeOver()) tellTimeOver();
    return !isTimeOver();
}

void Simulator::undo() {
    if (mayTakeBack() && may(exercise::Operation::undo)) liveSession_->undo();
}

void Simulator::redo() {
    if (mayTakeBack() && may(exercise::Operation::redo)) liveSession_->redo();
}

void Simulator::reset() {
    if (!mayTakeBack() || !may(exercise::Operation::reset)) return;
    liveSession_->reset();
    emit wasReset();
}

void Simulator::tellDrill() {
    if (!ear_) return;
    ear_->radiusMm = settings_.bur->maxRadiusMm();
    ear_->edges = settings_.cuttingParameters.edges;
    ear_->freeSpeedRpm = instrument::driveByName(driveName_.toStdString()).freeSpeedRpm;
}

void Simulator::setBur(const QString& nameOrFile) {
    if (mode_ == Mode::replay || mode_ == Mode::review) return;
    if (!permissions().allowsBur(nameOrFile.toStdString())) {
        emit noticed(QStringLiteral("bur-locked"), {nameOrFile});
        emit settingsChanged();
        return;
    }
    try {
        instrument::Instrument made = instrument::makeInstrument(nameOrFile.toStdString());
        settings_.bur = std::move(made.bur);
        settings_.cuttingParameters = std::move(made.cuttingParameters);
        burName_ = nameOrFile;
        if (mayWork()) liveSession_->setBur(settings_.bur, settings_.cuttingParameters);
        if (touch_) touch_->session->setBur(settings_.bur, settings_.cuttingParameters);
        tellDrill();
    } catch (const core::Error& error) {
        emit failed(problemOf(error));
    }
    emit settingsChanged();
}

void Simulator::setDrive(const QString& name) {
    if (mode_ == Mode::replay || mode_ == Mode::review || name == driveName_) return;
    try {
        settings_.drive = driveAt(name.toStdString(), 0.0);
    } catch (const core::Error& error) {
        emit failed(problemOf(error));
        return;
    }
    driveName_ = name;
    speedRpm_ = settings_.drive.freeSpeedRpm;
    noteDriveChosen();
    if (mayWork()) liveSession_->setDrive(settings_.drive);
    tellDrill();
    emit settingsChanged();
}

void Simulator::noteDriveChosen() {
    if (document_.task && !document_.task->drive.empty()) return;
    chosenDrive_ = driveName_;
    chosenRpm_ = speedRpm_;
}

void Simulator::setSpeed(double rpm) {
    if (mode_ == Mode::replay || mode_ == Mode::review) return;
    settings_.drive = driveAt(driveName_.toStdString(), rpm);
    speedRpm_ = settings_.drive.freeSpeedRpm;
    noteDriveChosen();
    if (mayWork()) liveSession_->setDrive(settings_.drive);
    emit settingsChanged();
}

void Simulator::setMultipliers(double stiffness, double damping, double friction) {
    if (mode_ == Mode::replay || mode_ == Mode::review) return;
    force::Parameters wanted = settings_.parameters;
    wanted.stiffnessMultiplier = stiffness;
    wanted.dampingMultiplier = damping;
    wanted.frictionMultiplier = friction;
    try {
        force::validate(wanted);
        settings_.parameters = wanted;
        if (mayWork()) liveSession_->setParameters(wanted);
    } catch (const core::Error& error) {
        emit failed(problemOf(error));
    }
    emit settingsChanged();
}

void Simulator::setHullMethod(bool hull) {
    if (!mayWork() || hull == hull_) return;
    if (hull && status_.cut) {
        emit failed(problemById(QStringLiteral("hull-cannot-cut")));
    } else {
        hull_ = hull;
        liveSession_->setHullMethod(hull);
    }
    emit settingsChanged();
}

void Simulator::noteWorkingWay(int hour, bool mirrorOnly, bool fingerRest) {
    way_ = {hour, mirrorOnly, fingerRest, way_.depthStop, way_.perPassMm};
    if (mode_ != Mode::liveSession || !liveSession_) return;
    liveSession_->noteWorkingWay(way_);
}

void Simulator::noteHand(bool isStopOn, std::optional<double> perPassMm) {
    if (way_.depthStop == isStopOn && way_.perPassMm == perPassMm) return;
    way_.depthStop = isStopOn;
    way_.perPassMm = perPassMm;
    noteWorkingWay(way_.hour, way_.mirrorOnly, way_.fingerRest);
}

void Simulator::setForceMode(force::LawId mode) {
    if (mode_ == Mode::replay || mode == settings_.parameters.law) return;
    settings_.parameters.law = mode;
    if (mayWork()) liveSession_->setParameters(settings_.parameters);
    emit settingsChanged();
}

void Simulator::play(bool playing) {
    if (replay_) replay_->play(playing);
}

void Simulator::seek(double timeS) {
    if (replay_) replay_->seek(timeS);
}

void Simulator::setReplaySpeed(double speed) {
    if (replay_) replay_->setSpeed(speed);
}

void Simulator::setMix(const sound::Mix& mix) {
    mix_ = mix;
    if (player_) player_->setMix(mix);
}

void Simulator::setEar(const sound::Ear& ear) {
    if (player_) player_->setEar(ear);
}

void Simulator::setRecordings(const sound::Recording& motor, const sound::Recording& cutting,
                              std::function<void(const std::optional<Problem>&)> done) {
    if (!player_) {
        done({});
        return;
    }
    if (soundJob_) return;
    soundJob_ = std::make_unique<Job>(
        tr("Reading the sound"),
        [player = player_.get(), motor, cutting](const core::Progress&) { player->setRecordings(motor, cutting); });
    const auto end = [this, done = std::move(done)](const std::optional<Problem>& problem) {
        soundJob_.release()->deleteLater();
        done(problem);
    };
    connect(soundJob_.get(), &Job::done, this, [end] { end({}); });
    connect(soundJob_.get(), &Job::failed, this, [end](const Problem& problem) { end(problem); });
    soundJob_->start();
}

sound::PlayerStatus Simulator::soundStatus() const {
    if (player_) return player_->status();
    sound::PlayerStatus status;
    status.silent = true;
    status.device = tr("switched off").toStdString();
    return status;
}

}  // namespace handpiece::desktop
