// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/tissue_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "handpiece/app/simulation/session_player.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/senses/surface/brick_source.h"
#include "handpiece/senses/surface/closed_surface.h"

namespace handpiece::simulation {
namespace fs = std::filesystem;

void exportStl(const std::shared_ptr<const tooth::ToothModel>& base, const tooth::StateDelta& state,
               const fs::path& file, const core::Progress& progress) {
    tooth::ToothMirror mirror(base);
    mirror.apply(state);
    geometry::writeStl(file, surface::closedSurface(surface::MirrorSource(mirror), progress));
}

std::vector<fs::path> exportTissues(const std::shared_ptr<const tooth::ToothModel>& base,
                                    const tooth::StateDelta& state, const fs::path& folder,
                                    const core::Progress& progress) {
    tooth::ToothMirror mirror(base);
    mirror.apply(state);
    const surface::MirrorSource source(mirror);
    const std::vector<cases::Tissue> tissues = base->tissues.tissues();
    struct File {
        fs::path path;
        std::vector<std::byte> bytes;
    };
    std::vector<File> files;
    for (std::size_t i = 0; i < tissues.size(); ++i) {
        const double share = 1.0 / static_cast<double>(tissues.size());
        const geometry::TriangleMesh mesh = surface::closedPart(
            source, base->tissues, tissues[i],
            core::part(progress, share * static_cast<double>(i), share * static_cast<double>(i + 1)));
        const std::string name = std::string(cases::properties(tissues[i]).name) + ".stl";
        files.push_back({folder / name, {}});
        if (!mesh.triangles.empty()) files.back().bytes = geometry::stlBytes(mesh, name);
    }
    core::prepareOutputFolder(folder);
    std::vector<fs::path> written;
    for (const File& file : files) {
        std::error_code error;
        if (file.bytes.empty()) {
            fs::remove(file.path, error);
            continue;
        }
        core::writeFile(file.path, file.bytes);
        written.push_back(file.path);
    }
    return written;
}

namespace {

CutTeeth teethOfSession(const fs::path& path, std::optional<double> atS, bool useCache,
                        const core::Progress& progress) {
    SessionPlayer player(path, {useCache, false, {}}, core::part(progress, 0.0, 0.5));
    if (atS && *atS > player.durationS())
        throw core::Error(fmt::format("the session has no second {:.3f}", *atS), path.string(),
                          fmt::format("it is {:.3f} s long", player.durationS()));
    player.seek(atS.value_or(player.durationS()), core::part(progress, 0.5, 1.0));
    return {player.toothCase(), player.station().teeth(), player.state()};
}

CutTeeth teethOfAttempt(const fs::path& path, bool useCache, const core::Progress& progress) {
    cases::OpenAttempt open = cases::openAttempt(path);
    SimulationSettings settings;
    settings.field.voxelMm = open.attempt.voxelMm;
    const auto saved = [&] {
        tooth::Teeth teeth = makeSimulation(open.toothCase, settings, useCache, progress).teeth();
        tooth::StateDelta state = tooth::decodeState(open.attempt.state, teeth, path.string());
        return CutTeeth{std::move(open.toothCase), std::move(teeth), std::move(state)};
    };
    // It does not tell its bands: the command line never makes them thinner than a few voxels, the window keeps
    // them.
    const field::FieldSettings kept = settings.field;
    settings.field.bandOutMm = std::max(kept.bandOutMm, 2.0 * kept.voxelMm);
    settings.field.bandInMm = std::max(kept.bandInMm, 4.0 * kept.voxelMm);
    if (settings.field.bandOutMm == kept.bandOutMm && settings.field.bandInMm == kept.bandInMm) return saved();
    try {
        return saved();
    } catch (const core::Error&) {  // what is wrong beside the bands is told by the second reading
        settings.field = kept;
        return saved();
    }
}

}  // namespace

std::optional<CutTeeth> readCutTeeth(const fs::path& path, std::optional<double> atS, bool useCache,
                                     const core::Progress& progress) {
    std::error_code error;
    if (path.extension() == ".h5" && !fs::is_directory(path, error))
        return teethOfSession(path, atS, useCache, progress);
    if (fs::exists(path, error) && cases::isAttempt(path)) return teethOfAttempt(path, useCache, progress);
    return std::nullopt;
}

cases::Case asCut(cases::Case toothCase, const tooth::Teeth& teeth, const tooth::StateDelta& state,
                  const core::Progress& progress) {
    for (std::size_t number = 0; number < teeth.size() && number <= toothCase.others.size(); ++number) {
        const bool isCut =
            std::any_of(state.bricks.begin(), state.bricks.end(),
                        [&](const tooth::StateDelta::Brick& b) { return !b.uncut && tooth::toothOf(b.id) == number; });
        if (!isCut || teeth[number] == nullptr) continue;
        tooth::ToothMirror mirror(teeth[number], static_cast<std::uint16_t>(number));
        mirror.apply(state);
        cases::Tooth& tooth = number == 0 ? static_cast<cases::Tooth&>(toothCase) : toothCase.others[number - 1];
        tooth.outer =
            surface::closedSurface(surface::MirrorSource(mirror),
                                   core::part(progress, static_cast<double>(number) / static_cast<double>(teeth.size()),
                                              static_cast<double>(number + 1) / static_cast<double>(teeth.size())));
    }
    return toothCase;
}

cases::Case readAsCut(const fs::path& path, std::optional<double> atS, bool useCache, const core::Progress& progress) {
    std::optional<CutTeeth> cut = readCutTeeth(path, atS, useCache, core::part(progress, 0.0, 0.6));
    if (!cut) return cases::readCase(path);
    return asCut(std::move(cut->toothCase), cut->teeth, cut->state, core::part(progress, 0.6, 1.0));
}

ToothOfFile toothOf(const fs::path& path, double voxelMm, bool useCache, const core::Progress& progress) {
    if (std::optional<CutTeeth> cut = readCutTeeth(path, {}, useCache, progress))
        return {std::move(cut->teeth.front()), std::move(cut->state)};
    SimulationSettings settings;
    settings.field.voxelMm = voxelMm;
    return {makeSimulation(cases::readCase(path), settings, useCache, progress).tooth, {}};
}

}  // namespace handpiece::simulation
