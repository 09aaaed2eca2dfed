// SPDX-License-Identifier: Apache-2.0
#include "shell/simulator.h"

#include <algorithm>
#include <atomic>

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;
constexpr int kPollMs = 33, kReplayPollMs = 16;
constexpr double kStartAboveMm = 8.0;

/// Over the middle of the crown, tip down.
core::Pose poseAbove(const tooth::Case& toothCase) {
    core::Box box = toothCase.outer.bounds();
    if (toothCase.outer.vertices.empty())
        for (const tooth::Part& part : toothCase.parts)
            for (const core::Vec3& v : part.mesh.vertices)
                box.extend(v);
    core::Pose pose;
    pose.positionMm = 0.5 * (box.min + box.max);
    pose.positionMm.z() = box.max.z() + kStartAboveMm;
    return pose;
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
      hands_(options.hands),
      shelf_(options.folders.sessions, options.shelf),
      voxelUm_(options.voxelUm) {
    const instrument::Instrument made = instrument::makeInstrument(burName_.toStdString());
    settings_.bur = made.bur;
    settings_.ability = made.ability;
    settings_.drive = driveAt(driveName_.toStdString(), 0.0);
    speedRpm_ = settings_.drive.freeSpeedRpm;
    settings_.field.voxelMm = 1e-3 * voxelUm_;
    settings_.capability = device::pointerCapability();
    connect(&hands_, &Hands::changed, this, &Simulator::passHandpiece);
    if (options.sound) player_ = std::make_unique<sound::Player>();
    connect(&timer_, &QTimer::timeout, this, &Simulator::poll);
    timer_.setTimerType(Qt::PreciseTimer);
    shelf_.tidy();
}

Simulator::~Simulator() {
    soundJob_.reset();
    job_.reset();
    stopAll();
}

QStringList Simulator::lockedHelps() const {
    QStringList helps;
    if (mode_ == Mode::sitting && toothCase_ && toothCase_->exercise)
        for (const std::string& help : toothCase_->exercise->lockedHelps)
            helps << QString::fromStdString(help);
    return helps;
}

QStringList Simulator::allowedBurs() const {
    QStringList burs;
    if (mode_ == Mode::sitting && toothCase_ && toothCase_->exercise)
        for (const std::string& bur : toothCase_->exercise->allowedBurs)
            burs << QString::fromStdString(bur);
    return burs;
}

SessionNote Simulator::noteNow() const {
    SessionNote note{toQString(document_.caseFile), QString::fromStdString(document_.name),
                     toQString(document_.attemptFile), unsaved_};
    if (document_.starter) {
        const std::string_view name = starter::infoOf(document_.starter->kind).name;
        note.starter = QString::fromUtf8(name.data(), static_cast<qsizetype>(name.size()));
        note.faces = document_.starter->faces;
    }
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
    sample_.removedMm3 = loaded.state.removedMm3;
    status_ = {};
    savedMm3_ = loaded.state.removedMm3;
    unsaved_ = false;
    startPose_ = poseAbove(*toothCase_);

    station::SittingSettings sitting;
    sitting.code = loaded.code.empty() ? code_.toStdString() : loaded.code;
    sessionCode_ = sitting.code;
    sitting.elapsedS = elapsedS_ = loaded.elapsedS;
    sitting.history = std::move(loaded.history);
    sitting.realTime = options_.realTime;
    const std::vector<std::string> locked =
        toothCase_->exercise ? toothCase_->exercise->lockedHelps : std::vector<std::string>();
    sitting.lowerButtonUndoes = std::find(locked.begin(), locked.end(), "undo") == locked.end();
    if (options_.record) {
        try {
            sitting.sessionFile = shelf_.begin(noteNow());
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
        return std::make_unique<station::Sitting>(loaded.station, *toothCase_, std::move(device), sitting, tooth_);
    };
    try {
        sitting_ = make();
    } catch (const core::Error& error) {
        if (sitting.sessionFile.empty()) throw;
        // Better to work without a record than not at all.
        sitting.sessionFile.clear();
        shelf_.end();
        emit noticed(QStringLiteral("recording-stopped"), {problemOf(error).what});
        sitting_ = make();
    }
    pictureFeed_ = sitting_->subscribe();
    pollFeed_ = sitting_->subscribe();
    if (player_) {
        ear_ = std::make_shared<Ear>();
        tellDrill();
        sitting_->setListener([player = player_.get(), ear = ear_, periodS = 1.0 / settings_.rateHz](
                                  const messages::HapticSample& sample) { ear->hear(*player, sample, periodS); });
    }
    mode_ = Mode::sitting;
    timer_.start(kPollMs);
    emit documentChanged();
    emit settingsChanged();
    emit unsavedChanged(false);
    if (!loaded.missingBur.empty())
        emit noticed(QStringLiteral("bur-missing"), {QString::fromStdString(loaded.missingBur), burName_});
}

ReplayDriver::Heard Simulator::replayEar() {
    if (!player_) return {};
    ear_ = std::make_shared<Ear>();
    return [player = player_.get(), ear = ear_](const messages::HapticSample& sample, double stepS,
                                                const station::Station& station) {
        ear->radiusMm = station.settings.bur->maxRadiusMm();
        ear->edges = station.settings.ability.edges;
        ear->freeSpeedRpm = station.settings.drive.freeSpeedRpm;
        ear->hear(*player, sample, stepS);
    };
}

void Simulator::watch(std::unique_ptr<ReplayDriver> driver) {
    replay_ = std::move(driver);
    toothCase_ = std::make_shared<const tooth::Case>(replay_->toothCase());
    tooth_ = replay_->tooth();
    const device::Capability capability = settings_.capability;
    settings_ = replay_->firstSettings();
    settings_.capability = capability;
    mode_ = Mode::replay;
    sample_ = replay_->now().sample;
    status_ = {};
    timer_.start(kReplayPollMs);
    emit documentChanged();
    emit plotted(replay_->plot());
}

void Simulator::stopSitting(bool keepMarker) {
    timer_.stop();
    if (sitting_) {
        sitting_->stop();
        status_ = sitting_->status();
    }
    sitting_.reset();
    if (player_) player_->setDrill({});
    pictureFeed_.reset();
    pollFeed_.reset();
    mailbox_.reset();
    usedHand_.reset();
    if (keepMarker) {
        shelf_.leave();
    } else {
        shelf_.end();
    }
    mode_ = Mode::empty;
}

void Simulator::stopAll() {
    timer_.stop();
    replay_.reset();
    // A tooth that waits behind a replay: what nobody saved of it is offered again at the next start.
    if (leftFor_ && !leftFor_->file.note.unsaved) shelf_.settle(leftFor_->file.session);
    leftFor_.reset();
    stopSitting(false);
}

void Simulator::close() {
    waiting_ = {};
    job_.reset();
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
        if (now.bur && now.bur != settings_.bur) {
            settings_.bur = now.bur;
            burName_ = QString::fromStdString(now.bur->name());
            emit settingsChanged();
        }
        if (now.problem) {
            replay_->play(false);
            emit failed(*now.problem);
        }
        emit ticked();
        return;
    }
    if (!sitting_) return;
    const bool fine = status_.fault.empty();
    sample_ = pollFeed_->read();
    status_ = sitting_->status();
    if (sample_.tick > 0 && (sample_.flags & messages::kRestoring) == 0) markUnsaved(sample_.removedMm3 != savedMm3_);
    if (fine && !status_.fault.empty())
        emit failed(problemById(QStringLiteral("sitting-ended"), {QString::fromStdString(status_.fault)}));
    emit plotted(sitting_->takePlot());
    for (const station::Notice& notice : sitting_->takeNotices()) {
        // Hands says which, and what to do.
        if (notice.id == "device-fault" && usedHand_) continue;
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
    return mode_ == Mode::sitting && sitting_ && status_.fault.empty();
}

void Simulator::undo() {
    if (mayWork() && !isLocked(QStringLiteral("undo"))) sitting_->undo();
}

void Simulator::redo() {
    if (mayWork() && !isLocked(QStringLiteral("undo"))) sitting_->redo();
}

void Simulator::reset() {
    if (mayWork() && !isLocked(QStringLiteral("reset"))) sitting_->reset();
}

void Simulator::tellDrill() {
    if (!ear_) return;
    ear_->radiusMm = settings_.bur->maxRadiusMm();
    ear_->edges = settings_.ability.edges;
    ear_->freeSpeedRpm = instrument::driveByName(driveName_.toStdString()).freeSpeedRpm;
}

void Simulator::setBur(const QString& nameOrFile) {
    if (mode_ == Mode::replay) return;
    const QStringList allowed = allowedBurs();
    if (!allowed.isEmpty() && !allowed.contains(nameOrFile)) {
        emit noticed(QStringLiteral("bur-locked"), {nameOrFile});
        emit settingsChanged();
        return;
    }
    try {
        instrument::Instrument made = instrument::makeInstrument(nameOrFile.toStdString());
        settings_.bur = std::move(made.bur);
        settings_.ability = std::move(made.ability);
        burName_ = nameOrFile;
        if (mayWork()) sitting_->setBur(settings_.bur, settings_.ability);
        tellDrill();
    } catch (const core::Error& error) {
        emit failed(problemOf(error));
    }
    emit settingsChanged();
}

void Simulator::setDrive(const QString& name) {
    if (mode_ == Mode::replay || name == driveName_) return;
    try {
        settings_.drive = driveAt(name.toStdString(), 0.0);
    } catch (const core::Error& error) {
        emit failed(problemOf(error));
        return;
    }
    driveName_ = name;
    speedRpm_ = settings_.drive.freeSpeedRpm;
    if (mayWork()) sitting_->setDrive(settings_.drive);
    tellDrill();
    emit settingsChanged();
}

void Simulator::setSpeed(double rpm) {
    if (mode_ == Mode::replay) return;
    settings_.drive = driveAt(driveName_.toStdString(), rpm);
    speedRpm_ = settings_.drive.freeSpeedRpm;
    if (mayWork()) sitting_->setDrive(settings_.drive);
    emit settingsChanged();
}

void Simulator::setMultipliers(double stiffness, double damping, double friction) {
    if (mode_ == Mode::replay) return;
    force::Parameters wanted = settings_.parameters;
    wanted.stiffnessMultiplier = stiffness;
    wanted.dampingMultiplier = damping;
    wanted.frictionMultiplier = friction;
    try {
        force::validate(wanted);
        settings_.parameters = wanted;
        if (mayWork()) sitting_->setParameters(wanted);
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
        sitting_->setHullMethod(hull);
    }
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
