// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/scan_work/scan_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "handpiece/app/scan_work/fit_scan.h"
#include "handpiece/app/scan_work/removed_by_scan.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/scan/registration/registration.h"

namespace handpiece::scan_work {
namespace {

namespace fs = std::filesystem;

constexpr double kGrowNoises = 4.0;       ///< beside a cut the surface counts as cut from so much noise on
constexpr double kLeastBesideMm2 = 10.0;  ///< of a tooth beside it, to tell whether that was cut

TriangleMesh readMillimetres(const fs::path& path, double mmPerUnit) {
    TriangleMesh mesh = geometry::scaled(geometry::readMesh(path), mmPerUnit);
    const geometry::UnitGuess guess = geometry::probableUnit(mesh.bounds().size().norm());
    if (guess.unit != geometry::LengthUnit::millimetre)
        throw core::Error(fmt::format("this scan is {:.3g} mm large, which is no tooth{}", mesh.bounds().size().norm(),
                                      guess.unit == geometry::LengthUnit::unknown
                                          ? std::string()
                                          : fmt::format("; it looks like {}", geometry::unitName(guess.unit))),
                          path.string(), "give the unit of the file with --unit: mm, cm, m, inch or um");
    return mesh;
}

struct Cut {
    tooth::StateDelta state;
    double areaMm2 = 0.0;
};
/// What a scan of one tooth, in that tooth's frame and without its noise, shows as gone.
Cut cutOf(const TriangleMesh& mesh, const std::shared_ptr<const tooth::ToothModel>& whole, double growMm) {
    const std::vector<double> far = distancesTo(whole->tree, mesh), areas = vertexAreas(mesh);
    const std::vector<char> cut = cutVertices(mesh, far, areas, growMm);
    Cut result;
    core::Box box;
    for (std::size_t i = 0; i < cut.size(); ++i) {
        if (!cut[i]) continue;
        result.areaMm2 += areas[i];
        box.extend(mesh.vertices[i]);
        // What is gone lies between the two surfaces.
        box.extend(whole->tree.nearest(mesh.vertices[i]).pointMm);
    }
    if (box.isEmpty()) return result;
    const auto removed = std::make_shared<const Removed>(mesh, cut, whole->tree, growMm);
    const zones::Zones gone(
        [removed](const Vec3& p) {
            return zones::PastTarget{(*removed)(p), -zones::kFarMm};
        },
        box.grown(0.3), {});
    result.state = zones::idealState(gone, whole);
    return result;
}

/// The teeth beside it: each laid onto its own uncut surface, as plastic teeth stand a little otherwise in every jaw.
void addBeside(ScannedTeeth& result, const Fitted& fitted, const Scene& scene, double growMm) {
    tooth::LoadSettings settings;
    settings.field.voxelMm = scene.task.voxelMm;
    result.teeth.resize(scene.task.toothCase.others.size() + 1);
    for (std::size_t k = 0; k < scene.besides.size(); ++k) {
        const cases::PlacedTooth& other = scene.task.toothCase.others[scene.besides[k]];
        if (!other.isCuttable) continue;
        cases::Case alone;
        static_cast<cases::Tooth&>(alone) = other;
        alone.source = scene.task.toothCase.source;
        const std::shared_ptr<const tooth::ToothModel> whole = tooth::loadModel(alone, settings);
        const auto number = static_cast<std::uint16_t>(scene.besides[k] + 1);
        result.teeth[number] = whole;
        const auto unknown = [&](const std::string& why) {
            if (result.notBeside.empty()) result.notBeside = why;
        };
        if (geometry::surfaceAreaMm2(fitted.beside[k]) < kLeastBesideMm2) {
            unknown(fmt::format("the scan does not show tooth {} beside it", other.fdiNumber));
            continue;
        }
        TriangleMesh mesh = geometry::transformed(fitted.beside[k], other.inCase.inverse());
        try {
            mesh = geometry::transformed(
                mesh, registration::registerOnto(mesh, whole->outer, {core::Pose{}, 0.7}).movingInFixed);
        } catch (const core::Error& error) {
            if (error.problem() == "cancelled") throw;
            unknown(fmt::format("tooth {} beside it does not fit the case's: {}", other.fdiNumber, error.problem()));
            continue;
        }
        tooth::StateDelta state = cutOf(smoothed(std::move(mesh), fitted.fit.rmsMm), whole, growMm).state;
        for (tooth::StateDelta::Brick& brick : state.bricks)
            brick.id = tooth::brickId(number, tooth::denseOf(brick.id));
        tooth::RemovedMm3 removed;
        removed.set(number, state.removedMm3.own);
        state.removedMm3 = std::move(removed);
        result.state.append(std::move(state));
    }
}

}  // namespace

bool isScan(const fs::path& path) {
    const geometry::MeshFormat format = geometry::meshFormatOf(path);
    return format == geometry::MeshFormat::stl || format == geometry::MeshFormat::ply;
}

std::string_view wordsOf(score::RegisteredOn on) {
    switch (on) {
        case score::RegisteredOn::adjacentTeeth:
            return "adjacent teeth and uncut surface";
        case score::RegisteredOn::earlierScan:
            return "an earlier scan";
        case score::RegisteredOn::uncutSurface:
            break;
    }
    return "uncut surface";
}

ScannedTeeth readScan(const Files& files, const tasks::Task& task, const core::Progress& progress) {
    std::optional<TriangleMesh> before;
    if (files.before) before = readMillimetres(*files.before, files.mmPerUnit);
    return teethOfScan(readMillimetres(files.scan, files.mmPerUnit), task, files.scan.string(),
                       before ? &*before : nullptr, progress);
}

ScannedTeeth teethOfScan(TriangleMesh mesh, const tasks::Task& task, const std::string& where,
                         const TriangleMesh* before, const core::Progress& progress) {
    const auto tidy = [&](TriangleMesh scan) {
        geometry::requireValidIndices(scan, where);
        scan = tidied(std::move(scan));
        if (scan.triangles.empty()) throw core::Error("this scan has no surface", where, "give a mesh with triangles");
        return scan;
    };
    mesh = tidy(std::move(mesh));
    std::optional<TriangleMesh> earlier;
    if (before != nullptr) earlier = tidy(*before);

    tooth::LoadSettings settings;
    settings.field.voxelMm = task.voxelMm;
    const std::shared_ptr<const tooth::ToothModel> whole =
        tooth::loadModel(task.toothCase, settings, core::part(progress, 0.0, 0.2));
    const Scene scene(task, *whole, where);
    Fitted place = fitted(std::move(mesh), scene, earlier ? &*earlier : nullptr, core::part(progress, 0.2, 0.8));

    ScannedTeeth result;
    result.teeth = {whole};
    result.fit = place.fit;
    const TriangleMesh even = smoothed(place.tooth, place.fit.rmsMm);
    const Spread left = spreadOf(distancesTo(whole->tree, even), vertexAreas(even), place.uncut);
    // Where nearly nothing is uncut that says little: then a third of what there was before.
    constexpr double kLeftOfRms = 1.0 / 3.0;
    result.fit.noiseMm =
        left.areaMm2 < kLeastBesideMm2 ? std::max(left.rmsMm, kLeftOfRms * place.fit.rmsMm) : left.rmsMm;
    const double growMm = std::max(place.fit.rmsMm, kGrowNoises * result.fit.noiseMm);
    Cut cut = cutOf(even, whole, growMm);
    result.fit.cutMm2 = cut.areaMm2;
    result.state = std::move(cut.state);
    addBeside(result, place, scene, growMm);
    core::report(progress, 1.0);
    return result;
}

}  // namespace handpiece::scan_work
