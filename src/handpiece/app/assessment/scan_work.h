// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A real preparation: a scan of a plastic or real tooth that was cut, as work on an exercise.

#include <filesystem>
#include <optional>

#include "handpiece/app/assessment/score_work.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::assessment {

/// What is refused. Chosen by the project, from the scans of scan_work_test [R].
inline constexpr double kMostScanRmsMm = 0.1;       ///< over the uncut surface
inline constexpr double kFarOffMm = 0.15;           ///< farther than this off the whole tooth is not that tooth
inline constexpr double kMostOutsideShare = 0.1;    ///< of the scan, that lies so far outside of it: no bur adds tissue
inline constexpr double kMostStrayCutShare = 0.35;  ///< of the scan out of the task's zones, so far inside
inline constexpr double kLeastUncutMm2 = 20.0;      ///< to register on

/// True for a file whose name is a mesh's.
[[nodiscard]] bool isScan(const std::filesystem::path& path);
/// Registers the scan (open or closed, of the crown alone) onto the exercise's tooth by what was not cut, and takes as
/// cut what lies under its surface there; all that it does not show is as in the whole tooth. `mmPerUnit` of the file.
/// Throws core::Error: a broken file, another unit, a scan that does not fit (how far, where, what to do).
[[nodiscard]] Work readScan(const std::filesystem::path& path, const tasks::Task& task, double mmPerUnit = 1.0,
                            const core::Progress& progress = {});
/// The same of a mesh [mm]; `where` names it in errors.
[[nodiscard]] Work workOfScan(geometry::TriangleMesh mesh, const tasks::Task& task, const std::string& where,
                              const core::Progress& progress = {});

/// A measure's uncertainty with what registration and scanner add (docs/assessment.md#scans). `overPulpMm`: the least
/// thickness over the pulp, where it could be measured.
[[nodiscard]] double widened(const measures::Measured& measured, const score::ScanFit& scan,
                             std::optional<double> overPulpMm);

}  // namespace handpiece::assessment
