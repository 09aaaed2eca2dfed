// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A tooth before any cut: surface, distances, tissues. Immutable, shared by the tick, its mirrors and every bur.

#include <filesystem>
#include <memory>
#include <string>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/core/realtime.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/base/geometry/vertex_colours.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/field/distance_field.h"
#include "handpiece/model/field/tissue_map.h"
#include "handpiece/model/tooth/tissue_volumes.h"

namespace handpiece::tooth {

struct CutSettings {
    double bandMm = 0.0;  ///< how deep under the surface the field follows a cut; 0: 0.2 mm, at least 3 voxels
    std::size_t reserveBricks = 0;  ///< bricks kept ready for the tooth's interior; 0: all of it, at most 256 MB
};

struct ToothModel {
    std::string name;
    geometry::TriangleMesh outer;  ///< as felt
    geometry::TriangleTree tree;   ///< exact distances to `outer`
    field::DistanceField field;    ///< its tissues are those of `tissues`
    field::TissueMap tissues{};
    CutSettings settings{};  ///< with what 0 stands for filled in
    /// What is cut holds its values to [-settings.bandMm, bandOutMm]: nearer than that to the surface they are
    /// distances, beyond it they only say "at least". At least two voxels: nearer the clamp would bend the surface.
    double bandOutMm = 0.0;
    TissueVolumes volumesMm3{};
    std::uint64_t fieldHash = 0;  ///< of the field as it was built, with the tissues that its file keeps
    std::uint64_t identity = 0;   ///< two models share it only when a state of one is a state of the other
    bool fromCache = false;
    double buildSeconds = 0.0;          ///< that loadModel took, built or reopened
    geometry::VertexColours colours{};  ///< of `outer` as a scanner saw it; empty: not known

    /// kBrickValues values of a brick before any cut. The same bits whoever asks.
    void uncutBrick(std::uint32_t dense, float* out) const noexcept HANDPIECE_REALTIME;
};

struct LoadSettings {
    field::FieldSettings field;
    CutSettings cut{};
    bool useCache = true;
    std::filesystem::path
        cacheFolder{};  ///< empty: beside the case, or the user's cache folder where that is read-only
};

/// The one way from a case to a tooth, for command line, window and replay: builds (in parallel, the same bits at any
/// thread count) or reopens distances and tissues. Throws core::Error for surfaces that cannot be felt and settings out
/// of range.
[[nodiscard]] std::shared_ptr<const ToothModel> loadModel(const cases::Case& toothCase,
                                                          const LoadSettings& settings = {},
                                                          const core::Progress& progress = {});
/// The share of its progress that is over when the distances are known and the tissues are laid out.
inline constexpr double kDistancesShare = 0.6;

/// The same tooth of other tissues, or to be cut otherwise. Throws core::Error for tissues of another grid and settings
/// out of range.
[[nodiscard]] std::shared_ptr<const ToothModel> withTissues(ToothModel&& model, field::TissueMap tissues,
                                                            const CutSettings& settings = {});
[[nodiscard]] std::shared_ptr<const ToothModel> withTissues(const ToothModel& model, field::TissueMap tissues,
                                                            const CutSettings& settings = {});

}  // namespace handpiece::tooth
