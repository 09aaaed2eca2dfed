// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/documents.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <utility>

#include "handpiece/app/course/kept_cases.h"
#include "handpiece/app/exercise/permissions.h"
#include "handpiece/app/simulation/session_player.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/case/work_on.h"
#include "handpiece/model/tooth/kept_model.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/senses/surface/brick_source.h"
#include "handpiece/senses/surface/closed_surface.h"

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;

void takeBur(LoadedTooth& loaded, simulation::SimulationSettings& settings, const std::string& bur,
             const std::string& cuttingParameters) {
    instrument::Instrument made = instrument::makeInstrument(bur, {}, cuttingParameters);
    settings.bur = std::move(made.bur);
    settings.cuttingParameters = std::move(made.cuttingParameters);
    loaded.bur = bur;
}

/// What an attempt was cut with. A bur out of a file that is gone by now is no reason not to open it.
void takeInstruments(LoadedTooth& loaded, simulation::SimulationSettings& settings, const LoadRequest& request,
                     const cases::Attempt* attempt) {
    loaded.drive = request.drive;
    loaded.speedRpm = request.speedRpm;
    const tasks::Task* task = loaded.document.task.get();
    if (task && !task->drive.empty()) {
        loaded.drive = task->drive;
        loaded.speedRpm = task->speedRpm.value_or(0.0);
    }
    const cases::Exercise* exercise = loaded.toothCase->exercise ? &*loaded.toothCase->exercise : nullptr;
    const std::string otherwise = exercise::firstBur(exercise, request.bur);
    std::string bur = otherwise, cuttingParameters;
    if (attempt) {
        const auto& drives = instrument::drives();
        if (std::any_of(drives.begin(), drives.end(), [&](const auto& d) { return d.name == attempt->drive; })) {
            if (loaded.drive != attempt->drive || !task || task->drive.empty()) loaded.speedRpm = 0.0;
            loaded.drive = attempt->drive;
        }
        bur = exercise::firstBur(exercise, attempt->bur);
        if (bur == attempt->bur)
            cuttingParameters = attempt->cuttingParameters;
        else
            loaded.lockedBur = attempt->bur;
    } else if (exercise && !exercise->bur.empty()) {
        bur = exercise->bur;
    }
    try {
        takeBur(loaded, settings, bur, cuttingParameters);
    } catch (const core::Error&) {
        loaded.missingBur = bur;
        takeBur(loaded, settings, otherwise, {});
    }
    settings.drive = driveAt(loaded.drive, loaded.speedRpm);
    loaded.speedRpm = settings.drive.freeSpeedRpm;
}

/// The tissues' feel from the case's own table; the person's multipliers stay.
void takeTissues(simulation::SimulationSettings& settings, const cases::Case& toothCase) {
    settings.tissues = toothCase.tissues;
    const force::Parameters wanted = settings.parameters;
    settings.parameters = force::defaultParameters(toothCase.tissues);
    settings.parameters.law = wanted.law;
    settings.parameters.stiffnessMultiplier = wanted.stiffnessMultiplier;
    settings.parameters.dampingMultiplier = wanted.dampingMultiplier;
    settings.parameters.frictionMultiplier = wanted.frictionMultiplier;
}

void tell(const LoadListener& listener, LoadStep step) {
    if (listener.step) listener.step(step);
}

/// Voxel of a tooth that is only touched: what it rests on is asked of the triangles.
constexpr double kTouchVoxelMm = 0.1;

void offerTouch(const cases::Tooth& tooth, const LoadRequest& request, const core::Progress& progress,
                const LoadListener& listener) {
    auto made = std::make_shared<Touchable>();
    auto alone = std::make_shared<cases::Case>();
    static_cast<cases::Tooth&>(*alone) = tooth;
    simulation::SimulationSettings settings = request.settings;
    settings.field = simulation::fieldSettingsAt(kTouchVoxelMm);
    settings.hull = settings.resumed = false;
    takeTissues(settings, *alone);
    try {
        made->station = simulation::makeSimulation(*alone, std::move(settings), false, progress);
        made->liveTooth = std::make_shared<simulation::LiveTooth>(made->station, tooth::StateDelta{}, progress);
    } catch (const core::Error&) {
        return;  // whatever it is, the tooth itself tells it when its turn comes
    }
    made->toothCase = std::move(alone);
    listener.touchable(std::move(made));
}

void lockHelps(tasks::Task& task) {
    if (!task.toothCase.exercise) task.toothCase.exercise.emplace();
    std::vector<std::string>& locked = task.toothCase.exercise->lockedHelps;
    for (const std::string_view help : kUnaidedLocks)
        if (std::find(locked.begin(), locked.end(), help) == locked.end()) locked.emplace_back(help);
    task.hasLiveBar = false;
}

/// In an exam the station's service says what is locked, and not the exercise.
void takeExam(tasks::Task& task, const LoadRequest& request) {
    if (request.exam.empty()) return;
    if (!task.toothCase.exercise) task.toothCase.exercise.emplace();
    task.toothCase.exercise->lockedHelps = request.examLocks;
    if (std::find(request.examLocks.begin(), request.examLocks.end(), "score") != request.examLocks.end())
        task.hasLiveBar = false;
}

/// Where the case of an exercise lies, to be named by an attempt.
fs::path casePlace(const fs::path& task) {
    if (!core::isFolder(task)) return task;
    if (cases::isAttempt(task)) return cases::readAttempt(task).caseFile;
    return core::isThere(task / tasks::kTaskFile) ? task / "case" : task;
}

/// An attempt of before named its last recording only.
std::vector<RecordingPlace> placesOf(const cases::Attempt& attempt, const LoadRequest& request) {
    std::vector<cases::Attempt::Recording> named = attempt.recordings;
    if (named.empty() && !attempt.session.empty()) named.push_back({attempt.session, false});
    std::vector<RecordingPlace> places;
    for (const cases::Attempt::Recording& r : named)
        places.push_back({r.name, r.packed ? request.path : request.sessionFolder / r.name, r.packed});
    return places;
}

}  // namespace

bool isUnaided(const tasks::Task& task) {
    if (!task.toothCase.exercise) return false;
    const std::vector<std::string>& locked = task.toothCase.exercise->lockedHelps;
    return std::all_of(kUnaidedLocks.begin(), kUnaidedLocks.end(), [&](std::string_view help) {
        return std::find(locked.begin(), locked.end(), help) != locked.end();
    });
}

cases::PackageFiles recordingBytes(const std::vector<RecordingPlace>& places, bool packedOnly, std::size_t& leftOut,
                                   const core::Progress& progress) {
    cases::PackageFiles files;
    std::uint64_t bytes = 0;
    leftOut = 0;
    for (std::size_t i = places.size(); i-- > 0;) {
        const RecordingPlace& place = places[i];
        core::report(progress, 1.0 - static_cast<double>(i + 1) / static_cast<double>(places.size()));
        if (packedOnly && !place.packed) continue;
        const std::uint64_t room = cases::kMaxRecordingBytes - bytes;
        std::error_code error;
        const std::uint64_t size = fs::file_size(place.in, error);
        if (error || (!place.packed && size > room)) {
            ++leftOut;
            continue;
        }
        std::vector<std::byte> data =
            place.packed ? cases::readRecording(place.in, place.name) : core::readFile(place.in, room);
        if (data.size() > room) {
            ++leftOut;
            continue;
        }
        bytes += data.size();
        files[place.name] = std::move(data);
    }
    return files;
}

FileKind fileKindOf(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    std::error_code error;
    if (fs::is_directory(path, error)) return cases::isAttempt(path) ? FileKind::attempt : FileKind::toothCase;
    if (extension == ".h5") return FileKind::session;
    if (extension == ".toml") return FileKind::toothCase;
    if (extension == ".handpiece")
        return fs::exists(path, error) && cases::isAttempt(path) ? FileKind::attempt : FileKind::toothCase;
    if (geometry::meshFormatOf(path) != geometry::MeshFormat::unknown) return FileKind::mesh;
    return FileKind::unknown;
}

namespace {

fs::path starterPlace(const Starter& starter, const fs::path& folder) {
    return course::keptToothPlace(starter.fdi, starter.patient, starter.faces, folder);
}

}  // namespace

cases::Case starterCase(const Starter& starter, const fs::path& folder, const core::Progress& progress,
                        const LoadListener& listener) {
    const double toothShare = starter.inMouth ? 0.2 : 1.0;
    const auto show = [&](cases::Tooth shown) {
        auto sketch = std::make_shared<cases::Case>();
        static_cast<cases::Tooth&>(*sketch) = std::move(shown);
        if (listener.sketch) listener.sketch(std::move(sketch));
    };
    bool isNew = false;
    course::KeptListener hears{[&] {
                                   isNew = true;
                                   tell(listener, LoadStep::shaping);
                                   show(dentition::makeSketch(starter.fdi, starter.patient));
                               },
                               listener.renewed, listener.notKept};
    cases::Case tooth = course::keptTooth(starter.fdi, starter.patient, starter.faces, folder,
                                          core::part(progress, 0.0, toothShare), hears);
    if (!starter.inMouth) return tooth;
    // Reading the mouth takes a while too: the tooth is seen meanwhile.
    show(tooth);
    if (isNew && listener.shaped) listener.shaped(tooth);
    hears.making = [&] { tell(listener, LoadStep::mouth); };
    cases::Case mouth =
        course::keptMouth(starter.fdi, starter.patient, folder, core::part(progress, toothShare, 1.0), hears);
    return course::standIn(std::move(static_cast<cases::Tooth&>(tooth)), std::move(mouth));
}

instrument::Drive driveAt(const std::string& name, double speedRpm) {
    instrument::Drive drive = instrument::driveByName(name);
    if (speedRpm > 0.0)
        drive.freeSpeedRpm = std::clamp(speedRpm, tasks::kLeastSpeedShare * drive.freeSpeedRpm, drive.freeSpeedRpm);
    return drive;
}

LoadedTooth loadTooth(const LoadRequest& request, const core::Progress& progress, const LoadListener& told) {
    LoadedTooth loaded;
    LoadListener listener = told;
    listener.shaped = [&, isOffered = false](const cases::Tooth& tooth) mutable {
        // The bar stands still meanwhile, which is a second.
        const core::Progress still = [&](double) { return !progress || progress(0.0); };
        if (told.touchable && !std::exchange(isOffered, true)) offerTouch(tooth, request, still, told);
    };
    tell(listener, request.recover ? LoadStep::recovering : LoadStep::reading);
    simulation::SimulationSettings settings = request.settings;
    std::optional<cases::Attempt> attempt;
    std::optional<simulation::Recovered> recovered;
    if (const bool isMade = request.starter && request.task.empty(); request.outside && !isMade)
        request.outside->read(request.task.empty() ? request.path : request.task, core::part(progress, 0.0, 0.4));
    const core::Progress reading = core::part(progress, 0.0, 0.5), preparing = core::part(progress, 0.5, 0.8);
    if (request.recover) {
        recovered = simulation::recover(request.path, reading);
        loaded.document = request.recovered;
        recovered->toothCase.exercise = request.exercise;
        if (!request.recovered.taskPath.empty()) {
            try {
                auto task = std::make_shared<tasks::Task>(tasks::readTask(request.recovered.taskPath));
                takeExam(*task, request);
                if (!request.exam.empty()) recovered->toothCase.exercise = task->toothCase.exercise;
                loaded.document.task = std::move(task);
            } catch (const core::Error&) {  // gone by now: the tooth comes back all the same
                loaded.document.taskPath.clear();
            }
        }
        loaded.toothCase = std::make_shared<const cases::Case>(std::move(recovered->toothCase));
        loaded.elapsedS = loaded.document.beforeS + recovered->elapsedS;
        loaded.code = recovered->code;
        loaded.recording = request.path;
        loaded.session = simulation::LiveSessionSettings::Session::recovered;
        settings = recovered->settings;
        settings.capability = request.settings.capability;
        settings.hull = false;
        loaded.bur = settings.bur->name();
        loaded.drive = settings.drive.name;
        loaded.speedRpm = settings.drive.freeSpeedRpm;
    } else if (!request.task.empty()) {
        auto task = std::make_shared<tasks::Task>(tasks::readTask(request.task));
        if (request.unaided) lockHelps(*task);
        takeExam(*task, request);
        loaded.document.exam = request.exam;
        const fs::path whole = core::wholePath(request.task);
        loaded.document.caseFile = casePlace(whole);
        loaded.document.taskPath = whole;
        loaded.document.name = task->toothCase.name;
        loaded.document.began =
            std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch())
                .count();
        loaded.toothCase = std::make_shared<const cases::Case>(task->toothCase);
        settings.field = simulation::fieldSettingsAt(task->voxelMm);
        loaded.document.task = std::move(task);
    } else if (request.starter) {
        cases::Case made = starterCase(*request.starter, request.starterFolder, reading, listener);
        loaded.document.caseFile = starterPlace(*request.starter, request.starterFolder);
        loaded.document.starter = request.starter;
        loaded.document.name = made.name;
        loaded.toothCase = std::make_shared<const cases::Case>(std::move(made));
    } else if (fileKindOf(request.path) == FileKind::attempt) {
        cases::OpenAttempt open = cases::openAttempt(request.path);
        loaded.document.attemptFile = request.path;
        loaded.document.caseFile = open.attempt.caseFile;
        loaded.document.name = request.path.stem().string();
        loaded.toothCase = std::make_shared<const cases::Case>(std::move(open.toothCase));
        attempt = std::move(open.attempt);
        loaded.document.student = attempt->student;
        loaded.document.recordings = placesOf(*attempt, request);
        if (!attempt->exercise.empty()) {
            loaded.document.task = std::make_shared<const tasks::Task>(
                tasks::parseTask(attempt->exercise, attempt->rubric, *loaded.toothCase, request.path.string()));
            loaded.document.taskPath = core::wholePath(request.path);
            loaded.toothCase = {loaded.document.task, &loaded.document.task->toothCase};
        }
        settings.field = simulation::fieldSettingsAt(attempt->voxelMm);
        loaded.elapsedS = attempt->elapsedS;
        loaded.code = attempt->student;
    } else {
        const fs::path path = request.path.extension() == ".toml" ? request.path.parent_path() : request.path;
        cases::Case read = cases::readCase(path);
        if (request.fdi != 0 && request.fdi != read.fdiNumber) {
            read = cases::workOn(std::move(read), request.fdi);
            loaded.document.workedOn = request.fdi;
        }
        loaded.document.caseFile = core::wholePath(path);
        loaded.document.name = read.name;
        loaded.toothCase = std::make_shared<const cases::Case>(std::move(read));
    }
    core::report(preparing, 0.0);
    if (listener.sketch) listener.sketch(loaded.toothCase);
    tell(listener, LoadStep::distances);
    if (!recovered) {
        takeTissues(settings, *loaded.toothCase);
        takeInstruments(loaded, settings, request, attempt ? &*attempt : nullptr);
    }
    settings.resumed = attempt || recovered;
    if (!settings.resumed && settings.field.voxelMm < kTouchVoxelMm &&
        !tooth::isKept(*loaded.toothCase, {settings.field, settings.cut, request.useCache}))
        listener.shaped(*loaded.toothCase);
    std::atomic<bool> hasDistances{false};
    const core::Progress stepwise = [&](double fraction) {
        if (fraction >= tooth::kDistancesShare && !hasDistances.exchange(true)) tell(listener, LoadStep::tissues);
        return !preparing || preparing(fraction);
    };
    loaded.station = simulation::makeSimulation(*loaded.toothCase, std::move(settings), request.useCache, stepwise);
    if (attempt) loaded.state = tooth::decodeState(attempt->state, loaded.station.teeth(), request.path.string());
    if (recovered) loaded.state = std::move(recovered->state);
    if (attempt || recovered) loaded.station.resume(loaded.state);
    if (recovered) loaded.history = simulation::keepHistory(recovered->history, loaded.state, loaded.station);
    tell(listener, LoadStep::surface);
    loaded.liveTooth =
        std::make_shared<simulation::LiveTooth>(loaded.station, loaded.state, core::part(progress, 0.8, 1.0));
    return loaded;
}

std::vector<cases::Tissue> presentTissues(const cases::Case& toothCase) {
    std::vector<cases::Tissue> present;
    for (const cases::Part& part : toothCase.parts)
        if (std::find(present.begin(), present.end(), part.tissue) == present.end()) present.push_back(part.tissue);
    if (present.empty()) present.push_back(cases::Tissue::enamel);
    std::sort(present.begin(), present.end());
    return present;
}

}  // namespace handpiece::desktop
