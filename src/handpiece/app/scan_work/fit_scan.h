// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A scan laid onto the exercise's tooth by what was not cut. Private to this room.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/app/scan_work/scan_mesh.h"
#include "handpiece/app/scan_work/scan_work.h"
#include "handpiece/assess/preparation/preparation.h"

namespace handpiece::scan_work {

/// What a scan is held against, tooth frame.
struct Scene {
    const tasks::Task& task;
    const tooth::ToothModel& whole;
    std::optional<preparation::Laid> laid{};
    std::vector<std::size_t> besides{};            ///< of the case's other teeth those beside it, in the same jaw
    TriangleMesh others{};                         ///< these, as they were
    std::unique_ptr<const TriangleTree> beside{};  ///< of `others`; null where there are none
    std::string where;                             ///< the scan, for errors

    Scene(const tasks::Task& ofTask, const tooth::ToothModel& model, std::string source);
    /// Nothing this near to where the exercise lets anything go is registered on.
    [[nodiscard]] bool mayBeCut(const Vec3& p) const;
    [[noreturn]] void refuse(const std::string& problem) const;
};

/// A scan in its place.
struct Fitted {
    TriangleMesh tooth;                ///< of the exercise's tooth alone, raw
    std::vector<TriangleMesh> beside;  ///< what lies on each of the scene's teeth beside, tooth frame; may be empty
    std::vector<char> uncut;           ///< by vertex of `tooth`: surface that is as it was
    score::ScanFit fit;                ///< what is not filled in: noise, cut area
};
/// `before`: an earlier scan of the same [mm], its own frame. Throws core::Error: it does not fit, how far, where, what
/// to do.
[[nodiscard]] Fitted fitted(TriangleMesh scan, const Scene& scene, const TriangleMesh* before,
                            const core::Progress& progress);

/// How well a surface holds a body in place: of a point about which it turns, and its turns, one standard deviation.
struct Hold {
    double liesMm = 1e9, turnsRad = 1e9;
};
/// `rmsMm`: one draw a square millimetre.
[[nodiscard]] Hold holdOf(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                          const std::vector<double>& mm2, double rmsMm, const Vec3& about);

}  // namespace handpiece::scan_work
