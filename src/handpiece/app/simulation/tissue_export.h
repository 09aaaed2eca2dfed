// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What is left of a tooth as surfaces: of the whole and of each tissue for other programs, and in its case.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/tooth/state_delta.h"
#include "handpiece/model/tooth/tooth_mirror.h"
#include "handpiece/model/tooth/tooth_model.h"

namespace handpiece::simulation {

/// The whole as one closed STL. Throws core::Error.
void exportStl(const std::shared_ptr<const tooth::ToothModel>& base, const tooth::StateDelta& state,
               const std::filesystem::path& file, const core::Progress& progress = {});

/// Each tissue as a closed STL of its own, "enamel.stl" and so on, into a folder that is made where there is none.
/// Tissues of which nothing is left have no file; one of theirs from before goes. Returns the files. All surfaces are
/// made before the first is written. Throws core::Error.
std::vector<std::filesystem::path> exportTissues(const std::shared_ptr<const tooth::ToothModel>& base,
                                                 const tooth::StateDelta& state, const std::filesystem::path& folder,
                                                 const core::Progress& progress = {});

/// The case with its teeth as they are cut: each that was is bounded by what is left of it, and its parts end there
/// (docs/case-format.md). `teeth` and `state` are of this case. Throws core::Error when cancelled.
[[nodiscard]] cases::Case asCut(cases::Case toothCase, const tooth::Teeth& teeth, const tooth::StateDelta& state,
                                const core::Progress& progress = {});
/// Teeth out of a file, and what was cut of them.
struct CutTeeth {
    cases::Case toothCase;
    tooth::Teeth teeth;
    tooth::StateDelta state;
};
/// Of an attempt as it was saved, of a session as it was at `atS` seconds (none: as it ended). None: the file is of
/// another kind, nothing of which can have been cut. Throws core::Error.
[[nodiscard]] std::optional<CutTeeth> readCutTeeth(const std::filesystem::path& path, std::optional<double> atS,
                                                   bool useCache, const core::Progress& progress = {});
/// What a case or a mesh holds, an attempt as it was saved, a session as it was at `atS` seconds (none: as it
/// ended), teeth as they are cut. Throws core::Error.
[[nodiscard]] cases::Case readAsCut(const std::filesystem::path& path, std::optional<double> atS, bool useCache,
                                    const core::Progress& progress = {});

/// A tooth out of a file: a case or a mesh as it is, an attempt as it was saved, a session as it ended.
struct ToothOfFile {
    std::shared_ptr<const tooth::ToothModel> base;
    tooth::StateDelta state;
};
/// `voxelMm`: of cases and meshes, which have none of their own. Throws core::Error.
[[nodiscard]] ToothOfFile toothOf(const std::filesystem::path& path, double voxelMm, bool useCache,
                                  const core::Progress& progress = {});

}  // namespace handpiece::simulation
