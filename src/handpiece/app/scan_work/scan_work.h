// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A real preparation: a scan of a plastic or real tooth that was cut, made into a cut tooth of its exercise.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "handpiece/assess/score/score.h"
#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/tooth/tooth_mirror.h"

namespace handpiece::scan_work {

/// What is refused. Chosen by the project, from the scans of scan_work_test [R].
inline constexpr double kMostScanRmsMm = 0.1;       ///< over what was registered on
inline constexpr double kFarOffMm = 0.15;           ///< farther than this off a tooth is not that tooth
inline constexpr double kMostOutsideShare = 0.1;    ///< of the scan, that lies so far outside of it: no bur adds tissue
inline constexpr double kMostStrayCutShare = 0.35;  ///< of the scan out of the task's zones, so far inside
inline constexpr double kLeastUncutMm2 = 20.0;      ///< to register on

/// True for a file whose name is a mesh's.
[[nodiscard]] bool isScan(const std::filesystem::path& path);

/// What a scan shows of the exercise's teeth.
struct ScannedTeeth {
    tooth::Teeth teeth;  ///< by their numbers in the case; those beside that cannot be cut are null
    tooth::StateDelta state;
    score::ScanFit fit;
    std::string notBeside;  ///< why nothing is known of cuts in the teeth beside it; empty: they are in the scan
};

/// An earlier scan of the same tooth and of those beside it, before it was cut, in any frame.
struct Files {
    std::filesystem::path scan;
    std::optional<std::filesystem::path> before{};
    double mmPerUnit = 1.0;  ///< of both
};
/// Registers the scan (open or closed, of the crown alone or with what stands around it) onto the exercise's tooth by
/// what was not cut, on the teeth beside it where too little is left, or on an earlier scan; and takes as cut what lies
/// under its surface there. All that it does not show is as in the whole tooth. Throws core::Error: a broken file,
/// another unit, a mirrored scan, one that does not fit (how far, where, what to do).
[[nodiscard]] ScannedTeeth readScan(const Files& files, const tasks::Task& task, const core::Progress& progress = {});
/// The same of meshes [mm]; `where` names the scan in errors.
[[nodiscard]] ScannedTeeth teethOfScan(geometry::TriangleMesh mesh, const tasks::Task& task, const std::string& where,
                                       const geometry::TriangleMesh* before = nullptr,
                                       const core::Progress& progress = {});

/// A measure's uncertainty with what registration and scanner add (docs/assessment.md#scans). `overPulpMm`: the least
/// thickness over the pulp, where it could be measured.
[[nodiscard]] double widened(const measures::Measured& measured, const score::ScanFit& scan,
                             std::optional<double> overPulpMm);

/// "uncut surface", "adjacent teeth", "an earlier scan".
[[nodiscard]] std::string_view wordsOf(score::RegisteredOn on);

}  // namespace handpiece::scan_work
