// SPDX-License-Identifier: Apache-2.0
#include "shell/documents.h"

#include <fmt/format.h>

#include <algorithm>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/tooth/cut_state_file.h"
#include "handpiece/senses/surface/brick_source.h"
#include "handpiece/senses/surface/closed_surface.h"
#include "station/session_player.h"

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;

void takeBur(LoadedTooth& loaded, station::StationSettings& settings, const std::string& bur,
             const std::string& ability) {
    instrument::Instrument made = instrument::makeInstrument(bur, {}, ability);
    settings.bur = std::move(made.bur);
    settings.ability = std::move(made.ability);
    loaded.bur = bur;
}

/// What an attempt was cut with. A bur out of a file that is gone by now is no reason not to open it.
void takeInstruments(LoadedTooth& loaded, station::StationSettings& settings, const LoadRequest& request,
                     const tooth::Attempt* attempt) {
    loaded.drive = request.drive;
    loaded.speedRpm = request.speedRpm;
    std::string bur = request.bur, ability;
    if (attempt) {
        const auto& drives = instrument::drives();
        if (std::any_of(drives.begin(), drives.end(), [&](const auto& d) { return d.name == attempt->drive; })) {
            loaded.drive = attempt->drive;
            loaded.speedRpm = 0.0;
        }
        bur = attempt->bur;
        ability = attempt->ability;
    } else if (loaded.toothCase->exercise && !loaded.toothCase->exercise->bur.empty()) {
        bur = loaded.toothCase->exercise->bur;
    }
    try {
        takeBur(loaded, settings, bur, ability);
    } catch (const core::Error&) {
        loaded.missingBur = bur;
        takeBur(loaded, settings, request.bur, {});
    }
    settings.drive = driveAt(loaded.drive, loaded.speedRpm);
    loaded.speedRpm = settings.drive.freeSpeedRpm;
}

/// The tissues' feel from the case's own table; the person's multipliers stay.
void takeTissues(station::StationSettings& settings, const tooth::Case& toothCase) {
    settings.tissues = toothCase.tissues;
    const force::Parameters wanted = settings.parameters;
    settings.parameters = force::defaultParameters(toothCase.tissues);
    settings.parameters.stiffnessMultiplier = wanted.stiffnessMultiplier;
    settings.parameters.dampingMultiplier = wanted.dampingMultiplier;
    settings.parameters.frictionMultiplier = wanted.frictionMultiplier;
}

}  // namespace

FileKind fileKindOf(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    std::error_code error;
    if (fs::is_directory(path, error)) return tooth::isAttempt(path) ? FileKind::attempt : FileKind::toothCase;
    if (extension == ".h5") return FileKind::session;
    if (extension == ".toml") return FileKind::toothCase;
    if (extension == ".handpiece")
        return fs::exists(path, error) && tooth::isAttempt(path) ? FileKind::attempt : FileKind::toothCase;
    if (geometry::meshFormatOf(path) != geometry::MeshFormat::unknown) return FileKind::mesh;
    return FileKind::unknown;
}

tooth::Case starterCase(const Starter& starter, const fs::path& folder, const core::Progress& progress) {
    const starter::ToothKindInfo& info = starter::infoOf(starter.kind);
    // The version stands in the name: a later one may make another tooth of the same rules.
    const fs::path place = folder / fmt::format("{}-{}-{}", info.name, starter.faces, HANDPIECE_VERSION);
    std::error_code error;
    if (fs::exists(place / "case.toml", error)) {
        try {
            return tooth::readCase(place);
        } catch (const core::Error&) {
            fs::remove_all(place, error);  // damaged: it is made again
        }
    }
    const tooth::Case made = starter::makeTooth(starter.kind, {starter.faces, 0, true}, progress);
    fs::create_directories(folder, error);
    tooth::writeCase(made, place);
    // As read back: an STL holds less than a double, and the cache beside it belongs to what it holds.
    return tooth::readCase(place);
}

instrument::Drive driveAt(const std::string& name, double speedRpm) {
    instrument::Drive drive = instrument::driveByName(name);
    if (speedRpm > 0.0) drive.freeSpeedRpm = std::clamp(speedRpm, 0.02 * drive.freeSpeedRpm, drive.freeSpeedRpm);
    return drive;
}

LoadedTooth loadTooth(const LoadRequest& request, const core::Progress& progress) {
    LoadedTooth loaded;
    station::StationSettings settings = request.settings;
    std::optional<tooth::Attempt> attempt;
    std::optional<station::Recovered> recovered;
    const core::Progress reading = core::part(progress, 0.0, 0.3), preparing = core::part(progress, 0.3, 0.8);
    if (request.recover) {
        recovered = station::recover(request.path, reading);
        loaded.document = request.recovered;
        loaded.toothCase = std::make_shared<const tooth::Case>(std::move(recovered->toothCase));
        loaded.elapsedS = recovered->elapsedS;
        loaded.code = recovered->code;
        settings = recovered->settings;
        settings.capability = request.settings.capability;
        settings.hull = false;
        loaded.bur = settings.bur->name();
        loaded.drive = settings.drive.name;
        loaded.speedRpm = settings.drive.freeSpeedRpm;
    } else if (request.starter) {
        tooth::Case made = starterCase(*request.starter, request.starterFolder, reading);
        loaded.document.caseFile = made.source;
        loaded.document.starter = request.starter;
        loaded.document.name = made.name;
        loaded.toothCase = std::make_shared<const tooth::Case>(std::move(made));
    } else if (fileKindOf(request.path) == FileKind::attempt) {
        tooth::OpenAttempt open = tooth::openAttempt(request.path);
        loaded.document.attemptFile = request.path;
        loaded.document.caseFile = open.attempt.caseFile;
        loaded.document.name = request.path.stem().string();
        loaded.toothCase = std::make_shared<const tooth::Case>(std::move(open.toothCase));
        attempt = std::move(open.attempt);
        settings.field.voxelMm = attempt->voxelMm;
        loaded.elapsedS = attempt->elapsedS;
        loaded.code = attempt->student;
    } else {
        const fs::path path = request.path.extension() == ".toml" ? request.path.parent_path() : request.path;
        tooth::Case read = tooth::readCase(path);
        loaded.document.caseFile = fs::absolute(path);
        loaded.document.name = read.name;
        loaded.toothCase = std::make_shared<const tooth::Case>(std::move(read));
    }
    core::report(preparing, 0.0);
    if (!recovered) {
        takeTissues(settings, *loaded.toothCase);
        takeInstruments(loaded, settings, request, attempt ? &*attempt : nullptr);
    }
    settings.resumed = attempt || recovered;
    loaded.station = station::makeStation(*loaded.toothCase, std::move(settings), request.useCache, preparing);
    if (attempt)
        loaded.state =
            tooth::decodeState(attempt->state, loaded.station.identity, *loaded.station.tooth, request.path.string());
    if (recovered) loaded.state = std::move(recovered->state);
    if (attempt || recovered) loaded.station.resume(loaded.state);
    if (recovered) loaded.history = station::keepHistory(recovered->history, loaded.state, loaded.station);
    loaded.liveTooth =
        std::make_shared<station::LiveTooth>(loaded.station.tooth, loaded.state, core::part(progress, 0.8, 1.0));
    return loaded;
}

void exportStl(const std::shared_ptr<const tooth::CuttableTooth>& base, const tooth::CutState& state,
               const fs::path& file, const core::Progress& progress) {
    tooth::CutMirror mirror(base);
    mirror.apply(state);
    geometry::writeStl(file, surface::closedSurface(surface::MirrorSource(mirror), progress));
}

}  // namespace handpiece::desktop
