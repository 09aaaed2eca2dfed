// SPDX-License-Identifier: Apache-2.0
// What an exercise allows; handing in; looking at what was handed in.
#include <QLocale>
#include <QTemporaryDir>

#include "desktop/work/simulator.h"
#include "handpiece/base/core/file.h"

namespace handpiece::desktop {

namespace fs = std::filesystem;
namespace {
constexpr double kRestsOverMm = 8.0;
}

/// A tooth that was handed in, to be looked at; its recordings are unpacked as they are watched, and go with it.
struct Simulator::Reviewed {
    LoadedTooth tooth;
    QTemporaryDir recordings;
};

const cases::Exercise* Simulator::exercise() const {
    const cases::Case* of = leftFor_    ? leftFor_->tooth.toothCase.get()
                            : reviewed_ ? reviewed_->tooth.toothCase.get()
                                        : toothCase_.get();
    return of && of->exercise ? &*of->exercise : nullptr;
}

exercise::Permissions Simulator::permissions() const {
    using exercise::WorkMode;
    const WorkMode mode = reviewed_                    ? WorkMode::review
                          : mode_ == Mode::liveSession ? WorkMode::work
                          : mode_ == Mode::replay      ? WorkMode::replay
                                                       : WorkMode::nothing;
    return exercise::permissionsOf(exercise(), mode, exam_.has_value());
}

bool Simulator::may(exercise::Operation operation) {
    const exercise::Permissions now = permissions();
    if (now.locks(operation)) emit refused(operation);
    return now.allows(operation);
}

cases::Attempt Simulator::attemptNow(bool handedIn) {
    cases::Attempt attempt = liveSession_->attempt(document_.caseFile);
    if (!code_.isEmpty()) attempt.student = code_.toStdString();
    for (const RecordingPlace& recording : document_.recordings)
        attempt.recordings.push_back({recording.name, recording.packed});
    if (!attempt.session.empty()) attempt.recordings.push_back({attempt.session, false});
    attempt.handedIn = handedIn;
    if (document_.task) {
        attempt.exercise = tasks::taskToml(*document_.task);
        attempt.rubric = document_.task->rubric;
    }
    return attempt;
}

void Simulator::handIn(const fs::path& path) {
    if (job_ || !may(exercise::Operation::elsewhere)) return;
    if (mode_ != Mode::liveSession) {
        emit failed(problemById(QStringLiteral("nothing-open")));
        return;
    }
    // Only a recording that was closed is whole: the tooth is left, and taken up again.
    liveSession_->stop();
    const auto attempt = std::make_shared<cases::Attempt>(attemptNow(true));
    const auto left = std::make_shared<Left>(leaveLiveSession());
    struct Packed {
        std::size_t count = 0, leftOut = 0;
        std::uint64_t bytes = 0;
    };
    const auto packed = std::make_shared<Packed>();
    start(
        tr("Handing in"),
        [attempt, path, packed, outside = outside_, recordings = left->tooth.document.recordings,
         toothCase = left->tooth.toothCase](const core::Progress& progress) {
            cases::PackageFiles files = recordingBytes(recordings, false, packed->leftOut, progress);
            packed->count = files.size();
            for (const auto& [name, bytes] : files) {
                packed->bytes += bytes.size();
                outside->made(bytes);
            }
            cases::writeAttempt(*attempt, path, toothCase.get(), std::move(files));
            outside->made(path);
        },
        [this, left, path, packed] {
            left->tooth.document.attemptFile = path;
            left->file.note.unsaved = false;
            emit saved(toQString(path));
            QStringList told{toQString(path.filename()), QString::number(packed->count),
                             QLocale().toString(static_cast<double>(packed->bytes) / (1 << 20), 'f', 1)};
            if (packed->leftOut > 0) told << QString::number(packed->leftOut);
            emit noticed(packed->leftOut > 0 ? QStringLiteral("handed-in-part") : QStringLiteral("handed-in"), told);
            comeBack(left);
        },
        [this, left] { comeBack(left); });
}

void Simulator::review(const fs::path& attempt) {
    if (!may(exercise::Operation::elsewhere)) return;
    LoadRequest wanted = request();
    wanted.path = attempt;
    loadFor(std::move(wanted), tr("Opening %1").arg(toQString(attempt.filename())), [this](LoadedTooth loaded) {
        reviewed_ = std::make_shared<Reviewed>();
        reviewed_->tooth = std::move(loaded);
        showReviewed();
    });
}

void Simulator::showReviewed() {
    stopAll(true);
    const LoadedTooth& tooth = reviewed_->tooth;
    document_ = tooth.document;
    toothCase_ = tooth.toothCase;
    tooth_ = tooth.liveTooth;
    const device::Capability capability = settings_.capability;
    settings_ = tooth.station.settings;
    settings_.capability = capability;
    burName_ = QString::fromStdString(tooth.bur);
    driveName_ = QString::fromStdString(tooth.drive);
    speedRpm_ = tooth.speedRpm;
    unsaved_ = false;
    status_ = {};
    // The bur rests over the tooth; what is gone is told.
    sample_ = {};
    sample_.removedMm3 = tooth.state.removedMm3.own;
    sample_.removedOthersMm3 = tooth.state.removedMm3.sumOfOthers();
    const core::Box box = tooth_->model().outer.bounds();
    startPose_ = {{box.centre().x(), box.centre().y(), box.max.z() + kRestsOverMm}, core::Quat::Identity()};
    for (std::size_t axis = 0; axis < 3; ++axis)
        sample_.positionMm[axis] = sample_.proxyPositionMm[axis] = startPose_.positionMm[static_cast<int>(axis)];
    mode_ = Mode::review;
    emit documentChanged();
    emit settingsChanged();
    emit unsavedChanged(false);
    emit ticked();
}

const Document& Simulator::reviewed() const {
    return reviewed_->tooth.document;
}

void Simulator::watchRecording(std::size_t which) {
    if (job_ || !reviewed_ || which >= reviewed_->tooth.document.recordings.size()) return;
    const RecordingPlace place = reviewed_->tooth.document.recordings[which];
    if (!place.packed || !reviewed_->recordings.isValid()) {
        emit failed(problemById(QStringLiteral("no-recording")));
        return;
    }
    const fs::path file = toPath(reviewed_->recordings.path()) / place.name;
    std::error_code error;
    if (fs::exists(file, error)) {
        openSession(file, true);
        return;
    }
    start(
        tr("Opening %1").arg(QString::fromStdString(place.name)),
        [place, file](const core::Progress&) { core::writeFile(file, cases::readRecording(place.in, place.name)); },
        [this, file] { openSession(file, true); });
}

}  // namespace handpiece::desktop
