// SPDX-License-Identifier: Apache-2.0
// The simulator's long work: opening, saving, cutting again.
#include "desktop/work/simulator.h"
#include "handpiece/app/report/session_report.h"
#include "handpiece/app/simulation/tissue_export.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/attempt.h"

#include <set>

namespace handpiece::desktop {
namespace fs = std::filesystem;

void Simulator::start(const QString& title, Job::Work work, std::function<void()> done,
                      std::function<void()> otherwise) {
    job_ = std::make_unique<Job>(title, std::move(work));
    // The job lets go of itself only after its signal has been dealt with.
    const auto end = [this] {
        job_.release()->deleteLater();
        emit jobEnded();
        touch_.reset();
    };
    connect(job_.get(), &Job::progressed, this, &Simulator::jobProgressed);
    connect(job_.get(), &Job::done, this, [this, end, done = std::move(done)] {
        end();
        try {
            done();
        } catch (const core::Error& error) {
            emit failed(problemOf(error));
        }
        goOn();
    });
    connect(job_.get(), &Job::failed, this, [this, end, otherwise](const Problem& problem) {
        end();
        emit failed(problem);
        if (otherwise) otherwise();
        goOn();
    });
    connect(job_.get(), &Job::cancelled, this, [this, end, otherwise = std::move(otherwise)] {
        end();
        if (otherwise) otherwise();
        goOn();
    });
    emit jobStarted(title);
    job_->start();
}

void Simulator::cancelJob() {
    if (job_ && !exam_) job_->cancel();
}

void Simulator::whenFree(std::function<void()> what) {
    waiting_ = std::move(what);
    goOn();
}

/// What ended may have begun more: a tooth that is brought back.
void Simulator::goOn() {
    if (!job_ && handChanged_) passHandpiece();
    if (job_ || !waiting_) return;
    const std::function<void()> what = std::move(waiting_);
    waiting_ = {};
    what();
}

LoadRequest Simulator::request() const {
    LoadRequest request;
    request.starterFolder = options_.folders.starters;
    request.sessionFolder = options_.folders.sessions;
    request.bur = burName_.toStdString();
    request.drive = chosenDrive_.toStdString();
    request.speedRpm = chosenRpm_;
    request.settings = settings_;
    request.settings.rateHz = options_.rateHz;
    request.settings.resumed = false;
    request.settings.field = simulation::fieldSettingsAt(1e-3 * options_.voxelUm);
    request.outside = outside_;
    return request;
}

void Simulator::load(LoadRequest request, const QString& title, std::function<void()> done) {
    loadFor(std::move(request), title, [this, done = std::move(done)](LoadedTooth loaded) {
        sit(std::move(loaded));
        if (done) done();
    });
}

void Simulator::loadFor(LoadRequest request, const QString& title, std::function<void(LoadedTooth)> then) {
    if (job_) return;
    const auto loaded = std::make_shared<LoadedTooth>();
    start(
        title,
        [loaded, request, listener = loadListener()](const core::Progress& progress) {
            *loaded = loadTooth(request, progress, listener);
        },
        [loaded, then = std::move(then)] { then(std::move(*loaded)); });
}

/// Called on the job's thread; what it says is told on the window's, while that job still runs.
LoadListener Simulator::loadListener() {
    const int job = ++loads_;
    const auto tell = [this, job](std::function<void()> what) {
        QMetaObject::invokeMethod(
            this,
            [this, job, what = std::move(what)] {
                if (job_ && job == loads_) what();
            },
            Qt::QueuedConnection);
    };
    LoadListener listener;
    listener.step = [this, tell](LoadStep step) { tell([this, step] { emit jobStepped(stepText(step)); }); };
    listener.renewed = [this, tell](const fs::path& place) {
        tell([this, place] { emit noticed(QStringLiteral("cache-renewed"), {toQString(place)}); });
    };
    listener.notKept = [this, tell](const fs::path& place, const core::Error& why) {
        tell([this, place, what = problemOf(why).what] {
            emit noticed(QStringLiteral("cache-not-kept"), {toQString(place.parent_path()), what});
        });
    };
    listener.sketch = [this, tell](std::shared_ptr<const cases::Case> sketch) {
        tell([this, sketch = std::move(sketch)] {
            if (mode_ == Mode::empty) emit sketched(sketch);
        });
    };
    listener.touchable = [this, tell](std::shared_ptr<Touchable> touchable) {
        tell([this, touchable = std::move(touchable)] { beginTouch(touchable); });
    };
    return listener;
}

QString Simulator::stepText(LoadStep step) {
    switch (step) {
        case LoadStep::reading:
            return tr("reading");
        case LoadStep::recovering:
            return tr("cutting again what was recorded");
        case LoadStep::shaping:
            return tr("shaping it (the first time only)");
        case LoadStep::mouth:
            return tr("making the mouth around it (the first time only)");
        case LoadStep::distances:
            return tr("measuring distances");
        case LoadStep::tissues:
            return tr("laying out its tissues");
        case LoadStep::surface:
            return tr("drawing its surface");
    }
    return {};
}

void Simulator::openStarter(const Starter& starter) {
    if (!may(exercise::Operation::elsewhere)) return;
    LoadRequest wanted = request();
    wanted.starter = starter;
    load(std::move(wanted), tr("Preparing the tooth"));
}

void Simulator::open(const fs::path& path, int fdi) {
    if (!may(exercise::Operation::elsewhere)) return;
    FileKind kind = FileKind::unknown;
    try {
        kind = fileKindOf(path);
    } catch (const core::Error& error) {
        emit failed(problemOf(error));
        return;
    }
    if (kind == FileKind::unknown) {
        std::error_code error;
        emit failed(
            problemById(fs::exists(path, error) ? QStringLiteral("unknown-file") : QStringLiteral("file-not-found"), {},
                        toQString(path)));
        return;
    }
    if (kind == FileKind::session) {
        openSession(path);
        return;
    }
    LoadRequest wanted = request();
    wanted.path = path;
    wanted.fdi = fdi;
    load(std::move(wanted), tr("Opening %1").arg(toQString(path.filename())));
}

void Simulator::readApart(const fs::path& path, std::function<void()> then) {
    if (outside_->isAtHand(path)) return then();
    if (job_ || !may(exercise::Operation::elsewhere)) return;
    start(
        tr("Reading %1").arg(toQString(path.filename())),
        [path, outside = outside_](const core::Progress& progress) { outside->read(path, progress); }, std::move(then));
}

void Simulator::openSession(const fs::path& path, bool keepsReview) {
    if (job_) return;
    const auto player = std::make_shared<std::unique_ptr<simulation::SessionPlayer>>();
    start(
        tr("Opening %1").arg(toQString(path.filename())),
        [player, path, outside = outside_](const core::Progress& progress) {
            const double read = outside->isAtHand(path) ? 0.0 : 0.5;
            outside->read(path, core::part(progress, 0.0, read));
            *player = std::make_unique<simulation::SessionPlayer>(path, true, core::part(progress, read, 1.0));
        },
        [this, player, path, keepsReview] {
            std::shared_ptr<Left> left = std::move(leftFor_);
            stopAll(keepsReview);
            leftFor_ = std::move(left);
            unsaved_ = false;
            document_ = {};
            document_.name = path.filename().string();
            document_.caseFile = path;
            watch(std::make_unique<ReplayDriver>(std::move(*player), replayEar()));
            emit unsavedChanged(false);
        },
        [this] {
            if (leftFor_)
                closeReplay();
            else if (mode_ == Mode::empty && tooth_)
                close();  // of work that was finished, whose recording is gone: nothing can be done with its picture
        });
}

Simulator::Left Simulator::leaveLiveSession() {
    Left left{{shelf_.current(), noteNow()}, {}, history::History()};
    LoadedTooth& tooth = left.tooth;
    tooth.document = document_;
    if (const fs::path& current = shelf_.current(); !current.empty())
        tooth.document.recordings.push_back({current.filename().string(), current, false});
    tooth.toothCase = toothCase_;
    tooth.bur = burName_.toStdString();
    tooth.drive = driveName_.toStdString();
    tooth.speedRpm = speedRpm_;
    tooth.code = sessionCode_;
    liveSession_->stop();
    tooth.station = liveSession_->station();
    tooth.station.settings = liveSession_->settings();
    tooth.station.settings.hull = false;
    tooth.station.settings.resumed = true;
    tooth.state = liveSession_->state();
    tooth.elapsedS = elapsedS_ + liveSession_->status().timeS;
    left.history = liveSession_->history();
    // Only a recording that was closed is whole.
    stopLiveSession(true);
    tooth.recording = left.file.session;
    tooth.session = simulation::LiveSessionSettings::Session::continued;
    return left;
}

void Simulator::comeBack(const std::shared_ptr<Left>& left, std::function<void()> then) {
    const auto loaded = std::make_shared<LoadedTooth>(left->tooth);
    start(
        tr("Bringing the tooth back"),
        [left, loaded](const core::Progress& progress) {
            // A field of its own: what the old loop had yet to hand over is in the state.
            loaded->station.renewFields();
            loaded->station.resume(loaded->state);
            loaded->history = simulation::keepHistory(left->history, loaded->state, loaded->station);
            loaded->liveTooth = std::make_shared<simulation::LiveTooth>(loaded->station, loaded->state, progress);
        },
        [this, left, loaded, then = std::move(then)] {
            leftFor_.reset();
            sit(std::move(*loaded));
            takeOver(left->file);
            if (then) then();
        });
}

/// What was brought back is in no file yet: the recording under way holds it, and says so. Where none could go on, the
/// one that was left keeps its marker.
void Simulator::takeOver(const Crashed& file) {
    if (file.note.unsaved) {
        savedMm3_ = {};
        savedOthersMm3_ = 0.0;
        markUnsaved(true);
    }
    if (!shelf_.current().empty() && file.session != shelf_.current()) shelf_.settle(file.session);
}

void Simulator::replayThis() {
    if (mode_ == Mode::review) {
        const std::vector<RecordingPlace>& all = reviewed().recordings;
        for (std::size_t i = all.size(); i-- > 0;)
            if (all[i].packed) return watchRecording(i);
    }
    if (job_ || mode_ != Mode::liveSession || !may(exercise::Operation::elsewhere)) return;
    if (!isRecorded()) {
        emit failed(problemById(QStringLiteral("no-recording")));
        return;
    }
    leftFor_ = std::make_shared<Left>(leaveLiveSession());
    openSession(leftFor_->file.session);
}

void Simulator::closeReplay(std::function<void()> then) {
    if (job_) return;
    if (leftFor_) {
        comeBack(leftFor_, std::move(then));
    } else if (reviewed_) {
        showReviewed();
        if (then) then();
    } else {
        close();
    }
}

void Simulator::giveUpBehindReplay() {
    if (leftFor_) leftFor_->file.note.unsaved = false;
}

void Simulator::setCode(const QString& asked) {
    // What a session's header takes: with anything else nothing would be recorded.
    QString code;
    for (const QChar c : asked.trimmed())
        if (c.unicode() < 128 && (c.isLetterOrNumber() || c == QLatin1Char('-') || c == QLatin1Char('_'))) code += c;
    code.truncate(32);
    if (code == code_) return;
    code_ = code;
    sessionCode_ = code.toStdString();
    if (job_ || mode_ != Mode::liveSession || exam_) return;
    if (!status_.cut && status_.strokes == 0 && document_.attemptFile.empty()) {
        load(requestAgain(), tr("Preparing the tooth"));
    } else {
        emit noticed(QStringLiteral("code-later"), {code});
    }
}

void Simulator::recover(const Crashed& crashed, std::function<void()> then) {
    if (may(exercise::Operation::elsewhere)) bringBack(crashed, std::move(then));
}

void Simulator::bringBack(const Crashed& crashed, std::function<void()> then) {
    LoadRequest wanted = request();
    wanted.path = crashed.session;
    wanted.recover = true;
    wanted.recovered.caseFile = toPath(crashed.note.caseFile);
    wanted.recovered.attemptFile = toPath(crashed.note.attemptFile);
    wanted.recovered.name = crashed.note.title.toStdString();
    wanted.recovered.starter = crashed.note.starter;
    wanted.recovered.workedOn = crashed.note.workedOn;
    wanted.recovered.taskPath = toPath(crashed.note.task);
    wanted.recovered.beforeS = crashed.note.beforeS;
    wanted.recovered.began = crashed.note.began;
    for (const QString& name : crashed.note.recordings) {
        // On the shelf, or gone from there and in the attempt that it was saved with.
        const fs::path place = shelf_.folder() / name.toStdString(), saved = wanted.recovered.attemptFile;
        const bool isPacked = !core::isThere(place) && !saved.empty() && core::isThere(saved);
        wanted.recovered.recordings.push_back({name.toStdString(), isPacked ? saved : place, isPacked});
    }
    wanted.recovered.recordings.push_back({crashed.session.filename().string(), crashed.session, false});
    if (exam_) {
        wanted.exam = exam_->sitting, wanted.examLocks = exam_->locked;
        wanted.recovered.exam = exam_->sitting, wanted.recovered.taskPath = exam_->exercise;
    }
    try {
        if (!crashed.note.exercise.isEmpty())
            wanted.exercise = cases::parseExercise(crashed.note.exercise.toStdString(), crashed.session.string());
    } catch (const core::Error& error) {
        emit failed(problemOf(error));  // the tooth comes back all the same
    }
    load(std::move(wanted), tr("Bringing the tooth back"), [this, crashed, then = std::move(then)] {
        takeOver(crashed);
        if (then) then();
    });
}

void Simulator::saveAs(const fs::path& path, std::function<void()> then) {
    if (job_ || !may(exercise::Operation::elsewhere)) return;
    if (mode_ != Mode::liveSession) {
        emit failed(problemById(QStringLiteral("nothing-open")));
        return;
    }
    std::error_code error;
    const bool vanished = !fs::exists(document_.caseFile, error);
    const bool packed = path.extension() == ".handpiece";
    if (vanished && !packed) {
        emit failed(problemById(QStringLiteral("case-vanished"), {toQString(document_.caseFile)}));
        return;
    }
    const auto attempt = std::make_shared<cases::Attempt>(attemptNow(false));
    const tooth::TissueVolumes removedMm3 = attempt->removedMm3;
    const double othersMm3 = sample_.removedOthersMm3;
    const auto carried = std::make_shared<std::set<std::string>>();
    start(
        tr("Saving"),
        [attempt, packed, path, carried, outside = outside_, toothCase = toothCase_, recordings = document_.recordings,
         isJudged = document_.task != nullptr](const core::Progress& p) {
            // What came with the attempt goes on with it: it may lie in the very file that is replaced. Of an exercise
            // all sittings before this one: the shelf keeps none for ever.
            std::size_t leftOut = 0;
            cases::PackageFiles files = recordingBytes(recordings, !isJudged, leftOut, p);
            for (const auto& [name, bytes] : files) {
                carried->insert(name);
                outside->made(bytes);
            }
            cases::writeAttempt(*attempt, path, packed ? toothCase.get() : nullptr, std::move(files));
            outside->made(path);
        },
        [this, path, removedMm3, othersMm3, vanished, carried, then = std::move(then)] {
            document_.attemptFile = path;
            document_.name = path.stem().string();
            for (RecordingPlace& recording : document_.recordings)
                if (carried->contains(recording.name)) recording = {recording.name, path, true};
            savedMm3_ = removedMm3;
            savedOthersMm3_ = othersMm3;
            markUnsaved(isCutSinceSaved(), true);  // its place has changed in any case
            emit saved(toQString(path));
            // A tooth of the program is made again; that it could not be kept was told.
            if (vanished && !document_.starter)
                emit noticed(QStringLiteral("case-vanished"), {toQString(document_.caseFile)});
            if (then) then();
        });
}

tooth::StateDelta Simulator::state() const {
    return liveSession_ ? liveSession_->state() : tooth_->state({sample_.removedMm3, {}});
}

void Simulator::exportStl(const fs::path& path) {
    if (job_ || !may(exercise::Operation::elsewhere)) return;
    if (!tooth_) {
        emit failed(problemById(QStringLiteral("nothing-open")));
        return;
    }
    start(
        tr("Writing the STL file"),
        [path, base = tooth_->modelShared(), state = state()](const core::Progress& progress) {
            simulation::exportStl(base, state, path, progress);
        },
        [this, path] { emit saved(toQString(path)); });
}

void Simulator::exportTissues(const fs::path& folder) {
    if (job_ || !may(exercise::Operation::elsewhere)) return;
    if (!tooth_) {
        emit failed(problemById(QStringLiteral("nothing-open")));
        return;
    }
    const auto last = std::make_shared<fs::path>(folder);
    start(
        tr("Writing the tissues"),
        [folder, last, base = tooth_->modelShared(), state = state()](const core::Progress& progress) {
            const auto files = simulation::exportTissues(base, state, folder, progress);
            if (!files.empty()) *last = files.front();
        },
        [this, last] { emit saved(toQString(*last)); });
}

void Simulator::writeReport(const fs::path& file) {
    if (!may(exercise::Operation::report)) return;
    const fs::path session = mode_ == Mode::replay ? document_.caseFile : shelf_.current();
    if (job_ || session.empty()) {
        if (!job_) emit failed(problemById(QStringLiteral("no-recording")));
        return;
    }
    start(
        tr("Writing the report"),
        [session, file](const core::Progress& progress) {
            simulation::SessionPlayer player(session, true, core::part(progress, 0.0, 0.2));
            core::writeFile(file, report::sessionReport(player, {}, core::part(progress, 0.2, 1.0)));
        },
        [this, file] { emit saved(toQString(file)); });
}

void Simulator::copyRecording(const fs::path& file) {
    if (job_ || !isRecorded() || !may(exercise::Operation::elsewhere)) return;
    start(
        tr("Copying the recording"),
        [from = shelf_.current(), file, outside = outside_](const core::Progress&) {
            core::writeFile(file, core::readFile(from));
            outside->made(file);
        },
        [this, file] { emit saved(toQString(file)); });
}

void Simulator::setVoxel(int um) {
    if (mode_ == Mode::empty && !job_) options_.voxelUm = voxelUm_ = um;
    if (job_ || mode_ != Mode::liveSession || um == voxelUm_) return;
    if (document_.task) {
        emit failed(problemById(QStringLiteral("voxel-of-exercise"), {QString::number(voxelUm_)}));
        emit settingsChanged();
        return;
    }
    if (status_.inStroke) {
        emit failed(problemById(QStringLiteral("voxel-in-stroke")));
        emit settingsChanged();
        return;
    }
    options_.voxelUm = um;
    if (!status_.cut) {
        load(requestAgain(), tr("Preparing the tooth"));
        return;
    }
    if (settings_.resumed || shelf_.current().empty()) {
        emit failed(problemById(settings_.resumed ? QStringLiteral("voxel-resumed") : QStringLiteral("no-recording")));
        emit settingsChanged();
        return;
    }
    const field::FieldSettings field = simulation::fieldSettingsAt(1e-3 * um);
    const auto left = std::make_shared<Left>(leaveLiveSession());
    const auto loaded = std::make_shared<LoadedTooth>(left->tooth);
    start(
        tr("Cutting the tooth again"),
        [loaded, field, session = left->file.session](const core::Progress& progress) {
            simulation::Recut recut = simulation::recutAt(session, field, true, core::part(progress, 0.0, 0.8));
            loaded->station = std::move(recut.station);
            loaded->station.settings.hull = false;
            loaded->station.settings.resumed = true;
            loaded->recording.clear();  // in another field: it begins anew
            loaded->session = simulation::LiveSessionSettings::Session::anew;
            loaded->state = std::move(recut.state);
            loaded->history = simulation::keepHistory(recut.history, loaded->state, loaded->station);
            loaded->liveTooth =
                std::make_shared<simulation::LiveTooth>(loaded->station, loaded->state, core::part(progress, 0.8, 1.0));
        },
        [this, loaded, left] {
            sit(std::move(*loaded));
            takeOver(left->file);
        },
        // Refused or cancelled: the tooth as it was.
        [this, left] { comeBack(left); });
}

}  // namespace handpiece::desktop
