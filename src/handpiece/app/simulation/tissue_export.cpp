// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/tissue_export.h"

#include <algorithm>
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

ToothOfFile toothOf(const fs::path& path, double voxelMm, bool useCache, const core::Progress& progress) {
    std::error_code error;
    if (path.extension() == ".h5" && !fs::is_directory(path, error)) {
        SessionPlayer player(path, {useCache, false, {}}, core::part(progress, 0.0, 0.5));
        player.seek(player.durationS(), core::part(progress, 0.5, 1.0));
        return {player.station().tooth, player.state()};
    }
    SimulationSettings settings;
    settings.field.voxelMm = voxelMm;
    if (fs::exists(path, error) && cases::isAttempt(path)) {
        const cases::OpenAttempt open = cases::openAttempt(path);
        settings.field.voxelMm = open.attempt.voxelMm;
        const auto saved = [&] {
            const SimulationSetup station = makeSimulation(open.toothCase, settings, useCache, progress);
            return ToothOfFile{station.tooth, tooth::decodeState(open.attempt.state, station.teeth(), path.string())};
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
    return {makeSimulation(cases::readCase(path), settings, useCache, progress).tooth, {}};
}

}  // namespace handpiece::simulation
